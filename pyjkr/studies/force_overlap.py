# Law: simplified JKR normal force at a prescribed overlap, at the real stiffness and at a reduced one.
# Covers: Haervig et al. 2017 section 3.1, fig. 3, eqs 7-10, 23 and 24.
# Assumes: sphere on wall at rest, so that damping takes no part; LIGGGHTS reports the force at step 0.
"""Force over overlap of three contacts: the real one, E alone reduced, E and gamma reduced."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field

from pyjkr.cost.variants import changed
from pyjkr.oracle.normal import elastic_force, equilibrium_overlap, pull_off_force, stored_energy
from pyjkr.plot import BLUE, STYLE, VERMILION, panels
from pyjkr.studies import lanes
from pyjkr.studies.check import Check

VERSION = 1
# Name, modulus ratio is reduced, rule of the surface energy; Haervig 2017, legend of fig. 3.
VARIANTS = ("original", "E reduced", "E and gamma reduced")
LOOKS = {"original": ("black", "-", "o"), "E reduced": (VERMILION, ":", "s"), "E and gamma reduced": (BLUE, "--", "D")}
NAMES = {
    "original": r"original $E$, $\gamma$",
    "E reduced": r"$E$ reduced, $\gamma$ real",
    "E and gamma reduced": r"$E$ and $\gamma$ reduced (eq. 24)",
}
# Overlaps of a Gauss-Legendre rule: the force is smooth between overlap 0 and equilibrium, so 24 give all digits.
NODES = 24
# Least overlap, in parts of that at equilibrium: the surfaces just touch.
TOUCHING = 1e-10
# Of the force in units of F_C: positions are rounded to 1e-16 r, which the stiffness turns into 1e-12 F_C.
FORCE_TOLERANCE = 1e-9
# Of ratios of forces and energies.
RATIO_TOLERANCE = 1e-9


class Settings(BaseModel):
    """What fig. 3 is drawn for."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    scene: str = "dahneke"
    """Shipped case that gives the sphere, the materials and the law."""
    modulus_ratio: float = Field(default=0.1, gt=0, lt=1)
    """E_mod/E of the two reduced contacts."""
    deepest: float = Field(default=2.5, gt=1)
    """Largest overlap, in units of the equilibrium overlap of each contact."""
    markers: int = Field(default=16, ge=4)
    """Overlaps at which LIGGGHTS is asked, per contact, besides those of the integral."""


def points(settings: Settings) -> list[dict]:
    """One point per contact and engine."""
    _, digest = lanes.shipped(settings.scene)
    return [
        {
            "label": f"{variant}, {engine}",
            "engine": engine,
            "scene": settings.scene,
            "scene_sha256": digest,
            "variant": variant,
            "modulus_ratio": 1.0 if variant == "original" else settings.modulus_ratio,
            "deepest": settings.deepest,
            "markers": settings.markers,
        }
        for variant in VARIANTS
        for engine in ("oracle", "liggghts")
    ]


def evaluate(point: dict, directory: Path) -> list[dict]:
    """Force at the overlaps of one contact; the oracle's stand beside those of LIGGGHTS."""
    scene = _scene(point)
    case = lanes.only_case(scene)
    contact = lanes.normal_contact(case.pair, scene.model.normal)
    zero_load = float(equilibrium_overlap(contact))
    common = {
        "variant": point["variant"],
        "engine": point["engine"],
        "pull_off_force": float(pull_off_force(contact)),
        "equilibrium_overlap": zero_load,
        "well_depth": -float(stored_energy(contact, zero_load)),
    }
    if point["engine"] == "oracle":
        overlaps = np.linspace(0.0, point["deepest"] * zero_load, 241)
        forces = np.asarray(elastic_force(contact, overlaps))
        return [
            {**common, "kind": "curve", "overlap": float(d), "force": float(f), "force_oracle": float(f), "weight": 0.0}
            for d, f in zip(overlaps, forces, strict=True)
        ]
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    asked = [("apart", -0.05 * zero_load, 0.0), ("touching", TOUCHING * zero_load, 0.0), ("equilibrium", zero_load, 0.0)]
    asked += [("curve", d, 0.0) for d in np.linspace(0.02, point["deepest"], point["markers"]) * zero_load]
    asked += [("integral", 0.5 * (1 + x) * zero_load, 0.5 * w * zero_load) for x, w in zip(nodes, weights, strict=True)]
    radius = case.radii[0]
    frame = lanes.run(case, scene, [lanes.Lane(height=radius - d) for _, d, _ in asked], directory, steps=0, density_factor=lanes.HEAVY)
    rows = []
    for (kind, _, weight), row in zip(asked, frame.sort_values("id").itertuples(), strict=True):
        # as LIGGGHTS has it, from the rounded position
        overlap = radius - row.z
        exact = float(elastic_force(contact, overlap)) if overlap > 0 else 0.0
        rows.append({**common, "kind": kind, "overlap": overlap, "force": row.fz, "force_oracle": exact, "weight": weight})
    return rows


def _scene(point: dict):
    """The scene of a contact, at rest: one slow speed, for a plan needs one."""
    rules = {"modulus_ratios": (point["modulus_ratio"],), "unmodified_ratios": None}
    scene = changed(lanes.same_scene(point), reduction={**rules, "maximum_overlap": 1.0}, impact={"speeds": (1e-3,)})
    if point["variant"] == "E reduced":
        return _unmodified(scene, point["modulus_ratio"])
    return scene


def _unmodified(scene, modulus_ratio: float):
    """E reduced and gamma left: a scene whose real modulus is the reduced one."""
    contact = scene.meeting
    return changed(scene, contact={"effective_modulus": contact.effective_modulus * modulus_ratio}, reduction={"modulus_ratios": (1.0,)})


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """LIGGGHTS on the curves; what section 3.1 says of the three contacts."""
    runs = table[table["engine"] == "liggghts"]
    found = []
    for variant in VARIANTS:
        rows = runs[runs["variant"] == variant]
        error = lanes.worst((rows["force"] - rows["force_oracle"]) / rows["pull_off_force"])
        found.append(_check(f"{variant}: force, LIGGGHTS - oracle, over F_C", error, "<= 1e-9", error <= FORCE_TOLERANCE))
        first = rows[rows["kind"] == "touching"].iloc[0]
        pull = -first["force"] / first["pull_off_force"]
        found.append(_check(f"{variant}: pull as the surfaces part, over F_C", pull, "8/9 within 1e-9", abs(pull - 8 / 9) <= 1e-9))
    apart = lanes.worst(runs[runs["kind"] == "apart"]["force"])
    found.append(_check("force of parted surfaces [N]", apart, "0", apart == 0))
    at_rest = runs[runs["kind"] == "equilibrium"]
    left = lanes.worst(at_rest["force"] / at_rest["pull_off_force"])
    found.append(_check("force at a_0^2/(3 R), over F_C", left, "<= 1e-9", left <= FORCE_TOLERANCE))

    real, soft, both = (runs[runs["variant"] == variant] for variant in VARIANTS)
    q = settings.modulus_ratio
    found.append(_kept("E reduced: force that breaks contact, over the real one", _touching(soft) / _touching(real)))
    lower = _touching(both) / _touching(real)
    found.append(_kept("E and gamma reduced: force that breaks contact, over the real one", lower, q**0.4, "(E_mod/E)^(2/5)"))
    deeper = _first(soft, "equilibrium_overlap") / _first(real, "equilibrium_overlap")
    found.append(_kept("E reduced: equilibrium overlap, over the real one", deeper, q ** (-2 / 3), "(E_mod/E)^(-2/3)"))
    energies = {variant: _separation_energy(runs[runs["variant"] == variant]) for variant in VARIANTS}
    same = energies["E and gamma reduced"] / energies["original"]
    found.append(_kept("E and gamma reduced: separation energy (eq. 23), over the real one", same))
    more = energies["E reduced"] / energies["original"]
    found.append(_kept("E reduced: separation energy, over the real one", more, q ** (-2 / 3), "(E_mod/E)^(-2/3)"))
    found.append(_kept("original: separation energy, LIGGGHTS over oracle", energies["original"] / _first(real, "well_depth")))
    return found


def _check(name: str, measured: float, wanted: str, holds: bool) -> Check:
    return Check(name, float(measured), wanted, bool(holds))


def _kept(name: str, measured: float, wanted: float = 1.0, words: str = "1") -> Check:
    value = words if words == "1" else f"{words} = {wanted:.6g}"
    return _check(name, measured, f"{value} within 1e-9", abs(measured / wanted - 1) <= RATIO_TOLERANCE)


def _first(rows: pd.DataFrame, column: str) -> float:
    return float(rows[column].iloc[0])


def _touching(rows: pd.DataFrame) -> float:
    return float(rows[rows["kind"] == "touching"]["force"].iloc[0])


def _separation_energy(rows: pd.DataFrame) -> float:
    """Work [J] to pull from equilibrium to overlap 0, from the forces of LIGGGHTS; Haervig 2017, eq. 23."""
    nodes = rows[rows["kind"] == "integral"]
    return -float((nodes["weight"] * nodes["force"]).sum()) if len(nodes) else math.nan


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 3: force over overlap, in units of the real contact."""
    figure, (axes,) = panels(1, (7.2, 4.6))
    real = table[table["variant"] == "original"].iloc[0]
    length, force = real["equilibrium_overlap"], real["pull_off_force"]
    for variant in VARIANTS:
        colour, style, marker = LOOKS[variant]
        rows = table[(table["variant"] == variant) & (table["kind"] == "curve")]
        curve, runs = rows[rows["engine"] == "oracle"], rows[rows["engine"] == "liggghts"]
        axes.plot(curve["overlap"] / length, curve["force"] / force, style, color=colour, linewidth=1.6, label=NAMES[variant])
        # the contact ends at overlap 0
        start = curve.iloc[0]
        axes.plot([0, 0], [0, start["force"] / force], style, color=colour, linewidth=0.9)
        axes.plot(runs["overlap"] / length, runs["force"] / force, marker, color=colour, markersize=5, markerfacecolor="none",
                  label="LIGGGHTS", linestyle="none")  # fmt: skip
    reach = settings.deepest * settings.modulus_ratio**-0.4
    axes.set_xlim(-0.04 * reach, 1.02 * reach)
    axes.set_ylim(-1.15, 2.2)
    axes.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    axes.axhline(-8 / 9, color="0.75", linewidth=0.8, zorder=0)
    axes.annotate(r"$-\frac{8}{9}F_{\rm C}$", (0.99, -8 / 9), xycoords=("axes fraction", "data"), xytext=(0, -4),
                  textcoords="offset points", ha="right", va="top", fontsize=STYLE["legend"], color="0.4")  # fmt: skip
    axes.set_xlabel(r"overlap $\delta_{\rm n}/\delta_{\rm n,0}$ (of the original contact)", fontsize=STYLE["label"])
    axes.set_ylabel(r"force $F_{\rm n}/F_{\rm C}$ (positive: repulsive)", fontsize=STYLE["label"])
    axes.set_title(rf"force of a sphere on a wall, $E_{{\rm mod}}/E$ = {settings.modulus_ratio:g}", fontsize=STYLE["title"])
    figure.legend(loc="outside lower center", ncols=3, fontsize=STYLE["legend"], frameon=False)
    return {"force_overlap": figure}
