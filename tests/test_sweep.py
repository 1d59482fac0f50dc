"""Sweeps: files and their faults, what is kept, what is left behind. Points are evaluated in this process."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
from sweep_fakes import counting
from sweep_fakes.files import Here, evaluated, options, written

from pyjkr import resources
from pyjkr.errors import RunError, SceneError, ToleranceError
from pyjkr.sweep import executing, load
from pyjkr.sweep.command import run_sweep
from pyjkr.sweep.store import Store, owned

LEFT = ["points", "result.json", "squares.png", "summary.csv", "sweep.toml", "table.csv"]


@pytest.fixture
def here(monkeypatch):
    monkeypatch.setattr(executing, "crew", lambda workers, scheduler: Here())


def names(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def point_file(path: Path, output: Path, number: float) -> Path:
    sweep = load(path)
    point = next(point for point in sweep.points if point["number"] == number)
    return output / "points" / f"{Store.of(sweep, output).key(point)}.json"


# --- files -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("numbers", "numbrs", "settings: unknown key 'numbrs'. Did you mean 'numbers'?"),
        ('title = "squares"', 'titel = "squares"', "unknown key 'titel'. Did you mean 'title'?"),
        ('title = "squares"', "", "title is missing. Add it."),
        ("numbers = [3.0]", 'numbers = ["three"]', "numbers[0] = 'three' must be a number."),
        ("numbers = [3.0]", "", "numbers is missing. Add it."),
        ("numbers = [3.0]", "numbers = []", "settings: they leave no point to evaluate. Give every list an entry."),
        ("sweep_fakes.counting", "sticking_treshold", "unknown study 'sticking_treshold'. Did you mean 'sticking_threshold'?"),
        ("sweep_fakes.counting", "check", "pyjkr.studies.check is no study: it has no VERSION, Settings"),
        ("numbers = [3.0]", "numbers = [3.0", "is not valid TOML"),
        ("numbers = [3.0]", "numbers = [3.0, inf]", "settings.numbers[1] = inf is not a finite number. Correct it."),
        ("numbers = [3.0]", "numbers = [3.0]\nmarks = 4", "settings: marks = 4 must be a text in quotes."),
    ],
)
def test_a_fault_is_one_line_with_file_key_and_remedy(tmp_path, old, new, message):
    path = written(tmp_path, [3.0])
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(SceneError) as caught:
        run_sweep(options(path, tmp_path / "out"))
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_an_unknown_case_names_the_nearest_shipped_one():
    with pytest.raises(SceneError, match="Did you mean 'haervig_fig1"):
        run_sweep(options(Path("haervig_fig21"), Path("nowhere")))


def test_a_directory_with_a_sweep_file_is_told_from_that_file(tmp_path):
    (tmp_path / "sweep.toml").touch()
    with pytest.raises(SceneError, match=rf"Did you mean {tmp_path}/sweep.toml\?"):
        run_sweep(options(tmp_path, Path("nowhere")))


def test_every_shipped_sweep_is_valid():
    shipped = resources.shipped_sweeps()
    assert {"haervig_fig11", "haervig_fig12"} <= set(shipped)
    for path in shipped.values():
        assert load(path).points


# --- what is kept ----------------------------------------------------------------------------------------------------


def test_a_sweep_leaves_table_figures_and_result(tmp_path, here, capsys):
    path = written(tmp_path, [3.0, 2.0])
    run_sweep(options(path, tmp_path / "out"))
    assert names(tmp_path / "out") == LEFT
    assert (tmp_path / "out" / "sweep.toml").read_bytes() == path.read_bytes()
    # In the order of the points, not of their ends or names.
    assert list(pd.read_csv(tmp_path / "out" / "table.csv")["square"]) == [9.0, 4.0]
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["passed"] is True and result["points"] == 2 and result["settings"]["numbers"] == [3.0, 2.0]
    assert result["checks"] == [{"name": "sum of squares", "measured": 13.0, "wanted": "<= 1e+09", "holds": True}]
    assert 0 < result["wall_time_of_points"] < 10
    assert result["summary"] == {"columns": ["of", "numbers", "mean square"], "data": [["all", 2, 6.5]]}
    assert (tmp_path / "out" / "summary.csv").read_text() == "of,numbers,mean square\nall,2,6.5\n"
    assert "sum of squares  13        <= 1e+09  ok" in capsys.readouterr().out


def test_finished_points_are_not_evaluated_again_and_give_the_same_table(tmp_path, here):
    run_sweep(options(written(tmp_path, [3.0, 2.0]), tmp_path / "out"))
    fresh = (tmp_path / "out" / "table.csv").read_bytes()
    run_sweep(options(written(tmp_path, [3.0, 2.0]), tmp_path / "out"))
    assert (tmp_path / "out" / "table.csv").read_bytes() == fresh
    run_sweep(options(written(tmp_path, [2.0, 5.0, 3.0]), tmp_path / "out"))
    assert evaluated(tmp_path) == {"3": 1, "2": 1, "5": 1}


@pytest.mark.parametrize("damage", ["", "{", "[]", '{"rows": [1]}', "another point"])
def test_a_damaged_point_is_evaluated_again(tmp_path, here, damage):
    path, out = written(tmp_path, [3.0, 2.0]), tmp_path / "out"
    run_sweep(options(path, out))
    kept = point_file(path, out, 3.0)
    whole = json.loads(kept.read_text())
    kept.write_text(point_file(path, out, 2.0).read_text() if damage == "another point" else damage)
    run_sweep(options(path, out))
    assert evaluated(tmp_path) == {"3": 2, "2": 1}
    assert json.loads(kept.read_text())["point"] == whole["point"]
    assert list(pd.read_csv(out / "table.csv")["square"]) == [9.0, 4.0]


def test_a_new_version_of_the_study_evaluates_all_again(tmp_path, here, monkeypatch):
    path = written(tmp_path, [3.0])
    run_sweep(options(path, tmp_path / "out"))
    monkeypatch.setattr(counting, "VERSION", 2)
    run_sweep(options(path, tmp_path / "out"))
    assert evaluated(tmp_path) == {"3": 2}


def test_a_point_listed_twice_is_evaluated_once(tmp_path, here):
    run_sweep(options(written(tmp_path, [3.0, 3.0]), tmp_path / "out"))
    assert evaluated(tmp_path) == {"3": 1}


# --- what fails ------------------------------------------------------------------------------------------------------


def test_a_failed_point_stops_neither_the_others_nor_leaves_a_result(tmp_path, here):
    path, out = written(tmp_path, [3.0, 2.0, 5.0]), tmp_path / "out"
    (tmp_path / "marks" / "fail-2").touch()
    with pytest.raises(RunError) as caught:
        run_sweep(options(path, out))
    assert caught.value.exit_code == 3
    first, second, third = str(caught.value).splitlines()
    assert first.startswith("1 of 3 points failed")
    assert second == "  number 2: ValueError: 2 is not to my taste"
    trace = Path(third.removeprefix("    see ")).read_text()
    assert "Traceback" in trace and "in evaluate" in trace
    assert names(out) == ["points"]
    (tmp_path / "marks" / "fail-2").unlink()
    run_sweep(options(path, out))
    assert evaluated(tmp_path) == {"3": 1, "2": 2, "5": 1}
    assert not list(out.rglob("error.txt"))


def test_a_failure_removes_the_result_of_an_earlier_sweep(tmp_path, here):
    out = tmp_path / "out"
    run_sweep(options(written(tmp_path, [3.0]), out))
    (out / "mine.png").touch()
    (tmp_path / "marks" / "fail-2").touch()
    with pytest.raises(RunError):
        run_sweep(options(written(tmp_path, [3.0, 2.0]), out))
    assert names(out) == ["mine.png", "points", "sweep.toml"]


def test_a_check_that_does_not_hold_is_exit_status_1_with_a_result(tmp_path, here, capsys):
    with pytest.raises(ToleranceError):
        run_sweep(options(written(tmp_path, [3.0], largest_sum=8.0), tmp_path / "out"))
    assert "BAD" in capsys.readouterr().out
    assert json.loads((tmp_path / "out" / "result.json").read_text())["passed"] is False


def test_two_sweeps_in_one_directory_are_refused(tmp_path, here):
    out = tmp_path / "out"
    run_sweep(options(written(tmp_path, [3.0]), out))
    with owned(out), pytest.raises(RunError, match="another sweep is at work there"):
        run_sweep(options(written(tmp_path, [3.0]), out))
    assert names(out) == LEFT, "the refused sweep touched what the other one had written"
