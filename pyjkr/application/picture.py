"""A run -> one picture: the spheres from the side, and the number that the scene is about over time.

Covers one view or two and one curve for each start of `scene.Start`. Spheres are circles, the farther ones drawn first and paler,
coloured by fragment or cluster, in a stream by what the tube holds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from pyjkr import plot
from pyjkr.application import analysis
from pyjkr.application.analysis import Frame
from pyjkr.application.scene import Application
from pyjkr.planning.variants import Variant

# Largest clusters first, in colours that stay apart when pale; smaller ones and single spheres are grey.
COLOURS = (plot.BLUE, plot.VERMILION, plot.GREEN, plot.PURPLE)
GREY, WALL, BODY = "0.75", "0.35", "0.9"
# Part of white mixed into the colour of the farthest sphere.
FARTHEST = 0.4
# Prefixes of lengths and times, largest that keeps the numbers above 1.
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
# Shown over time, and how it is named.
SHOWN = {
    "pair": ("separation_speed", "speed of separation [m/s]"),
    "single": ("distance_along_wall", "way along the wall"),
    "agglomerate": ("fragments", "fragments"),
    "cloud": ("mean_cluster_size", "spheres per cluster"),
    "rain": ("kinetic_energy_share", r"kinetic energy / ($m\,g\,r$ of all)"),
    "stream": ("captured_share", "captured part of the spheres"),
}
# Room around the shown spheres, in radii of the largest; of flying fragments the outermost are left outside [percent].
ROOM, OUTERMOST = 0.6, 4.0
# A tube is shown down to here at least, in its radii from the axis.
LOWEST_OF_TUBE = 0.25
# Views flatter than this, height over width, stand above the curve. Sizes in inches.
FLAT = 0.5
WIDTH, HEIGHT, CURVE, WIDTH_OF_CURVE, MARGIN = 6.4, 3.4, 2.3, 3.6, 0.85


@dataclass(frozen=True)
class Window:
    """What a view shows [m]."""

    left: float
    right: float
    low: float
    high: float

    @property
    def flatness(self) -> float:
        """Height over width."""
        return (self.high - self.low) / (self.right - self.left)

    def holds(self, frame: Frame) -> np.ndarray:
        """Whether each sphere's centre is seen."""
        x, z = frame.positions[:, 0], frame.positions[:, 2]
        return (x >= self.left) & (x <= self.right) & (z >= self.low) & (z <= self.high)


def picture(scene: Application, variant: Variant, directory: Path) -> Figure:
    """Side view at the end of a run, of an agglomerate also before; and what the scene is about over time.

    Parameters
    ----------
    scene, variant
        What was simulated.
    directory : Path
        Of the run.
    """
    every = analysis.frames(scene, variant, directory)
    return draw(scene, every)


def draw(scene: Application, every: list[Frame]) -> Figure:
    """The same of frames at hand."""
    window = _window(scene, every)
    shown = [every[0], every[-1]] if scene.start == "agglomerate" else [every[-1]]
    figure, views, curve = _panels(window, len(shown))
    for axes, frame in zip(views, shown, strict=True):
        _side_view(axes, scene, every[0], frame, window)
    _over_time(curve, scene, every)
    figure.suptitle(scene.title, fontsize=plot.STYLE["title"])
    return figure


def _panels(window: Window, views: int) -> tuple[Figure, list[Axes], Axes]:
    """Axes of the views and of the curve: flat views above each other and above it, one other beside it, two side by side above it."""
    names = list(range(views))
    if window.flatness < FLAT:
        height = WIDTH * window.flatness
        size = (WIDTH + MARGIN, views * (height + MARGIN) + CURVE + MARGIN)
        grid = {"mosaic": [[name] for name in [*names, "curve"]], "height_ratios": [height] * views + [CURVE]}
    elif views == 1:
        width = HEIGHT / window.flatness
        size = (width + WIDTH_OF_CURVE + 2 * MARGIN, HEIGHT + MARGIN)
        grid = {"mosaic": [[0, "curve"]], "width_ratios": [width, WIDTH_OF_CURVE]}
    else:
        height = WIDTH_OF_CURVE * window.flatness
        size = (views * (WIDTH_OF_CURVE + MARGIN), height + CURVE + 2 * MARGIN)
        grid = {"mosaic": [names, ["curve"] * views], "height_ratios": [height, CURVE]}
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic(**grid)
    for each in axes.values():
        each.tick_params(labelsize=plot.STYLE["tick"], direction="in", top=True, right=True, which="both")
    return figure, [axes[name] for name in names], axes["curve"]


def _window(scene: Application, every: list[Frame]) -> Window:
    """Room for what matters at the end, and at the start where it is drawn too; of a stream the upper side of the tube."""
    first, last = every[0], every[-1]
    room = ROOM * float(last.radii.max())
    if scene.start == "stream":
        half = scene.wall.radius
        held = last.positions[last.held]
        left, right = np.array([-half, half]) if not len(held) else (min(-half, held[:, 0].min()), max(half, held[:, 0].max()))
        low = min(LOWEST_OF_TUBE * half, held[:, 2].min(initial=half))
        high = held[:, 2].max(initial=half)
        margin = float(last.radii.max()) + room
        return Window(left - margin, right + margin, low - margin, high + margin)
    if scene.start == "cloud":
        return Window(-room, scene.domain.size[0] + room, -room, scene.domain.size[2] + room)
    frames = [first, last] if scene.start in ("pair", "single", "agglomerate") else [last]
    left_out = [0.0, OUTERMOST] if scene.start == "agglomerate" else [0.0] * len(frames)
    sides = []
    for axis in (0, 2):
        lows = [np.percentile(frame.positions[:, axis] - frame.radii, part) for frame, part in zip(frames, left_out, strict=True)]
        highs = [np.percentile(frame.positions[:, axis] + frame.radii, 100 - part) for frame, part in zip(frames, left_out, strict=True)]
        sides.append((min(lows) - room, max(highs) + room))
    (left, right), (low, high) = sides
    if scene.wall:
        low = -0.05 * (right - left)
    return Window(float(left), float(right), float(low), float(high))


def _side_view(axes: Axes, scene: Application, first: Frame, frame: Frame, window: Window) -> None:
    unit, prefix = _prefix(max(window.right - window.left, window.high - window.low))
    axes.set_xlim(window.left / unit, window.right / unit)
    axes.set_ylim(window.low / unit, window.high / unit)
    axes.set_aspect("equal")
    axes.set_xlabel(f"$x$ [{prefix}m]", fontsize=plot.STYLE["label"])
    axes.set_ylabel(f"$z$ [{prefix}m]", fontsize=plot.STYLE["label"])
    if scene.wall and scene.wall.shape == "tube":
        axes.add_patch(Circle((0, 0), scene.wall.radius / unit, facecolor=BODY, edgecolor=WALL))
    elif scene.wall:
        axes.axhspan(window.low / unit, 0.0, facecolor=BODY, edgecolor=WALL)
    if scene.domain and all(scene.periodic):
        width, _, height = scene.domain.size
        axes.add_patch(Rectangle((0, 0), width / unit, height / unit, fill=False, edgecolor=WALL, linestyle=":"))
    colours = _colours(scene, frame)
    if scene.start in ("pair", "single"):
        _outlines(axes, first, unit, colours)
    _spheres(axes, frame, unit, colours)
    axes.set_title(_what(scene, first, frame, window), fontsize=plot.STYLE["legend"])


def _spheres(axes: Axes, frame: Frame, unit: float, colours: list[str]) -> None:
    depth = frame.positions[:, 1]
    order = np.argsort(-depth)
    # 0 in front, 1 at the back; a single layer is all in front.
    behind = (depth - depth.min()) / max(np.ptp(depth), float(frame.radii.max()))
    pale = FARTHEST * behind[:, None]
    faces = (1 - pale) * np.array([to_rgb(colour) for colour in colours]) + pale
    _circles(axes, frame, order, unit, facecolors=faces[order], edgecolors="black", linewidths=0.4)


def _outlines(axes: Axes, frame: Frame, unit: float, colours: list[str]) -> None:
    _circles(axes, frame, np.arange(len(frame.radii)), unit, facecolors="none", edgecolors=colours, linewidths=1.2, linestyles="--")


def _circles(axes: Axes, frame: Frame, order: np.ndarray, unit: float, **style: object) -> None:
    sizes = 2 * frame.radii[order] / unit
    places = frame.positions[order][:, [0, 2]] / unit
    axes.add_collection(
        EllipseCollection(sizes, sizes, np.zeros(len(order)), units="xy", offsets=places, transOffset=axes.transData, **style)
    )


def _colours(scene: Application, frame: Frame) -> list[str]:
    """By cluster, the largest first; in a stream by what the tube holds; one colour elsewhere."""
    if scene.start == "stream":
        return [plot.VERMILION if held else GREY for held in frame.held]
    if scene.start in ("rain", "pair", "single"):
        return [plot.BLUE] * len(frame.radii)
    clusters = frame.clusters
    sizes = np.bincount(clusters)
    ranks = {int(cluster): rank for rank, cluster in enumerate(np.argsort(-sizes, kind="stable"))}
    return [COLOURS[ranks[int(cluster)]] if ranks[int(cluster)] < len(COLOURS) and sizes[cluster] > 1 else GREY for cluster in clusters]


def _what(scene: Application, first: Frame, frame: Frame, window: Window) -> str:
    unit, prefix = _prefix(frame.time)
    when = "start" if frame is first else f"after {frame.time / unit:.3g} {prefix}s"
    outside = int(np.count_nonzero(~window.holds(frame)))
    seen = f"{outside} of {scene.number} spheres are outside" if outside else ""
    if scene.start in ("pair", "single"):
        return f"dashed: start; filled: {when}"
    if scene.start == "agglomerate":
        what = "coloured: the four largest fragments" if len(frame.pairs) else "no two spheres touch"
        return when if frame is first else f"{when}; {what}" + (f"\n{seen}" if seen else "")
    if scene.start == "cloud":
        return f"{when}; coloured: the four largest clusters;\ndotted: the periodic block"
    return f"{when}{'; coloured: held by the tube' if scene.start == 'stream' else ''}{f'; {seen}' if seen else ''}"


def _over_time(axes: Axes, scene: Application, every: list[Frame]) -> None:
    name, label = SHOWN[scene.start]
    times = np.array([frame.time for frame in every])
    measured = [analysis.measure(scene, every[0], frame) for frame in every]
    values = np.array([each[name] for each in measured])
    unit, prefix = _prefix(times[-1])
    if analysis.UNITS[name] == "m":
        length, length_prefix = _prefix(float(np.abs(values).max()))
        values, label = values / length, f"{label} [{length_prefix}m]"
    if scene.start == "rain":
        # Spheres that start at rest have no logarithm.
        times, values = times[values > 0], values[values > 0]
        axes.set_yscale("log")
    axes.plot(times / unit, values, "-", color=plot.BLUE, linewidth=1.6)
    if scene.start == "pair":
        axes.axhline(0, color="0.75", linewidth=0.8, zorder=0)
    elif scene.start != "rain":
        axes.set_ylim(bottom=min(0.0, 1.05 * values.min()))
    axes.set_xlim(0, every[-1].time / unit)
    axes.set_xlabel(f"time [{prefix}s]", fontsize=plot.STYLE["label"])
    axes.set_ylabel(label, fontsize=plot.STYLE["label"])
    axes.set_title(_result(scene, measured[-1]), fontsize=plot.STYLE["legend"])


def _result(scene: Application, values: dict[str, float]) -> str:
    """What came out, in a few words."""
    if scene.start in ("pair", "single"):
        stuck = "stuck together" if scene.start == "pair" else f"stuck after {_length(values['distance_along_wall'])} along the wall"
        return f"result: {stuck}" if values["stuck"] else rf"result: rebound, $e_{{\rm eff}}$ = {values['e_eff']:.3f}"
    if scene.start == "agglomerate":
        largest = round(values["largest_fragment_share"] * scene.number)
        return f"result: {values['fragments']:.0f} fragments, " + (f"the largest of {largest} spheres" if largest > 1 else "all single spheres")
    if scene.start == "cloud":
        return f"result: {values['mean_cluster_size']:.3g} spheres per cluster, {values['largest_cluster_size']:.0f} in the largest"
    if scene.start == "rain":
        return f"result: packing fraction {values['packing_fraction']:.3f}, {values['coordination_number']:.2f} contacts per sphere"
    return f"result: {100 * values['captured_share']:.0f} % of the spheres, {100 * values['captured_mass_share']:.0f} % of the mass"


def _length(value: float) -> str:
    unit, prefix = _prefix(value)
    return f"{value / unit:.3g} {prefix}m"


def _prefix(value: float) -> tuple[float, str]:
    return next(((size, letter) for size, letter in PREFIXES if math.fabs(value) >= size), PREFIXES[-1])
