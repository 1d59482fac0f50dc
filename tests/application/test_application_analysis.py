"""Numbers of frames whose answer is known: clusters, what hangs on the wall, packing of a lattice, slices of spheres."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from application_scenes import BREAK_UP, frame, scene_of

from pyjkr.application import analysis

APART = [[0.0, 0.0, 3.0 * index] for index in range(7)]


def test_clusters_are_chains_of_contacts_and_held_is_what_a_chain_leads_to_the_wall() -> None:
    # 0-1-2 touch the wall with 2; 3-4 do not; 5 alone does; 6 alone does not.
    seen = frame(APART, pairs=[(0, 1), (2, 1), (3, 4)], at_wall=[False, False, True, False, False, True, False])
    assert [sorted(np.flatnonzero(seen.clusters == cluster).tolist()) for cluster in sorted(set(seen.clusters))] == [
        [0, 1, 2], [3, 4], [5], [6]
    ]  # fmt: skip
    assert seen.held.tolist() == [True, True, True, False, False, True, False]
    assert seen.coordination_numbers.tolist() == [1, 2, 1, 1, 1, 0, 0]


def test_kinetic_energy_is_that_of_flight_and_of_spin() -> None:
    seen = frame([[0, 0, 0], [0, 0, 9]], radii=[1.0, 2.0], density=3.0, velocities=[[0, 3, 4], [0, 0, 0]], spins=[[0, 0, 0], [0, 0, 5]])
    masses = 4 * math.pi * np.array([1.0, 8.0])
    # m v^2/2 of the first, (2/5) m r^2 omega^2/2 of the second.
    assert seen.kinetic_energy == pytest.approx(masses[0] * 12.5 + 0.2 * masses[1] * 4 * 25, rel=1e-14)


def test_fragments_of_an_agglomerate() -> None:
    given = scene_of(BREAK_UP)
    count = given.number
    places = [[0, 0, 3.0 * index] for index in range(count)]
    whole = frame(places, pairs=[(index, index + 1) for index in range(count - 1)])
    # A chain cut behind the 90th, the 120th, and the 149th sphere; the piece of 30 hangs on the wall.
    cuts = (89, 119, 148)
    left = [pair for pair in whole.pairs.tolist() if pair[0] not in cuts]
    broken = frame(places, pairs=left, at_wall=np.arange(count) == 100)
    values = analysis.measure(given, whole, broken)
    assert values == pytest.approx(
        {"fragments": 4, "largest_fragment_share": 90 / 150, "single_share": 1 / 150, "contacts_left_share": 146 / 149,
         "share_on_wall": 30 / 150}, rel=1e-14,
    )  # fmt: skip
    assert analysis.measure(given, whole, whole)["fragments"] == 1


def test_clusters_of_a_cloud() -> None:
    given = scene_of("dust_coagulation")
    places = np.zeros((300, 3))
    first = frame(places, velocities=[2.0, 0.0, 0.0])
    # Clusters of 3 and of 2; 295 single spheres; half of the speed.
    last = frame(places, pairs=[(0, 1), (1, 2), (0, 2), (7, 8)], velocities=[1.0, 0.0, 0.0])
    assert analysis.measure(given, first, last) == pytest.approx(
        {"mean_cluster_size": 300 / 297, "weighted_cluster_size": (9 + 4 + 295) / 300, "largest_cluster_size": 3,
         "coordination_number": 8 / 300, "kinetic_energy_share": 0.25}, rel=1e-14,
    )  # fmt: skip


def test_packing_fraction_of_a_simple_cubic_lattice_is_pi_over_6() -> None:
    given = scene_of("packed_bed")
    r = 0.5e-3
    # Columns of 5 by 5 fill the 5 mm, 12 layers high: the middle slab cuts at whole layers.
    places = np.array(list(itertools.product(*(np.arange(n) * 2 * r + r for n in (5, 5, 12)))))
    neighbours = np.linalg.norm(places[:, None] - places[None], axis=2) < 2.001 * r
    pairs = np.argwhere(np.triu(neighbours, 1))
    seen = frame(places, radii=r, density=2500.0, pairs=pairs, velocities=[0.0, 0.0, 0.01])
    values = analysis.measure(given, seen, seen)
    assert values["bed_height"] == pytest.approx(24 * r, rel=1e-12)
    assert values["packing_fraction"] == pytest.approx(math.pi / 6, rel=1e-12)
    # Four in the plane less the open sides (a row of 5 has 8 ends in 25), two along the column.
    assert values["coordination_number"] == pytest.approx(2 * 2 * 4 / 5 + 2, rel=1e-12)
    # m v^2/2 over m g r.
    assert values["kinetic_energy_share"] == pytest.approx(0.5 * 0.01**2 / (9.81 * r), rel=1e-12)


def test_slices_of_a_sphere_add_up_and_halve_at_the_centre() -> None:
    r = np.array([1.5])
    whole = 4 / 3 * math.pi * 1.5**3
    assert analysis._volume_below(np.array([9.0]), r)[0] == pytest.approx(whole, rel=1e-14)
    assert analysis._volume_below(np.array([-9.0]), r)[0] == 0
    assert analysis._volume_below(np.array([0.0]), r)[0] == pytest.approx(whole / 2, rel=1e-14)
    # The slice between two planes is the integral of the discs' areas, by Simpson's rule exact for a parabola.
    low, high = -0.4, 1.1
    discs = [math.pi * (1.5**2 - z**2) for z in (low, (low + high) / 2, high)]
    slab = (high - low) / 6 * (discs[0] + 4 * discs[1] + discs[2])
    found = analysis._volume_below(np.array([high]), r) - analysis._volume_below(np.array([low]), r)
    assert found[0] == pytest.approx(slab, rel=1e-13)


def test_what_a_tube_caught() -> None:
    given = scene_of("ash_on_tube")
    places = np.zeros((300, 3))
    places[:, 0] = np.arange(300)
    radii = np.where(np.arange(300) < 150, 1.0, 2.0)
    first = frame(places, radii=radii)
    last = frame(places, radii=radii, pairs=[(10, 200), (30, 31)], at_wall=np.arange(300) == 10)
    assert analysis.measure(given, first, last) == pytest.approx(
        {"captured_share": 2 / 300, "captured_mass_share": 9 / (150 + 150 * 8), "mean_captured_radius": 1.5, "shift_across": 105.0,
         "coordination_number": 1.0}, rel=1e-14,
    )  # fmt: skip
    empty = analysis.measure(given, first, first)
    assert set(empty.values()) == {0.0}


def test_pair_rebounds_or_sticks() -> None:
    given = scene_of("head_on_pair")
    places = [[-2.6e-6, 0, 0], [2.6e-6, 0, 0]]
    first = frame(places, velocities=[[0.3, 0, 0], [-0.3, 0, 0]])
    away = frame(places, velocities=[[-0.12, 0, 0], [0.12, 0, 0]], spins=[[0, 0, 0], [0, 3, 4]])
    values = analysis.measure(given, first, away)
    assert values == pytest.approx({"e_eff": 0.24 / 0.6, "stuck": 0, "separation_speed": 0.24, "spin": 5.0}, rel=1e-12)
    held = frame(places, velocities=[[-0.12, 0, 0], [0.12, 0, 0]], pairs=[(0, 1)])
    assert analysis.measure(given, first, held)["e_eff"] == 0
    assert analysis.measure(given, first, held)["stuck"] == 1


def test_way_along_the_wall_counts_from_the_first_touch() -> None:
    given = scene_of("oblique_wall")
    r = 5e-6
    first = frame([[0, 0, r + 1e-6]], radii=r, velocities=[[0.5, 0, -0.25]])
    # The gap of 1 um closes after 4 us, 2 um along the wall.
    stuck = frame([[3.5e-6, 0, r]], radii=r, at_wall=True, time=9e-6, spins=[[0, 7.0, 0]])
    assert analysis.measure(given, first, stuck) == pytest.approx(
        {"e_eff": 0, "stuck": 1, "tangential_speed": 0, "spin": 7.0, "distance_along_wall": 1.5e-6}, rel=1e-12
    )
    away = frame([[3.5e-6, 0, 3 * r]], radii=r, time=9e-6, velocities=[[0.4, 0, 0.2]])
    assert analysis.measure(given, first, away)["e_eff"] == pytest.approx(0.8, rel=1e-12)
    assert analysis.measure(given, first, first)["distance_along_wall"] == 0


def test_every_number_has_a_unit() -> None:
    for name in ("head_on_pair", "oblique_wall", BREAK_UP, "dust_coagulation", "packed_bed", "ash_on_tube"):
        given = scene_of(name)
        seen = frame(np.arange(3 * given.number).reshape(-1, 3) * 1e-3 + 1e-3, velocities=[0.1, 0.0, -0.1], time=1.0)
        assert set(analysis.measure(given, seen, seen)) <= set(analysis.UNITS)
