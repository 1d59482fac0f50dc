"""`Costs` -> tables, as rows of text: for a terminal in columns, for a page in Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pyjkr.cost import results
from pyjkr.cost.results import Costs

TARGET_NAMES = {"wall": "wall", "sphere": "pair"}


@dataclass(frozen=True)
class Table:
    """One table: what it shows, the names of its columns, its cells."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def text(costs: Costs) -> str:
    """All tables, what is left out, and the verdict, for a terminal."""
    parts = [_columns(table) for table in tables(costs)]
    parts.append("\n".join([*(f"left out: {line}" for line in costs.left_out), *verdict(costs)]))
    return "\n\n".join(parts)


def verdict(costs: Costs) -> Iterator[str]:
    """One line for each check."""
    for check in costs.checks:
        where = f" ({check.where})" if check.where else ""
        yield f"{'ok ' if check.passed else 'BAD'} {check.name}: {check.worst:.2g}, limit {check.tolerance:.2g}{where}"


def markdown(table: Table) -> str:
    """The table in Markdown."""
    lines = [table.header, ["---"] * len(table.header), *table.rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def tables(costs: Costs) -> tuple[Table, ...]:
    """Every table of a measurement."""
    return (
        errors(costs, "energy_error"),
        errors(costs, "e_error"),
        errors(costs, "energy_error_relative"),
        equal_error(costs),
        threshold(costs),
        restitution(costs),
        times(costs),
        stiffness(costs),
        oblique(costs),
        effects(costs),
        headline(costs),
    )


def errors(costs: Costs, error: str) -> Table:
    """Largest error over speeds and phases by steps per collision."""
    names = {"energy_error": "e_eff^2", "e_error": "e_eff", "energy_error_relative": "e_eff^2, relative to e_eff^2"}
    found = results.errors_by_steps(costs, error)
    steps = [column for column in found.columns if column not in (*results.LAW_KEYS, "order")]
    rows = [
        (*_law(row), *(f"{row[count]:.1e}" for count in steps), f"{row['order']:.2f}") for row in found.to_dict("records")
    ]
    header = ("target", "normal law", "event correction", *map(str, steps), "order")
    return Table(f"Largest error in {names[error]} by time steps per collision", header, tuple(rows))


def equal_error(costs: Costs) -> Table:
    """Steps without correction for the error that 20 and 60 with it have."""
    rows = [
        (TARGET_NAMES[row.target], row.normal, str(row.steps), f"{row.error:.1e}", f"{need:.0f}", f"{need / row.steps:.0f}")
        for row in results.steps_for_equal_error(costs).itertuples()
        for need in (row.steps_without,)
    ]
    header = ("target", "normal law", "steps with correction", "error in e_eff^2", "steps without, same error", "times more")
    return Table("Steps per collision without event correction for the same error (fitted power law)", header, tuple(rows))


def threshold(costs: Costs) -> Table:
    """How often sticking is decided wrongly next to the threshold."""
    rows = costs.study("threshold")
    groups = rows.groupby([*results.LAW_KEYS, "speed"], sort=False)["decided_wrongly"]
    cells = [
        (*_law(row), f"{row['speed']:.4g}", f"{row['wrong']:.0f} of {row['impacts']}")
        for row in groups.agg(wrong="sum", impacts="size").reset_index().to_dict("records")
    ]
    header = ("target", "normal law", "event correction", "speed [m/s]", "decided wrongly")
    return Table("Stuck or rebound, 2 % below and above the sticking speed, 20 steps a collision", header, tuple(cells))


def restitution(costs: Costs) -> Table:
    """Largest error with event correction at other dampings."""
    found = results.errors_by_restitution(costs)
    steps = [column for column in found.columns if isinstance(column, int)]
    rows = [
        (row["normal"], f"{row['restitution_coefficient']:g}", f"{row['slowest']:.3g}", *(f"{row[count]:.1e}" for count in steps))
        for row in found.to_dict("records")
    ]
    header = ("normal law", "e", "slowest [m/s]", *map(str, steps))
    return Table("Largest error in e_eff^2 with event correction, at other restitution coefficients", header, tuple(rows))


def times(costs: Costs) -> Table:
    """Computing time per impact and step."""
    rows = [
        (TARGET_NAMES[row["target"]], row["normal"], f"{row['off'] * 1e9:.0f}", f"{row['on'] * 1e9:.0f}", f"{row['ratio']:.2f}")
        for _, row in results.time_per_step(costs).iterrows()
    ]
    header = ("target", "normal law", "correction off [ns]", "on [ns]", "on over off")
    return Table("Computing time of one impact and one step, whole time loop without output", header, tuple(rows))


def stiffness(costs: Costs) -> Table:
    """Normal impacts at reduced stiffness."""
    found = results.stiffness(costs).sort_values(["modulus_ratio", "steps_per_collision"], ascending=[False, True])
    rows = [
        (f"{row.modulus_ratio:g}", str(row.steps_per_collision), f"{row.steps_for_time:.1f}", f"{row.energy_error:.1e}")
        for row in found.itertuples()
    ]
    header = ("E_mod/E", "steps per collision", "steps for the time of one real collision", "largest error in e_eff^2")
    return Table("Reduced stiffness, normal impact: all of the error is the integrator's", header, tuple(rows))


def oblique(costs: Costs) -> Table:
    """Oblique impacts at reduced stiffness: physical change beside the error of the integrator."""
    found = results.oblique(costs)
    counts = [count for count in (20, 60, 200, 1000) if count in set(found["steps_per_collision"])]
    rows = []
    for (rule, ratio), part in found.groupby(["effect", "modulus_ratio"]):
        part = part.set_index("steps_per_collision")
        line = (f"{ratio:g}", rule, f"{part['tangential_change'].iloc[0]:.3f}", f"{part['spin_change'].iloc[0]:.3f}")
        worst = part[["tangential_error", "spin_error"]].max(axis=1)
        rows.append((rule != "scaled", -ratio, line + tuple(f"{worst.get(count, math.nan):.1e}" for count in counts)))
    header = ("E_mod/E", "surface energy of sliding and rolling", "change of v_t", "change of r omega")
    header += tuple(f"error, {count} steps" for count in counts)
    title = "Reduced stiffness, oblique impact (45 degrees), in parts of the impact speed"
    return Table(title, header, tuple(line for _, _, line in sorted(rows)))


def effects(costs: Costs) -> Table:
    """What each effect does in the oblique impact."""
    rows = []
    for row in results.effects(costs).itertuples():
        matters = "" if row.effect == "everything" else "yes" if row.largest_change > results.MATTERS else "no"
        changes = (f"{change:.1e}" for change in (row.e_change, row.tangential_change, row.spin_change))
        outcome = (f"{value:.4f}" for value in (row.e, row.tangential, row.spin))
        rows.append((row.effect, *outcome, *changes, matters, f"{row.time_per_step * 1e9:.0f}", f"{row.time_ratio:.2f}"))
    header = ("simulated with", "e_eff", "v_t/v", "r omega/v", "change of v_n/v", "of v_t/v", "of r omega/v", "matters")
    return Table("Effects on or off, oblique impact", (*header, "ns a step", "of everything"), tuple(rows))


def headline(costs: Costs) -> Table:
    """The main job at the real stiffness, and reduced with event correction."""
    found = results.headline(costs)
    rows = []
    for row in found.itertuples():
        savings = (found[cost].iloc[0] / getattr(row, cost) for cost in ("run_steps", "computing_time"))
        rows.append(
            (
                f"{row.modulus_ratio:g}",
                str(row.steps_per_collision),
                row.event_correction,
                f"{row.run_steps:d}",
                *(f"{saving:.1f}" for saving in savings),
                f"{row.e_error:.1e}",
                f"{row.energy_error:.1e}",
                f"{row.decided_wrongly:.0f}",
            )
        )
    header = ("E_mod/E", "steps per collision", "event correction", "steps", "fewer steps", "less computing time")
    header += ("largest error in e_eff", "in e_eff^2", "decided wrongly")
    range_ = f"{found['slowest'].min():.3g} to {found['fastest'].max():.3g} m/s" if len(found) else ""
    return Table(f"The main job for the same simulated time, {range_}", header, tuple(rows))


def _law(row: dict[str, Any]) -> tuple[str, str, str]:
    """Cells of target, normal law and event correction."""
    return TARGET_NAMES[row["target"]], row["normal"], row["event_correction"]


def _columns(table: Table) -> str:
    lines: Sequence[Sequence[str]] = (table.header, *table.rows)
    widths = [max(len(line[index]) for line in lines) for index in range(len(table.header))]
    body = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join([table.title, *body])
