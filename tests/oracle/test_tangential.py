"""Sliding law of the oracle: stiffness, limit, reset, energy."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pyjkr.oracle import (
    NormalContact,
    contact_radius,
    effective_shear_modulus,
    elastic_force,
    equilibrium_overlap,
    pull_off_force,
)
from pyjkr.oracle.tangential import (
    plastic_rate,
    resistance,
    returned_displacement,
    sliding,
    sliding_limit,
    slip_rate,
    slip_velocity,
    tangential_damping,
    tangential_stiffness,
)

ROUND_OFF = 1e-13
RADIUS, MODULUS, SHEAR, ENERGY, MASS, FRICTION = 0.83e-6, 3.8e9, 1.1e9, 0.052, 2.3e-15, 0.37
OVERLAP = 2.7e-9


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


def contact_of(model: str, restitution: float = 0.7) -> NormalContact:
    return NormalContact(RADIUS, MODULUS, ENERGY, model, restitution)


def slider_of(model: str, overlap: float = OVERLAP, damping: bool = True):
    contact = contact_of(model)
    return sliding(contact, SHEAR, FRICTION, pull_off_force(contact), MASS, overlap, damping)


def test_shear_modulus_of_like_bodies():
    assert effective_shear_modulus(3e9, 0.3, 3e9, 0.3) == pytest.approx(3e9 / (4 * 1.3 * 1.7), rel=1e-15)


def test_stiffness_follows_the_hertz_radius_or_the_contact_radius():
    assert tangential_stiffness(contact_of("jkr/simplified"), SHEAR, OVERLAP) == pytest.approx(
        8 * SHEAR * (RADIUS * OVERLAP) ** 0.5, rel=ROUND_OFF
    )
    assert tangential_stiffness(contact_of("jkr"), SHEAR, OVERLAP) == pytest.approx(
        8 * SHEAR * contact_radius(contact_of("jkr"), OVERLAP), rel=ROUND_OFF
    )


def test_dashpot_uses_the_square_root_of_five_sixths():
    beta = -np.log(0.7) / np.hypot(np.log(0.7), np.pi)
    assert tangential_damping(contact_of("jkr"), 13.0, MASS) == pytest.approx(
        2 * (5 / 6) ** 0.5 * beta * (13.0 * MASS) ** 0.5, rel=ROUND_OFF
    )


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
    for name in ("stiffness", "limit"):
        difference = (getattr(above, name) - getattr(below, name)) / (2 * step)
        assert getattr(slider, f"{name}_slope") == pytest.approx(
            difference, rel=1e-7
        )  # central difference of step 1e-4


def test_spring_yields_along_itself_and_total_force_is_capped_along_the_total():
    slider = slider_of("jkr/simplified")
    displacement, velocity = np.array([3e-9, -5e-9, 0.0]), np.array([0.4, 0.9, 0.0])
    assert np.linalg.norm(slider.stiffness * displacement) > slider.limit
    kept = returned_displacement(slider, displacement)
    assert slider.stiffness * kept == pytest.approx(
        slider.limit * displacement / np.linalg.norm(displacement), rel=ROUND_OFF
    )
    total = slider.stiffness * kept + slider.dashpot * velocity
    held = resistance(slider, kept, velocity)
    assert held == pytest.approx(total * min(1, slider.limit / np.linalg.norm(total)), rel=ROUND_OFF)
    assert resistance(slider, displacement, velocity, yielding=True) == pytest.approx(held, rel=ROUND_OFF)


def test_a_load_within_the_limit_is_left_alone():
    slider = slider_of("jkr")
    displacement, velocity = np.array([1e-11, -2e-11, 0.0]), np.array([1e-3, 2e-3, 0.0])
    assert np.array_equal(returned_displacement(slider, displacement), displacement)
    assert np.array_equal(
        resistance(slider, displacement, velocity), slider.stiffness * displacement + slider.dashpot * velocity
    )


def test_slip_rate_keeps_the_spring_at_the_limit_while_limit_and_stiffness_change():
    overlap_rate, velocity = 0.7, np.array([0.4, -0.3, 0.0])
    slider = slider_of("jkr")
    displacement = returned_displacement(slider, np.array([2e-8, 1e-8, 0.0]))
    assert slip_rate(slider, displacement, velocity, overlap_rate) > 0
    step = 1e-14
    moved = displacement + step * plastic_rate(slider, displacement, velocity, overlap_rate)
    after = slider_of("jkr", OVERLAP + step * overlap_rate)
    growth = np.linalg.norm(after.stiffness * moved) / after.limit - 1
    assert abs(growth) < 1e-3 * step * np.linalg.norm(velocity) / np.linalg.norm(
        displacement
    )  # second order in the step


@given(*[st.floats(-1.0, 1.0)] * 4, log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3))
@settings(max_examples=200, deadline=None)
def test_dashpot_and_cap_never_work_for_the_motion(x, y, u, w, stretch, speed):
    # however far the dashpot alone exceeds the limit: power into the slider >= power into its spring
    slider = slider_of("jkr/simplified")
    spring = returned_displacement(slider, stretch * slider.limit / slider.stiffness * np.array([x, y, 0.0]))
    velocity = speed * slider.limit / slider.dashpot * np.array([u, w, 0.0])
    load = resistance(slider, spring, velocity)
    assert np.linalg.norm(load) <= slider.limit * (1 + ROUND_OFF)
    assert (load - slider.stiffness * spring) @ velocity >= -ROUND_OFF * slider.limit * np.max(np.abs(velocity))


@given(
    st.lists(st.tuples(st.floats(-3e-8, 3e-8), st.floats(-3e-8, 3e-8)), min_size=2, max_size=6),
    st.sampled_from(["jkr/simplified", "jkr"]),
)
@settings(max_examples=25, deadline=None)
def test_a_closed_slip_cycle_never_makes_energy(corners, model):
    slider = slider_of(model)
    path = np.array([(0.0, 0.0), *corners, (0.0, 0.0)])
    displacement, work = np.zeros(3), 0.0
    for start, end in itertools.pairwise(path):
        step = np.append((end - start) / 40, 0.0)
        for _ in range(40):
            displacement = returned_displacement(slider, displacement + step)
            work += resistance(slider, displacement, 3e8 * step) @ step  # end-point rule: adds (k/2) step^2 at most
    stored = 0.5 * slider.stiffness * displacement @ displacement
    assert work >= stored * (1 - ROUND_OFF)
    assert stored <= 0.5 * slider.limit**2 / slider.stiffness * (1 + ROUND_OFF)


def test_slip_velocity_of_rigid_motion_vanishes():
    spin, normal, arm_i, arm_j = np.array([3e5, -1e5, 2e5]), np.array([0.6, 0.0, 0.8]), 0.9e-6, 0.4e-6
    velocity_i, velocity_j = np.cross(spin, np.zeros(3)), np.cross(spin, (arm_i + arm_j) * normal)
    assert np.allclose(slip_velocity(velocity_i, velocity_j, spin, spin, arm_i, arm_j, normal), 0.0, atol=1e-15)
