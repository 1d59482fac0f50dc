"""The numbers that decide on effects: for each the error of the result that leaving it out would make, estimated.

Covers impacts (parts of the energy for e_eff^2, of the speed for velocities and spins) and contacts that last (forces and moments over
the loads that act). Sources: Haervig 2017, Chen 2019. Assumes the real material; each measure takes the worst meeting.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pyjkr.planning import collisions
from pyjkr.planning.situation import Effect, Meeting, Situation

# Energy to pull a contact from equilibrium to its end, in units of (w^5 R^4/E^2)^(1/3): with the neck to rupture, and to zero overlap
# where `jkr/simplified` ends; integrals of Haervig 2017, eqs 8-10 (its eq. 23), and Chen 2019, eq. 6.
ENERGY_TO_RUPTURE, ENERGY_TO_ZERO_OVERLAP = 11.6945859, 4.60238997
# Pull that `jkr/simplified` misses of F_C: it ends at 8/9; Haervig 2017, sec. 2.1.
MISSING_PULL = 1 / 9
# Stiffness reduction at which original limits are judged, before one is chosen.
JUDGED_RATIO = 0.01
# Rolling and twisting by so much rearrange a cluster [rad]; Dominik and Tielens 1997 take the energy of a quarter turn for rolling.
QUARTER_TURN = math.pi / 2


@dataclass(frozen=True)
class Measure:
    """One number of one effect, as in `Decision`."""

    number: float
    measure: str
    formula: str
    source: str
    where: str = ""


def _worst(situation: Situation, number: Callable[[Meeting], float]) -> tuple[float, str]:
    """Largest number of all meetings, and the label of its meeting."""
    return max(((number(meeting), meeting.label) for meeting in situation.meetings), key=lambda each: each[0])


def lasts(situation: Situation) -> bool:
    """Whether loads on contacts that stay are part of the result; of an impact that sticks only that it does."""
    return situation.about != "impact" or (situation.lasting and situation.many_contacts)


def load(situation: Situation) -> float:
    """Load on a lasting contact [N]: half of the largest weight, since weights grow evenly with depth; the pull; 0 for none."""
    return max(situation.weight_carried / 2, situation.pulling_force)


def _over(force: float, acting: float) -> float:
    """Force over what acts: infinite where nothing does."""
    return 0.0 if force == 0 else force / acting if acting > 0 else math.inf


def adhesion_in_impacts(situation: Situation) -> Measure:
    def lost(meeting: Meeting) -> float:
        plain = meeting.pair.restitution_coefficient**2
        return float(np.max(np.abs(plain - collisions.energy_kept(meeting.pair, "jkr", collisions.speeds(meeting)))))

    return _measured(
        _worst(situation, lost),
        "change of e_eff^2 by adhesion, at the slowest impact",
        "e^2 - e_eff^2(v)",
        "Chen 2019, eqs 5-9, integrated (calibrate.collision)",
    )


def adhesion_that_lasts(situation: Situation) -> Measure:
    def share(meeting: Meeting) -> float:
        # What lies free is held by its own weight alone, however much rests on others.
        own = min(collisions.masses(meeting)) * situation.gravity
        acting = max(min(load(situation), own) if own > 0 else load(situation), situation.pulling_force)
        return _over(meeting.pair.pull_off_force, acting)

    found = _worst(situation, share) if lasts(situation) else (0.0, "")
    return _measured(found, "pull-off force / weight or pull", "F_C/F, F = max(m g of the lighter, pull)", "Haervig 2017, eq. 8 (F_C)")


def neck_in_impacts(situation: Situation) -> Measure:
    def change(meeting: Meeting) -> float:
        if meeting.pair.surface_energy == 0:
            return 0.0
        speed = collisions.speeds(meeting)
        full, simplified = (collisions.energy_kept(meeting.pair, law, speed) for law in ("jkr", "jkr/simplified"))
        return float(np.max(np.abs(full - simplified)))

    return _measured(
        _worst(situation, change),
        "difference of e_eff^2, jkr and jkr/simplified",
        "e_eff^2(jkr) - e_eff^2(jkr/simplified), largest from slowest to fastest",
        "Haervig 2017, eqs 8-13; Chen 2019, eqs 5-9 (calibrate.collision)",
    )


def neck_that_lasts(situation: Situation) -> Measure:
    acting = load(situation)
    if not lasts(situation):
        return Measure(0.0, "no contact lasts", "", "")
    if situation.about == "strength":
        found = _worst(situation, lambda meeting: MISSING_PULL if meeting.pair.surface_energy > 0 else 0.0)
        return _measured(found, "pull-off force that jkr/simplified misses", "1 - 8/9", "Haervig 2017, sec. 2.1")
    share = 1 - ENERGY_TO_ZERO_OVERLAP / ENERGY_TO_RUPTURE
    found = _worst(situation, lambda meeting: share * min(1.0, _over(meeting.pair.pull_off_force, acting)))
    return _measured(found, "energy of breaking that jkr/simplified misses", "(1 - 4.602/11.695) min(1, F_C/F)", "Haervig 2017, eq. 23")


def sliding_in_impacts(situation: Situation) -> Measure:
    found = _worst(situation, lambda meeting: collisions.sliding_change(meeting, meeting.pair))
    return _measured(
        found,
        "change of spin by friction / impact speed",
        "(5/2) min(mu((1+e) m v_n + 2 F_C t_c), (4/7) m v_t)/(m_light v)",
        "Haervig 2017, eqs 6, 14-17",
    )


def sliding_that_lasts(situation: Situation) -> Measure:
    many = situation.many_contacts or lasts(situation)
    found = _worst(situation, lambda meeting: meeting.friction_coefficient) if many else (0.0, "")
    return _measured(found, "tangential load that contacts carry / normal load", "mu", "Haervig 2017, eq. 17")


def sliding_adhesion_in_impacts(situation: Situation) -> Measure:
    found = _worst(situation, lambda meeting: collisions.sliding_adhesion_change(meeting, meeting.pair))
    return _measured(
        found,
        "change of spin by 2 F_C in the limit / impact speed",
        "(5/2) min(2 mu F_C t_c, (4/7) m v_t)/(m_light v)",
        "Haervig 2017, eq. 17",
    )


def sliding_adhesion_that_lasts(situation: Situation) -> Measure:
    acting = load(situation)

    def share(meeting: Meeting) -> float:
        return _over(2 * meeting.pair.pull_off_force * meeting.friction_coefficient, acting)

    found = _worst(situation, share) if lasts(situation) else (0.0, "")
    return _measured(found, "adhesive part of the sliding limit / load that lasts", "2 mu F_C/F", "Haervig 2017, eq. 17")


def rolling_in_impacts(situation: Situation) -> Measure:
    found = _worst(situation, lambda meeting: collisions.rolling_change(meeting, meeting.pair))
    return _measured(
        found,
        "change of spin by rolling resistance / impact speed",
        "(5/2) 4 F_C s^(3/2) xi t_c/(m r v), xi <= xi_crit; v_t/v where it sticks",
        "Haervig 2017, eqs 20-22",
    )


def rolling_that_lasts(situation: Situation) -> Measure:
    return _moment_that_lasts(
        situation,
        "rolling",
        lambda meeting: 4 * meeting.pair.pull_off_force * meeting.critical_rolling,
        lasts(situation),
        "4 F_C xi_crit",
        "Haervig 2017, eqs 18, 21; Chen 2019, eq. 11; quarter turn: Dominik and Tielens 1997",
    )


def twisting_that_lasts(situation: Situation) -> Measure:
    def moment(meeting: Meeting) -> float:
        pair = meeting.pair
        return 2 / 3 * pair.equilibrium_contact_radius * 2 * pair.pull_off_force * meeting.friction_coefficient

    # One sphere on a wall, or two, are not turned about the line of their centres by forces through them.
    return _moment_that_lasts(
        situation, "twisting", moment, lasts(situation) and situation.many_contacts, "(2/3) a_0 2 mu F_C", "Chen 2019, eqs 1c, 3b"
    )


def _moment_that_lasts(
    situation: Situation, name: str, moment: Callable[[Meeting], float], happens: bool, formula: str, source: str
) -> Measure:
    """A moment against the load times the radius; without a load, its energy over a quarter turn against the slowest impact."""
    if not happens:
        return Measure(0.0, f"no contact lasts that would be loaded by {name}", "", "")
    acting = load(situation)
    if acting > 0:
        found = _worst(situation, lambda meeting: moment(meeting) / (acting * max(meeting.radii)))
        return _measured(found, f"moment of {name} / moment of the load", f"{formula}/(F r)", source)

    def energy(meeting: Meeting) -> float:
        return moment(meeting) * QUARTER_TURN / (0.5 * meeting.pair.effective_mass * meeting.slowest_speed**2)

    found = _worst(situation, energy)
    return _measured(found, f"energy of {name} a quarter turn / slowest impact", f"{formula} pi/2/(m v^2/2)", source)


def gravity_in_flight(situation: Situation) -> Measure:
    def gained(meeting: Meeting) -> float:
        return 2 * situation.gravity * situation.falling_length / meeting.slowest_speed**2

    return _measured(_worst(situation, gained), "energy of falling / slowest impact", "2 g L/v^2", "energy")


def gravity_that_lasts(situation: Situation) -> Measure:
    if not lasts(situation) or situation.gravity == 0:
        return Measure(0.0, "no weight on a contact that lasts", "", "")

    def weight(meeting: Meeting) -> float:
        acting = max(situation.weight_carried, max(collisions.masses(meeting)) * situation.gravity)
        return math.inf if meeting.pair.surface_energy == 0 else acting / meeting.pair.pull_off_force

    return _measured(_worst(situation, weight), "weight / pull-off force", "m g/F_C", "Haervig 2017, sec. 6")


def damping_in_impacts(situation: Situation) -> Measure:
    # In both laws, for the neck may be left out: without it nothing sticks that is not damped.
    def change(meeting: Meeting) -> float:
        speed = collisions.speeds(meeting)
        laws = ("jkr", "jkr/simplified")
        kept = [[collisions.energy_kept(meeting.pair, law, speed, e) for e in (None, 1.0)] for law in laws]
        return float(max(np.max(np.abs(elastic - damped)) for damped, elastic in kept))

    return _measured(
        _worst(situation, change),
        "energy that damping takes / impact energy",
        "e_eff^2(e = 1) - e_eff^2(e)",
        "Haervig 2017, eqs 11-13; Chen 2019, eqs 5-9",
    )


def damping_that_lasts(situation: Situation) -> Measure:
    def share(meeting: Meeting) -> float:
        swings = max(1.0, situation.time / collisions.contact_time(meeting.pair, meeting.speed))
        return -math.expm1(2 * swings * math.log(meeting.pair.restitution_coefficient))

    found = _worst(situation, share) if lasts(situation) else (0.0, "")
    return _measured(found, "energy that damping takes of oscillations that last", "1 - e^(2 t/t_c)", "Haervig 2017, eq. 12")


def original_limits(situation: Situation) -> Measure:
    # The moment of rolling goes as F_C: scaled with the surface energy it is lost by 1 - q^(2/5). For what lasts that is all. In an
    # oblique impact that rebounds it is the other way round: real limits break the similarity, 10 % of v_t and 26 % of the spin at
    # q = 0.01 (docs/lever-arm.md). One that sticks rolls on and is stopped by the real moment.
    lost, source = 1 - JUDGED_RATIO**0.4, "Haervig 2017, sec. 3.2; Chen 2019, eqs 11-12"
    strength = f"strength of rolling and sliding lost without it, at E_mod/E = {JUDGED_RATIO:g}"
    if situation.about != "impact":
        return Measure(lost, strength, "1 - q^(2/5)", source)

    def stuck(meeting: Meeting) -> float:
        sticks = meeting.slowest_speed <= collisions.sticking_speed(meeting.pair, "jkr")
        return lost if sticks and meeting.tangential_speed > 0 else 0.0

    found = _worst(situation, stuck)
    if found[0] > 0:
        return _measured(found, f"an oblique impact sticks and rolls on: {strength}", "1 - q^(2/5)", source)
    return Measure(
        0.0,
        "not where impacts rebound: it changes oblique ones by 0.26 of the spin at E_mod/E = 0.01",
        "by what the scene is about",
        "docs/lever-arm.md, last table (oracle)",
    )


def _measured(found: tuple[float, str], measure: str, formula: str, source: str) -> Measure:
    return Measure(found[0], measure, formula, source, found[1])


# The measures of every effect; the largest decides.
OF: dict[Effect, tuple[Callable[[Situation], Measure], ...]] = {
    "adhesion": (adhesion_in_impacts, adhesion_that_lasts, sliding_adhesion_in_impacts, rolling_in_impacts),
    "neck": (neck_in_impacts, neck_that_lasts),
    "sliding": (sliding_in_impacts, sliding_that_lasts),
    "sliding_adhesion": (sliding_adhesion_in_impacts, sliding_adhesion_that_lasts),
    "rolling": (rolling_in_impacts, rolling_that_lasts),
    "twisting": (twisting_that_lasts,),
    "damping": (damping_in_impacts, damping_that_lasts),
    "gravity": (gravity_in_flight, gravity_that_lasts),
    "original_limits": (original_limits,),
}
