"""What softening changes in oblique impacts, which are not similar as normal ones are: upper bounds, cause by cause.

Covers Haervig 2017, secs 2.1 and 3.2 (sliding and rolling at reduced stiffness) and Chen 2019, eqs 11-12 (real limits), calibrated with
the oracle. Assumes spheres without spin before the impact.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pyjkr import scaling, timestep
from pyjkr.contact import PairProperties
from pyjkr.planning import collisions
from pyjkr.planning.decision import Decision
from pyjkr.planning.effects import on
from pyjkr.planning.situation import Meeting, Situation

# Change of v_t or r omega over the tangential speed of impact, per overlap/r: the force acts at r - overlap/2; measured bound,
# docs/lever-arm.md.
LEVER_SHARE = 0.5
# Change of any speed after an oblique impact of two spheres over the impact speed, per angle by which the line of centres turns
# more. Largest of 4 to 40 m/s, 20 to 70 degrees, q = 0.3 and 0.03, equal spheres and 1:4, lever arm r, no rolling, in the oracle:
# 0.61 (`test_oblique_share...` of tests/planning/test_softening.py).
TURNING_SHARE = 0.65
# Change of v_t and r omega of an impact that sticks and rolls, over v_t, per square of the stuck period over the time in which it is
# stopped: in the oracle 0.08 to 0.29 for q = 0.1 to 0.001 (1 um, 1 m/s, 60 degrees, 15 to 60 periods).
SETTLING_SHARE = 0.35
# It holds down to so many periods; with 4.5 the way rolled was wrong by twice the estimate (25 um, q = 1e-4), so fewer count as lost.
FEWEST_PERIODS = 8


def change(situation: Situation, decisions: tuple[Decision, ...], modulus_ratio: float) -> dict[str, float]:
    """Change of velocities and spins after oblique impacts, over the impact speed, by cause; upper bounds.

    Normal motion is exactly similar. Not similar are the lever arm r - overlap/2, the angle by which the line of centres of two
    spheres turns, rolling resistance, and limits with real surface energy (docs/lever-arm.md).

    Parameters
    ----------
    situation, decisions
        What may happen, what is simulated.
    modulus_ratio : float
        q.
    """
    worst: dict[str, float] = {}
    for meeting in situation.meetings:
        for speed in dict.fromkeys((meeting.slowest_speed, meeting.speed)) if meeting.tangential_speed > 0 else ():
            parts = _oblique_parts(replace(meeting, speed=speed, slowest_speed=speed), decisions, modulus_ratio)
            worst = parts if sum(parts.values()) > sum(worst.values()) else worst
    return worst


def _oblique_parts(meeting: Meeting, decisions: tuple[Decision, ...], q: float) -> dict[str, float]:
    """Of a meeting at one normal speed."""
    adhesion, originals, parts = on(decisions, "adhesion"), on(decisions, "original_limits"), {}
    real = collisions.softened(meeting, 1.0, adhesion=adhesion)
    soft = collisions.softened(meeting, q, adhesion=adhesion, originals=originals)
    share = meeting.tangential_speed / math.hypot(meeting.speed, meeting.tangential_speed)
    # Without originals LIGGGHTS takes xi_crit of Krijt from the modified a_0 ~ q^(-1/5).
    limit = meeting.critical_rolling * (1.0 if originals else scaling.contact_radius_factor(q))
    sticks = meeting.speed <= collisions.sticking_speed(real, "jkr")
    if on(decisions, "sliding") and meeting.friction_coefficient > 0:
        deeper = collisions.overlap_in_impact(soft, meeting.speed) - collisions.overlap_in_impact(real, meeting.speed)
        parts["lever arm"] = LEVER_SHARE * deeper / min(meeting.radii) * share
        # What sticks slides until it rolls, whatever the limit.
        if originals and on(decisions, "sliding_adhesion") and not sticks:
            kept = collisions.sliding_adhesion_change(meeting, soft, real.pull_off_force)
            parts["real sliding limit"] = kept - collisions.sliding_adhesion_change(meeting, real)
    if sticks:
        # It rolls on for a time that does not scale: a smaller moment stops it later.
        moment = scaling.force_factor(q) * (1.0 if originals else scaling.contact_radius_factor(q))
        if on(decisions, "rolling"):
            known = _settling(meeting, soft) * FEWEST_PERIODS <= 1
            change = _settling(meeting, soft) ** 2 - _settling(meeting, real) ** 2
            parts["settling"] = share * (SETTLING_SHARE * change if known or change == 0 else 1.0)
            parts |= {} if originals else {"scaled rolling": share * (1 - moment)}
        return parts
    parts["turning"] = TURNING_SHARE * (collisions.turning(meeting, soft) - collisions.turning(meeting, real))
    if on(decisions, "rolling") and adhesion:
        parts["rolling"] = collisions.rolling_change(meeting, soft, limit) - collisions.rolling_change(meeting, real)
    return parts


def _settling(meeting: Meeting, pair: PairProperties) -> float:
    """Stuck period over the time in which rolling resistance stops the lightest sphere, m r v_t/(4 F_C xi_crit)."""
    if not math.isfinite(meeting.critical_rolling):
        return 0.0
    lightest = min(mass * radius for mass, radius in zip(collisions.masses(meeting), meeting.radii, strict=True))
    moment = 4 * meeting.pair.pull_off_force * meeting.critical_rolling
    return timestep.stuck_period(pair) * moment / (lightest * meeting.tangential_speed)
