"""Figures of the border between sticking and rebound: Haervig 2017, figs 11 and 12.

Covers drawing only; the rows come from `sticking_threshold`. Nothing digitised is drawn.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

from pyjkr import plot

# Factor of the damping in eq. 11: mended, and as printed.
CORRECTED, PRINTED = "2 sqrt(5/6)", "2 (5/6)"


def critical_elasticity_figure(table: pd.DataFrame) -> Figure:
    """lambda_crit over Ad, one line per e; Haervig 2017, fig. 11.

    Parameters
    ----------
    table : DataFrame
        Rows of the study, with one damping.
    """
    figure, (axes,) = plot.panels(1, (7.2, 5.2))
    oracle = table[table["engine"] == "oracle"]
    values = sorted(oracle["restitution_coefficient"].unique())
    colours = colormaps["viridis"](np.linspace(0, 0.88, len(values)))
    for index, (e, colour) in enumerate(zip(values, colours, strict=True)):
        line = oracle[oracle["restitution_coefficient"] == e].sort_values("adhesiveness")
        label = "oracle, bisection" if index == 0 else None
        axes.plot(line["adhesiveness"], line["critical_elasticity"], ".-", color=colour, linewidth=1.4, markersize=5, label=label)
        end = line.iloc[-1]
        axes.annotate(f"e = {e:g}", (end["adhesiveness"], end["critical_elasticity"]), xytext=(5, 0), textcoords="offset points",
                      va="center", fontsize=plot.STYLE["legend"], color=colour)  # fmt: skip
    _draw_liggghts(axes, table, "adhesiveness", "critical_elasticity")
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = oracle["adhesiveness"].min(), oracle["adhesiveness"].max()
    axes.set_xlim(low / 1.3, high * (high / low) ** 0.13)
    axes.text(0.10, 0.80, "rebounds", transform=axes.transAxes, fontsize=plot.STYLE["label"], color="0.35")
    axes.text(0.68, 0.22, "sticks", transform=axes.transAxes, fontsize=plot.STYLE["label"], color="0.35")
    axes.set_xlabel(r"adhesiveness parameter ${\rm Ad} = 3\gamma/(\rho v^2 r)$", fontsize=plot.STYLE["label"])
    axes.set_ylabel(r"critical elasticity parameter $\lambda_{\rm crit} = E/(\rho v^2)$", fontsize=plot.STYLE["label"])
    axes.set_title("Border between sticking and rebound at a wall (model only)", fontsize=plot.STYLE["title"])
    figure.legend(loc="outside lower center", ncols=2, fontsize=plot.STYLE["legend"], frameon=False)
    return figure


def coefficient_figure(table: pd.DataFrame, reference: pd.DataFrame | None) -> Figure:
    """c over e, with the corrected and the printed damping; Haervig 2017, fig. 12.

    Parameters
    ----------
    table : DataFrame
        Rows of the study.
    reference : DataFrame or None
        Derived values: e, c, c_printed.
    """
    figure, (axes,) = plot.panels(1, (7.2, 4.8))
    lines = (
        (CORRECTED, "-", plot.BLUE, r"damping $2\sqrt{5/6}$", "c"),
        (PRINTED, "--", plot.VERMILION, "damping 2 (5/6), as printed", "c_printed"),
    )
    for damping, style, colour, label, column in lines:
        line = table[(table["engine"] == "oracle") & (table["damping"] == damping)].sort_values("restitution_coefficient")
        if len(line):
            x, y = line["restitution_coefficient"], line["coefficient"]
            axes.plot(x, y, style, color=colour, linewidth=1.6, label=f"oracle, {label}")
            if reference is not None:
                name = "derived reference" if damping == CORRECTED else None
                axes.plot(reference["e"], reference[column], "x", color="black", markersize=7, label=name, zorder=3)
    _draw_liggghts(axes, table, "restitution_coefficient", "coefficient")
    axes.set_yscale("log")
    axes.set_xlim(0, 1)
    axes.set_xlabel("restitution coefficient without adhesion $e$", fontsize=plot.STYLE["label"])
    axes.set_ylabel(r"coefficient $c = \lambda_{\rm crit}\,{\rm Ad}^{-5/2}$", fontsize=plot.STYLE["label"])
    axes.set_title("Coefficient of the border between sticking and rebound (model only)", fontsize=plot.STYLE["title"])
    figure.legend(loc="outside lower center", ncols=2, fontsize=plot.STYLE["legend"], frameon=False)
    return figure


def _draw_liggghts(axes, table: pd.DataFrame, x: str, y: str) -> None:
    found = table[table["engine"] == "liggghts"]
    if len(found):
        axes.plot(found[x], found[y], "o", color="black", markersize=9, markerfacecolor="none", markeredgewidth=1.3,
                  label="LIGGGHTS, bisection", zorder=4)  # fmt: skip
