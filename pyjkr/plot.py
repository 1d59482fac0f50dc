"""`Comparison` -> figures: Haervig 2017, fig. 5 (e_eff over speed) and fig. 13 (velocity over time).

Colours are Okabe and Ito's, which colour-blind readers tell apart; marker shapes and sizes differ as well, so that
points which coincide, as they should, are all seen.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from pyjkr import scaling
from pyjkr.compare import Comparison

if TYPE_CHECKING:
    from pyjkr.calibrate.measurements import Measurements

BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
# Outermost first: each marker fits into the one before.
SCALED_MARKERS = (("o", 11, BLUE), ("s", 7.5, VERMILION), ("D", 4, GREEN), ("^", 3, PURPLE), ("v", 2, ORANGE))
UNMODIFIED_MARKERS = (("x", 8, PURPLE), ("+", 9, ORANGE), ("1", 9, SKY))
LINE_STYLES = ("-", "--", ":", "-.")
STYLE = {"label": 11, "tick": 10, "legend": 9, "title": 11}


def restitution_figure(comparison: Comparison, curves: pd.DataFrame, measured: Measurements | None = None) -> Figure:
    """Effective restitution coefficient over impact speed; Haervig 2017, fig. 5.

    Parameters
    ----------
    comparison : Comparison
        What to draw as markers.
    curves : DataFrame
        What to draw as lines, from `compare.oracle_curves`.
    measured : Measurements or None
        Points of an experiment, with error bars where their standard deviation is known.
    """
    figure, (axes,) = panels(1, (7.2, 4.6))
    table = comparison.table
    groups = list(dict.fromkeys(zip(table["modulus_ratio"], table["rule"], strict=True)))
    scaled = [ratio for ratio, rule in groups if rule == "scaled"]
    for style, ratio in zip(_cycle(LINE_STYLES, len(groups)), [q for q, rule in groups if rule == "unmodified"], strict=False):
        curve = curves[(curves["modulus_ratio"] == ratio) & (curves["rule"] == "unmodified")]
        axes.plot(curve["speed"], curve["e_eff"], style, color="0.55", linewidth=1.2, zorder=1,
                  label=rf"oracle, $E_{{\rm mod}}/E$ = {ratio:g}, $\gamma$ not modified")  # fmt: skip
    for ratio in scaled[:1]:
        curve = curves[(curves["modulus_ratio"] == ratio) & (curves["rule"] == "scaled")]
        axes.plot(curve["speed"], curve["e_eff"], "-", color="black", linewidth=1.4, label="oracle", zorder=2)
    engine = "LIGGGHTS" if comparison.engine == "liggghts" else "oracle"
    counts = {"scaled": 0, "unmodified": 0}
    for ratio, rule in groups:
        points = table[(table["modulus_ratio"] == ratio) & (table["rule"] == rule)]
        markers = SCALED_MARKERS if rule == "scaled" else UNMODIFIED_MARKERS
        marker, size, colour = markers[counts[rule] % len(markers)]
        counts[rule] += 1
        energy = r"$\gamma_{\rm mod} = \gamma\,(E_{\rm mod}/E)^{2/5}$" if rule == "scaled" and ratio != 1 else r"$\gamma$ real"
        name = rf"{engine}, $E_{{\rm mod}}/E$ = {ratio:g}, {energy}" + (" (not modified)" if rule == "unmodified" else "")
        axes.plot(
            points["speed"], points[f"e_eff_{comparison.engine}"], marker, markersize=size, color=colour, markerfacecolor="none",
            markeredgewidth=1.5, label=name, zorder=3, clip_on=False,
        )  # fmt: skip
    if measured is not None:
        axes.errorbar(measured.speed, measured.restitution, yerr=measured.standard_deviation, fmt="*", markersize=9, color=ORANGE,
                      ecolor="0.5", elinewidth=0.8, label=f"measured, {Path(measured.source).name}", zorder=4)  # fmt: skip
    axes.set_xscale("log")
    _plain_speed_ticks(axes, sorted(table["speed"].unique()))
    axes.set_ylim(-0.02, 1.0)
    axes.set_xlabel("impact speed $v$ [m/s]", fontsize=STYLE["label"])
    axes.set_ylabel(r"effective restitution coefficient $e_{\rm eff}$", fontsize=STYLE["label"])
    e = comparison.plan.scene.meeting.restitution_coefficient
    axes.axhline(e, color="0.75", linewidth=0.8, zorder=0)
    axes.annotate(f"without adhesion, $e$ = {e:g}", (0.01, e), xycoords=("axes fraction", "data"), xytext=(0, 3),
                  textcoords="offset points", fontsize=STYLE["legend"], color="0.4")  # fmt: skip
    figure.legend(loc="outside lower center", ncols=2, fontsize=STYLE["legend"], frameon=False)
    axes.set_title(comparison.plan.scene.title, fontsize=STYLE["title"])
    return figure


def velocity_figure(comparison: Comparison) -> Figure:
    """Velocity over time at one speed, and over scaled time, where all stiffnesses agree; Haervig 2017, fig. 13.

    Parameters
    ----------
    comparison : Comparison
        What to draw, at the speed that `figures.velocity_speed` of its scene names.
    """
    speed = comparison.plan.scene.figures.velocity_speed
    cases = [case for case in comparison.plan.cases if case.speed == speed and case.rule == "scaled"]
    figure, (left, right) = panels(2, (8.6, 4.2))
    longest = max((_shown_time(comparison, case) for case in cases), default=0.0)
    for case, style, (_, _, colour) in zip(
        cases, _cycle(LINE_STYLES, len(cases)), _cycle(SCALED_MARKERS, len(cases)), strict=True
    ):
        outcome = comparison.outcomes[case.label]
        label = rf"$E_{{\rm mod}}/E$ = {case.modulus_ratio:g}"
        time, factor = outcome.time * 1e9, scaling.time_factor(case.modulus_ratio)
        left.plot(time, outcome.velocity, style, color=colour, linewidth=1.8, label=label)
        right.plot(time / factor, outcome.velocity, style, color=colour, linewidth=1.8)
    left.set_xlim(-0.03 * longest * 1e9, 1.1 * longest * 1e9)
    scaled_end = max((_shown_time(comparison, case) / scaling.time_factor(case.modulus_ratio) for case in cases), default=0.0)
    right.set_xlim(-0.03 * scaled_end * 1e9, 1.1 * scaled_end * 1e9)
    left.set_xlabel("time since contact $t$ [ns]", fontsize=STYLE["label"])
    right.set_xlabel(r"scaled time $t\,(E_{\rm mod}/E)^{2/5}$ [ns]", fontsize=STYLE["label"])
    left.set_ylabel("velocity towards the target [m/s]", fontsize=STYLE["label"])
    for axes in (left, right):
        axes.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    right.tick_params(labelleft=False)
    right.sharey(left)
    figure.legend(loc="outside lower center", ncols=len(cases) or 1, fontsize=STYLE["legend"], frameon=False)
    figure.suptitle(f"{comparison.plan.scene.title}, {speed:g} m/s", fontsize=STYLE["title"])
    return figure


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG; the suffix of `path` is taken as it is."""
    figure.savefig(path, dpi=200)


def panels(columns: int, size: tuple[float, float]):
    """A figure without pyplot's global state, and its axes in a row."""
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for each in axes:
        each.tick_params(labelsize=STYLE["tick"], direction="in", top=True, right=True, which="both")
    return figure, axes


def _shown_time(comparison: Comparison, case) -> float:
    """End of the contact [s], or three stuck periods."""
    time = comparison.outcomes[case.label].contact_time
    return time if time == time else 3 * case.periods["stuck oscillation"]


def _cycle(values, count: int) -> list:
    return [values[i % len(values)] for i in range(count)]


def _plain_speed_ticks(axes, speeds: list[float]) -> None:
    """1, 2, 5, 10, ... as plain numbers on the logarithmic axis."""
    marks = [mantissa * 10.0**decade for decade in range(-6, 6) for mantissa in (1, 2, 3, 5, 7)]
    shown = [mark for mark in marks if speeds[0] * 0.999 <= mark <= speeds[-1] * 1.001]
    shown = shown if len(shown) > 1 else speeds
    axes.set_xticks(shown, [f"{mark:g}" for mark in shown])
    axes.set_xticks([], minor=True)
    axes.set_xlim(speeds[0] * 0.93, speeds[-1] * 1.07)
