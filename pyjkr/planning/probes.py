"""What `pyjkr plan --verify` runs for a situation: impacts, limits of contacts that last, pulls, a compressed stack.

Covers no law: the probes are in `probe_impacts` and `probe_contacts`. Assumes that a scene goes wrong where its fastest, slowest or most
loaded contact does, and next to the sticking speed. What the plan does not promise is run and shown, but not judged.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from pyjkr.planning import collisions, measures, probe_contacts, probe_impacts, variants
from pyjkr.planning.probe_parts import Probe
from pyjkr.planning.situation import Meeting, Situation

# Energy, in parts of the impact's and in units of max_error, with which a sphere leaves at the probe just above the sticking speed: a
# plan that errs by max_error still decides it rightly. The probe below is as far from it.
CLEAR = 2.0
# Steps of a reference at most: some ten seconds. What rolls on for longer is not followed until it rests.
MOST_STEPS = 3e6


def probes(situation: Situation, max_error: float, rolling_damping: float = 0.0) -> list[Probe]:
    """Everything worth probing in a situation, whatever the plan for it leaves out.

    Parameters
    ----------
    situation : Situation
        Its meetings, loads and what the result must be right about.
    max_error : float
        Of the plan: how near to the sticking speed a decision may be asked for.
    rolling_damping : float
        Setting of the scene for `rolling_friction krijt`, over critical.
    """
    found: list[Probe] = []
    for meeting in situation.meetings:
        found += _impacts(situation, meeting, max_error, rolling_damping)
        found += _contacts(situation, meeting)
    pairs = [meeting for meeting in situation.meetings if len(meeting.radii) == 2]
    if situation.many_contacts and measures.lasts(situation) and pairs:
        # The softest contact of the scene for its size: lowest E R.
        worst = min(pairs, key=lambda meeting: meeting.pair.effective_modulus * meeting.pair.effective_radius)
        if situation.weight_carried > 0 or worst.pair.surface_energy > 0:
            found.append(probe_contacts.stack(worst, situation.weight_carried))
    return found


def not_probed(situation: Situation) -> tuple[str, ...]:
    """What the plan promises and no probe looks at, one line each.

    Parameters
    ----------
    situation : Situation
        As for `probes`.
    """
    found = []
    if situation.spheres_across > 1:
        found.append("what is left of a body of many spheres that breaks: a few spheres do not tell; run the scene in both ways")
    found += [
        f"{meeting.label}: the way rolled until at rest takes more than {MOST_STEPS:g} steps of the reference"
        for meeting in situation.meetings
        if sticks_and_rolls(situation, meeting) and not _followed(situation, meeting)
    ]
    return tuple(found)


def sticking_probes(meeting: Meeting, max_error: float) -> tuple[float, ...]:
    """Speeds just below and above the sticking speed of the real material [m/s], where both are speeds of the scene.

    At the sticking speed itself the smallest error decides; there is nothing to ask. Above, real spheres leave with 2 `max_error`
    of the energy; below it is by the same factor slower.

    Parameters
    ----------
    meeting : Meeting
        Of the scene.
    max_error : float
        Of the plan.
    """
    pair = meeting.pair
    sticks = collisions.sticking_speed(pair, "jkr")

    def excess(speed: float) -> float:
        return float(collisions.energy_kept(pair, "jkr", np.asarray(speed))) - CLEAR * max_error

    if not meeting.slowest_speed < sticks < meeting.speed or excess(meeting.speed) < 0:
        return ()
    above = brentq(excess, sticks, meeting.speed)
    below = sticks**2 / above
    return (below, above) if below > meeting.slowest_speed else (above,)


def sticks_and_rolls(situation: Situation, meeting: Meeting) -> bool:
    """Whether the result is where a sphere rests that hits a wall obliquely, sticks and rolls on."""
    return (
        situation.about_single_impacts
        and len(meeting.radii) == 1
        and meeting.tangential_speed > 0
        and math.isfinite(meeting.critical_rolling)
        and meeting.speed <= collisions.sticking_speed(meeting.pair, "jkr")
    )


def _followed(situation: Situation, meeting: Meeting) -> bool:
    """Whether the reference can follow a sphere that rolls until it rests."""
    real = variants.reference(situation, meeting)
    return probe_impacts.watched(meeting, real) < MOST_STEPS * real.time_step


def _impacts(situation: Situation, meeting: Meeting, max_error: float, rolling_damping: float) -> Iterator[Probe]:
    for speed in sorted({meeting.slowest_speed, *sticking_probes(meeting, max_error), meeting.speed}):
        yield probe_impacts.impact(meeting, speed, 0.0)
    if sticks_and_rolls(situation, meeting) and _followed(situation, meeting):
        yield probe_impacts.way(meeting, rolling_damping)
    elif meeting.tangential_speed > 0:
        yield probe_impacts.impact(meeting, meeting.speed, meeting.tangential_speed, promised=situation.about_single_impacts)


def _contacts(situation: Situation, meeting: Meeting) -> Iterator[Probe]:
    """Limits of sliding, rolling and twisting, and the pull, of contacts with adhesion."""
    if meeting.pair.surface_energy == 0:
        return
    rolls = math.isfinite(meeting.critical_rolling)
    if sticks_and_rolls(situation, meeting):
        yield probe_contacts.yields(meeting, "rolling", 0.0)
    elif measures.lasts(situation):
        floor = probe_contacts.moment_of_loads(meeting, measures.load(situation))
        promised = situation.about != "impact"
        if meeting.friction_coefficient > 0:
            yield probe_contacts.yields(meeting, "sliding", floor, promised=promised)
        if rolls:
            yield probe_contacts.yields(meeting, "rolling", floor, promised=promised)
        if rolls and meeting.friction_coefficient > 0 and situation.many_contacts:
            yield probe_contacts.yields(meeting, "twisting", floor, promised=promised)
    if situation.pulling_force > 0:
        yield probe_contacts.pull(meeting, situation.pulling_force)
