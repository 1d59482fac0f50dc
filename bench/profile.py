"""Laws with and without each effect -> where the time of a contact goes, and what bounds it from below."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from bench.laws import FULL, HERTZ, SIMPLIFIED, Law, Mode

if TYPE_CHECKING:
    from bench.report import Results

# Order of `bench.laws._ours`: each slot with the event correction on, then off.
_SLOTS = ("normal force", "sliding", "rolling", "twisting")


def text(results: Results, table) -> str:
    """The section of the page; empty where the laws were not measured.

    Parameters
    ----------
    results
        What was measured.
    table
        Header and rows -> Markdown.
    """
    rows = [row for laws in (SIMPLIFIED, FULL) for row in _rows(results, laws)]
    if not rows:
        return ""
    return (
        "## Where the time goes\n\n"
        "Each effect switched on after the one before; differences of the least pair times on the frozen bed, and of the "
        "instructions. What is switched off costs nothing: its line is not there, in the table as in the program, which has "
        "a loop of its own for every combination.\n\n"
        + table(("model", "effect", "ns per contact", "instructions per contact"), rows)
        + "\n"
        + _bound(results)
    )


def _rows(results: Results, laws: tuple[Law, ...]) -> Iterator[tuple[str, ...]]:
    before: tuple[float, float | None] = (0.0, 0.0)
    for number, slot in enumerate(_SLOTS):
        now = _cost(results, laws[2 * number])
        if now is None:
            return
        yield (f"`{laws[0].key}`" if number == 0 else "", slot, *_differences(now, before))
        before = now
    with_rolling, plain = _cost(results, laws[4]), _cost(results, laws[5])
    if with_rolling and plain:
        yield ("", "of these, event correction (normal, sliding, rolling)", *_differences(with_rolling, plain))


def _cost(results: Results, law: Law) -> tuple[float, float | None] | None:
    found = results.laws.get((law, Mode.FROZEN))
    if not found:
        return None
    counted = results.instructions.get((law, Mode.FROZEN))
    return min(sample.per_evaluation for sample in found), counted.per_evaluation if counted else None


def _differences(now: tuple[float, float | None], before: tuple[float, float | None]) -> tuple[str, str]:
    counted = "" if now[1] is None or before[1] is None else f"{now[1] - before[1]:.0f}"
    return f"{now[0] - before[0]:.1f}", counted


def _bound(results: Results) -> str:
    alone, whole, stock = (_cost(results, law) for law in (SIMPLIFIED[0], SIMPLIFIED[4], HERTZ))
    if not (alone and whole and stock):
        return ""
    lines = [
        f"From below the time is bounded by what every law must do: walk the lists, fetch both spheres' positions, velocities and "
        f"spins, add force and moment to both. Stock `hertz` takes {stock[0]:.0f} ns for that and a square root, ours with the JKR "
        f"root {alone[0]:.0f} ns of the {whole[0]:.0f} ns of `{SIMPLIFIED[4].key}`."
    ]
    ours = [row for row in results.solver if row.method.startswith("ours: 64")]
    if ours:
        lines.append(f"The root itself is {ours[0].throughput_ns:.1f} ns of it: solving it faster would no longer show.")
    beds = sorted(n for law, n in results.growth if law is SIMPLIFIED[4])
    if len(beds) > 1:
        costs = [min(sample.per_evaluation for sample in results.growth[SIMPLIFIED[4], n]) for n in (beds[0], beds[-1])]
        lines.append(
            f"Memory is the rest: {costs[0]:.0f} ns a contact with {beds[0]:,} spheres, which fit the caches, {costs[1]:.0f} ns with "
            f"{beds[-1]:,}."
        )
    return " ".join(lines) + "\n"
