"""Sweeps over a scene: which keys take which values, what is refused, and the rows against `pyjkr run`'s own numbers."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pandas as pd
import pytest
from scene_files import DAHNEKE, PAIR, written

from pyjkr.compare import oracle_outcomes
from pyjkr.errors import PyjkrError
from pyjkr.plan import plan
from pyjkr.scene import load as load_scene
from pyjkr.studies import scene as study
from pyjkr.sweep import load


def sweep(directory: Path, *lines: str, scene: str = DAHNEKE, engine: str = "oracle"):
    written(directory, scene, "impact.toml")
    head = ['title = "x"', 'study = "scene"', "[settings]", 'scene = "impact.toml"', f'engine = "{engine}"', "[settings.vary]"]
    return load(written(directory, "\n".join([*head, *lines, ""]), "sweep.toml"))


def test_points_are_the_full_product_and_carry_their_scenes(tmp_path):
    made = sweep(tmp_path, '"contact.0.surface_energy" = [0.05, 0.2, 0.07]', '"impact.speeds" = [[2.5], [4.5]]').points
    pairs = [(scene["contact"][0]["surface_energy"], scene["impact"]["speeds"]) for scene in (json.loads(p["scene"]) for p in made)]
    assert pairs == [(energy, speeds) for energy in (0.05, 0.2, 0.07) for speeds in ([2.5], [4.5])]
    assert made[0]["label"] == "surface_energy = 0.05, speeds = [2.5]"
    # Nothing else has changed, and nothing but the point is needed to evaluate it elsewhere.
    plain = tomllib.loads(DAHNEKE)
    scene = json.loads(made[0]["scene"])
    assert scene["material"] == plain["material"] and scene["reduction"] == plain["reduction"]
    assert str(tmp_path) not in json.dumps(made)


def test_keys_may_be_dotted_tables_quoted_names_and_absent_tables(tmp_path):
    vary = ['material."silica & co".density = [2100.0]', '"contact.0.friction_coefficient" = [0.2]', "environment.acceleration = [9.81]"]
    scene = json.loads(sweep(tmp_path, *vary, scene=PAIR).points[0]["scene"])
    assert scene["material"]["silica & co"]["density"] == 2100.0
    assert scene["contact"][0]["friction_coefficient"] == 0.2
    assert scene["environment"] == {"acceleration": 9.81}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('"contact.0.surface_energi" = [0.1]', "'polystyrene'-'quartz': unknown key 'surface_energi'. Did you mean 'surface_energy'?"),
        ('"contct.0.surface_energy" = [0.1]', "unknown key 'contct'. Did you mean 'contact'?"),
        ('"contact.0.surface_energy" = [0.1, -0.3]', "surface_energy = -0.3: impact.toml: contact"),
        ('"contact.1.surface_energy" = [0.1]', "'contact.1.surface_energy' names entry '1' of a list of 1. They count from 0."),
        ('"title.text" = ["a"]', "'title.text' goes into a value that is no table."),
        ('"impact.diameter" = [1e-6, 1e-300]', "impact.toml: "),
        ('"impact.phase" = 0.3', "'impact.phase' = 0.3 must be a list of values. Write [0.3]."),
        ('"impact.phase" = []', "settings: impact.phase = [] must not be empty."),
    ],
)
def test_what_makes_no_scene_is_refused_before_anything_runs(tmp_path, line, message):
    with pytest.raises(PyjkrError) as caught:
        _ = sweep(tmp_path, line).points
    assert caught.value.exit_code == 2
    assert str(caught.value).startswith(f"{tmp_path / 'sweep.toml'}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_scene_that_is_not_there_names_the_shipped_ones(tmp_path):
    path = written(tmp_path, 'title = "x"\nstudy = "scene"\nsettings.scene = "dahnecke"\n', "sweep.toml")
    with pytest.raises(PyjkrError, match=r"dahnecke is not there. Give a path relative to the sweep file, or a shipped case: .*dahneke"):
        load(path)


def test_rows_of_the_oracle_are_those_of_the_edited_scene_file(tmp_path):
    made = sweep(tmp_path, '"contact.0.surface_energy" = [0.06, 0.11]')
    table = pd.DataFrame([row for point in made.points for row in study.evaluate(point, tmp_path)])
    for energy in (0.06, 0.11):
        text = DAHNEKE.replace("surface_energy = 0.11", f"surface_energy = {energy}")
        expected = oracle_outcomes(plan(load_scene(written(tmp_path, text, "edited.toml"))))
        rows = table[table["contact.0.surface_energy"] == energy].set_index("case")["e_eff_oracle"]
        assert rows.to_dict() == {label: outcome.restitution for label, outcome in expected.items()}
    assert list(study.figures(table, made.settings)) == ["restitution"]
    assert study.checks(table, made.settings) == []


def test_liggghts_runs_every_combination_and_is_held_against_the_oracle(tmp_path, plugin):
    lines = ['"impact.speeds" = [[2.0], [5.0]]', '"reduction.modulus_ratios" = [[0.1]]', '"reduction.unmodified_ratios" = [[]]']
    made = sweep(tmp_path, *lines, engine="liggghts")
    rows = [study.evaluate(point, tmp_path / str(number)) for number, point in enumerate(made.points)]
    table = pd.DataFrame([row for part in rows for row in part])
    assert list(table["speed"]) == [2.0, 5.0]
    assert list(table["stuck_liggghts"]) == [True, False]
    assert (table["steps"] > 200).all() and (table["wall_time"] > 0).all()
    assert [check.holds for check in study.checks(table, made.settings)] == [True, True]
    wrong = table.assign(difference=[0.0, 0.01], stuck_liggghts=[False, False])
    assert [check.holds for check in study.checks(wrong, made.settings)] == [False, False]
