"""Ballistic packings with the real and with reduced stiffness: Chen, Liu and Li 2019, sec. 4, table 1, figs 8 to 13.

Covers the series S, A, B and C over adhesion number and seed: what is run, the rows it leaves, what they must show.
Assumes equal spheres, a floor of their material, no gravity; sizes, speed and damping are ours, see the case's README.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import pydantic
from matplotlib.figure import Figure

from pyjkr.errors import PlanError
from pyjkr.packing import deck, drawings, rows
from pyjkr.packing.bed import read_bed, require_freud
from pyjkr.packing.scene import REAL_MODULUS, PackingScene, series
from pyjkr.studies.check import Check

VERSION = 1

# A bed may keep this part of the inlet's energy, and may leave this part of the spheres in flight.
LEFT_ENERGY, LEFT_FLYING = 1e-4, 0.01
# A difference between series is real where it exceeds this many standard errors.
STANDARD_ERRORS = 3.0
# Mean overlap against eq. 16: contacts that push and contacts that pull balance, up to the curvature of the law.
OVERLAP_TOLERANCE = 0.05
# Kolmogorov and Smirnov: two samples of n and m differ by more than this times sqrt(1/n + 1/m) once in a hundred. Contacts
# of one sphere are not independent, so n is the number of spheres for contacts too.
ONCE_IN_A_HUNDRED = 1.63
# Distance of the floor, and of two centres, that no sphere may fall short of [r, 2 r].
DEEPEST = 0.9


class Settings(pydantic.BaseModel):
    """What is swept, and the spheres. SI units."""

    model_config = pydantic.ConfigDict(frozen=True, extra="forbid")

    series: tuple[str, ...] = ("S", "A-2", "B-2", "C-2", "C-3")
    """Lines of table 1."""
    adhesion_numbers: tuple[pydantic.PositiveFloat, ...] = (3.0,)
    """Ad = gamma/(rho U^2 R) of the real material, R = r/2 [-]; sets the size of the spheres."""
    checked_adhesion_number: pydantic.PositiveFloat = 3.0
    """The one at which series are compared, in the transition from dense to loose [-]."""
    seeds: tuple[pydantic.NonNegativeInt, ...] = (1, 2, 3)
    """Of the random columns."""
    particles: int = pydantic.Field(500, ge=50)
    """Spheres in one packing."""
    speed: pydantic.PositiveFloat = 5.0
    """U of the rain [m/s]."""
    density: pydantic.PositiveFloat = 1050.0
    """[kg/m3]."""
    youngs_modulus: pydantic.PositiveFloat = REAL_MODULUS
    """Of the real material [Pa]."""
    poissons_ratio: float = pydantic.Field(0.33, ge=0, lt=0.5)
    """[-]."""
    surface_energy: pydantic.PositiveFloat = 0.05
    """gamma of the real material [J/m2]."""
    restitution_coefficient: float = pydantic.Field(0.7, gt=0.05, lt=1)
    """e without adhesion [-]."""
    friction_coefficient: pydantic.NonNegativeFloat = 0.3
    """mu [-]."""
    critical_rolling_angle: pydantic.PositiveFloat = 0.0085
    """theta_crit [rad]."""
    rolling_damping: pydantic.NonNegativeFloat = 0.3
    """Of the rolling spring, over critical [-]."""
    box_in_radii: float = pydantic.Field(16.0, ge=8)
    """Edge of the column [r]."""
    inlet_fraction: float = pydantic.Field(0.05, gt=0, le=0.1)
    """Solid fraction of the rain [-]."""
    steps_per_collision: int = pydantic.Field(20, ge=5)
    """Time steps in a collision at U, and in a stuck period."""
    rest_fraction: pydantic.PositiveFloat = 1e-5
    """At rest when the kinetic energy is this part of the inlet's [-]."""
    settling_time: pydantic.PositiveFloat = 400.0
    """Longest time after the last sphere has come down [r/U]."""
    settling_acceleration: pydantic.NonNegativeFloat = 0.0
    """Towards the floor, once the last sphere has come down [U^2/r]: rest for spheres that hardly stick."""

    @pydantic.field_validator("series")
    @classmethod
    def _known(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        for name in names:
            try:
                series(name)
            except PlanError as error:
                raise ValueError(str(error)) from None
        return names

    @pydantic.model_validator(mode="after")
    def _checked_is_swept(self) -> Settings:
        if self.checked_adhesion_number not in self.adhesion_numbers:
            raise ValueError(f"checked_adhesion_number = {self.checked_adhesion_number:g} is not one of adhesion_numbers. Add it there.")
        return self


def points(settings: Settings) -> list[dict[str, Any]]:
    """One packing for each seed, adhesion number and series; the first seeds of all series come first."""
    swept = {"series", "adhesion_numbers", "checked_adhesion_number", "seeds"}
    shared = settings.model_dump(exclude=swept)
    found = []
    for seed in settings.seeds:
        for adhesion_number in settings.adhesion_numbers:
            for name in settings.series:
                line = series(name)
                found.append(
                    {
                        "label": f"{name}_Ad{adhesion_number:g}_seed{seed}",
                        "engine": "liggghts",
                        "series": name,
                        "snapshot": seed == settings.seeds[0],
                        "modulus_ratio": line.modulus_ratio,
                        "scaled": line.scaled,
                        "originals": line.originals,
                        "adhesion_number": adhesion_number,
                        "seed": seed,
                        **shared,
                    }
                )
    return found


def evaluate(point: dict[str, Any], directory: Path) -> list[dict[str, Any]]:
    """Pack, unless the whole run lies in `directory`, and measure.

    Returns
    -------
    list of dict
        Rows of one `kind` each: "summary", once; "distribution", a bin of a `quantity`; "sphere", where the point wants a
        snapshot. Lengths in r, delta_e where named so; energies in that of the inlet; forces in F_C.
    """
    require_freud()
    scene = PackingScene(**{field.name: point[field.name] for field in dataclasses.fields(PackingScene)})
    run = deck.simulate(scene, Path(directory))
    bed = read_bed(scene, Path(directory))
    which = {key: point[key] for key in ("label", "engine", "series", "adhesion_number", "seed", "modulus_ratio")}
    timing = {"steps": run.steps, "loop_time": run.loop_time, "wall_time": run.wall_time}
    found = [{**which, "kind": "summary", **rows.summary(scene, bed), **timing}]
    found += [{**which, "kind": "distribution", **row} for row in rows.distributions(scene, bed)]
    if point["snapshot"]:
        found += [{**which, "kind": "sphere", **row} for row in rows.spheres(bed)]
    return found


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """What figs 9 to 12 must show: beds at rest; C as S, A looser, B denser; overlaps after eqs 16 and 17."""
    summary = table[table["kind"] == "summary"]
    return [*_bed_checks(summary, settings), *_series_checks(summary, settings), *_contact_checks(table, settings)]


def _bed_checks(summary: pd.DataFrame, settings: Settings) -> Iterator[Check]:
    lost = int((summary["spheres"] != settings.particles).sum())
    yield Check("packings that lost spheres", lost, "0", lost == 0)
    deepest = float(min(summary["lowest_centre"].min(), summary["smallest_distance"].min()))
    wanted = f"above {DEEPEST:g}: none goes through the floor or another"
    yield Check("least height over r, least distance over 2 r", deepest, wanted, deepest > DEEPEST)
    energy = float(summary["kinetic_energy_left"].max())
    yield Check("kinetic energy left, over the inlet's", energy, f"below {LEFT_ENERGY:g}", energy < LEFT_ENERGY)
    flying = float((summary["flying_spheres"] / summary["spheres"]).max())
    yield Check("spheres still in flight, share", flying, f"at most {LEFT_FLYING:g}", flying <= LEFT_FLYING)
    agree = float((summary["packing_fraction"] / summary["slab_packing_fraction"] - 1).abs().mean())
    yield Check("packing fraction from Voronoi cells against that of the slab, mean difference", agree, "below 0.02", agree < 0.02)


def _series_checks(summary: pd.DataFrame, settings: Settings) -> Iterator[Check]:
    """Fig. 9: differences from S over seeds, at the checked adhesion number."""
    here = summary[summary["adhesion_number"] == settings.checked_adhesion_number]
    real = here[here["series"] == "S"]
    for name in settings.series:
        these = here[here["series"] == name]
        if name == "S" or min(len(these), len(real)) < 2:
            continue
        difference, error, scatter = {}, {}, {}
        for quantity in ("packing_fraction", "coordination_number"):
            difference[quantity] = float(these[quantity].mean() - real[quantity].mean())
            spread = these[quantity].var(), real[quantity].var()
            error[quantity] = math.sqrt(spread[0] / len(these) + spread[1] / len(real))
            scatter[quantity] = math.sqrt(sum(spread) / 2)

        def significant(quantity: str, sign: int, difference: dict = difference, error: dict = error) -> bool:
            return sign * difference[quantity] > STANDARD_ERRORS * error[quantity]

        def shown(quantity: str, difference: dict = difference, error: dict = error) -> str:
            return f"{difference[quantity]:+.4f} +- {error[quantity]:.4f}"

        if name.startswith("A"):
            change = {quantity: abs(value) / float(real[quantity].mean()) for quantity, value in difference.items()}
            share = change["coordination_number"] / change["packing_fraction"]
            yield Check(f"{name}: relative change of the coordination number over that of the packing fraction", share,
                        "below 0.5: weak", share < 0.5)  # fmt: skip
            yield Check(f"{name}: packing fraction over that of S", shown("packing_fraction"),
                        f"lower by more than {STANDARD_ERRORS:g} standard errors", significant("packing_fraction", -1))  # fmt: skip
        elif name.startswith("B"):
            for quantity in ("packing_fraction", "coordination_number"):
                yield Check(f"{name}: {quantity.replace('_', ' ')} over that of S", shown(quantity),
                            f"higher by more than {STANDARD_ERRORS:g} standard errors", significant(quantity, 1))  # fmt: skip
        else:
            for quantity in ("packing_fraction", "coordination_number"):
                yield Check(f"{name}: {quantity.replace('_', ' ')} over that of S", shown(quantity),
                            f"within the scatter of one packing, {scatter[quantity]:.4f}",
                            abs(difference[quantity]) <= scatter[quantity])  # fmt: skip


def _contact_checks(table: pd.DataFrame, settings: Settings) -> Iterator[Check]:
    """Figs 10 to 13: distributions of C as of S, mean overlap after eqs 16 and 17, time saved."""
    summary = table[(table["kind"] == "summary") & (table["adhesion_number"] == settings.checked_adhesion_number)]
    for name in settings.series:
        if name != "S" and not name.startswith("C"):
            continue
        these = summary[summary["series"] == name]
        ratio = float((these["mean_overlap"] / these["equilibrium_overlap"]).mean())
        yield Check(f"{name}: mean overlap over delta_e, eq. 16", ratio, f"1 +- {OVERLAP_TOLERANCE:g}",
                    abs(ratio - 1) <= OVERLAP_TOLERANCE)  # fmt: skip
        if name == "S" or "S" not in settings.series:
            continue
        real = summary[summary["series"] == "S"]
        growth = float(these["mean_overlap"].mean() / real["mean_overlap"].mean() * these["modulus_ratio"].iloc[0] ** 0.4)
        yield Check(f"{name}: mean overlap over that of S, times (E_R/E_O)^(2/5), eq. 17", growth, f"1 +- {OVERLAP_TOLERANCE:g}",
                    abs(growth - 1) <= OVERLAP_TOLERANCE)  # fmt: skip
        distributions = table[(table["kind"] == "distribution") & (table["adhesion_number"] == settings.checked_adhesion_number)]
        critical = ONCE_IN_A_HUNDRED * math.sqrt(1 / these["middle_spheres"].sum() + 1 / real["middle_spheres"].sum())
        for quantity in ("local_packing_fraction", "coordination_number", "normal_force"):
            both = [_cumulative(distributions, each, quantity) for each in (name, "S")]
            distance = float((both[0] - both[1]).abs().max())
            yield Check(f"{name}: cumulative distribution of {quantity.replace('_', ' ')}, distance from that of S", distance,
                        f"below {critical:.3f}, chance but once in a hundred", distance < critical)  # fmt: skip
        faster = float(these["loop_time"].mean() / real["loop_time"].mean())
        yield Check(f"{name}: time over that of S", faster, "below 1", faster < 1)


def _cumulative(distributions: pd.DataFrame, name: str, quantity: str) -> pd.Series:
    """Share of the values up to each bin's end, over all seeds."""
    own = distributions[(distributions["series"] == name) & (distributions["quantity"] == quantity)]
    counts = own.groupby("low")["count"].sum()
    return counts.cumsum() / own.groupby("seed")["total"].first().sum()


def summary(table: pd.DataFrame, settings: Settings) -> pd.DataFrame:
    """Means and standard deviations over the packings of each series at the checked adhesion number, as table 1 lists them.

    Steps and time of a series are compared with those of S; time is that of the time loop, median over the packings.
    """
    here = table[(table["kind"] == "summary") & (table["adhesion_number"] == settings.checked_adhesion_number)]
    real = here[here["series"] == "S"]
    lines = []
    for name in settings.series:
        these = here[here["series"] == name]
        line = {"series": name, "E_R/E_O": f"{these['modulus_ratio'].iloc[0]:.3g}", "packings": len(these)}
        for title, quantity in (("packing fraction", "packing_fraction"), ("coordination number", "coordination_number")):
            line[title] = f"{these[quantity].mean():.4f} +- {these[quantity].std():.4f}"
        line["overlap / delta_e"] = f"{(these['mean_overlap'] / these['equilibrium_overlap']).mean():.4f}"
        line["steps"] = f"{these['steps'].mean():.4g}"
        line["time of one [s]"] = f"{these['loop_time'].median():.3g}"
        if len(real):
            line["fewer steps"] = f"{real['steps'].mean() / these['steps'].mean():.2f}"
            line["faster"] = f"{real['loop_time'].median() / these['loop_time'].median():.2f}"
        lines.append(line)
    return pd.DataFrame(lines)


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Figs 8 to 13 of Chen 2019, as far as the swept points fill them."""
    here = table[table["adhesion_number"] == settings.checked_adhesion_number]
    found = {"snapshots": drawings.snapshots(here), "local_structure": drawings.local_structure(here)}
    found["contacts"] = drawings.contacts(here)
    found["timing"] = drawings.timing(here[here["kind"] == "summary"])
    summary = table[table["kind"] == "summary"]
    if len(settings.adhesion_numbers) > 1:
        found["packing_fraction"] = drawings.over_adhesion_number(summary, "packing_fraction")
        found["coordination_number"] = drawings.over_adhesion_number(summary, "coordination_number")
    else:
        found["packing"] = drawings.by_series(summary)
    return found
