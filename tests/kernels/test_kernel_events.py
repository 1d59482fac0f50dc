"""Kernels of the steps in which a contact is made or broken.

Weights against the Hurwitz zeta function, instants against motion.

The generalised Euler-Maclaurin formula gives the first sample of t^p, theta of a step after the event, the weight
-zeta(-p, 1 + theta)/theta^p; the kernels carry polynomial fits of -zeta(-p, 1 + theta).
"""

from __future__ import annotations

import math

import kernels
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf, workdps

FIT = 3e-7  # what the header states of its fits
PARABOLA = 1e-13  # a square root and three sums, the root written without cancellation
DIGITS = 30


@pytest.mark.parametrize(
    ("weight", "power"), [(kernels.quarter_power_weight, "0.25"), (kernels.square_root_weight, "0.5")]
)
def test_weight_is_minus_the_hurwitz_zeta_function(weight, power: str) -> None:
    with workdps(DIGITS):
        for theta in np.linspace(0.0, 1.0, 41):
            assert abs(weight(theta) + mp.zeta(-mpf(power), 1 + mpf(float(theta)))) <= FIT


@pytest.mark.parametrize(("weight", "power"), [(kernels.quarter_power_weight, 0.25), (kernels.square_root_weight, 0.5)])
def test_weighted_sum_integrates_a_power_that_begins_within_a_step(weight, power: float) -> None:
    # integral of t^p over [0, T], samples at theta h, theta h + h, ..., the last one half: what the plain sum loses
    # is O(h^(1+p))
    for theta in (0.07, 0.42, 0.93):
        for steps in (20, 200):
            t = theta + np.arange(steps)
            whole = t[-1] ** (power + 1) / (power + 1)
            total = weight(theta) + np.sum(t[1:-1] ** power) + 0.5 * t[-1] ** power
            # next term of the formula at the far end: p T^(p-1)/12, then p (p-1)(p-2) T^(p-3)/720
            end = power * t[-1] ** (power - 1) / 12
            assert total - end == pytest.approx(
                whole, abs=FIT + abs(power * (power - 1) * (power - 2)) * t[-1] ** (power - 3) / 360
            )


@given(
    st.floats(1e-3, 0.999),
    st.floats(-24.0, 3.0).map(math.exp),
    st.floats(-16.0, -3.0).map(math.exp),
    st.floats(-0.9, 30.0),
)
@settings(max_examples=200, deadline=None)
def test_fraction_before_break_is_the_root_of_the_parabola(
    theta: float, speed: float, time_step: float, bend: float
) -> None:
    # x(tau) = start tau + (bend/2) tau^2 in steps, pulled with `bend` = A/start (> 0 here means faster and faster)
    mass, start = 3.1e-14, speed * time_step
    acceleration = bend * start
    if 1.0 + bend <= 0.0:
        return
    left = start * theta + 0.5 * acceleration * theta**2
    separated = start + 0.5 * acceleration
    breaking_overlap = -2.7 * separated
    previous = breaking_overlap + left
    got = kernels.fraction_before_break(
        previous - separated, previous, time_step, breaking_overlap, acceleration * mass / time_step**2, mass
    )
    # the kernel sees left = previous - breaking_overlap: rounding of the two overlaps, and the root's slope start + A
    # theta
    explained = 2.0**-51 * abs(breaking_overlap) / abs(start + acceleration * theta)
    with workdps(DIGITS):
        s, bent, rest = (mpf(x) for x in (start, acceleration, left))
        exact = 2 * rest / (s + mp.sqrt(s * s + 2 * bent * rest))
    assert got == pytest.approx(float(exact), abs=PARABOLA + 8 * explained)


def test_fraction_before_break_of_a_straight_path_is_the_linear_one() -> None:
    assert kernels.fraction_before_break(-7.3e-9, -2.1e-9, 3e-10, -5.4e-9, 0.0, 4e-15) == pytest.approx(
        3.3 / 5.2, rel=PARABOLA
    )


@pytest.mark.parametrize(
    ("overlap", "previous", "breaking", "fraction"),
    [(-3e-9, 2e-9, 2e-9, 0.0), (-3e-9, 1e-9, 2e-9, 0.0), (4e-9, 2e-9, -5e-9, 0.0), (-3e-9, 2e-9, -7e-9, 1.0)],
)
def test_fraction_before_break_stays_between_0_and_1_out_of_its_range(
    overlap: float, previous: float, breaking: float, fraction: float
) -> None:
    assert kernels.fraction_before_break(overlap, previous, 6e-10, breaking, -8e-19, 9e-15) == fraction
