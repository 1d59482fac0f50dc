"""The cost model: its sum, the parts of a law, and a cache that is believed only where it fits."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from pyjkr.errors import PlanError
from pyjkr.planning import cost_model, probe_deck
from pyjkr.planning.cost_model import NUMBERS, PARTS, SHIPPED, CostModel
from pyjkr.simulator import Simulator

# Powers of two, so that each coefficient can be read off a sum; the laws are 2^20 and up.
POWERS = CostModel(
    **{name: float(2**index) for index, name in enumerate(NUMBERS)},
    laws={part: float(2 ** (20 + index)) for index, part in enumerate(PARTS)},
)
FULL = "model jkr tangential jkr rolling_friction krijt twisting on"


@pytest.fixture
def simulator(tmp_path) -> Simulator:
    program = tmp_path / "liggghts"
    program.write_bytes(b"a program")
    return Simulator(program)


@pytest.fixture
def measured(simulator) -> CostModel:
    return replace(POWERS, program=probe_deck.program_digest(simulator), machine=cost_model.machine_name())


def test_a_law_costs_the_sum_of_its_parts_and_keywords_nothing():
    assert cost_model.parts(FULL + " rollingDamping 0.2") == ("model jkr", "tangential jkr", "rolling_friction krijt", "twisting on")
    assert POWERS.contact(FULL) == sum(POWERS.laws[part] for part in cost_model.parts(FULL))
    assert cost_model.parts("model hertz tangential off rolling_friction off") == ("model hertz",)
    assert cost_model.parts("model hertz tangential no_history rolling_friction epsd") == (
        "model hertz", "tangential history", "rolling_friction epsd2",
    )  # fmt: skip


def test_a_style_that_was_never_timed_is_refused_by_name():
    with pytest.raises(PlanError, match="'model hooke'"):
        SHIPPED.contact("model hooke tangential history")


@pytest.mark.parametrize(
    ("amounts", "names"),
    [
        ({}, ("step",)),
        ({"particles": 1}, ("step", "sphere")),
        ({"idle": 1}, ("step", "idle")),
        ({"rebuild_rate": 1, "particles": 1}, ("step", "sphere", "rebuild_sphere")),
        ({"rebuild_rate": 1, "candidates": 1}, ("step", "rebuild_candidate")),
        ({"rebuild_rate": 1, "bins": 1}, ("step", "rebuild_bin")),
        ({"particles": 1, "forces": 1}, ("step", "sphere", "force")),
        ({"triangles": 1}, ("step", "triangle")),
    ],
)
def test_a_step_is_the_sum_of_what_there_is_to_do(amounts, names):
    time = POWERS.step_time("model jkr", **({"particles": 0, "contacts": 0} | amounts))
    assert time == sum(getattr(POWERS, name) for name in names)


def test_ranks_share_the_work_but_not_the_step_and_exchange_their_faces():
    alone = POWERS.step_time(FULL, 2000, 5000, idle=700)
    shared = POWERS.step_time(FULL, 2000, 5000, idle=700, ranks=2)
    # (2000/2)^(2/3) = 100 spheres at the face.
    assert shared == pytest.approx((alone - POWERS.step) / 2 + POWERS.step + POWERS.message + 100 * POWERS.ghost, rel=1e-12)
    assert cost_model.ghosts(2000, 1) == 0


def test_a_run_is_its_steps_its_frames_and_the_start():
    step = POWERS.step_time(FULL, 7, 3)
    loop = POWERS.loop_time(11, FULL, 7, 3, frames=5)
    assert loop == 11 * step + 5 * (POWERS.frame + 7 * POWERS.frame_sphere)
    assert POWERS.wall_time(11, FULL, 7, 3, frames=5) == loop + POWERS.start


def test_a_stored_model_comes_back(simulator, measured, tmp_path):
    file = cost_model.store(measured, tmp_path / "new" / "cost.json")
    assert cost_model.load(simulator, file) == measured
    assert [entry.name for entry in file.parent.iterdir()] == ["cost.json"]


def test_the_cache_is_where_the_user_says_and_only_an_absolute_path_counts(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cost_model.cache_file() == tmp_path / "pyjkr" / "cost-model.json"
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cost_model.cache_file() == tmp_path / ".cache" / "pyjkr" / "cost-model.json"


def _without(name):
    return lambda values: values.pop(name)


@pytest.mark.parametrize(
    "damage",
    [
        _without("sphere"),
        _without("rebuild_bin"),
        lambda values: values["laws"].pop("model jkr"),
        lambda values: values.update(sphere="fast"),
        lambda values: values.update(sphere=None),
        lambda values: values.update(step=-1e-9),
        lambda values: values.update(idle=float("nan")),
        lambda values: values.update(laws=[1, 2]),
        lambda values: values.update(colour="red"),
        lambda values: values.update(machine="another"),
        lambda values: values.update(program="another"),
    ],
)
def test_a_damaged_or_foreign_cache_gives_the_shipped_model(damage, simulator, measured, tmp_path):
    values = json.loads(json.dumps(asdict(measured)))
    file = tmp_path / "cost.json"
    file.write_text(json.dumps(values))
    assert cost_model.load(simulator, file) == measured
    damage(values)
    file.write_text(json.dumps(values))
    assert cost_model.load(simulator, file) is SHIPPED


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"\xff\xfe", b"3"])
def test_a_cache_that_is_no_model_gives_the_shipped_one(text, simulator, tmp_path):
    file = tmp_path / "cost.json"
    file.write_bytes(text)
    assert cost_model.load(simulator, file) is SHIPPED


def test_without_cache_or_program_the_shipped_model_is_taken(simulator, measured, tmp_path):
    assert cost_model.load(simulator, tmp_path / "none.json") is SHIPPED
    file = cost_model.store(measured, tmp_path / "cost.json")
    assert cost_model.load(None, file) is SHIPPED
    simulator.executable.write_bytes(b"built anew")
    assert cost_model.load(simulator, file) is SHIPPED


def test_a_cache_that_cannot_be_written_says_what_to_set(measured, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("no directory")
    with pytest.raises(PlanError, match="XDG_CACHE_HOME"):
        cost_model.store(measured, Path(blocked) / "cost.json")


def test_the_shipped_model_knows_every_part_and_says_that_it_is_shipped():
    assert set(SHIPPED.laws) == set(PARTS)
    assert SHIPPED.origin == "shipped"
    assert all(getattr(SHIPPED, name) > 0 for name in NUMBERS)
