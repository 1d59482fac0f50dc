# Law: simplified JKR, one normal impact on a wall at the real and at reduced stiffness.
# Covers: Haervig et al. 2017 section 4, fig. 5, eqs 3, 7-13 and 24.
# Assumes: what the scene assumes; no experiment is drawn, for no numbers of it are at hand.
"""Effective restitution coefficient over impact speed, with and without eq. 24."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat

from pyjkr import plan
from pyjkr.contact import maximum_overlap
from pyjkr.oracle.impact import sticking_speed
from pyjkr.plot import LINE_STYLES, SCALED_MARKERS, STYLE, UNMODIFIED_MARKERS, panels
from pyjkr.studies import impacts, lanes
from pyjkr.studies.check import Check

VERSION = 1
RESTITUTION_TOLERANCE = 2e-3
# Of e_eff between stiffnesses with eq. 24: the discrete steps are similar too, only round-off differs.
SIMILARITY_TOLERANCE = 1e-6


class Settings(BaseModel):
    """What fig. 5 is drawn for; None takes what the scene has."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    scene: str = "dahneke"
    """Shipped case that gives the sphere, the wall, the law and whatever is not set here."""
    speeds: Annotated[tuple[PositiveFloat, ...], Field(min_length=1)] | None = None
    """Impact speeds [m/s]."""
    steps_per_collision: int | None = Field(default=None, ge=10)
    """Time steps per collision."""
    curve_points: int = Field(default=60, ge=5)
    """Speeds of each line of the oracle."""


def points(settings: Settings) -> list[dict]:
    """One point per speed, stiffness and rule in LIGGGHTS; and one line of the oracle per stiffness and rule."""
    scene, digest = lanes.shipped(settings.scene)
    reduction = scene.reduction
    groups = [("scaled", q) for q in reduction.modulus_ratios] + [("unmodified", q) for q in reduction.unmodified_ratios]
    speeds = settings.speeds or scene.impact.speeds
    common = {
        "scene": settings.scene,
        "scene_sha256": digest,
        "steps_per_collision": settings.steps_per_collision or scene.impact.steps_per_collision,
    }
    found = []
    for rule, ratio in groups:
        about = {**common, "rule": rule, "modulus_ratio": ratio}
        shallow = [speed for speed in speeds if not _too_deep(scene, speed, ratio, rule)]
        if not shallow:
            continue
        for speed in shallow:
            found.append({"label": f"{speed:g} m/s, q = {ratio:g}, {rule}", "engine": "liggghts", **about, "speed": speed})
        found.append(
            {
                "label": f"oracle, q = {ratio:g}, {rule}",
                "engine": "oracle",
                **about,
                "slowest": min(speeds),
                "fastest": max(speeds),
                "curve_points": settings.curve_points,
            }
        )
    return found


def _too_deep(scene, speed: float, ratio: float, rule: str) -> bool:
    """Whether the plan leaves an impact out, since it presses deeper than the scene allows."""
    deepest = maximum_overlap(plan.pair_properties(scene, ratio, rule), speed)
    return deepest / scene.impact.sphere_radius > scene.reduction.maximum_overlap


def evaluate(point: dict, directory: Path) -> list[dict]:
    """One impact in LIGGGHTS beside the oracle's, or one line of the oracle."""
    scene = lanes.same_scene(point)
    keys = {name: point[name] for name in ("engine", "rule", "modulus_ratio")}
    if point["engine"] == "oracle":
        return [{**keys, **row} for row in _curve(scene, point)]
    scene = impacts.alone(scene, point["speed"], point["modulus_ratio"], point["rule"], point["steps_per_collision"])
    case, found = impacts.outcome(scene, "liggghts", directory)
    _, exact = impacts.outcome(scene, "oracle", directory)
    return [
        {
            **keys,
            "speed": point["speed"],
            "e_eff": found.restitution,
            "e_eff_oracle": exact.restitution,
            "stuck": found.stuck,
            "stuck_oracle": exact.stuck,
            "contact_time": found.contact_time,
            "contact_time_oracle": exact.contact_time,
            "time_step": case.time_step,
            "steps": found.steps,
        }
    ]


def _curve(scene, point: dict) -> list[dict]:
    """e_eff of the oracle; its speeds crowd above the sticking speed, where e_eff rises like a square root."""
    pair = plan.pair_properties(scene, point["modulus_ratio"], point["rule"])
    contact = lanes.normal_contact(pair, scene.model.normal)
    slowest, fastest = point["slowest"], point["fastest"]
    threshold = sticking_speed(contact, pair.effective_mass, relative_tolerance=1e-10)
    sticking = [slowest, threshold] if slowest < threshold < fastest else [slowest] if slowest < threshold else []
    gap = max(slowest - threshold, 1e-4 * fastest)
    above = threshold + np.geomspace(gap, fastest - threshold, point["curve_points"]) if threshold < fastest else np.array([fastest])
    rows = [{"speed": float(speed), "e_eff_oracle": 0.0, "sticking_speed": threshold} for speed in sticking]
    for speed in above.tolist():
        e_eff = impacts.restitution(contact, pair.effective_mass, speed)
        rows.append({"speed": speed, "e_eff_oracle": e_eff, "sticking_speed": threshold})
    return rows


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """LIGGGHTS on the lines of the oracle; eq. 24 keeps e_eff, gamma left alone does not."""
    runs, curves = (table[table["engine"] == engine] for engine in ("liggghts", "oracle"))
    error = lanes.worst(runs["e_eff"] - runs["e_eff_oracle"])
    found = [Check("e_eff, LIGGGHTS - oracle, all impacts", error, "<= 2e-3", error <= RESTITUTION_TOLERANCE)]
    unlike = int((runs["stuck"].astype(bool) != runs["stuck_oracle"].astype(bool)).sum())
    found.append(Check("impacts that stick in one and rebound in the other", unlike, "0", unlike == 0 and len(runs) > 0))
    scaled = runs[runs["rule"] == "scaled"]
    for what, column, tolerance, words in (
        ("LIGGGHTS", "e_eff", SIMILARITY_TOLERANCE, "<= 1e-6"),
        ("oracle", "e_eff_oracle", 1e-9, "<= 1e-9"),
    ):
        several = scaled.groupby("speed")[column].filter(lambda values: len(values) > 1)
        spread = scaled.loc[several.index].groupby("speed")[column]
        apart = lanes.worst(spread.max() - spread.min())
        found.append(Check(f"e_eff between stiffnesses with eq. 24, {what}", apart, words, apart <= tolerance))
    thresholds = curves.drop_duplicates(["rule", "modulus_ratio"]).set_index(["rule", "modulus_ratio"])["sticking_speed"]
    real = thresholds.get(("scaled", 1.0), float("nan"))
    for (rule, ratio), speed in thresholds.items():
        if ratio == 1:
            continue
        # Pi = m v^2 R/(F_C a_0^2) decides sticking: v ~ gamma^(5/6) E^(-1/3)
        wanted = 1.0 if rule == "scaled" else ratio ** (-1 / 3)
        words = "1" if rule == "scaled" else f"(E_mod/E)^(-1/3) = {wanted:.4g}"
        found.append(
            Check(
                f"sticking speed at E_mod/E = {ratio:g}, gamma {rule}, over the real one",
                float(speed / real),
                f"{words} within 1e-8",
                bool(abs(speed / real / wanted - 1) <= 1e-8),
            )
        )
    return found


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 5: e_eff over impact speed. The model alone, no experiment."""
    scene, _ = lanes.shipped(settings.scene)
    figure, (axes,) = panels(1, (7.2, 5.0))
    groups = list(dict.fromkeys(zip(table["rule"], table["modulus_ratio"], strict=True)))
    runs, curves = (table[table["engine"] == engine] for engine in ("liggghts", "oracle"))
    drawn = {"scaled": 0, "unmodified": 0}
    for rule, ratio in groups:
        number, drawn[rule] = drawn[rule], drawn[rule] + 1
        mine = [rows[(rows["rule"] == rule) & (rows["modulus_ratio"] == ratio)] for rows in (runs, curves)]
        marker, size, colour = (SCALED_MARKERS if rule == "scaled" else UNMODIFIED_MARKERS)[number]
        energy = r"$\gamma$ real" if ratio == 1 or rule == "unmodified" else r"$\gamma_{\rm mod}$ of eq. 24"
        if rule == "unmodified" or number == 0:
            look = {"color": "black" if rule == "scaled" else "0.55", "linewidth": 1.3}
            style = "-" if rule == "scaled" else LINE_STYLES[1 + number % 3]
            axes.plot(mine[1]["speed"], mine[1]["e_eff_oracle"], style, zorder=1, label=f"oracle, $q$ = {ratio:g}, {energy}", **look)
        axes.plot(mine[0]["speed"], mine[0]["e_eff"], marker, markersize=size, color=colour, markerfacecolor="none", zorder=3,
                  markeredgewidth=1.5, clip_on=False, linestyle="none", label=f"LIGGGHTS, $q$ = {ratio:g}, {energy}")  # fmt: skip
    axes.set_xscale("log")
    slowest, fastest = table["speed"].min(), table["speed"].max()
    marks = [value for value in (0.1, 0.2, 0.5, 1, 2, 3, 5, 7, 10, 20, 50, 100) if slowest <= value <= fastest]
    axes.set_xticks(marks, [f"{mark:g}" for mark in marks])
    axes.set_xticks([], minor=True)
    axes.set_xlim(0.93 * slowest, 1.07 * fastest)
    axes.set_ylim(-0.02, 1.0)
    e = scene.meeting.restitution_coefficient
    axes.axhline(e, color="0.75", linewidth=0.8, zorder=0)
    axes.annotate(f"without adhesion, $e$ = {e:g}", (0.01, e), xycoords=("axes fraction", "data"), xytext=(0, 3),
                  textcoords="offset points", fontsize=STYLE["legend"], color="0.4")  # fmt: skip
    axes.set_xlabel("impact speed $v$ [m/s]", fontsize=STYLE["label"])
    axes.set_ylabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=STYLE["label"])
    axes.set_title(f"{scene.title}; $q = E_{{\\rm mod}}/E$", fontsize=STYLE["title"])
    figure.legend(loc="outside lower center", ncols=2, fontsize=STYLE["legend"], frameon=False)
    return {"wall_restitution": figure}
