# Law: full or simplified JKR with viscous damping, inverted by `pyjkr.calibrate`.
# Covers: Chen, Liu, Li 2019 section 3, fig. 7: two points of a curve give it back, and gamma E^(-2/5) with it; then a reduced E.
# Assumes: the points are picked on the model's own curve, for the paper's are lost; noise is normal and drawn here.
"""The inversion, tried on curves whose parameters are known: from two points, and from many with noise."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field, PositiveFloat, model_validator
from scipy import stats

from pyjkr.calibrate import Measurements, Particle, fit
from pyjkr.calibrate.collision import collision
from pyjkr.calibrate.particle import similarity_group
from pyjkr.calibrate.report import draw
from pyjkr.oracle import NormalContact, impact, sticking_speed
from pyjkr.plot import STYLE, VERMILION, panels
from pyjkr.studies import impacts, polystyrene
from pyjkr.studies.check import Check

VERSION = 1
# Of gamma E^(-2/5) and e from two points of the oracle: what the table's interpolation leaves.
RECOVERY_TOLERANCE = 1e-5
# Of e_eff in LIGGGHTS at the reduced stiffness, from the oracle at the real one.
LIGGGHTS_TOLERANCE = 2e-3
# A coverage is judged too small where a true one of the nominal size would come out so low with less than this probability.
IMPLAUSIBLE = 0.005


class Settings(polystyrene.Sphere):
    """What fig. 7 is drawn for."""

    law: Literal["jkr", "jkr/simplified"] = "jkr"
    """Normal law."""
    restitution_coefficient: float = Field(default=0.86, gt=0.05, lt=1)
    """e without adhesion [-]."""
    plateau: float = Field(default=10.0, gt=1)
    """Speed of the point on the plateau, in sticking speeds."""
    typical: float = Field(default=1.6, gt=1)
    """Speed of the typical point, in sticking speeds."""
    modulus_ratio: float = Field(default=0.026, gt=0, lt=1)
    """E_mod/E of the simulation that is to reproduce the curve."""
    speeds: tuple[PositiveFloat, ...] = Field(default=(1.05, 1.3, 2.0, 4.0, 9.0), min_length=1)
    """Speeds of that simulation, in sticking speeds."""
    steps_per_collision: int = Field(default=1000, ge=10)
    """Time steps per collision."""
    noisy_points: int = Field(default=20, ge=3)
    """Measurements of each noisy set, between `slowest` and `fastest`."""
    slowest: float = Field(default=0.7, gt=0)
    """[sticking speeds]; below 1 the sphere sticks, and is given as 0."""
    fastest: float = Field(default=8.0, gt=1)
    """[sticking speeds]"""
    noise: float = Field(default=0.02, gt=0)
    """Standard deviation of each e_eff [-]."""
    seeds: int = Field(default=200, ge=20)
    """Noisy sets."""
    confidences: tuple[Annotated[float, Field(gt=0, lt=1)], ...] = Field(default=(0.95, 0.99), min_length=1)
    """Nominal joint confidences."""

    @model_validator(mode="after")
    def _in_order(self) -> Settings:
        for low, high in (("typical", "plateau"), ("slowest", "fastest")):
            if getattr(self, low) >= getattr(self, high):
                raise ValueError(f"{low} = {getattr(self, low):g} must be below {high} = {getattr(self, high):g}. Swap or correct them.")
        return self


def points(settings: Settings) -> list[dict]:
    """The inversion of two points; impacts in LIGGGHTS at E_mod; batches of noisy sets."""
    common = {name: getattr(settings, name) for name in (*polystyrene.Sphere.model_fields, "law", "restitution_coefficient")}
    pair = {"plateau": settings.plateau, "typical": settings.typical, "modulus_ratio": settings.modulus_ratio}
    found = [{"label": "two points", "engine": "oracle", "kind": "two", **common, **pair}]
    for speed in settings.speeds:
        one = {"speed": speed, "steps_per_collision": settings.steps_per_collision}
        found.append({"label": f"{speed:g} v_s at E_mod", "engine": "liggghts", "kind": "reduced", **common, **pair, **one})
    noisy = {"count": settings.noisy_points, "slowest": settings.slowest, "fastest": settings.fastest, "noise": settings.noise}
    for scatter in ("stated", "unknown"):
        for confidence in settings.confidences:
            what = {"scatter": scatter, "confidence": confidence, "seeds": settings.seeds}
            label = f"noise {scatter}, {100 * confidence:g} %"
            found.append({"label": label, "engine": "table", "kind": "noisy", **common, **noisy, **what})
    return found


def evaluate(point: dict, directory: Path) -> list[dict]:
    """What came of one point of the study."""
    return {"two": _two, "reduced": _reduced, "noisy": _noisy}[point["kind"]](point, directory)


def _particle(point: dict) -> Particle:
    modulus = point["effective_modulus"]
    reduced = modulus * point["modulus_ratio"] if "modulus_ratio" in point else None
    return Particle(radius=point["radius"], density=point["density"], effective_modulus=modulus, effective_modulus_mod=reduced)


def _curve(point: dict) -> tuple[NormalContact, float, float]:
    """The contact whose parameters are to be found again, the mass [kg] and the sticking speed [m/s], by the oracle."""
    contact = NormalContact(
        point["radius"], point["effective_modulus"], point["surface_energy"], point["law"], point["restitution_coefficient"]
    )
    mass = _particle(point).effective_mass
    return contact, mass, sticking_speed(contact, mass)


def _picked(point: dict) -> Measurements:
    """A point on the plateau and a typical one, steps (a) and (b) of the paper, integrated by the oracle."""
    contact, mass, sticking = _curve(point)
    speeds = sticking * np.array([point["typical"], point["plateau"]])
    restitution = [impact(contact, mass, speed, samples=2, stuck_periods=0.01).restitution for speed in speeds.tolist()]
    return Measurements(speeds, np.array(restitution), source="two points")


def _two(point: dict, directory: Path) -> list[dict]:
    picked = _picked(point)
    found = fit(picked, _particle(point), point["law"])
    common = {
        "kind": "two",
        "e": found.restitution_coefficient.value,
        "group": found.group.value,
        "surface_energy": found.surface_energy.value,
        "surface_energy_mod": found.surface_energy_mod.value,
    }
    return [common | {"speed": float(v), "e_eff": float(e)} for v, e in zip(picked.speed, picked.restitution, strict=True)]


def _reduced(point: dict, directory: Path) -> list[dict]:
    """Step (d): LIGGGHTS at E_mod with the calibrated gamma_mod and damping, beside the oracle with the real parameters."""
    contact, mass, sticking = _curve(point)
    found = fit(_picked(point), _particle(point), point["law"])
    soft = polystyrene.Sphere(
        radius=point["radius"],
        density=point["density"],
        effective_modulus=found.particle.effective_modulus_mod,
        surface_energy=found.surface_energy_mod.value,
    )
    speed = point["speed"] * sticking
    e = min(found.restitution_coefficient.value, 1.0)
    scene = polystyrene.impact_on_wall(soft, speed, e, point["law"], point["steps_per_collision"])
    _, run = impacts.outcome(scene, "liggghts", directory)
    exact = impact(contact, mass, speed, samples=2, stuck_periods=0.01).restitution
    return [{"kind": "reduced", "speed": speed, "e_eff": run.restitution, "e_eff_oracle": exact}]


def _measured(point: dict, seed: int) -> Measurements:
    """One noisy set: stuck spheres are exact zeros, as an experiment writes them down."""
    model, particle, e = collision(point["law"]), _particle(point), point["restitution_coefficient"]
    group = similarity_group(point["surface_energy"], point["effective_modulus"])
    ratios = np.geomspace(point["slowest"], point["fastest"], point["count"])
    true = model.restitution(ratios, e)
    noise = point["noise"] * np.random.default_rng(seed).standard_normal(len(true))
    speeds = ratios * particle.speed_unit(group) * float(model.sticking_ratio(e))
    deviation = np.full(len(true), point["noise"]) if point["scatter"] == "stated" else None
    return Measurements(speeds, np.where(true > 0, np.clip(true + noise, 0, 1), 0.0), deviation, source=f"seed {seed}")


def _noisy(point: dict, directory: Path) -> list[dict]:
    """Whether each interval holds its parameter, set by set."""
    e, group = point["restitution_coefficient"], similarity_group(point["surface_energy"], point["effective_modulus"])
    rows = []
    for seed in range(point["seeds"]):
        found = fit(_measured(point, seed), _particle(point), point["law"], confidence=point["confidence"])
        row = {"kind": "noisy", "scatter": point["scatter"], "confidence": point["confidence"], "seed": seed}
        for name, estimate, true in (("e", found.restitution_coefficient, e), ("group", found.group, group)):
            row |= {name: estimate.value, f"{name}_lower": estimate.lower, f"{name}_upper": estimate.upper}
            row[f"{name}_held"] = bool(estimate.lower <= true <= estimate.upper)
        rows.append(row)
    return rows


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Two points give the parameters back; the reduced run gives the curve back; intervals hold what they say."""
    group = similarity_group(settings.surface_energy, settings.effective_modulus)
    two = table[table["kind"] == "two"].iloc[0]
    found = []
    for name, unit, true in (("group", " J m^-2 Pa^-0.4", group), ("e", "", settings.restitution_coefficient)):
        holds = abs(two[name] / true - 1) <= RECOVERY_TOLERANCE
        label = "gamma E^(-2/5) from two points" if name == "group" else "e without adhesion from two points"
        found.append(Check(label, float(two[name]), f"{true:.6g}{unit} within 1e-5", bool(holds)))
    reduced = table[table["kind"] == "reduced"]
    error = float((reduced["e_eff"] - reduced["e_eff_oracle"]).abs().max(skipna=False))
    name = f"e_eff, LIGGGHTS at E_mod/E = {settings.modulus_ratio:g} with the calibrated gamma_mod - oracle at E"
    found.append(Check(name, error, "<= 2e-3", error <= LIGGGHTS_TOLERANCE))
    for (scatter, confidence), rows in table[table["kind"] == "noisy"].groupby(["scatter", "confidence"]):
        both = rows["e_held"].astype(bool) & rows["group_held"].astype(bool)
        count, least = len(rows), int(stats.binom.ppf(IMPLAUSIBLE, len(rows), confidence))
        name = f"sets of {count} whose {100 * confidence:g} % intervals hold both parameters, noise {scatter}"
        found.append(Check(name, int(both.sum()), f">= {least}", int(both.sum()) >= least))
        if confidence == max(settings.confidences):
            first = int(both[rows["seed"] < 20].sum())
            found.append(Check(f"of the first 20, {100 * confidence:g} %, noise {scatter}", first, "20", first == 20))
    return found


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Chen 2019, fig. 7: two picked points, the calibrated curve, the reduced run; and one noisy set with its band."""
    figure, (left, right) = panels(2, (9.6, 4.8))
    two, reduced = (table[table["kind"] == kind] for kind in ("two", "reduced"))
    point = {name: getattr(settings, name) for name in (*polystyrene.Sphere.model_fields, "law", "restitution_coefficient")}
    picked = Measurements(two["speed"].to_numpy(), two["e_eff"].to_numpy(), source="two points")
    draw(left, fit(picked, _particle(point), settings.law), name="picked on the oracle's curve")
    name = rf"LIGGGHTS, $E_{{\rm mod}}/E$ = {settings.modulus_ratio:g}, calibrated $\gamma_{{\rm mod}}$"
    look = {"color": VERMILION, "markersize": 8, "markerfacecolor": "none", "markeredgewidth": 1.4, "linestyle": "none"}
    left.plot(reduced["speed"], reduced["e_eff"], "s", label=name, **look)
    low = min(left.get_xlim()[0], 0.95 * reduced["speed"].min())
    left.set_xlim(low, max(left.get_xlim()[1], 1.1 * reduced["speed"].max()))
    left.set_title("two points", fontsize=STYLE["title"])
    noisy = point | {"count": settings.noisy_points, "slowest": settings.slowest, "fastest": settings.fastest}
    noisy |= {"noise": settings.noise, "scatter": "stated"}
    draw(right, fit(_measured(noisy, 0), _particle(point), settings.law), name="drawn at random")
    right.set_title(f"{settings.noisy_points} points, noise {settings.noise:g}", fontsize=STYLE["title"])
    for axes in (left, right):
        axes.legend(fontsize=STYLE["legend"] - 1, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.14))
    return {"calibration": figure}
