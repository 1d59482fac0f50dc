"""The bed that every law is measured on: a periodic packing of spheres, made once, and what touches what in it.

Random points relax under a harmonic repulsion until no overlap pushes any more (just short of jamming, so that
neighbours lie side by side); then all lengths shrink a little, and neighbours overlap by about what JKR contacts
without load do. Larger beds repeat a smaller one. The same file is read by LIGGGHTS and LAMMPS.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

# Solid fraction before shrinking: short of random close packing (0.64), which sets the coordination number.
PACKED_FRACTION = 0.58
SEED = 20240607
# Relaxed when the overlaps that are left are this part of a radius; the bed's own overlaps are a hundred times larger.
RELAXED_OVERLAP = 2e-4
MAX_ITERATIONS = 4000


@dataclass(frozen=True)
class BedSpec:
    """What defines a bed.

    Parameters
    ----------
    spheres
        Number of spheres.
    radius
        Mean radius [m].
    overlap
        Overlap of two spheres that lay side by side, as a part of the mean diameter.
    size_spread
        Radii are uniform within mean (1 +- size_spread); 0: equal.
    density
        Of the material [kg/m3].
    speed
        Root mean square of each velocity component in the live bed [m/s]; spins carry a comparable surface speed.
    """

    spheres: int
    radius: float = 0.5e-6
    overlap: float = 0.01
    size_spread: float = 0.0
    density: float = 1050.0
    speed: float = 0.1

    @property
    def key(self) -> str:
        recipe = json.dumps([asdict(self), PACKED_FRACTION, SEED, RELAXED_OVERLAP, MAX_ITERATIONS])
        return f"{self.spheres}-{hashlib.sha256(recipe.encode()).hexdigest()[:10]}"


@dataclass(frozen=True)
class Bed:
    """A packing in a periodic box with one corner at the origin.

    Parameters
    ----------
    positions, radii, box
        [m].
    velocities, spins
        Of the live bed [m/s, rad/s].
    density
        [kg/m3].
    """

    positions: np.ndarray
    radii: np.ndarray
    box: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
    density: float

    @property
    def contacts(self) -> Contacts:
        return count_contacts(self.positions, self.radii, self.box)


def pairs_within(positions: np.ndarray, box: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of points closer than a distance in a periodic box.

    Parameters
    ----------
    positions, box
        [m].
    distance
        [m], less than half the shortest edge of the box.

    Returns
    -------
    tuple of arrays
        First index, second index, vector from the second to the first [m].
    """
    wrapped = np.mod(positions, box)
    # np.mod of a tiny negative number is the edge itself, which cKDTree refuses.
    wrapped[wrapped >= box] = 0.0
    pairs = cKDTree(wrapped, boxsize=box).query_pairs(distance, output_type="ndarray")
    i, j = pairs[:, 0], pairs[:, 1]
    return i, j, _nearest_image(wrapped[i] - wrapped[j], box)


@dataclass(frozen=True)
class Contacts:
    """What overlaps in a periodic box.

    Parameters
    ----------
    pairs
        Pairs of spheres that overlap.
    evaluations
        Times a serial run with `newton off` evaluates the law each step: twice for a pair that touches through a face
        of the box, once from each side.
    """

    pairs: int
    evaluations: int


def count_contacts(positions: np.ndarray, radii: np.ndarray, box: np.ndarray) -> Contacts:
    """Count the pairs of spheres that overlap in a periodic box.

    Parameters
    ----------
    positions, radii, box
        [m].
    """
    i, j, separation = pairs_within(positions, box, 2.0 * float(np.max(radii)))
    reach = radii[i] + radii[j]
    touching = np.einsum("ij,ij->i", separation, separation) < reach * reach
    wrapped = np.mod(positions, box)
    through_face = np.any(np.abs(wrapped[i] - wrapped[j]) > 0.5 * box, axis=1)
    pairs = int(np.count_nonzero(touching))
    return Contacts(pairs, pairs + int(np.count_nonzero(touching & through_face)))


def make_bed(spec: BedSpec, show: Callable[[int], None] = lambda iteration: None) -> Bed:
    """Pack a bed.

    Parameters
    ----------
    spec
        What to make.
    show
        Called with the iteration.
    """
    random = np.random.default_rng(SEED)
    n = spec.spheres
    shares = 1.0 + spec.size_spread * random.uniform(-1.0, 1.0, n)
    volume = 4.0 / 3.0 * math.pi * float(np.sum(shares**3))
    edge = (volume / PACKED_FRACTION) ** (1.0 / 3.0)
    positions = _relax(random.uniform(0.0, edge, (n, 3)), shares, edge, show)
    scale = spec.radius * (1.0 - spec.overlap)
    radii = spec.radius * shares
    return Bed(
        positions=scale * np.mod(positions, edge),
        radii=radii,
        box=np.full(3, scale * edge),
        velocities=random.normal(0.0, spec.speed, (n, 3)),
        spins=random.normal(0.0, spec.speed, (n, 3)) / radii[:, None],
        density=spec.density,
    )


def repeated(bed: Bed, times: tuple[int, int, int]) -> Bed:
    """A bed laid side by side with itself, along each edge as often as told."""
    shifts = np.stack(np.meshgrid(*(np.arange(k) for k in times), indexing="ij"), axis=-1).reshape(-1, 3) * bed.box
    copies = len(shifts)
    return Bed(
        positions=(bed.positions[None] + shifts[:, None]).reshape(-1, 3),
        radii=np.tile(bed.radii, copies),
        box=bed.box * np.asarray(times),
        velocities=np.tile(bed.velocities, (copies, 1)),
        spins=np.tile(bed.spins, (copies, 1)),
        density=bed.density,
    )


def cached_bed(spec: BedSpec, directory: Path, show: Callable[[int], None] = lambda iteration: None) -> Bed:
    """The bed of an earlier call, or a new one that is kept for the next."""
    file = directory / f"bed-{spec.key}.npz"
    if file.exists():
        with np.load(file) as stored:
            return Bed(**{name: stored[name] for name in stored.files if name != "density"}, density=spec.density)
    bed = make_bed(spec, show)
    directory.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".part.npz")
    np.savez(unfinished, **{name: value for name, value in vars(bed).items() if name != "density"})
    unfinished.replace(file)
    return bed


def write_data_file(bed: Bed, file: Path, *, moving: bool) -> None:
    """Write a bed as `read_data` of LIGGGHTS (granular) and LAMMPS (sphere) takes it.

    Parameters
    ----------
    bed
        What to write.
    file
        Where to.
    moving
        With the velocities and spins; otherwise all are 0.
    """
    number = np.arange(1, len(bed.radii) + 1)
    unfinished = file.with_suffix(".part")
    with unfinished.open("w", encoding="ascii") as out:
        out.write(f"bed of {len(number)} spheres\n\n{len(number)} atoms\n1 atom types\n\n")
        for axis, length in zip("xyz", bed.box, strict=True):
            out.write(f"0.0 {length:.17g} {axis}lo {axis}hi\n")
        out.write("\nAtoms\n\n")
        rows = np.column_stack(
            [number, np.ones_like(number), 2.0 * bed.radii, np.full(len(number), bed.density), bed.positions]
        )
        np.savetxt(out, rows, fmt="%d %d %.17g %.17g %.17g %.17g %.17g")
        if moving:
            out.write("\nVelocities\n\n")
            np.savetxt(out, np.column_stack([number, bed.velocities, bed.spins]), fmt="%d" + " %.17g" * 6)
    unfinished.replace(file)


def _nearest_image(separation: np.ndarray, box: np.ndarray | float) -> np.ndarray:
    return separation - box * np.round(separation / box)


def _relax(positions: np.ndarray, radii: np.ndarray, edge: float, show: Callable[[int], None]) -> np.ndarray:
    """Push overlapping spheres apart: FIRE (Bitzek et al. 2006) with unit masses and unit spring constants."""
    n, box = len(radii), np.full(3, edge)
    reach, skin = 2.0 * float(np.max(radii)), 0.4
    velocity = np.zeros_like(positions)
    step, largest_step, mixing, downhill = 0.1, 0.5, 0.1, 0
    listed_at = None
    for iteration in range(MAX_ITERATIONS):
        if listed_at is None or np.max(np.abs(positions - listed_at)) > 0.5 * skin / math.sqrt(3.0):
            i, j, _ = pairs_within(positions, box, reach + skin)
            listed_at = positions.copy()
        separation = _nearest_image(positions[i] - positions[j], edge)
        distance = np.sqrt(np.einsum("ij,ij->i", separation, separation))
        overlap = np.maximum(radii[i] + radii[j] - distance, 0.0)
        if np.max(overlap, initial=0.0) < RELAXED_OVERLAP:
            break
        push = (overlap / np.maximum(distance, 1e-12))[:, None] * separation
        force = np.column_stack([np.bincount(i, push[:, k], n) - np.bincount(j, push[:, k], n) for k in range(3)])
        power = float(np.sum(force * velocity))
        if power > 0.0:
            speed, strength = np.linalg.norm(velocity), np.linalg.norm(force)
            velocity = (1.0 - mixing) * velocity + mixing * speed / strength * force
            downhill += 1
            if downhill > 5:
                step, mixing = min(1.1 * step, largest_step), 0.99 * mixing
        elif power < 0.0:
            velocity[:] = 0.0
            step, mixing, downhill = 0.5 * step, 0.1, 0
        velocity += step * force
        positions = positions + step * velocity
        show(iteration)
    return positions
