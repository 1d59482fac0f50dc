"""Kernel that turns stored displacements with their contact, against exact rotation matrices.

Reference: Rodrigues' formula; first the smallest rotation that takes the old normal to the new, then the spin about
the new normal.
"""

from __future__ import annotations

import math

import kernels
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

ROUND_OFF = 2e-15  # of the length: a dozen operations
FOURTH_ORDER = 0.15  # of angle^4: 1/8 from the series of cos(phi) + sin^2(phi)/2, and the next term
THIRD_ORDER = 0.09  # of spin^3: 1/12 of Cayley's rotation, 2 atan(x/2) = x - x^3/12
SLOPE = 0.05  # of a fitted order on log axes, angles from 0.4 to 0.0125

directions = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 3)
    .filter(lambda v: np.linalg.norm(v) > 0.1)
    .map(lambda v: np.array(v) / np.linalg.norm(v))
)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k


def across(vector: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return vector - np.dot(vector, normal) * normal


class Case:
    """A contact whose normal turned by `tilt` about an axis in its plane and whose partners spun by `spin`."""

    def __init__(self, seed: int, tilt: float, spin: float):
        draw = np.random.default_rng(seed)
        old = draw.normal(size=3)
        self.old = old / np.linalg.norm(old)
        axis = across(draw.normal(size=3), self.old)
        turn = rotation(axis, tilt)
        self.normal = turn @ self.old
        self.change = across(self.normal - self.old, self.normal)
        self.stored = 3.7e-9 * across(draw.normal(size=3), self.old)
        self.length = np.linalg.norm(self.stored)
        self.spin = spin
        self.exact = rotation(self.normal, spin) @ turn @ self.stored

    def turned(self) -> np.ndarray:
        return kernels.turned(self.stored, self.normal, self.change, self.spin)


@pytest.mark.parametrize("seed", range(5))
def test_tilt_of_the_normal_is_followed_to_fourth_order(seed: int) -> None:
    angles = 0.4 / 2.0 ** np.arange(5)
    errors = [np.linalg.norm((case := Case(seed, angle, 0.0)).turned() - case.exact) / case.length for angle in angles]
    assert all(error <= FOURTH_ORDER * angle**4 for error, angle in zip(errors, angles, strict=True))
    assert np.polyfit(np.log(angles), np.log(errors), 1)[0] == pytest.approx(4.0, abs=SLOPE)


@pytest.mark.parametrize("seed", range(5))
def test_spin_about_the_normal_is_followed_to_third_order(seed: int) -> None:
    angles = 0.4 / 2.0 ** np.arange(5)
    errors = [np.linalg.norm((case := Case(seed, 0.0, angle)).turned() - case.exact) / case.length for angle in angles]
    assert all(error <= THIRD_ORDER * angle**3 for error, angle in zip(errors, angles, strict=True))
    assert np.polyfit(np.log(angles), np.log(errors), 1)[0] == pytest.approx(3.0, abs=SLOPE)


@given(st.integers(0, 10**6), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5))
@settings(max_examples=200, deadline=None)
def test_turned_vector_lies_in_the_new_contact_plane_and_keeps_its_length(seed: int, tilt: float, spin: float) -> None:
    case = Case(seed, tilt, spin)
    got = case.turned()
    assert abs(np.dot(got, case.normal)) <= ROUND_OFF * case.length
    assert abs(np.linalg.norm(got) / case.length - 1.0) <= FOURTH_ORDER * tilt**4 + ROUND_OFF


@given(st.integers(0, 10**6), st.floats(-math.pi, math.pi))
@settings(max_examples=200, deadline=None)
def test_spin_alone_keeps_the_length_to_round_off_however_far_it_turns(seed: int, spin: float) -> None:
    case = Case(seed, 0.0, spin)
    assert abs(np.linalg.norm(case.turned()) / case.length - 1.0) <= ROUND_OFF


@given(st.integers(0, 10**6), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5), directions, st.floats(-math.pi, math.pi))
@settings(max_examples=200, deadline=None)
def test_turning_the_frame_turns_the_result(
    seed: int, tilt: float, spin: float, axis: np.ndarray, angle: float
) -> None:
    case, frame = Case(seed, tilt, spin), rotation(axis, angle)
    there = kernels.turned(frame @ case.stored, frame @ case.normal, frame @ case.change, spin)
    assert np.linalg.norm(there - frame @ case.turned()) <= 2 * ROUND_OFF * case.length


@given(st.integers(0, 10**6), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5))
@settings(max_examples=100, deadline=None)
def test_a_mirror_turns_the_spin_round(seed: int, tilt: float, spin: float) -> None:
    case, mirror = Case(seed, tilt, spin), np.diag([1.0, 1.0, -1.0])
    there = kernels.turned(mirror @ case.stored, mirror @ case.normal, mirror @ case.change, -spin)
    assert np.array_equal(there, mirror @ case.turned())


@given(st.integers(0, 10**6), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5))
@settings(max_examples=100, deadline=None)
def test_exchanged_partners_see_the_opposite_displacement_turn_alike(seed: int, tilt: float, spin: float) -> None:
    case = Case(seed, tilt, spin)
    # normal and displacement change sign, the spin about the fixed direction stays: about the other normal it is -spin
    there = kernels.turned(-case.stored, -case.normal, -case.change, -spin)
    assert np.array_equal(there, -case.turned())


@pytest.mark.parametrize("tilt", [0.003, 0.02, 0.7])
def test_where_the_change_of_normal_is_not_known_the_vector_is_projected_at_its_length(tilt: float) -> None:
    case = Case(11, tilt, 0.0)
    got = kernels.turned(case.stored, case.normal, np.zeros(3), 0.0)
    assert abs(np.dot(got, case.normal)) <= ROUND_OFF * case.length
    assert np.linalg.norm(got) == pytest.approx(case.length, rel=ROUND_OFF)
    assert np.linalg.norm(np.cross(got, across(case.stored, case.normal))) <= ROUND_OFF * case.length**2


def test_a_whole_turn_in_small_steps_comes_back() -> None:
    # rolled round a circle in 1000 steps: the exact map is the identity, the error 1000 times that of a step, (2
    # pi/1000)^4/8
    steps = 1000
    step = rotation(np.array([0.0, 0.0, 1.0]), 2.0 * math.pi / steps)
    normal, stored = np.array([0.6, 0.8, 0.0]), np.array([0.0, 0.0, 2.3]) + np.array([-0.8, 0.6, 0.0])
    start = stored
    for _ in range(steps):
        new = step @ normal
        stored = kernels.turned(stored, new, across(new - normal, new), 0.0)
        normal = new
    assert np.linalg.norm(stored - start) <= 1.1 * steps * (2 * math.pi / steps) ** 4 / 8 + steps * ROUND_OFF
