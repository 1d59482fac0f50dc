"""`Costs` -> work-precision diagrams: error against computing time and against steps, labelled with steps per collision.

Colours are Okabe and Ito's; correction on and off differ in marker and line style as well. Imported by `report` alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from pyjkr.cost import results
from pyjkr.cost.results import Costs
from pyjkr.plot import BLUE, GREEN, ORANGE, PURPLE, SKY, STYLE, VERMILION, panels

# (target, law) -> colour, marker.
CURVES = {
    ("wall", "jkr/simplified"): (BLUE, "o"),
    ("wall", "jkr"): (VERMILION, "s"),
    ("sphere", "jkr/simplified"): (GREEN, "D"),
    ("sphere", "jkr"): (PURPLE, "^"),
}
# Markers of curves that coincide, as a wall and a pair do in a normal impact, must all be seen: outermost first.
SIZES = {"wall": 9, "sphere": 4.5}
MARKS = (("o", BLUE), ("s", VERMILION), ("D", GREEN), ("^", PURPLE), ("v", ORANGE), ("P", SKY), ("X", "black"))
# Drawn in place of no change at all.
NO_CHANGE = 1e-6
DPI = 90


def all_figures(costs: Costs) -> Iterator[tuple[str, Figure]]:
    """(file name, figure) for each study that has something to show."""
    yield "cost-steps.png", steps_figure(costs)
    if len(costs.study("stiffness")):
        yield "cost-stiffness.png", stiffness_figure(costs)
    if len(costs.study("effects")):
        yield "cost-effects.png", effects_figure(costs)


def steps_figure(costs: Costs) -> Figure:
    """Largest error in e_eff^2 over speeds and phases, against steps per collision and against computing time."""
    figure, (left, right) = panels(2, (9.6, 5.0))
    rows = results.steps_with_time(costs)
    for (target, law, corrected), curve in rows.groupby(results.LAW_KEYS, sort=False):
        colour, marker = CURVES[(target, law)]
        look = {
            "color": colour,
            "marker": marker,
            "markersize": SIZES[target],
            "linestyle": "-" if corrected == "on" else "--",
            "markerfacecolor": "none" if target == "wall" else colour,
            "linewidth": 1.3,
        }
        name = f"{law}, {'wall' if target == 'wall' else 'pair'}, event correction {corrected}"
        left.plot(curve["steps_per_collision"], curve["energy_error"], **look, label=name)
        right.plot(curve["collision_computing_time"] * 1e6, curve["energy_error"], **look)
        if target == "wall":
            above = (law == "jkr") == (corrected == "on")
            _label_points(right, curve, curve["collision_computing_time"] * 1e6, colour, above)
    for steps, tolerance in results.TARGETS.items():
        left.plot(steps, tolerance, marker="v", color="black", markersize=8, linestyle="none",
                  label="target" if steps == min(results.TARGETS) else None)  # fmt: skip
    for axes, shown in ((left, rows["steps_per_collision"]), (right, rows["collision_computing_time"] * 1e6)):
        _log_log(axes, shown)
    left.set_xticks(*_plain(rows["steps_per_collision"].unique()))
    left.set_xlabel("time steps per collision", fontsize=STYLE["label"])
    right.set_xlabel(r"computing time of one collision [$\mu$s]", fontsize=STYLE["label"])
    left.set_ylabel(r"largest error in $e_{\rm eff}^2$", fontsize=STYLE["label"])
    right.sharey(left)
    right.tick_params(labelleft=False)
    figure.legend(loc="outside lower center", ncols=2, fontsize=STYLE["legend"], frameon=False)
    figure.suptitle("Normal impacts from 1.1 times the sticking speed on", fontsize=STYLE["title"])
    return figure


def stiffness_figure(costs: Costs) -> Figure:
    """Reduced stiffness: integrator's error over steps in normal impacts; in oblique ones the physical change beside it."""
    figure, (left, right) = panels(2, (9.6, 6.0))
    rows = results.stiffness(costs)
    palette = _palette(sorted(rows["modulus_ratio"].unique(), reverse=True))
    for ratio, curve in reversed(list(rows.groupby("modulus_ratio"))):
        colour, marker = palette[ratio]
        left.plot(curve["steps_for_time"], curve["energy_error"], "-", color=colour, marker=marker, markersize=6,
                  markerfacecolor="none", linewidth=1.3, label=rf"$E_{{\rm mod}}/E$ = {ratio:g}")  # fmt: skip
        if ratio in (max(palette), min(palette)):
            _label_points(left, curve, curve["steps_for_time"], colour, above=ratio == max(palette))
    left.set_xlabel("time steps for the time of one real collision", fontsize=STYLE["label"])
    left.set_ylabel(r"largest error in $e_{\rm eff}^2$", fontsize=STYLE["label"])
    left.set_title("normal impact: the integrator's error alone", fontsize=STYLE["title"])
    _log_log(left, rows["steps_for_time"])
    changes = results.oblique(costs)
    _oblique_panel(right, changes)
    _log_log(right, changes["modulus_ratio"])
    for axes, columns in ((left, 2), (right, 1)):
        axes.legend(fontsize=STYLE["legend"], frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=columns)
    return figure


def _oblique_panel(axes: Axes, rows: pd.DataFrame) -> None:
    looks = {("tangential", "scaled"): (BLUE, "o", "none"), ("spin", "scaled"): (VERMILION, "s", "none")}
    looks |= {("tangential", "originals"): (BLUE, "o", BLUE), ("spin", "originals"): (VERMILION, "s", VERMILION)}
    names = {"tangential": r"$v_t$", "spin": r"$r\omega$"}
    energies = {"scaled": r"scaled $\gamma$", "originals": r"original $\gamma$ in sliding and rolling"}
    for (quantity, rule), (colour, marker, fill) in looks.items():
        curve = rows[(rows["effect"] == rule) & (rows["modulus_ratio"] < 1)].drop_duplicates("modulus_ratio")
        axes.plot(curve["modulus_ratio"], curve[f"{quantity}_change"], "-", color=colour, marker=marker, markerfacecolor=fill,
                  label=f"change of {names[quantity]}, {energies[rule]}")  # fmt: skip
    shown = [steps for steps in (20, 60, 200) if steps in set(rows["steps_per_collision"])]
    for steps, style in zip(shown, ("--", "-.", ":"), strict=False):
        curve = rows[(rows["effect"] == "scaled") & (rows["steps_per_collision"] == steps)]
        worst = curve[["tangential_error", "spin_error"]].max(axis=1)
        axes.plot(curve["modulus_ratio"], worst, style, color="0.35", label=f"error of {steps} steps a collision")
    axes.set_xlabel(r"stiffness $E_{\rm mod}/E$", fontsize=STYLE["label"])
    axes.set_ylabel("in parts of the impact speed", fontsize=STYLE["label"])
    axes.set_title("oblique impact: physical change, and error", fontsize=STYLE["title"])


def effects_figure(costs: Costs) -> Figure:
    """What leaving out an effect changes in an oblique impact, and what computing time is left."""
    figure, (axes,) = panels(1, (8.2, 4.4))
    rows = results.effects(costs)
    rows = rows[rows["effect"] != "everything"]
    for row, (marker, colour) in zip(rows.itertuples(), MARKS, strict=False):
        axes.plot(row.time_ratio, max(row.largest_change, NO_CHANGE), marker, color=colour, markersize=9, label=row.effect)
    axes.axvline(1, color="0.75", linewidth=0.8, zorder=0)
    axes.axhline(results.MATTERS, color="0.75", linewidth=0.8, zorder=0)
    axes.annotate("below: hardly matters", (0.01, results.MATTERS), xycoords=("axes fraction", "data"), xytext=(0, -11),
                  textcoords="offset points", fontsize=STYLE["legend"], color="0.4")  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(NO_CHANGE / 2, 2)
    axes.set_yticks(*zip(*[(NO_CHANGE, "none"), *((10.0**power, f"$10^{{{power}}}$") for power in range(-5, 1))], strict=True))
    axes.set_xlabel("computing time per step, of that with everything", fontsize=STYLE["label"])
    axes.set_ylabel("largest change of $v_n$, $v_t$, $r\\omega$ over impact speed", fontsize=STYLE["label"])
    figure.legend(loc="outside right center", fontsize=STYLE["legend"], frameon=False)
    axes.set_title("oblique impact without one effect", fontsize=STYLE["title"])
    return figure


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a small PNG."""
    figure.savefig(path, dpi=DPI)


def _log_log(axes: Axes, x: pd.Series) -> None:
    """Logarithmic axes with plain numbers along x, and room for the labels of the points."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(x.min() / 1.6, x.max() * 1.6)
    axes.margins(y=0.08)
    marks = [mantissa * 10.0**decade for decade in range(-6, 7) for mantissa in (1, 3)]
    axes.set_xticks(*_plain([mark for mark in marks if x.min() / 1.6 <= mark <= x.max() * 1.6]))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(True, which="major", color="0.9", linewidth=0.6)


def _plain(marks: Sequence[float]) -> tuple[Sequence[float], list[str]]:
    return marks, [f"{mark:g}" for mark in marks]


def _label_points(axes: Axes, curve: pd.DataFrame, x: pd.Series, colour: str, above: bool) -> None:
    for place, error, steps in zip(x, curve["energy_error"], curve["steps_per_collision"], strict=True):
        axes.annotate(f"{steps:g}", (place, error), xytext=(5, 4) if above else (-5, -5), textcoords="offset points",
                      ha="left" if above else "right", va="bottom" if above else "top", fontsize=7, color=colour)  # fmt: skip


def _palette(ratios: list[float]) -> dict[float, tuple[str, str]]:
    looks = (("black", "o"), (SKY, "s"), (BLUE, "D"), (GREEN, "^"), (VERMILION, "v"), (ORANGE, "P"), (PURPLE, "X"))
    return {ratio: looks[index % len(looks)] for index, ratio in enumerate(ratios)}
