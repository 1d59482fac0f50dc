"""A run -> the few numbers that its scene is about: rebound, spin, fragments, clusters, what a wall caught, a bed's density.

Covers one function for each start of `scene.Start`, over one frame. Contacts are LIGGGHTS' own list, necks among them; a
sphere touches a wall where its gap is no longer than a neck, since LIGGGHTS lists no contacts of primitive walls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pyjkr import dump
from pyjkr.application import laws, shapes
from pyjkr.application.deck import CONTACTS_NAME, FACETS, SPHERES_NAME
from pyjkr.application.laws import Law
from pyjkr.application.scene import Application
from pyjkr.planning.variants import Variant

# Unit of each number, as `observables` names it; "" for pure numbers.
UNITS = {
    "e_eff": "",
    "stuck": "",
    "separation_speed": "m/s",
    "tangential_speed": "m/s",
    "spin": "rad/s",
    "distance_along_wall": "m",
    "fragments": "",
    "largest_fragment_share": "",
    "single_share": "",
    "contacts_left_share": "",
    "share_on_wall": "",
    "captured_share": "",
    "captured_mass_share": "",
    "mean_captured_radius": "m",
    "shift_across": "m",
    "mean_cluster_size": "",
    "weighted_cluster_size": "",
    "largest_cluster_size": "",
    "coordination_number": "",
    "packing_fraction": "",
    "bed_height": "m",
    "kinetic_energy_share": "",
}
# Part of a bed's height that is measured, away from the floor and from the ragged surface.
MIDDLE = (0.25, 0.75)


@dataclass(frozen=True)
class Frame:
    """Spheres and contacts at one step.

    Attributes
    ----------
    time : float
        Since the start [s].
    radii, masses : ndarray
        [m], [kg], by identifier.
    positions, velocities, spins : ndarray
        [m], [m/s], [rad/s], one row each.
    pairs : ndarray
        Indices of the two spheres of each contact.
    at_wall : ndarray
        Whether a sphere touches the wall.
    """

    time: float
    radii: np.ndarray
    masses: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
    pairs: np.ndarray
    at_wall: np.ndarray

    @property
    def clusters(self) -> np.ndarray:
        """Number of the cluster of each sphere: spheres that contacts connect, the wall not among them."""
        return _connected(len(self.radii), self.pairs)

    @property
    def held(self) -> np.ndarray:
        """Whether a chain of contacts leads from a sphere to the wall."""
        clusters = self.clusters
        return np.isin(clusters, clusters[self.at_wall])

    @property
    def coordination_numbers(self) -> np.ndarray:
        """Contacts of each sphere with other spheres."""
        return np.bincount(self.pairs.ravel(), minlength=len(self.radii))

    @property
    def kinetic_energy(self) -> float:
        """Of translation and spin of all spheres [J]."""
        squares = np.sum(self.velocities**2, axis=1) + 0.4 * self.radii**2 * np.sum(self.spins**2, axis=1)
        return 0.5 * float(self.masses @ squares)


def frames(scene: Application, variant: Variant, directory: Path) -> list[Frame]:
    """All frames of a run, in order of time; the first is the start.

    Raises
    ------
    DumpError
        Where a dump is missing or damaged.
    """
    law = laws.law(scene, variant)
    spheres = dump.read(directory / SPHERES_NAME)
    pairs = {}
    if scene.start != "single":
        contacts = dump.read(directory / CONTACTS_NAME)
        listed = contacts[["c_contacts[1]", "c_contacts[2]"]].to_numpy().astype(np.int64) - 1
        pairs = {step: listed[rows] for step, rows in contacts.groupby("step").indices.items()}
    none = np.empty((0, 2), dtype=np.int64)
    return [_frame(scene, law, step * variant.time_step, rows, pairs.get(step, none)) for step, rows in spheres.groupby("step", sort=True)]


def observables(scene: Application, variant: Variant, directory: Path) -> dict[str, float]:
    """What the scene is about, at the end of a run, as few numbers; units in `UNITS`.

    Parameters
    ----------
    scene, variant
        What was simulated.
    directory : Path
        Of the run.
    """
    every = frames(scene, variant, directory)
    return measure(scene, every[0], every[-1])


def evolution(scene: Application, variant: Variant, directory: Path) -> pd.DataFrame:
    """The same numbers at every frame, over `time` [s]."""
    every = frames(scene, variant, directory)
    return pd.DataFrame([{"time": frame.time, **measure(scene, every[0], frame)} for frame in every])


def measure(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    """The numbers of one frame, given the first."""
    values = _MEASURES[scene.start](scene, first, last)
    return {name: float(value) for name, value in values.items()}


def _pair(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    apart = last.positions[1] - last.positions[0]
    leaving = float((last.velocities[1] - last.velocities[0]) @ apart / np.linalg.norm(apart))
    stuck = len(last.pairs) > 0
    return {
        "e_eff": 0.0 if stuck else max(0.0, leaving / scene.motion.speed),
        "stuck": stuck,
        "separation_speed": leaving,
        "spin": np.linalg.norm(last.spins, axis=1).max(),
    }


def _single(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    stuck = bool(last.at_wall[0])
    approach = -first.velocities[0, 2]
    flight = (first.positions[0, 2] - first.radii[0]) / approach
    touched = first.positions[0, 0] + first.velocities[0, 0] * flight
    return {
        "e_eff": 0.0 if stuck else max(0.0, last.velocities[0, 2] / approach),
        "stuck": stuck,
        "tangential_speed": last.velocities[0, 0],
        "spin": last.spins[0, 1],
        # From where it first touched, by free flight.
        "distance_along_wall": last.positions[0, 0] - touched if last.time > flight else 0.0,
    }


def _agglomerate(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    sizes = np.bincount(last.clusters)
    return {
        "fragments": len(sizes),
        "largest_fragment_share": sizes.max() / scene.number,
        "single_share": np.count_nonzero(sizes == 1) / scene.number,
        # Without adhesion the spheres of an agglomerate do not hold on to each other from the start.
        "contacts_left_share": len(last.pairs) / max(1, len(first.pairs)),
        "share_on_wall": np.mean(last.held),
    }


def _cloud(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    sizes = np.bincount(last.clusters)
    return {
        "mean_cluster_size": scene.number / len(sizes),
        "weighted_cluster_size": np.sum(sizes**2) / scene.number,
        "largest_cluster_size": sizes.max(),
        "coordination_number": np.mean(last.coordination_numbers),
        "kinetic_energy_share": last.kinetic_energy / first.kinetic_energy,
    }


def _rain(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    height = 2 * float(np.average(last.positions[:, 2], weights=last.masses))
    low, high = (share * height for share in MIDDLE)
    z = last.positions[:, 2]
    middle = (z >= low) & (z < high)
    solid = np.sum(_volume_below(high - z, last.radii) - _volume_below(low - z, last.radii))
    weight = float(last.masses @ last.radii) * scene.motion.gravity
    return {
        "packing_fraction": solid / ((high - low) * scene.domain.size[0] * scene.domain.size[1]),
        "coordination_number": np.mean(last.coordination_numbers[middle]) if middle.any() else 0.0,
        "bed_height": height,
        "kinetic_energy_share": last.kinetic_energy / weight if weight else last.kinetic_energy / first.kinetic_energy,
    }


def _stream(scene: Application, first: Frame, last: Frame) -> dict[str, float]:
    held = last.held
    return {
        "captured_share": np.mean(held),
        "captured_mass_share": last.masses[held].sum() / last.masses.sum(),
        "mean_captured_radius": np.mean(last.radii[held]) if held.any() else 0.0,
        "shift_across": np.mean(last.positions[held, 0]) if held.any() else 0.0,
        "coordination_number": np.mean(last.coordination_numbers[held]) if held.any() else 0.0,
    }


_MEASURES = {"pair": _pair, "single": _single, "agglomerate": _agglomerate, "cloud": _cloud, "rain": _rain, "stream": _stream}


def _frame(scene: Application, law: Law, time: float, rows: pd.DataFrame, pairs: np.ndarray) -> Frame:
    radii = rows["radius"].to_numpy()
    densities = np.array([scene.material[scene.materials[kind - 1]].density or 0.0 for kind in rows["type"]])
    positions = rows[["x", "y", "z"]].to_numpy()
    gaps = np.full(len(radii), math.inf)
    if scene.wall and scene.wall.shape == "plane":
        gaps = positions[:, 2] - radii
    elif scene.wall:
        gaps = shapes.distance_to_tube(positions, scene.wall.radius, scene.wall.length, FACETS) - radii
    return Frame(
        time=time,
        radii=radii,
        masses=4 / 3 * math.pi * radii**3 * densities,
        positions=positions,
        velocities=rows[["vx", "vy", "vz"]].to_numpy(),
        spins=rows[["omegax", "omegay", "omegaz"]].to_numpy(),
        pairs=pairs,
        at_wall=gaps <= law.neck,
    )


def _connected(number: int, pairs: np.ndarray) -> np.ndarray:
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(number, number))
    return connected_components(graph, directed=False)[1]


def _volume_below(height: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Volume of the part of a sphere that lies below a plane `height` above its centre [m3]: a cap of height h."""
    h = np.clip(height + radii, 0.0, 2 * radii)
    return math.pi * h**2 * (3 * radii - h) / 3
