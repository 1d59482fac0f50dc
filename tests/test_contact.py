"""Effective properties, special points and the depth of an impact, against the oracle and closed forms."""

from __future__ import annotations

import dataclasses
import math

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
