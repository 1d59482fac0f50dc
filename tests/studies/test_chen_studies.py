"""Studies of Chen, Liu, Li 2019, figs 2 to 7: their points evaluated small, and that their checks can fail."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from pyjkr.studies import calibration, chen_restitution, critical_rolling_force, polystyrene, restitution_contours


def table_of(study, settings, directory, engines=("oracle", "liggghts", "table")):
    """The rows of all points, as they come back from a file."""
    rows = []
    for number, point in enumerate(study.points(settings)):
        if point["engine"] in engines:
            place = directory / str(number)
            place.mkdir()
            rows += study.evaluate(json.loads(json.dumps(point)), place)
    path = directory / "table.csv"
    pd.DataFrame(rows).to_csv(path, index=False)
    return pd.read_csv(path)


def broken(checks):
    return [check.name for check in checks if not check.holds]


@pytest.fixture(scope="module")
def restitution(plugin, tmp_path_factory):
    settings = chen_restitution.Settings(speeds=(1.1, 1.5, 4.0), modulus_ratios=(1.0, 0.026), steps_per_collision=400, curve_points=5)
    return settings, table_of(chen_restitution, settings, tmp_path_factory.mktemp("restitution"))


@pytest.mark.liggghts
def test_corrected_surface_energy_keeps_the_rebound_and_stretches_the_time(restitution):
    settings, table = restitution
    assert broken(chen_restitution.checks(table, settings)) == []
    figures = chen_restitution.figures(table, settings)
    assert set(figures) == {"restitution_reduced", "restitution_corrected"}


@pytest.mark.liggghts
def test_checks_of_the_restitution_see_a_wrong_exponent_and_a_wrong_time(restitution):
    settings, table = restitution
    soft = (table["rule"] == "scaled") & (table["modulus_ratio"] != 1)
    wrong = table.copy()
    wrong.loc[soft, ["e_eff", "e_eff_oracle"]] += 0.003
    assert sum("eq. 10" in name for name in broken(chen_restitution.checks(wrong, settings))) == 2
    wrong = table.copy()
    wrong.loc[soft, "contact_time"] *= 1.002
    assert any("collision time" in name for name in broken(chen_restitution.checks(wrong, settings)))


@pytest.mark.liggghts
def test_spheres_in_liggghts_roll_at_the_closed_form_of_the_critical_force(plugin, tmp_path):
    settings = critical_rolling_force.Settings(radii=(5e-6, 15e-6), measured_radii=(5e-6,), measured_displacements=(42e-9,))
    table = table_of(critical_rolling_force, settings, tmp_path)
    assert broken(critical_rolling_force.checks(table, settings)) == []
    assert "critical_rolling_force" in critical_rolling_force.figures(table, settings)
    wrong = table.copy()
    wrong.loc[wrong["variant"] == "corrected", ["held_force", "rolling_force"]] *= settings.modulus_ratio**0.4  # without eq. 11
    assert len(broken(critical_rolling_force.checks(wrong, settings))) == 2


def test_critical_force_is_that_of_both_papers():
    settings = critical_rolling_force.Settings()
    radius, gamma = 10e-6, 0.05
    assert critical_rolling_force.predicted("original", radius, settings) == pytest.approx(12 * np.pi * gamma * radius * 0.0084)
    zero_load = (9 * np.pi * gamma * 5e-6**2 / 3.8e9) ** (1 / 3)
    krijt = np.pi * zero_load * settings.adhesion_hysteresis * gamma  # Krijt 2014: M_crit = pi R a_0 dgamma, over r
    assert critical_rolling_force.predicted("krijt", 5e-6, settings) == pytest.approx(krijt)


def test_particles_of_one_group_rebound_alike_and_the_map_agrees(tmp_path):
    settings = restitution_contours.Settings(alphas=(0.1, 0.7), groups=(10.0, 60.0), nodes=40)
    table = table_of(restitution_contours, settings, tmp_path)
    assert broken(restitution_contours.checks(table, settings)) == []
    assert "restitution_contours" in restitution_contours.figures(table, settings)
    wrong = table.copy()
    wrong.loc[wrong["particle"] == 1, "e_eff"] += 1e-8
    assert any("one group" in name for name in broken(restitution_contours.checks(wrong, settings)))


@pytest.mark.liggghts
def test_two_points_give_back_the_group_of_polystyrene_and_the_curve_at_reduced_stiffness(plugin, tmp_path):
    settings = calibration.Settings(speeds=(1.3, 4.0), steps_per_collision=400, seeds=20, confidences=(0.99,))
    table = table_of(calibration, settings, tmp_path)
    assert broken(calibration.checks(table, settings)) == []
    assert table[table["kind"] == "two"]["group"].iloc[0] == pytest.approx(7.36e-6, rel=1e-3)  # 0.05 J/m2 and 3.8 GPa, three digits
    assert "calibration" in calibration.figures(table, settings)
    wrong = table.copy()
    wrong.loc[wrong["kind"] == "noisy", "group_held"] = False
    assert len(broken(calibration.checks(wrong, settings))) == 4


def test_settings_refuse_what_they_do_not_know():
    for study in (chen_restitution, critical_rolling_force, restitution_contours, calibration):
        with pytest.raises(ValueError, match="Extra inputs"):
            study.Settings(colour="red")
    with pytest.raises(ValueError, match="differ in length"):
        critical_rolling_force.Settings(measured_radii=(1e-6,))


def test_scene_of_the_sphere_has_the_stiffness_it_is_given():
    scene = polystyrene.impact_on_wall(polystyrene.Sphere(effective_modulus=2e8), 3.0, 0.7, "jkr", 100)
    assert scene.meeting.effective_modulus == 2e8 and scene.model.tangential == "off"
