"""Haervig 2017, eqs 1 and 24, against published numbers and against the similarity they are to keep."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pyjkr import scaling

ratios = st.floats(math.log(1e-5), 0.0).map(math.exp)

# Chen 2019, table 1: gamma_R of gamma_O = 0.05 J/m2, E_O = 3.8 GPa; printed with four digits.
PRINTED_DIGITS = 5e-4


@pytest.mark.parametrize(("modulus", "printed"), [(1.0e9, 0.02931), (0.5e9, 0.02221), (0.1e9, 0.01167)])
def test_surface_energy_is_that_of_chens_table(modulus, printed):
    assert scaling.surface_energy_mod(0.05, modulus / 3.8e9) == pytest.approx(printed, rel=PRINTED_DIGITS)


def test_tabor_number_of_dahnekes_sphere():
    # 45.3: R = 0.635 um, E = 271 MPa, gamma = 0.11 J/m2 (Haervig 2017, fig. 5) in eq. 1; three digits.
    assert scaling.tabor_number(0.635e-6, 271e6, 0.11) == pytest.approx(45.3, rel=1e-3)


@given(ratio=ratios)
def test_sticking_energy_stays_while_forces_fall_and_lengths_grow(ratio):
    # Haervig 2017, eq. A.11: gamma^(5/3)/E^(2/3) is kept; energy = force times length.
    energy = scaling.surface_energy_mod(0.07, ratio)
    assert energy ** (5 / 3) / ratio ** (2 / 3) == pytest.approx(0.07 ** (5 / 3), rel=1e-12)
    assert scaling.force_factor(ratio) * scaling.length_factor(ratio) == pytest.approx(1, rel=1e-12)
    # Velocities stay: length over time.
    assert scaling.length_factor(ratio) == pytest.approx(scaling.time_factor(ratio), rel=1e-12)


@given(ratio=ratios)
def test_tabor_factor_is_that_of_the_tabor_number(ratio):
    before = scaling.tabor_number(0.4e-6, 2.3e9, 0.06)
    after = scaling.tabor_number(0.4e-6, 2.3e9 * ratio, scaling.surface_energy_mod(0.06, ratio))
    assert after / before == pytest.approx(scaling.tabor_factor(ratio), rel=1e-12)


def test_a_stiff_small_sphere_is_warned_of_and_a_soft_one_is_not():
    assert scaling.tabor_warning(0.635e-6, 271e6, 0.11) is None
    assert "between JKR and DMT" in scaling.tabor_warning(1.5e-6, 31.7e9, 0.03)
    assert "the DMT range" in scaling.tabor_warning(5e-9, 300e9, 0.01)


def test_without_surface_energy_there_is_nothing_to_warn_of():
    assert scaling.tabor_warning(0.4e-6, 70e9, 0.0) is None


@given(ratio=st.floats(math.log(1e-6), 0.0).map(math.exp))
def test_smallest_modulus_ratio_keeps_just_the_share_of_the_force(ratio):
    assert scaling.smallest_modulus_ratio(scaling.force_factor(ratio)) == pytest.approx(ratio, rel=1e-12)
