"""Kernels of sliding, rolling and twisting: limits, resets, energy of closed cycles, kinematics of the contact point.

Rolling velocity is compared with its definition (contact point past the mean of both surfaces), not with the formula
of the papers.
"""

from __future__ import annotations

import math

import kernels
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

ROUND_OFF = 4e-15  # of the largest term: a dozen operations
ENERGY_ROUND_OFF = 1e-12  # of the sum of the absolute work: a few hundred additions
WALL_LIMIT = 3e-9  # a partner 1e9 times larger: the limit is reached as r_i/r_j, thrice


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


components = st.floats(-3.0, 3.0)
vectors = st.tuples(components, components, components).map(np.array)


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


normals = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(unit)


def across(vector: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return vector - np.dot(vector, normal) * normal


# ---- sliding ----


@pytest.mark.parametrize(
    ("elastic_force", "limit"), [(-3.1e-7, 0.7 * (2 * 5.3e-7 - 3.1e-7)), (8.9e-6, 0.7 * (8.9e-6 + 2 * 5.3e-7))]
)
def test_sliding_limit_is_friction_times_force_plus_twice_the_pull_off(elastic_force: float, limit: float) -> None:
    assert kernels.sliding_limit(elastic_force, 5.3e-7, 0.7) == pytest.approx(limit, rel=ROUND_OFF)


def test_sliding_limit_is_a_magnitude_where_the_original_pull_off_is_exceeded() -> None:
    # F_N below -2 F_C of the real surfaces: possible where stiffness and real surface energy are far apart
    assert kernels.sliding_limit(-8.3e-7, 2.9e-7, 0.6) == pytest.approx(0.6 * 2.5e-7, rel=ROUND_OFF)


@given(vectors, vectors, log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=150, deadline=None)
def test_force_never_exceeds_the_limit_nor_does_the_spring_and_below_it_nothing_is_cut(
    s, v, stiffness: float, damping: float, limit: float
) -> None:
    new, force = kernels.slide(s, v, stiffness, damping, limit)
    assert np.linalg.norm(force) <= limit * (1 + ROUND_OFF)
    assert stiffness * np.linalg.norm(new) <= limit * (1 + ROUND_OFF)
    if stiffness * np.linalg.norm(s) < limit * (1 - ROUND_OFF):
        assert np.array_equal(new, s)
    # what is left of the spring points where it did; the sum of spring and dashpot is cut along itself
    whole = -stiffness * new - damping * v
    terms = stiffness * np.linalg.norm(new) + damping * np.linalg.norm(v)
    assert np.linalg.norm(np.cross(new, s)) <= ROUND_OFF * np.linalg.norm(new) * np.linalg.norm(s)
    assert np.dot(new, s) >= 0.0 and np.dot(force, whole) >= 0.0
    if np.linalg.norm(whole) <= limit * (1 - ROUND_OFF):
        assert np.linalg.norm(force - whole) <= ROUND_OFF * terms
    else:
        assert np.linalg.norm(np.cross(force, whole)) <= ROUND_OFF * terms * np.linalg.norm(force)
        assert np.linalg.norm(force) >= limit * (1 - 2 * ROUND_OFF)


@given(vectors, log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=200, deadline=None)
def test_where_the_spring_slips_it_is_reset_to_carry_the_limit(s, stiffness: float, limit: float) -> None:
    new, force = kernels.slide(s, np.zeros(3), stiffness, 0.0, limit)
    assert np.linalg.norm(force + stiffness * new) <= ROUND_OFF * min(limit, stiffness * np.linalg.norm(s))
    again, same = kernels.slide(new, np.zeros(3), stiffness, 0.0, limit * (1 + ROUND_OFF))
    assert np.array_equal(again, new) and np.linalg.norm(same - force) <= ROUND_OFF * limit


@given(vectors, vectors, log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=100, deadline=None)
def test_opposite_motion_gives_exactly_the_opposite_force(s, v, stiffness: float, damping: float, limit: float) -> None:
    new, force = kernels.slide(s, v, stiffness, damping, limit)
    other, opposite = kernels.slide(-s, -v, stiffness, damping, limit)
    assert np.array_equal(other, -new) and np.array_equal(opposite, -force)


@pytest.mark.parametrize("stiffness", [0.0, 7.1])
def test_without_a_limit_no_force_is_carried(stiffness: float) -> None:
    _, force = kernels.slide([0.2, -0.3, 0.5], [0.7, 0.11, -0.13], stiffness, 0.9, 0.0)
    assert np.array_equal(force, np.zeros(3))


@given(log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=100, deadline=None)
def test_the_spring_left_by_slip_pulls_back_and_never_pushes_along(
    speed: float, stiffness: float, damping: float, limit: float
) -> None:
    # a contact that was unloaded and slips along +x: the spring that is left may only point back
    slip = np.array([speed, 0.0, 0.0])
    new, _ = kernels.slide(0.017 * slip, slip, stiffness, damping, limit)
    assert new[0] >= -ROUND_OFF * damping * speed / stiffness


def work_of_path(
    path: np.ndarray, stiffness: float, damping: float, limit: float, time_step: float
) -> tuple[float, float, np.ndarray]:
    """Work put into the contact along a path, its absolute sum, and the spring that is left."""
    spring, work, total = np.zeros(3), 0.0, 0.0
    for step in np.diff(path, axis=0):
        spring, force = kernels.slide(spring + step, step / time_step, stiffness, damping, limit)
        work -= np.dot(force, step)
        total += abs(np.dot(force, step))
    return work, total, spring


paths = st.lists(st.tuples(components, components, st.just(0.0)), min_size=3, max_size=30)


@given(paths, log_uniform(1e-2, 1e2), st.one_of(st.just(0.0), log_uniform(1e-3, 1e1)), log_uniform(1e-2, 1e3))
@settings(max_examples=150, deadline=None)
def test_work_along_any_path_covers_the_energy_left_in_the_spring_without_dashpot(
    path, stiffness: float, damping: float, limit: float
) -> None:
    work, total, spring = work_of_path(np.array(path), stiffness, 0.0, limit, 0.017)
    stored = 0.5 * stiffness * np.dot(spring, spring)
    assert work - stored >= -ENERGY_ROUND_OFF * (total + stored)


# A jerk to and fro with slow motion between: a spring that a fast jerk winds up backwards would push along on the
# slow way.
JERKS = [0.0, 0.05, *np.linspace(0.05, 1.65, 400)[1:], 1.6, *np.linspace(1.6, 0.0, 400)[1:]]


@given(paths, log_uniform(1e-2, 1e2), log_uniform(1e-3, 1e1), log_uniform(1e-2, 1e3))
@example([(x, 0.0, 0.0) for x in JERKS], 3.0, 7.0, 5.0)
@settings(max_examples=100, deadline=None)
def test_a_closed_cycle_of_sliding_with_dashpot_never_makes_energy(
    path, stiffness: float, damping: float, limit: float
) -> None:
    closed = np.array([*path, *path[1:], path[0]])
    work, total, _ = work_of_path(closed, stiffness, damping, limit, 0.017)
    assert work >= -ENERGY_ROUND_OFF * total


# ---- rolling ----


def rolling_velocity_by_definition(ri, rj, vi, vj, wi, wj, n) -> tuple[np.ndarray, np.ndarray]:
    """Velocity of the contact point past the mean of both surfaces, and the slip velocity u_i - u_j; n from i to j.

    The definition that Haervig 2017 eq. 20 abbreviates: the contact point moves with the line of centres, dividing it
    as the radii do; each surface moves with its sphere's centre and spin.
    """
    ui, uj = across(vi + np.cross(wi, ri * n), n), across(vj - np.cross(wj, rj * n), n)
    point = across(vi, n) + ri * across(vj - vi, n) / (ri + rj)
    return point - 0.5 * (ui + uj), ui - uj


def rolling_velocity_of_pair(ri, rj, vi, vj, wi, wj, n) -> np.ndarray:
    slip = across(vi - vj, n) + np.cross(ri * wi + rj * wj, n)
    return kernels.rolling_velocity(wi - wj, n, slip, ri * rj / (ri + rj), (rj - ri) / (rj + ri))


@given(log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), vectors, vectors, vectors, vectors, normals)
@settings(max_examples=150, deadline=None)
def test_rolling_velocity_is_that_of_the_contact_point_past_both_surfaces(ri, rj, vi, vj, wi, wj, n) -> None:
    exact, _ = rolling_velocity_by_definition(ri, rj, vi, vj, wi, wj, n)
    scale = sum(map(np.linalg.norm, (vi, vj))) + ri * np.linalg.norm(wi) + rj * np.linalg.norm(wj)
    assert np.linalg.norm(rolling_velocity_of_pair(ri, rj, vi, vj, wi, wj, n) - exact) <= 2 * ROUND_OFF * scale


@given(log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), vectors, vectors, vectors, vectors, normals)
@settings(max_examples=100, deadline=None)
def test_exchanged_partners_have_the_same_rolling_velocity(ri, rj, vi, vj, wi, wj, n) -> None:
    here, there = (
        rolling_velocity_of_pair(ri, rj, vi, vj, wi, wj, n),
        rolling_velocity_of_pair(rj, ri, vj, vi, wj, wi, -n),
    )
    scale = sum(map(np.linalg.norm, (vi, vj))) + ri * np.linalg.norm(wi) + rj * np.linalg.norm(wj)
    assert np.linalg.norm(here - there) <= ROUND_OFF * scale


@given(log_uniform(1e-3, 1e3), vectors, vectors, normals)
@settings(max_examples=100, deadline=None)
def test_wall_is_the_limit_of_a_huge_partner_at_rest(radius, velocity, spin, n) -> None:
    slip = across(velocity, n) + radius * np.cross(spin, n)
    wall = kernels.rolling_velocity(spin, n, slip, radius, 1.0)
    pair = rolling_velocity_of_pair(radius, 1e9 * radius, velocity, np.zeros(3), spin, np.zeros(3), n)
    assert np.linalg.norm(wall - pair) <= WALL_LIMIT * (np.linalg.norm(velocity) + radius * np.linalg.norm(spin))


def test_pure_rolling_on_a_wall_has_no_slip_and_the_rolling_velocity_r_omega() -> None:
    radius, spin, down = 0.37, np.array([0.0, 2.9, 0.0]), np.array([0.0, 0.0, -1.0])
    velocity = np.cross(spin, -radius * down)  # rolls along +x
    slip = across(velocity, down) + radius * np.cross(spin, down)
    assert np.linalg.norm(slip) <= ROUND_OFF
    rolling = kernels.rolling_velocity(spin, down, slip, radius, 1.0)
    assert rolling == pytest.approx([radius * 2.9, 0.0, 0.0], abs=ROUND_OFF)


def test_pure_sliding_on_a_wall_rolls_at_half_the_slip() -> None:
    down, slip = np.array([0.0, 0.0, -1.0]), np.array([0.7, -0.2, 0.0])
    assert kernels.rolling_velocity(np.zeros(3), down, slip, 0.37, 1.0) == pytest.approx(0.5 * slip, abs=ROUND_OFF)


@given(
    st.sampled_from([0.31, 0.9, 4.3]),
    vectors,
    normals,
    log_uniform(1e-3, 1e3),
    st.one_of(st.just(0.0), log_uniform(1e-3, 1e3)),
)
@settings(max_examples=100, deadline=None)
def test_rolling_moment_opposes_the_rolling_that_made_it(radius, spin, n, stiffness, damping) -> None:
    # spin in the contact plane, no slip: v_L = R n x spin; M . spin < 0
    spin = across(spin, n)
    if np.linalg.norm(spin) < 1e-3:
        return
    velocity = kernels.rolling_velocity(spin, n, np.zeros(3), radius, 0.2)
    time_step = 0.013
    _, moment = kernels.rolling(time_step * velocity, velocity, n, stiffness, damping, math.inf)
    power = np.dot(moment, spin)
    assert power < 0.0
    size = radius * np.linalg.norm(spin)
    assert np.linalg.norm(moment) == pytest.approx((stiffness * time_step + damping) * size, rel=10 * ROUND_OFF)
    assert abs(np.dot(moment, n)) <= ROUND_OFF * np.linalg.norm(moment)


@given(vectors, log_uniform(1e-3, 1e2))
@settings(max_examples=100, deadline=None)
def test_rolling_displacement_is_cut_to_its_limit_and_keeps_its_direction(displacement, critical: float) -> None:
    n = np.array([0.0, 0.0, 1.0])
    new, moment = kernels.rolling(displacement, np.zeros(3), n, 2.3, 0.0, critical)
    size = np.linalg.norm(displacement)
    assert np.linalg.norm(new) == pytest.approx(min(size, critical), rel=ROUND_OFF)
    assert np.linalg.norm(np.cross(new, displacement)) <= ROUND_OFF * size * critical
    assert np.linalg.norm(moment) <= 2.3 * critical * (1 + ROUND_OFF)


@given(paths, log_uniform(1e-2, 1e2), st.one_of(st.just(0.0), log_uniform(1e-3, 1e1)), log_uniform(1e-2, 1e1))
@settings(max_examples=200, deadline=None)
def test_a_closed_cycle_of_rolling_never_makes_energy(path, stiffness: float, damping: float, critical: float) -> None:
    n, time_step = np.array([0.0, 0.0, 1.0]), 0.017
    xi, work, total = np.zeros(3), 0.0, 0.0
    for step in np.diff(np.array([*path, *path[1:], path[0]]), axis=0):
        xi, moment = kernels.rolling(xi + step, step / time_step, n, stiffness, damping, critical)
        # v_L = R n x spin: the spin that rolls by `step` is (step x n)/R, with R = 1 in these units of moment
        done = -np.dot(moment, np.cross(step, n))
        work, total = work + done, total + abs(done)
    assert work >= -ENERGY_ROUND_OFF * total


# ---- twisting ----


@given(components, components, log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=200, deadline=None)
def test_twisting_moment_is_limited_opposes_and_resets_as_sliding_does(angle, spin, stiffness, damping, limit) -> None:
    new, moment = kernels.twist(angle, spin, stiffness, damping, limit)
    assert abs(moment) <= limit * (1 + ROUND_OFF)
    assert moment * (-stiffness * new - damping * spin) >= 0.0
    along, force = kernels.slide([angle, 0.0, 0.0], [spin, 0.0, 0.0], stiffness, damping, limit)
    assert new == pytest.approx(along[0], rel=ROUND_OFF)
    assert moment == pytest.approx(
        force[0], rel=ROUND_OFF, abs=ROUND_OFF * (stiffness * abs(angle) + damping * abs(spin))
    )
    assert kernels.twist(-angle, -spin, stiffness, damping, limit) == (-new, -moment)


@given(st.lists(components, min_size=3, max_size=30), log_uniform(1e-2, 1e2), log_uniform(1e-2, 1e3))
@settings(max_examples=200, deadline=None)
def test_a_closed_cycle_of_twisting_never_makes_energy(path, stiffness: float, limit: float) -> None:
    angle, work, total = 0.0, 0.0, 0.0
    for step in np.diff([*path, *path[1:], path[0]]):
        angle, moment = kernels.twist(angle + step, step / 0.017, stiffness, 0.0, limit)
        work, total = work - moment * step, total + abs(moment * step)
    assert work >= -ENERGY_ROUND_OFF * total


@given(
    st.lists(components, min_size=3, max_size=30),
    log_uniform(1e-2, 1e2),
    log_uniform(1e-3, 1e1),
    log_uniform(1e-2, 1e3),
)
@example(JERKS, 3.0, 7.0, 5.0)
@settings(max_examples=100, deadline=None)
def test_a_closed_cycle_of_twisting_with_dashpot_never_makes_energy(
    path, stiffness: float, damping: float, limit: float
) -> None:
    angle, work, total = 0.0, 0.0, 0.0
    for step in np.diff([*path, *path[1:], path[0]]):
        angle, moment = kernels.twist(angle + step, step / 0.017, stiffness, damping, limit)
        work, total = work - moment * step, total + abs(moment * step)
    assert work >= -ENERGY_ROUND_OFF * total
