# Law: full JKR with viscous damping, normal impacts in the units of the similarity group.
# Covers: Chen, Liu, Li 2019 section 3, figs 5 and 6, eqs 7-9; in place of its fits (13)-(14), lost, contours of the model itself.
# Assumes: a sphere at a wall; the contours are interpolated from the table of `pyjkr.calibrate`, the checks integrate directly.
"""Contours of the restitution over damping and (Ad El^(-2/5))^(-5/6), and what high speed leaves of them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, model_validator

from pyjkr.calibrate.collision import collision
from pyjkr.calibrate.particle import Particle, chen_group, similarity_group
from pyjkr.calibrate.table import HIGHEST_RESTITUTION, LOWEST_RESTITUTION, restitution_of
from pyjkr.oracle import NormalContact, damping_ratio, impact
from pyjkr.plot import BLUE, LINE_STYLES, STYLE, VERMILION, panels
from pyjkr.studies.check import Check

VERSION = 1
# Of e_eff: between particles of one group, and of the table that the contours are drawn from.
COLLAPSE_TOLERANCE, TABLE_TOLERANCE = 1e-9, 1e-5
ALPHA_OF_BETA = math.sqrt(5)
# Where the contours are labelled, of the highest group.
LABELS_AT = 0.45


class Settings(BaseModel):
    """What figs 5 and 6 are drawn for."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    law: Literal["jkr", "jkr/simplified"] = "jkr"
    """Normal law."""
    alphas: tuple[PositiveFloat, ...] = (0.02, 0.1, 0.3, 0.6, 1.0)
    """Damping coefficients sqrt(5) abs(beta) of the direct integrations [-]."""
    groups: tuple[PositiveFloat, ...] = (6.0, 12.0, 40.0, 150.0)
    """(Ad El^(-2/5))^(-5/6) of the direct integrations [-]."""
    radii: tuple[PositiveFloat, ...] = (0.3e-6, 0.635e-6, 4e-6)
    """Sizes of the particles that share a group [m]."""
    moduli: tuple[PositiveFloat, ...] = (0.1e9, 3.8e9, 70e9)
    """Effective moduli [Pa], one for each radius."""
    surface_energies: tuple[PositiveFloat, ...] = (0.2, 0.05, 0.012)
    """Surface energies [J/m2], one for each radius."""
    densities: tuple[PositiveFloat, ...] = (2200.0, 1050.0, 7800.0)
    """[kg/m3], one for each radius."""
    contours: tuple[float, ...] = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
    """e_eff of the contour lines."""
    group_range: tuple[PositiveFloat, PositiveFloat] = (2.0, 300.0)
    """(Ad El^(-2/5))^(-5/6) that is drawn."""
    nodes: int = Field(default=160, ge=20)
    """Points of each axis of the contours."""

    @model_validator(mode="after")
    def _fit_together(self) -> Settings:
        counts = [len(each) for each in (self.radii, self.moduli, self.surface_energies, self.densities)]
        if len(set(counts)) > 1 or counts[0] < 2:
            given = ", ".join(map(str, counts))
            raise ValueError(f"radii, moduli, surface_energies, densities have {given} entries. Give one of each per particle, two or more.")
        least, most = (ALPHA_OF_BETA * float(damping_ratio(e)) for e in (HIGHEST_RESTITUTION, LOWEST_RESTITUTION))
        for alpha in self.alphas:
            if not least <= alpha <= most:
                raise ValueError(f"alphas: {alpha:g} is outside of the table, {least:.2g} to {most:.4g}. Choose one inside.")
        if self.group_range[0] >= self.group_range[1]:
            raise ValueError("group_range: the first end must be below the second. Swap them.")
        return self


def points(settings: Settings) -> list[dict]:
    """One point per damping and group, integrated directly for every particle; one for the map of contours."""
    particles = [
        {"radius": radius, "effective_modulus": modulus, "surface_energy": energy, "density": density}
        for radius, modulus, energy, density in zip(
            settings.radii, settings.moduli, settings.surface_energies, settings.densities, strict=True
        )
    ]
    found = [
        {"label": f"alpha = {alpha:g}, group = {group:g}", "engine": "oracle", "law": settings.law, "alpha": alpha, "group": group,
         "particles": particles}
        for alpha in settings.alphas
        for group in settings.groups
    ]  # fmt: skip
    span = {"group_range": list(settings.group_range), "nodes": settings.nodes}
    return [*found, {"label": "map", "engine": "table", "law": settings.law, **span}]


def evaluate(point: dict, directory: Path) -> list[dict]:
    """e_eff of one damping and group, particle by particle; or of the whole map, from the table."""
    return _map(point) if point["engine"] == "table" else _particles(point)


def _particles(point: dict) -> list[dict]:
    beta = point["alpha"] / ALPHA_OF_BETA
    e, model = restitution_of(beta), collision(point["law"])
    ratio = point["group"] / chen_group(1.0)
    tabulated = float(model.restitution(ratio / model.sticking_ratio(e), e))
    rows = []
    for number, given in enumerate(point["particles"]):
        particle = Particle(radius=given["radius"], density=given["density"])
        # from Ad and El themselves, not through v_*: (gamma/(rho v^2 r)) (E/(rho v^2))^(-2/5) goes as v^(-6/5)
        at_unit_speed = given["surface_energy"] / (given["density"] * given["radius"]) * (
            given["effective_modulus"] / given["density"]
        ) ** -0.4  # fmt: skip
        speed = point["group"] * at_unit_speed ** (5 / 6)
        contact = NormalContact(given["radius"], given["effective_modulus"], given["surface_energy"], point["law"], e)
        found = impact(contact, particle.effective_mass, speed, samples=2, stuck_periods=0.01)
        rows.append(
            {
                "engine": "oracle", "alpha": point["alpha"], "group": point["group"], "particle": number, "speed": speed,
                "e_eff": found.restitution, "e_eff_table": tabulated,
                "energy_group": similarity_group(given["surface_energy"], given["effective_modulus"]),
            }
        )  # fmt: skip
    return rows


def _map(point: dict) -> list[dict]:
    model = collision(point["law"])
    beta = np.linspace(*damping_ratio(np.array([HIGHEST_RESTITUTION, 1.0001 * LOWEST_RESTITUTION])), point["nodes"])
    groups = np.geomspace(*point["group_range"], point["nodes"])
    e = np.array([restitution_of(value) for value in beta])
    e_eff = model.restitution(groups[:, None] / chen_group(1.0) / model.sticking_ratio(e), e)
    rows = []
    for column, value in enumerate(beta):
        common = {
            "engine": "table",
            "alpha": ALPHA_OF_BETA * float(value),
            "sticking_group": chen_group(float(model.sticking_ratio(e[column]))),
        }
        rows += [
            common | {"group": float(group), "e_eff": float(restitution), "e_hertz": float(e[column])}
            for group, restitution in zip(groups, e_eff[:, column], strict=True)
        ]
    return rows


def checks(table: pd.DataFrame, settings: Settings) -> list[Check]:
    """Particles of one group collapse; the table is what they give; the map rises with speed and falls with damping."""
    direct, drawn = (table[table["engine"] == engine] for engine in ("oracle", "table"))
    same = direct.groupby(["alpha", "group"])["e_eff"]
    apart = float((same.max() - same.min()).max()) if same.size().min() > 1 else math.nan
    span = direct["energy_group"].max() / direct["energy_group"].min()
    name = f"e_eff between {len(settings.radii)} particles of one group, gamma E^(-2/5) from 1 to {span:.3g}"
    found = [Check(name, apart, "<= 1e-9", apart <= COLLAPSE_TOLERANCE)]
    error = float((direct["e_eff"] ** 2 - direct["e_eff_table"] ** 2).abs().max())
    found.append(Check("e_eff^2, table of the contours - direct integration", error, "<= 1e-5", error <= TABLE_TOLERANCE))
    moving = int((direct["e_eff"] > 0).sum())
    found.append(Check("direct integrations that rebound, and that stick", f"{moving}, {len(direct) - moving}", "both > 0",
                       0 < moving < len(direct)))  # fmt: skip
    grid = drawn.pivot(index="group", columns="alpha", values="e_eff").to_numpy()
    fall = float(max(-np.diff(grid, axis=0).min(), np.diff(grid, axis=1).max())) + 0.0  # no minus zero
    found.append(Check("e_eff on the map: largest step against rise with speed, fall with damping", fall, "<= 0", fall <= 0))
    below = drawn[drawn["group"] < drawn["sticking_group"]]["e_eff"]
    most = float(below.max()) if len(below) else math.nan
    found.append(Check("e_eff in the sticking region", most, "0", most == 0))
    return found


def figures(table: pd.DataFrame, settings: Settings) -> dict[str, Figure]:
    """Chen 2019, fig. 5: contours; and fig. 6 (c): damping over the restitution of the plateau, beside Hertz."""
    drawn = table[table["engine"] == "table"]
    grid = drawn.pivot(index="group", columns="alpha", values="e_eff")
    damping, groups = grid.columns.to_numpy(dtype=float), grid.index.to_numpy(dtype=float)
    figure, (axes, plateau) = panels(2, (10.0, 4.8))
    values = grid.to_numpy().T
    shades = axes.contourf(groups, damping, values, levels=np.linspace(0, 1, 21), cmap="Blues", zorder=0)
    lines = axes.contour(groups, damping, values, levels=settings.contours, colors="black", linewidths=0.9)
    # labels one above the other, on the plateau where the lines are apart
    place = groups[np.argmin(np.abs(groups - LABELS_AT * groups[-1]))]
    heights = np.interp(settings.contours, grid.loc[place].to_numpy()[::-1], damping[::-1])
    axes.clabel(lines, fmt="%g", fontsize=STYLE["legend"] - 1, manual=[(place, height) for height in heights.tolist()])
    sticking = drawn.drop_duplicates("alpha")
    axes.plot(sticking["sticking_group"], sticking["alpha"], "-", color=VERMILION, linewidth=2, label="sticking ends")
    axes.text(0.1, 0.8, "sticks", transform=axes.transAxes, fontsize=STYLE["label"], color=VERMILION)
    axes.set_xscale("log")
    axes.set_xlim(*settings.group_range)
    axes.set_ylim(0, damping[-1])
    axes.set_ylabel(r"damping coefficient $\alpha = \sqrt{5}\,|\beta|$ [-]", fontsize=STYLE["label"])
    axes.set_xlabel(r"$(Ad\,El^{-2/5})^{-5/6} \propto v$ [-]", fontsize=STYLE["label"])
    axes.set_title(r"contours of $e_{\rm eff}$", fontsize=STYLE["title"])
    figure.colorbar(shades, ax=axes, ticks=np.linspace(0, 1, 6))
    shown = [group for group in (30.0, 100.0, settings.group_range[1]) if group <= settings.group_range[1]]
    for number, group in enumerate(shown):
        row = grid.iloc[int(np.argmin(np.abs(groups - group)))]
        plateau.plot(row.to_numpy(), damping, LINE_STYLES[1 + number % 3], color=BLUE, linewidth=1.5,
                     label=rf"$(Ad\,El^{{-2/5}})^{{-5/6}}$ = {row.name:.0f}")  # fmt: skip
    plateau.plot(sticking["e_hertz"], sticking["alpha"], "-", color="black", linewidth=1.5, label="without adhesion")
    plateau.set_xlim(0, 1)
    plateau.set_ylim(0, damping[-1])
    plateau.set_xlabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=STYLE["label"])
    plateau.set_ylabel(r"damping coefficient $\alpha$ [-]", fontsize=STYLE["label"])
    plateau.set_title("damping read off the plateau", fontsize=STYLE["title"])
    figure.legend(loc="outside lower center", ncols=5, fontsize=STYLE["legend"], frameon=False)
    return {"restitution_contours": figure}
