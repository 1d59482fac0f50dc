# Law: adhesive rolling resistance of a sphere on a wall, pushed at its centre along the wall.
# Covers: Chen, Liu, Li 2019 section 2.3, fig. 4, eqs 3c and 11; Haervig et al. 2017 section 5.1, eq. 18 (Krijt's limit).
# Assumes: the sphere rests at its equilibrium overlap and cannot slip; the force is constant.
"""Critical rolling force over size: closed forms, and the force at which spheres in LIGGGHTS begin to roll."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field, PositiveFloat, model_validator

from pyjkr.oracle import NormalContact, equilibrium_contact_radius, equilibrium_overlap
from pyjkr.plan import plan
from pyjkr.plot import BLUE, GREEN, PURPLE, STYLE, VERMILION, panels
from pyjkr.studies import lanes, polystyrene
from pyjkr.studies.check import Check

VERSION = 1
# Name -> colour, line, marker, marker size, label.
VARIANTS = {
    "original": ("black", "-", "o", 10, r"original $E$, $\gamma$"),
    "reduced": (VERMILION, "--", "s", 6, r"$E_{\rm mod}$, $\gamma_{\rm mod}$ of eq. 10"),
    "corrected": (BLUE, ":", "x", 7, r"the same, rolling with original $\gamma$ (eq. 11)"),
    "krijt": (GREEN, "-.", "D", 6, r"limit of Krijt, $\pi a_0 \Delta\gamma$"),
}
# Of the yield force; the lever arm of LIGGGHTS, r - overlap/2, makes up to a fifth of it.
TOLERANCE = 0.01
# Forces tried at once, and how far from the closed form either way the first of them reach.
FORCES, REACH, ROUNDS = 24, 3.0, 2
# Enough time steps for the sliding mode, 2.2 times as fast as the stuck oscillation to which they are counted.
STEPS_PER_PERIOD = 40
# Rolling periods without slip: in the last of them a sphere that is held moves less than this part of xi_crit.
PERIODS, AT_REST, DAMPING = 9, 1e-3, 1.0


class Settings(polystyrene.Sphere):
    """What fig. 4 is drawn for; `radius` is where Krijt's limit equals that of the rolling angle."""

    radius: float = Field(default=10e-6, gt=0)
    """[m]"""
    radii: tuple[PositiveFloat, ...] = Field(default=(5e-6, 10e-6, 15e-6), min_length=1)
    """Spheres pushed in LIGGGHTS [m]."""
    critical_rolling_angle: float = Field(default=0.0084, gt=0)
    """theta_crit [rad]."""
    modulus_ratio: float = Field(default=0.026, gt=0, lt=1)
    """E_mod/E of the reduced spheres."""
    friction_coefficient: float = Field(default=0.6, gt=0)
    """Large enough not to slip [-]."""
    restitution_coefficient: float = Field(default=0.86, gt=0.05, le=1)
    """e without adhesion [-]: damps the sliding mode."""
    measured_radii: tuple[PositiveFloat, ...] = ()
    """Of an experiment [m]."""
    measured_displacements: tuple[PositiveFloat, ...] = ()
    """Critical rolling displacements of that experiment [m]."""

    @model_validator(mode="after")
    def _pairs(self) -> Settings:
        if len(self.measured_radii) != len(self.measured_displacements):
            raise ValueError("measured_radii and measured_displacements differ in length. Give one displacement for each radius.")
        return self

    @property
    def adhesion_hysteresis(self) -> float:
        """dgamma/gamma [-] with which Krijt's xi_crit, a_0/12 dgamma/gamma, is theta_crit R at `radius`."""
        contact = NormalContact(self.radius, self.effective_modulus, self.surface_energy)
        return 12 * self.critical_rolling_angle * self.radius / float(equilibrium_contact_radius(contact))


def yield_force(radius: float, surface_energy: float, critical_displacement: float) -> float:
    """Force [N] at the centre of a sphere on a wall that makes it roll: 4 F_C xi_crit/r = 12 pi gamma xi_crit."""
    return 12 * math.pi * surface_energy * critical_displacement


def critical_displacement(variant: str, radius: float, settings: Settings) -> float:
    """xi_crit [m]: theta_crit R (Chen 2019, eq. 3c) or a_0/12 dgamma/gamma (Haervig 2017, eq. 18)."""
    if variant != "krijt":
        return settings.critical_rolling_angle * radius
    contact = NormalContact(radius, settings.effective_modulus, settings.surface_energy)
    return float(equilibrium_contact_radius(contact)) * settings.adhesion_hysteresis / 12


def predicted(variant: str, radius: float, settings: Settings) -> float:
    """Closed form of the critical force [N]; gamma_mod makes it (E_mod/E)^(2/5) times too small, eq. 11 mends that."""
    factor = settings.modulus_ratio**0.4 if variant == "reduced" else 1.0
    return yield_force(radius, settings.surface_energy, critical_displacement(variant, radius, settings)) * factor


def points(settings: Settings) -> list[dict]:
    """One point per size and variant, searched in LIGGGHTS."""
    return [
        {
            "label": f"{variant}, r = {radius * 1e6:g} um",
            "engine": "liggghts",
            "variant": variant,
            "settings": settings.model_dump(exclude={"measured_radii", "measured_displacements"}, mode="json"),
            "pushed_radius": radius,
        }
        for variant in VARIANTS
        for radius in settings.radii
    ]


def evaluate(point: dict, directory: Path) -> list[dict]:
    """The bracket of the critical force: many forces at once, then many between the two that matter."""
    settings, variant, radius = Settings.model_validate(point["settings"]), point["variant"], point["pushed_radius"]
    expected = predicted("original" if variant != "krijt" else variant, radius, settings)
    # deliberately wide: it holds the critical force of every variant
    lower, upper = expected / (REACH / settings.modulus_ratio**0.4), expected * REACH
    for number in range(ROUNDS):
        forces = np.geomspace(lower, upper, FORCES)
        rolled = _rolled(settings, variant, radius, forces, directory / f"round{number}")
        if rolled[0] or not rolled[-1] or np.any(np.diff(rolled.astype(int)) < 0):
            lower = upper = math.nan
            break
        first = int(np.argmax(rolled))
        lower, upper = float(forces[first - 1]), float(forces[first])
    row = {"variant": variant, "radius": radius, "held_force": lower, "rolling_force": upper}
    return [row | {"predicted_force": predicted(variant, radius, settings)}]


def _rolled(settings: Settings, variant: str, radius: float, forces: np.ndarray, directory: Path) -> np.ndarray:
    """Which of the forces [N] set a sphere rolling for good."""
    limit = {"critical_rolling_angle": settings.critical_rolling_angle}
    if variant == "krijt":
        limit = {"adhesion_hysteresis": settings.adhesion_hysteresis}
    sphere = polystyrene.Sphere(
        radius=radius, density=settings.density, effective_modulus=settings.effective_modulus, surface_energy=settings.surface_energy
    )
    soft = variant in ("reduced", "corrected")
    scene = polystyrene.impact_on_wall(
        sphere, 1e-4, settings.restitution_coefficient, "jkr", STEPS_PER_PERIOD,
        contact=limit | {"friction_coefficient": settings.friction_coefficient},
        rolling_damping=DAMPING,
        reduction={
            "modulus_ratios": (settings.modulus_ratio if soft else 1.0,),
            "use_original_surface_energy": variant == "corrected",
        },
    )  # fmt: skip
    case = plan(scene).cases[0]
    settled = float(equilibrium_overlap(lanes.normal_contact(case.pair, "jkr")))
    mass, energy = case.pair.effective_mass, case.pair.surface_energy_of_rolling
    # omega^2 = 60 pi gamma/(7 m): k_r = 12 pi r gamma and 7/5 m r^2 about the contact point, with r v_L = r^2 omega
    period = 2 * math.pi / math.sqrt(60 * math.pi * energy / (7 * mass))
    every = math.ceil(period / case.time_step)
    frame = lanes.run(
        case, scene, [lanes.Lane(height=radius - settled, force=float(force)) for force in forces], directory,
        steps=PERIODS * every, every=every, periodic=True,
    )  # fmt: skip
    last, before = (frame[frame["step"] == number * every].set_index("id")["xu"].sort_index() for number in (PERIODS, PERIODS - 1))
    # the surface rolls half as far as the centre moves in LIGGGHTS' symmetric measure; either way xi_crit is the scale
    return ((last - before).to_numpy() > AT_REST * critical_displacement(variant, radius, settings)).astype(bool)


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """The bracket of LIGGGHTS around the closed form, and eq. 11 against its absence."""
    found = []
    middle = table.assign(force=np.sqrt(table["held_force"] * table["rolling_force"]))
    for variant, rows in middle.groupby("variant", sort=False):
        worst = float((rows["force"] / rows["predicted_force"] - 1).abs().max(skipna=False))
        found.append(Check(f"{variant}: critical force, LIGGGHTS over closed form - 1", worst, "<= 1 %", worst <= TOLERANCE))
    width = float((table["rolling_force"] / table["held_force"] - 1).max(skipna=False))
    found.append(Check("width of the brackets, relative", width, "<= 2 %", width <= 2 * TOLERANCE))
    forces = middle.set_index(["variant", "radius"])["force"]
    for variant, wanted, words in (("reduced", settings.modulus_ratio**0.4, "(E_mod/E)^(2/5)"), ("corrected", 1.0, "the original")):
        worst = float((forces[variant] / forces["original"] / wanted - 1).abs().max(skipna=False))
        found.append(Check(f"{variant}: critical force over {words} of the original - 1", worst, "<= 1 %", worst <= TOLERANCE))
    for radius, displacement in zip(settings.measured_radii, settings.measured_displacements, strict=True):
        angle = displacement / radius
        near = abs(angle / settings.critical_rolling_angle - 1) <= 0.02
        name = f"measured xi_crit/r at {radius * 1e6:g} um"
        found.append(Check(name, angle, f"{settings.critical_rolling_angle:g} rad within 2 %", near))
    return found


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Chen 2019, fig. 4, and the measured critical displacements from which the angle comes."""
    measured = bool(settings.measured_radii)
    figure, axes = panels(1 + measured, (9.4 if measured else 6.4, 4.8))
    radii = np.linspace(0.5 * min(settings.radii), 1.15 * max(settings.radii), 60)
    for variant, (colour, style, marker, size, label) in VARIANTS.items():
        rows = table[table["variant"] == variant]
        line = [predicted(variant, radius, settings) * 1e9 for radius in radii]
        axes[0].plot(radii * 1e6, line, style, color=colour, linewidth=1.6, label=label)
        axes[0].plot(rows["radius"] * 1e6, np.sqrt(rows["held_force"] * rows["rolling_force"]) * 1e9, marker, color=colour,
                     markersize=size, markerfacecolor="none", markeredgewidth=1.5, linestyle="none", label="LIGGGHTS")  # fmt: skip
    axes[0].set_ylabel("critical rolling force [nN]", fontsize=STYLE["label"])
    if measured:
        for variant in ("original", "krijt"):
            colour, style, *_ = VARIANTS[variant]
            line = [critical_displacement(variant, radius, settings) * 1e9 for radius in radii]
            axes[1].plot(radii * 1e6, line, style, color=colour, linewidth=1.6)
        axes[1].plot(np.array(settings.measured_radii) * 1e6, np.array(settings.measured_displacements) * 1e9, "*", color=PURPLE,
                     markersize=11, linestyle="none", label=r"measured $\xi_{\rm crit}$ (Sümer and Sitti 2008)")  # fmt: skip
        axes[1].set_ylabel(r"critical rolling displacement $\xi_{\rm crit}$ [nm]", fontsize=STYLE["label"])
    for each in axes:
        each.set_xlim(radii[0] * 1e6, radii[-1] * 1e6)
        each.set_ylim(bottom=0)
        each.set_xlabel(r"radius $r$ [$\mu$m]", fontsize=STYLE["label"])
    figure.legend(loc="outside lower center", ncols=3 if measured else 2, fontsize=STYLE["legend"], frameon=False)
    reduction = rf"$E_{{\rm mod}}/E$ = {settings.modulus_ratio:g}"
    title = rf"polystyrene on a wall, $\theta_{{\rm crit}}$ = {settings.critical_rolling_angle:g}, {reduction}"
    figure.suptitle(title, fontsize=STYLE["title"])
    return {"critical_rolling_force": figure}
