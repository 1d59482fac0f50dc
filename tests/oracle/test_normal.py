"""Normal law of the oracle against closed-form constants.

Constants marked [mpmath] were computed to 30 digits from the closed forms of Johnson, Kendall, Roberts in the units
F_C, a_0^2/R, a_0.
"""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from pyjkr.oracle import (
    Model,
    NormalContact,
    contact_radius,
    damping_coefficient,
    damping_ratio,
    effective_modulus,
    effective_radius,
    elastic_force,
    equilibrium_contact_radius,
    equilibrium_overlap,
    normal_stiffness,
    pull_off_force,
    rupture_overlap,
    stored_energy,
)
from pyjkr.oracle.normal import scaled_root, scaled_roots

ROUND_OFF = 1e-13  # of max(|F|, F_C): a few operations on a root with 1e-15 relative error
ROOT = 2e-15  # relative error of the contact radius away from rupture: twice brentq's tolerance on its square root
LOSS_HAT = 0.25741351095852878  # [mpmath] make-break loss over F_C a_0^2/R
WELL_HAT = 0.16704520940365363  # [mpmath] well from overlap 0 to equilibrium over F_C a_0^2/R
RUPTURE_HAT = 0.27516060407455222  # [mpmath] delta_C R/a_0^2 = 1/(2 6^(1/3))
PRINTED = 1e-13  # round-off; the constants carry seventeen digits

POLYSTYRENE = dict(effective_radius=0.73e-6, effective_modulus=3.8e9, surface_energy=0.052)


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


RADII, MODULI, ENERGIES, OVERLAPS = (
    log_uniform(1e-9, 1e-3),
    log_uniform(1e5, 1e12),
    log_uniform(1e-12, 10.0),
    log_uniform(1e-16, 0.5),
)


def reference(radius: float, modulus: float, energy: float, overlap: float):
    """(a, F) with 50 digits, from the root of overlap(a)."""
    with mpmath.workdps(50):
        r, e, g, d = map(mpmath.mpf, (radius, modulus, energy, overlap))
        unit = mpmath.cbrt(9 * mpmath.pi * g * r**2 / e)
        x = d * r / unit**2
        u = 1 + mpmath.root(abs(x), 4)  # right of the largest root, where Newton on the convex quartic descends to it
        for _ in range(200):
            u -= (u**4 - 2 * u / 3 - x) / (4 * u**3 - mpmath.mpf(2) / 3)
        a = unit * u**2
        return float(a), float(4 * e * a**3 / (3 * r) - 4 * mpmath.sqrt(mpmath.pi * g * e * a**3))


@given(RADII, MODULI, ENERGIES, OVERLAPS)
@settings(max_examples=60, deadline=None)
def test_contact_radius_and_force_agree_with_fifty_digits(radius, modulus, energy, strain):
    contact = NormalContact(radius, modulus, energy)
    a, force = reference(radius, modulus, energy, strain * radius)
    assert contact_radius(contact, strain * radius) == pytest.approx(a, rel=ROOT)
    assert abs(elastic_force(contact, strain * radius) - force) <= ROUND_OFF * max(abs(force), pull_off_force(contact))


@given(RADII, MODULI, ENERGIES, log_uniform(1e-6, 0.999))
@settings(max_examples=60, deadline=None)
def test_the_neck_agrees_with_fifty_digits_down_to_rupture(radius, modulus, energy, depth):
    contact = NormalContact(radius, modulus, energy, "jkr")
    overlap = float(rupture_overlap(contact)) * (1 - depth)
    a, force = reference(radius, modulus, energy, overlap)
    conditioning = (
        1e-15 / depth**0.5
    )  # a - a_rupture goes as the square root of the distance, itself known to round-off of the overlap
    assert contact_radius(contact, overlap) == pytest.approx(a, rel=ROOT + conditioning)
    assert elastic_force(contact, overlap) == pytest.approx(
        force, abs=(ROUND_OFF + 10 * conditioning) * pull_off_force(contact)
    )


@given(RADII, MODULI, log_uniform(1e-12, 10.0), OVERLAPS)
@settings(max_examples=60, deadline=None)
def test_overlap_to_radius_to_overlap_returns(radius, modulus, energy, strain):
    contact = NormalContact(radius, modulus, energy)
    overlap = strain * radius
    a = contact_radius(contact, overlap)
    returned = a**2 / radius - 2 * np.sqrt(np.pi * energy * a / modulus)  # Haervig 2017 eq. A.9
    assert abs(returned - overlap) <= 1e-14 * a**2 / radius  # the two terms cancel


@pytest.mark.parametrize("model", list(Model))
def test_special_points_of_the_curve(model):
    contact = NormalContact(**POLYSTYRENE, model=model)
    unit, force = equilibrium_contact_radius(contact), pull_off_force(contact)
    assert force == pytest.approx(3 * np.pi * 0.73e-6 * 0.052, rel=1e-15)
    assert elastic_force(contact, 0.0) == pytest.approx(-8 / 9 * force, rel=ROUND_OFF)
    assert contact_radius(contact, 0.0) == pytest.approx(
        0.76314282836888791 * unit, rel=PRINTED
    )  # [mpmath] (2/3)^(2/3)
    assert abs(elastic_force(contact, equilibrium_overlap(contact))) < ROUND_OFF * force
    assert contact_radius(contact, equilibrium_overlap(contact)) == pytest.approx(unit, rel=ROOT)
    assert normal_stiffness(contact, equilibrium_overlap(contact)) == pytest.approx(1.2 * 3.8e9 * unit, rel=ROUND_OFF)


def test_full_contact_ruptures_at_minus_delta_c_with_five_ninths_of_the_pull_off_force():
    contact = NormalContact(**POLYSTYRENE, model="jkr")
    unit, overlap = equilibrium_contact_radius(contact), rupture_overlap(contact)
    assert overlap == pytest.approx(-RUPTURE_HAT * unit**2 / 0.73e-6, rel=PRINTED)
    # The square root of the distance to rupture multiplies the round-off of the overlap: 1e-16 becomes 1e-8.
    assert contact_radius(contact, overlap) == pytest.approx(0.30285343213868994 * unit, rel=1e-7)  # [mpmath] 6^(-2/3)
    assert elastic_force(contact, overlap) == pytest.approx(-5 / 9 * pull_off_force(contact), rel=1e-7)


def test_simplified_contact_breaks_at_zero_overlap():
    assert rupture_overlap(NormalContact(**POLYSTYRENE)) == 0.0


def test_force_reaches_minus_pull_off_force_and_not_below():
    contact = NormalContact(**POLYSTYRENE, model="jkr")
    overlaps = np.linspace(rupture_overlap(contact), equilibrium_overlap(contact), 20001)
    lowest = np.min(elastic_force(contact, overlaps)) / pull_off_force(contact)
    assert -1 - ROUND_OFF <= lowest < -1 + 1e-7  # 1e-7: parabola through a minimum sampled 2e4 times


@pytest.mark.parametrize("model", list(Model))
def test_energies_of_the_well_and_of_the_neck(model):
    contact = NormalContact(**POLYSTYRENE, model=model)
    unit = pull_off_force(contact) * equilibrium_contact_radius(contact) ** 2 / 0.73e-6
    assert stored_energy(contact, 0.0) == pytest.approx(0.0, abs=1e-15 * unit)
    assert stored_energy(contact, equilibrium_overlap(contact)) == pytest.approx(-WELL_HAT * unit, rel=PRINTED)
    if model is Model.FULL:
        assert stored_energy(contact, rupture_overlap(contact)) == pytest.approx(LOSS_HAT * unit, rel=PRINTED)


@given(RADII, MODULI, ENERGIES, OVERLAPS)
@settings(max_examples=40, deadline=None)
def test_stored_energy_is_the_integral_of_the_force(radius, modulus, energy, strain):
    contact = NormalContact(radius, modulus, energy)
    overlap = strain * radius
    expected = quad(lambda x: elastic_force(contact, x * overlap) * overlap, 0, 1, epsrel=1e-11, epsabs=0)[0]
    scale = overlap * max(abs(elastic_force(contact, overlap)), pull_off_force(contact))
    # round-off: energies are differences from overlap 0 on the scale F_C a_0^2/R
    unit = pull_off_force(contact) * equilibrium_contact_radius(contact) ** 2 / radius
    assert abs(stored_energy(contact, overlap) - expected) <= 1e-9 * scale + 1e-14 * unit


@given(RADII, MODULI, ENERGIES, log_uniform(1e-8, 0.5), st.sampled_from(["jkr", "jkr/simplified"]))
@settings(max_examples=60, deadline=None)
def test_force_and_stiffness_are_derivatives(radius, modulus, energy, strain, model):
    contact = NormalContact(radius, modulus, energy, model)
    overlap = strain * radius
    step = 1e-4 * max(overlap, equilibrium_overlap(contact))
    force = (stored_energy(contact, overlap + step) - stored_energy(contact, overlap - step)) / (2 * step)
    stiffness = (elastic_force(contact, overlap + step) - elastic_force(contact, overlap - step)) / (2 * step)
    scale = max(abs(elastic_force(contact, overlap)), pull_off_force(contact))
    assert (
        abs(force - elastic_force(contact, overlap)) < 1e-6 * scale
    )  # second order in the step of 1e-4, and round-off/step
    assert stiffness == pytest.approx(normal_stiffness(contact, overlap), rel=1e-6)


@given(RADII, MODULI, OVERLAPS)
@settings(deadline=None)
def test_no_surface_energy_is_hertz(radius, modulus, strain):
    contact = NormalContact(radius, modulus, 0.0)
    overlap = strain * radius
    assert elastic_force(contact, overlap) == pytest.approx(4 / 3 * modulus * radius**0.5 * overlap**1.5, rel=ROUND_OFF)
    assert stored_energy(contact, overlap) == pytest.approx(
        8 / 15 * modulus * radius**0.5 * overlap**2.5, rel=ROUND_OFF
    )
    assert elastic_force(contact, 0.0) == 0.0 and elastic_force(contact, -overlap) == 0.0


@given(RADII, MODULI, OVERLAPS)
@settings(deadline=None)
def test_vanishing_surface_energy_tends_to_hertz(radius, modulus, strain):
    overlap = strain * radius
    energy = (
        1e-20 * modulus * overlap**1.5 / radius**0.5
    )  # a_0^3/a^3 = 9 pi 1e-20: the first correction to Hertz is its square root
    assert elastic_force(NormalContact(radius, modulus, energy), overlap) == pytest.approx(
        4 / 3 * modulus * radius**0.5 * overlap**1.5, rel=1e-8
    )


@given(RADII, MODULI, ENERGIES, OVERLAPS, log_uniform(1e-3, 0.9))
@settings(max_examples=60, deadline=None)
def test_scaled_surface_energy_leaves_the_dimensionless_curve_alone(radius, modulus, energy, strain, ratio):
    contact, softened = (
        NormalContact(radius, modulus, energy),
        NormalContact(radius, ratio * modulus, energy * ratio**0.4),
    )
    overlap = strain * radius
    force, soft_force = elastic_force(contact, overlap), elastic_force(softened, overlap * ratio**-0.4)
    assert abs(soft_force / ratio**0.4 - force) <= 10 * ROUND_OFF * max(abs(force), pull_off_force(contact))
    before, after = stored_energy(contact, overlap), stored_energy(softened, overlap * ratio**-0.4)
    unit = pull_off_force(contact) * equilibrium_contact_radius(contact) ** 2 / radius
    assert abs(after - before) <= 10 * ROUND_OFF * max(abs(before), unit)


@given(RADII, MODULI, ENERGIES, OVERLAPS, log_uniform(1e-20, 1e-6), st.floats(0.05, 0.98))
@settings(max_examples=60, deadline=None)
def test_damping_follows_its_own_contact_stiffness(radius, modulus, energy, strain, mass, restitution):
    overlap, beta = strain * radius, -np.log(restitution) / np.hypot(np.log(restitution), np.pi)
    simplified = NormalContact(radius, modulus, energy, "jkr/simplified", restitution)
    full = NormalContact(radius, modulus, energy, "jkr", restitution)
    a = contact_radius(full, overlap)
    assert damping_ratio(restitution) == pytest.approx(beta, rel=ROUND_OFF)
    expected = 2 * (5 / 6) ** 0.5 * beta * (2 * modulus * (radius * overlap) ** 0.5 * mass) ** 0.5
    assert damping_coefficient(simplified, overlap, mass) == pytest.approx(expected, rel=ROUND_OFF)
    assert damping_coefficient(full, overlap, mass) == pytest.approx(
        5**0.5 * beta * (mass * 4 / 3 * modulus * a) ** 0.5, rel=ROUND_OFF
    )


def test_the_damping_laws_agree_for_hertz_and_the_full_one_acts_in_the_neck():
    hertz = [NormalContact(0.73e-6, 3.8e9, 0.0, model, 0.6) for model in Model]
    assert damping_coefficient(hertz[0], 2e-9, 3e-15) == pytest.approx(
        damping_coefficient(hertz[1], 2e-9, 3e-15), rel=ROUND_OFF
    )
    neck = NormalContact(**POLYSTYRENE, model="jkr", restitution_coefficient=0.6)
    assert damping_coefficient(neck, 0.9 * rupture_overlap(neck), 3e-15) > 0


def test_arrays_of_contacts_give_what_each_contact_gives():
    radius, modulus, energy = np.array([0.3e-6, 2e-6, 5e-5]), np.array([2e8, 3.8e9, 7e10]), np.array([0.11, 0.0, 0.02])
    overlap = np.array([3e-9, 1e-8, -2e-10])
    together = elastic_force(NormalContact(radius, modulus, energy, "jkr"), overlap)
    alone = [
        elastic_force(NormalContact(*row, "jkr"), x) for *row, x in zip(radius, modulus, energy, overlap, strict=True)
    ]
    assert together == pytest.approx(alone, rel=1e-14)  # numpy's vector powers round differently


def test_effective_properties_of_unlike_bodies():
    assert effective_radius(0.4e-6, 1.2e-6) == pytest.approx(0.3e-6, rel=1e-15)
    assert effective_radius(0.4e-6, np.inf) == 0.4e-6
    assert effective_modulus(3e9, 0.3, np.inf, 0.2) == pytest.approx(3e9 / 0.91, rel=1e-15)


@pytest.mark.parametrize(
    "wrong",
    [
        dict(surface_energy=-0.01),
        dict(effective_radius=0.0),
        dict(effective_modulus=float("nan")),
        dict(model="hertz"),
        dict(restitution_coefficient=1.2),
    ],
)
def test_impossible_properties_are_refused(wrong):
    with pytest.raises(ValueError):
        NormalContact(**{**POLYSTYRENE, **wrong})


def test_the_root_exists_over_the_whole_range():
    for radius in (1e-9, 1e-6, 1e-3):
        for energy in (0.0, 1e-15, 1e-4, 10.0):
            contact = NormalContact(radius, 2e9, energy, "jkr")
            a = contact_radius(contact, radius * np.array([-0.5, -1e-16, 0.0, 1e-16, 1e-8, 0.5]))
            assert np.all(np.isfinite(a)) and np.all(np.diff(a) >= 0)


def test_many_roots_at_once_are_the_roots_one_by_one():
    rng = np.random.default_rng(11)
    reach, critical = 10 ** rng.uniform(-14, 1, 500), np.where(rng.random(500) < 0.2, 0.0, rng.uniform(1e-3, 1, 500))
    reach[:2], critical[1] = 0.0, 0.0
    one_by_one = [scaled_root(r, c) for r, c in zip(reach.tolist(), critical.tolist(), strict=True)]
    assert scaled_roots(reach, critical) == pytest.approx(one_by_one, rel=1e-14)  # a few roundings of either
