"""The inversion: what it finds again, how sure it is, and what it says it cannot know."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from pyjkr.calibrate import CalibrationError, Measurements, Particle, fit
from pyjkr.calibrate.collision import collision
from pyjkr.calibrate.particle import chen_group, similarity_group
from pyjkr.oracle import NormalContact, impact, sticking_speed

LAWS = ("jkr", "jkr/simplified")
# Dahneke's sphere with the fit of Krijt 2013: Haervig 2017, caption of fig. 5.
RADIUS, DENSITY, MODULUS, ENERGY, E = 0.635e-6, 1026.0, 271e6, 0.11, 0.86
PARTICLE = Particle(radius=RADIUS, density=DENSITY, effective_modulus=MODULUS, effective_modulus_mod=0.03 * MODULUS)
GROUP = similarity_group(ENERGY, MODULUS)
INTERPOLATION = 1e-5  # of e_eff^2 in the table
NOISE, SEEDS = 0.02, 20


def exact(law: str, ratios, particle: Particle = PARTICLE) -> Measurements:
    """Points integrated by the oracle, at speeds over the sticking speed."""
    contact = NormalContact(particle.effective_radius, MODULUS, ENERGY, law, E)
    speeds = sticking_speed(contact, particle.effective_mass) * np.asarray(ratios)
    found = [impact(contact, particle.effective_mass, v, samples=2, stuck_periods=0.01).restitution for v in speeds.tolist()]
    return Measurements(speeds, np.array(found))


def noisy(law: str, seed: int, *, low=0.7, high=8.0, count=20, stated=False, relative=False) -> Measurements:
    model = collision(law)
    ratios = np.geomspace(low, high, count)
    true = model.restitution(ratios, E)
    sigma = NOISE * (true if relative else 1.0)
    measured = np.where(true > 0, np.clip(true + sigma * np.random.default_rng(seed).standard_normal(count), 0, 1), 0.0)
    speeds = ratios * PARTICLE.speed_unit(GROUP) * float(model.sticking_ratio(E))
    return Measurements(speeds, measured, np.full(count, NOISE) if stated else None)


def held(found, e=E, group=GROUP) -> bool:
    pairs = ((found.restitution_coefficient, e), (found.group, group))
    return all(estimate.lower <= true <= estimate.upper for estimate, true in pairs)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("target", ["wall", "sphere"])
def test_two_points_of_the_oracle_give_the_parameters_back(law, target):
    particle = Particle(radius=RADIUS, density=DENSITY, target=target, effective_modulus=MODULUS, effective_modulus_mod=8.1e6)
    found = fit(exact(law, [1.4, 12.0], particle), particle, law)
    assert found.restitution_coefficient.value == pytest.approx(E, abs=INTERPOLATION)
    assert found.group.value == pytest.approx(GROUP, rel=INTERPOLATION)
    assert found.surface_energy.value == pytest.approx(ENERGY, rel=INTERPOLATION)
    assert found.surface_energy_mod.value == pytest.approx(ENERGY * (8.1e6 / MODULUS) ** 0.4, rel=INTERPOLATION)  # Chen 2019 eq. 10
    assert found.alpha.value == pytest.approx(5**0.5 * found.damping_ratio.value)
    assert found.group.lower is None and "no uncertainty" in " ".join(found.warnings)


@pytest.mark.parametrize("law, kind", [("jkr", {}), ("jkr", {"relative": True}), ("jkr", {"stated": True}), ("jkr/simplified", {})])
def test_noise_of_two_per_cent_leaves_both_parameters_inside_their_intervals(law, kind):
    assert [seed for seed in range(SEEDS) if not held(fit(noisy(law, seed, **kind), PARTICLE, law))] == []


def test_intervals_hold_both_parameters_as_often_as_they_say():
    sets, confidence = 40, 0.9
    count = sum(held(fit(noisy("jkr", 1000 + seed, count=8, low=1.05), PARTICLE, confidence=confidence)) for seed in range(sets))
    # fewer than this has a probability below 0.5 % where the joint coverage is as stated
    assert count >= stats.binom.ppf(0.005, sets, confidence)


def test_intervals_are_no_wider_than_the_linear_ones_need():
    """Far from the threshold the region is an ellipse: its extent is sqrt(chi2(2)) standard errors of the Jacobian."""
    data = noisy("jkr", 5, low=1.3, stated=True)
    found, model = fit(data, PARTICLE, confidence=0.95), collision("jkr")

    def curve(e, ln_sticking):
        return model.restitution(data.speed / np.exp(ln_sticking), e)

    best, h = (found.restitution_coefficient.value, float(np.log(found.sticking_speed.value))), 1e-5
    columns = [(curve(best[0] + h, best[1]) - curve(best[0] - h, best[1])) / (2 * h)]
    columns.append((curve(best[0], best[1] + h) - curve(best[0], best[1] - h)) / (2 * h))
    jacobian = np.column_stack(columns) / NOISE
    error = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    width = found.restitution_coefficient.upper - found.restitution_coefficient.lower
    assert width == pytest.approx(2 * np.sqrt(stats.chi2.ppf(0.95, 2)) * error[0], rel=0.1)  # one cell of a 121-node grid, curvature


def test_interval_of_a_long_thin_region_is_that_of_the_profile():
    """Near the threshold the region is a thin bow; a scan over ln v_s at each e, far finer, is the other way to its extent."""
    data = noisy("jkr", 4, low=1.02, high=1.3, count=6, stated=True)
    found, model = fit(data, PARTICLE, confidence=0.99), collision("jkr")
    limit = found.chi_square + stats.chi2.ppf(0.99, 2)
    sticking = np.linspace(0.9, 1.0, 3001) * data.speed[0]

    def inside(e):
        residuals = (model.restitution(data.speed[:, None] / sticking, e) - data.restitution[:, None]) / NOISE
        return (residuals**2).sum(axis=0).min() <= limit

    inner = np.array([e for e in np.arange(0.7, 0.998, 0.001) if inside(e)])
    estimate = found.restitution_coefficient
    cell = (inner[-1] - inner[0]) / 60  # twice that of the grid: the region fills more than half of its frame
    assert inner[0] - 2 * cell - 1e-3 <= estimate.lower <= inner[0]
    assert inner[-1] <= estimate.upper <= inner[-1] + 2 * cell + 1e-3


def test_spheres_that_stuck_narrow_the_interval_of_the_adhesion():
    data = noisy("jkr", 2, low=0.95, count=9)
    data = Measurements(data.speed, data.restitution, np.full(9, 0.1))
    moved = data.restitution > 0
    without = Measurements(data.speed[moved], data.restitution[moved], data.standard_deviation[moved])
    assert not moved.all()
    with_stuck, alone = (fit(each, PARTICLE) for each in (data, without))
    assert with_stuck.group.lower > 1.05 * alone.group.lower
    assert held(with_stuck)


def test_points_on_the_plateau_bound_the_adhesion_from_above_only():
    found = fit(noisy("jkr", 3, low=40, high=400, count=8), PARTICLE)
    assert found.group.lower == 0 and found.sticking_speed.lower == 0 and found.group.upper > GROUP
    assert held(found)
    assert any("only bounded above" in warning for warning in found.warnings)


def test_points_near_sticking_tell_little_about_damping():
    found = fit(noisy("jkr", 4, low=1.02, high=1.12, count=6, stated=True), PARTICLE)
    assert found.restitution_coefficient.upper - found.restitution_coefficient.lower > 0.1
    assert held(found)
    assert any("damping is poorly known" in warning for warning in found.warnings)


def test_speeds_in_other_units_scale_the_group_and_are_doubted():
    data = noisy("jkr", 6)
    found, thousandfold = fit(data, PARTICLE), fit(Measurements(1000 * data.speed, data.restitution), PARTICLE)
    assert thousandfold.group.value == pytest.approx(1000**1.2 * found.group.value, rel=1e-6)  # v_*^2 goes as group^(5/3)
    assert thousandfold.restitution_coefficient.value == pytest.approx(found.restitution_coefficient.value, abs=1e-8)
    assert found.warnings == ()
    assert sum("unit" in warning or "m/s?" in warning for warning in thousandfold.warnings) >= 2
    slow = fit(Measurements(1e-5 * data.speed, data.restitution), PARTICLE)
    assert any("units" in warning for warning in slow.warnings)


def test_standard_deviations_that_are_too_small_widen_the_intervals_and_are_named():
    data = noisy("jkr", 7, stated=True)
    honest = fit(data, PARTICLE)
    bold = fit(Measurements(data.speed, data.restitution, data.standard_deviation / 10), PARTICLE)
    assert any("farther from the curve" in warning for warning in bold.warnings)
    width, wanted = (each.group.upper - each.group.lower for each in (bold, honest))
    assert width > 0.6 * wanted


def test_a_restitution_that_falls_at_high_speed_is_called_plastic():
    data = noisy("jkr", 8, low=1.2)
    fall = np.where(data.speed > data.speed[8], (data.speed / data.speed[8]) ** -0.25, 1.0)
    assert any("plastic" in warning for warning in fit(Measurements(data.speed, data.restitution * fall), PARTICLE).warnings)
    assert not any("plastic" in warning for warning in fit(data, PARTICLE).warnings)


def test_a_blurred_threshold_is_named():
    data = noisy("jkr", 9, low=1.05)
    restitution = data.restitution.copy()
    restitution[3] = 0.0
    assert any("blurred" in warning for warning in fit(Measurements(data.speed, restitution), PARTICLE).warnings)


def test_two_points_that_no_curve_meets_are_named():
    found = fit(Measurements(np.array([1.0, 2.0]), np.array([0.8, 0.3])), PARTICLE)
    assert any("no curve" in warning for warning in found.warnings)


def test_band_holds_the_true_curve_and_the_best_one():
    found = fit(noisy("jkr", 10), PARTICLE)
    speeds = np.geomspace(0.8, 20, 200) * found.sticking_speed.value
    best, lower, upper = found.curve(speeds)
    model = collision("jkr")
    true = model.restitution(speeds / (PARTICLE.speed_unit(GROUP) * model.sticking_ratio(E)), E)
    assert np.all(lower <= best) and np.all(best <= upper)
    assert np.all(lower <= true) and np.all(true <= upper)
    assert (upper - lower).max() < 0.3


def test_group_of_chen_is_that_of_its_definition():
    speed, mass = 3.1, 4 / 3 * np.pi * RADIUS**3 * DENSITY
    pull_off, zero_load = 3 * np.pi * RADIUS * ENERGY, (9 * np.pi * ENERGY * RADIUS**2 / MODULUS) ** (1 / 3)
    adhesion, elasticity = ENERGY / (DENSITY * speed**2 * RADIUS), MODULUS / (DENSITY * speed**2)
    unit = (pull_off * zero_load**2 / (RADIUS * mass)) ** 0.5
    assert PARTICLE.speed_unit(GROUP) == pytest.approx(unit, rel=1e-13)
    assert PARTICLE.group(unit) == pytest.approx(GROUP, rel=1e-13)
    assert chen_group(speed / unit) == pytest.approx((adhesion * elasticity**-0.4) ** (-5 / 6), rel=1e-13)


@pytest.mark.parametrize("confidence", [0.0, 1.0, 95])
def test_a_confidence_that_is_none_is_refused(confidence):
    with pytest.raises(CalibrationError, match="between 0 and 1"):
        fit(noisy("jkr", 0), PARTICLE, confidence=confidence)


def test_an_unknown_law_is_refused():
    with pytest.raises(CalibrationError, match="jkr/simplified"):
        fit(noisy("jkr", 0), PARTICLE, "dmt")
