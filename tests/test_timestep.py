"""Time scales against closed forms, and the law by which they change with the stiffness."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pyjkr import contact, oracle, scaling, timestep
from pyjkr.contact import PairProperties

# Two polystyrene spheres of 1 um radius: E_i = 3.8 GPa, nu = 0.33, rho = 1050 kg/m3, gamma = 0.05 J/m2.
RADIUS, DENSITY, MODULUS, POISSON, ENERGY = 1e-6, 1050.0, 3.8e9, 0.33, 0.05
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
THREE_DIGITS = 5e-3


def spheres(ratio: float = 1.0, energy: float = ENERGY, wall: bool = False) -> PairProperties:
    share = 1.0 if wall else 0.5
    moduli, poissons = (ratio * MODULUS,) * 2, (POISSON,) * 2
    return PairProperties(
        effective_radius=share * RADIUS,
        effective_mass=share * MASS,
        effective_inertia=share * 0.4 * MASS * RADIUS**2,
        effective_modulus=contact.effective_modulus(moduli, poissons),
        effective_shear_modulus=contact.effective_shear_modulus(moduli, poissons),
        surface_energy=scaling.surface_energy_mod(energy, ratio),
        surface_energy_of_rolling=energy,
        restitution_coefficient=0.7,
    )


@pytest.mark.parametrize(
    ("ratio", "rayleigh", "stuck", "rolling"), [(1.0, 2.9e-9, 24.9e-9, 271e-9), (1e-3, 92e-9, 394e-9, 271e-9)]
)
def test_periods_of_a_polystyrene_pair(ratio, rayleigh, stuck, rolling):
    # 2.9, 24.9, 271 ns and 92, 394, 271 ns: derived from the closed forms, printed with two or three digits.
    pair = spheres(ratio)
    assert timestep.rayleigh_time(RADIUS, DENSITY, ratio * MODULUS, POISSON) == pytest.approx(rayleigh, rel=2 * THREE_DIGITS)
    assert timestep.stuck_period(pair) == pytest.approx(stuck, rel=THREE_DIGITS)
    assert timestep.rolling_period(pair, pair.equilibrium_contact_radius) == pytest.approx(rolling, rel=THREE_DIGITS)


def test_hertz_time_is_the_quadrature_of_an_undamped_impact():
    # 2.94327518 d_max/v with d_max = (15 m v^2/(16 E sqrt R))^(2/5): two closed forms of one time.
    radius, mass, modulus, speed = 0.635e-6, 1.1e-15, 271e6, 3.7
    deepest = (15 * mass * speed**2 / (16 * modulus * math.sqrt(radius))) ** 0.4
    assert timestep.hertz_collision_time(radius, mass, modulus, speed) == pytest.approx(2.94327518 * deepest / speed, rel=1e-8)


def test_stuck_period_of_dahnekes_sphere():
    # 28.3 ns from E = 271 MPa, gamma = 0.11 J/m2, rho = 1026 kg/m3, d = 1.27 um (Haervig 2017, fig. 5).
    radius = 0.635e-6
    pair = dataclasses.replace(
        spheres(),
        effective_radius=radius,
        effective_mass=1026 * 4 / 3 * math.pi * radius**3,
        effective_modulus=271e6,
        surface_energy=0.11,
    )
    assert timestep.stuck_period(pair) == pytest.approx(28.3e-9, rel=2e-3)


def test_modes_at_a_wall_in_units_of_the_normal_one():
    # Same material, nu = 0.33: sliding 2.163, twisting 1.293 a_0/R; rolling without slip 0.890870806 a_0/R, sqrt(7/4) times
    # that where nothing hinders slip, sqrt(7/2) times if slip did not count as rolling.
    pair = spheres(wall=True)
    zero_load = pair.equilibrium_contact_radius
    normal, slender = timestep.stuck_period(pair), zero_load / pair.effective_radius
    assert normal / timestep.sliding_period(pair, zero_load) == pytest.approx(2.163, rel=5e-4)
    assert normal / timestep.twisting_period(pair, zero_load) == pytest.approx(1.293 * slender, rel=5e-4)
    assert normal / timestep.rolling_period(pair, zero_load) == pytest.approx(0.890870806 * math.sqrt(3.5) * slender, rel=1e-8)
    free = normal / timestep.rolling_period(pair, zero_load, timestep.spin_share((RADIUS,), (MASS,)))
    assert free == pytest.approx(0.890870806 * math.sqrt(1.75) * slender, rel=1e-8)


@given(ratio=st.floats(math.log(1e-4), 0.0).map(math.exp), speed=st.floats(math.log(1e-2), math.log(50)).map(math.exp))
def test_collision_time_grows_as_equation_24_says(ratio, speed):
    # Haervig 2017, sec. 6.2.
    grown = timestep.collision_time(spheres(ratio), speed) / timestep.collision_time(spheres(), speed)
    assert grown == pytest.approx(ratio**-0.4, rel=1e-12)


def test_rolling_with_the_original_surface_energy_does_not_slow_down():
    stiff, soft = spheres(), spheres(1e-2)
    assert timestep.rolling_period(soft, soft.equilibrium_contact_radius) == pytest.approx(
        timestep.rolling_period(stiff, stiff.equilibrium_contact_radius), rel=1e-12
    )


def test_without_adhesion_nothing_oscillates_and_hertz_sets_the_step():
    pair = spheres(energy=0.0)
    assert timestep.stuck_period(pair) == math.inf
    assert timestep.rolling_period(pair, 1e-8) == math.inf
    hertz = timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, 0.6)
    assert timestep.time_step(pair, 0.6, 40) == hertz / 40


def test_spins_of_like_spheres_roll_without_slip_and_a_tiny_one_sees_a_wall():
    assert timestep.spin_share((RADIUS, RADIUS), (MASS, MASS)) == 1
    tiny = timestep.spin_share((1e-6, 1e-2), (2e-15, 2e-3))
    assert tiny == pytest.approx(timestep.spin_share((1e-6,), (2e-15,)), rel=2e-4)
    assert timestep.spin_share((3e-6, 0.7e-6), (5e-14, 4e-15)) == timestep.spin_share((0.7e-6, 3e-6), (4e-15, 5e-14))


@given(ratio=st.floats(1.0, 30.0), energy=st.sampled_from([ENERGY, 1e-3]))
def test_normal_period_is_that_of_the_slope_of_the_oracle(ratio, energy):
    pair = spheres(energy=energy)
    law = oracle.NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy, "jkr")
    a = ratio * pair.equilibrium_contact_radius
    overlap = contact.overlap(pair, a)
    step = 1e-5 * pair.equilibrium_contact_radius**2 / pair.effective_radius
    force = [float(oracle.elastic_force(law, overlap + sign * step)) for sign in (-1, 1)]
    slope = (force[1] - force[0]) / (2 * step)
    # The difference of two forces, a fraction 1e-5 apart.
    expected = 2 * math.pi * math.sqrt(pair.effective_mass / slope)
    assert timestep.normal_period(pair, a) == pytest.approx(expected, rel=1e-6)


def test_normal_period_is_the_stuck_one_at_rest_and_that_of_hertz_without_adhesion():
    pair = spheres()
    assert timestep.normal_period(pair, pair.equilibrium_contact_radius) == pytest.approx(
        timestep.stuck_period(pair), rel=1e-14
    )
    plain = spheres(energy=0.0)
    hertz = 2 * math.pi * math.sqrt(plain.effective_mass / (2 * plain.effective_modulus * 3e-8))
    assert timestep.normal_period(plain, 3e-8) == pytest.approx(hertz, rel=1e-14)


@given(h=st.floats(0.05, 4), ratio=st.floats(0, 3))
def test_verlet_limit_is_where_an_oscillation_begins_to_grow(h, ratio):
    # x+ - 2 x + x- + 2 zeta h (x - x-) + h^2 x = 0, h = dt omega: the larger root leaves the unit circle.
    growth = np.abs(np.roots([1, 2 * ratio * h + h**2 - 2, 1 - 2 * ratio * h])).max()
    period = 3.7e-9
    time_step = h * period / (2 * math.pi)
    if time_step < 0.999 * timestep.verlet_limit(period, ratio):
        assert growth <= 1 + 1e-9
    elif time_step > 1.001 * timestep.verlet_limit(period, ratio):
        assert growth > 1
