# Law: simplified JKR, the velocity during one normal impact on a wall at several stiffnesses.
# Covers: Haervig et al. 2017 section 6.2, fig. 13, eq. 24; times as (E/E_mod)^(2/5).
# Assumes: what the scene assumes; surface energies of eq. 24.
"""Velocity over time of one collision, and over scaled time, where all stiffnesses fall on one curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat

from pyjkr import scaling
from pyjkr.errors import SceneError
from pyjkr.plot import BLUE, GREEN, STYLE, VERMILION, panels
from pyjkr.studies import impacts, lanes
from pyjkr.studies.check import Check

VERSION = 1
COLOURS = ("black", BLUE, VERMILION, GREEN)
LINES = ("-", "--", ":", "-.")
TIME_TOLERANCE = 1e-3
RESTITUTION_TOLERANCE = 2e-3
# Of the velocity between stiffnesses at equal scaled times, over the impact speed: the discrete steps are similar.
SIMILARITY_TOLERANCE = 1e-6
# Frames kept before the contact and after it, in parts of the contact time.
MARGIN = 0.15


class Settings(BaseModel):
    """What fig. 13 is drawn for."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    scene: str = "dahneke"
    """Shipped case that gives the sphere, the wall and the law."""
    speed: float | None = Field(default=None, gt=0)
    """Impact speed [m/s]; None takes `figures.velocity_speed` of the scene."""
    modulus_ratios: tuple[PositiveFloat, ...] = Field(default=(1.0, 0.1, 0.01), min_length=2, max_length=4)
    """E_mod/E, the real stiffness first."""
    steps_per_collision: int | None = Field(default=None, ge=10)
    """Time steps per collision; None takes what the scene has."""


def points(settings: Settings) -> list[dict]:
    """One impact per stiffness."""
    scene, digest = lanes.shipped(settings.scene)
    speed = settings.speed or scene.figures.velocity_speed
    if speed is None:
        raise SceneError(f"{scene.source}: figures: velocity_speed is missing. Give it, or speed in the sweep's settings.")
    return [
        {
            "label": f"q = {ratio:g}",
            "engine": "liggghts",
            "scene": settings.scene,
            "scene_sha256": digest,
            "speed": speed,
            "modulus_ratio": ratio,
            "steps_per_collision": settings.steps_per_collision or scene.impact.steps_per_collision,
        }
        for ratio in settings.modulus_ratios
    ]


def evaluate(point: dict, directory: Path) -> list[dict]:
    """Velocity at the frames of one impact, the oracle's beside it."""
    scene = impacts.alone(lanes.same_scene(point), point["speed"], point["modulus_ratio"], "scaled", point["steps_per_collision"])
    case, found = impacts.outcome(scene, "liggghts", directory)
    _, exact = impacts.outcome(scene, "oracle", directory)
    contact_time = exact.contact_time
    if found.stuck or exact.stuck:
        raise SceneError(f"{scene.source}: at {point['speed']:g} m/s the sphere sticks and has no rebound to show. Raise the speed.")
    shown = (found.time >= -MARGIN * contact_time) & (found.time <= (1 + MARGIN) * contact_time)
    times, velocities = found.time[shown], found.velocity[shown]
    inside = np.clip(times, 0.0, contact_time)
    return [
        {
            "modulus_ratio": point["modulus_ratio"],
            "time": float(time),
            "velocity": float(velocity),
            "velocity_oracle": float(velocity_oracle),
            "contact_time": found.contact_time,
            "contact_time_oracle": contact_time,
            "e_eff": found.restitution,
            "e_eff_oracle": exact.restitution,
            "impact_speed": case.normal_speed,
            "time_step": case.time_step,
        }
        for time, velocity, velocity_oracle in zip(times, velocities, np.interp(inside, exact.time, exact.velocity), strict=True)
    ]


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Times go as (E/E_mod)^(2/5), velocities stay."""
    cases = table.drop_duplicates("modulus_ratio").set_index("modulus_ratio")
    real = cases.iloc[0]
    found = []
    for ratio, case in cases.iloc[1:].iterrows():
        factor = scaling.time_factor(ratio / cases.index[0])
        measured = case["contact_time"] / real["contact_time"]
        found.append(
            Check(
                f"contact time at E_mod/E = {ratio:g} over that at {cases.index[0]:g}",
                float(measured),
                f"(E/E_mod)^(2/5) = {factor:.6g} within 0.1 %",
                bool(abs(measured / factor - 1) <= TIME_TOLERANCE),
            )
        )
    spread = float(cases["e_eff"].max() - cases["e_eff"].min())
    found.append(Check("rebound speed over impact speed, spread over stiffnesses", spread, "<= 1e-6", spread <= SIMILARITY_TOLERANCE))
    error = lanes.worst(cases["e_eff"] - cases["e_eff_oracle"])
    found.append(Check("rebound speed over impact speed, LIGGGHTS - oracle", error, "<= 2e-3", error <= RESTITUTION_TOLERANCE))
    late = lanes.worst(cases["contact_time"] / cases["contact_time_oracle"] - 1)
    found.append(Check("contact time, LIGGGHTS over oracle - 1", late, "<= 1e-3", late <= TIME_TOLERANCE))
    away = lanes.worst(_common_times(table, cases).std() / real["impact_speed"])
    found.append(Check("velocity at equal scaled times, spread over stiffnesses, over v", away, "<= 1e-6", away <= SIMILARITY_TOLERANCE))
    return found


def _common_times(table: pd.DataFrame, cases: pd.DataFrame) -> pd.DataFrame:
    """Velocities of all stiffnesses at the scaled times of the first: one row per stiffness."""
    scaled = {ratio: table[table["modulus_ratio"] == ratio].copy() for ratio in cases.index}
    for ratio, rows in scaled.items():
        rows["time"] = rows["time"] / scaling.time_factor(ratio)
    times = scaled[cases.index[0]]["time"]
    return pd.DataFrame([np.interp(times, rows["time"], rows["velocity"]) for rows in scaled.values()])


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 13, and beside it the same over scaled time."""
    figure, (left, right) = panels(2, (8.6, 4.4))
    ratios = list(dict.fromkeys(table["modulus_ratio"]))
    for number, ratio in enumerate(ratios):
        rows = table[table["modulus_ratio"] == ratio]
        time, factor = rows["time"] * 1e9, scaling.time_factor(ratio)
        look = {"color": COLOURS[number], "linewidth": 1.8}
        left.plot(time, rows["velocity"], LINES[number], label=rf"$E_{{\rm mod}}/E$ = {ratio:g}", **look)
        right.plot(time / factor, rows["velocity"], LINES[number], **look)
    # points of the oracle on the common curve: it is smooth there
    rows = table[(table["modulus_ratio"] == ratios[0]) & (table["time"] > 0) & (table["time"] < table["contact_time"])]
    rows = rows.iloc[:: max(1, len(rows) // 18)]
    right.plot(rows["time"] * 1e9 / scaling.time_factor(ratios[0]), rows["velocity_oracle"], "o", color="0.35", markersize=5,
               markerfacecolor="none", linestyle="none", label="oracle")  # fmt: skip
    left.set_xlabel("time since contact $t$ [ns]", fontsize=STYLE["label"])
    right.set_xlabel(r"scaled time $t\,(E_{\rm mod}/E)^{2/5}$ [ns]", fontsize=STYLE["label"])
    left.set_ylabel("velocity towards the wall [m/s]", fontsize=STYLE["label"])
    for axes in (left, right):
        axes.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    right.sharey(left)
    right.tick_params(labelleft=False)
    figure.suptitle(f"one collision at {table['impact_speed'].iloc[0]:g} m/s, LIGGGHTS", fontsize=STYLE["title"])
    figure.legend(loc="outside lower center", ncols=len(ratios) + 1, fontsize=STYLE["legend"], frameon=False)
    return {"collision_velocity": figure}
