"""CSV file -> `Measurements`: speeds and restitution coefficients of one particle, with what is wrong in them said first.

Covers no law. A restitution of 0 is a sphere that stuck: a measurement like the others.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd

from pyjkr.calibrate.particle import CalibrationError

COLUMNS = ("speed", "restitution", "standard_deviation")
# Two unknowns, damping and adhesion.
FEWEST_POINTS = 2


@dataclass(frozen=True)
class Measurements:
    """Points of a rebound experiment, in the order of speed.

    Parameters
    ----------
    speed : ndarray
        v [m/s], normal to the surface, before the contact.
    restitution : ndarray
        e_eff [-], normal speed after over before; 0 where the sphere stuck.
    standard_deviation : ndarray or None
        Of each restitution [-]; None where it is not known and must be judged by the scatter.
    source : str
        Where they are from, for messages.

    Raises
    ------
    CalibrationError
        Where a number cannot be, or there are too few.
    """

    speed: np.ndarray
    restitution: np.ndarray
    standard_deviation: np.ndarray | None = None
    source: str = "data"

    def __post_init__(self) -> None:
        order = np.argsort(np.asarray(self.speed, dtype=float), kind="stable")
        for name in COLUMNS:
            value = getattr(self, name)
            if value is None:
                continue
            array = np.asarray(value, dtype=float)
            if array.shape != (len(order),):
                raise CalibrationError(f"{self.source}: {name} has {array.size} entries, speed has {len(order)}. Give one for each.")
            _require(np.isfinite(array), array, self.source, name, "is not a finite number. Remove the point or correct it.")
            object.__setattr__(self, name, array[order])
        _require(self.speed > 0, self.speed, self.source, "speed", "m/s must be > 0. Remove the point.")
        _require(
            self.restitution >= 0, self.restitution, self.source, "restitution",
            "is negative. Write 0 where the sphere stuck; a speed after the contact that points away counts as positive.",
        )  # fmt: skip
        _require(
            self.restitution <= 1, self.restitution, self.source, "restitution",
            "is above 1: no impact gains energy. Divide percentages by 100, and give speed ratios.",
        )  # fmt: skip
        if self.standard_deviation is not None:
            _require(
                self.standard_deviation > 0, self.standard_deviation, self.source, "standard_deviation",
                "must be > 0. Leave the column out where it is not known.",
            )  # fmt: skip
        if len(self.speed) < FEWEST_POINTS:
            raise CalibrationError(
                f"{self.source}: {len(self.speed)} point(s). Damping and adhesion are two unknowns: give at least {FEWEST_POINTS}"
                " points, one of them on the plateau at high speed and one nearer to sticking."
            )
        if not np.any(self.rebounds):
            raise CalibrationError(f"{self.source}: every sphere stuck. Add impacts that are fast enough to rebound.")
        if self.rebounds.sum() < FEWEST_POINTS:
            raise CalibrationError(
                f"{self.source}: one impact rebounded, all others stuck. Many pairs of damping and adhesion do that: add another"
                " speed that rebounds."
            )
        if len(np.unique(self.speed)) < FEWEST_POINTS:
            raise CalibrationError(f"{self.source}: all points have the speed {self.speed[0]:g} m/s. Add another speed.")

    @property
    def rebounds(self) -> np.ndarray:
        """Which spheres did not stick."""
        return self.restitution > 0


def read(path: str | Path) -> Measurements:
    """Read a CSV file with the columns speed [m/s], restitution and, where known, standard_deviation.

    Parameters
    ----------
    path : str or Path
        Comma-separated text with one header line; lines that begin with # are comments, units in brackets are ignored.

    Raises
    ------
    CalibrationError
        One line: file, what is wrong, remedy.
    """
    path = Path(path)
    wanted = "The header must be: speed,restitution  or  speed,restitution,standard_deviation"
    try:
        # every cell as text, so that a stray word is found and named
        table = pd.read_csv(path, comment="#", header=None, dtype=str, skipinitialspace=True, skip_blank_lines=True)
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read: {error.strerror}. Name a CSV file.") from error
    except pd.errors.EmptyDataError:
        raise CalibrationError(f"{path}: holds no points. {wanted}.") from None
    except (UnicodeDecodeError, pd.errors.ParserError) as error:
        raise CalibrationError(f"{path}: is not a comma-separated table: {str(error).strip()}. {wanted}.") from error
    names = [re.sub(r"[\[(].*", "", str(name)).strip().lower().replace(" ", "_") for name in table.iloc[0]]
    for name in names:
        if name not in COLUMNS:
            raise CalibrationError(f"{path}: unknown column '{name}'. {wanted}.")
        if names.count(name) > 1:
            raise CalibrationError(f"{path}: column '{name}' is there {names.count(name)} times. Keep one of them.")
    for name in COLUMNS[:2]:
        if name not in names:
            raise CalibrationError(f"{path}: column '{name}' is missing. {wanted}.")
    rows = table.iloc[1:]
    if not len(rows):
        raise CalibrationError(f"{path}: holds a header but no points. Add one line for each impact.")
    columns = {name: _numbers(rows[index], name, path) for index, name in enumerate(names)}
    return Measurements(**columns, source=str(path))


def _numbers(cells: pd.Series, name: str, path: Path) -> np.ndarray:
    values = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=float)
    if np.any(np.isnan(values)):
        row = int(np.argmax(np.isnan(values)))
        cell = cells.iloc[row]
        shown = "is empty" if pd.isna(cell) else f"= {cell!r} is not a number"
        raise CalibrationError(f"{path}: point {row + 1}: {name} {shown}. Remove the point or correct it.")
    return values


def _require(good: npt.ArrayLike, values: np.ndarray, source: str, name: str, what: str) -> None:
    if not np.all(good):
        place = int(np.argmin(good))
        raise CalibrationError(f"{source}: {name} = {values[place]:g} {what}")
