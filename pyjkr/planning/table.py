"""An `ApplicationPlan` as text: tables for a terminal, comments for a deck, every number with formula and source.

Covers no law and no decision.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from pyjkr.planning.plan import ApplicationPlan
from pyjkr.planning.steps import Mode

# Words of a measure that fit into a line of 120 characters.
MEASURE_WIDTH = 58


def text(plan: ApplicationPlan) -> str:
    """Decisions, limits of the softening, modes of the time step and the estimated error, for a terminal."""
    parts = [
        f"{plan.situation.title} (about {plan.situation.about}, max_error {plan.max_error:g})",
        _table(("effect", "decision", "number", "threshold", "measure", "where"), _decisions(plan)),
        f"softening: E_mod/E = {plan.modulus_ratio:g}, bound by {plan.binding.name}",
        _table(("limit", "E_mod/E >=", "estimate"), _limits(plan)),
        f"time step: {plan.time_step:.3g} s, bound by {plan.limiting_mode} ({plan.step.limiting.where});"
        f" {plan.steps_per_collision:.3g} steps per collision",
        _table(("time scale", "period [s]", "time step <= [s]", "binds", "where"), _modes(shortest(plan.step.modes))),
        _table(("estimated error", "at most"), [(cause, f"{value:.2g}") for cause, value in plan.budget.items()]),
        f"contact law: {plan.styles.pair} {plan.styles.keywords}".rstrip(),
        *(f"warning: {line}" for line in plan.warnings),
    ]
    return "\n\n".join(parts)


def comments(plan: ApplicationPlan) -> tuple[str, ...]:
    """The same in short, for the head of a deck; without the comment sign."""
    lines = [f"effects, by the error of leaving them out (max_error = {plan.max_error:g}):"]
    lines += _table(("effect", "", "number", "threshold", "measure"), [row[:5] for row in _decisions(plan)]).splitlines()
    lines += [
        f"E_mod/E = {plan.modulus_ratio:g}: {plan.binding.name}, {plan.binding.estimate}; {plan.binding.formula} ({plan.binding.source})",
        f"time step {plan.time_step:.3g} s: {plan.limiting_mode}, {plan.step.limiting.formula} ({plan.step.limiting.source})",
    ]
    wrapped = (textwrap.wrap(line, 128, subsequent_indent="  ") if len(line) > 128 else [line] for line in lines)
    return tuple(line.rstrip() for group in wrapped for line in group)


def explain(plan: ApplicationPlan) -> str:
    """Every derived number with its formula and source."""
    lines = ["effects"]
    for made in plan.decisions:
        why = "as wished or given" if made.forced else f"{_number(made.number)} {'>' if made.on else '<='} {made.threshold:.3g}"
        lines += _entry(f"{made.effect}: {_decision(made.on)}, {why}", made.measure, made.formula, made.source, made.where)
    lines += ["", f"softening, E_mod/E = {plan.modulus_ratio:g}"]
    for limit in plan.limits:
        lines += _entry(f"{limit.name}: E_mod/E >= {limit.smallest_ratio:.3g}", limit.estimate, limit.formula, limit.source)
    lines += ["", f"time step, {plan.time_step:.3g} s"]
    for mode in plan.step.modes:
        head = f"{mode.name}: time step <= {mode.limit:.3g} s" if mode.binds else f"{mode.name}: {mode.period:.3g} s, for information"
        lines += _entry(head, f"its time {mode.period:.3g} s", mode.formula, mode.source, mode.where)
    lines += ["", "estimated error, upper bounds", *(f"  {cause}: {value:.2g}" for cause, value in plan.budget.items())]
    return "\n".join(lines)


def shortest(modes: Iterable[Mode]) -> list[Mode]:
    """Of each time scale the meeting with the shortest limit."""
    best: dict[str, Mode] = {}
    for mode in modes:
        if mode.name not in best or mode.limit < best[mode.name].limit:
            best[mode.name] = mode
    return sorted(best.values(), key=lambda mode: (not mode.binds, mode.limit))


def _decisions(plan: ApplicationPlan) -> list[tuple[str, ...]]:
    return [
        (made.effect, _decision(made.on) + (" (forced)" if made.forced else ""), _number(made.number), f"{made.threshold:.3g}",
         textwrap.shorten(made.measure, MEASURE_WIDTH, placeholder=" ..."), made.where)
        for made in plan.decisions
    ]  # fmt: skip


def _limits(plan: ApplicationPlan) -> list[tuple[str, ...]]:
    rows = sorted(plan.limits, key=lambda limit: -limit.smallest_ratio)
    return [(limit.name, f"{limit.smallest_ratio:.2g}" if limit.smallest_ratio > 0 else "-", limit.estimate) for limit in rows]


def _modes(modes: Iterable[Mode]) -> list[tuple[str, ...]]:
    return [
        (mode.name, f"{mode.period:.3g}", f"{mode.limit:.3g}" if mode.binds else "-", "yes" if mode.binds else "no", mode.where)
        for mode in modes
    ]


def _decision(is_on: bool) -> str:
    return "on" if is_on else "off"


def _number(value: float) -> str:
    return f"{value:.3g}"


def _entry(head: str, measure: str, formula: str, source: str, where: str = "") -> list[str]:
    return [f"  {head}", *(f"      {line}" for line in (measure, formula, f"source: {source}" if source else "", where) if line)]


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns as wide as their longest entry."""
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in (head, *rows))
