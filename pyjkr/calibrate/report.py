"""`Calibration` -> text for a terminal, and files: `result.json`, `calibration.csv`, `calibration.png`.

Covers no law. `result.json` is written last and in one move, so that what bears this name is always a whole result.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pyjkr import plot
from pyjkr.calibrate.inversion import Calibration, Estimate
from pyjkr.report import versions

RESULT_NAME, CURVE_NAME, FIGURE_NAME = "result.json", "calibration.csv", "calibration.png"
# Speeds of the curve, close above the sticking speed as well, where it rises like a square root.
CURVE_POINTS = 300
# The curve is drawn beyond the points by this factor either way.
MARGIN = 1.25

# Attribute, name and unit of what is found.
QUANTITIES = (
    ("restitution_coefficient", "restitution coefficient without adhesion e", "-"),
    ("damping_ratio", "damping ratio |beta|", "-"),
    ("alpha", "damping of the full law alpha = sqrt(5) |beta|", "-"),
    ("sticking_speed", "sticking speed v_s", "m/s"),
    ("group", "gamma E^(-2/5)", "J m^-2 Pa^-0.4"),
    ("surface_energy", "surface energy gamma", "J/m2"),
    ("surface_energy_mod", "surface energy gamma_mod", "J/m2"),
)


def text(found: Calibration) -> str:
    """Table of what was found, for a terminal."""
    moduli = {"surface_energy": found.particle.effective_modulus, "surface_energy_mod": found.particle.effective_modulus_mod}
    lines = [f"law {found.law}, {_counts(found)}", ""]
    share = f"{100 * found.confidence:g} % interval"
    lines.append(f"{'':<50}{'best':>11}   {share + ', all together':<30}")
    for name, label, unit in QUANTITIES:
        estimate: Estimate | None = getattr(found, name)
        if estimate is None:
            continue
        at = f" at {'E_mod' if name.endswith('mod') else 'E'} = {moduli[name]:g} Pa" if name in moduli else ""
        between = "unknown" if estimate.lower is None else f"{estimate.lower:.5g} to {estimate.upper:.5g}"
        lines.append(f"{label + at:<50}{estimate.value:>11.5g}   {between:<24} {unit}")
    if found.surface_energy is None and found.surface_energy_mod is None:
        lines.append("gamma and E enter rebounds as gamma E^(-2/5) only: give E or E_mod, and gamma follows.")
    if found.surface_energy_mod is not None:
        e, energy = found.restitution_coefficient.value, found.surface_energy_mod.value
        lines += ["", "for the [[contact]] of a scene that is run at E_mod itself:"]
        lines += [f"effective_modulus = {found.particle.effective_modulus_mod:g}", f"surface_energy = {energy:.6g}"]
        lines += [f"restitution_coefficient = {e:.6g}"]
    return "\n".join(lines)


def write(found: Calibration, directory: Path) -> Path:
    """Write all files of a calibration; return the path of `result.json`."""
    directory.mkdir(parents=True, exist_ok=True)
    for name in (RESULT_NAME, CURVE_NAME, FIGURE_NAME):
        (directory / name).unlink(missing_ok=True)
    curve(found).to_csv(directory / CURVE_NAME, index=False)
    plot.save(figure(found), directory / FIGURE_NAME)
    unfinished = directory / f".{RESULT_NAME}.{os.getpid()}"
    unfinished.write_text(json.dumps(result(found), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    return unfinished.replace(directory / RESULT_NAME)


def result(found: Calibration) -> dict[str, Any]:
    """What was found, fit for JSON; SI units, intervals null where nothing can be said."""
    particle, points = found.particle, found.measurements
    estimates = {name: getattr(found, name) for name, _, _ in QUANTITIES}
    return {
        "law": found.law,
        "confidence": found.confidence,
        "estimates": {
            name: {"value": estimate.value, "lower": estimate.lower, "upper": estimate.upper, "unit": unit}
            for (name, _, unit), estimate in zip(QUANTITIES, estimates.values(), strict=True)
            if estimate is not None
        },
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "scatter": found.scatter,
        "warnings": list(found.warnings),
        "particle": vars(particle) | {"effective_radius": particle.effective_radius, "effective_mass": particle.effective_mass},
        "source": points.source,
        "speed": points.speed.tolist(),
        "restitution": points.restitution.tolist(),
        "standard_deviation": None if points.standard_deviation is None else points.standard_deviation.tolist(),
        "residual": (points.restitution - found.curve(points.speed)[0]).tolist(),
        "versions": versions(),
    }


def curve(found: Calibration) -> pd.DataFrame:
    """The calibrated curve and its band.

    Returns
    -------
    DataFrame
        speed [m/s], e_eff, e_eff_lower, e_eff_upper [-]; the band is missing where nothing can be said.
    """
    points, sticking = found.measurements, found.sticking_speed.value
    lowest = min(points.speed[0], max(sticking, 0.1 * points.speed[0])) / MARGIN
    highest = max(points.speed[-1], sticking) * MARGIN
    speeds = np.geomspace(lowest, highest, CURVE_POINTS)
    if lowest < sticking:
        speeds = np.union1d(speeds, sticking + np.append(0.0, np.geomspace(1e-5 * sticking, highest - sticking, CURVE_POINTS)[:-1]))
    best, lower, upper = found.curve(speeds)
    nothing = np.full(len(speeds), np.nan)
    edges = (nothing, nothing) if lower is None else (lower, upper)
    return pd.DataFrame({"speed": speeds, "e_eff": best, "e_eff_lower": edges[0], "e_eff_upper": edges[1]})


def figure(found: Calibration, title: str | None = None) -> Figure:
    """Points, calibrated curve and band; as Chen, Liu, Li 2019, fig. 7."""
    drawn, (axes,) = plot.panels(1, (7.2, 4.6))
    draw(axes, found)
    axes.set_title(title or f"calibrated by {found.measurements.source}", fontsize=plot.STYLE["title"])
    drawn.legend(loc="outside lower center", ncols=2, fontsize=plot.STYLE["legend"], frameon=False)
    return drawn


def draw(axes: Axes, found: Calibration, name: str = "measured") -> None:
    """The same on given axes, without title and legend; `name` is what the points are called."""
    line, points = curve(found), found.measurements
    if found.region is not None:
        label = f"{100 * found.confidence:g} % band, all speeds together"
        axes.fill_between(line["speed"], line["e_eff_lower"], line["e_eff_upper"], color=plot.SKY, alpha=0.35, linewidth=0, label=label)
    e, group = found.restitution_coefficient.value, found.group.value
    label = rf"{found.law}, $e$ = {e:.3g}, $\gamma E^{{-2/5}}$ = {_power(group)} J m$^{{-2}}$ Pa$^{{-0.4}}$"
    axes.plot(line["speed"], line["e_eff"], "-", color=plot.BLUE, linewidth=1.6, label=label)
    bars = points.standard_deviation if points.standard_deviation is not None else None
    axes.errorbar(
        points.speed, points.restitution, yerr=bars, fmt="o", color="black", markersize=5, markerfacecolor="none", markeredgewidth=1.3,
        capsize=2, elinewidth=1, label=name + ("" if bars is None else ", one standard deviation"), clip_on=False, zorder=3,
    )  # fmt: skip
    axes.axhline(e, color="0.75", linewidth=0.8, zorder=0)
    axes.set_xscale("log")
    low, high = line["speed"].iloc[[0, -1]]
    marks = [mantissa * 10.0**decade for decade in range(-6, 6) for mantissa in ((1, 2, 5) if high / low < 300 else (1,))]
    shown = [mark for mark in marks if low <= mark <= high]
    if len(shown) > 1:
        axes.set_xticks(shown, [f"{mark:g}" for mark in shown])
        axes.set_xticks([], minor=True)
    axes.set_xlim(low, high)
    axes.set_ylim(0, 1)
    axes.set_xlabel("impact speed $v$ [m/s]", fontsize=plot.STYLE["label"])
    axes.set_ylabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=plot.STYLE["label"])


def _counts(found: Calibration) -> str:
    rebounds = int(found.measurements.rebounds.sum())
    stuck = len(found.measurements.speed) - rebounds
    words = f"{rebounds} points that rebound" + (f", {stuck} that stuck" if stuck else "")
    return words + (f"; scatter {found.scatter:.3g} in e_eff" if found.scatter is not None else "")


def _power(value: float) -> str:
    """A number as mathtext with a power of ten."""
    mantissa, exponent = f"{value:.3e}".split("e")
    return rf"${float(mantissa):.3g}\times10^{{{int(exponent)}}}$"
