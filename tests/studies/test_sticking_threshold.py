"""The border between sticking and rebound: bisection, the misprint, c against the derived values, LIGGGHTS."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pyjkr.errors import SceneError
from pyjkr.oracle.impact import sticking_speed
from pyjkr.oracle.normal import NormalContact
from pyjkr.studies import sticking_threshold as study
from pyjkr.sweep import load, sweep_file

# Derived by an integration of the dimensionless collision: cases/haervig_fig12/reference.
C_HALF, C_HALF_PRINTED = 20.431886, 15.423318


def rows(settings: study.Settings, directory: Path, engine: str = "oracle") -> pd.DataFrame:
    found = []
    for number, point in enumerate(study.points(settings)):
        if point["engine"] == engine:
            found += study.evaluate(point, directory / str(number))
    return pd.DataFrame(found)


@given(st.floats(-9, 15), st.floats(-9, -1))
def test_bisection_finds_a_border_anywhere_and_to_its_tolerance(place, width):
    border, tolerance = 10.0**place, 10.0**width
    found, count = study.bisect(lambda elasticity: elasticity > border, study.START, tolerance)
    assert found / border == pytest.approx(1, abs=tolerance)
    assert count < 70


def test_c_is_that_of_the_reference_with_either_damping(tmp_path):
    settings = study.Settings(restitution_coefficients=(0.5,), adhesivenesses=(37.0,), as_printed=True, radius=2.3e-6, speed=0.7)
    table = rows(settings, tmp_path).set_index("damping")["coefficient"]
    assert table[study.CORRECTED] == pytest.approx(C_HALF, rel=5e-7)
    assert table[study.PRINTED] == pytest.approx(C_HALF_PRINTED, rel=5e-7)


def test_bisection_agrees_with_the_root_of_the_exit_energy(tmp_path):
    settings = study.Settings(restitution_coefficients=(0.7,), adhesivenesses=(120.0,))
    critical = rows(settings, tmp_path)["critical_elasticity"][0]
    modulus, energy = study._material(study.points(settings)[0], critical)
    mass = 4 / 3 * math.pi * settings.radius**3 * settings.density
    speed = sticking_speed(NormalContact(settings.radius, modulus, energy, "jkr/simplified", 0.7), mass)
    # lambda to 1e-7 at fixed Ad is a third of it in speed.
    assert speed == pytest.approx(settings.speed, rel=4e-8)


def test_the_printed_damping_is_what_the_paper_prints():
    # Nominal 0.5 with 2 (5/6): exp(-pi b/sqrt(1 - b^2)) of b = sqrt(5/6) beta(0.5) = 0.91287 * 0.215454.
    assert study.restitution_as_printed(0.5) == pytest.approx(0.5325, abs=5e-5)


def test_liggghts_finds_the_border_of_the_oracle(tmp_path, plugin):
    settings = study.Settings(
        restitution_coefficients=(0.6,),
        adhesivenesses=(210.0,),
        liggghts=study.Liggghts(restitution_coefficients=(0.6,), adhesivenesses=(210.0,), steps_per_collision=100),
    )
    table = pd.concat([rows(settings, tmp_path), rows(settings, tmp_path, "liggghts")])
    (check,) = [check for check in study.checks(table, settings) if "LIGGGHTS" in check.name]
    assert check.holds
    # A wrong law would not hold: the printed damping moves the sticking speed by 8 % at this e.
    assert check.measured < study.SPEED_TOLERANCE < 0.08


def test_checks_fail_where_the_rows_are_wrong(tmp_path):
    reference = tmp_path / "c.csv"
    reference.write_text("# derived\ne,c,c_printed\n0.5,20.431886,15.423318\n")
    settings = study.Settings.model_validate(
        {"restitution_coefficients": [0.5], "adhesivenesses": [10.0, 1000.0], "reference": str(reference)}
    )
    right = [{"engine": "oracle", "damping": study.CORRECTED, "restitution_coefficient": 0.5, "adhesiveness": value,
              "critical_elasticity": C_HALF * value**2.5, "coefficient": C_HALF} for value in (10.0, 1000.0)]  # fmt: skip
    table = pd.DataFrame(right)
    assert [check.holds for check in study.checks(table, settings)] == [True, True]
    steeper = table.assign(critical_elasticity=C_HALF * table["adhesiveness"] ** 2.503)
    assert [check.holds for check in study.checks(steeper, settings)] == [False, True]
    higher = table.assign(coefficient=C_HALF * 1.0001)
    assert [check.holds for check in study.checks(higher, settings)] == [True, False]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('reference = "nowhere.csv"', "settings.reference: {}/nowhere.csv is not there."),
        ("liggghts.adhesivenesses = [7.0]", "settings: liggghts.restitution_coefficients holds 0.3"),
        ("restitution_coefficients = [1.0]", "settings: restitution_coefficients[0] = 1.0 must be < 1."),
        ("adhesiveness = [7.0]", "settings: unknown key 'adhesiveness'. Did you mean 'adhesivenesses'?"),
    ],
)
def test_faults_of_the_settings_are_named(tmp_path, line, message):
    path = tmp_path / "sweep.toml"
    head = 'title = "x"\nstudy = "sticking_threshold"\n[settings]\n'
    path.write_text(head + ("" if line.startswith("rest") else "restitution_coefficients = [0.5]\n") + line + "\n")
    with pytest.raises(SceneError) as caught:
        load(path)
    assert message.format(tmp_path) in str(caught.value)


@pytest.mark.parametrize("name", ["haervig_fig11", "haervig_fig12"])
def test_the_shipped_sweeps_are_those_of_the_captions(name):
    settings = load(sweep_file(name)).settings
    assert {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9} <= set(settings.restitution_coefficients)
    assert settings.liggghts is not None
