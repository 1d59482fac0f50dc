"""`verify`: sound plans hold, wrong ones are caught, whole runs are kept."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from planning_situations import PAIR, SINGLE, bed, meeting, situation

from pyjkr.planning import collisions, variants, verify
from pyjkr.planning.plan import ApplicationPlan, plan
from pyjkr.planning.probe_parts import Quantity


def scene_of_dust():
    """Pairs that meet slowly enough to stick and fast enough to rebound; their clusters feel a weak drag."""
    at = meeting(PAIR, speed=4.0, slowest=0.5, tangential=4.0)
    return bed(at, pulling_force=1e-3 * at.pair.pull_off_force, contacts_per_particle=1.0, particles=300)


def scene_that_rolls():
    """A sphere that grazes a wall, sticks, and rolls until it rests."""
    return situation(meeting((5e-6,), speed=0.08, tangential=1.0), lasting=True, particles=1, time=4e-5)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """References are kept from test to test; runs of the plans are not the same."""
    return tmp_path_factory.mktemp("verify")


@pytest.fixture
def brief(monkeypatch):
    """Times of a step are measured, but not well."""
    monkeypatch.setattr(verify, "BED_TURNS", 1)


def softer(made: ApplicationPlan, factor: float) -> ApplicationPlan:
    """Softer by a factor, with as many steps in a collision."""
    return replace(
        made, modulus_ratio=made.modulus_ratio / factor, step=replace(made.step, value=made.step.value * factor**0.4)
    )


def coarser(made: ApplicationPlan, steps: float) -> ApplicationPlan:
    """With so many steps in a collision."""
    return replace(made, step=replace(made.step, value=made.step.value * made.steps_per_collision / steps))


def wrong(found: verify.Verification) -> set[str]:
    """Quantities that do not hold."""
    return {row.quantity for row in found.rows if not row.holds}


@pytest.mark.liggghts
@pytest.mark.parametrize("max_error", [0.05, 0.01])
@pytest.mark.parametrize("scene", [scene_of_dust, scene_that_rolls])
def test_a_plan_holds(plugin, brief, runs, scene, max_error):
    found = verify.verify(plan(scene(), max_error), runs, plugin)
    assert found.holds, verify.text(found)
    judged = [row for row in found.rows if row.limit]
    assert max(row.error for row in judged) > 0
    assert found.speed_up > 1


@pytest.mark.liggghts
def test_whole_runs_are_kept_and_progress_is_told(plugin, brief, tmp_path, monkeypatch):
    made, told = plan(scene_that_rolls(), 0.05), []
    first = verify.verify(made, tmp_path, plugin, lambda done, of: told.append((done, of)))
    assert told == [(number, len(told)) for number in range(1, len(told) + 1)]
    assert len(told) == 3

    def never(*arguments, **keys):
        raise AssertionError("a whole run is repeated")

    monkeypatch.setattr(verify.probe_deck, "run_deck", never)
    assert verify.verify(made, tmp_path, plugin) == first


@pytest.mark.liggghts
def test_too_soft_a_plan_is_caught(plugin, brief, runs):
    made = softer(plan(scene_of_dust(), 0.05), 100)
    assert "volume strain by overlaps" in wrong(verify.verify(made, runs, plugin))
    rolls = softer(plan(scene_that_rolls(), 0.05), 100)
    assert "way rolled until at rest" in wrong(verify.verify(rolls, runs, plugin))


@pytest.mark.liggghts
def test_three_steps_a_collision_are_caught(plugin, brief, tmp_path):
    at = meeting(SINGLE, speed=8.0)
    made = coarser(plan(situation(at), 0.01), 3)
    assert "e_eff^2" in wrong(verify.verify(made, tmp_path, plugin))


@pytest.mark.liggghts
@pytest.mark.parametrize(
    ("scene", "effect", "quantity"),
    [
        (scene_that_rolls, "rolling", "way rolled until at rest"),
        (scene_of_dust, "twisting", "moment of twisting"),
        (scene_of_dust, "original_limits", "moment of sliding"),
        (scene_of_dust, "adhesion", "sticking"),
    ],
)
def test_an_effect_that_is_forced_off_where_it_is_needed_is_caught(plugin, brief, runs, scene, effect, quantity):
    wishes = {effect: "off"}
    made = plan(replace(scene(), wishes=wishes), 0.05)
    if effect == "original_limits":
        # Without them the plan does not soften; with this stiffness the strength would be lost.
        made = softer(made, 100)
    assert not made.on(effect)
    assert quantity in wrong(verify.verify(made, runs, plugin))


@pytest.mark.liggghts
def test_step_times_tell_the_full_law_from_the_stock_one(plugin, tmp_path):
    scene = bed(meeting(PAIR))
    full = variants.unreduced(scene)
    bare = replace(full, name="bare", styles=variants.of_effects({"damping"}))
    slow, fast = verify.step_times(scene, (full, bare), tmp_path, plugin)
    assert 1e-9 < fast < slow < 1e-5


def quantity(values, **keys) -> Quantity:
    return Quantity(name="e_eff^2", values=np.array(values, dtype=float), **keys)


def test_an_error_is_the_largest_of_all_lanes():
    row = verify.compare("probe", quantity([0.30, 0.42]), quantity([0.31, 0.40]), 0.015)
    assert row.error == pytest.approx(0.02)
    assert (row.planned, row.reference) == (0.42, 0.40)
    assert not row.holds
    assert verify.compare("probe", quantity([0.30]), quantity([0.31]), 0.015).holds


def test_a_relative_error_is_taken_of_no_less_than_the_floor():
    ours, theirs = quantity([0.0], relative=True), quantity([2e-3], relative=True, floor=0.5)
    assert verify.compare("probe", ours, theirs, 0.05).error == pytest.approx(4e-3)
    assert verify.compare("probe", ours, replace(theirs, floor=0.0), 0.05).error == pytest.approx(1.0)


def test_what_is_not_promised_is_shown_and_not_judged():
    row = verify.compare("probe", quantity([0.1], promised=False, note="why"), quantity([0.4]), 0.05)
    assert (row.error, row.limit, row.holds, row.note) == (pytest.approx(0.3), None, True, "why")


def test_decisions_on_the_threshold_are_not_counted_and_clear_ones_are():
    ours = quantity([1, 1, 0], decision=True, margin=np.array([0.0, 0.0, 0.3]))
    near = quantity([0, 1, 0], decision=True, margin=np.array([0.04, 0.0, 0.3]))
    clear = replace(near, margin=np.array([0.06, 0.0, 0.3]))
    assert verify.compare("probe", ours, near, 0.05).holds
    assert "1 of 3" in verify.compare("probe", ours, near, 0.05).note
    row = verify.compare("probe", ours, clear, 0.05)
    assert not row.holds
    assert row.error == pytest.approx(1 / 3)


def test_speeds_of_what_sticks_in_one_run_only_are_left_to_the_decision():
    assert verify.compare("probe", quantity([np.nan]), quantity([0.4]), 0.05) is None


def example(**keys) -> verify.Verification:
    rows = (
        verify.Row(probe="a wall", quantity="e_eff^2", planned=0.31, reference=0.30, error=0.01, limit=0.05),
        verify.Row(probe="a pair", quantity="e_eff^2", planned=0.37, reference=0.30, error=0.07, limit=0.05),
        verify.Row(probe="a pair", quantity="spin times radius", planned=0.7, reference=0.3, error=0.4, limit=None, note="not the result"),
    )
    return verify.Verification(**({
        "title": "dust", "max_error": 0.05, "rows": rows, "planned_step_time": 2e-7, "unreduced_step_time": 3e-7,
        "budget": {"time step": 0.004, "softening, turning": 0.02, "without neck": 0.01},
        "planned_wall_time": 4.0, "unreduced_wall_time": 84.0, "speed_up": 21.0,
    } | keys))  # fmt: skip


def test_the_text_puts_the_estimate_beside_the_largest_error():
    lines = verify.text(example()).splitlines()
    # Normal impacts are similar exactly: the softening is no part of their estimate.
    assert any(line.split() == ["e_eff^2", "0.07", "0.014", "0.05"] for line in lines)
    assert any(line.startswith("a pair") and line.endswith("BAD") for line in lines)
    assert any(line.startswith("a pair") and line.endswith("not judged") for line in lines)
    assert any("not the result" in line for line in lines)
    assert lines[-1].startswith("1 of 2 hold; worst: e_eff^2 of a pair")
    assert any("21 times faster" in line for line in lines)
    assert "slower" in verify.text(example(speed_up=0.5))


def test_json_holds_every_row_and_no_infinity():
    values = verify.to_json(example(budget={"without rolling": float("inf"), "time step": 0.004}))
    read = json.loads(json.dumps(values, allow_nan=False))
    assert read["holds"] is False
    assert [row["holds"] for row in read["rows"]] == [True, False, None]
    assert read["budget"] == {"without rolling": None, "time step": 0.004}
    assert read["speed_up"] == 21.0


def test_sticking_scene_of_these_tests_spans_the_sticking_speed():
    at = scene_of_dust().meetings[0]
    assert at.slowest_speed < collisions.sticking_speed(at.pair, "jkr") < at.speed
