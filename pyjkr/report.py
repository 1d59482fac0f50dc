"""`Comparison` -> files: `result.json`, `table.csv`, `table.txt`, the figures.

`result.json` is written last and in one move, so that what bears this name is always a whole result.
"""

from __future__ import annotations

import dataclasses
import importlib.metadata
import json
import math
import os
import platform
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pyjkr import plot, tables
from pyjkr.compare import Comparison, oracle_curves

if TYPE_CHECKING:
    from pyjkr.calibrate.measurements import Measurements

RESULT_NAME = "result.json"
FILES = (RESULT_NAME, "table.csv", "table.txt", "restitution.png", "velocity.png")


def clear(directory: Path) -> None:
    """Remove an earlier result, so that it is not taken for that of a run which then fails."""
    for name in FILES:
        (directory / name).unlink(missing_ok=True)


def write(comparison: Comparison, directory: Path, scene_digest: str, measured: Measurements | None = None) -> None:
    """Write all files of a comparison.

    Parameters
    ----------
    comparison : Comparison
        What to write.
    directory : Path
        Where to.
    scene_digest : str
        SHA-256 of the scene file.
    measured : Measurements or None
        Points of an experiment, drawn beside the model; they decide nothing.
    """
    comparison.table.to_csv(directory / "table.csv", index=False)
    (directory / "table.txt").write_text(tables.comparison_text(comparison), encoding="utf-8")
    plot.save(plot.restitution_figure(comparison, oracle_curves(comparison.plan), measured), directory / "restitution.png")
    if comparison.plan.scene.figures.velocity_speed is not None:
        plot.save(plot.velocity_figure(comparison), directory / "velocity.png")
    unfinished = directory / f".{RESULT_NAME}.{os.getpid()}"
    unfinished.write_text(
        json.dumps(_result(comparison, scene_digest), indent=2, allow_nan=False) + "\n", encoding="utf-8"
    )
    unfinished.replace(directory / RESULT_NAME)


def _result(comparison: Comparison, scene_digest: str) -> dict[str, Any]:
    return {
        "title": comparison.plan.scene.title,
        "scene_sha256": scene_digest,
        "engine": comparison.engine,
        "passed": comparison.passed,
        "checks": [
            {"name": check.name, "worst": _finite(check.worst), "tolerance": check.tolerance}
            | {"passed": check.passed, "where": check.where}
            for check in comparison.checks
        ],
        "table": [{key: _finite(value) for key, value in row.items()} for row in comparison.table.to_dict("records")],
        "left_out": [dataclasses.asdict(item) for item in comparison.plan.left_out],
        "warnings": list(comparison.plan.warnings),
        "versions": versions() | {"simulator": "; ".join(comparison.simulators) or None},
    }


def versions() -> dict[str, str]:
    """Versions of what a result depends on."""
    found = {"python": platform.python_version()}
    for name in ("pyjkr", "numpy", "scipy", "pandas"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def _finite(value: Any) -> Any:
    """JSON knows no NaN: what was not measured is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
