"""`Situation` -> `ApplicationPlan`: which effects, how soft, which time step, and what the estimates say about the error.

Covers no law of its own. Refuses what no stiffness puts right: contacts beyond JKR, overlaps beyond small strain, forces that the
real contact does not hold. Assumes that the situation's speeds and forces are upper bounds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pyjkr import contact as contact_laws
from pyjkr import scaling
from pyjkr.errors import PlanError
from pyjkr.limits import NEGLIGIBLE_FRACTION
from pyjkr.planning import collisions, effects, oblique, softening, steps
from pyjkr.planning.decision import Decision, Limit
from pyjkr.planning.effects import on
from pyjkr.planning.situation import Effect, Meeting, Situation
from pyjkr.planning.steps import TimeStep
from pyjkr.planning.styles import Styles, styles

# Where the scene says nothing else.
DEFAULT_ERROR = 0.05
# Errors are parts of the impact: beyond a half nothing is left to be right about, and less is not reached by the measured tables.
LARGEST_ERROR, SMALLEST_ERROR = 0.5, 1e-5


@dataclass(frozen=True, kw_only=True)
class ApplicationPlan:
    """Everything that was decided about a scene.

    Attributes
    ----------
    situation : Situation
        What may happen.
    max_error : float
        Largest error of the result that was asked for.
    decisions : tuple of Decision
        One for each effect.
    limits : tuple of Limit
        Of the softening.
    modulus_ratio : float
        q = E_mod/E.
    binding : Limit
        The limit that decided on it.
    step : TimeStep
        With its modes.
    styles : Styles
        Contact law of the deck.
    budget : dict
        Estimated error by cause; each an upper bound.
    warnings : tuple of str
        One line each.
    """

    situation: Situation
    max_error: float
    decisions: tuple[Decision, ...]
    limits: tuple[Limit, ...]
    modulus_ratio: float
    binding: Limit
    step: TimeStep
    styles: Styles
    budget: dict[str, float]
    warnings: tuple[str, ...]

    @property
    def time_step(self) -> float:
        """[s]."""
        return self.step.value

    @property
    def steps_per_collision(self) -> float:
        """Time steps in the shortest collision."""
        return self.step.steps_per_collision

    @property
    def limiting_mode(self) -> str:
        """What binds the time step."""
        return self.step.limiting.name

    def on(self, effect: Effect) -> bool:
        """Whether an effect is simulated."""
        return on(self.decisions, effect)


def plan(situation: Situation, max_error: float = DEFAULT_ERROR) -> ApplicationPlan:
    """Decide on everything that a deck needs.

    Parameters
    ----------
    situation : Situation
        What may happen.
    max_error : float
        Largest error of the result: of e_eff^2, of speeds and spins over the impact speed, of forces that hold; each relative.

    Raises
    ------
    PlanError
        Where no deck of this law can be right.
    """
    _refuse_nonsense(situation, max_error)
    decisions = effects.decide(situation, max_error)
    _refuse_beyond_jkr(situation, decisions)
    limits = softening.limits(situation, decisions, max_error)
    modulus_ratio = softening.ratio(limits)
    step = steps.choose(situation, decisions, modulus_ratio, max_error)
    budget = _budget(situation, decisions, modulus_ratio, step)
    binding = softening.binding(limits)
    return ApplicationPlan(
        situation=situation, max_error=max_error, decisions=decisions, limits=limits, modulus_ratio=modulus_ratio, binding=binding,
        step=step, styles=styles(decisions), budget=budget,
        warnings=tuple(_warnings(situation, decisions, binding, budget, max_error)),
    )  # fmt: skip


def _refuse_nonsense(situation: Situation, max_error: float) -> None:
    if not SMALLEST_ERROR <= max_error <= LARGEST_ERROR:
        raise PlanError(
            f"{situation.source}: max_error = {max_error!r} must be within {SMALLEST_ERROR:g} and {LARGEST_ERROR:g}."
            " It is a part of the impact's energy or speed; 0.05 is usual."
        )
    if not situation.meetings:
        raise PlanError(f"{situation.source}: nothing can touch anything. Add particles, or a wall.")
    for meeting in situation.meetings:
        if not 0 < meeting.slowest_speed <= meeting.speed < math.inf:
            raise PlanError(
                f"{situation.source}: {meeting.label}: normal speeds from {meeting.slowest_speed:g} to {meeting.speed:g} m/s."
                " They must be above 0 and in this order; give a speed of the motion."
            )


def _refuse_beyond_jkr(situation: Situation, decisions: tuple[Decision, ...]) -> None:
    adhesion = on(decisions, "adhesion")
    law = "jkr" if on(decisions, "neck") else "jkr/simplified"
    for meeting in situation.meetings:
        pair = collisions.softened(meeting, 1.0, adhesion=adhesion)
        deepest = max(collisions.overlap_in_impact(pair, meeting.speed), softening.overlap_at_rest(situation, pair))
        if deepest > situation.maximum_overlap * pair.effective_radius:
            raise PlanError(
                f"{situation.source}: {meeting.label}: at {meeting.speed:g} m/s the real material presses"
                f" {deepest / pair.effective_radius:.2g} R deep, limit {situation.maximum_overlap:g} R, beyond the small strain of JKR."
                " Lower the speed, or look for a law with plasticity."
            )
        if pair.surface_energy == 0:
            continue
        tabor = scaling.tabor_number(*_tabor_arguments(meeting))
        if tabor < scaling.TABOR_OF_DMT:
            raise PlanError(
                f"{situation.source}: {meeting.label}: Tabor number {tabor:.2g} of the real material is below {scaling.TABOR_OF_DMT:g},"
                " the DMT range, where JKR does not hold (Haervig 2017, eq. 1). Take a larger or softer sphere, or a DMT model."
            )
        held = contact_laws.holding_force(pair, law)
        if situation.pulling_force > held:
            raise PlanError(
                f"{situation.source}: {meeting.label}: a pull of {situation.pulling_force:.3g} N exceeds the {held:.3g} N that the real"
                " contact holds, so that nothing stays. Lower the force, or set adhesion = 'off'."
            )


def _tabor_arguments(meeting: Meeting) -> tuple[float, float, float]:
    """Of the real material: softening raises the Tabor number and would hide a DMT contact."""
    pair = meeting.pair
    return pair.effective_radius, pair.effective_modulus, pair.surface_energy


def _budget(situation: Situation, decisions: tuple[Decision, ...], modulus_ratio: float, step: TimeStep) -> dict[str, float]:
    budget = {f"without {made.effect}": made.number for made in decisions if not made.on and made.number > 0}
    if situation.about_single_impacts:
        parts = oblique.change(situation, decisions, modulus_ratio)
        budget |= {f"softening, {cause}": value for cause, value in parts.items() if value > 0}
    return budget | {f"time step, {step.steps_per_collision:.3g} steps per collision": step.error}


def _warnings(situation: Situation, decisions: tuple[Decision, ...], binding: Limit, budget: dict[str, float], max_error: float):
    adhesive = [meeting for meeting in situation.meetings if meeting.pair.surface_energy > 0 and on(decisions, "adhesion")]
    if adhesive:
        numbers = {meeting.label: _tabor_arguments(meeting) for meeting in adhesive}
        label = min(numbers, key=lambda name: scaling.tabor_number(*numbers[name]))
        warning = scaling.tabor_warning(*numbers[label])
        if warning:
            yield f"{situation.source}: {label}: {warning}"
    for made in decisions:
        if made.forced and not made.on and made.number > made.threshold:
            yield f"{situation.source}: {made.effect} is off, though it would matter, {made.number:.2g}: {made.measure}."
    if (
        situation.about != "impact"
        and on(decisions, "original_limits")
        and any(meeting.tangential_speed > 0 for meeting in situation.meetings)
    ):
        yield (
            f"{situation.source}: real limits of rolling and sliding keep what holds and what yields; the spin after a single oblique"
            " impact may change by a quarter (docs/lever-arm.md). Set about = 'impact' where that is the result."
        )
    if binding.smallest_ratio > 1:
        yield (
            f"{situation.source}: {binding.name} allows no softening: {binding.estimate}, more than {NEGLIGIBLE_FRACTION:g} of it."
            if binding.name.startswith("pull-off")
            else f"{situation.source}: {binding.name} allows no softening: {binding.estimate}."
        )
    wished = {f"without {made.effect}" for made in decisions if made.forced}
    total = sum(value for cause, value in budget.items() if math.isfinite(value) and cause not in wished)
    if total > max_error:
        yield f"{situation.source}: the estimated errors add up to {total:.2g}, max_error is {max_error:g}. Lower max_error, or check."
