# Law: adhesive rolling resistance of a sphere that is rolled along a wall at its equilibrium overlap.
# Covers: Haervig et al. 2017 sections 2.2 and 3.2, fig. 4, eqs 18-22 and 24.
# Assumes: a = a_0 throughout, rolling without slip at a prescribed spin; no friction, so that the torque is that of rolling alone.
"""Rolling torque over rolled distance: the real contact, two reduced ones, and the one mended as in section 3.2."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field

from pyjkr.cost.variants import changed
from pyjkr.oracle import rolling
from pyjkr.oracle.normal import NormalContact, equilibrium_contact_radius, equilibrium_overlap, pull_off_force
from pyjkr.plot import BLUE, GREEN, STYLE, VERMILION, panels
from pyjkr.studies import lanes
from pyjkr.studies.check import Check

VERSION = 1
VARIANTS = ("original", "E reduced", "E and gamma reduced", "corrected")
LOOKS = {
    "original": ("black", "-", "o", 8),
    "E reduced": (VERMILION, ":", "s", 5),
    "E and gamma reduced": (BLUE, "--", "D", 5),
    "corrected": (GREEN, "-.", "x", 6),
}
NAMES = {
    "original": r"original $E$, $\gamma$",
    "E reduced": r"$E$ reduced, $\gamma$ real",
    "E and gamma reduced": r"$E$ and $\gamma$ reduced (eq. 24)",
    "corrected": r"reduced, real $F_{\rm C}$ and $\xi_{\rm crit}$ (sec. 3.2)",
}
# Of torques over M_crit. The overlap is rounded to 1e-16 r and a/a_0 with it; the position drifts by round-off of 1e-16 r a step.
TOLERANCE = 1e-9
# Any will do: nothing moves but as prescribed [s].
TIME_STEP = 1e-9


class Settings(BaseModel):
    """What fig. 4 is drawn for."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    scene: str = "dahneke"
    """Shipped case that gives the sphere, the materials and the normal law."""
    modulus_ratio: float = Field(default=0.1, gt=0, lt=1)
    """E_mod/E of the reduced contacts."""
    adhesion_hysteresis: float = Field(default=0.3, gt=0)
    """dgamma/gamma of eq. 18 [-]."""
    reach: float = Field(default=1.5, gt=1)
    """Rolled distance, in units of the largest critical one."""
    steps: int = Field(default=240, ge=20)
    """Time steps in which it is rolled."""


def points(settings: Settings) -> list[dict]:
    """One point per contact; each is rolled in LIGGGHTS, with the law of the oracle beside it."""
    _, digest = lanes.shipped(settings.scene)
    # E alone reduced has the largest critical displacement, a_0 q^(-1/3)
    reach = settings.reach * settings.modulus_ratio ** (-1 / 3)
    return [
        {
            "label": variant,
            "engine": "liggghts",
            "scene": settings.scene,
            "scene_sha256": digest,
            "variant": variant,
            "modulus_ratio": 1.0 if variant == "original" else settings.modulus_ratio,
            "adhesion_hysteresis": settings.adhesion_hysteresis,
            "reach": reach,
            "steps": settings.steps,
        }
        for variant in VARIANTS
    ]


def evaluate(point: dict, directory: Path) -> list[dict]:
    """Torque on a sphere that rolls from rest at its equilibrium overlap, step by step."""
    scene = _scene(point)
    case = lanes.only_case(scene)
    contact, radius = lanes.normal_contact(case.pair, scene.model.normal), case.radii[0]
    real = lanes.same_scene(point).meeting
    original = NormalContact(radius, real.effective_modulus, real.surface_energy)
    original_critical = float(rolling.critical_displacement_krijt(equilibrium_contact_radius(original), point["adhesion_hysteresis"]))
    overlap = float(equilibrium_overlap(contact))
    rolling_speed = point["reach"] * original_critical / (point["steps"] * TIME_STEP)
    spin = rolling_speed / radius
    # LIGGGHTS' contact point lies half way into the overlap: at this speed of the centre it does not slip
    lane = lanes.Lane(height=radius - overlap, spin=spin, speed=spin * (radius - 0.5 * overlap))
    frame = lanes.run(
        case, scene, [lane], directory, steps=point["steps"], density_factor=lanes.HEAVY, time_step=TIME_STEP, periodic=True
    )  # fmt: skip
    # section 3.2: the real values decide F_C and xi_crit where they are kept
    deciding = original if point["variant"] in ("original", "corrected") else contact
    stiffness = float(rolling.rolling_stiffness(pull_off_force(deciding), 1.0))
    critical = float(rolling.critical_displacement_krijt(equilibrium_contact_radius(deciding), point["adhesion_hysteresis"]))
    return [
        {
            "variant": point["variant"],
            "distance": step * TIME_STEP * rolling_speed,
            "torque": -torque,
            "torque_oracle": stiffness * min(step * TIME_STEP * rolling_speed, critical),
            "rolling_stiffness": stiffness,
            "critical_displacement": critical,
        }
        for step, torque in zip(frame["step"].tolist(), frame["tqy"].tolist(), strict=True)
    ]


def _scene(point: dict):
    """The scene of a contact with rolling; its one speed serves the plan alone."""
    contact: dict = {"adhesion_hysteresis": point["adhesion_hysteresis"]}
    scene = lanes.same_scene(point)
    ratio = point["modulus_ratio"]
    if point["variant"] == "E reduced":
        contact["effective_modulus"], ratio = scene.meeting.effective_modulus * ratio, 1.0
    return changed(
        scene,
        model={"rolling_friction": "krijt", "tangential": "off"},
        contact=contact,
        reduction={
            "modulus_ratios": (ratio,),
            "unmodified_ratios": None,
            "maximum_overlap": 1.0,
            "use_original_surface_energy": point["variant"] == "corrected",
        },
        impact={"speeds": (1e-3,)},
    )


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Slope and plateau of every torque, and that the mended one is the real one."""
    q = settings.modulus_ratio
    found = []
    for variant in VARIANTS:
        rows = table[table["variant"] == variant]
        error = lanes.worst((rows["torque"] - rows["torque_oracle"]) / rows["torque_oracle"].max())
        found.append(Check(f"{variant}: torque, LIGGGHTS - oracle, over M_crit", error, "<= 1e-9", error <= TOLERANCE))
    stiffness = {variant: _slope(table[table["variant"] == variant]) for variant in VARIANTS}
    plateau = {variant: float(table[table["variant"] == variant]["torque"].iloc[-1]) for variant in VARIANTS}
    first = table[table["variant"] == "original"].iloc[0]
    found.append(_ratio("original: slope over k_r = 4 F_C", stiffness["original"] / first["rolling_stiffness"], 1.0, "1"))
    critical = first["rolling_stiffness"] * first["critical_displacement"]
    found.append(_ratio("original: plateau over 4 F_C a_0/12 dgamma/gamma", plateau["original"] / critical, 1.0, "1"))
    expected = {
        "E reduced": (1.0, q ** (-1 / 3), "1", "(E_mod/E)^(-1/3)"),
        "E and gamma reduced": (q**0.4, q**0.2, "(E_mod/E)^(2/5)", "(E_mod/E)^(1/5)"),
        "corrected": (1.0, 1.0, "1", "1"),
    }
    for variant, (slope, level, slope_name, level_name) in expected.items():
        found.append(_ratio(f"{variant}: slope over the real one", stiffness[variant] / stiffness["original"], slope, slope_name))
        found.append(_ratio(f"{variant}: plateau over the real one", plateau[variant] / plateau["original"], level, level_name))
    both = [table[table["variant"] == variant]["torque"].to_numpy() for variant in ("corrected", "original")]
    apart = lanes.worst((both[0] - both[1]) / plateau["original"])
    found.append(Check("corrected - original torque, over M_crit", apart, "<= 1e-9", apart <= TOLERANCE))
    return found


def _slope(rows: pd.DataFrame) -> float:
    """Torque per rolled distance [N], fitted over the elastic part."""
    elastic = rows[rows["distance"] <= 0.95 * rows["critical_displacement"]]
    return float(np.polyfit(elastic["distance"] / elastic["distance"].max(), elastic["torque"], 1)[0] / elastic["distance"].max())


def _ratio(name: str, measured: float, wanted: float, words: str) -> Check:
    value = words if words == "1" else f"{words} = {wanted:.6g}"
    return Check(name, float(measured), f"{value} within 1e-9", bool(abs(measured / wanted - 1) <= TOLERANCE))


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 4: torque over rolled distance, in units of the real contact's limit."""
    figure, (axes,) = panels(1, (7.2, 4.8))
    first = table[table["variant"] == "original"].iloc[0]
    length = first["critical_displacement"]
    torque = first["rolling_stiffness"] * length
    for variant in VARIANTS:
        colour, style, marker, size = LOOKS[variant]
        rows = table[table["variant"] == variant]
        shown = rows.iloc[:: max(1, settings.steps // 24)]
        axes.plot(rows["distance"] / length, rows["torque_oracle"] / torque, style, color=colour, linewidth=1.6, label=NAMES[variant])
        axes.plot(shown["distance"] / length, shown["torque"] / torque, marker, color=colour, markersize=size,
                  markerfacecolor="none", linestyle="none", label="LIGGGHTS")  # fmt: skip
    axes.set_xlim(0, table["distance"].max() / length)
    axes.set_ylim(0, 1.15 * table["torque"].max() / torque)
    axes.set_xlabel(r"rolled distance $\xi/\xi_{\rm crit}$ (of the original contact)", fontsize=STYLE["label"])
    axes.set_ylabel(r"rolling torque $M_{\rm r}/M_{\rm crit}$", fontsize=STYLE["label"])
    axes.set_title(rf"torque of a rolling sphere at $a = a_0$, $E_{{\rm mod}}/E$ = {settings.modulus_ratio:g}", fontsize=STYLE["title"])
    figure.legend(loc="outside lower center", ncols=2, fontsize=STYLE["legend"], frameon=False)
    return {"rolling_torque": figure}
