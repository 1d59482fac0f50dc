"""Sliding law of the oracle: stiffness, limit, reset, energy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pyjkr.oracle import NormalContact, contact_radius, effective_shear_modulus, elastic_force, equilibrium_overlap, pull_off_force
from pyjkr.oracle.tangential import (
    resistance,
    returned_displacement,
    sliding,
    sliding_limit,
    slip_direction,
    slip_rate,
    slip_velocity,
    tangential_damping,
    tangential_stiffness,
)

ROUND_OFF = 1e-13
RADIUS, MODULUS, SHEAR, ENERGY, MASS, FRICTION = 0.83e-6, 3.8e9, 1.1e9, 0.052, 2.3e-15, 0.37
OVERLAP = 2.7e-9


def contact_of(model: str, restitution: float = 0.7) -> NormalContact:
    return NormalContact(RADIUS, MODULUS, ENERGY, model, restitution)


def slider_of(model: str, overlap: float = OVERLAP, damping: bool = True):
    contact = contact_of(model)
    return sliding(contact, SHEAR, FRICTION, pull_off_force(contact), MASS, overlap, damping)


def test_shear_modulus_of_like_bodies():
    assert effective_shear_modulus(3e9, 0.3, 3e9, 0.3) == pytest.approx(3e9 / (4 * 1.3 * 1.7), rel=1e-15)


def test_stiffness_follows_the_hertz_radius_or_the_contact_radius():
    assert tangential_stiffness(contact_of("jkr/simplified"), SHEAR, OVERLAP) == pytest.approx(8 * SHEAR * (RADIUS * OVERLAP) ** 0.5, rel=ROUND_OFF)
    assert tangential_stiffness(contact_of("jkr"), SHEAR, OVERLAP) == pytest.approx(8 * SHEAR * contact_radius(contact_of("jkr"), OVERLAP), rel=ROUND_OFF)


def test_dashpot_uses_the_square_root_of_five_sixths():
    beta = -np.log(0.7) / np.hypot(np.log(0.7), np.pi)
    assert tangential_damping(contact_of("jkr"), 13.0, MASS) == pytest.approx(2 * (5 / 6) ** 0.5 * beta * (13.0 * MASS) ** 0.5, rel=ROUND_OFF)


def test_adhesion_lets_an_unloaded_contact_carry_twice_the_pull_off_force():
    contact = contact_of("jkr")
    limit = sliding_limit(contact, FRICTION, pull_off_force(contact), equilibrium_overlap(contact))
    assert limit == pytest.approx(2 * FRICTION * pull_off_force(contact), rel=ROUND_OFF)


def test_sliding_limit_takes_the_original_pull_off_force_and_the_reduced_normal_force():
    reduced = NormalContact(RADIUS, 0.01 * MODULUS, ENERGY * 0.01**0.4)
    original = 3 * np.pi * RADIUS * ENERGY
    expected = FRICTION * abs(elastic_force(reduced, OVERLAP) + 2 * original)
    assert sliding_limit(reduced, FRICTION, original, OVERLAP) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_slopes_are_derivatives(model):
    slider, step = slider_of(model), 1e-4 * OVERLAP
    above, below = slider_of(model, OVERLAP + step), slider_of(model, OVERLAP - step)
    for name in ("stiffness", "dashpot", "limit"):
        difference = (getattr(above, name) - getattr(below, name)) / (2 * step)
        assert getattr(slider, f"{name}_slope") == pytest.approx(difference, rel=1e-7)  # central difference of step 1e-4


def test_total_force_is_held_at_the_limit_along_the_trial_force_and_the_spring_is_reset():
    slider = slider_of("jkr/simplified")
    displacement, velocity = np.array([3e-9, -5e-9, 0.0]), np.array([0.4, 0.9, 0.0])
    trial = slider.stiffness * displacement + slider.dashpot * velocity
    assert np.linalg.norm(trial) > slider.limit
    held = resistance(slider, displacement, velocity)
    assert np.linalg.norm(held) == pytest.approx(slider.limit, rel=ROUND_OFF)
    assert held == pytest.approx(slider.limit * trial / np.linalg.norm(trial), rel=ROUND_OFF)
    reset = returned_displacement(slider, displacement, velocity)
    assert slider.stiffness * reset + slider.dashpot * velocity == pytest.approx(held, rel=1e-12, abs=1e-12 * slider.limit)


def test_a_load_within_the_limit_is_left_alone():
    slider = slider_of("jkr")
    displacement, velocity = np.array([1e-11, -2e-11, 0.0]), np.array([1e-3, 2e-3, 0.0])
    assert np.array_equal(returned_displacement(slider, displacement, velocity), displacement)


def test_slip_rate_keeps_the_load_at_the_limit():
    overlap_rate, velocity, acceleration = 0.7, np.array([0.4, -0.3, 0.0]), np.array([2e8, 5e8, 0.0])
    slider = slider_of("jkr")
    displacement = returned_displacement(slider, np.array([2e-8, 1e-8, 0.0]), velocity)
    rate = slip_rate(slider, displacement, velocity, acceleration, overlap_rate)
    step = 1e-16
    moved = displacement + step * (velocity - rate * slip_direction(slider, displacement, velocity))
    after = slider_of("jkr", OVERLAP + step * overlap_rate)
    load = np.linalg.norm(after.stiffness * moved + after.dashpot * (velocity + step * acceleration))
    growth, scale = load - after.limit, step * slider.stiffness * np.linalg.norm(velocity)
    assert abs(growth) < 1e-3 * scale  # second order in the step, and round-off of the limit


@given(st.lists(st.tuples(st.floats(-3e-8, 3e-8), st.floats(-3e-8, 3e-8)), min_size=2, max_size=6), st.sampled_from(["jkr/simplified", "jkr"]))
@settings(max_examples=25, deadline=None)
def test_a_closed_slip_cycle_never_makes_energy(corners, model):
    slider = slider_of(model, damping=False)
    path = np.array([(0.0, 0.0), *corners, (0.0, 0.0)])
    displacement, work = np.zeros(3), 0.0
    for start, end in zip(path[:-1], path[1:]):
        step = np.append((end - start) / 40, 0.0)
        for _ in range(40):
            displacement = returned_displacement(slider, displacement + step, np.zeros(3))
            work += resistance(slider, displacement, np.zeros(3), False) @ step  # end-point rule: exact dissipation plus (k/2) step^2
    steps = 0.5 * slider.stiffness * np.sum(np.sum(np.diff(path, axis=0) ** 2, axis=1)) / 40
    stored = 0.5 * slider.stiffness * displacement @ displacement
    assert work >= stored - 1e-12 * (steps + slider.limit * 1e-8)
    assert stored <= 0.5 * slider.limit**2 / slider.stiffness * (1 + ROUND_OFF)


def test_slip_velocity_of_rigid_motion_vanishes():
    spin, normal, arm_i, arm_j = np.array([3e5, -1e5, 2e5]), np.array([0.6, 0.0, 0.8]), 0.9e-6, 0.4e-6
    velocity_i, velocity_j = np.cross(spin, np.zeros(3)), np.cross(spin, (arm_i + arm_j) * normal)
    assert np.allclose(slip_velocity(velocity_i, velocity_j, spin, spin, arm_i, arm_j, normal), 0.0, atol=1e-15)
