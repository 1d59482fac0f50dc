"""Skin and bins: the cheapest by their own cost, held by necks and motion; the bins that LIGGGHTS looks through, counted in space."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from pyjkr.errors import PlanError
from pyjkr.planning import neighbours
from pyjkr.planning.cost_model import SHIPPED
from pyjkr.planning.neighbours import BIN_SHARES, LEAST_SKIN_IN_RADII, MOST_SKIN_IN_RADII, SKIN_IN_NECKS, Surroundings

RADIUS = 2.5e-6
PLAIN = Surroundings(
    speed=0.7, time_step=3e-9, smallest_radius=RADIUS, mean_radius=1.2 * RADIUS, largest_radius=1.5 * RADIUS,
    number_density=0.3 / (4 / 3 * math.pi * RADIUS**3), neck=1e-8,
)  # fmt: skip
# No skin of the scan, 100 of them between the bounds, is cheaper than the one that is chosen.
SCAN = 100


def _least(s: Surroundings) -> float:
    return max(SKIN_IN_NECKS * s.neck, 2 * s.speed * s.time_step, LEAST_SKIN_IN_RADII * s.smallest_radius)


@given(
    speed=st.floats(-3, 2), density=st.floats(-4, -0.2), spread=st.floats(1, 5), neck=st.floats(-12, -6),
    room=st.one_of(st.none(), st.floats(0, 7)),
)  # fmt: skip
def test_no_other_skin_or_bin_is_cheaper(speed, density, spread, neck, room):
    volume = 0.0 if room is None else 150 * 10**room * RADIUS**3
    s = replace(
        PLAIN, speed=10**speed, mean_radius=spread**0.5 * RADIUS, largest_radius=spread * RADIUS, neck=10**neck,
        number_density=10**density / (4 / 3 * math.pi * RADIUS**3), particles=150, box_volume=volume,
    )  # fmt: skip
    least, most = _least(s), MOST_SKIN_IN_RADII * RADIUS
    if least > most:
        with pytest.raises(PlanError):
            neighbours.choose(s, SHIPPED)
        return
    chosen = neighbours.choose(s, SHIPPED)
    shares = BIN_SHARES if volume else BIN_SHARES[:1]
    scanned = min(
        neighbours.at(skin, s, SHIPPED, bin_share=share).step_time for skin in np.geomspace(least, most, SCAN) for share in shares
    )
    assert chosen.step_time <= scanned * (1 + 1e-12)
    assert least * (1 - 1e-12) <= chosen.skin <= most * (1 + 1e-12)


def test_each_bound_is_named_where_it_holds_the_skin():
    assert neighbours.choose(PLAIN, SHIPPED).limit == "wall time"
    necks = neighbours.choose(replace(PLAIN, neck=0.8 * RADIUS), SHIPPED)
    assert (necks.limit, necks.skin) == ("necks", pytest.approx(SKIN_IN_NECKS * 0.8 * RADIUS))
    # Walking through lists is so dear that lists are made in every step.
    dear = replace(SHIPPED, idle=1.0)
    assert neighbours.choose(PLAIN, dear).limit == "least skin"
    fast = neighbours.choose(replace(PLAIN, speed=100.0), dear)
    assert (fast.limit, fast.skin, fast.rebuild_rate) == ("motion in a step", pytest.approx(200 * PLAIN.time_step), 1.0)
    free = replace(SHIPPED, idle=0.0, rebuild_candidate=0.0)
    assert neighbours.choose(PLAIN, free).limit == "next spheres"


def test_spheres_at_rest_have_the_shortest_lists():
    chosen = neighbours.choose(replace(PLAIN, speed=0.0), SHIPPED)
    assert (chosen.skin, chosen.rebuild_rate) == (LEAST_SKIN_IN_RADII * RADIUS, 0.0)


def test_spheres_too_fast_for_any_list_are_refused_before_the_first_step():
    with pytest.raises(PlanError, match="motion in a step"):
        neighbours.choose(replace(PLAIN, speed=1e4), SHIPPED)


def test_an_empty_box_has_coarse_bins_and_a_full_one_those_of_liggghts():
    search = 2 * PLAIN.largest_radius
    volumes = (100 / PLAIN.number_density, 1e9 * search**3)
    sizes = [neighbours.choose(replace(PLAIN, particles=100, box_volume=volume), SHIPPED) for volume in volumes]
    full, empty = ((lists.bin_size / (search + lists.skin)) for lists in sizes)
    assert full <= 1
    assert empty >= 2


def test_lists_are_made_anew_after_half_a_skin():
    lists = neighbours.at(0.4 * RADIUS, PLAIN, SHIPPED)
    assert 1 / lists.rebuild_rate == pytest.approx(0.2 * RADIUS / (PLAIN.speed * PLAIN.time_step))


def test_idle_pairs_and_candidates_are_those_of_points_spread_at_random():
    rng = np.random.default_rng(3)
    count, box = 3000, 1.0
    points = rng.random((count, 3)) * box
    radius, skin = 0.03, 0.02
    s = replace(PLAIN, mean_radius=radius, largest_radius=radius, smallest_radius=radius, number_density=count / box**3)
    lists = neighbours.at(skin, s, SHIPPED)
    tree = cKDTree(points, boxsize=box)
    touching, listed = (len(tree.query_pairs(reach)) / count for reach in (2 * radius, 2 * radius + skin))
    # Some 6000 pairs: 5 % are four standard deviations.
    assert lists.idle == pytest.approx(listed - touching, rel=0.05)
    assert lists.candidates == pytest.approx(2 * listed, rel=0.05)


@pytest.mark.parametrize("share", [0.5, 1.0, 2.0, 0.3])
def test_bins_looked_through_are_those_with_a_corner_within_reach_of_one_of_the_middle_bin(share):
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    bins = sum(
        np.linalg.norm((corners[:, None] - corners[None]) + np.array(offset), axis=2).min() * share < 1
        for offset in itertools.product(range(-5, 6), repeat=3)
    )
    # Against 125 bins of half the search distance.
    assert neighbours.looked_through(share) == pytest.approx(bins * share**3 / (125 / 8))
