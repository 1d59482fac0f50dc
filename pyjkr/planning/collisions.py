"""Estimates of single collisions for the decisions of a plan: rebound, and what sliding and rolling do to an oblique one.

Covers Haervig 2017 eqs 3, 8-13 through the interpolated table of `calibrate.collision`, eqs 14-22 and Chen 2019 eqs 1b-1d, 3
through impulses: a load times the contact time. Assumes solid spheres; the impulses are upper bounds, not outcomes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pyjkr import contact as contact_laws
from pyjkr import scaling, timestep
from pyjkr.calibrate.collision import Law, collision
from pyjkr.calibrate.table import HIGHEST_RESTITUTION, LOWEST_RESTITUTION
from pyjkr.contact import PairProperties
from pyjkr.planning.situation import Meeting

# Sticking speed of the full law without damping in units of sqrt(F_C a_0^2/(R m)): the energy of the make and break of the
# neck, 0.2574 F_C a_0^2/R (Haervig 2017, eqs 8-10, integrated to the rupture of Chen 2019, eq. 6).
UNDAMPED_STICKING = 0.717514475
# Speeds at which a range of speeds is looked at.
SPEEDS_LOOKED_AT = 33
# Spin of a solid sphere that an impulse J at its rim makes: r omega = (5/2) J/m. Both spheres of a pair and a wall slip
# against each other by (7/2) J/m with m the effective mass.
RIM_SHARE = 5 / 2
SLIP_SHARE = 7 / 2
# Largest change of the slip over the slip: a spring turns it round at best.
SLIP_REVERSAL = 2.0


def softened(meeting: Meeting, modulus_ratio: float, *, adhesion: bool = True, originals: bool = False) -> PairProperties:
    """Pair of a meeting at reduced stiffness, q = E_mod/E with gamma_mod = gamma q^(2/5); Haervig 2017, eq. 24.

    Parameters
    ----------
    meeting : Meeting
        The meeting, of the real material.
    modulus_ratio : float
        q.
    adhesion : bool
        Whether there is any surface energy.
    originals : bool
        Whether the rolling moment keeps the original surface energy; Chen 2019, eq. 11.
    """
    pair = meeting.pair
    energy = pair.surface_energy if adhesion else 0.0
    normal_energy = scaling.surface_energy_mod(energy, modulus_ratio)
    return replace(
        pair,
        effective_modulus=pair.effective_modulus * modulus_ratio,
        effective_shear_modulus=pair.effective_shear_modulus * modulus_ratio,
        surface_energy=normal_energy,
        surface_energy_of_rolling=energy if originals else normal_energy,
    )


def speeds(meeting: Meeting) -> np.ndarray:
    """Normal speeds of a meeting from the slowest to the fastest [m/s], evenly on a log axis."""
    return np.geomspace(meeting.slowest_speed, meeting.speed, SPEEDS_LOOKED_AT)


def masses(meeting: Meeting) -> tuple[float, ...]:
    """Masses of the spheres of a meeting [kg]."""
    return tuple(4 / 3 * math.pi * radius**3 * density for radius, density in zip(meeting.radii, meeting.densities, strict=True))


def energy_kept(pair: PairProperties, law: Law, speed: np.ndarray, restitution_coefficient: float | None = None) -> np.ndarray:
    """e_eff^2 of normal impacts [-], 0 where they stick.

    Parameters
    ----------
    pair : PairProperties
        The pair; without surface energy e^2 is returned, which Hertz with this damping gives exactly.
    law : str
        "jkr" or "jkr/simplified".
    speed : ndarray
        Normal speeds [m/s].
    restitution_coefficient : float
        In place of the pair's; 1 for no damping.
    """
    e = pair.restitution_coefficient if restitution_coefficient is None else restitution_coefficient
    speed = np.asarray(speed, dtype=float)
    sticks = sticking_speed(pair, law, e)
    if sticks == 0:
        return np.full_like(speed, e**2)
    if e == 1:
        return np.maximum(0.0, 1 - (sticks / speed) ** 2)
    kept = collision(law).restitution(np.maximum(speed / sticks, 1.0), _in_table(e)) ** 2
    return np.where(speed > sticks, kept, 0.0)


def sticking_speed(pair: PairProperties, law: Law, restitution_coefficient: float | None = None) -> float:
    """Speed below which a normal impact sticks [m/s]; 0 without adhesion, and for `jkr/simplified` without damping."""
    e = pair.restitution_coefficient if restitution_coefficient is None else restitution_coefficient
    unit = math.sqrt(pair.pull_off_force / (pair.effective_radius * pair.effective_mass)) * pair.equilibrium_contact_radius
    if e == 1:
        return UNDAMPED_STICKING * unit if law == "jkr" else 0.0
    return float(collision(law).sticking_ratio(_in_table(e))) * unit


def _in_table(restitution_coefficient: float) -> float:
    """Of the table; above its end damping takes less than 0.4 % of the energy."""
    return min(max(restitution_coefficient, LOWEST_RESTITUTION), HIGHEST_RESTITUTION)


def contact_time(pair: PairProperties, speed: float) -> float:
    """Upper bound of how long an impact touches [s]; the stuck period where it sticks (Haervig 2017, eqs 7-9).

    The way in takes half of Hertz' collision time, the way out longer: slower by e_eff, and held back by the neck next to the
    sticking speed. The two constants enclose the contact times of `oracle.impact` of both laws for e from 0.3 to 1; they go as
    q^(-2/5) like Hertz' time itself.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    speed : float
        Normal speed of approach [m/s].
    """
    kept = float(energy_kept(pair, "jkr", np.asarray(speed)))
    if kept == 0:
        return timestep.stuck_period(pair)
    hertz = timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, speed)
    held_back = 0.25 * min(1.0, 1.5 * sticking_speed(pair, "jkr") / speed)
    return hertz * (1 + kept**-0.1) / 2 * (1.06 + held_back)


def overlap_in_impact(pair: PairProperties, speed: float) -> float:
    """Deepest overlap [m], never less than that of equilibrium."""
    return contact_laws.maximum_overlap(pair, speed)


def equilibrium_overlap(pair: PairProperties) -> float:
    """delta_0 = a_0^2/(3 R) [m]; Chen 2019, eq. 16."""
    return pair.equilibrium_contact_radius**2 / (3 * pair.effective_radius)


def tangential_cases(meeting: Meeting) -> Iterator[tuple[float, float, float]]:
    """(normal speed, tangential speed, both together) at the slowest and the fastest approach [m/s]."""
    if meeting.tangential_speed > 0:
        for normal_speed in dict.fromkeys((meeting.slowest_speed, meeting.speed)):
            yield normal_speed, meeting.tangential_speed, math.hypot(normal_speed, meeting.tangential_speed)


def sliding_change(meeting: Meeting, pair: PairProperties) -> float:
    """Largest change of r omega by friction in an oblique impact, over the impact speed: (5/2) J/(m_light v).

    J is the smaller of Coulomb's impulse mu ((1 + e) m v_n + 2 F_C t_c) (Haervig 2017, eq. 17) and the one that turns the
    slip round. The change of the tangential speed is 2/5 of it.
    """
    return max((RIM_SHARE * _impulse(meeting, pair, *case) for case in tangential_cases(meeting)), default=0.0)


def sliding_adhesion_change(meeting: Meeting, pair: PairProperties, pull_off_force: float | None = None) -> float:
    """The same from the term 2 F_C of the sliding limit alone; Haervig 2017, eq. 17.

    Parameters
    ----------
    meeting : Meeting
        The meeting.
    pair : PairProperties
        Of the normal law, reduced or not.
    pull_off_force : float
        F_C of the sliding limit [N], where it is not the pair's: the original one of Chen 2019, eq. 12.
    """
    force = pair.pull_off_force if pull_off_force is None else pull_off_force
    worst = 0.0
    for normal_speed, tangential_speed, speed in tangential_cases(meeting):
        with_it = meeting.friction_coefficient * 2 * force * contact_time(pair, normal_speed)
        impulse = min(with_it, _reversal(pair, tangential_speed))
        worst = max(worst, RIM_SHARE * impulse / (min(masses(meeting)) * speed))
    return worst


def rolling_change(meeting: Meeting, pair: PairProperties, critical_rolling: float | None = None) -> float:
    """Largest change of r omega by rolling resistance in an oblique impact, over the impact speed: (5/2) M t_c/(m_i r_i v).

    M = 4 F_C s^(3/2) xi at the deepest contact, s = a/a_0, with xi the smaller of xi_crit and half the way that the contact
    rolls; Haervig 2017, eqs 20-22. An impact that sticks rolls until resistance has taken all of its tangential speed.

    Parameters
    ----------
    meeting : Meeting
        The meeting.
    pair : PairProperties
        Of the normal law, with the surface energy of rolling.
    critical_rolling : float
        xi_crit [m], where it is not the meeting's.
    """
    if pair.surface_energy == 0:
        return 0.0
    limit = meeting.critical_rolling if critical_rolling is None else critical_rolling
    worst, sticks = 0.0, sticking_speed(pair, "jkr")
    for normal_speed, tangential_speed, speed in tangential_cases(meeting):
        if normal_speed <= sticks:
            worst = max(worst, tangential_speed / speed)
            continue
        time = contact_time(pair, normal_speed)
        way = min(limit, 0.5 * _rolling_speed(meeting, pair, normal_speed, tangential_speed) * time)
        depth = contact_laws.maximum_contact_radius(pair, normal_speed) / pair.equilibrium_contact_radius
        pull_off = 3 * math.pi * pair.effective_radius * pair.surface_energy_of_rolling
        impulse = 4 * pull_off * depth**1.5 * way * time
        lightest = min(mass * radius for mass, radius in zip(masses(meeting), meeting.radii, strict=True))
        worst = max(worst, RIM_SHARE * impulse / (lightest * speed))
    return worst


def turning(meeting: Meeting, pair: PairProperties) -> float:
    """Angle by which the line of centres of two spheres turns during an oblique impact [rad]: v_t t_c/(r_i + r_j); 0 at a wall."""
    if len(meeting.radii) == 1:
        return 0.0
    return max((vt * contact_time(pair, vn) / sum(meeting.radii) for vn, vt, _ in tangential_cases(meeting)), default=0.0)


def _impulse(meeting: Meeting, pair: PairProperties, normal_speed: float, tangential_speed: float, speed: float) -> float:
    """Impulse of sliding over m_light v."""
    bounce = (1 + pair.restitution_coefficient) * pair.effective_mass * normal_speed
    adhesive = 2 * pair.pull_off_force * contact_time(pair, normal_speed)
    impulse = min(meeting.friction_coefficient * (bounce + adhesive), _reversal(pair, tangential_speed))
    return impulse / (min(masses(meeting)) * speed)


def _reversal(pair: PairProperties, tangential_speed: float) -> float:
    """Impulse that turns a slip round [kg m/s]."""
    return SLIP_REVERSAL / SLIP_SHARE * pair.effective_mass * tangential_speed


def _rolling_speed(meeting: Meeting, pair: PairProperties, normal_speed: float, tangential_speed: float) -> float:
    """Bound of the rolling velocity in an oblique impact [m/s]; Haervig 2017, eq. 20, its misprint mended."""
    weights = [1 / (mass * radius) for mass, radius in zip(masses(meeting), meeting.radii, strict=True)]
    weights += [0.0] * (2 - len(weights))
    asymmetry = 1.0 if len(meeting.radii) == 1 else abs(meeting.radii[1] - meeting.radii[0]) / sum(meeting.radii)
    impulse = min(masses(meeting)) * math.hypot(normal_speed, tangential_speed)
    impulse *= _impulse(meeting, pair, normal_speed, tangential_speed, math.hypot(normal_speed, tangential_speed))
    spins = pair.effective_radius * RIM_SHARE * impulse * abs(weights[0] - weights[1])
    return max(spins, asymmetry / 2 * tangential_speed)
