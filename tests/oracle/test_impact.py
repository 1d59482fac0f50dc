"""Impacts of the oracle against closed forms, published numbers and its own convergence."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pyjkr.oracle import (
    NormalContact,
    damping_coefficient,
    elastic_force,
    equilibrium_contact_radius,
    equilibrium_overlap,
    impact,
    pull_off_force,
    rupture_overlap,
    sticking_speed,
    stored_energy,
)

EXACT = 5e-12  # integrator at relative tolerance 1e-12 over one collision: measured up to 2.4e-12
REFERENCE = 5e-7  # half a unit of the sixth digit of the reference e_eff
TABLE = 2e-7  # half a unit of the eighth digit of the tables of sticking speeds, and their own integration at 1e-9

LOSS_HAT = 0.25741351095852878  # [mpmath, 30 digits] make-break loss of full JKR over F_C a_0^2/R
HERTZ_TIME = 2.8682656991953314  # [mpmath] Hertz contact time over (m^2/(R E^2 v))^(1/5)
HERTZ_TIME_OVERLAP = 2.9432751843247047  # [mpmath] Hertz contact time over maximum overlap / v

# Dahneke's polystyrene sphere on a quartz wall with the fit of Krijt 2013 (caption of Haervig 2017 fig. 5).
SPHERE_RADIUS, SPHERE_MASS = 0.635e-6, 1026 * 4 / 3 * np.pi * 0.635e-6**3
DAHNEKE = NormalContact(SPHERE_RADIUS, 271e6, 0.11, "jkr/simplified", 0.86)


def speed_unit(contact: NormalContact, mass: float) -> float:
    """sqrt(F_C a_0^2/(R m))."""
    return float(
        np.sqrt(pull_off_force(contact) * equilibrium_contact_radius(contact) ** 2 / (contact.effective_radius * mass))
    )


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


# Derived from the closed equations by an independent integration, six digits (1e-4 for the two slow ones).
@pytest.mark.parametrize(
    "speed, restitution, digits",
    [
        (2.45, 0.1599, 5e-5),
        (2.6, 0.3080, 5e-5),
        (3.2, 0.534051, REFERENCE),
        (5.0, 0.718637, REFERENCE),
        (10.0, 0.8111, 5e-5),
        (20.0, 0.841016, REFERENCE),
    ],
)
def test_dahneke_sphere_rebounds_with_the_reference_restitution(speed, restitution, digits):
    assert impact(DAHNEKE, SPHERE_MASS, speed).restitution == pytest.approx(restitution, abs=digits)


def test_dahneke_sphere_sticks_below_2_4005_metres_per_second():
    critical = sticking_speed(DAHNEKE, SPHERE_MASS)
    assert critical == pytest.approx(2.400, abs=1e-3)  # reference printed to 2.400
    assert critical == pytest.approx(0.46931637 * speed_unit(DAHNEKE, SPHERE_MASS), rel=TABLE)
    assert impact(DAHNEKE, SPHERE_MASS, critical * (1 - 1e-6)).stuck
    assert not impact(DAHNEKE, SPHERE_MASS, critical * (1 + 1e-6)).stuck


# Haervig 2017 fig. 12: c(e), here as dimensionless speeds derived to eight digits with eq. 11 as 2 sqrt(5/6).
@pytest.mark.parametrize(
    "restitution, critical",
    [(0.1, 9.5691224), (0.3, 2.8865187), (0.5, 1.4944515), (0.7, 0.83887246), (0.9, 0.37922475)],
)
def test_sticking_speed_of_the_simplified_law_follows_the_table(restitution, critical):
    contact = NormalContact(0.83e-6, 3.8e9, 0.052, "jkr/simplified", restitution)
    assert sticking_speed(contact, 2.3e-15) == pytest.approx(critical * speed_unit(contact, 2.3e-15), rel=TABLE)


# Full JKR with eta = alpha sqrt(m (4/3) E a), alpha = sqrt(5) |beta|: dimensionless sticking speed, restitution at
# 30 units; eight digits.
@pytest.mark.parametrize(
    "alpha, critical, at_thirty",
    [
        (0.01, 0.75455305, 0.984408),
        (0.1, 1.096349, 0.85596321),
        (0.3, 2.009236, 0.6209597),
        (0.6, 4.2186259, 0.36351378),
        (1.2, 20.054452, 0.054855428),
    ],
)
def test_sticking_speed_of_the_full_law_follows_the_table(alpha, critical, at_thirty):
    beta = alpha / 5**0.5
    contact = NormalContact(0.83e-6, 3.8e9, 0.052, "jkr", float(np.exp(-np.pi * beta / np.sqrt(1 - beta**2))))
    unit = speed_unit(contact, 2.3e-15)
    assert sticking_speed(contact, 2.3e-15) == pytest.approx(critical * unit, rel=TABLE)
    assert impact(contact, 2.3e-15, 30 * unit).restitution == pytest.approx(at_thirty, abs=TABLE)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
@given(st.floats(0.06, 0.98), log_uniform(1e-3, 300.0), log_uniform(1e-18, 1e-9))
@settings(max_examples=8, deadline=None)
def test_hertz_returns_the_nominal_restitution_exactly(model, restitution, speed, mass):
    assert impact(NormalContact(0.4e-6, 2.7e9, 0.0, model, restitution), mass, speed).restitution == pytest.approx(
        restitution, abs=EXACT
    )


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_hertz_contact_time_and_depth(model):
    radius, modulus, mass, speed = 0.4e-6, 2.7e9, 3.1e-15, 4.2
    result = impact(NormalContact(radius, modulus, 0.0, model), mass, speed)
    assert result.contact_time == pytest.approx(
        HERTZ_TIME * (mass**2 / (radius * modulus**2 * speed)) ** 0.2, rel=EXACT
    )
    assert result.contact_time == pytest.approx(
        HERTZ_TIME_OVERLAP * result.maximum_overlap / speed, rel=1e-9
    )  # depth from dense output
    assert result.maximum_overlap == pytest.approx(
        (15 * mass * speed**2 / (16 * modulus * radius**0.5)) ** 0.4, rel=1e-9
    )


@given(log_uniform(1e-3, 30.0))
@settings(max_examples=10, deadline=None)
def test_undamped_simplified_contact_never_sticks(ratio):
    contact = NormalContact(0.83e-6, 3.8e9, 0.052)
    result = impact(contact, 2.3e-15, ratio * speed_unit(contact, 2.3e-15))
    assert result.restitution == pytest.approx(1.0, abs=EXACT) and np.isfinite(result.contact_time)
    assert sticking_speed(contact, 2.3e-15) == 0.0


@given(log_uniform(0.75, 30.0))
@settings(max_examples=10, deadline=None)
def test_undamped_full_contact_loses_the_neck_energy(ratio):
    contact = NormalContact(0.83e-6, 3.8e9, 0.052, "jkr")
    unit = speed_unit(contact, 2.3e-15)
    assert impact(contact, 2.3e-15, ratio * unit).restitution == pytest.approx(
        (1 - 2 * LOSS_HAT / ratio**2) ** 0.5, abs=EXACT
    )
    assert sticking_speed(contact, 2.3e-15) == pytest.approx((2 * LOSS_HAT) ** 0.5 * unit, rel=1e-10)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
@given(log_uniform(1e-3, 0.8), st.floats(0.3, 0.97), log_uniform(0.1, 60.0))
@settings(max_examples=8, deadline=None)
def test_scaled_surface_energy_leaves_rebound_alone_and_stretches_time(model, ratio, restitution, speed_ratio):
    contact = NormalContact(0.83e-6, 3.8e9, 0.052, model, restitution)
    softened = NormalContact(0.83e-6, 3.8e9 * ratio, 0.052 * ratio**0.4, model, restitution)  # Haervig 2017 eq. 24
    speed = speed_ratio * speed_unit(contact, 2.3e-15)
    before, after = impact(contact, 2.3e-15, speed), impact(softened, 2.3e-15, speed)
    assert after.stuck == before.stuck
    assert after.restitution == pytest.approx(before.restitution, abs=1e-10)
    assert after.maximum_overlap == pytest.approx(before.maximum_overlap * ratio**-0.4, rel=1e-9)
    if not before.stuck:
        assert after.contact_time == pytest.approx(before.contact_time * ratio**-0.4, rel=1e-10)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_looser_tolerance_changes_the_answer_no_more_than_it_says(model):
    contact = NormalContact(SPHERE_RADIUS, 271e6, 0.11, model, 0.86)
    fine = impact(contact, SPHERE_MASS, 6.3, relative_tolerance=3e-14)
    for tolerance in (1e-8, 1e-10, 1e-12):
        rough = impact(contact, SPHERE_MASS, 6.3, relative_tolerance=tolerance)
        assert abs(rough.restitution - fine.restitution) < 3 * tolerance  # a few steps' worth of local error
        assert rough.contact_time == pytest.approx(fine.contact_time, rel=10 * tolerance)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_trajectory_obeys_the_equation_of_motion_and_the_energy_balance(model):
    contact, mass = NormalContact(SPHERE_RADIUS, 271e6, 0.11, model, 0.86), SPHERE_MASS
    result = impact(contact, mass, 7.1, samples=4001)
    force = (
        elastic_force(contact, result.overlap) + damping_coefficient(contact, result.overlap, mass) * result.velocity
    )
    middle, dt = slice(20, -20), np.diff(result.time)
    trapezium = np.concatenate([[0], np.cumsum(0.5 * (force[1:] + force[:-1]) * dt)])
    assert np.allclose(
        mass * (7.1 - result.velocity)[middle], trapezium[middle], atol=1e-6 * mass * 7.1
    )  # trapezium rule, 4e3 points
    power = damping_coefficient(contact, result.overlap, mass) * result.velocity**2
    lost = np.sum(0.5 * (power[1:] + power[:-1]) * dt)
    kept = 0.5 * mass * (7.1**2 - result.rebound_speed**2) - stored_energy(contact, rupture_overlap(contact))
    assert lost == pytest.approx(kept, rel=1e-6)
    assert result.overlap[0] == pytest.approx(0.0, abs=1e-12 * SPHERE_RADIUS) and result.velocity[0] == pytest.approx(
        7.1, rel=EXACT
    )
    assert result.overlap[-1] == pytest.approx(rupture_overlap(contact), abs=1e-9 * SPHERE_RADIUS)
    assert np.all(dt > 0)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_stuck_contact_swings_about_equilibrium_with_the_small_period(model):
    contact, mass = NormalContact(0.83e-6, 3.8e9, 0.052, model, 0.9), 2.3e-15
    result = impact(contact, mass, 0.05 * speed_unit(contact, mass), samples=20001, stuck_periods=24.0)
    assert result.stuck and result.rebound_speed == 0.0 and np.isnan(result.contact_time)
    period = 2 * np.pi * np.sqrt(mass / (1.2 * 3.8e9 * equilibrium_contact_radius(contact)))
    start = len(result.time) * 2 // 3  # by then the swing is small enough for the linear period
    swing = (result.overlap - equilibrium_overlap(contact))[start:]
    crossings = np.flatnonzero((swing[1:] > 0) & (swing[:-1] <= 0))
    times = (
        result.time[start:][crossings]
        - swing[crossings] * np.diff(result.time[start:])[crossings] / np.diff(swing)[crossings]
    )
    c = damping_coefficient(contact, equilibrium_overlap(contact), mass)
    damped = period / np.sqrt(1 - (c * period / (4 * np.pi * mass)) ** 2)
    assert np.mean(np.diff(times)) == pytest.approx(damped, rel=2e-4)  # amplitude left at the end of the swing


def test_stuck_period_of_dahneke_sphere_is_28_3_nanoseconds():
    period = 2 * np.pi * np.sqrt(SPHERE_MASS / (1.2 * 271e6 * equilibrium_contact_radius(DAHNEKE)))
    assert period == pytest.approx(28.3e-9, rel=2e-3)  # three printed digits


def test_impact_refuses_a_speed_that_makes_no_contact():
    with pytest.raises(ValueError, match="speed"):
        impact(DAHNEKE, SPHERE_MASS, 0.0)
