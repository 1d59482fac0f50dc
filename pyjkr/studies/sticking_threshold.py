"""Border between sticking and rebound at a wall: Haervig 2017, sec. 5.2, eq. 25, figs 11 and 12.

lambda = E/(rho v^2) and Ad = 3 gamma/(rho v^2 r); lambda_crit = c(e) Ad^(5/2). Each lambda_crit is found by bisection, with
the oracle and, where asked for, with LIGGGHTS. Assumes the simplified law, a normal impact, no other force.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator

from pyjkr.oracle.impact import impact
from pyjkr.oracle.normal import Model, NormalContact
from pyjkr.scene import Scene
from pyjkr.studies import impacts
from pyjkr.studies.check import Check
from pyjkr.studies.sticking_figures import CORRECTED, PRINTED, coefficient_figure, critical_elasticity_figure

VERSION = 1

# Of lambda_crit, by the oracle; its integrator is far more accurate.
ORACLE_TOLERANCE = 1e-7
INTEGRATOR_TOLERANCE = 1e-10
# Of lambda_crit, by LIGGGHTS: a third of it in speed.
LIGGGHTS_TOLERANCE = 1e-3
# Where every search for a bracket starts, whatever Ad and e, and how it widens.
START, WIDENING = 1e6, 100.0
# What the checks ask for. Slope of the lines of fig. 11; c to four digits; the threshold of LIGGGHTS in speed.
SLOPE, SLOPE_TOLERANCE = 2.5, 0.002
COEFFICIENT_TOLERANCE = 5e-5
SPEED_TOLERANCE = 5e-3
POISSONS_RATIO = 0.3

Coefficients = Annotated[tuple[Annotated[float, Field(gt=0.05, lt=1)], ...], Field(min_length=1)]
Adhesivenesses = Annotated[tuple[Annotated[float, Field(gt=0)], ...], Field(min_length=1)]


class Liggghts(BaseModel):
    """Which points LIGGGHTS finds as well."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    restitution_coefficients: Coefficients = (0.3, 0.5, 0.7, 0.9)
    adhesivenesses: Adhesivenesses = (100.0,)
    # Time steps in the shorter of Hertz's collision time and the stuck period.
    steps_per_collision: Annotated[int, Field(ge=10)] = 200


class Settings(BaseModel):
    """Which lines and points. Only lambda, Ad and e matter; radius, density and speed say in which units they are computed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    restitution_coefficients: Coefficients = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
    # Ad = 3 gamma/(rho v^2 r) [-].
    adhesivenesses: Adhesivenesses = (10.0, 100.0, 1000.0, 10000.0)
    # Also the damping as eq. 11 prints it, 2 (5/6) in place of 2 sqrt(5/6).
    as_printed: bool = False
    # CSV with columns e and c (and c_printed), relative to the sweep file.
    reference: str | None = None
    radius: Annotated[float, Field(gt=0)] = 0.635e-6  # m
    density: Annotated[float, Field(gt=0)] = 1026.0  # kg/m3
    speed: Annotated[float, Field(gt=0)] = 2.0  # m/s
    liggghts: Liggghts | None = None

    @field_validator("reference")
    @classmethod
    def _reference_is_there(cls, name: str | None, info: ValidationInfo) -> str | None:
        if name is None:
            return None
        path = Path((info.context or {}).get("directory", ".")) / name
        if not path.is_file():
            raise ValueError(f"{path} is not there. Correct the path, which is relative to the sweep file.")
        return str(path)

    @model_validator(mode="after")
    def _liggghts_has_its_oracle(self) -> Settings:
        if self.liggghts is not None:
            for key in ("restitution_coefficients", "adhesivenesses"):
                spare = sorted(set(getattr(self.liggghts, key)) - set(getattr(self, key)))
                if spare:
                    raise ValueError(f"liggghts.{key} holds {spare[0]!r}, which is not in {key}. Add it there, to compare with.")
        return self


def points(settings: Settings) -> list[dict[str, Any]]:
    """One point per line and adhesiveness."""
    made = []
    for damping in (CORRECTED, PRINTED) if settings.as_printed else (CORRECTED,):
        for e in settings.restitution_coefficients:
            made += [_point(settings, "oracle", damping, e, value) for value in settings.adhesivenesses]
    if settings.liggghts is not None:
        steps = {"steps_per_collision": settings.liggghts.steps_per_collision}
        for e in settings.liggghts.restitution_coefficients:
            made += [_point(settings, "liggghts", CORRECTED, e, value) | steps for value in settings.liggghts.adhesivenesses]
    return made


def _point(settings: Settings, engine: str, damping: str, e: float, adhesiveness: float) -> dict[str, Any]:
    return {
        "label": f"e = {e:g}, Ad = {adhesiveness:g}, {engine}" + (", as printed" if damping == PRINTED else ""),
        "engine": engine,
        "damping": damping,
        "restitution_coefficient": e,
        "adhesiveness": adhesiveness,
        "radius": settings.radius,
        "density": settings.density,
        "speed": settings.speed,
    }


def evaluate(point: dict[str, Any], directory: Path) -> list[dict[str, Any]]:
    """lambda_crit and c of one point."""
    if point["engine"] == "oracle":
        tolerance, rebounds = ORACLE_TOLERANCE, _oracle(point)
    else:
        tolerance, rebounds = LIGGGHTS_TOLERANCE, _liggghts(point, directory)
    critical, count = bisect(rebounds, START, tolerance)
    return [
        {
            "engine": point["engine"],
            "damping": point["damping"],
            "restitution_coefficient": point["restitution_coefficient"],
            "adhesiveness": point["adhesiveness"],
            "critical_elasticity": critical,
            "coefficient": critical / point["adhesiveness"] ** SLOPE,
            "impacts": count,
        }
    ]


def bisect(rebounds: Callable[[float], bool], start: float, tolerance: float) -> tuple[float, int]:
    """Elasticity parameter above which a sphere rebounds, and how many impacts it took to find it.

    Parameters
    ----------
    rebounds : callable
        Tells what happens at an elasticity parameter; stiffer spheres adhere less.
    start : float
        Elasticity parameter at which to look first.
    tolerance : float
        Relative width of the last bracket.
    """
    count = 1
    lower = upper = start
    if rebounds(start):
        while True:
            lower, count = lower / WIDENING, count + 1
            if not rebounds(lower):
                break
            upper = lower
    else:
        while True:
            upper, count = upper * WIDENING, count + 1
            if rebounds(upper):
                break
            lower = upper
    while upper / lower - 1 > tolerance:
        middle, count = math.sqrt(lower * upper), count + 1
        lower, upper = (lower, middle) if rebounds(middle) else (middle, upper)
    return math.sqrt(lower * upper), count


def restitution_as_printed(restitution_coefficient: float) -> float:
    """What a contact without adhesion returns if it is damped with 2 (5/6) in place of 2 sqrt(5/6) (Haervig 2017, eq. 11).

    The printed factor weakens beta by sqrt(5/6), and e = exp(-pi beta/sqrt(1 - beta^2)) inverts eq. 12 exactly.
    """
    logarithm = -math.log(restitution_coefficient)
    beta = logarithm / math.hypot(logarithm, math.pi) * math.sqrt(5 / 6)
    return math.exp(-math.pi * beta / math.sqrt(1 - beta**2))


def _material(point: dict[str, Any], elasticity: float) -> tuple[float, float]:
    """Effective modulus [Pa] and surface energy [J/m2] of an elasticity parameter, at the point's adhesiveness."""
    pressure = point["density"] * point["speed"] ** 2
    return elasticity * pressure, point["adhesiveness"] * pressure * point["radius"] / 3


def _oracle(point: dict[str, Any]) -> Callable[[float], bool]:
    mass = 4 / 3 * math.pi * point["radius"] ** 3 * point["density"]
    e = point["restitution_coefficient"]
    if point["damping"] == PRINTED:
        e = restitution_as_printed(e)

    def rebounds(elasticity: float) -> bool:
        modulus, energy = _material(point, elasticity)
        contact = NormalContact(point["radius"], modulus, energy, Model.SIMPLIFIED, e)
        found = impact(contact, mass, point["speed"], relative_tolerance=INTEGRATOR_TOLERANCE, samples=2, stuck_periods=0.01)
        return not found.stuck

    return rebounds


def _liggghts(point: dict[str, Any], directory: Path) -> Callable[[float], bool]:
    def rebounds(elasticity: float) -> bool:
        _, found = impacts.outcome(_scene(point, elasticity), "liggghts", directory / f"lambda_{elasticity:.6e}")
        return not found.stuck

    return rebounds


def _scene(point: dict[str, Any], elasticity: float) -> Scene:
    modulus, energy = _material(point, elasticity)
    contact = {
        "between": ("sphere", "wall"),
        "effective_modulus": modulus,
        "surface_energy": energy,
        "restitution_coefficient": point["restitution_coefficient"],
    }
    impact_at_wall = {
        "radius": point["radius"],
        "material": "sphere",
        "target": "wall",
        "wall_material": "wall",
        "speeds": (point["speed"],),
        "steps_per_collision": point["steps_per_collision"],
    }
    return Scene(
        title=point["label"],
        model={"normal": "jkr/simplified", "tangential": "off", "rolling_friction": "off"},
        # Poisson's ratios do not matter: the effective modulus is given.
        material={"sphere": {"density": point["density"], "poissons_ratio": POISSONS_RATIO}, "wall": {"poissons_ratio": POISSONS_RATIO}},
        contact=(contact,),
        impact=impact_at_wall,
        # On the way to the border the bisection meets spheres that are far too soft; the laws hold for them formally.
        reduction={"maximum_overlap": 1.0},
    )


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Slope of each line, c against the reference, LIGGGHTS against the oracle."""
    made = []
    oracle = table[table["engine"] == "oracle"]
    if len(settings.adhesivenesses) > 1:
        for (damping, e), line in oracle.groupby(["damping", "restitution_coefficient"], sort=True):
            slope = np.polyfit(np.log(line["adhesiveness"]), np.log(line["critical_elasticity"]), 1)[0]
            name = f"slope of lambda_crit(Ad), e = {e:g}" + (", as printed" if damping == PRINTED else "")
            made.append(Check(name, float(slope), f"{SLOPE} +- {SLOPE_TOLERANCE}", bool(abs(slope - SLOPE) <= SLOPE_TOLERANCE)))
    if settings.reference is not None:
        made += _reference_checks(oracle, pd.read_csv(settings.reference, comment="#"))
    if settings.liggghts is not None:
        made.append(_liggghts_check(table))
    return made


def _reference_checks(oracle: pd.DataFrame, reference: pd.DataFrame) -> list[Check]:
    made = []
    for damping, column in ((CORRECTED, "c"), (PRINTED, "c_printed")):
        lines = oracle[oracle["damping"] == damping].merge(reference, left_on="restitution_coefficient", right_on="e")
        if len(lines):
            worst = float((lines["coefficient"] / lines[column] - 1).abs().max())
            name = f"c(e), damping {damping}: largest deviation from the reference, {len(lines)} values"
            made.append(Check(name, worst, f"<= {COEFFICIENT_TOLERANCE:g} (four digits)", worst <= COEFFICIENT_TOLERANCE))
    return made or [Check("c(e) against the reference", "no e in common", "at least one", False)]


def _liggghts_check(table: pd.DataFrame) -> Check:
    keys = ["restitution_coefficient", "adhesiveness"]
    oracle = table[(table["engine"] == "oracle") & (table["damping"] == CORRECTED)]
    both = table[table["engine"] == "liggghts"].merge(oracle, on=keys, suffixes=("", "_oracle"))
    # At given materials lambda/Ad^(5/2) goes as v^3.
    worst = float(((both["critical_elasticity"] / both["critical_elasticity_oracle"]) ** (1 / 3) - 1).abs().max())
    name = f"sticking speed, LIGGGHTS against oracle: largest deviation, {len(both)} values"
    return Check(name, worst, f"<= {SPEED_TOLERANCE:g}", worst <= SPEED_TOLERANCE)


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Fig. 11 where there are several adhesivenesses, else fig. 12."""
    if len(settings.adhesivenesses) > 1:
        return {"critical_elasticity": critical_elasticity_figure(table[table["damping"] == CORRECTED])}
    reference = None if settings.reference is None else pd.read_csv(settings.reference, comment="#")
    return {"coefficient": coefficient_figure(table, reference)}
