"""CSV files in, result files out, and one line for every fault a user can make."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from pyjkr import arguments, cli
from pyjkr.calibrate import CalibrationError, Measurements, Particle, command, fit, read, report
from pyjkr.calibrate.collision import collision

HEADER = "speed,restitution\n"
SIZE = ["--diameter", "1.27e-6", "--density", "1026"]


def written(directory, text):
    path = directory / "rebounds.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_comments_and_order_of_columns_do_not_matter(tmp_path):
    path = written(tmp_path, "# a comment\nRestitution [-], speed [m/s] , standard deviation\n0.5,3,0.02\n\n0, 1.5,0.01\n.7,8,.03\n")
    data = read(path)
    assert data.speed.tolist() == [1.5, 3, 8]
    assert data.restitution.tolist() == [0, 0.5, 0.7]
    assert data.standard_deviation.tolist() == [0.01, 0.02, 0.03]


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "holds no points"),
        ("# only a comment\n", "holds no points"),
        (HEADER, "no points"),
        (HEADER + "1,0.5\n", "at least 2"),
        (HEADER + "1,0.5\n2,nan\n", "point 2: restitution"),
        (HEADER + "1,0.5\n2,\n", "point 2: restitution is empty"),
        (HEADER + "1,0.5\n2,abc\n", "'abc' is not a number"),
        (HEADER + "1,0.5\n2,inf\n", "not a finite number"),
        (HEADER + "1,50\n2,60\n", "percentages"),
        (HEADER + "1,-0.1\n2,0.6\n", "is negative"),
        (HEADER + "0,0.1\n2,0.6\n", "speed = 0 m/s must be > 0"),
        (HEADER + "-1,0.1\n2,0.6\n", "must be > 0"),
        (HEADER + "1,0\n2,0\n", "every sphere stuck"),
        (HEADER + "1,0\n2,0.5\n", "one impact rebounded"),
        (HEADER + "1,0.5\n1,0.6\n", "all points have the speed 1"),
        (HEADER + "1,0.5\n2,0.6,7,8\n", "not a comma-separated table"),
        ("speed,restitution,speed\n1,0.5,1\n2,0.6,2\n", "'speed' is there 2 times"),
        ("speed,e\n1,0.5\n2,0.6\n", "unknown column 'e'"),
        ("speed,standard_deviation\n1,0.5\n2,0.6\n", "'restitution' is missing"),
        ("speed,restitution,standard_deviation\n1,0.5,0\n2,0.6,0.1\n", "standard_deviation = 0 must be > 0"),
    ],
)
def test_each_fault_is_one_line_that_names_the_file_and_a_remedy(tmp_path, text, words):
    with pytest.raises(CalibrationError, match=words) as caught:
        read(written(tmp_path, text))
    message = str(caught.value)
    assert "rebounds.csv" in message and "\n" not in message and message.endswith(".")
    assert caught.value.exit_code == 2


def test_a_missing_file_and_a_binary_one_are_named(tmp_path):
    with pytest.raises(CalibrationError, match="cannot be read"):
        read(tmp_path / "none.csv")
    (tmp_path / "rebounds.csv").write_bytes(b"\xff\xfe\x00speed")
    with pytest.raises(CalibrationError, match="not a comma-separated table"):
        read(tmp_path / "rebounds.csv")


@pytest.mark.parametrize(
    "values, words",
    [
        ({"radius": -1e-6, "density": 1000.0}, "radius"),
        ({"radius": 1e-6}, "exactly one of density"),
        ({"radius": 1e-6, "density": 1000.0, "mass": 1e-15}, "exactly one of density"),
        ({"radius": 1e-6, "density": float("nan")}, "density"),
        ({"radius": 1e-6, "density": 1e3, "target": "floor"}, "target"),
        ({"radius": 1e-6, "density": 1e3, "effective_modulus": 0.0}, "effective_modulus"),
    ],
)
def test_a_particle_that_cannot_be_is_refused(values, words):
    with pytest.raises(CalibrationError, match=words):
        Particle(**values)


def test_arrays_of_different_length_are_refused():
    with pytest.raises(CalibrationError, match="has 1 entries, speed has 2"):
        Measurements(np.array([1.0, 2.0]), np.array([0.5]))


@pytest.fixture
def rebounds(tmp_path):
    """A file of the model's own curve, e = 0.8, sticking speed 1.5 m/s."""
    speeds = np.array([1.0, 1.6, 2.0, 3.0, 5.0, 9.0, 20.0])
    restitution = collision("jkr").restitution(speeds / 1.5, 0.8) + np.array([0, 1, -1, 1, 1, -1, 1]) * [0, *[0.004] * 6]
    return written(tmp_path, HEADER + "".join(f"{v},{e}\n" for v, e in zip(speeds, restitution, strict=True)))


def run(path, *words):
    command.run_calibrate(arguments.parser(cli.ACTIONS).parse_args(["calibrate", str(path), *SIZE, *words]))


def test_the_verb_leaves_a_result_a_curve_and_a_figure(rebounds, tmp_path, capsys):
    out = tmp_path / "out"
    run(rebounds, "--modulus", "271e6", "--modulus-mod", "27.1e6", "-o", str(out))
    result = json.loads((out / report.RESULT_NAME).read_text())
    estimates = result["estimates"]
    assert estimates["restitution_coefficient"]["lower"] < 0.8 < estimates["restitution_coefficient"]["upper"]
    assert estimates["sticking_speed"]["lower"] < 1.5 < estimates["sticking_speed"]["upper"]
    ratio = estimates["surface_energy_mod"]["value"] / estimates["surface_energy"]["value"]
    assert ratio == pytest.approx(0.1**0.4)  # Chen 2019, eq. 10
    curve = pd.read_csv(out / report.CURVE_NAME)
    assert (curve["e_eff_lower"] <= curve["e_eff"]).all() and (curve["e_eff"] <= curve["e_eff_upper"]).all()
    assert (out / report.FIGURE_NAME).read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr()
    assert "gamma_mod at E_mod = 2.71e+07 Pa" in printed.out and "surface_energy = " in printed.out
    assert report.RESULT_NAME in printed.err


def test_without_a_modulus_only_the_group_is_named(rebounds, tmp_path, capsys):
    run(rebounds, "-o", str(tmp_path / "out"))
    assert "give E or E_mod" in capsys.readouterr().out
    assert "surface_energy" not in json.loads((tmp_path / "out" / report.RESULT_NAME).read_text())["estimates"]


def test_two_points_write_a_result_without_intervals(tmp_path):
    path = written(tmp_path, HEADER + "2,0.5\n20,0.75\n")
    run(path, "-o", str(tmp_path / "out"))
    result = json.loads((tmp_path / "out" / report.RESULT_NAME).read_text())
    assert result["estimates"]["group"]["lower"] is None
    assert max(map(abs, result["residual"])) < 1e-6


def test_nothing_in_the_figure_covers_anything_else(rebounds):
    figure = report.figure(fit(rebounds, Particle(radius=0.635e-6, density=1026.0)))
    figure.draw_without_rendering()
    axes, legend = figure.axes[0].get_tightbbox(), figure.legends[0].get_window_extent()
    assert not axes.overlaps(legend)
    assert figure.axes[0].get_xlabel().endswith("[m/s]")
