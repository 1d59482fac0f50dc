"""Where the spheres of a scene start and how fast: all that is random comes from the seed of the scene.

Covers the six starts of `scene.Start`. Places and velocities do not depend on the plan, except that the spheres of an
agglomerate start at the equilibrium distance of the contact law.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from pyjkr.application import shapes
from pyjkr.application.laws import Body, Law
from pyjkr.application.scene import Application
from pyjkr.errors import PlanError

# Gap to the other sphere or to the wall at the start, in radii of the largest sphere.
GAP = 0.05
# Distance of centres over the sum of radii, at least, where spheres are put at random.
CLEARANCE = 1.05
# Places tried for one sphere: enough up to a solid fraction of 0.15.
TRIES = 2000
# Room between the tube and the block of a stream, and around everything, in radii of the largest sphere.
ROOM = 4.0
# A sphere that a heavy body hits leaves at twice its speed at most.
THROWN = 2.0


@dataclass(frozen=True)
class Spheres:
    """Spheres at the start, classes one after the other.

    Attributes
    ----------
    materials : tuple of str
        Of each sphere.
    radii, densities, masses : ndarray
        [m], [kg/m3], [kg].
    positions, velocities : ndarray
        [m], [m/s], one row each.
    """

    materials: tuple[str, ...]
    radii: np.ndarray
    densities: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray

    @property
    def masses(self) -> np.ndarray:
        """Of each sphere [kg]."""
        return 4 / 3 * math.pi * self.radii**3 * self.densities

    @property
    def size_classes(self) -> list[tuple[int, int, float]]:
        """First and last identifier, from 1, and radius [m] of each run of equal spheres."""
        classes, first = [], 1
        for radius, group in itertools.groupby(self.radii.tolist()):
            count = len(list(group))
            classes.append((first, first + count - 1, radius))
            first += count
        return classes


def spheres(scene: Application, law: Law | None = None) -> Spheres:
    """Spheres of a scene at the start.

    Parameters
    ----------
    scene : Application
        What starts.
    law : Law, optional
        Sets the distance of touching spheres in an agglomerate; without it they just touch.

    Raises
    ------
    PlanError
        Where spheres find no free place at random.
    """
    kinds = [(entry.material, radius, count) for entry in scene.particles for radius, count in entry.classes]
    materials = tuple(name for name, _, count in kinds for _ in range(count))
    radii = np.array([radius for _, radius, count in kinds for _ in range(count)])
    densities = np.array([scene.material[name].density for name in materials])
    random = np.random.default_rng(scene.run.seed)
    masses = densities * radii**3
    count, speed, largest = len(radii), scene.motion.speed, float(radii.max())
    velocities = np.zeros((count, 3))
    if scene.start == "pair":
        # Each moves in the frame of the centre of mass.
        positions = np.array([[-radii[0] - 0.5 * GAP * largest, 0.0, 0.0], [radii[1] + 0.5 * GAP * largest, 0.0, 0.0]])
        velocities[:, 0] = speed * masses[::-1] / masses.sum() * np.array([1.0, -1.0])
    elif scene.start in ("single", "agglomerate"):
        angle = math.radians(scene.motion.angle)
        velocities += speed * np.array([math.sin(angle), 0.0, -math.cos(angle)])
        positions = np.zeros((1, 3)) if scene.start == "single" else _agglomerate(scene, law, largest)
        positions[:, 2] += GAP * largest - (positions[:, 2] - radii).min()
    else:
        low, high = filled_block(scene, largest)
        positions = _at_random(radii, low, high, scene.periodic, random, scene.source)
        if scene.start == "cloud":
            velocities = random.normal(0.0, scene.motion.spread, (count, 3))
            velocities -= masses @ velocities / masses.sum()
        else:
            velocities[:, 2] = -speed
    return Spheres(materials, radii, densities, positions, velocities)


def filled_block(scene: Application, largest: float) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of the block that the spheres fill [m]: domain.size, set down where it belongs."""
    size = np.array(scene.domain.size)
    bottom = {"cloud": 0.0, "rain": 0.0}.get(scene.start)
    if bottom is None:
        low = np.array([-size[0] / 2, -size[1] / 2, scene.wall.radius + ROOM * largest])
        return low, low + size
    return np.zeros(3), size


def box(scene: Application, start: Spheres) -> tuple[tuple[float, float], ...]:
    """Bounds along x, y and z [m]: room for all that may fly away at the fastest speed; exact where periodic."""
    largest = float(start.radii.max())
    room = ROOM * largest
    low, high = start.positions.min(axis=0) - room, start.positions.max(axis=0) + room
    reach = _reach(scene, start, float(high[2]))
    if scene.start != "cloud":
        low, high = low - reach, high + reach
    if scene.wall and scene.wall.shape == "plane":
        low[2] = -room
    if scene.wall and scene.wall.shape == "tube":
        half = np.array([scene.wall.radius, 0.5 * scene.wall.length, scene.wall.radius])
        low, high = np.minimum(low, -half - room), np.maximum(high, half + room)
    for axis, periodic in enumerate(scene.periodic):
        if periodic:
            low[axis], high[axis] = 0.0, scene.domain.size[axis]
    rounded = [(a, b) if periodic else _outwards(a, b) for a, b, periodic in zip(low, high, scene.periodic, strict=True)]
    return tuple((float(a), float(b)) for a, b in rounded)


def _outwards(low: float, high: float) -> tuple[float, float]:
    """Bounds rounded outwards to three digits of their distance, for whoever reads the deck."""
    digits = 2 - math.floor(math.log10(high - low))
    # Scaled by whole powers of ten and read back from text: no noise of round-off in the deck.
    return float(f"{math.floor(low * 10.0**digits)}e{-digits}"), float(f"{math.ceil(high * 10.0**digits)}e{-digits}")


def _reach(scene: Application, start: Spheres, height: float) -> float:
    """How far a sphere may get from where all of them start [m]: in a straight line, or up to where gravity turns it back."""
    gravity, duration = scene.motion.gravity, scene.run.duration
    own = float(np.linalg.norm(start.velocities, axis=1).max())
    blown = float(np.linalg.norm(scene.gas.velocity)) if scene.gas else 0.0
    if scene.start != "rain":
        return THROWN * (max(own, blown) + gravity * duration) * duration
    # Spheres hit the floor that fell from the top, and are thrown up from there at the most.
    fallen = math.sqrt(own**2 + 2 * gravity * height)
    straight = THROWN * max(fallen, blown) * duration
    return straight if gravity == 0 or scene.gas else min(straight, (THROWN * fallen) ** 2 / (2 * gravity))


def _agglomerate(scene: Application, law: Law | None, radius: float) -> np.ndarray:
    sphere = Body(scene.particles[0].material, radius)
    overlap = law.equilibrium_overlap(sphere, sphere) if law and law.adhesive else 0.0
    # All contacts are as deep as one of two spheres at rest; the shape stays, whatever the stiffness.
    return shapes.agglomerate(scene.number, scene.run.seed) * (radius - 0.5 * overlap)


def _at_random(
    radii: np.ndarray, low: np.ndarray, high: np.ndarray, periodic: tuple[bool, ...], random: np.random.Generator, source: str
) -> np.ndarray:
    """Random places without overlap, the largest sphere first; whole spheres inside where the block is not periodic."""
    places = np.empty((len(radii), 3))
    set_down: list[int] = []
    lengths, wrapped = high - low, np.array(periodic, dtype=float)
    for index in np.argsort(-radii, kind="stable"):
        inset = np.where(periodic, 0.0, CLEARANCE * radii[index])
        if np.any(low + inset >= high - inset):
            raise PlanError(f"{source}: domain.size is smaller than a sphere. Make it larger.")
        for _ in range(TRIES):
            place = random.uniform(low + inset, high - inset)
            apart = places[set_down] - place
            apart -= wrapped * lengths * np.round(apart / lengths)
            near = CLEARANCE * (radii[set_down] + radii[index])
            if np.all(np.einsum("ij,ij->i", apart, apart) > near**2):
                break
        else:
            raise PlanError(f"{source}: no free place for all {len(radii)} spheres. Make domain.size larger or number smaller.")
        places[index] = place
        set_down.append(int(index))
    return places
