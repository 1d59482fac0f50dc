"""`pyjkr plan`, `deck` and `run` on scenes of many particles: what is printed, written, refused, and the exit status."""

from __future__ import annotations

import json

import pytest
from application_scenes import CASES, changed

from pyjkr.application import scene, situation
from pyjkr.cli import main
from pyjkr.planning import plan


def run(*arguments: object) -> int:
    try:
        return main([str(argument) for argument in arguments])
    except SystemExit as stop:  # argparse leaves by itself
        return stop.code


def test_plan_decides_says_why_and_writes_a_deck(tmp_path, capsys):
    assert run("plan", "head_on_pair", "--max-error", "5%", "-o", tmp_path) == 0
    out = capsys.readouterr().out
    for piece in ("adhesion", "threshold", "E_mod/E = ", "bound by", "steps per collision", "times faster", "skin"):
        assert piece in out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in.deck", "plan-explained.txt", "plan.txt"]
    deck = (tmp_path / "in.deck").read_text(encoding="utf-8")
    assert "effects, by the error of leaving them out (max_error = 0.05)" in deck
    assert "model jkr" in deck
    assert "tangential" not in deck.split("pair_style")[1].splitlines()[0]


def test_a_smaller_error_costs_more_steps(tmp_path):
    steps = []
    for part in ("5%", "0.01"):
        assert run("plan", "oblique_wall", "--max-error", part, "-o", tmp_path / part) == 0
        steps.append(int((tmp_path / part / "in.deck").read_text(encoding="utf-8").split()[-1]))
    assert steps[1] > steps[0]


def test_explain_gives_every_number_its_formula_and_source(tmp_path, capsys):
    assert run("plan", "ash_on_tube", "--explain", "-o", tmp_path) == 0
    out = capsys.readouterr().out
    assert out.count("source: ") >= 20
    assert "Haervig 2017, eq. 24" in out
    assert "Chen 2019" in out


def test_deck_goes_to_stdout_or_to_a_directory_with_what_it_reads(tmp_path, capsys):
    assert run("deck", "ash_on_tube") == 0
    printed = capsys.readouterr().out
    assert printed.startswith("# Fouling of a tube")
    assert run("deck", "ash_on_tube", "-o", tmp_path) == 0
    assert {"in.deck", "spheres.data", "tube.stl"} <= {path.name for path in tmp_path.iterdir()}
    assert (tmp_path / "in.deck").read_text(encoding="utf-8") == printed


@pytest.mark.liggghts
def test_run_simulates_measures_and_draws(tmp_path, capsys):
    assert run("run", "head_on_pair", "-o", tmp_path, "--no-progress") == 0
    out = capsys.readouterr().out
    assert "e_eff" in out
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert result["observables"]["stuck"] == 0
    assert 0 < result["observables"]["e_eff"] < 0.8
    assert result["effects"]["neck"] is True
    assert {"picture.png", "evolution.csv", "scene.toml", "spheres.dump"} <= {path.name for path in tmp_path.iterdir()}


def test_impacts_are_planned_too_where_an_error_is_given(capsys):
    assert run("plan", "dahneke", "--max-error", "1%") == 0
    assert "bound by" in capsys.readouterr().out
    assert run("plan", "dahneke") == 0
    assert "bound by" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "changes", "told"),
    [
        ("dust_coagulation", [("radius = 0.5e-6 ", "radius = 2e-9 "), ("spread = 0.05 ", "spread = 0.5 "),
                              ("[1.6e-5, 1.6e-5, 1.6e-5]", "[6.4e-8, 6.4e-8, 6.4e-8]"),
                              ("surface_energy = 0.025", "surface_energy = 0.02")],
         "Tabor number"),
        ("head_on_pair", [("speed = 0.6 ", "speed = 60.0 ")], "beyond the small strain of JKR"),
        ("ash_on_tube", [("viscosity = 4e-5", "viscosity = 4.0")], "exceeds the"),
    ],
)  # fmt: skip
def test_what_the_law_does_not_cover_is_refused_with_the_number(tmp_path, capsys, name, changes, told):
    assert run("plan", changed(tmp_path, name, *changes), "-o", tmp_path / "out") == 2
    error = capsys.readouterr().err
    assert told in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_tabor_number_between_dmt_and_jkr_is_warned_about(tmp_path, capsys):
    assert run("plan", "dust_coagulation", "-o", tmp_path) == 0
    assert "Tabor number 0.475" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("plan", "head_on_pair", "--max-error", "much"), "a number such as 0.01, or 1%"),
        (("plan", "head_on_pair", "--max-error", "90%"), "max_error"),
        (("plan", "dahneke", "--verify"), "--verify belongs to scenes of many particles"),
        (("deck", "head_on_pair", "--case", "one"), "--case"),
        (("deck", "dahneke"), "-o DIR"),
        (("run", "head_on_pair", "--engine", "oracle"), "oracle"),
        (("cost", "head_on_pair"), "scene of many particles"),
        (("cost",), "SCENE"),
    ],
)
def test_slips_of_the_finger_end_in_one_line_and_status_2(capsys, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == 2
    assert told in capsys.readouterr().err.splitlines()[-1]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "changes", "told"),
    [
        ("head_on_pair", [("duration = 1e-5 ", "duration = 1e3 ")], "LIGGGHTS takes 2147483647"),
        ("head_on_pair", [("duration = 1e-5 ", "duration = 1e300 ")], "beyond what can be computed"),
        ("dust_coagulation", [("[numerics]", "[numerics]\nskin = 1e-12")], "too short"),
        ("oblique_wall", [("[[particles]]", "[particles]")], "particles"),
    ],
)
def test_numbers_that_cannot_be_run_are_refused_in_one_line(tmp_path, capsys, name, changes, told):
    assert run("plan", changed(tmp_path, name, *changes), "-o", tmp_path / "out") == 2
    error = capsys.readouterr().err
    assert told in error
    assert len(error.splitlines()) == 1 or name == "dust_coagulation"


def test_free_rolling_is_no_slip_of_an_exponent(tmp_path):
    free = [("critical_rolling_angle = 0.0084", "critical_rolling_angle = 0.0")]
    assert run("plan", changed(tmp_path, "oblique_wall", *free), "-o", tmp_path / "out") == 0


def test_a_run_that_may_end_in_contact_is_warned_about(tmp_path, capsys):
    short = changed(tmp_path, "head_on_pair", ("duration = 1e-5 ", "duration = 5e-7 "))
    assert run("plan", short, "-o", tmp_path / "out") == 0
    assert "may end in contact" in capsys.readouterr().err


def test_drag_of_a_gas_bounds_the_softening_and_the_time_step(tmp_path):
    """In water the softened impact would be braked to a halt; a fast response is followed."""
    plans = {}
    for viscosity in ("1e-5", "1e-3"):
        path = changed(tmp_path, "head_on_pair", ("[run]", f"[gas]\nviscosity = {viscosity}\n[run]"))
        plans[viscosity] = plan.plan(situation.situation(scene.load(path)), 0.05)
    assert plans["1e-3"].modulus_ratio > 10 * plans["1e-5"].modulus_ratio
    assert plans["1e-3"].binding.name == "outer force during an impact"
    for viscosity, made in plans.items():
        response = 1050 * 2 * 2.5e-6**2 / (9 * float(viscosity))
        assert made.time_step <= 0.1 * response


def test_a_bed_of_less_than_a_layer_carries_whole_spheres(tmp_path):
    few = changed(tmp_path, "packed_bed", ("number = 300", "number = 5"))
    assert not plan.plan(situation.situation(scene.load(few)), 0.05).on("adhesion")


def test_a_directory_of_the_name_of_a_case_does_not_hide_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "packed_bed").mkdir()
    assert run("plan", "packed_bed", "-o", "out") == 0


def test_two_spheres_of_two_materials_need_one_contact(tmp_path):
    text = CASES["head_on_pair"].read_text(encoding="utf-8")
    text = text.replace('between = ["polystyrene", "polystyrene"]', 'between = ["polystyrene", "glass"]')
    text = text.replace("number = 2\n", 'number = 1\n').replace('start = "pair"', 'start = "pair"', 1)
    first = text[text.index("[[particles]]") : text.index("[motion]")]
    second = first.replace('"spheres"', '"other"').replace('material = "polystyrene"', 'material = "glass"')
    glass = "[material.glass]\ndensity = 2500.0\nyoungs_modulus = 70e9\npoissons_ratio = 0.22\n"
    path = tmp_path / "two.toml"
    path.write_text(text.replace(first, glass + first + second), encoding="utf-8-sig")
    assert run("deck", path, "-o", tmp_path / "out") == 0


def test_all_cases_are_listed_by_the_help(capsys):
    assert run("--help") == 0
    out = capsys.readouterr().out
    assert all(name in out for name in CASES)
