"""Squares of numbers. Every evaluation leaves a mark; files named after a number make it fail, die or take long."""

from __future__ import annotations

import os
import signal
import sys
import uuid
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator

from pyjkr import plot
from pyjkr.process import lines_of, program
from pyjkr.studies.check import Check

VERSION = 1


class Settings(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    numbers: tuple[float, ...]
    largest_sum: float = 1e9
    marks: str = "marks"  # directory beside the sweep file

    @field_validator("marks")
    @classmethod
    def _beside(cls, name: str, info: ValidationInfo) -> str:
        return str(info.context["directory"] / name)


def points(settings: Settings) -> list[dict[str, Any]]:
    return [{"label": f"number {number:g}", "number": number, "marks": settings.marks} for number in settings.numbers]


def evaluate(point: dict[str, Any], directory: Path) -> list[dict[str, Any]]:
    number, marks = point["number"], Path(point["marks"])
    (marks / f"evaluated-{number:g}-{uuid.uuid4().hex}").touch()
    if (marks / f"fail-{number:g}").exists():
        raise ValueError(f"{number:g} is not to my taste")
    if (marks / f"die-{number:g}").exists():
        os.kill(os.getpid(), signal.SIGKILL)
    if (marks / f"wait-{number:g}").exists():
        code = "import os, time; print(os.getpid(), flush=True); time.sleep(60)"
        with program([sys.executable, "-c", code], dict(os.environ), directory) as (process, terminal):
            for line in lines_of(process, terminal, float("inf")):
                (marks / f"program-{line}").touch()
    (directory / "left.txt").write_text("a file of the point's own")
    # Types that JSON does not know, and a value that it does not allow.
    square = np.float64(number) ** 2
    return [{"number": number, "square": square, "whole": np.int64(number), "odd": np.bool_(number % 2), "nothing": float("nan")}]


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    total = table["square"].sum()
    return [Check("sum of squares", float(total), f"<= {settings.largest_sum:g}", bool(total <= settings.largest_sum))]


def summary(table: pd.DataFrame, settings: Settings) -> pd.DataFrame:
    return pd.DataFrame({"of": ["all"], "numbers": [len(table)], "mean square": [table["square"].mean()]})


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    figure, (axes,) = plot.panels(1, (2, 2))
    axes.plot(table["number"], table["square"])
    return {"squares": figure}
