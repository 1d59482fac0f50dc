"""Runs of LIGGGHTS on small beds -> the coefficients of a `CostModel`.

Covers no law. Beds are cubic lattices of like spheres that just overlap (three contacts each) or stand apart: what touches is known.
Assumes that the machine may be busy: of several runs of a deck the fastest counts, part by part.
"""

from __future__ import annotations

import itertools
import math
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from pyjkr.errors import RunError
from pyjkr.planning import probe_deck
from pyjkr.planning.cost_model import PARTS, SHIPPED, CostModel, ghosts, machine_name, parts
from pyjkr.planning.probe_deck import Material, ProbeDeck, Sphere
from pyjkr.simulator import Simulator

# Polystyrene of 1 um softened to 50 MPa; sixty steps in the period of the stiffest mode. Spheres are so heavy that contacts neither
# push them apart nor pull them together: what touches stays as it was counted.
RADIUS, DENSITY, TIME_STEP = 0.5e-6, 1e18, 5e-10
MATERIAL = Material(
    youngs_modulus=50e6, poissons_ratio=0.33, restitution_coefficient=0.8, friction_coefficient=0.35, surface_energy=0.00885,
    critical_rolling_angle=0.01, more={"coefficientRollingFriction": 0.1},
)  # fmt: skip
# Distance of neighbours in a bed, and apart, in diameters.
TOUCHING, APART = 0.99, 1.6
SPEED = 1e-4
SEED = 5
# Changes no digit of a speed: it is the fix that is timed.
FORCE = 1e-30
LAWS = (
    "model hertz",
    "model hertz tangential history",
    "model hertz tangential history rolling_friction epsd2",
    *(
        f"model {normal}{rest}"
        for normal in ("jkr/simplified", "jkr")
        for rest in (
            "",
            " tangential jkr",
            " tangential jkr rolling_friction krijt",
            " tangential jkr rolling_friction krijt twisting on",
        )
    ),
)
FULL = LAWS[-1]


@dataclass(frozen=True, kw_only=True)
class Timing:
    """What one run took, and what there was to do.

    Attributes
    ----------
    styles : str
        The law.
    spheres, contacts, idle, candidates : float
        As for `CostModel.step_time`.
    steps, rebuilds, ranks : int
        Of the run.
    pair_time, neighbour_time, other_time, loop_time : float
        As LIGGGHTS tells them [s]; neighbour: with the exchange of spheres before; other: integration and fixes.
    bins, forces, frames : float
        As for `CostModel.step_time` and `loop_time`.
    output_time, start_time : float
        Of frames; of the program outside its runs [s].
    """

    styles: str
    spheres: int
    contacts: float
    idle: float
    candidates: float
    steps: int
    rebuilds: int
    ranks: int
    pair_time: float
    neighbour_time: float
    other_time: float
    loop_time: float
    bins: float = 0.0
    forces: int = 0
    frames: int = 0
    output_time: float = 0.0
    start_time: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Bed:
    """A deck to be timed.

    Attributes
    ----------
    styles : str
        The law.
    edge : int
        Spheres along an edge.
    distance, skin, room : float
        Of neighbours, of the lists, and empty space at one face of the box [diameters].
    steps, runs, ranks : int
        Steps of each run, runs, MPI processes.
    always_rebuild, pushed, written : bool
        Whether every step makes new lists, whether a fix pushes the spheres, whether every step is a frame.
    """

    styles: str
    edge: int
    distance: float
    skin: float
    steps: int
    runs: int = 3
    ranks: int = 1
    room: float = 0.0
    always_rebuild: bool = False
    pushed: bool = False
    written: bool = False

    @property
    def spheres(self) -> int:
        """N."""
        return self.edge**3

    @property
    def pairs(self) -> tuple[int, int]:
        """Pairs that touch, and those that are nearer than the skin but do not."""
        listed = _lattice_pairs(self.edge, (1 + self.skin) / self.distance)
        touching = _lattice_pairs(self.edge, 1 / self.distance)
        return touching, listed - touching

    @property
    def candidates(self) -> float:
        """Pairs looked at for new lists."""
        return candidates(self.spheres, (2 * RADIUS * self.distance) ** -3, 2 * RADIUS * (1 + self.skin))


def candidates(spheres: float, number_density: float, search: float) -> float:
    """Pairs looked at for new neighbour lists: spheres within the search distance of each, n (4/3) pi (d + skin)^3.

    LIGGGHTS looks at the bins around, which is more by a factor that does not change with the distance.

    Parameters
    ----------
    spheres : float
        N.
    number_density : float
        n [1/m3].
    search : float
        Largest diameter and skin [m].
    """
    return spheres * number_density * 4 / 3 * math.pi * search**3


def beds(ranks: bool) -> list[Bed]:
    """What `calibrate` runs: every law, idle pairs, new lists, few spheres, and where told two ranks."""
    touching = [Bed(styles=law, edge=10, distance=TOUCHING, skin=0.1, steps=12, runs=30) for law in LAWS]
    idle = [Bed(styles=law, edge=10, distance=TOUCHING, skin=0.5, steps=12, runs=30) for law in (LAWS[1], FULL)]
    lists = [
        Bed(styles=LAWS[1], edge=12, distance=distance, skin=skin, steps=2, runs=20, always_rebuild=True)
        for distance, skin in ((TOUCHING, 0.1), (TOUCHING, 0.6), (APART, 0.1), (APART, 0.5))
    ]
    lists += [Bed(styles=LAWS[1], edge=6, distance=APART, skin=0.1, steps=4, runs=20, room=60.0, always_rebuild=True)]
    few = [Bed(styles=LAWS[1], edge=edge, distance=APART, skin=0.1, steps=steps, runs=20) for edge, steps in ((2, 500), (4, 500), (10, 50))]
    few += [Bed(styles=LAWS[1], edge=5, distance=APART, skin=0.1, steps=200, runs=20, pushed=True)]
    few += [Bed(styles=LAWS[1], edge=edge, distance=APART, skin=0.1, steps=10, runs=10, written=True) for edge in (2, 8)]
    shared = [
        Bed(styles=FULL, edge=edge, distance=TOUCHING, skin=0.1, steps=steps, runs=10, ranks=2) for edge, steps in ((6, 200), (12, 40))
    ]
    return touching + idle + lists + few + (shared if ranks else [])


def idle_machine() -> bool:
    """Whether two cores are free: ranks that wait for a busy core would be timed waiting."""
    cores = os.cpu_count() or 1
    return cores > 1 and os.getloadavg()[0] < cores - 1


def calibrate(
    simulator: Simulator, directory: Path | None = None, report: Callable[[int, int], None] = lambda done, all: None
) -> CostModel:
    """Measure the coefficients on this machine; takes some five seconds.

    Parameters
    ----------
    simulator : Simulator
        LIGGGHTS to measure.
    directory : Path or None
        Gets the runs; None uses a temporary one.
    report : callable
        Told how many runs are done, of how many.

    Raises
    ------
    RunError
        Where a run fails.
    """
    if directory is None:
        with tempfile.TemporaryDirectory(prefix="pyjkr-cost-") as name:
            return calibrate(simulator, Path(name), report)
    wanted = beds(idle_machine() and shutil.which("mpirun") is not None)
    timings = []
    for done, bed in enumerate(wanted, start=1):
        timings.append(measure(bed, directory / f"{done:02d}", simulator))
        report(done, len(wanted))
    return replace(fit(timings), program=probe_deck.program_digest(simulator), machine=machine_name())


def fit(timings: Sequence[Timing]) -> CostModel:
    """Coefficients that fit timings best, none of them negative: least squares of relative errors.

    Pair times give the laws and idle pairs, neighbour times the lists, spheres without neighbours the step itself and forces; output
    the frames; two ranks, what is left of their time, the exchange. What was not timed, and triangles, are those of the shipped model,
    as much faster or slower as this machine is in the pairs.
    """
    alone = [timing for timing in timings if timing.ranks == 1]
    busy = [timing for timing in alone if timing.contacts + timing.idle > 0]
    pair_rows = [
        [timing.steps * timing.contacts * (name in parts(timing.styles)) for name in PARTS] + [timing.steps * timing.idle]
        for timing in busy
    ]
    *laws, idle = _solve(pair_rows, [timing.pair_time for timing in busy])
    listed = [timing for timing in alone if timing.rebuilds > 0]
    rebuild_sphere, rebuild_candidate, rebuild_bin = _solve(
        [[timing.rebuilds * amount for amount in (timing.spheres, timing.candidates, timing.bins)] for timing in listed],
        [timing.neighbour_time for timing in listed],
    )
    lonely = [timing for timing in alone if timing.contacts + timing.idle == 0 and not timing.rebuilds and not timing.frames]
    step, sphere, force = _solve(
        [[timing.steps, timing.steps * timing.spheres, timing.steps * timing.spheres * timing.forces] for timing in lonely],
        [timing.other_time + timing.pair_time for timing in lonely],
    )
    written = [timing for timing in alone if timing.frames]
    frame, frame_sphere = _solve(
        [[timing.frames, timing.frames * timing.spheres] for timing in written], [timing.output_time for timing in written]
    )
    pace = sum(laws) / sum(SHIPPED.laws.values())
    model = CostModel(
        step=step, sphere=sphere, idle=idle, rebuild_sphere=rebuild_sphere, rebuild_candidate=rebuild_candidate, rebuild_bin=rebuild_bin,
        force=force, triangle=pace * SHIPPED.triangle, frame=frame, frame_sphere=frame_sphere,
        start=min(timing.start_time for timing in alone), message=pace * SHIPPED.message, ghost=pace * SHIPPED.ghost,
        laws=dict(zip(PARTS, laws, strict=True)),
    )  # fmt: skip
    shared = [timing for timing in timings if timing.ranks > 1]
    if not shared:
        return model
    rows = [[timing.steps, timing.steps * ghosts(timing.spheres, timing.ranks)] for timing in shared]
    left = [max(timing.loop_time - predicted(replace(model, message=0.0, ghost=0.0), timing), 1e-3 * timing.loop_time) for timing in shared]
    message, ghost = _solve(rows, left)
    return replace(model, message=message, ghost=ghost)


def predicted(model: CostModel, timing: Timing) -> float:
    """Loop time [s] that a model gives to a run that was timed."""
    return model.loop_time(
        timing.steps, timing.styles, timing.spheres, timing.contacts, idle=timing.idle, rebuild_rate=timing.rebuilds / timing.steps,
        candidates=timing.candidates, bins=timing.bins, forces=timing.forces, ranks=timing.ranks, frames=timing.frames,
    )  # fmt: skip


def measure(bed: Bed, directory: Path, simulator: Simulator, material: Material = MATERIAL) -> Timing:
    """Time one bed: the fastest of its runs for each part of the time, after a short one that counts for nothing.

    Parameters
    ----------
    bed, directory, simulator
        What to run, where, with what.
    material : Material
        Only its names matter for the time.
    """
    deck = deck_of(bed, material)
    run = probe_deck.execute(deck, directory, simulator, ranks=bed.ranks)
    blocks = read_log(run.log.read_text(encoding="utf-8", errors="replace"))[1:]
    if len(blocks) != bed.runs:
        raise RunError(f"{run.log}: {len(blocks)} of {bed.runs} runs tell their times. Remove the directory and run again.")
    touching, idle = bed.pairs

    def least(*names: str) -> float:
        return min(sum(block.get(name, 0.0) for name in names) for block in blocks)

    return Timing(
        styles=bed.styles, spheres=bed.spheres, contacts=touching, idle=idle, candidates=bed.candidates, steps=bed.steps,
        rebuilds=int(least("builds")), ranks=bed.ranks, pair_time=least("Pair"), neighbour_time=least("Neigh", "Comm"),
        other_time=least("Other", "Modfy"), loop_time=least("Loop"), bins=_bins(deck), forces=int(bed.pushed),
        frames=bed.steps if bed.written else 0, output_time=least("Outpt"), start_time=run.wall_time - run.loop_time,
    )  # fmt: skip


def deck_of(bed: Bed, material: Material = MATERIAL) -> ProbeDeck:
    """The deck of a bed."""
    spacing = 2 * RADIUS * bed.distance
    random = np.random.default_rng(SEED)
    places = np.stack(np.meshgrid(*[np.arange(bed.edge) * spacing] * 3, indexing="ij"), axis=-1).reshape(-1, 3).tolist()
    speeds = random.normal(0.0, SPEED, (len(places), 3)).tolist()
    spheres = tuple(
        Sphere(radius=RADIUS, density=DENSITY, position=tuple(place), velocity=tuple(speed), force=(0.0, 0.0, FORCE * bed.pushed))
        for place, speed in zip(places, speeds, strict=True)
    )
    edge = bed.edge * spacing
    space = edge + 2 * RADIUS * bed.room
    return ProbeDeck(
        title=f"timing of {bed.styles}, {bed.spheres} spheres", spheres=spheres, material=material, styles=bed.styles,
        time_step=TIME_STEP, runs=(10, *[bed.steps] * bed.runs), skin=2 * RADIUS * bed.skin, box=(-spacing, space) * 3,
        every=int(bed.written), always_rebuild=bed.always_rebuild,
    )  # fmt: skip


_LOOP = re.compile(r"^Loop time of (\S+) on ", re.MULTILINE)
_PART = re.compile(r"^(\w+)\s+time \(%\) = (\S+)", re.MULTILINE)
_BIN_SIZE = re.compile(r"binsize (\S+)")
_BUILDS = re.compile(r"^Neighbor list builds = (\d+)", re.MULTILINE)


def read_log(text: str) -> list[dict[str, float]]:
    """Times [s] of every run in a log of LIGGGHTS by their names, `Loop` for all of it; `builds`: new neighbour lists.

    Parameters
    ----------
    text : str
        The log.
    """
    starts = [match.start() for match in _LOOP.finditer(text)]
    blocks = []
    for start, end in itertools.pairwise([*starts, len(text)]):
        block = text[start:end]
        builds = _BUILDS.search(block)
        if builds:
            times = {name: float(value) for name, value in _PART.findall(block)}
            blocks.append(times | {"Loop": float(_LOOP.search(block)[1]), "builds": int(builds[1])})
    return blocks


def _solve(rows: Sequence[Sequence[float]], times: Sequence[float]) -> list[float]:
    """Non-negative least squares of relative errors; columns are scaled, whose sizes differ by many orders."""
    matrix = np.array(rows, dtype=float) / np.array(times)[:, None]
    scale = np.maximum(np.linalg.norm(matrix, axis=0), np.finfo(float).tiny)
    solution, _ = nnls(matrix / scale, np.ones(len(times)))
    return [float(value) for value in solution / scale]


def _lattice_pairs(edge: int, reach: float) -> int:
    """Pairs of points of a cubic lattice nearer than `reach` lattice constants."""
    span = range(-math.floor(reach), math.floor(reach) + 1)
    return (
        sum(
            max(0, edge - abs(i)) * max(0, edge - abs(j)) * max(0, edge - abs(k))
            for i in span for j in span for k in span
            if 0 < i * i + j * j + k * k < reach * reach
        )
        // 2
    )  # fmt: skip


def _bins(deck: ProbeDeck) -> float:
    """Bins of a deck's box: `probe_deck.render` writes their size."""
    size = float(_BIN_SIZE.search(probe_deck.render(deck)[0])[1])
    return float(np.prod([(high - low) / size for low, high in zip(deck.box[::2], deck.box[1::2], strict=True)]))
