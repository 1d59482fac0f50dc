"""`Execution` -> files: `table.csv`, figures, `result.json`; and the checks as text.

Nothing is written of a sweep that is not complete. `result.json` is written last and in one move, so that what bears this
name is always a whole result.
"""

from __future__ import annotations

import hashlib
import json
import math
import platform
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from pyjkr import plot
from pyjkr import report as impact_report
from pyjkr.errors import RunError
from pyjkr.studies.check import Check
from pyjkr.sweep.executing import Execution, Failure
from pyjkr.sweep.file import SWEEP_NAME, Sweep
from pyjkr.sweep.store import POINTS, pyjkr_version, write_whole

RESULT_NAME = "result.json"
TABLE_NAME = "table.csv"
SUMMARY_NAME = "summary.csv"
# Names of the figures that a sweep draws, so that the next one can remove them.
FIGURES_NAME = "figures.json"
LISTED_FAILURES = 10


@dataclass(frozen=True)
class Report:
    """The verdict of a complete sweep, and the files that show it."""

    checks: tuple[Check, ...]
    figures: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether every check holds."""
        return all(check.holds for check in self.checks)


def clear(directory: Path) -> None:
    """Remove an earlier result, so that it is not taken for that of a sweep which then fails or is stopped."""
    drawn = directory / POINTS / FIGURES_NAME
    names = json.loads(drawn.read_text(encoding="utf-8")) if drawn.is_file() else []
    for name in (RESULT_NAME, TABLE_NAME, SUMMARY_NAME, *names):
        (directory / name).unlink(missing_ok=True)
    drawn.unlink(missing_ok=True)


def report(sweep: Sweep, execution: Execution, directory: Path) -> Report:
    """Write all files of a complete sweep.

    Parameters
    ----------
    sweep : Sweep
        What was evaluated.
    execution : Execution
        What came out.
    directory : Path
        Where to.

    Raises
    ------
    RunError
        Where points have failed; nothing is written then.
    """
    if execution.failures:
        raise RunError(failure_text(execution))
    execution.table.to_csv(directory / TABLE_NAME, index=False)
    checks = tuple(sweep.module.checks(execution.table, sweep.settings))
    drawn = {f"{stem}.png": figure for stem, figure in sweep.module.figures(execution.table, sweep.settings).items()}
    # a study may have more to say than rows and checks: the means of many, for one
    summary = sweep.module.summary(execution.table, sweep.settings) if hasattr(sweep.module, "summary") else None
    if summary is not None:
        summary.to_csv(directory / SUMMARY_NAME, index=False)
    write_whole(directory / POINTS / FIGURES_NAME, json.dumps(list(drawn)))
    for name, figure in drawn.items():
        plot.save(figure, directory / name)
    copy = directory / SWEEP_NAME
    if sweep.source.resolve() != copy.resolve():
        shutil.copyfile(sweep.source, copy)
    made = Report(checks, tuple(drawn))
    write_whole(directory / RESULT_NAME, json.dumps(_result(sweep, execution, made, summary), indent=2, allow_nan=False) + "\n")
    return made


def _result(sweep: Sweep, execution: Execution, made: Report, summary: pd.DataFrame | None) -> dict[str, Any]:
    return {
        "title": sweep.title,
        "study": sweep.study,
        "study_version": sweep.module.VERSION,
        "sweep_sha256": hashlib.sha256(sweep.source.read_bytes()).hexdigest(),
        "settings": sweep.settings.model_dump(mode="json"),
        "points": execution.points,
        "rows": len(execution.table),
        "wall_time_of_points": execution.seconds,
        "passed": made.passed,
        "checks": [
            {"name": check.name, "measured": _json(check.measured), "wanted": check.wanted, "holds": bool(check.holds)}
            for check in made.checks
        ],
        "summary": None if summary is None else json.loads(summary.to_json(orient="split", index=False)),
        "figures": list(made.figures),
        "versions": impact_report.versions() | {"pyjkr": pyjkr_version(), "machine": platform.machine()},
    }


def checks_text(checks: tuple[Check, ...]) -> str:
    """The checks as a table, and the verdict, for a terminal."""
    if not checks:
        return "no checks"
    rows = [("check", "measured", "wanted", "")]
    rows += [(check.name, measured_text(check.measured), check.wanted, "ok" if check.holds else "BAD") for check in checks]
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    bad = sum(not check.holds for check in checks)
    return "\n".join([*lines, "", "every check holds" if not bad else f"{bad} of {len(checks)} checks do NOT hold"])


def measured_text(value: float | str) -> str:
    """A measured number with as many digits as a reader can use."""
    return value if isinstance(value, str) else f"{value:.6g}"


def failure_text(execution: Execution) -> str:
    """Which points failed, why, and where to read more."""
    lines = [f"{len(execution.failures)} of {execution.points} points failed; the others are kept, the same command runs these again"]
    # One cause, a program that is missing for one, often stops all points.
    alike: dict[str, list[Failure]] = {}
    for failure in execution.failures:
        alike.setdefault(failure.message, []).append(failure)
    for message, failures in list(alike.items())[:LISTED_FAILURES]:
        others = f" and {len(failures) - 1} more" if len(failures) > 1 else ""
        lines += [f"  {failures[0].label}{others}: {message}", f"    see {failures[0].file}"]
    if len(alike) > LISTED_FAILURES:
        lines.append(f"  and {len(alike) - LISTED_FAILURES} other causes, in {execution.failures[0].file.parent.parent}/*/")
    return "\n".join(lines)


def _json(value: Any) -> Any:
    """JSON knows no NaN: what was not measured is null."""
    if isinstance(value, str):
        return value
    return float(value) if math.isfinite(value) else None
