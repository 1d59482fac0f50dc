# Law: none; spheres, planes and the laws of their pairs, as values.
# Covers: Haervig et al. 2017 eq. 2 for every pair (a wall counts as a sphere of infinite radius and mass).
# Assumes: solid spheres unless inertia is given; plane walls in uniform motion.
"""What an assembly is made of."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, product

import numpy as np

from .loads import History, Options, PairLaw, Pairs, no_history, pairs


@dataclass(frozen=True)
class Wall:
    """A plane: any point of it [m], its normal towards the spheres, its velocity [m/s], and the type that names its
    laws."""

    point: Sequence[float]
    normal: Sequence[float]
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    type: int = 1


@dataclass(frozen=True)
class Assembly:
    """Spheres and walls at one instant.

    Parameters
    ----------
    position, velocity, spin : (N, 3), [m], [m/s], [rad/s].
    radius, mass : (N,), [m], [kg]. Moments of inertia are those of solid spheres.
    laws : PairLaw of every (type, type), either order; a single PairLaw serves for all.
    options : which laws take part.
    walls : planes.
    type : (N,), type of each sphere, default 1.
    external_force, external_torque : (N, 3), constant [N], [N m], default 0.
    inertia : (N,), [kg m2], default (2/5) m r^2.
    touching : rows of `pair_table` in contact, with their `overlap` [m] and `history`; empty at the start of a new
        assembly.
    time : [s].
    """

    position: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    laws: PairLaw | Mapping[tuple[int, int], PairLaw]
    options: Options = Options()
    walls: Sequence[Wall] = ()
    type: np.ndarray | None = None
    external_force: np.ndarray | None = None
    external_torque: np.ndarray | None = None
    inertia: np.ndarray | None = None
    touching: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    overlap: np.ndarray = field(default_factory=lambda: np.zeros(0))
    history: History = field(default_factory=lambda: no_history(0))
    time: float = 0.0


def pair_table(assembly: Assembly) -> Pairs:
    """Properties of all pairs of spheres, then of all spheres and walls."""
    count, walls = len(assembly.radius), len(assembly.walls)
    table = list(combinations(range(count), 2)) + list(product(range(count), range(count, count + walls)))
    types = list(np.ones(count, dtype=int) if assembly.type is None else assembly.type) + [
        wall.type for wall in assembly.walls
    ]
    i, j = np.array(table, dtype=int).reshape(-1, 2).T

    def law(a: int, b: int) -> PairLaw:
        if isinstance(assembly.laws, PairLaw):
            return assembly.laws
        return assembly.laws[(a, b)] if (a, b) in assembly.laws else assembly.laws[(b, a)]

    radius, mass, inertia = bodies(assembly)
    return pairs(i, j, radius, mass, inertia, [law(types[a], types[b]) for a, b in table], assembly.options)


def bodies(assembly: Assembly) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radius [m], mass [kg] and moment of inertia [kg m2] of the spheres, then of the walls (infinite)."""
    rigid = np.full(len(assembly.walls), np.inf)
    inertia = (
        0.4 * np.asarray(assembly.mass) * np.square(assembly.radius) if assembly.inertia is None else assembly.inertia
    )
    return tuple(np.concatenate([value, rigid]) for value in (assembly.radius, assembly.mass, inertia))
