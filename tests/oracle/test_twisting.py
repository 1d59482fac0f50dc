"""Twisting law of the oracle: values, slopes, limit, energy."""

import numpy as np
import pytest

from pyjkr.oracle import NormalContact, contact_radius, pull_off_force
from pyjkr.oracle.tangential import resistance, returned_displacement, sliding
from pyjkr.oracle.twisting import twisting, twisting_rate

RADIUS, MODULUS, SHEAR, ENERGY, MASS, FRICTION, OVERLAP = 0.83e-6, 3.8e9, 1.1e9, 0.052, 2.3e-15, 0.37, 2.7e-9
ROUND_OFF = 1e-13


def sliders(model: str, overlap: float = OVERLAP, energy: float = ENERGY, ratio: float = 1.3):
    contact = NormalContact(RADIUS, MODULUS, energy, model, 0.7)
    slider = sliding(contact, SHEAR, FRICTION, pull_off_force(contact), MASS, overlap)
    return contact, slider, twisting(contact, slider, overlap, ratio)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_spring_dashpot_and_limit_come_from_sliding_and_the_contact_radius(model):
    contact, slider, twist = sliders(model)
    a = contact_radius(contact, OVERLAP)
    assert twist.stiffness == pytest.approx(slider.stiffness * a**2 / 2, rel=ROUND_OFF)
    assert twist.dashpot == pytest.approx(slider.dashpot * a**2 / 2, rel=ROUND_OFF)
    assert twist.limit == pytest.approx(2 / 3 * 1.3 * a * slider.limit, rel=ROUND_OFF)


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_slopes_are_derivatives(model):
    step = 1e-4 * OVERLAP
    twist, above, below = sliders(model)[2], sliders(model, OVERLAP + step)[2], sliders(model, OVERLAP - step)[2]
    for name in ("stiffness", "limit"):
        difference = (getattr(above, name) - getattr(below, name)) / (2 * step)
        assert getattr(twist, f"{name}_slope") == pytest.approx(difference, rel=1e-7)  # central difference of step 1e-4


def test_without_surface_energy_nothing_resists_twisting():
    twist = sliders("jkr", energy=0.0)[2]
    assert twist.stiffness == 0.0 and twist.dashpot == 0.0 and twist.limit == 0.0


def test_a_closed_twisting_cycle_loses_what_the_hysteresis_loop_encloses():
    twist = sliders("jkr")[2]
    elastic = float(twist.limit / twist.stiffness)
    angle, work = np.zeros(1), 0.0
    for step in np.diff(5 * elastic * np.sin(np.linspace(0, 2 * np.pi, 801))):
        angle = returned_displacement(twist, angle + step)
        work += float(resistance(twist, angle, np.zeros(1))[0]) * step
    # Slips 4, 8 and 3 elastic angles on the three strokes and ends with the spring full: 15 + 1/2.
    assert work == pytest.approx(
        15.5 * twist.limit * elastic, rel=1e-2
    )  # end-point rule, steps of 4 % of the elastic angle


def test_twisting_rate_is_the_relative_spin_about_the_normal():
    n = np.array([0.6, 0.0, 0.8])
    assert twisting_rate(np.array([3.0, 7.0, -1.0]), np.array([0.5, -2.0, 4.0]), n) == pytest.approx(
        [0.6 * 2.5 - 0.8 * 5.0]
    )
