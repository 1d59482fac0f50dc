"""`Costs` -> files: `cost.csv`, `cost.json`, the figures; `cost.json` last and in one move."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import pandas as pd

from pyjkr.cost import figures, results
from pyjkr.cost.results import Costs
from pyjkr.report import versions

RESULT_NAME = "cost.json"
TABLE_NAME = "cost.csv"
FIGURES = ("cost-steps.png", "cost-stiffness.png", "cost-effects.png")


def clear(directory: Path) -> None:
    """Remove an earlier result, so that it is not taken for that of a measurement which then fails."""
    for name in (RESULT_NAME, TABLE_NAME, *FIGURES):
        (directory / name).unlink(missing_ok=True)


def write(costs: Costs, directory: Path, scene_digest: str, simulator: str) -> None:
    """Write all files of a measurement.

    Parameters
    ----------
    costs : Costs
        What to write.
    directory : Path
        Where to.
    scene_digest : str
        SHA-256 of the scene file.
    simulator : str
        Path of the simulator.
    """
    costs.table.to_csv(directory / TABLE_NAME, index=False)
    for name, figure in figures.all_figures(costs):
        figures.save(figure, directory / name)
    unfinished = directory / f".{RESULT_NAME}.{os.getpid()}"
    content = _result(costs) | {"scene_sha256": scene_digest, "versions": versions() | {"simulator": simulator}}
    unfinished.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    unfinished.replace(directory / RESULT_NAME)


def _result(costs: Costs) -> dict[str, Any]:
    return {
        "title": costs.scene.title,
        "passed": costs.passed,
        "checks": [
            {"name": check.name, "worst": _finite(float(check.worst)), "tolerance": check.tolerance}
            | {"passed": bool(check.passed), "where": check.where}
            for check in costs.checks
        ],
        "energy_errors": _records(results.errors_by_steps(costs)),
        "restitution_errors": _records(results.errors_by_steps(costs, "e_error")),
        "steps_for_equal_error": _records(results.steps_for_equal_error(costs)),
        "errors_by_restitution": _records(results.errors_by_restitution(costs)),
        "time_per_step": _records(results.time_per_step(costs)),
        "stiffness": _records(results.stiffness(costs)),
        "oblique": _records(results.oblique(costs)),
        "effects": _records(results.effects(costs)),
        "headline": _records(results.headline(costs)),
        "left_out": list(costs.left_out),
    }


def _records(frame: pd.DataFrame) -> list[dict[str, Any]]:
    # Through pandas' own JSON: it turns its integers and NaN into what JSON knows.
    return json.loads(frame.rename(columns=str).to_json(orient="records", double_precision=15))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
