"""Rolling law of the oracle: kinematics, sign, stiffness, limits."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pyjkr.oracle import NormalContact, equilibrium_contact_radius, pull_off_force
from pyjkr.oracle.rolling import (
    critical_displacement_angle,
    critical_displacement_krijt,
    rolling_damping,
    rolling_moment,
    rolling_stiffness,
    rolling_velocity,
    truncated_displacement,
)

ROUND_OFF = 1e-12
UNIT = st.floats(-0.9, 0.9)
VECTOR = st.tuples(UNIT, UNIT, UNIT).map(np.array)


def direction(vector: np.ndarray) -> np.ndarray:
    vector = vector + np.array([0.0, 0.0, 1.7])
    return vector / np.linalg.norm(vector)


@given(VECTOR, VECTOR, VECTOR, VECTOR, VECTOR, st.floats(0.2, 0.9), st.floats(1.1, 4.0))
@settings(max_examples=50, deadline=None)
def test_rolling_velocity_is_that_of_the_contact_point_past_the_mean_of_both_surfaces(n, v_i, v_j, w_i, w_j, r_i, r_j):
    n = direction(n)
    surface_i, surface_j = v_i + np.cross(w_i, r_i * n), v_j - np.cross(w_j, r_j * n)
    point = (r_j * v_i + r_i * v_j) / (r_i + r_j)  # of the centre line, where the spheres touch

    def tangential(vector):
        return vector - n * (vector @ n)

    expected = tangential(point) - tangential(surface_i + surface_j) / 2
    slip = tangential(surface_i - surface_j)
    assert np.allclose(rolling_velocity(r_i, r_j, w_i, w_j, n, slip), expected, atol=ROUND_OFF)


@given(VECTOR, VECTOR, VECTOR, VECTOR)
@settings(deadline=None)
def test_a_wall_is_an_infinite_sphere(n, w, v, other):
    n = direction(n)
    slip = np.cross(n, v)
    wall = rolling_velocity(0.7, np.inf, w, np.zeros(3), n, slip)
    assert np.allclose(wall, -0.7 * np.cross(w, n) + 0.5 * slip, atol=ROUND_OFF)
    assert np.allclose(wall, rolling_velocity(0.7, 1e14, w, np.zeros(3), n, slip), atol=1e-11)


@given(VECTOR, VECTOR, VECTOR, VECTOR)
@settings(deadline=None)
def test_exchanging_the_spheres_keeps_the_rolling_displacement_and_turns_the_moment(n, w_i, w_j, slip):
    n = direction(n)
    slip = np.cross(n, slip)
    one = rolling_velocity(0.7, 1.9, w_i, w_j, n, slip)
    other = rolling_velocity(1.9, 0.7, w_j, w_i, -n, -slip)
    assert np.allclose(one, other, atol=ROUND_OFF)
    assert np.allclose(
        rolling_moment(3.0, 0.4, one, one, n), -rolling_moment(3.0, 0.4, other, other, -n), atol=ROUND_OFF
    )


@given(VECTOR, VECTOR, VECTOR)
@settings(deadline=None)
def test_the_moment_takes_from_rolling_what_the_spring_stores(n, w_i, w_j):
    n, k, r_i, r_j = direction(n), 3.1, 0.7, 1.9
    velocity = rolling_velocity(r_i, r_j, w_i, w_j, n, np.zeros(3))
    displacement = 0.3 * velocity
    power = rolling_moment(k, 0.0, displacement, velocity, n) @ (w_i - w_j)
    assert power == pytest.approx(-k / (r_i * r_j / (r_i + r_j)) * displacement @ velocity, abs=ROUND_OFF)


def test_a_sphere_rolling_forward_on_the_floor_is_held_back():
    floor, forward_spin = np.array([0.0, 0.0, -1.0]), np.array([0.0, 2.0, 0.0])  # moves along +x
    velocity = rolling_velocity(0.7, np.inf, forward_spin, np.zeros(3), floor, np.zeros(3))
    assert velocity == pytest.approx([1.4, 0.0, 0.0])
    assert rolling_moment(3.0, 0.0, velocity, velocity, floor) == pytest.approx([0.0, -4.2, 0.0])


def test_stiffness_limit_and_damping_take_the_stated_values():
    contact = NormalContact(0.83e-6, 3.8e9, 0.052)
    force, zero_load = pull_off_force(contact), equilibrium_contact_radius(contact)
    assert rolling_stiffness(force, 0.64) == pytest.approx(4 * force * 0.512, rel=1e-14)
    assert critical_displacement_krijt(zero_load, 0.3) == pytest.approx(zero_load / 40, rel=1e-14)
    assert critical_displacement_angle(0.83e-6, 0.0084) == pytest.approx(6.972e-9, rel=1e-14)
    # Krijt 2014: the largest moment at a = a_0 is pi R a_0 dgamma.
    largest = rolling_stiffness(force, 1.0) * critical_displacement_krijt(zero_load, 0.3)
    assert largest == pytest.approx(np.pi * 0.83e-6 * zero_load * 0.3 * 0.052, rel=1e-14)
    assert rolling_damping(0.2, 5.0, 7.0, 3.0) == pytest.approx(0.4 * (35 / 3) ** 0.5, rel=1e-14)


@given(st.lists(st.tuples(UNIT, UNIT), min_size=2, max_size=6))
@settings(max_examples=25, deadline=None)
def test_a_closed_rolling_cycle_never_makes_energy(corners):
    path, xi, work, critical = np.array([(0.0, 0.0), *corners, (0.0, 0.0)]), np.zeros(3), 0.0, 0.21
    for start, end in itertools.pairwise(path):
        step = np.append((end - start) / 50, 0.0)
        for _ in range(50):
            xi = truncated_displacement(xi + step, critical)
            work += xi @ step
    assert np.linalg.norm(xi) <= critical * (1 + ROUND_OFF)
    assert work >= 0.5 * xi @ xi - ROUND_OFF
