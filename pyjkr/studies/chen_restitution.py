# Law: full JKR with viscous damping, one normal impact on a wall at the real and at reduced stiffness.
# Covers: Chen, Liu, Li 2019 section 2.2, figs 2 and 3, eqs 1a, 4-8 and 10.
# Assumes: polystyrene of table 1 and a sphere of Dahneke's size; the paper's own numbers are lost with its formulas.
"""Restitution and collision time over speed: without adhesion, with gamma left alone, and with gamma_mod of eq. 10."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field, PositiveFloat, model_validator

from pyjkr import scaling
from pyjkr.oracle import NormalContact, impact, sticking_speed
from pyjkr.plan import plan
from pyjkr.plot import LINE_STYLES, SCALED_MARKERS, STYLE, panels
from pyjkr.studies import impacts, polystyrene
from pyjkr.studies.check import Check

VERSION = 1
RULES = ("no adhesion", "unmodified", "scaled")
# e_eff in LIGGGHTS, between stiffnesses and from the oracle; of the oracle between stiffnesses; of scaled collision times.
LIGGGHTS_TOLERANCE, ORACLE_TOLERANCE, TIME_TOLERANCE = 2e-3, 1e-9, 1e-3
# What leaving gamma alone must change somewhere, for the figure to have a point.
PLAIN_TO_SEE = 0.1


class Settings(polystyrene.Sphere):
    """What figs 2 and 3 are drawn for."""

    law: Literal["jkr", "jkr/simplified"] = "jkr"
    """Normal law."""
    restitution_coefficient: float = Field(default=0.86, gt=0.05, le=1)
    """e without adhesion [-]."""
    modulus_ratios: tuple[PositiveFloat, ...] = (1.0, 0.26, 0.026)
    """E_mod/E, from the surface energies of table 1; 1 is the real stiffness and has to be there."""
    speeds: tuple[PositiveFloat, ...] = Field(default=(0.8, 1.1, 1.4, 2.0, 3.5, 6.0, 10.0), min_length=1)
    """Impact speeds in LIGGGHTS [m/s]."""
    steps_per_collision: int = Field(default=1000, ge=10)
    """Time steps per collision."""
    curve_points: int = Field(default=90, ge=5)
    """Speeds of each line of the oracle."""

    @model_validator(mode="after")
    def _real_stiffness_is_there(self) -> Settings:
        if 1.0 not in self.modulus_ratios:
            raise ValueError("modulus_ratios lacks 1.0, the real stiffness that the others are compared with. Add it.")
        return self


def points(settings: Settings) -> list[dict]:
    """Per rule and stiffness one line of the oracle, and an impact in LIGGGHTS per speed; without adhesion the oracle alone."""
    found = []
    for rule in RULES:
        for ratio in settings.modulus_ratios:
            if rule == "unmodified" and ratio == 1:
                continue
            real = settings.surface_energy
            energy = {"no adhesion": 0.0, "unmodified": real, "scaled": scaling.surface_energy_mod(real, ratio)}[rule]
            common = {
                "rule": rule,
                "modulus_ratio": ratio,
                "law": settings.law,
                "radius": settings.radius,
                "density": settings.density,
                "effective_modulus": settings.effective_modulus * ratio,
                "surface_energy": energy,
                "restitution_coefficient": settings.restitution_coefficient,
            }
            label = f"q = {ratio:g}, {rule}"
            line = {"speeds": list(settings.speeds), "curve_points": settings.curve_points}
            found.append({"label": f"oracle, {label}", "engine": "oracle", **common, **line})
            for speed in settings.speeds if rule != "no adhesion" else ():
                step = {"speed": speed, "steps_per_collision": settings.steps_per_collision}
                found.append({"label": f"{speed:g} m/s, {label}", "engine": "liggghts", **common, **step})
    return found


def evaluate(point: dict, directory: Path) -> list[dict]:
    """One line of the oracle, or one impact in LIGGGHTS beside the oracle's."""
    keys = {name: point[name] for name in ("engine", "rule", "modulus_ratio")}
    sphere = polystyrene.Sphere(**{name: point[name] for name in polystyrene.Sphere.model_fields})
    if point["engine"] == "oracle":
        return [{**keys, **row} for row in _line(point, sphere)]
    scene = polystyrene.impact_on_wall(sphere, point["speed"], point["restitution_coefficient"], point["law"], point["steps_per_collision"])
    _, found = impacts.outcome(scene, "liggghts", directory)
    _, exact = impacts.outcome(scene, "oracle", directory)
    row = {"speed": point["speed"], "e_eff": found.restitution, "e_eff_oracle": exact.restitution}
    return [{**keys, **row, "contact_time": found.contact_time, "contact_time_oracle": exact.contact_time}]


def _line(point: dict, sphere: polystyrene.Sphere) -> list[dict]:
    """e_eff and collision time of the oracle: at the speeds of LIGGGHTS, and from just above sticking on."""
    e, law = point["restitution_coefficient"], point["law"]
    contact = NormalContact(sphere.radius, sphere.effective_modulus, sphere.surface_energy, law, e)
    mass = plan(polystyrene.impact_on_wall(sphere, 1.0, e, law, 100)).cases[0].pair.effective_mass
    sticking = sticking_speed(contact, mass)
    slowest, fastest = min(point["speeds"]), max(point["speeds"])
    speeds = np.array(point["speeds"])
    if sticking < fastest:
        near = max(slowest - sticking, 1e-5 * sticking)
        speeds = np.union1d(speeds, sticking + np.geomspace(near, fastest - sticking, point["curve_points"])[:-1])
    if slowest < sticking < fastest:
        speeds = np.union1d(speeds, sticking * (1 - 1e-9))  # the last that sticks: the line has a corner there
    rows = []
    for speed in speeds.tolist():
        found = impact(contact, mass, speed, samples=2, stuck_periods=0.01)
        rows.append({"speed": speed, "e_eff_oracle": found.restitution, "contact_time_oracle": found.contact_time})
    return [row | {"sticking_speed": sticking, "given": row["speed"] in point["speeds"]} for row in rows]


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Eq. 10 keeps the rebound and stretches the time; without it sticking spreads; without adhesion nothing changes."""
    runs, lines = (table[table["engine"] == engine] for engine in ("liggghts", "oracle"))
    given = lines[lines["given"].astype("boolean").fillna(False)]
    error = float((runs["e_eff"] - runs["e_eff_oracle"]).abs().max(skipna=False))
    found = [Check("e_eff, LIGGGHTS - oracle, all impacts", error, "<= 2e-3", error <= LIGGGHTS_TOLERANCE)]
    for rows, engine, column, tolerance in (
        (runs, "LIGGGHTS", "e_eff", LIGGGHTS_TOLERANCE),
        (given, "oracle", "e_eff_oracle", ORACLE_TOLERANCE),
    ):
        apart = _spread(rows[rows["rule"] == "scaled"], column)
        found.append(Check(f"e_eff between stiffnesses with gamma_mod of eq. 10, {engine}", apart, f"<= {tolerance:g}", apart <= tolerance))
    apart = _spread(given[given["rule"] == "no adhesion"], "e_eff_oracle")
    found.append(Check("e_eff between stiffnesses without adhesion, oracle", apart, "<= 1e-9", apart <= ORACLE_TOLERANCE))
    real = runs[(runs["rule"] == "scaled") & (runs["modulus_ratio"] == 1)].set_index("speed")
    for ratio, rows in runs[runs["rule"] == "unmodified"].groupby("modulus_ratio"):
        change = float((rows["speed"].map(real["e_eff"]) - rows["e_eff"]).max())
        name = f"largest fall of e_eff at E_mod/E = {ratio:g} with gamma left alone, LIGGGHTS"
        found.append(Check(name, change, f">= {PLAIN_TO_SEE:g}", change >= PLAIN_TO_SEE))
    thresholds = lines.drop_duplicates(["rule", "modulus_ratio"]).set_index(["rule", "modulus_ratio"])["sticking_speed"]
    for (rule, ratio), speed in thresholds.items():
        if rule == "unmodified":
            wanted = ratio ** (-1 / 3)
            over = float(speed / thresholds[("scaled", 1.0)])
            name = f"sticking speed at E_mod/E = {ratio:g}, gamma left alone, over the real one"
            found.append(Check(name, over, f"(E_mod/E)^(-1/3) = {wanted:.4g} within 1e-8", abs(over / wanted - 1) <= 1e-8))
    for ratio, rows in runs[runs["rule"] == "scaled"].groupby("modulus_ratio"):
        if ratio != 1:
            over = rows["contact_time"] / rows["speed"].map(real["contact_time"]) / scaling.time_factor(ratio)
            worst = float((over - 1).abs().max())
            name = f"collision time at E_mod/E = {ratio:g} over the real one, from (E_mod/E)^(-2/5), LIGGGHTS"
            found.append(Check(name, worst, "<= 1e-3", worst <= TIME_TOLERANCE))
    return found


def _spread(rows: pd.DataFrame, column: str) -> float:
    """Largest difference at one speed; NaN, which fulfils nothing, where there is but one stiffness."""
    several = rows.groupby("speed").filter(lambda group: len(group) > 1)
    groups = several.groupby("speed")[column]
    return float((groups.max() - groups.min()).max()) if len(several) else float("nan")


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Chen 2019, figs 2 (a, b) and 3 (a, b)."""
    runs, lines = (table[table["engine"] == engine] for engine in ("liggghts", "oracle"))
    left, (hertz, alone) = panels(2, (9.2, 4.6))
    right, (scaled, time) = panels(2, (9.2, 4.6))
    shown = ((hertz, "no adhesion", "e_eff"), (alone, "unmodified", "e_eff"), (scaled, "scaled", "e_eff"), (time, "scaled", "contact_time"))
    for axes, rule, column in shown:
        factor = 1e9 if column == "contact_time" else 1.0
        for number, ratio in enumerate(settings.modulus_ratios):
            of = "scaled" if ratio == 1 and rule == "unmodified" else rule
            line, impacts_ = (rows[(rows["rule"] == of) & (rows["modulus_ratio"] == ratio)] for rows in (lines, runs))
            marker, size, colour = SCALED_MARKERS[number % len(SCALED_MARKERS)]
            if rule != "unmodified":
                style = LINE_STYLES[number % len(LINE_STYLES)]
            else:
                size, style = 6, "-"
            label = rf"$E_{{\rm mod}}/E$ = {ratio:g}"
            axes.plot(line["speed"], factor * line[f"{column}_oracle"], style, color=colour, linewidth=1.5, label=f"oracle, {label}")
            if len(impacts_):
                axes.plot(impacts_["speed"], factor * impacts_[column], marker, markersize=size, color=colour, markerfacecolor="none",
                          markeredgewidth=1.4, linestyle="none", label=f"LIGGGHTS, {label}", clip_on=False)  # fmt: skip
        axes.set_xscale("log")
        marks = [mark for mark in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50) if min(settings.speeds) <= mark <= max(settings.speeds)]
        axes.set_xticks(marks, [f"{mark:g}" for mark in marks])
        axes.set_xticks([], minor=True)
        axes.set_xlim(0.93 * min(settings.speeds), 1.07 * max(settings.speeds))
        axes.set_xlabel("impact speed $v$ [m/s]", fontsize=STYLE["label"])
        if column == "e_eff":
            axes.set_ylim(-0.02, 1)
            axes.set_ylabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=STYLE["label"])
        else:
            axes.set_yscale("log")
            values = factor * table.loc[table["rule"] == rule, f"{column}_oracle"].dropna()
            ticks = [tick for tick in (1, 2, 5, 10, 20, 50, 100, 200, 500) if 0.8 * values.min() <= tick <= 1.25 * values.max()]
            axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
            axes.set_yticks([], minor=True)
            axes.set_ylim(0.8 * values.min(), 1.25 * values.max())
            axes.set_ylabel(r"collision time $t_{\rm C}$ [ns]", fontsize=STYLE["label"])
    hertz.set_title("without adhesion", fontsize=STYLE["title"])
    alone.set_title(r"$\gamma$ left alone", fontsize=STYLE["title"])
    scaled.set_title(r"$\gamma_{\rm mod} = \gamma\,(E_{\rm mod}/E)^{2/5}$", fontsize=STYLE["title"])
    time.set_title("the same impacts", fontsize=STYLE["title"])
    for figure, axes in ((left, alone), (right, scaled)):
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=STYLE["legend"], frameon=False)
    return {"restitution_reduced": left, "restitution_corrected": right}
