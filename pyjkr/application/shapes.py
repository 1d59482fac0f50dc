"""Shapes made of a seed or of a size: the agglomerate, and the triangles of a tube.

The agglomerate is that of Bennett (1972), J. Appl. Phys. 43:2727: one sphere after the other into the pocket of three others that
lies nearest to the centre. Lengths in radii, spheres just touch: whoever uses it sets the distance of contact.
"""

from __future__ import annotations

import functools
import itertools
import math

import numpy as np
from scipy.spatial.transform import Rotation

# Distances below 2 by less than this are touching, not overlapping.
TOUCHING = 1e-9
# Pockets are taken in the order of their distance from the centre, roughened by this share: no two seeds build alike.
ROUGHNESS = 0.05


# A plan asks for the places several times.
@functools.lru_cache(maxsize=4)
def agglomerate(number: int, seed: int) -> np.ndarray:
    """Centres of touching spheres of radius 1, about their centre of mass, in a random orientation.

    Parameters
    ----------
    number : int
        How many spheres.
    seed : int
        Of numpy's default generator.
    """
    random = np.random.default_rng(seed)
    corners = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / math.sqrt(2)
    centres = corners[:1]
    pockets, ranks = np.empty((0, 3)), np.empty(0)
    while len(centres) < number:
        if len(centres) < len(corners):
            added = corners[len(centres)]
        else:
            chosen = int(np.argmin(ranks))
            added = pockets[chosen]
        centres = np.vstack([centres, added])
        free = _apart(pockets, added)
        new = _pockets_of_last(centres)
        pockets = np.vstack([pockets[free], new])
        ranks = np.concatenate([ranks[free], np.linalg.norm(new, axis=1) * (1 + ROUGHNESS * random.random(len(new)))])
    # Four normal numbers are a quaternion of any direction alike: a random orientation.
    turned = Rotation.from_quat(random.normal(size=4))
    places = turned.apply(centres - centres.mean(axis=0))
    places.flags.writeable = False
    return places


def _apart(points: np.ndarray, centre: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points - centre, axis=-1) > 2 - TOUCHING


def _pockets_of_last(centres: np.ndarray) -> np.ndarray:
    """Free places that touch the last sphere and two others."""
    last = centres[-1]
    others = centres[:-1]
    near = others[np.linalg.norm(others - last, axis=1) < 4]
    if len(near) < 2:
        return np.empty((0, 3))
    first, second = (near[list(index)] for index in zip(*itertools.combinations(range(len(near)), 2), strict=True))
    # The point at distance 2 from three centres: their circumcentre, and a height above and below its plane.
    u, v = first - last, second - last
    normal = np.cross(u, v)
    area = np.einsum("ij,ij->i", normal, normal)
    good = area > 1e-12
    u, v, normal, area = u[good], v[good], normal[good], area[good]
    squares = np.einsum("ij,ij->i", u, u)[:, None], np.einsum("ij,ij->i", v, v)[:, None]
    circumcentre = np.cross(squares[0] * v - squares[1] * u, normal) / (2 * area[:, None])
    height = 4 - np.einsum("ij,ij->i", circumcentre, circumcentre)
    reachable = height > 0
    rise = normal[reachable] * np.sqrt(height[reachable] / area[reachable])[:, None]
    foot = last + circumcentre[reachable]
    points = np.vstack([foot + rise, foot - rise])
    distances = np.linalg.norm(points[:, None] - centres[None], axis=2)
    return points[np.min(distances, axis=1, initial=math.inf) > 2 - TOUCHING]


def distance_to_tube(points: np.ndarray, radius: float, length: float, around: int) -> np.ndarray:
    """Distance of points outside to the facets of `tube` [m], which lie inside its circle; infinite beyond its ends.

    Parameters
    ----------
    points : ndarray
        [m], one row each.
    radius, length, around
        As for `tube`.
    """
    facet = 2 * math.pi / around
    # From the middle of the facet that a point stands over.
    aside = np.mod(np.arctan2(points[:, 0], points[:, 2]), facet) - 0.5 * facet
    distances = np.hypot(points[:, 0], points[:, 2]) * np.cos(aside) - radius * math.cos(0.5 * facet)
    return np.where(np.abs(points[:, 1]) <= 0.5 * length, distances, math.inf)


def tube(radius: float, length: float, around: int) -> str:
    """STL text of a tube along y around the origin, normals outwards; facets are about as long as wide.

    Parameters
    ----------
    radius, length : float
        Of the circle that the corners lie on, and along y [m].
    around : int
        Facets around the tube.
    """
    along = max(1, round(length / (2 * math.pi * radius / around)))
    angles = [2 * math.pi * index / around for index in range(around)]
    circle = [(radius * math.sin(angle), radius * math.cos(angle)) for angle in angles]
    heights = [length * (index / along - 0.5) for index in range(along + 1)]
    lines = ["solid tube"]
    for index, step in itertools.product(range(around), range(along)):
        (x0, z0), (x1, z1) = circle[index], circle[(index + 1) % around]
        low, high = heights[step], heights[step + 1]
        corners = ((x0, low, z0), (x1, low, z1), (x1, high, z1), (x0, high, z0))
        angle = (index + 0.5) * 2 * math.pi / around
        for triangle in ((0, 1, 2), (0, 2, 3)):
            lines += [f"  facet normal {math.sin(angle)!r} 0.0 {math.cos(angle)!r}", "    outer loop"]
            lines += [f"      vertex {corners[i][0]!r} {corners[i][1]!r} {corners[i][2]!r}" for i in triangle]
            lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, "endsolid tube", ""])
