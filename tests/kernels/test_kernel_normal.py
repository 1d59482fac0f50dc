"""Kernel of the normal law against JKR evaluated in mpmath with 40 digits.

Reference: overlap(a) = a^2/R - 2 sqrt(pi gamma a/E) and F(a) = 4 E a^3/(3 R) - 4 sqrt(pi gamma E a^3) (Haervig 2017
eqs 8 to 10), the root a(overlap) enclosed by a change of sign. The kernel is handed doubles; the reference takes them
as exact.
"""

from __future__ import annotations

import math

import kernels
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from kernels import Contact
from mpmath import mp, mpf, workdps
from scipy.integrate import quad

DIGITS = 40
CLOSED_FORM = 1e-12  # of max(|F|, F_C): what the kernel promises
# Roundings between an overlap and u, in units of 2^-52: a_1 carries two cube roots (one each, R's counted twice for its
# square), their arguments and two products, 5 in all; squared 10; then times R and a division, half each, and one to
# spare.
ROUNDINGS = 12
EPSILON = 2.0**-52
NEXT_TO_RUPTURE = 1e-10  # the root is nearly double there: its own error, beyond the rounding of the overlap
HERTZ = 8 * EPSILON  # three products and a square root in another order
SCALED = 60 * EPSILON  # two evaluations, six roundings of changed inputs each, exponents up to 3
QUADRATURE = 1e-9  # scipy.quad, smooth integrand
DIFFERENCE = (
    2e-8  # central difference: h^2 of the third derivative against round-off/h, h = 1e-4 of the energy's own scale
)

GLASS = Contact(radius=2.3e-6, modulus=5.9e9, energy=0.037)


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


RADII = log_uniform(1e-9, 1e-3)
MODULI = log_uniform(1e5, 1e11)
ENERGIES = st.one_of(st.just(1e-12), st.just(10.0), log_uniform(1e-12, 10.0))
OVERLAPS = log_uniform(1e-12, 0.5)  # of R


class Reference:
    """JKR of one contact with 40 digits."""

    def __init__(self, contact: Contact):
        with workdps(DIGITS):
            self.R, self.E, self.g = mpf(contact.radius), mpf(contact.modulus), mpf(contact.energy)
            self.pull_off = 3 * mp.pi * self.R * self.g
            # a where d(overlap)/da = 0: 2 a/R = sqrt(pi gamma/(E a))
            self.a_rupture = mp.cbrt(mp.pi * self.g * self.R**2 / (4 * self.E))
            self.rupture = self.overlap(self.a_rupture)

    def overlap(self, a: mpf) -> mpf:
        return a**2 / self.R - 2 * mp.sqrt(mp.pi * self.g * a / self.E)

    def force(self, a: mpf) -> mpf:
        return 4 * self.E * a**3 / (3 * self.R) - 4 * mp.sqrt(mp.pi * self.g * self.E * a**3)

    def contact_radius(self, overlap: object) -> mpf:
        """Largest root, enclosed.

        Overlap(a) rises from a_rupture on, and the enclosing interval is tested for its change of sign.
        """
        d = mpf(overlap)
        if d <= self.rupture:
            return self.a_rupture
        # sqrt(a): convex quartic, Newton from the right descends to the largest root
        c = 2 * mp.sqrt(mp.pi * self.g / self.E) * self.R
        b = mp.sqrt(self.a_rupture) + mp.root(max(d, 0) * self.R, 4) + mp.cbrt(c)
        for _ in range(400):
            step = (b**4 - c * b - d * self.R) / (4 * b**3 - c)
            b -= step
            if abs(step) < b * mpf(10) ** (3 - DIGITS):
                break
        a = b * b
        margin = mpf(10) ** (-20)
        assert self.overlap(a * (1 + margin)) > d
        low = max(a * (1 - margin), self.a_rupture)
        assert self.overlap(low) < d
        return a

    def at(self, overlap: object) -> tuple[mpf, mpf]:
        a = self.contact_radius(overlap)
        return a, self.force(a)


def allowance(reference: Reference, overlap: float, exact: mpf, promise: float = CLOSED_FORM) -> mpf:
    """promise * max(|F|, F_C) plus the change of F for a few roundings of the overlap: |F(d (1 +- k eps)) - F(d)|."""
    nudge = mpf(ROUNDINGS) * EPSILON
    moved = max(abs(reference.at(mpf(overlap) * (1 + s * nudge))[1] - exact) for s in (1, -1))
    return promise * max(abs(exact), reference.pull_off) + moved


@given(RADII, MODULI, ENERGIES, OVERLAPS)
@example(1e-9, 1e5, 10.0, 1e-12)
@example(1e-3, 1e11, 1e-12, 0.5)
@example(1e-9, 1e11, 10.0, 0.1)
@example(1e-3, 1e5, 1e-12, 1e-12)
@settings(max_examples=200, deadline=None)
def test_force_is_the_closed_form_to_1e_12_for_pressed_surfaces(
    radius: float, modulus: float, energy: float, strain: float
) -> None:
    contact = Contact(radius, modulus, energy)
    overlap = strain * radius
    got = kernels.normal(contact, overlap)
    with workdps(DIGITS):
        reference = Reference(contact)
        a, exact = reference.at(overlap)
        # no allowance for rounding: the law is well conditioned here
        assert abs(mpf(float(got.force[0])) - exact) <= CLOSED_FORM * max(abs(exact), reference.pull_off)
        assert abs(mpf(float(got.contact_radius[0])) / a - 1) <= CLOSED_FORM


@given(RADII, MODULI, ENERGIES, st.floats(0.0, 1.0))
@settings(max_examples=150, deadline=None)
def test_force_is_the_closed_form_in_the_neck(radius: float, modulus: float, energy: float, stretch: float) -> None:
    contact = Contact(radius, modulus, energy)
    overlap = stretch * kernels.rupture_overlap(contact)
    got = kernels.force(contact, overlap)
    with workdps(DIGITS):
        reference = Reference(contact)
        _, exact = reference.at(overlap)
        assert abs(mpf(got) - exact) <= allowance(reference, overlap, exact)


@given(RADII, MODULI, ENERGIES, log_uniform(1e-16, 1e-3))
@settings(max_examples=150, deadline=None)
def test_force_next_to_rupture_errs_by_the_rounding_of_the_overlap_alone(
    radius: float, modulus: float, energy: float, left: float
) -> None:
    contact = Contact(radius, modulus, energy)
    overlap = (1.0 - left) * kernels.rupture_overlap(contact)
    got = kernels.force(contact, overlap)
    with workdps(DIGITS):
        reference = Reference(contact)
        _, exact = reference.at(overlap)
        assert abs(mpf(got) - exact) <= allowance(reference, overlap, exact, NEXT_TO_RUPTURE)


@pytest.mark.parametrize(
    "left", [0.0, 1e-15, 1e-13, 1e-10, 1e-7, 1e-4, 1e-2, 0.3, 0.47247, 0.9, 3.7, 2.9e3, 1.7e9, 3.3e20]
)
def test_root_keeps_its_distance_from_the_double_root_to_round_off(left: float) -> None:
    reduced = -0.47247039371057743679 + left
    with workdps(DIGITS):
        # the root of that double, not of what was meant
        critical = mpf(4) ** (-mpf(1) / 3)
        square = max(mpf(reduced) - (critical**4 - critical), mpf(0))
        w = mp.sqrt(square) + mp.root(square, 4)
        for _ in range(300 if square else 0):
            w -= (w**2 * (w**2 + 4 * critical * w + 6 * critical**2) - square) / (
                4 * w**3 + 12 * critical * w**2 + 12 * critical**2 * w
            )
        # the constant D_c is a double too: half an ulp of it is the least that t^2 = D - D_c can err, and w =
        # t/(sqrt(6) u_c)
        rounding = mpf(2) ** -55
        explained = (mp.sqrt(square + rounding) - mp.sqrt(max(square - rounding, 0))) / (mp.sqrt(6) * critical)
        assert abs(mpf(kernels.contact_radius_root(reduced)) - (critical + w)) <= explained + 2 * EPSILON * (
            critical + w
        )


def test_pull_off_is_the_lowest_point_of_the_curve_and_minus_three_pi_r_gamma() -> None:
    pull_off = 3 * math.pi * GLASS.radius * GLASS.energy
    rupture = kernels.rupture_overlap(GLASS)
    overlaps = np.linspace(rupture, -0.3 * rupture, 20_001)
    curve = kernels.normal(GLASS, overlaps).force
    assert curve.min() >= -pull_off * (1 + HERTZ)
    # F_min at a = 2^(-2/3) a_0 and so at -3^(-2/3) of delta_C (load control: 9^(1/3) times smaller)
    at = rupture / 9 ** (1 / 3)
    assert kernels.force(GLASS, at) == pytest.approx(-pull_off, rel=HERTZ)
    assert overlaps[curve.argmin()] == pytest.approx(at, abs=overlaps[1] - overlaps[0])


@given(RADII, MODULI, ENERGIES)
@settings(max_examples=100, deadline=None)
def test_curve_passes_its_four_known_points(radius: float, modulus: float, energy: float) -> None:
    contact = Contact(radius, modulus, energy)
    pull_off = 3 * math.pi * radius * energy
    with workdps(DIGITS):
        a0 = mp.cbrt(9 * mp.pi * mpf(energy) * mpf(radius) ** 2 / mpf(modulus))
        rupture = -float(a0**2 / (2 * mp.cbrt(6) * mpf(radius)))
        equilibrium = float(a0**2 / (3 * mpf(radius)))
        a0 = float(a0)
    assert kernels.rupture_overlap(contact) == pytest.approx(rupture, rel=ROUNDINGS * EPSILON)
    zero, settled, snap = (
        kernels.normal(contact, x) for x in (0.0, equilibrium, 2.0 * kernels.rupture_overlap(contact))
    )
    assert zero.force[0] == pytest.approx(-8 / 9 * pull_off, rel=2 * HERTZ)
    assert zero.contact_radius[0] == pytest.approx((2 / 3) ** (2 / 3) * a0, rel=HERTZ)
    # the overlap is rounded: F = 3.6 F_C R/a_0^2 d(overlap) = 1.2 F_C times the relative rounding
    assert abs(settled.force[0]) <= 1.2 * ROUNDINGS * EPSILON * pull_off * 2
    assert settled.contact_radius[0] == pytest.approx(a0, rel=HERTZ)
    # past the rupture by round-off of the overlap the neck is taken to be at it
    assert snap.force[0] == pytest.approx(-5 / 9 * pull_off, rel=2 * HERTZ)
    assert snap.contact_radius[0] == pytest.approx(6 ** (-2 / 3) * a0, rel=HERTZ)


@given(RADII, MODULI, OVERLAPS)
@settings(max_examples=100, deadline=None)
def test_without_surface_energy_the_force_is_hertz_to_round_off(radius: float, modulus: float, strain: float) -> None:
    contact = Contact(radius, modulus, 0.0)
    overlap = strain * radius
    got = kernels.normal(contact, overlap)
    with workdps(DIGITS):
        hertz = float(mpf(4) / 3 * mpf(modulus) * mp.sqrt(mpf(radius) * mpf(overlap) ** 3))
    assert got.force[0] == pytest.approx(hertz, rel=HERTZ)
    assert got.contact_radius[0] == pytest.approx(math.sqrt(radius * overlap), rel=HERTZ)


@given(RADII, MODULI, OVERLAPS)
@settings(max_examples=100, deadline=None)
def test_force_goes_to_hertz_as_surface_energy_goes_to_zero(radius: float, modulus: float, strain: float) -> None:
    overlap = strain * radius
    hertz = kernels.force(Contact(radius, modulus, 0.0), overlap)
    # a grows by what adhesion adds, F falls by 4 sqrt(pi gamma E a^3): bounded by 8 such terms and, where they
    # vanish, 8 F_C
    for energy in (3e-20, 7e-40, 2e-80, 6e-160):
        a = math.sqrt(radius * overlap)
        leading = 4 * math.sqrt(math.pi * energy) * math.sqrt(modulus * a**3)
        got = kernels.force(Contact(radius, modulus, energy), overlap)
        assert abs(got - hertz) <= 8 * leading + CLOSED_FORM * hertz + 24 * math.pi * radius * energy


@pytest.mark.parametrize("energy", [3e-220, 7e-260, 5e-300, 5e-324])
def test_surface_energies_down_to_the_smallest_double_give_a_finite_force(energy: float) -> None:
    overlap = 0.13 * GLASS.radius
    hertz = kernels.force(Contact(GLASS.radius, GLASS.modulus, 0.0), overlap)
    # 5e-324 is one bit: adhesion is lost in it, but Hertz must be left
    assert kernels.force(Contact(GLASS.radius, GLASS.modulus, energy), overlap) == pytest.approx(hertz, rel=CLOSED_FORM)


@given(RADII, MODULI, ENERGIES)
@settings(max_examples=60, deadline=None)
def test_contact_radius_and_stiffness_grow_along_the_whole_curve(radius: float, modulus: float, energy: float) -> None:
    contact = Contact(radius, modulus, energy)
    rupture = kernels.rupture_overlap(contact)
    overlaps = np.concatenate(
        [np.linspace(rupture, 0.0, 300)[:-1], np.geomspace(-1e-3 * rupture, max(0.5 * radius, -9.0 * rupture), 300)]
    )
    got = kernels.normal(contact, overlaps)
    assert np.all(np.diff(got.contact_radius) > 0.0)
    assert np.all(np.diff(got.damping) > 0.0)
    assert np.all(np.diff(got.tangential_stiffness) > 0.0)


def stored_energy(contact: Contact, contact_radius: float) -> float:
    """Elastic energy less surface energy, 0 for surfaces apart.

    Integral of F d(overlap)/da from a = 0, term by term with 40 digits.
    """
    with workdps(DIGITS):
        E, R, w, a = mpf(contact.modulus), mpf(contact.radius), 2 * mpf(contact.energy), mpf(contact_radius)  # noqa: N806
        # flat punch after Hertz: U = E (8 a^5/(15 R^2) - (4/3) a^3 (a^2/R - d)/R + a (a^2/R - d)^2) - pi w a^2
        s = mp.sqrt(mp.pi * w * a / (2 * E))
        return float(E * (mpf(8) / 15 * a**5 / R**2 - mpf(8) / 3 * a**3 * s / R + 4 * a * s**2) - mp.pi * w * a**2)


@given(RADII, MODULI, ENERGIES, st.floats(-0.95, 40.0))
@settings(max_examples=100, deadline=None)
def test_force_is_the_derivative_of_the_stored_energy(
    radius: float, modulus: float, energy: float, reduced: float
) -> None:
    # reduced overlap in units of delta_C
    contact = Contact(radius, modulus, energy)
    unit = -kernels.rupture_overlap(contact)
    h = 1e-4
    points = np.array([reduced - h, reduced, reduced + h]) * unit
    got = kernels.normal(contact, points)
    slope = (stored_energy(contact, got.contact_radius[2]) - stored_energy(contact, got.contact_radius[0])) / (
        points[2] - points[0]
    )
    pull_off = 3 * math.pi * radius * energy
    # the third derivative of the energy grows as (reduced + 1)^(-3/2) towards the rupture
    assert abs(slope - got.force[1]) <= DIFFERENCE * max(abs(got.force[1]), pull_off) * max(
        1.0, (reduced + 1.0) ** -1.5
    )


def test_work_of_a_make_and_break_cycle_is_the_known_loss() -> None:
    # pulled from first touch to the snap: 0.257413511 F_C a_0^2/R, a pure number of the law
    rupture = kernels.rupture_overlap(GLASS)
    # overlap = rupture (1 - x^2) takes the square root out of the integrand
    work = quad(
        lambda x: kernels.force(GLASS, rupture * (1 - x * x)) * 2 * x * rupture, 0.0, 1.0, epsabs=0.0, epsrel=QUADRATURE
    )[0]
    unit = -rupture * 2 * 6 ** (1 / 3) * 3 * math.pi * GLASS.radius * GLASS.energy
    assert abs(work) == pytest.approx(0.25741351095852878 * unit, rel=10 * QUADRATURE)


@given(RADII, MODULI, ENERGIES, OVERLAPS, log_uniform(1e-4, 1e7), log_uniform(1e-5, 1e6), log_uniform(1e-6, 1e8))
@settings(max_examples=100, deadline=None)
def test_other_units_give_the_same_forces(
    radius: float, modulus: float, energy: float, strain: float, length: float, mass: float, time: float
) -> None:
    contact = Contact(radius, modulus, energy)
    pressure, per_area = mass / (length * time**2), mass / time**2
    other = Contact(
        radius * length,
        modulus * pressure,
        energy * per_area,
        contact.mass * mass,
        contact.shear * pressure,
        contact.damping_ratio,
    )
    for overlap in (strain * radius, 0.4 * kernels.rupture_overlap(contact)):
        here, there = kernels.normal(contact, overlap), kernels.normal(other, overlap * length)
        scale = max(abs(here.force[0]), 3 * math.pi * radius * energy)
        assert abs(there.force[0] / (mass * length / time**2) - here.force[0]) <= SCALED * scale
        assert there.contact_radius[0] == pytest.approx(length * here.contact_radius[0], rel=SCALED)
        assert there.damping[0] == pytest.approx(mass / time * here.damping[0], rel=SCALED)
        assert there.tangential_stiffness[0] == pytest.approx(per_area * here.tangential_stiffness[0], rel=SCALED)


@given(RADII, MODULI, ENERGIES, OVERLAPS, st.floats(0.01, 0.999), log_uniform(1e-24, 1e-3), log_uniform(1e4, 1e11))
@settings(max_examples=60, deadline=None)
def test_damping_and_tangential_stiffness_are_those_of_the_contract(
    radius: float, modulus: float, energy: float, strain: float, restitution: float, mass: float, shear: float
) -> None:
    with workdps(DIGITS):
        beta = -mp.log(mpf(restitution)) / mp.sqrt(mp.log(mpf(restitution)) ** 2 + mp.pi**2)
        contact = Contact(radius, modulus, energy, mass, shear, float(beta))
        reference, beta = Reference(contact), mpf(float(beta))
        overlap = strain * radius
        simplified, full = kernels.normal(contact, overlap, full=False), kernels.normal(contact, overlap)
        hertz_radius = mp.sqrt(mpf(radius) * mpf(overlap))
        stiffness = 2 * mpf(modulus) * hertz_radius
        assert simplified.damping[0] == pytest.approx(
            float(2 * mp.sqrt(mpf(5) / 6) * beta * mp.sqrt(stiffness * mpf(mass))), rel=CLOSED_FORM
        )
        assert simplified.tangential_stiffness[0] == pytest.approx(
            float(8 * mpf(shear) * hertz_radius), rel=CLOSED_FORM
        )
        for where, got in ((overlap, full), (0.7 * kernels.rupture_overlap(contact), None)):
            got = got or kernels.normal(contact, where)
            a = reference.contact_radius(where)
            assert got.damping[0] == pytest.approx(
                float(mp.sqrt(5) * beta * mp.sqrt(mpf(mass) * mpf(4) / 3 * mpf(modulus) * a)), rel=CLOSED_FORM
            )
            assert got.tangential_stiffness[0] == pytest.approx(float(8 * mpf(shear) * a), rel=CLOSED_FORM)


def test_the_two_laws_damp_alike_where_adhesion_is_absent() -> None:
    contact = Contact(radius=3.4e-5, modulus=7.7e7, energy=0.0)
    overlaps = np.geomspace(1e-15, 1.7e-5, 50)
    simplified, full = kernels.normal(contact, overlaps, full=False), kernels.normal(contact, overlaps)
    # S_n = 2 E a and (4/3) E a: 4 (5/6) 2 = 5 (4/3)
    assert simplified.damping == pytest.approx(full.damping, rel=HERTZ)
    assert simplified.tangential_stiffness == pytest.approx(full.tangential_stiffness, rel=HERTZ)
