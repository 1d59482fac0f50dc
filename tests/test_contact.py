"""Effective properties, special points and the depth of an impact, against the oracle and closed forms."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_timestep import spheres

from pyjkr import contact, oracle

speeds = st.floats(math.log(1e-3), math.log(100)).map(math.exp)
energies = st.floats(math.log(1e-4), math.log(1.0)).map(math.exp)
# Cancellation of a^2/R against the neck's term where the impact barely dents the sphere.
ROUND_OFF = 1e-9


def test_particle_modulus_gives_the_pair_its_effective_modulus():
    poissons = (0.33, 0.17)
    moduli = tuple(contact.particle_modulus(271e6, poisson) for poisson in poissons)
    assert contact.effective_modulus(moduli, poissons) == pytest.approx(271e6, rel=1e-14)


def test_rupture_overlap_is_that_of_each_law():
    # delta_C R/a_0^2 = 1/(2 6^(1/3)) = 0.275160604.
    pair = spheres()
    assert contact.rupture_overlap(pair, "jkr/simplified") == 0
    scale = pair.equilibrium_contact_radius**2 / pair.effective_radius
    assert contact.rupture_overlap(pair, "jkr") == pytest.approx(-0.275160604 * scale, rel=1e-8)


@given(speed=speeds, energy=energies)
def test_deepest_overlap_stores_the_kinetic_energy(speed, energy):
    pair = spheres(energy=energy)
    law = oracle.NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy)
    deepest = contact.maximum_overlap(pair, speed)
    kinetic, well = 0.5 * pair.effective_mass * speed**2, -float(oracle.stored_energy(law, oracle.equilibrium_overlap(law)))
    assert float(oracle.stored_energy(law, deepest)) == pytest.approx(kinetic, rel=ROUND_OFF, abs=ROUND_OFF * (kinetic + well))


@given(speed=speeds)
def test_deepest_overlap_without_adhesion_is_that_of_hertz(speed):
    # (15 m v^2/(16 E sqrt R))^(2/5)
    pair = spheres(energy=0.0)
    hertz = (15 * pair.effective_mass * speed**2 / (16 * pair.effective_modulus * math.sqrt(pair.effective_radius))) ** 0.4
    assert contact.maximum_overlap(pair, speed) == pytest.approx(hertz, rel=1e-12)
    faint = dataclasses.replace(pair, surface_energy=1e-12)
    assert contact.maximum_overlap(faint, speed) == pytest.approx(hertz, rel=1e-3)


def test_damping_never_presses_deeper_than_the_bound():
    pair = spheres()
    law = oracle.NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy, restitution_coefficient=0.7)
    for speed in (0.05, 0.8, 9.0):
        assert oracle.impact(law, pair.effective_mass, speed).maximum_overlap < contact.maximum_overlap(pair, speed)


# Of contact radii: the root's own round-off, and near rupture that of the overlap, which the double root turns into
# its square root.
ROUND_OFF_OF_ROOT = 1e-14
ROUND_OFF_NEAR_RUPTURE = 1e-7


@given(energy=st.floats(math.log(1e-12), math.log(10.0)).map(math.exp), wall=st.booleans())
def test_contact_radius_is_that_of_the_oracle_from_rupture_to_deep_compression(energy, wall):
    pair = spheres(energy=energy, wall=wall)
    law = oracle.NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy, "jkr")
    rupture = contact.rupture_overlap(pair, "jkr")
    neck = rupture * (1 - np.logspace(-3, 0, 60))
    pressed = -rupture * np.logspace(-8, 8, 90)
    for overlaps in (neck, pressed):
        found = contact.contact_radius(overlaps, pair)
        # 1e-13: a distance of 1e-3 from rupture costs two digits.
        np.testing.assert_allclose(found, oracle.contact_radius(law, overlaps), rtol=1e-13)
    beyond = rupture * (1 - np.logspace(-15, -3, 30))
    np.testing.assert_allclose(
        contact.contact_radius(beyond, pair), oracle.contact_radius(law, beyond), rtol=ROUND_OFF_NEAR_RUPTURE
    )


@given(ratio=st.floats(math.log(0.7), math.log(40)).map(math.exp))
def test_contact_radius_gives_the_overlap_back(ratio):
    pair = spheres()
    a = ratio * pair.equilibrium_contact_radius
    assert contact.contact_radius(contact.overlap(pair, a), pair) == pytest.approx(a, rel=20 * ROUND_OFF_OF_ROOT)


def test_contact_radius_at_the_named_points():
    # a_0 at delta = a_0^2/(3 R); (2/3)^(2/3) a_0 without overlap; 6^(-2/3) a_0 = 0.302853432 a_0 at rupture, and then none.
    pair = spheres()
    zero_load, rupture = pair.equilibrium_contact_radius, contact.rupture_overlap(pair, "jkr")
    overlaps = [zero_load**2 / (3 * pair.effective_radius), 0.0, rupture, 1.001 * rupture]
    expected = np.array([1.0, (2 / 3) ** (2 / 3), 0.302853432, 0.0]) * zero_load
    np.testing.assert_allclose(contact.contact_radius(overlaps, pair), expected, rtol=ROUND_OFF_NEAR_RUPTURE)


def test_contact_radius_without_adhesion_is_that_of_hertz():
    pair = spheres(energy=0.0)
    found = contact.contact_radius([3e-9, 0.0, -2e-9], pair)
    np.testing.assert_allclose(found, [math.sqrt(pair.effective_radius * 3e-9), 0.0, 0.0], rtol=ROUND_OFF_OF_ROOT)


def test_contact_radius_takes_one_pair_for_each_contact():
    alone = [spheres(energy=0.03), spheres(energy=0.0), spheres(energy=0.2, wall=True)]
    both = dataclasses.replace(
        alone[0],
        effective_radius=np.array([pair.effective_radius for pair in alone]),
        surface_energy=np.array([pair.surface_energy for pair in alone]),
    )
    overlaps = [2e-9, 5e-10, -1e-10]
    expected = [float(contact.contact_radius(one, pair)) for one, pair in zip(overlaps, alone, strict=True)]
    np.testing.assert_allclose(contact.contact_radius(overlaps, both), expected, rtol=ROUND_OFF_OF_ROOT)


def test_the_simplified_contact_holds_eight_ninths_of_the_pull_off_force():
    pair = spheres()
    law = oracle.NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy, "jkr")
    assert contact.holding_force(pair, "jkr/simplified") == pytest.approx(-float(oracle.elastic_force(law, 0.0)), rel=1e-14)
    overlaps = np.linspace(contact.rupture_overlap(pair, "jkr"), 0, 20_001)
    assert contact.holding_force(pair, "jkr") == pytest.approx(-oracle.elastic_force(law, overlaps).min(), rel=1e-7)
