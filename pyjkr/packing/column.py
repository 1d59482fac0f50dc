"""Where the spheres start: a sparse random column above the floor. Chen, Liu and Li 2019, sec. 4 (random inlet, fig. 8).

Positions are in radii and depend on count, cross-section, solid fraction and seed alone: all series rain alike.
"""

from __future__ import annotations

import math

import numpy as np

from pyjkr.errors import PlanError

# Distance of two centres, and height of the lowest one, at least [r].
CLEARANCE = 2.2
LOWEST = 3.0
# Places tried for one sphere; at the solid fractions allowed here a few are enough.
TRIES = 1000
DENSEST = 0.1


def column(particles: int, box: float, solid_fraction: float, seed: int) -> np.ndarray:
    """Random places without overlap in a column periodic in x and y, [0, box) x [0, box) x [LOWEST, ...).

    Parameters
    ----------
    particles : int
        How many.
    box : float
        Edge of the cross-section [r].
    solid_fraction : float
        Volume of the spheres over that of the column.
    seed : int
        Of numpy's default generator.

    Returns
    -------
    ndarray
        Centres [r], one row each, lowest first.

    Raises
    ------
    PlanError
        Where the column is too narrow or too dense for placing at random.
    """
    if box < 3 * CLEARANCE or not 0 < solid_fraction <= DENSEST:
        raise PlanError(
            f"packing: a column {box:g} r wide with solid fraction {solid_fraction:g} cannot be filled at random."
            f" Set box_in_radii >= {3 * CLEARANCE:g} and inlet_fraction in (0, {DENSEST:g}]."
        )
    height = particles * 4 / 3 * math.pi / (solid_fraction * box**2)
    random = np.random.default_rng(seed)
    places = np.empty((particles, 3))
    for count in range(particles):
        for _ in range(TRIES):
            place = random.uniform((0.0, 0.0, LOWEST), (box, box, LOWEST + height))
            apart = places[:count] - place
            apart[:, :2] -= box * np.round(apart[:, :2] / box)
            if not count or np.min(np.einsum("ij,ij->i", apart, apart)) > CLEARANCE**2:
                break
        else:
            raise PlanError(f"packing: no free place for sphere {count + 1} of {particles}. Lower inlet_fraction.")
        places[count] = place
    return places[np.argsort(places[:, 2])]
