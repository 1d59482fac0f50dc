"""Rows of packings -> figures: Chen, Liu and Li 2019, figs 8 to 13. Nothing of the paper is digitised: all shown is the model.

Colours and sizes are those of `pyjkr.plot`; the series keep theirs in every figure.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure

from pyjkr import plot

# By letter and number of the series: the letter sets the colours, the number the marker.
COLOURS = {
    "S": plot.BLUE, "A-1": "#E9A27F", "A-2": plot.VERMILION, "A-3": "#7F3800", "B-1": "#E3BAD2", "B-2": plot.PURPLE,
    "B-3": "#7D3C64", "C-1": "#7FCEB9", "C-2": plot.GREEN, "C-3": "#004F3A",
}  # fmt: skip
MARKERS = {"S": "o", "1": "^", "2": "s", "3": "D"}
LINES = {"S": "-", "1": ":", "2": "--", "3": "-."}
NAMES = {"packing_fraction": r"packing fraction $\phi$", "coordination_number": r"coordination number $Z$"}
# Thickness of the slice that a snapshot shows [r].
SLICE = 4.0


def by_series(summary: pd.DataFrame) -> Figure:
    """Packing fraction and coordination number of each series at one adhesion number; a column of fig. 9."""
    names = list(dict.fromkeys(summary["series"]))
    figure, both = plot.panels(2, (8.4, 3.8))
    for axes, (quantity, label) in zip(both, NAMES.items(), strict=True):
        for place, name in enumerate(names):
            values = summary.loc[summary["series"] == name, quantity]
            axes.plot(np.full(len(values), place - 0.16), values, ".", color=COLOURS[name], markersize=5, alpha=0.6)
            spread = values.std() if len(values) > 1 else 0.0
            axes.errorbar(place + 0.1, values.mean(), spread, fmt=_of(MARKERS, name), color=COLOURS[name], markersize=8, capsize=4)
            if name == "S":
                axes.axhspan(values.mean() - spread, values.mean() + spread, color=COLOURS[name], alpha=0.12, linewidth=0)
        axes.set_xticks(range(len(names)), names)
        axes.set_xlim(-0.6, len(names) - 0.4)
        _labels(axes, "series of table 1", label)
    count = summary.groupby("series")["seed"].nunique().max()
    number = summary["adhesion_number"].iloc[0]
    figure.suptitle(f"Ad = {number:g}: {count} packings of each series (dots), mean and standard deviation", fontsize=plot.STYLE["title"])
    return figure


def over_adhesion_number(summary: pd.DataFrame, quantity: str) -> Figure:
    """Packing fraction or coordination number over the adhesion number, series A, B and C against S; fig. 9."""
    letters = [letter for letter in "ABC" if summary["series"].str.startswith(letter).any()]
    figure, panels = plot.panels(max(1, len(letters)), (4.0 * max(1, len(letters)), 3.9))
    for axes, letter in zip(panels, letters or [""], strict=True):
        shown = [name for name in dict.fromkeys(summary["series"]) if name == "S" or (letter and name.startswith(letter))]
        for name in shown:
            groups = summary[summary["series"] == name].groupby("adhesion_number")[quantity]
            mean, spread = groups.mean(), groups.std().fillna(0.0)
            size = 9 if name == "S" else 6
            axes.errorbar(mean.index, mean, spread, fmt=_of(MARKERS, name), color=COLOURS[name], markersize=size, capsize=3,
                          markerfacecolor="none", linestyle=_of(LINES, name), linewidth=1, label=name)  # fmt: skip
        axes.set_xscale("log")
        axes.legend(fontsize=plot.STYLE["legend"], frameon=False)
        _labels(axes, r"adhesion number Ad of the real material", NAMES[quantity] if axes is panels[0] else "")
        axes.sharey(panels[0])
    return figure


def local_structure(table: pd.DataFrame) -> Figure:
    """Distributions of local packing fraction and of contacts of one sphere, S against C; fig. 10."""
    figure, (left, right) = plot.panels(2, (8.4, 3.9))
    names = [name for name in dict.fromkeys(table["series"]) if name == "S" or name.startswith("C")]
    for name in names:
        for axes, quantity in ((left, "local_packing_fraction"), (right, "coordination_number")):
            centre, density = _density(table, name, quantity)
            axes.plot(centre, density, marker=_of(MARKERS, name), color=COLOURS[name], linestyle=_of(LINES, name), markersize=5,
                      markerfacecolor="none", label=name)  # fmt: skip
    left.set_xlim(0.1, 0.8)
    right.set_xlim(0, 9)
    _labels(left, r"local packing fraction $\phi_{\rm local}$", "probability density")
    _labels(right, "contacts of one sphere", "probability")
    for axes in (left, right):
        axes.set_ylim(bottom=0)
        axes.legend(fontsize=plot.STYLE["legend"], frameon=False)
    return figure


def contacts(table: pd.DataFrame) -> Figure:
    """Distributions of overlap, with delta_e of eq. 16 as lines, and of scaled normal force, S against C; figs 11 and 12."""
    figure, (left, right) = plot.panels(2, (8.4, 4.2))
    summary, furthest = table[table["kind"] == "summary"], 0.0
    for name in [name for name in dict.fromkeys(table["series"]) if name == "S" or name.startswith("C")]:
        own = summary[summary["series"] == name].iloc[0]
        unit = own["equilibrium_overlap"] / own["radius"]
        label = rf"{name}, $E_R/E_O$ = {own['modulus_ratio']:.3g}"
        centre, density = _density(table, name, "overlap")
        furthest = max(furthest, centre[density > 0].max() * unit * 100)
        left.plot(centre * unit * 100, density / (unit * 100), color=COLOURS[name], linestyle=_of(LINES, name), label=label)
        left.axvline(unit * 100, color=COLOURS[name], linewidth=0.8, linestyle="--")
        centre, density = _density(table, name, "normal_force")
        filled = density > 0
        right.plot(centre[filled], density[filled], _of(MARKERS, name), color=COLOURS[name], markersize=4.5, markerfacecolor="none")
    left.set_xlim(-0.05 * furthest, 1.05 * furthest)
    left.set_yscale("log")
    right.set_yscale("log")
    _labels(left, r"overlap $\delta/r$ [%]", "probability density [1/%]")
    _labels(right, r"normal force $F_{\rm N}/\langle|F_{\rm N}|\rangle$", "probability density")
    figure.legend(loc="outside lower center", ncols=4, fontsize=plot.STYLE["legend"], frameon=False)
    return figure


def timing(summary: pd.DataFrame) -> Figure:
    """Time and steps of a packing over those of S, for every series; fig. 13."""
    figure, (axes,) = plot.panels(1, (5.6, 4.0))
    means = summary.groupby("series", sort=False)[["modulus_ratio", "loop_time", "steps"]].mean()
    real = means.loc["S"] if "S" in means.index else means.iloc[0]
    for name, own in means.iterrows():
        marker = {"marker": _of(MARKERS, name), "color": COLOURS[name], "linestyle": "none"}
        axes.plot(own["modulus_ratio"], own["loop_time"] / real["loop_time"], markersize=8, label=f"{name}, time", **marker)
        axes.plot(own["modulus_ratio"], own["steps"] / real["steps"], markersize=12, markerfacecolor="none", **marker)
    ratios = np.geomspace(means["modulus_ratio"].min(), 1, 50)
    axes.plot(ratios, ratios**0.4, "-", color="0.5", linewidth=1, label=r"$(E_R/E_O)^{2/5}$")
    axes.plot([], [], "s", color="0.4", markersize=12, markerfacecolor="none", linestyle="none", label="large open: steps")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_yticks([0.1, 0.2, 0.3, 0.5, 1.0], ["0.1", "0.2", "0.3", "0.5", "1"])
    axes.set_yticks([], minor=True)
    axes.legend(fontsize=plot.STYLE["legend"], frameon=False)
    _labels(axes, r"reduced over real stiffness $E_R/E_O$", "time and steps of a packing, over those of S")
    return figure


def snapshots(table: pd.DataFrame) -> Figure:
    """A slice of the bed of each series, coloured by contacts; fig. 8."""
    spheres = table[table["kind"] == "sphere"]
    names = list(dict.fromkeys(spheres["series"]))
    figure, panels = plot.panels(max(1, len(names)), (1.9 * max(2, len(names)) + 0.8, 3.6))
    drawn: Any = None
    top = float(spheres.loc[spheres["settled"].astype(bool), "z"].max()) + 1 if len(spheres) else 1.0
    for axes, name in zip(panels, names, strict=False):
        own = spheres[(spheres["series"] == name) & (spheres["y"] < SLICE) & (spheres["z"] < top)].sort_values("y", ascending=False)
        drawn = EllipseCollection(
            np.full(len(own), 2.0), np.full(len(own), 2.0), np.zeros(len(own)), units="xy", offsets=own[["x", "z"]].to_numpy(),
            offset_transform=axes.transData, array=own["contacts"].to_numpy(dtype=float), cmap="viridis", edgecolor="white",
            linewidth=0.3, clim=(0, 8),
        )  # fmt: skip
        axes.add_collection(drawn)
        axes.set_xlim(0, own["box"].max())
        axes.set_ylim(0, top)
        axes.set_aspect("equal")
        axes.set_title(name, fontsize=plot.STYLE["title"])
        _labels(axes, "$x/r$", "$z/r$" if axes is panels[0] else "")
        axes.tick_params(labelleft=axes is panels[0])
    if drawn is not None:
        figure.colorbar(drawn, ax=panels.tolist(), label=f"contacts; slice of {SLICE:g} r", shrink=0.8)
    return figure


def _density(table: pd.DataFrame, name: str, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Centres of the bins and probability density, over all seeds."""
    rows = table[(table["kind"] == "distribution") & (table["series"] == name) & (table["quantity"] == quantity)]
    counts = rows.groupby(["low", "high"])[["count", "total"]].sum().reset_index()
    width = counts["high"] - counts["low"]
    return ((counts["low"] + counts["high"]) / 2).to_numpy(), (counts["count"] / counts["total"] / width).to_numpy()


def _of(choices: dict[str, str], name: str) -> str:
    return choices[name.partition("-")[2] or "S"]


def _labels(axes: Any, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=plot.STYLE["label"])
    axes.set_ylabel(y, fontsize=plot.STYLE["label"])
