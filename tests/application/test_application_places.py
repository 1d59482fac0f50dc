"""Where spheres start: apart or touching as they should, all inside the domain, the same for the same seed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from application_scenes import BREAK_UP, NAMES, changed, scene_of, variant, with_values
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pyjkr.application import laws, places, scene, shapes
from pyjkr.application.deck import FACETS
from pyjkr.application.laws import Body
from pyjkr.errors import PlanError

# Touching spheres of an agglomerate: round-off of some hundred additions.
ROUND_OFF = 1e-9


def distances(start: places.Spheres, lengths: np.ndarray) -> np.ndarray:
    """Of all centres, over the sum of radii, the nearest image along periodic axes; infinite on the diagonal."""
    apart = start.positions[:, None] - start.positions[None]
    apart -= np.where(np.isfinite(lengths), lengths, 0.0) * np.round(apart / lengths)
    over = np.linalg.norm(apart, axis=2) / (start.radii[:, None] + start.radii[None])
    np.fill_diagonal(over, math.inf)
    return over


@pytest.mark.parametrize("name", NAMES)
def test_spheres_do_not_overlap_and_lie_within_the_box(name: str) -> None:
    given = scene_of(name)
    start = places.spheres(given)
    size = np.array(given.domain.size) if given.domain else np.full(3, math.inf)
    lengths = np.where(given.periodic, size, math.inf)
    least = 1 - ROUND_OFF if given.start == "agglomerate" else places.CLEARANCE if given.domain else 1.0
    assert distances(start, lengths).min() >= least
    for axis, (low, high) in enumerate(places.box(given, start)):
        margin = 0.0 if given.periodic[axis] else 1.0
        assert (start.positions[:, axis] - margin * start.radii).min() >= low
        assert (start.positions[:, axis] + margin * start.radii).max() <= high
    if given.wall and given.wall.shape == "plane":
        assert (start.positions[:, 2] - start.radii).min() > 0
    if given.wall and given.wall.shape == "tube":
        assert (np.hypot(start.positions[:, 0], start.positions[:, 2]) - start.radii).min() > given.wall.radius


def test_pair_of_unequal_spheres_has_no_momentum_and_meets_at_its_speed(tmp_path: Path) -> None:
    second = 'start = "pair"\n[[particles]]\nname = "large"\nmaterial = "polystyrene"\nnumber = 1\nradius = 4.5e-6\nstart = "pair"'
    given = scene.load(changed(tmp_path, "head_on_pair", ("number = 2", "number = 1"), ('start = "pair"', second)))
    start = places.spheres(given)
    assert start.radii.tolist() == [2.5e-6, 4.5e-6]
    assert np.abs(start.masses @ start.velocities).max() < 1e-12 * start.masses[0] * given.motion.speed
    assert start.velocities[0, 0] - start.velocities[1, 0] == pytest.approx(given.motion.speed, rel=1e-12)
    # The heavy one is the slow one: (4.5/2.5)^3 times.
    assert start.velocities[0, 0] / -start.velocities[1, 0] == pytest.approx(1.8**3, rel=1e-12)
    gap = start.positions[1, 0] - start.positions[0, 0] - start.radii.sum()
    assert gap == pytest.approx(places.GAP * 4.5e-6, rel=1e-6)


def test_cloud_has_no_momentum_and_the_spread_that_was_asked_for() -> None:
    given = scene_of("dust_coagulation")
    start = places.spheres(given)
    assert np.abs(start.masses @ start.velocities).max() < 1e-12 * start.masses.sum() * given.motion.spread
    # Standard error of a standard deviation out of 900 numbers: 1/sqrt(1800) = 2.4 %; four of them.
    assert start.velocities.std() == pytest.approx(given.motion.spread, rel=0.094)


def test_agglomerate_hangs_together_and_every_sphere_touches_three() -> None:
    centres = shapes.agglomerate(150, 3)
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    np.fill_diagonal(apart, math.inf)
    assert apart.min() >= 2 - ROUND_OFF
    touching = apart < 2 + ROUND_OFF
    assert touching.sum(axis=1).min() >= 3
    assert connected_components(coo_array(touching), directed=False)[0] == 1
    assert np.abs(centres.mean(axis=0)).max() < 1e-12


def test_spheres_of_an_agglomerate_start_as_deep_as_they_rest_in_the_law_of_the_deck() -> None:
    given = scene_of(BREAK_UP)
    law = laws.law(given, variant(given, modulus_ratio=0.02))
    sphere = Body("polystyrene", given.radii[1])
    pair = law.properties(sphere, sphere)
    # Closed form of Haervig 2017, eq. A.9 with eq. 7: a_0^3 = 9 pi gamma R^2/E, delta_0 = a_0^2/(3 R).
    radius = given.radii[1] / 2
    polystyrene = given.material["polystyrene"]
    energy = given.contact[0].surface_energy * 0.02**0.4
    modulus = 0.02 * polystyrene.youngs_modulus / (2 * (1 - polystyrene.poissons_ratio**2))
    rest = (9 * math.pi * energy * radius**2 / modulus) ** (2 / 3) / (3 * radius)
    assert law.equilibrium_overlap(sphere, sphere) == pytest.approx(rest, rel=1e-12)
    start = places.spheres(given, law)
    overlap = 2 * given.radii[1] * (1 - distances(start, np.full(3, math.inf)).min())
    assert overlap == pytest.approx(rest, rel=1e-6)
    assert pair.surface_energy == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("name", [BREAK_UP, "dust_coagulation", "packed_bed", "ash_on_tube"])
def test_seed_decides_all_that_is_random(name: str, tmp_path: Path) -> None:
    given = scene_of(name)
    first, again = places.spheres(given), places.spheres(given)
    assert first.positions.tolist() == again.positions.tolist()
    assert first.velocities.tolist() == again.velocities.tolist()
    other = scene.load(with_values(tmp_path, name, seed=99))
    assert np.abs(places.spheres(other).positions - first.positions).max() > given.radii[0]


def test_block_that_is_too_small_is_refused(tmp_path: Path) -> None:
    crowded = scene.load(with_values(tmp_path, "dust_coagulation", number=300, radius=0.5e-6, size="[6e-6, 6e-6, 6e-6]"))
    with pytest.raises(PlanError, match=r"no free place for all 300 spheres\. Make domain\.size larger or number smaller"):
        places.spheres(crowded)
    thin = scene.load(with_values(tmp_path, "packed_bed", radius=0.5e-3, size="[5e-3, 5e-3, 9e-4]"))
    with pytest.raises(PlanError, match=r"domain\.size is smaller than a sphere"):
        places.spheres(thin)


def test_box_has_room_for_what_gravity_and_gas_do(tmp_path: Path) -> None:
    slow = scene.load(with_values(tmp_path, "ash_on_tube", speed=0.01, duration=0.5, velocity="[0.2, 0.0, -0.3]"))
    start = places.spheres(slow)
    low, _ = places.box(slow, start)[2]
    # Free fall, and the way that the gas blows.
    assert low < start.positions[:, 2].min() - 0.5 * 9.81 * 0.5**2
    assert places.box(slow, start)[0][1] > start.positions[:, 0].max() + 0.2 * 0.5
    bed = scene_of("packed_bed")
    # A sphere that leaves the floor at twice the speed of what fell from the top rises to four times the height.
    assert places.box(bed, places.spheres(bed))[2][1] > 4 * bed.domain.size[2]


def test_bounds_are_short_numbers() -> None:
    given = scene_of("head_on_pair")
    for bounds in places.box(given, places.spheres(given)):
        assert all(float(f"{bound:.3g}") == bound for bound in bounds)


def test_tube_is_closed_and_its_distance_is_that_of_its_facets() -> None:
    radius, length = 3.0, 5.0
    vertices = np.array([line.split()[1:] for line in shapes.tube(radius, length, FACETS).splitlines() if "vertex" in line], dtype=float)
    triangles = vertices.reshape(-1, 3, 3)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    # Area of a prism of 72 faces; normals outwards.
    assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(FACETS * length * 2 * radius * math.sin(math.pi / FACETS), rel=1e-9)
    assert np.all(np.einsum("ij,ij->i", normals[:, [0, 2]], triangles.mean(axis=1)[:, [0, 2]]) > 0)
    random = np.random.default_rng(8)
    angles, heights = random.uniform(0, 2 * math.pi, 40), random.uniform(-2.4, 2.4, 40)
    points = np.column_stack([4 * np.sin(angles), heights, 4 * np.cos(angles)])
    units = normals / np.linalg.norm(normals, axis=1)[:, None]
    # A convex body: the distance is that to the plane farthest behind the point.
    wanted = np.max(np.einsum("pij,ij->pi", points[:, None] - triangles[None, :, 0], units), axis=1)
    assert shapes.distance_to_tube(points, radius, length, FACETS) == pytest.approx(wanted, abs=1e-12)
    beyond = np.array([[0.0, 2.6, 4.0]])
    assert math.isinf(shapes.distance_to_tube(beyond, radius, length, FACETS)[0])
