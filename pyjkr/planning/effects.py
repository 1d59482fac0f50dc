"""Which effects a scene needs: each has a number, the error that leaving it out would make, against a threshold.

Covers every law of both papers by the estimates of `measures`. "auto" switches on where the number exceeds a quarter of `max_error`;
wishes force. Assumes that an effect which needs another one is off where that is off.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pyjkr.errors import PlanError
from pyjkr.planning import measures
from pyjkr.planning.budget import EFFECT_SHARE
from pyjkr.planning.decision import Decision
from pyjkr.planning.measures import Measure
from pyjkr.planning.situation import Effect, Situation

# What an effect builds on; of `original_limits` one of two is enough.
NEEDS: dict[Effect, tuple[Effect, ...]] = {
    "adhesion": (),
    "neck": ("adhesion",),
    "sliding": (),
    "sliding_adhesion": ("adhesion", "sliding"),
    "rolling": ("adhesion",),
    "twisting": ("adhesion", "rolling"),
    "damping": (),
    "gravity": (),
    "original_limits": ("adhesion",),
}
# Effects that only a property of the material gives; without it not even a wish helps.
PROPERTY: dict[Effect, str] = {
    "adhesion": "surface_energy is 0",
    "sliding": "friction_coefficient is 0",
    "gravity": "gravity is 0",
    "damping": "restitution_coefficient is 1",
}


def decide(situation: Situation, max_error: float) -> tuple[Decision, ...]:
    """Decide on every effect, in the order of `situation.EFFECTS`.

    Parameters
    ----------
    situation : Situation
        What may happen.
    max_error : float
        Largest error of the result: a part of the impact's energy, of its speed, or of the force that holds.

    Raises
    ------
    PlanError
        Where a wish contradicts another wish or a property of the scene.
    """
    made: dict[Effect, Decision] = {}
    for effect, needs in NEEDS.items():
        found = [measure(situation) for measure in measures.OF[effect]]
        worst = max(found, key=lambda each: each.number)
        missing = next((need for need in needs if not made[need].on), None)
        if effect == "original_limits" and not missing and not (made["sliding_adhesion"].on or made["rolling"].on):
            missing = "rolling"
        made[effect] = _decision(situation, effect, worst, EFFECT_SHARE * max_error, missing)
    return tuple(made[effect] for effect in NEEDS)


def on(decisions: tuple[Decision, ...], effect: Effect) -> bool:
    """Whether an effect is simulated."""
    return next(decision.on for decision in decisions if decision.effect == effect)


def _decision(situation: Situation, effect: Effect, worst: Measure, threshold: float, missing: Effect | None) -> Decision:
    wish = situation.wishes.get(effect, "auto")
    decision = Decision(
        effect=effect, on=worst.number > threshold, number=worst.number, threshold=threshold, measure=worst.measure,
        formula=worst.formula, source=worst.source, where=worst.where,
    )  # fmt: skip
    # Rolling without adhesion is the stock model epsd2, on wish only: its coefficient is not a property of a JKR contact.
    stock_rolling = effect == "rolling" and missing == "adhesion" and wish == "on"
    if missing and not stock_rolling:
        if wish == "on":
            raise PlanError(
                f"{situation.source}: effects: {effect} = 'on' needs {missing}, which is off. Set {missing} = 'on', or {effect} = 'auto'."
            )
        return replace(decision, on=False, number=0.0, measure=f"needs {missing}, which is off", where="", forced=wish == "off")
    if wish == "on" and effect in PROPERTY and worst.number == 0 and not _given(situation, effect):
        raise PlanError(f"{situation.source}: effects: {effect} = 'on', but {PROPERTY[effect]}. Give it, or set {effect} = 'auto'.")
    if effect == "rolling" and not stock_rolling and (decision.on or wish == "on") and not _rolling_is_limited(situation):
        if wish == "on":
            raise PlanError(
                f"{situation.source}: effects: rolling = 'on' needs adhesion_hysteresis or critical_rolling_angle in every contact."
                " Give one, or set rolling = 'off'."
            )
        return replace(decision, on=False, measure=f"{worst.measure}; left out: the scene gives no limit of rolling", forced=True)
    return decision if wish == "auto" else replace(decision, on=wish == "on", forced=True)


def _given(situation: Situation, effect: Effect) -> bool:
    """Whether the scene gives the property that an effect works with."""
    given = {
        "adhesion": any(meeting.pair.surface_energy > 0 for meeting in situation.meetings),
        "sliding": any(meeting.friction_coefficient > 0 for meeting in situation.meetings),
        "gravity": situation.gravity > 0,
        "damping": any(meeting.pair.restitution_coefficient < 1 for meeting in situation.meetings),
    }
    return given[effect]


def _rolling_is_limited(situation: Situation) -> bool:
    return all(math.isfinite(meeting.critical_rolling) for meeting in situation.meetings if meeting.pair.surface_energy > 0)
