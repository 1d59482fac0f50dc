"""The command line: what it prints where, what it leaves behind, and its exit status."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from scene_files import DAHNEKE, MESH, PAIR, edited, written

from pyjkr import campaign, compare, report
from pyjkr.cli import main

# Fewer speeds: these tests are about files and statuses.
SHORT = edited(DAHNEKE, ("[2.0, 3.2, 5.0]", "[2.0, 5.0]"), ("steps_per_collision = 200", "steps_per_collision = 500"))
SHORTEST = edited(SHORT, ("[2.0, 5.0]", "[5.0]"), ("unmodified_ratios = [0.2]", ""))
RESULTS = ["restitution.png", "result.json", "scene.toml", "table.csv", "table.txt", "velocity.png"]


def run(*arguments: object) -> int:
    try:
        return main([str(argument) for argument in arguments])
    except SystemExit as stop:  # argparse leaves by itself
        return stop.code


def help_of(verb: str, capsys) -> str:
    assert run(verb, "--help") == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("verb", ["scale", "plan", "deck", "run", "compare", "calibrate", "sweep", "cost"])
def test_help_says_what_a_verb_reads_and_writes_and_ends_with_an_example(capsys, verb):
    text = help_of(verb, capsys)
    assert "Reads" in text
    assert "writes" in text
    assert text.rstrip().splitlines()[-2] == "example:"


@pytest.mark.parametrize("verb", ["scale", "plan", "deck"])
def test_the_example_of_the_help_runs(capsys, tmp_path, monkeypatch, verb):
    monkeypatch.chdir(tmp_path)
    program, *arguments = shlex.split(help_of(verb, capsys).rstrip().splitlines()[-1])
    assert program == "pyjkr"
    assert run(*arguments) == 0
    assert capsys.readouterr().out


def test_scale_prints_equation_24(capsys):
    assert run("scale", "--modulus", 271e6, "--surface-energy", 0.11, "--ratio", 0.1, 0.01) == 0
    lines = capsys.readouterr().out.splitlines()
    # 0.11 * 0.1^0.4 and 0.11 * 0.01^0.4; 10^0.4.
    assert lines[1].split() == ["0.1", "2.71e+07", "0.0437918", "2.5119", "2.5119", "0.3981"]
    assert lines[2].split()[2] == "0.0174338"


def test_scale_takes_a_scene_instead(capsys, tmp_path):
    assert run("scale", written(tmp_path, DAHNEKE)) == 0
    assert "0.0437918" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [[], ["--modulus", 1e9], ["dahneke", "--modulus", 1e9], ["--modulus", "-3", "--surface-energy", "2", "--ratio", "0.1"]],
)
def test_scale_refuses_half_a_question(capsys, arguments):
    assert run("scale", *arguments) == 2
    assert capsys.readouterr().err.startswith("pyjkr: scale: ")


def test_plan_lists_cases_and_what_is_left_out(capsys):
    assert run("plan", "dahneke") == 0
    text = capsys.readouterr().out
    assert "5.0mps_q0.01_scaled" in text
    assert "left out: E_mod/E = 0.01 scaled at 10, 14, 20 m/s: may press 0.55 to 0.87 R deep, limit 0.5 R" in text


def test_deck_writes_one_directory_per_case_and_names_them(capsys, tmp_path):
    assert run("deck", written(tmp_path, MESH), "-o", tmp_path / "decks") == 0
    paths = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert [path.parent.name for path in paths] == ["0.5mps_q1.0_scaled", "0.5mps_q0.01_scaled"]
    assert all(path.is_file() and (path.parent / "wall.stl").is_file() for path in paths)


def test_deck_of_an_unknown_case_is_a_usage_error(capsys, tmp_path):
    assert run("deck", written(tmp_path, MESH), "--case", "nope") == 2
    assert "no case 'nope'" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["plan", "run", "scale"])
def test_a_bad_scene_ends_in_one_line_and_status_2(capsys, tmp_path, verb):
    path = written(tmp_path, edited(DAHNEKE, ("0.11", "nan")))
    assert run(verb, path) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert (
        err == f"pyjkr: {path}: contact 'polystyrene'-'quartz': surface_energy = nan J/m2"
        " must be a finite number. Set 0 for plain Hertz contact.\n"
    )


def test_an_unknown_scene_names_the_shipped_ones(capsys):
    assert run("plan", "dahnek") == 2
    assert re.search("Shipped: .*dahneke", capsys.readouterr().err)


@pytest.mark.parametrize(
    "arguments", [[], ["calibrate"], ["run"], ["run", "dahneke", "--np", "0"], ["run", "dahneke", "--engine", "x"]]
)
def test_wrong_usage_is_status_2(capsys, arguments):
    assert run(*arguments) == 2


def test_a_dry_run_prints_decks_and_commands_and_writes_nothing(capsys, tmp_path):
    assert run("run", written(tmp_path, SHORT), "-o", tmp_path / "out", "--dry-run", "--np", 2) == 0
    text = capsys.readouterr().out
    assert text.count("pair_style ") == 6
    assert re.search(r"^# cd '.*5.0mps_q0.1_scaled' && mpirun -np 2 .* -in in.deck$", text, re.MULTILINE)
    assert not (tmp_path / "out").exists()


def test_the_oracle_runs_a_scene_without_liggghts(capsys, tmp_path):
    assert run("run", written(tmp_path, SHORT), "-o", tmp_path / "out", "--engine", "oracle") == 0
    out, err = capsys.readouterr()
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == RESULTS
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert (result["engine"], result["passed"]) == ("oracle", True)
    assert result["versions"]["simulator"] is None
    assert result["table"][0]["e_eff_liggghts"] is None
    assert "0.718637" in out
    assert out.strip() == (tmp_path / "out" / "table.txt").read_text().strip()
    assert "wrote" in err


def test_without_liggghts_the_oracle_takes_over_and_says_so(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("PYJKR_LIGGGHTS", str(tmp_path / "missing"))
    scene = written(tmp_path, SHORTEST)
    assert run("run", scene, "-o", tmp_path / "out") == 0
    assert "going on with --engine oracle" in capsys.readouterr().err
    assert run("run", scene, "-o", tmp_path / "out", "--engine", "liggghts") == 3


def test_outside_tolerance_is_status_1_and_stands_in_the_result(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(compare, "SIMILARITY_TOLERANCE", -1.0)
    assert run("run", written(tmp_path, SHORTEST), "-o", tmp_path / "out", "--engine", "oracle") == 1
    out, err = capsys.readouterr()
    assert "OUTSIDE TOLERANCE" in out
    assert "outside tolerance" in err
    assert json.loads((tmp_path / "out" / "result.json").read_text())["passed"] is False


def test_a_failed_simulator_is_status_3_and_leaves_no_old_result(capsys, tmp_path, monkeypatch):
    scene, directory = written(tmp_path, SHORTEST), tmp_path / "out"
    assert run("run", scene, "-o", directory, "--engine", "oracle") == 0
    monkeypatch.setenv("PYJKR_LIGGGHTS", "/bin/false")
    assert run("run", scene, "-o", directory, "--engine", "liggghts") == 3
    assert not any((directory / name).exists() for name in report.FILES)
    assert "in.deck" in capsys.readouterr().err


def test_an_interrupt_is_status_130_and_leaves_no_result(capsys, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setenv("PYJKR_LIGGGHTS", "/bin/false")
    monkeypatch.setattr(campaign, "execute", interrupted)
    assert run("run", written(tmp_path, SHORTEST), "-o", tmp_path / "out", "--engine", "liggghts") == 130
    assert not (tmp_path / "out" / "result.json").exists()


def test_compare_needs_a_directory_that_run_has_filled(capsys, tmp_path):
    assert run("compare", tmp_path) == 2
    written(tmp_path, SHORT)
    assert run("compare", tmp_path) == 3
    assert "no finished run of this scene" in capsys.readouterr().err


def test_a_reader_who_stops_early_meets_no_traceback():
    command = f"{shlex.quote(sys.executable)} -m pyjkr plan dahneke | head -1"
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent.parent)}
    done = subprocess.run(command, shell=True, capture_output=True, text=True, env=environment, check=False)
    assert done.stdout.startswith("case")
    assert "Traceback" not in done.stderr
    assert "Broken" not in done.stderr


@pytest.mark.liggghts
@pytest.mark.parametrize("text", [SHORT, MESH, PAIR], ids=["dahneke", "mesh", "pair"])
def test_liggghts_and_oracle_agree_for_every_kind_of_impact(tmp_path, plugin, text):
    directory = tmp_path / "it's out"
    assert run("run", written(tmp_path, text), "-o", directory) == 0
    table = pd.read_csv(directory / "table.csv")
    # Event-corrected velocity Verlet at 120 to 500 steps per collision.
    assert table["difference"].abs().max() < 2e-4
    assert (table["stuck_liggghts"] == table["stuck_oracle"]).all()


@pytest.mark.liggghts
def test_finished_runs_are_kept_and_compared_again(capsys, tmp_path, plugin):
    scene, directory = written(tmp_path, SHORT), tmp_path / "out"
    assert run("run", scene, "-o", directory) == 0
    dumps = {path: path.stat().st_mtime_ns for path in directory.glob("*/impact.dump")}
    assert len(dumps) == 6
    first = capsys.readouterr().out
    next(iter(dumps)).unlink()
    assert run("run", scene, "-o", directory) == 0
    again = {path: path.stat().st_mtime_ns for path in directory.glob("*/impact.dump")}
    assert sum(again[path] != dumps[path] for path in dumps) == 1
    capsys.readouterr()
    (directory / "result.json").unlink()
    assert run("compare", directory) == 0
    result = json.loads((directory / "result.json").read_text())
    assert (result["engine"], result["versions"]["simulator"]) == ("liggghts", plugin.name)
    columns = slice(0, 70)  # up to the step counts; one wall time differs
    assert [line[columns] for line in capsys.readouterr().out.splitlines()] == [line[columns] for line in first.splitlines()]


@pytest.mark.liggghts
def test_a_changed_scene_is_run_anew(tmp_path, plugin):
    directory = tmp_path / "out"
    assert run("run", written(tmp_path, SHORTEST), "-o", directory) == 0
    before = pd.read_csv(directory / "table.csv")["e_eff_liggghts"]
    assert run("run", written(tmp_path, edited(SHORTEST, ("= 0.86", "= 0.8"))), "-o", directory) == 0
    assert (pd.read_csv(directory / "table.csv")["e_eff_liggghts"] < before).all()


@pytest.mark.liggghts
def test_two_processes_give_what_one_gives(tmp_path, plugin):
    scene = written(tmp_path, SHORTEST)
    tables = []
    for ranks in (1, 2):
        assert run("run", scene, "-o", tmp_path / str(ranks), "--np", ranks) == 0
        tables.append(pd.read_csv(tmp_path / str(ranks) / "table.csv")["e_eff_liggghts"])
    assert tables[0].tolist() == tables[1].tolist()


def test_a_directory_that_cannot_be_made_is_one_line_and_no_traceback(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["run", "dahneke", "--engine", "oracle", "-o", str(tmp_path / "file" / "under")]) == 3
    error = capsys.readouterr().err
    assert error.splitlines()[-1] == f"pyjkr: {tmp_path / 'file' / 'under'}: Not a directory. Choose another directory with -o, or make room."


@pytest.mark.liggghts
def test_a_case_whose_dump_was_cut_since_is_run_again(tmp_path, plugin, capsys):
    scene = written(tmp_path, DAHNEKE)
    words = ["run", str(scene), "-o", str(tmp_path / "out"), "--no-progress"]
    assert main(words) == 0
    dump = next((tmp_path / "out").glob("*/impact.dump"))
    whole = dump.read_bytes()
    dump.write_bytes(whole[:-100])
    assert main(words) == 0
    assert dump.read_bytes() == whole


@pytest.mark.parametrize("change", [("271e6", "1e300"), ("1026.0", "1e-300")])
def test_numbers_beyond_computing_are_one_line_and_no_traceback(tmp_path, capsys, change):
    text = DAHNEKE.replace(*change)
    assert text != DAHNEKE
    assert main(["plan", str(written(tmp_path, text))]) == 2
    assert "Traceback" not in capsys.readouterr().err
