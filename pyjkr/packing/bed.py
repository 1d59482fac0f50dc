"""The bed at rest: what is measured in it. Chen, Liu and Li 2019, secs 4.1 to 4.3, eqs 15 and 16.

Covers packing fraction, coordination number, local packing fraction (Voronoi cells), overlaps and normal forces.
Assumes equal spheres; neighbours' overlaps are not taken off the solid volume, of which they are below 1e-3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pyjkr import dump
from pyjkr.errors import DumpError, PlanError
from pyjkr.packing.deck import CONTACT_KEYWORDS, CONTACTS_NAME, HISTORY, SPHERES_NAME
from pyjkr.packing.scene import PackingScene

# Part of the bed's height that is measured, away from the floor and from the ragged surface.
MIDDLE = (0.25, 0.75)


@dataclass(frozen=True)
class Bed:
    """Spheres at rest on the floor z = 0, in a column periodic in x and y.

    Attributes
    ----------
    positions : ndarray
        Centres [m], by identifier.
    radius, box : float
        Of all spheres, and edge of the column [m].
    pairs : ndarray
        Indices of the two spheres of each contact, necks among them.
    overlaps, normal_forces : ndarray
        Of each contact [m, N], positive in compression; a neck that reaches no overlap has a negative one.
    floor : ndarray
        Whether a sphere touches the floor.
    kinetic_energy : float
        Of the translation of all spheres [J].
    """

    positions: np.ndarray
    radius: float
    box: float
    pairs: np.ndarray
    overlaps: np.ndarray
    normal_forces: np.ndarray
    floor: np.ndarray
    kinetic_energy: float

    @property
    def settled(self) -> np.ndarray:
        """Whether a sphere belongs to the bed: a chain of contacts leads from it to the floor."""
        count = len(self.positions)
        ground = np.flatnonzero(self.floor)
        rows = np.concatenate([self.pairs[:, 0], ground])
        columns = np.concatenate([self.pairs[:, 1], np.full(len(ground), count)])
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(count + 1, count + 1))
        _, labels = connected_components(graph, directed=False)
        return labels[:count] == labels[count]

    @property
    def height(self) -> float:
        """Twice the mean height of the bed's spheres [m]: the height of an even bed, whatever single chains stick out."""
        return 2 * float(np.mean(self.positions[self.settled, 2]))

    @property
    def middle(self) -> np.ndarray:
        """Whether a sphere belongs to the middle of the bed."""
        low, high = (share * self.height for share in MIDDLE)
        z = self.positions[:, 2]
        return self.settled & (z >= low) & (z < high)

    @property
    def coordination_numbers(self) -> np.ndarray:
        """Contacts of each sphere with other spheres."""
        return np.bincount(self.pairs.ravel(), minlength=len(self.positions))

    @property
    def middle_contacts(self) -> np.ndarray:
        """Whether both spheres of a contact belong to the middle."""
        return self.middle[self.pairs].all(axis=1)

    @property
    def local_packing_fractions(self) -> np.ndarray:
        """Volume of each sphere over that of its Voronoi cell; Chen 2019, eq. 15. Not finite outside the bed."""
        fractions = np.full(len(self.positions), np.nan)
        settled = self.settled
        fractions[settled] = 4 / 3 * math.pi / voronoi_volumes(self.positions[settled] / self.radius, self.box / self.radius)
        return fractions

    @property
    def packing_fraction(self) -> float:
        """phi of the middle: volume of its spheres over that of their Voronoi cells."""
        return float(1 / np.mean(1 / self.local_packing_fractions[self.middle]))

    @property
    def slab_packing_fraction(self) -> float:
        """phi of the middle by other means: volume of all caps and slices of spheres between its two planes."""
        low, high = (share * self.height for share in MIDDLE)
        z = self.positions[self.settled, 2]
        solid = _volume_below(high - z, self.radius) - _volume_below(low - z, self.radius)
        return float(np.sum(solid)) / ((high - low) * self.box**2)


def voronoi_volumes(positions: np.ndarray, box: float) -> np.ndarray:
    """Volumes of the Voronoi cells of points above a floor z = 0, in a column periodic in x and y.

    Parameters
    ----------
    positions : ndarray
        Of the points, in radii: freud computes in single precision.
    box : float
        Edge of the column, in the same unit.

    Notes
    -----
    freud's boxes are periodic along z too. A mirror image below the floor makes the floor a face of the lowest cells, and
    the period of image and bed together one of the plane a radius above the highest point.
    """
    freud = require_freud()
    top = float(np.max(positions[:, 2])) + 1
    both = np.concatenate([positions, positions * (1, 1, -1)])
    system = freud.box.Box(box, box, 2 * top), both - (box / 2, box / 2, 0)
    cells = freud.locality.Voronoi()
    return np.asarray(cells.compute(system).volumes, dtype=float)[: len(positions)]


def require_freud() -> ModuleType:
    """The library freud, or a `PlanError` that says how to install it: to be called before anything is run."""
    try:
        import freud
    except ImportError:
        raise PlanError("packing: Voronoi cells need the library freud. Install it: pip install freud-analysis") from None
    return freud


def read_bed(scene: PackingScene, directory: Path) -> Bed:
    """The bed that a run of `simulate` left.

    Raises
    ------
    DumpError
        A dump that is missing or damaged, or that does not hold all spheres.
    """
    spheres = _last(dump.read(directory / SPHERES_NAME))
    if len(spheres) != scene.particles:
        raise DumpError(
            f"{directory / SPHERES_NAME}: {len(spheres)} spheres where {scene.particles} were packed."
            " Delete the directory and run again."
        )
    listed = dump.read_contacts(directory / CONTACTS_NAME, CONTACT_KEYWORDS, history_names=HISTORY)
    contacts = _last(listed[listed["in_contact"] > 0]) if len(listed) else listed
    positions = spheres[["x", "y", "z"]].to_numpy()
    pairs = contacts[["id1", "id2"]].to_numpy() - 1
    # A contact through a face of the box is listed from either side.
    ordered = np.sort(pairs, axis=1)
    _, first = np.unique(ordered, axis=0, return_index=True)
    pairs, contacts = pairs[first], contacts.iloc[first]
    normal = positions[pairs[:, 0]] - positions[pairs[:, 1]]
    normal[:, :2] -= scene.box * np.round(normal[:, :2] / scene.box)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    forces = contacts[["force_normal_x", "force_normal_y", "force_normal_z"]].to_numpy()
    speeds = spheres[["vx", "vy", "vz"]].to_numpy()
    return Bed(
        positions=positions,
        radius=scene.radius,
        box=scene.box,
        pairs=pairs,
        overlaps=contacts["overlap"].to_numpy(),
        normal_forces=np.einsum("ij,ij->i", forces, normal),
        floor=positions[:, 2] < scene.radius + scene.neck,
        kinetic_energy=0.5 * scene.mass * float(np.sum(speeds**2)),
    )


def _last(frame: pd.DataFrame) -> pd.DataFrame:
    return frame[frame["step"] == frame["step"].max()]


def _volume_below(height: np.ndarray, radius: float) -> np.ndarray:
    """Volume of a sphere below a plane at a height over its centre."""
    depth = np.clip(height + radius, 0.0, 2 * radius)
    return math.pi * depth**2 * (radius - depth / 3)
