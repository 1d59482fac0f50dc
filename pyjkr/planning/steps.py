"""The time step: fine enough for the error, below the stability limit of every mode, for every meeting; the smallest decides.

Covers the measured accuracy of collisions (docs/accuracy-and-cost.md) and the modes of Haervig 2017 eqs 7-9, 14, 21 and Chen 2019
eq. 1c. Assumes event correction with the jkr models and none with stock `hertz`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pyjkr import contact as contact_laws
from pyjkr import timestep
from pyjkr.contact import PairProperties
from pyjkr.limits import STABLE_FRACTION
from pyjkr.planning import collisions
from pyjkr.planning.budget import STEP_SHARE
from pyjkr.planning.decision import Decision
from pyjkr.planning.effects import on
from pyjkr.planning.situation import Meeting, Situation

# Largest error of e_eff^2 over steps per collision with event correction, worst of both laws, pairs and walls (e = 0.86, 1.1 to 8
# times the sticking speed); docs/accuracy-and-cost.md, first table.
NORMAL_ERROR = {20: 4.0e-3, 40: 6.4e-4, 60: 2.8e-4, 100: 9.9e-5, 200: 2.4e-5, 500: 3.8e-6, 1000: 9.4e-7}
# The table ends at 8 times the sticking speed; at 40 times it 1.4 of its errors were measured (head-on, e = 0.2 to 0.95).
FASTEST, FAST_SHARE = 8.0, 1.5
# The same of v_t and r omega over the impact speed, worst of all stiffnesses at 45 degrees; there, table of oblique impacts.
OBLIQUE_ERROR = {20: 9.1e-3, 60: 5.3e-3, 200: 1.1e-3, 1000: 2.7e-4}
# An oblique impact that sticks slides until it rolls, with 5/7 of its speed whatever happened in between (angular momentum about the
# contact), so that OBLIQUE_ERROR says nothing about it. Error of the way that it rolls over that of e_eff^2 at as many steps: 1.7 in
# LIGGGHTS (25 um, 20 steps, q = 4e-4), rounded up; tests/application/test_sticking_way.py.
STICKING_SHARE = 2.0
# Lightly damped `jkr/simplified` sticks at speeds to which adhesion adds much: errors at 20 steps over those of e = 0.86; there, table
# of other restitution coefficients.
LIGHT_DAMPING = {0.86: 1.0, 0.9: 1.0, 0.95: 2.8, 0.99: 50.0}
# Stock `hertz` has no event correction: error of e_eff^2 times steps per collision, largest over e = 0.3 to 1, 13 phases of the first
# contact within a step and 10 to 2000 steps (plain velocity Verlet with half-step velocities, one dimension): 0.24.
STOCK_ERROR = 0.24
# With fewer the tables end, and sticking was not decided by more than 20.
FEWEST_STEPS = 20
# Square of the highest frequency of a sphere among z neighbours over that of a pair: z in a straight chain (z = 2), z/3 in cubic and
# face-centred lattices; in between for the rest, and never below the chain.
CHAIN, NEIGHBOUR_SHARE = 2.0, 1 / 2
# Skin of the neighbour lists in radii of the smallest sphere, and the part of it that may be flown in a step.
SKIN_IN_RADII, FLIGHT_SHARE = 0.2, 0.5
# Of the time in which a gas stops a sphere: half of it is where LIGGGHTS' explicit drag begins to oscillate.
DRAG_SHARE = 0.1
# LIGGGHTS takes a Young's modulus [Pa] from here on without `soft_particles`.
SOFTEST_MODULUS = 5e6


@dataclass(frozen=True, kw_only=True)
class Mode:
    """One time scale of one meeting.

    Attributes
    ----------
    name, where : str
        "collision", "normal", "sliding", "rolling", "twisting", "flight"; "Rayleigh", "equilibrium overlap" for information.
    period, limit : float
        The time itself, and the longest time step that it allows [s].
    binds : bool
        Whether the limit counts.
    formula, source : str
        As in `Decision`.
    """

    name: str
    where: str
    period: float
    limit: float
    binds: bool
    formula: str
    source: str


@dataclass(frozen=True, kw_only=True)
class TimeStep:
    """The time step that was chosen.

    Attributes
    ----------
    value : float
        [s], three digits, rounded down.
    steps_per_collision : float
        Of the shortest collision, in steps of `value`.
    error : float
        Estimated error of e_eff^2 or of v/speed at that resolution.
    limiting : Mode
        What it is bound by.
    modes : tuple of Mode
        All of them.
    """

    value: float
    steps_per_collision: float
    error: float
    limiting: Mode
    modes: tuple[Mode, ...]


def choose(situation: Situation, decisions: tuple[Decision, ...], modulus_ratio: float, max_error: float) -> TimeStep:
    """Longest time step that keeps a quarter of `max_error` and every stability limit.

    Parameters
    ----------
    situation, decisions
        What may happen, what is simulated.
    modulus_ratio : float
        q = E_mod/E.
    max_error : float
        Of the result, as in `effects.decide`.
    """
    found = modes(situation, decisions, modulus_ratio, max_error)
    limiting = min((mode for mode in found if mode.binds), key=lambda mode: mode.limit)
    unit = 10.0 ** (math.floor(math.log10(limiting.limit)) - 2)
    value = float(f"{math.floor(limiting.limit / unit * (1 + 1e-12)) * unit:.3g}")
    shortest = min(mode.period for mode in found if mode.name == "collision")
    return TimeStep(
        value=value, steps_per_collision=shortest / value, error=error(situation, decisions, shortest / value),
        limiting=limiting, modes=found,
    )  # fmt: skip


def error(situation: Situation, decisions: tuple[Decision, ...], steps_per_collision: float) -> float:
    """Estimated largest error of a collision [-]: of e_eff^2, and of velocities and spins over the impact speed where it is oblique.

    The second only where impacts are the result: beds and agglomerates forget the spin after a single one.
    """
    if not on(decisions, "adhesion"):
        normal = STOCK_ERROR / steps_per_collision
    else:
        fast = any(meeting.speed > FASTEST * _sticking_speed(meeting, decisions) for meeting in situation.meetings)
        normal = _interpolated(NORMAL_ERROR, steps_per_collision) * _light_damping(situation, decisions) * (FAST_SHARE if fast else 1.0)
    if not (situation.about_single_impacts and on(decisions, "sliding")):
        return normal
    aslant = [meeting for meeting in situation.meetings if meeting.tangential_speed > 0]
    if any(meeting.speed > _sticking_speed(meeting, decisions) for meeting in aslant):
        return max(normal, _interpolated(OBLIQUE_ERROR, steps_per_collision))
    return STICKING_SHARE * normal if aslant else normal


def _sticking_speed(meeting: Meeting, decisions: tuple[Decision, ...]) -> float:
    pair = collisions.softened(meeting, 1.0, adhesion=on(decisions, "adhesion"))
    return collisions.sticking_speed(pair, "jkr" if on(decisions, "neck") else "jkr/simplified")


def per_collision(situation: Situation, decisions: tuple[Decision, ...], max_error: float) -> int:
    """Steps per collision that keep a quarter of `max_error`, 20 at least."""
    allowed, few, many = STEP_SHARE * max_error, FEWEST_STEPS, FEWEST_STEPS
    while error(situation, decisions, many) > allowed:
        few, many = many, 2 * many
    while many - few > 1:
        middle = (few + many) // 2
        few, many = (middle, many) if error(situation, decisions, middle) > allowed else (few, middle)
    return many


def modes(situation: Situation, decisions: tuple[Decision, ...], modulus_ratio: float, max_error: float) -> tuple[Mode, ...]:
    """Every time scale of every meeting, with the time step that it allows."""
    steps = per_collision(situation, decisions, max_error)
    return tuple(mode for meeting in situation.meetings for mode in _modes(situation, meeting, decisions, modulus_ratio, steps))


def stiffening(situation: Situation) -> float:
    """Square of the highest frequency among neighbours over that of one pair [-]; 1 where spheres touch one at a time."""
    return max(CHAIN, NEIGHBOUR_SHARE * situation.contacts_per_particle) if situation.many_contacts else 1.0


def _modes(situation: Situation, meeting: Meeting, decisions: tuple[Decision, ...], q: float, steps: int) -> list[Mode]:
    adhesion = on(decisions, "adhesion")
    pair = collisions.softened(meeting, q, adhesion=adhesion, originals=on(decisions, "original_limits"))
    if not on(decisions, "damping"):
        pair = replace(pair, restitution_coefficient=1.0)
    radius = max(contact_laws.maximum_contact_radius(pair, meeting.speed), _radius_under_weight(situation, pair))
    time = timestep.collision_time(pair, meeting.speed)
    found = [
        Mode(
            name="collision", where=meeting.label, period=time, limit=time / steps, binds=True,
            formula=f"min(2.868 (m^2/(R E^2 v))^(1/5), 2 pi sqrt(m/(1.2 E a_0)))/{steps}",
            source="Hertz; Haervig 2017, eqs 7-9; docs/accuracy-and-cost.md",
        )
    ]  # fmt: skip
    for name, period, ratio, source in _periods(meeting, pair, decisions, radius):
        limit = STABLE_FRACTION * timestep.verlet_limit(period, ratio) / math.sqrt(stiffening(situation))
        formula = f"{STABLE_FRACTION:g} (sqrt(1 + zeta^2) - zeta) T/pi at the deepest contact"
        formula += f", /sqrt({stiffening(situation):g}) among neighbours" if situation.many_contacts else ""
        found.append(Mode(name=name, where=meeting.label, period=period, limit=limit, binds=True, formula=formula, source=source))
    return [*found, *_information(meeting, pair)]


def _periods(meeting: Meeting, pair: PairProperties, decisions: tuple[Decision, ...], radius: float):
    """(name, period, damping ratio, source) of the oscillations that the deck has."""
    period = timestep.normal_period(pair, radius)
    # Event correction takes normal damping at the full step, which leaves the limit of the undamped oscillation.
    ratio = 0.0 if on(decisions, "adhesion") else timestep.normal_damping_ratio(pair, radius, period)
    yield "normal", period, ratio, "Haervig 2017, eqs 8-11"
    if on(decisions, "sliding"):
        period = timestep.sliding_period(pair, radius)
        yield "sliding", period, timestep.tangential_damping_ratio(pair, radius, period), "Haervig 2017, eqs 14-16"
    if on(decisions, "rolling") and pair.surface_energy > 0:
        share = timestep.spin_share(meeting.radii, collisions.masses(meeting))
        yield "rolling", timestep.rolling_period(pair, radius, share), 0.0, "Haervig 2017, eq. 21"
    if on(decisions, "twisting") and pair.surface_energy > 0:
        period = timestep.twisting_period(pair, radius)
        yield "twisting", period, timestep.tangential_damping_ratio(pair, radius, period), "Chen 2019, eq. 1c"


def _information(meeting: Meeting, pair: PairProperties) -> list[Mode]:
    speed, smallest = math.hypot(meeting.speed, meeting.tangential_speed), min(meeting.radii)
    crossing = SKIN_IN_RADII * smallest / speed
    modulus = contact_laws.particle_modulus(pair.effective_modulus, meeting.poissons_ratio)
    rayleigh = min(
        timestep.rayleigh_time(radius, density, modulus, meeting.poissons_ratio)
        for radius, density in zip(meeting.radii, meeting.densities, strict=True)
    )
    found = [
        Mode(name="flight", where=meeting.label, period=crossing, limit=FLIGHT_SHARE * crossing, binds=True,
             formula=f"{FLIGHT_SHARE:g} {SKIN_IN_RADII:g} r/v", source="skin of the neighbour lists"),
        Mode(name="drag", where=meeting.label, period=meeting.drag_time, limit=DRAG_SHARE * meeting.drag_time,
             binds=math.isfinite(meeting.drag_time), formula=f"{DRAG_SHARE:g} m/(6 pi viscosity r)", source="Stokes; taken explicitly"),
        Mode(name="Rayleigh", where=meeting.label, period=rayleigh, limit=rayleigh, binds=False,
             formula="pi r sqrt(rho/G)/(0.1631 nu + 0.8766)", source="LIGGGHTS, fix check/timestep/gran; for comparison"),
    ]  # fmt: skip
    found = [mode for mode in found if math.isfinite(mode.period)]
    if pair.surface_energy > 0:
        time = collisions.equilibrium_overlap(pair) / meeting.speed
        found.append(
            Mode(name="equilibrium overlap", where=meeting.label, period=time, limit=time, binds=False,
                 formula="delta_0/v_n", source="Chen 2019, eq. 16; flown past in a fast impact, which resolves its own depth")
        )  # fmt: skip
    return found


def _radius_under_weight(situation: Situation, pair: PairProperties) -> float:
    """Contact radius under the largest weight [m]: Hertz' part of Haervig 2017, eq. 8."""
    return (3 * situation.weight_carried * pair.effective_radius / (4 * pair.effective_modulus)) ** (1 / 3)


def _interpolated(table: dict[int, float], steps: float) -> float:
    """Between the measured numbers a straight line on log axes; beyond them of second order, the order that was measured."""
    known = np.log(list(table))
    at = math.log(steps)
    value = float(np.interp(at, known, np.log(list(table.values()))))
    return math.exp(value - 2 * (min(0.0, at - known[0]) + max(0.0, at - known[-1])))


def _light_damping(situation: Situation, decisions: tuple[Decision, ...]) -> float:
    """Factor on the error of `jkr/simplified` with little damping, near its sticking speed."""
    if on(decisions, "neck"):
        return 1.0
    e = max(meeting.pair.restitution_coefficient for meeting in situation.meetings) if on(decisions, "damping") else 1.0
    lightness = [-math.log(1 - value) for value in LIGHT_DAMPING]
    return float(np.exp(np.interp(-math.log(max(1 - e, 1e-4)), lightness, np.log(list(LIGHT_DAMPING.values())))))
