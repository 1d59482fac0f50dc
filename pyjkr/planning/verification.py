"""What the probes of a plan found: rows, a verdict, tables for a terminal, JSON.

Covers no law. Assumes that the estimates of a plan are upper bounds, as its budget says; the tables put the measured errors beside them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

# Quantities that every cause of the budget changes; e_eff^2 all but softening, to which normal impacts are similar.
OF_SPEEDS = ("normal speed", "tangential speed", "spin times radius", "way rolled until at rest")
SOFTENING = "softening"


@dataclass(frozen=True, kw_only=True)
class Row:
    """One quantity of one probe.

    Attributes
    ----------
    probe, quantity : str
        What was looked at.
    planned, reference : float
        Values where they differ most; of decisions the part of the lanes that say yes.
    error : float
        Largest difference: in parts of the impact's energy (e_eff^2) or speed, of the reference's value (moments, way, coordination), of
        the volume (strain); parts of the lanes that were clearly decided differently (sticking, held).
    limit : float or None
        `max_error`, 0 for decisions; None where the plan does not promise the quantity.
    note : str
        Why it does not.
    """

    probe: str
    quantity: str
    planned: float
    reference: float
    error: float
    limit: float | None
    note: str = ""

    @property
    def holds(self) -> bool:
        """Whether the error is within the limit; what is not promised holds."""
        return self.limit is None or self.error <= self.limit


@dataclass(frozen=True, kw_only=True)
class Verification:
    """What the probes found.

    Attributes
    ----------
    title : str
        Of the scene.
    max_error : float
        Of the plan.
    budget : dict
        Estimated error by cause, as the plan has it; upper bounds.
    rows : tuple of Row
        Every quantity.
    not_probed : tuple of str
        What the plan promises and no probe looks at, one line each.
    planned_step_time, unreduced_step_time : float
        Of one step and sphere in a bed, measured in turn [s].
    planned_wall_time, unreduced_wall_time : float
        Of the scene's spheres over its duration, at that pace [s]; more for a few spheres, where most of a step is not theirs.
    speed_up : float
        Unreduced over planned, for the same simulated time.
    """

    title: str
    max_error: float
    budget: dict[str, float]
    rows: tuple[Row, ...]
    not_probed: tuple[str, ...] = ()
    planned_step_time: float
    unreduced_step_time: float
    planned_wall_time: float
    unreduced_wall_time: float
    speed_up: float

    @property
    def holds(self) -> bool:
        """Whether every error is within its limit."""
        return all(row.holds for row in self.rows)

    @property
    def worst(self) -> Row:
        """The row nearest to its limit, or furthest beyond; decisions first."""
        judged = [row for row in self.rows if row.limit is not None]
        return max(judged, key=lambda row: (not row.holds and row.limit == 0, row.error))


def text(verification: Verification) -> str:
    """Every row, the largest error of each quantity beside its estimate, and the times, for a terminal."""
    judged = [row for row in verification.rows if row.limit is not None]
    wrong = [row for row in judged if not row.holds]
    notes = list(dict.fromkeys(f"{row.quantity}: {row.note}" for row in verification.rows if row.note))
    verdict = f"{len(judged) - len(wrong)} of {len(judged)} hold"
    if judged:
        verdict += f"; worst: {verification.worst.quantity} of {verification.worst.probe}, {verification.worst.error:.2g}"
    parts = [
        f"{verification.title}: probes at the planned settings beside real stiffness and 400 steps a collision",
        _table(("probe", "quantity", "planned", "reference", "error", "limit", "holds"), map(_cells, verification.rows)),
        *(["not judged, or not all of it:\n" + "\n".join(f"  {note}" for note in notes)] if notes else []),
        *(["not probed:\n" + "\n".join(f"  {line}" for line in verification.not_probed)] if verification.not_probed else []),
        _table(("quantity", "largest error measured", "estimate, at most", "limit"), _beside(verification)),
        _table(("estimated error", "at most"), [(cause, f"{value:.2g}") for cause, value in verification.budget.items()]),
        f"a step and sphere: {verification.planned_step_time:.3g} s planned, {verification.unreduced_step_time:.3g} s unreduced\n"
        f"the spheres of the scene: {verification.planned_wall_time:.3g} s planned, {verification.unreduced_wall_time:.3g} s unreduced;"
        f" {_pace(verification.speed_up)}",
        verdict,
    ]
    return "\n\n".join(parts)


def to_json(verification: Verification) -> dict:
    """The same as values that JSON has: infinite estimates are None, and so is `holds` of what is not judged."""
    values = asdict(verification) | {"holds": verification.holds}
    for row, cells in zip(verification.rows, values["rows"], strict=True):
        cells["holds"] = row.holds if row.limit is not None else None
    return _finite(values)


def estimate(budget: dict[str, float], quantity: str) -> float | None:
    """What a plan's budget says about a quantity, at most; None where it says nothing.

    Parameters
    ----------
    budget : dict
        Estimated error by cause.
    quantity : str
        As the rows name it; a way goes with the speed.
    """
    if quantity == "e_eff^2":
        return sum(value for cause, value in budget.items() if not cause.startswith(SOFTENING))
    return sum(budget.values()) if quantity in OF_SPEEDS else None


def _beside(verification: Verification) -> Iterable[tuple[str, ...]]:
    """The largest error of every quantity that is judged."""
    judged = [row for row in verification.rows if row.limit is not None]
    for quantity in dict.fromkeys(row.quantity for row in judged):
        worst = max((row for row in judged if row.quantity == quantity), key=lambda row: row.error)
        most = estimate(verification.budget, quantity)
        yield quantity, f"{worst.error:.2g}", "-" if most is None else f"{most:.2g}", f"{worst.limit:g}"


def _cells(row: Row) -> tuple[str, ...]:
    holds = "not judged" if row.limit is None else "yes" if row.holds else "BAD"
    limit = "-" if row.limit is None else f"{row.limit:g}"
    return row.probe, row.quantity, f"{row.planned:.4g}", f"{row.reference:.4g}", f"{row.error:.2g}", limit, holds


def _pace(speed_up: float) -> str:
    return f"{speed_up:.3g} times faster" if speed_up >= 1 else f"{1 / speed_up:.3g} times slower than unreduced, which is not worth it"


def _finite(value):
    """Without infinities, which JSON does not have."""
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Columns as wide as their longest entry."""
    every = [head, *rows]
    widths = [max(len(row[column]) for row in every) for column in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in every)
