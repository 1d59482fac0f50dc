# Law: simplified JKR, head-on impacts of two equal spheres over the elasticity and the adhesiveness parameter.
# Covers: Haervig et al. 2017 section 5.2, figs 7 (gamma left alone) and 8 (gamma of eq. 24); eqs 3, 7-13, 24.
# Assumes: Ad = gamma/(rho v^2 R) with the effective radius R, as in the caption of fig. 7; lambda = E/(rho v^2), E effective.
"""e_eff over the elasticity parameter: bent where gamma is left alone, flat where it follows eq. 24."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, model_validator

from pyjkr import plan, scaling
from pyjkr.contact import maximum_overlap
from pyjkr.oracle.impact import impact, sticking_speed
from pyjkr.plot import BLUE, GREEN, ORANGE, PURPLE, SKY, STYLE, VERMILION, panels
from pyjkr.scene import Scene
from pyjkr.studies import impacts, lanes
from pyjkr.studies.check import Check

VERSION = 1
LOOKS = ((BLUE, "o"), (VERMILION, "s"), (GREEN, "D"), (PURPLE, "^"), (ORANGE, "v"), (SKY, "P"), ("black", "X"))
RESTITUTION_TOLERANCE = 2e-3
FLAT_IN_ORACLE = 1e-9
# lambda_crit = constant Ad^(5/2), from sticking speeds that are exact to 1e-11: their third power.
POWER_TOLERANCE = 1e-8
# What "e_eff/e approx. 1" of section 5.2 is taken for.
WITHOUT_ADHESION = 0.01


class Settings(BaseModel):
    """What figs 7 and 8 are drawn for."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rule: Literal["unmodified", "scaled"] = "unmodified"
    """Surface energy while E changes: left alone (fig. 7), or of eq. 24 (fig. 8)."""
    adhesiveness: tuple[PositiveFloat, ...] = Field(default=(1.0, 5.0, 10.0, 20.0, 24.0, 40.0), min_length=1, max_length=7)
    """Ad = gamma/(rho v^2 R) [-]; with rule "scaled" its value at the base elasticity."""
    base_elasticity: float = Field(default=1e6, gt=0)
    """lambda from which eq. 24 starts [-]; Haervig 2017, section 5.2."""
    lowest: float = Field(default=1e3, gt=0)
    """Least lambda [-]; below about 1e3 spheres press deeper than 0.5 R."""
    highest: float = Field(default=1e9, gt=0)
    """Largest lambda [-]."""
    per_decade: int = Field(default=2, ge=1)
    """Impacts in LIGGGHTS per decade of lambda and Ad."""
    curve_per_decade: int = Field(default=10, ge=1)
    """Impacts of the oracle per decade of lambda and Ad, besides those next to the threshold."""
    restitution_coefficient: float = Field(default=0.3, gt=0.05, le=1)
    """e without adhesion [-]; Haervig 2017, captions of figs 7 and 8."""
    radius: float = Field(default=1e-6, gt=0)
    """Of both spheres [m]. Like density and speed without influence: only lambda, Ad and e matter."""
    density: float = Field(default=1500.0, gt=0)
    """Of both spheres [kg/m3]."""
    speed: float = Field(default=0.7, gt=0)
    """Relative speed before the impact [m/s]."""
    steps_per_collision: int = Field(default=200, ge=10)
    """Time steps per collision."""
    maximum_overlap: float = Field(default=0.5, gt=0, le=1)
    """What may press deeper, in units of R, is left out."""

    @model_validator(mode="after")
    def _range_ascends(self) -> Settings:
        if self.lowest >= self.highest:
            raise ValueError(f"lowest = {self.lowest:g} must be below highest = {self.highest:g}. Swap or correct them.")
        return self


def points(settings: Settings) -> list[dict]:
    """One impact per lambda and Ad in LIGGGHTS, one line of the oracle per Ad."""
    found = []
    decades = math.log10(settings.highest / settings.lowest)
    keys = ("rule", "base_elasticity", "restitution_coefficient", "radius", "density", "speed", "steps_per_collision", "maximum_overlap")
    common = {key: getattr(settings, key) for key in keys}
    for adhesiveness in settings.adhesiveness:
        about = {"adhesiveness": adhesiveness, **common}
        for elasticity in np.geomspace(settings.lowest, settings.highest, round(decades * settings.per_decade) + 1).tolist():
            point = {"label": f"Ad = {adhesiveness:g}, lambda = {elasticity:.3g}", "engine": "liggghts", **about, "elasticity": elasticity}
            if not _too_deep(point):
                found.append(point)
        line = {"lowest": settings.lowest, "highest": settings.highest, "per_decade": settings.curve_per_decade}
        found.append({"label": f"Ad = {adhesiveness:g}, oracle", "engine": "oracle", **about, **line})
    return found


def _too_deep(point: dict) -> bool:
    scene = _scene(point)
    pair = plan.pair_properties(scene, 1.0, "scaled")
    deepest = maximum_overlap(pair, point["speed"])
    return deepest / pair.effective_radius > point["maximum_overlap"]


def surface_energy(point: dict) -> float:
    """gamma [J/m2] of an impact: Ad rho v^2 R, times (lambda/lambda_base)^(2/5) with rule "scaled" (eq. 24)."""
    energy = point["adhesiveness"] * point["density"] * point["speed"] ** 2 * 0.5 * point["radius"]
    if point["rule"] == "unmodified":
        return energy
    return scaling.surface_energy_mod(energy, point["elasticity"] / point["base_elasticity"])


def _scene(point: dict) -> Scene:
    """Two equal spheres: the Poisson's ratio takes no part, since the effective modulus is given."""
    return Scene.model_validate(
        {
            "title": "equal spheres head-on",
            "model": {"normal": "jkr/simplified", "tangential": "off", "rolling_friction": "off"},
            "material": {"solid": {"density": point["density"], "poissons_ratio": 0.3}},
            "contact": (
                {
                    "between": ("solid", "solid"),
                    "effective_modulus": point["elasticity"] * point["density"] * point["speed"] ** 2,
                    "surface_energy": surface_energy(point),
                    "restitution_coefficient": point["restitution_coefficient"],
                },
            ),
            "impact": {
                "radius": point["radius"],
                "material": "solid",
                "target": "sphere",
                "target_radius": point["radius"],
                "target_material": "solid",
                "speeds": (point["speed"],),
                "steps_per_collision": point["steps_per_collision"],
                "phase": 0.37,
            },
            "reduction": {"maximum_overlap": point["maximum_overlap"]},
        }
    )


def evaluate(point: dict, directory: Path) -> list[dict]:
    """One impact in LIGGGHTS with the oracle's beside it, or one line of the oracle."""
    if point["engine"] == "oracle":
        several = [{**point, "elasticity": elasticity} for elasticity in _line(point)]
        return [_exact(one) for one in several if not _too_deep(one)]
    case, found = impacts.outcome(_scene(point), "liggghts", directory)
    return [{**_exact(point), "e_eff": found.restitution, "stuck": found.stuck, "time_step": case.time_step, "steps": found.steps}]


def _line(point: dict) -> list[float]:
    """lambda of a line of the oracle; with gamma left alone they crowd above the threshold, where e_eff rises like a root."""
    decades = math.log10(point["highest"] / point["lowest"])
    even = np.geomspace(point["lowest"], point["highest"], round(decades * point["per_decade"]) + 1)
    if point["rule"] == "scaled":
        return even.tolist()
    critical = critical_elasticity(point)
    crowd = critical * (1 + np.array([-1e-6, *np.geomspace(1e-6, 0.1, 2 * point["per_decade"])]))
    return sorted([*even.tolist(), *crowd[(crowd > point["lowest"]) & (crowd < point["highest"])].tolist()])


def _exact(point: dict) -> dict:
    """The oracle's outcome of an impact."""
    pair = plan.pair_properties(_scene(point), 1.0, "scaled")
    contact = lanes.normal_contact(pair, "jkr/simplified")
    exact = impact(contact, pair.effective_mass, point["speed"], samples=2, stuck_periods=0.01)
    row = {name: point[name] for name in ("engine", "adhesiveness", "elasticity", "restitution_coefficient")}
    row |= {"surface_energy": pair.surface_energy, "e_eff_oracle": exact.restitution, "stuck_oracle": exact.stuck}
    return row | {"e_eff": exact.restitution, "stuck": exact.stuck}


def critical_elasticity(point: dict) -> float:
    """lambda [-] below which the spheres stick, gamma left alone; Haervig 2017, eq. 25.

    The sticking speed goes as gamma^(5/6) E^(-1/3), so one of the oracle's gives the lambda at which it is the impact speed.
    """
    pair = plan.pair_properties(_scene({**point, "elasticity": point["base_elasticity"], "rule": "unmodified"}), 1.0, "scaled")
    threshold = sticking_speed(lanes.normal_contact(pair, "jkr/simplified"), pair.effective_mass)
    return point["base_elasticity"] * (threshold / point["speed"]) ** 3


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """LIGGGHTS on the oracle's lines; thresholds and limits (fig. 7) or flatness (fig. 8)."""
    runs, exact = (table[table["engine"] == engine] for engine in ("liggghts", "oracle"))
    error = lanes.worst(runs["e_eff"] - runs["e_eff_oracle"])
    found = [Check("e_eff, LIGGGHTS - oracle, all impacts", error, "<= 2e-3", error <= RESTITUTION_TOLERANCE)]
    unlike = int((runs["stuck"].astype(bool) != runs["stuck_oracle"].astype(bool)).sum())
    found.append(Check("impacts that stick in one and rebound in the other", unlike, "0", unlike == 0 and len(runs) > 0))
    return found + (_flat(runs, exact, settings) if settings.rule == "scaled" else _bent(runs, exact, settings))


def _flat(runs: pd.DataFrame, exact: pd.DataFrame, settings: Settings) -> list[Check]:
    found = []
    for name, rows, tolerance, words in (
        ("oracle", exact, FLAT_IN_ORACLE, "<= 1e-9"),
        ("LIGGGHTS", runs, RESTITUTION_TOLERANCE, "<= 2e-3"),
    ):
        groups = rows.groupby("adhesiveness")["e_eff"]
        spread = lanes.worst(groups.max() - groups.min())
        found.append(Check(f"e_eff over lambda at the same Ad, spread, {name}", spread, words, spread <= tolerance))
    rebounds = int((exact.groupby("adhesiveness")["e_eff"].max() > 0).sum())
    sticks = len(settings.adhesiveness) - rebounds
    shown = f"{rebounds} of {len(settings.adhesiveness)}"
    found.append(Check("lines that rebound: some do, some stick", shown, "neither none nor all", rebounds > 0 and sticks > 0))
    return found


def _bent(runs: pd.DataFrame, exact: pd.DataFrame, settings: Settings) -> list[Check]:
    found, constants = [], []
    for adhesiveness in settings.adhesiveness:
        critical = critical_elasticity({**settings.model_dump(), "adhesiveness": adhesiveness})
        constants.append(critical / adhesiveness**2.5)
        rows = runs[runs["adhesiveness"] == adhesiveness]
        stuck = rows["stuck"].astype(bool)
        right = bool((stuck == (rows["elasticity"] < critical)).all()) and len(rows) > 0
        sides = [f"sticks to {rows[stuck]['elasticity'].max():.3g}"] if stuck.any() else []
        sides += [f"rebounds from {rows[~stuck]['elasticity'].min():.3g}"] if not stuck.all() else []
        shown = ", ".join(sides)
        wanted = f"on its sides of the oracle's threshold, {critical:.4g}"
        found.append(Check(f"Ad = {adhesiveness:g}: lambda in LIGGGHTS", shown, wanted, right))
        line = exact[exact["adhesiveness"] == adhesiveness].sort_values("elasticity")["e_eff"]
        least = float(line.diff().min())
        found.append(Check(f"Ad = {adhesiveness:g}: smallest rise of e_eff along lambda (oracle)", least, ">= 0", least >= -1e-12))
    spread = max(constants) / min(constants) - 1
    found.append(Check("lambda_crit/Ad^(5/2), spread over Ad", spread, "<= 1e-8 (eq. 25)", spread <= POWER_TOLERANCE))
    first = min(settings.adhesiveness)
    top = exact[exact["adhesiveness"] == first].sort_values("elasticity").iloc[-1]
    limit = float(top["e_eff"] / top["restitution_coefficient"])
    free = abs(limit - 1) <= WITHOUT_ADHESION
    found.append(Check(f"Ad = {first:g}: e_eff/e at the largest lambda", limit, "1 within 1 %: as without adhesion", free))
    return found


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 7 or 8: e_eff/e over lambda."""
    figure, (axes,) = panels(1, (7.2, 4.8))
    for number, adhesiveness in enumerate(settings.adhesiveness):
        colour, marker = LOOKS[number]
        rows = table[table["adhesiveness"] == adhesiveness].sort_values("elasticity")
        for engine, style in (("oracle", {"linestyle": "-", "linewidth": 1.4}), ("liggghts", {"linestyle": "none", "marker": marker})):
            mine = rows[rows["engine"] == engine]
            label = f"Ad = {adhesiveness:g}" if engine == "liggghts" else None
            axes.plot(mine["elasticity"], mine["e_eff"] / mine["restitution_coefficient"], color=colour, markerfacecolor="none",
                      markersize=6.5, markeredgewidth=1.4, label=label, **style)  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(settings.lowest / 1.5, settings.highest * 1.5)
    axes.set_ylim(-0.03, 1.05)
    if settings.rule == "scaled":
        axes.axvline(settings.base_elasticity, color="0.75", linewidth=0.8, zorder=0)
        axes.annotate("base value", (settings.base_elasticity, 0.02), xycoords=("data", "axes fraction"), xytext=(4, 8),
                      textcoords="offset points", fontsize=STYLE["legend"], color="0.4")  # fmt: skip
    what = r"$\gamma_{\rm mod}$ of eq. 24" if settings.rule == "scaled" else r"$\gamma$ unchanged"
    axes.set_xlabel(r"elasticity parameter $\lambda = E/(\rho_{\rm p} v^2)$", fontsize=STYLE["label"])
    axes.set_ylabel(r"$e_{\rm eff}/e$", fontsize=STYLE["label"])
    title = f"two equal spheres head-on, $e$ = {settings.restitution_coefficient:g}, {what} (lines: oracle, markers: LIGGGHTS)"
    axes.set_title(title, fontsize=STYLE["title"] - 1)
    legend = figure.legend(loc="outside lower center", ncols=len(settings.adhesiveness), fontsize=STYLE["legend"], frameon=False)
    legend.set_title(r"Ad = $\gamma/(\rho_{\rm p} v^2 R)$" + (" at the base value" if settings.rule == "scaled" else ""),
                     prop={"size": STYLE["legend"]})  # fmt: skip
    return {"similarity": figure}
