# Law: simplified JKR with sliding and rolling resistance; what becomes of spheres that a constant force pulls along the wall.
# Covers: Haervig et al. 2017 section 5.3, fig. 10; the impacts themselves are those of deposition.py.
# Assumes: a sphere that has left after four collision times stays away; one that stops under a constant force stays.
"""Rebound, rolling or sticking over the elasticity parameter and the force, at the real and at reduced stiffness."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat

from pyjkr.errors import PlanError, RunError
from pyjkr.plot import BLUE, GREEN, STYLE, VERMILION, panels
from pyjkr.studies import deposition, lanes
from pyjkr.studies.check import Check

VERSION = 1
LOOKS = {"rebound": (VERMILION, "^"), "rolling": (BLUE, "o"), "sticking": (GREEN, "s"), "undecided": ("black", "X")}
# A force is near the border where |F/F_yield - 1| is below: its sphere needs long to stop, and runs in a deck of its own.
NEAR_YIELD = 0.08
# Closer to the border than this no force is tried: the sphere would hardly ever stop.
LEAST_EXCESS = 1e-3
# Time to stop from rolling at the impact's tangential speed, times this.
MARGIN_OF_STOPPING = 1.5
# A sphere no longer rolls if it rocks within its critical displacement; watched over so many rolling periods at the end.
PERIODS_WATCHED = 2
# Travel in that window, in critical displacements: rocking stays below 2, a rolling sphere makes hundreds.
STANDS, ROLLS = 2.0, 5.0
# Relative width of lambda at which the search for the rebound border ends.
BISECTION_WIDTH = 1e-4
YIELD_TOLERANCE = 0.01
REBOUND_TOLERANCE = 0.01


class Settings(BaseModel):
    """What fig. 10 is drawn for. The paper gives axes and definitions, and none of the values."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    elasticity: tuple[PositiveFloat, ...] = Field(default=(1e7, 2e7, 5e7, 1e8, 2e8, 2.6e8, 5e8, 1e9), min_length=2)
    """lambda = E/(rho v^2 sin^2 psi) [-], of the real stiffness."""
    forces: tuple[PositiveFloat, ...] = Field(
        default=(0.1, 0.2, 0.4, 0.7, 0.9, 0.97, 0.98, 0.99, 1.01, 1.02, 1.03, 1.1, 1.4, 2.5, 5.0, 10.0), min_length=2
    )
    """F_ext/F_yield [-]."""
    modulus_ratios: tuple[PositiveFloat, ...] = Field(default=(1.0, 0.01), min_length=1)
    """E_mod/E, the real stiffness first."""
    adhesiveness: float = Field(default=300.0, gt=0)
    """Ad = 3 gamma/(rho v^2 sin^2(psi) r) [-]."""
    restitution_coefficient: float = Field(default=0.3, gt=0.05, le=1)
    """e without adhesion [-]."""
    angle: float = Field(default=60.0, gt=0, le=90)
    """psi, between path and wall [degrees]."""
    adhesion_hysteresis: float = Field(default=0.5, gt=0)
    """dgamma/gamma of eq. 18 [-]."""
    friction_coefficient: float = Field(default=0.5, gt=0)
    """mu [-]; large enough that rolling yields before sliding."""
    poissons_ratio: float = Field(default=0.3, ge=0, le=0.5)
    """Of sphere and wall [-]."""
    radius: float = Field(default=5e-6, gt=0)
    """[m]."""
    density: float = Field(default=2000.0, gt=0)
    """[kg/m3]."""
    surface_energy: float = Field(default=0.02, gt=0)
    """gamma [J/m2]; with Ad it sets the speed."""
    original_rolling: bool = True
    """Whether F_C and xi_crit of rolling stay those of the real contact (section 3.2); false shows what happens without."""
    steps_per_collision: int = Field(default=40, ge=10)
    """Time steps per collision."""


def points(settings: Settings) -> list[dict]:
    """One point per lambda and stiffness, with all forces; one search for the rebound border per stiffness."""
    common = settings.model_dump(exclude={"elasticity", "forces", "modulus_ratios"}) | {"engine": "liggghts"}
    found = []
    for ratio in settings.modulus_ratios:
        about = {**common, "modulus_ratio": ratio}
        for elasticity in settings.elasticity:
            _refuse_undecidable(about, elasticity, settings.forces)
            label = f"lambda = {elasticity:.3g}, q = {ratio:g}"
            found.append({"label": label, "kind": "map", **about, "elasticity": elasticity, "forces": list(settings.forces)})
        ends = {"lowest": min(settings.elasticity), "highest": max(settings.elasticity)}
        found.append({"label": f"rebound border, q = {ratio:g}", "kind": "border", **about, **ends})
    return found


def _refuse_undecidable(point: dict, elasticity: float, forces: tuple[float, ...]) -> None:
    lever = deposition.reaction_lever(point, elasticity)
    for force in forces:
        if abs(force * lever - 1) < LEAST_EXCESS:
            raise PlanError(
                f"settings: forces: {force:g} F_yield is within {LEAST_EXCESS:.1%} of what begins to roll the sphere at lambda ="
                f" {elasticity:g} and E_mod/E = {point['modulus_ratio']:g}: it would hardly ever stop. Move it away."
            )


def evaluate(point: dict, directory: Path) -> list[dict]:
    """What becomes of the spheres of one lambda, or where the rebound border lies."""
    return _border(point, directory) if point["kind"] == "border" else _map(point, directory)


def _map(point: dict, directory: Path) -> list[dict]:
    setup = deposition.prepare(point, point["elasticity"])
    outcomes = {force: {"outcome": "rebound", "travel": math.nan} for force in point["forces"]}
    held = [force for force, left in zip(point["forces"], _rebounds(setup, point["forces"], directory / "impact"), strict=True) if not left]
    for name, near in (("far", False), ("near", True)):
        forces = [force for force in held if (abs(force - 1) < NEAR_YIELD) == near]
        if forces:
            outcomes.update(_deposited(setup, forces, directory / name))
    keys = {name: point[name] for name in ("kind", "elasticity", "modulus_ratio", "adhesiveness")}
    return [{**keys, "force": force, "lever": setup.lever, **outcomes[force]} for force in point["forces"]]


def _rebounds(setup: deposition.Setup, forces: list[float], directory: Path) -> list[bool]:
    """Whether each sphere has left the wall when its collision is over."""
    frame = lanes.run(
        setup.case, setup.scene, [deposition.lane_of(setup, force) for force in forces], directory,
        steps=setup.case.steps, every=setup.case.steps, periodic=True,
    )  # fmt: skip
    last = frame[frame["step"] == setup.case.steps].sort_values("id")
    return (last["z"] > setup.case.radii[0]).tolist()


def _deposited(setup: deposition.Setup, forces: list[float], directory: Path) -> dict[float, dict]:
    """Whether the spheres that stay roll on or come to a stop: followed until the slowest must have stopped."""
    case = setup.case
    least = min(abs(force * setup.lever - 1) for force in forces)
    stopping = deposition.ROLLING_INERTIA * case.masses[0] * case.tangential_speed / (least * setup.yield_force)
    window = math.ceil(PERIODS_WATCHED * setup.rolling_period / case.time_step)
    duration = case.steps * case.time_step + MARGIN_OF_STOPPING * stopping
    steps = window * (math.ceil(duration / (window * case.time_step)) + 1)
    frame = lanes.run(
        case, setup.scene, [deposition.lane_of(setup, force) for force in forces], directory, steps=steps, every=window, periodic=True
    )  # fmt: skip
    now, before = (frame[frame["step"] == step].sort_values("id") for step in (steps, steps - window))
    if (now["z"] > case.radii[0]).any():
        raise RunError(f"{directory}: a sphere that had stuck is off the wall. Raise steps_per_collision.")
    travel = (now["xu"].to_numpy() - before["xu"].to_numpy()) / setup.critical_displacement
    return {
        force: {"outcome": "sticking" if abs(way) <= STANDS else "rolling" if way >= ROLLS else "undecided", "travel": float(way)}
        for force, way in zip(forces, travel, strict=True)
    }


def _border(point: dict, directory: Path) -> list[dict]:
    """lambda between sticking and rebound, by bisection with LIGGGHTS."""

    def rebounds(elasticity: float, number: int) -> bool:
        return _rebounds(deposition.prepare(point, elasticity), [0.0], directory / f"{number:02d}")[0]

    lower, upper = point["lowest"], point["highest"]
    if rebounds(lower, 0) or not rebounds(upper, 1):
        raise RunError(f"{directory}: no rebound border between lambda = {lower:g} and {upper:g}. Widen elasticity.")
    number = 2
    while upper / lower - 1 > BISECTION_WIDTH:
        middle = math.sqrt(lower * upper)
        lower, upper = (lower, middle) if rebounds(middle, number) else (middle, upper)
        number += 1
    keys = {name: point[name] for name in ("kind", "modulus_ratio", "adhesiveness")}
    return [{**keys, "elasticity": math.sqrt(lower * upper), "critical_elasticity": deposition.critical_elasticity(point)}]


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Both borders of the map, at every stiffness; and that the reduced stiffness gives the same map."""
    spheres, borders = table[table["kind"] == "map"], table[table["kind"] == "border"]
    critical = float(borders["critical_elasticity"].iloc[0])
    found = []
    for ratio in settings.modulus_ratios:
        rows = spheres[spheres["modulus_ratio"] == ratio]
        stays = rows[rows["elasticity"] < critical]
        highest = float(stays[stays["outcome"] == "sticking"].groupby("elasticity")["force"].max().min())
        lowest = float(stays[stays["outcome"] == "rolling"].groupby("elasticity")["force"].min().max())
        orderly = all(_orderly(one) for _, one in stays.groupby("elasticity"))
        right = orderly and highest >= 1 - YIELD_TOLERANCE and lowest <= 1 + YIELD_TOLERANCE
        name = f"q = {ratio:g}: F/F_yield between sticking and rolling"
        found.append(Check(name, f"{highest:g} to {lowest:g}", "1 within 1 %, at every lambda", right))
        border = borders[borders["modulus_ratio"] == ratio].iloc[0]
        measured = float(border["elasticity"] / critical)
        found.append(
            Check(
                f"q = {ratio:g}: lambda of the rebound border, LIGGGHTS over oracle",
                measured,
                f"1 within 1 % (oracle {critical:.5g})",
                abs(measured - 1) <= REBOUND_TOLERANCE,
            )
        )
        beyond = int(((rows["outcome"] == "rebound") != (rows["elasticity"] > critical)).sum())
        found.append(Check(f"q = {ratio:g}: spheres on the wrong side of the rebound border", beyond, "0", beyond == 0 and len(rows) > 0))
    kinds = spheres.groupby(["elasticity", "force"])["outcome"].nunique()
    unlike = int((kinds > 1).sum())
    found.append(Check("outcomes that differ between stiffnesses", unlike, "0", unlike == 0 and len(settings.modulus_ratios) > 1))
    return found


def _orderly(rows: pd.DataFrame) -> bool:
    """Whether all weak forces stick and all strong ones roll, and nothing is undecided."""
    rows = rows.sort_values("force")
    kinds = rows["outcome"].tolist()
    stuck = kinds.count("sticking")
    return kinds == ["sticking"] * stuck + ["rolling"] * (len(kinds) - stuck) and 0 < stuck < len(kinds)


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Haervig 2017, fig. 10: the three outcomes over lambda and F_ext/F_yield, and the border of rolling drawn large."""
    spheres, borders = table[table["kind"] == "map"], table[table["kind"] == "border"]
    critical = float(borders["critical_elasticity"].iloc[0])
    ratios = settings.modulus_ratios
    figure, axes = panels(len(ratios) + 1, (3.6 * (len(ratios) + 1), 4.6))
    close = (spheres["force"] - 1).abs() < NEAR_YIELD
    for ax, ratio in zip(axes, ratios, strict=False):
        _markers(ax, spheres[(spheres["modulus_ratio"] == ratio) & ~close], size=6)
        ax.set_yscale("log")
        ax.set_ylim(spheres["force"].min() / 1.6, spheres["force"].max() * 1.6)
        marks = [mark for mark in (0.01, 0.1, 0.2, 0.5, 1, 2, 5, 10, 100) if spheres["force"].min() <= mark <= spheres["force"].max()]
        ax.set_yticks(marks, [f"{mark:g}" for mark in marks])
        ax.set_yticks([], minor=True)
        ax.set_title(rf"$E_{{\rm mod}}/E$ = {ratio:g}", fontsize=STYLE["title"])
    for number, ratio in enumerate(ratios):
        _markers(axes[-1], spheres[(spheres["modulus_ratio"] == ratio) & close], size=9 - 4 * number)
    axes[-1].set_title("near the yield force, all stiffnesses", fontsize=STYLE["title"])
    for ax in axes:
        ax.set_xscale("log")
        ax.set_xlim(spheres["elasticity"].min() / 1.6, spheres["elasticity"].max() * 1.6)
        ax.plot([spheres["elasticity"].min() / 2, critical], [1, 1], "-", color="0.4", linewidth=1.0, zorder=0,
                label=r"$F_{\rm yield}$; $\lambda_{\rm crit}$ of the oracle" if ax is axes[0] else None)  # fmt: skip
        ax.axvline(critical, color="0.4", linewidth=1.0, zorder=0)
        ax.set_xlabel(r"$\lambda = E/(\rho_{\rm p} v^2 \sin^2\psi)$", fontsize=STYLE["label"])
    axes[0].set_ylabel(r"$F_{\rm ext}/F_{\rm yield}$", fontsize=STYLE["label"])
    names = {}
    for ax in axes:
        names |= {label: line for line, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    figure.legend(names.values(), names.keys(), loc="outside lower center", ncols=len(names), fontsize=STYLE["legend"], frameon=False)
    about = rf"oblique impacts on a wall, Ad = {settings.adhesiveness:g}, $e$ = {settings.restitution_coefficient:g}"
    figure.suptitle(about + rf", $\psi$ = {settings.angle:g}°, LIGGGHTS", fontsize=STYLE["title"])
    return {"rebound_map": figure}


def _markers(axes, rows: pd.DataFrame, size: float) -> None:
    for outcome, (colour, marker) in LOOKS.items():
        mine = rows[rows["outcome"] == outcome]
        if len(mine):
            axes.plot(mine["elasticity"], mine["force"], marker, color=colour, markersize=size, markerfacecolor="none",
                      linestyle="none", label=outcome)  # fmt: skip
