# Law: normal impact of two adhesive spheres, or of a sphere and a wall, as motion of one effective mass.
# Covers: Haervig et al. 2017 eqs 3, 5, 8-13 and the bisection of section 5.2; Chen et al. 2019 eqs 5, 7; contact
#   made at overlap 0.
# Assumes: central impact, no other force; broken at overlap 0 (simplified) or at the rupture of the neck (full).
"""One-dimensional impacts to near round-off.

The laws have branch points in time: damping goes as overlap^(1/4) at the make (simplified), da/d(overlap) diverges at
the rupture (full).
Both vanish when q replaces the overlap x and theta the time:
    simplified  x = q^4,  dt/dtheta = 4 q^3;      full  u = c + q (normal.py),  dt/dtheta = dx/dq;      in both
    dq/dtheta = dx/dt.
The right-hand sides are then smooth in q and the contact ends where q falls through 0, at a finite rate.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .normal import (
    CRITICAL,
    Model,
    NormalContact,
    damping_ratio,
    equilibrium_contact_radius,
    pull_off_force,
    rupture_overlap,
    scaled_root,
    stored_energy,
)


@dataclass(frozen=True)
class Impact:
    """Outcome of one normal impact.

    Parameters
    ----------
    speed : [m/s], before the contact.
    rebound_speed : [m/s], after it; 0 if stuck.
    restitution : [-], rebound_speed / speed.
    stuck : whether the contact never ends.
    contact_time : [s], from make to break; nan if stuck.
    maximum_overlap : [m].
    exit_energy : [J], kinetic energy at the break; if stuck, minus the energy that was missing at the first turning
        point.
    time, overlap, velocity : [s], [m], [m/s], the trajectory, from the make to the break or through a few
        oscillations if stuck.
        velocity is d(overlap)/dt, positive on approach.
    """

    speed: float
    rebound_speed: float
    restitution: float
    stuck: bool
    contact_time: float
    maximum_overlap: float
    exit_energy: float
    time: np.ndarray
    overlap: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True)
class _Units:
    """Scales of one impact: contact radius a_1, length a_1^2/R, force E a_1^3/(3 R), time sqrt(m length/force); eps
    as in normal.py."""

    length: float
    time: float
    energy: float
    eps: float
    critical: float
    damping: float
    simplified: bool


def _units(contact: NormalContact, effective_mass: float, speed: float) -> _Units:
    radius, modulus, zero_load = (
        contact.effective_radius,
        contact.effective_modulus,
        float(equilibrium_contact_radius(contact)),
    )
    scale = max(
        zero_load, (3 * radius**2 * effective_mass * speed**2 / modulus) ** 0.2
    )  # a_0, or the a at which Hertz stops the mass
    length, force = scale**2 / radius, modulus * scale**3 / (3 * radius)
    ratio = (zero_load / scale) ** 0.5
    damping = 2 * 5**0.5 * float(damping_ratio(contact.restitution_coefficient))
    return _Units(
        length,
        (effective_mass * length / force) ** 0.5,
        force * length,
        ratio**3,
        CRITICAL * ratio,
        damping,
        contact.model is Model.SIMPLIFIED,
    )


def _overlap(units: _Units, q):
    if units.simplified:
        return q**4
    return q**2 * (6 * units.critical**2 + q * (4 * units.critical + q)) - 3 * units.critical**4


def _right_hand_side(units: _Units):
    eps, c, damping = units.eps, units.critical, units.damping

    def simplified(theta, state):
        q, velocity, _ = state.tolist()
        stretch = 4 * q * q * q
        u = c + scaled_root((max(q, 0.0) ** 4 + 3 * c**4) ** 0.5, c)
        return [velocity, -stretch * (4 * u**3 * (u**3 - eps) + damping * max(q, 0.0) * velocity), stretch]

    def full(theta, state):
        q, velocity, _ = state.tolist()
        u, stretch = c + q, 4 * q * (3 * c * c + q * (3 * c + q))
        return [velocity, -stretch * (4 * u**3 * (u**3 - eps) + damping * u * velocity), stretch]

    return simplified if units.simplified else full


def _broken(theta, state):
    return state[0]


def _deepest(theta, state):
    return state[1]


def _turned(theta, state):
    return state[1]


_broken.terminal, _broken.direction = True, -1
_deepest.direction = -1
_turned.terminal, _turned.direction = True, 1


def _exact_break(right_hand_side, state, step, tolerances):
    """State where q = 0, by Newton on the length of a directly integrated last step: dense output is two orders less
    accurate."""
    for _ in range(3):
        end = solve_ivp(right_hand_side, (0.0, step), state, method="DOP853", first_step=step, **tolerances).y[:, -1]
        if end[1] == 0.0:
            break
        step = max(step - end[0] / end[1], 0.5 * step)
    return end


def impact(
    contact: NormalContact,
    effective_mass: float,
    speed: float,
    *,
    relative_tolerance: float = 1e-12,
    samples: int = 400,
    stuck_periods: float = 4.0,
) -> Impact:
    """Follow one impact from the make at overlap 0 to the break, or to the turning point that proves it stuck.

    Stuck is decided by energy: damping only removes it, so a contact that turns back before its breaking overlap can
    never reach it.

    Parameters
    ----------
    contact : properties of the contact (scalars).
    effective_mass : [kg], 1/m = 1/m_i + 1/m_j; the mass itself at a wall.
    speed : [m/s], relative normal speed at the make, > 0.
    relative_tolerance : [-], of the integrator (DOP853 on scaled, regularised variables).
    samples : [-], points of the trajectory.
    stuck_periods : [-], how many periods of the stuck oscillation the trajectory of a stuck contact shows after its
        turning point.

    Returns
    -------
    Impact

    Raises
    ------
    ValueError : if speed or mass is not positive.
    """
    if not (speed > 0 and effective_mass > 0):
        raise ValueError(f"speed = {speed} m/s and effective_mass = {effective_mass} kg must be > 0")
    units = _units(contact, effective_mass, speed)
    right_hand_side = _right_hand_side(units)
    tolerances = {"rtol": max(relative_tolerance, 3e-14), "atol": max(0.01 * relative_tolerance, 1e-16)}
    start = 0.0 if units.simplified else (2 * units.eps / 3) ** (1 / 3) - units.critical  # overlap 0
    state = np.array([start, speed * units.time / units.length, 0.0])
    run = solve_ivp(
        right_hand_side,
        (0.0, np.inf),
        state,
        method="DOP853",
        dense_output=True,
        events=(_broken, _deepest, _turned),
        **tolerances,
    )
    # Without damping energy decides alone: no accumulated error may stick a slow contact of the simplified law.
    barrier = float(stored_energy(contact, rupture_overlap(contact)))
    elastic_exit = 0.5 * effective_mass * speed**2 - barrier
    stuck = elastic_exit < 0 if units.damping == 0 else len(run.t_events[0]) == 0
    pieces = [(run.sol, run.t[-1])]
    if stuck:
        end = run.y[:, -1]
        exit_energy = float(stored_energy(contact, _overlap(units, end[0]) * units.length)) - barrier
        pieces.append(_stuck_piece(right_hand_side, units, contact, effective_mass, end, stuck_periods, tolerances))
        rebound_speed, contact_time = 0.0, np.nan
    else:
        end = (
            run.y[:, -1]
            if len(run.t_events[0]) == 0
            else _exact_break(right_hand_side, run.y[:, -2], run.t[-1] - run.t[-2], tolerances)
        )
        exit_energy = elastic_exit if units.damping == 0 else 0.5 * units.energy * end[1] ** 2
        rebound_speed, contact_time = (2 * exit_energy / effective_mass) ** 0.5, float(end[2]) * units.time
    q, velocity, time = np.concatenate(
        [piece(np.linspace(0, length, samples // len(pieces))) for piece, length in pieces], axis=1
    )
    return Impact(
        speed=speed,
        rebound_speed=float(rebound_speed),
        restitution=float(rebound_speed / speed),
        stuck=bool(stuck),
        contact_time=contact_time,
        maximum_overlap=float(_overlap(units, run.y_events[1][0][0]) * units.length),
        exit_energy=float(exit_energy),
        time=time * units.time,
        overlap=_overlap(units, q) * units.length,
        velocity=velocity * units.length / units.time,
    )


def _stuck_piece(right_hand_side, units, contact, effective_mass, state, periods, tolerances):
    """(dense output, its length) of the oscillation that follows the turning point."""
    period = (
        2 * np.pi * (effective_mass / (1.2 * contact.effective_modulus * equilibrium_contact_radius(contact))) ** 0.5
    )

    def late(theta, y):
        return y[2] - state[2] - periods * period / units.time

    late.terminal = True
    run = solve_ivp(
        right_hand_side, (0.0, np.inf), state, method="DOP853", dense_output=True, events=late, **tolerances
    )
    return run.sol, run.t[-1]


def sticking_speed(contact: NormalContact, effective_mass: float, *, relative_tolerance: float = 1e-11) -> float:
    """Impact speed [m/s] below which the contact sticks, Haervig 2017 section 5.2 (by root finding on the energy left
    at the exit).

    Parameters
    ----------
    contact : properties of the contact (scalars).
    effective_mass : [kg].
    relative_tolerance : [-], of the speed.

    Returns
    -------
    [m/s]; 0 where no speed sticks: without surface energy, or for the simplified law without damping.
    """
    simplified = contact.model is Model.SIMPLIFIED
    if contact.surface_energy == 0 or (simplified and contact.restitution_coefficient == 1):
        return 0.0
    unit = float(
        (
            pull_off_force(contact)
            * equilibrium_contact_radius(contact) ** 2
            / (contact.effective_radius * effective_mass)
        )
        ** 0.5
    )

    def margin(speed: float) -> float:
        return (
            impact(
                contact,
                effective_mass,
                speed,
                relative_tolerance=0.1 * relative_tolerance,
                samples=2,
                stuck_periods=0.01,
            ).exit_energy
            / speed
        )

    lower = upper = 0.7 * unit
    while margin(lower) > 0:
        lower *= 0.5
    while margin(upper) <= 0:
        upper *= 2.0
    return brentq(margin, lower, upper, xtol=1e-3 * relative_tolerance * lower, rtol=relative_tolerance)
