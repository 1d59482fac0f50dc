"""What accuracy costs: conclusions from fabricated numbers, the variants of a scene, and the promised accuracy in LIGGGHTS."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scene_files import DAHNEKE, MESH, PAIR, edited, written

from pyjkr import cli, resources
from pyjkr.cost import QUICK, Costs, Jobs, exact, figures, measure, page, report, results, tables, variants
from pyjkr.cost.impacts import Outcome, even_phases, execute, prepare, render
from pyjkr.cost.measure import rows_of
from pyjkr.cost.studies import Job
from pyjkr.plan import plan
from pyjkr.scene import load

# Of a fit through points that lie on a power law.
ROUND_OFF = 1e-10
# Equal impacts in different lanes of a deck: the same arithmetic at other coordinates along the wall.
LANES = 1e-12
# Similarity: round-off of the overlap, amplified near the threshold, as in compare.SIMILARITY_TOLERANCE.
SIMILARITY = 1e-6


@pytest.fixture(scope="module")
def dahneke():
    return load(resources.scene_file("dahneke"))


# --- conclusions ------------------------------------------------------------------------------------------------------


def test_order_is_that_of_the_power_law_beyond_the_coarsest_steps():
    steps = np.array([10, 20, 40, 100, 700])
    errors = 3.7 * steps**-1.25
    errors[0] = 0.9  # not yet on the power law
    assert results.convergence_order(steps, errors) == pytest.approx(1.25, rel=ROUND_OFF)


def test_order_leaves_out_round_off_and_needs_two_points():
    assert results.convergence_order([20, 40, 80, 160], [4e-3, 1e-3, 2.5e-4, 3e-14]) == pytest.approx(2.0, rel=ROUND_OFF)
    assert math.isnan(results.convergence_order([20, 40], [1e-3, 0.0]))


def test_worst_takes_the_largest_error_over_phases_and_speeds_and_a_nan_before_all():
    rows = pd.DataFrame(
        {"steps_per_collision": [20, 20, 60, 60], "phase": [0.1, 0.7, 0.1, 0.7], "error": [2e-3, 7e-3, math.nan, 5e-4]}
    )
    found = results.worst(rows, "error", ["steps_per_collision"]).set_index("steps_per_collision")
    assert found.loc[20, "phase"] == 0.7
    assert found.loc[60, "phase"] == 0.1


def impact_row(study, **keys):
    row = {"study": study, "target": "wall", "normal": "jkr", "event_correction": "on", "modulus_ratio": 1.0, "speed": 3.0}
    row |= {"steps_per_collision": 20, "phase": 0.25, "time_step": 1e-9 / keys.get("steps_per_collision", 20), "run_steps": 70}
    row |= {"computing_time": 4e-4, "time_per_step": 5e-8, "e": 0.61, "e_exact": 0.6, "e_error": 1e-2, "energy_error": 5e-3}
    row |= {"energy_error_relative": 1.4e-2, "decided_wrongly": 0, "tangential": 0.5, "spin": 0.3}
    return row | {"tangential_exact": 0.5, "spin_exact": 0.3} | keys


@pytest.fixture
def fabricated(dahneke):
    """Numbers as if measured: second order with correction, first order without, everything within the targets."""
    rows = []
    for corrected, order in (("on", 2), ("off", 1)):
        for steps in (20, 60, 200):
            for phase, factor in ((0.25, 1.0), (0.75, 0.3)):
                error = factor * 4e-3 * (20 / steps) ** order * (1 if corrected == "on" else 8)
                keys = {"steps_per_collision": steps, "phase": phase, "energy_error": error, "e_error": 0.9 * error}
                rows.append(impact_row("steps", event_correction=corrected, **keys))
        rows.append(impact_row("threshold", event_correction=corrected, decided_wrongly=int(corrected == "off")))
        for turn, disturbed in enumerate((1.0, 4.0, 1.1)):
            time = 5e-8 * disturbed * (1.2 if corrected == "on" else 1.0)
            rows.append(impact_row("time", event_correction=corrected, turn=turn, time_per_step=time))
    rows.append(impact_row("restitution", restitution_coefficient=0.95))
    for ratio, steps, corrected, total, error in ((1.0, 200, "off", 6000, 3e-2), (0.01, 20, "on", 100, 9e-3)):
        for phase in (0.25, 0.75):
            keys = {"steps_per_collision": steps, "event_correction": corrected, "modulus_ratio": ratio, "phase": phase}
            rows.append(impact_row("headline", run_steps=total, e_error=error, **keys))
    for ratio in (1.0, 0.1):
        for steps in (20, 60):
            keys = {"modulus_ratio": ratio, "steps_per_collision": steps}
            rows.append(impact_row("stiffness", **keys, time_step=1e-9 * ratio**-0.4 / steps))
            for rule in ("scaled", "originals"):
                exact_spin = 0.3 - (0.05 if ratio < 1 else 0.0)
                rows.append(impact_row("oblique", **keys, effect=rule, spin_exact=exact_spin, spin=exact_spin + 2e-3))
    for effect, e, time in (("everything", 0.6, 9e-8), ("no sliding", 0.6, 7e-8), ("no neck (jkr/simplified)", 0.8, 8e-8)):
        rows.append(impact_row("effects", effect=effect, e=e, tangential=0.7 if effect == "no sliding" else 0.5))
        rows += [impact_row("effects time", effect=effect, turn=turn, time_per_step=time * (1 + turn)) for turn in (0, 1, 2)]
    return Costs(dahneke, pd.DataFrame(rows), ("stiffness at E_mod/E = 0.001 and 3 m/s: too deep",))


def test_errors_by_steps_are_the_largest_over_phases_with_their_order(fabricated):
    table = results.errors_by_steps(fabricated).set_index("event_correction")
    assert table.loc["on", 20] == 4e-3
    assert table.loc["on", "order"] == pytest.approx(2.0, rel=ROUND_OFF)
    assert table.loc["off", "order"] == pytest.approx(1.0, rel=ROUND_OFF)


def test_steps_for_the_same_error_follow_from_the_fitted_power_law(fabricated):
    rows = results.steps_for_equal_error(fabricated).set_index("steps")
    # 8 times the error at 20 steps, of first order: 4e-3 needs 8 times the steps.
    assert rows.loc[20, "steps_without"] == pytest.approx(160, rel=ROUND_OFF)
    assert rows.loc[60, "steps_without"] == pytest.approx(160 * 9, rel=ROUND_OFF)


def test_time_ratio_is_the_median_of_ratios_within_a_turn(fabricated):
    (line,) = results.time_per_step(fabricated).to_dict("records")
    assert line["ratio"] == pytest.approx(1.2, rel=ROUND_OFF)


def test_steps_for_the_same_time_fall_with_the_stiffness(fabricated):
    rows = results.stiffness(fabricated).set_index(["modulus_ratio", "steps_per_collision"])
    assert rows.loc[(0.1, 60), "steps_for_time"] == pytest.approx(60 * 0.1**0.4, rel=ROUND_OFF)


def test_oblique_impacts_show_physical_change_and_error_apart(fabricated):
    rows = results.oblique(fabricated).set_index(["effect", "modulus_ratio", "steps_per_collision"])
    assert rows.loc[("scaled", 0.1, 20), "spin_change"] == pytest.approx(0.05, rel=ROUND_OFF)
    assert rows.loc[("scaled", 0.1, 20), "spin_error"] == pytest.approx(2e-3, rel=ROUND_OFF)


def test_an_effect_matters_where_the_outcome_changes(fabricated):
    rows = results.effects(fabricated).set_index("effect")
    assert rows.loc["no sliding", "largest_change"] == pytest.approx(0.2, rel=ROUND_OFF)
    assert rows.loc["no neck (jkr/simplified)", "largest_change"] == pytest.approx(0.2 / math.sqrt(2), rel=ROUND_OFF)
    assert rows.loc["no sliding", "time_ratio"] == pytest.approx(7 / 9, rel=ROUND_OFF)


def test_verdict_passes_and_names_what_fails(fabricated):
    assert fabricated.passed
    wrong = fabricated.table["energy_error"].where(fabricated.table["steps_per_collision"] != 60, 2e-3)
    worse = replace(fabricated, table=fabricated.table.assign(energy_error=wrong))
    assert not worse.passed
    assert "BAD error of e_eff^2 at 60 steps" in tables.text(worse)


def test_files_and_page_hold_every_table_and_no_nan(fabricated, tmp_path):
    report.write(fabricated, tmp_path, "0" * 64, "liggghts-jkr")
    content = json.loads((tmp_path / report.RESULT_NAME).read_text())
    assert content["passed"] is True
    assert content["headline"][1]["run_steps"] == 100
    assert len(pd.read_csv(tmp_path / report.TABLE_NAME)) == len(fabricated.table)
    page.write(fabricated, tmp_path, tmp_path / "docs.md", "pyjkr cost dahneke")
    text = (tmp_path / "docs.md").read_text()
    for table in tables.tables(fabricated):
        assert table.title in text
    for name in report.FIGURES:
        assert (tmp_path / "figures" / name).read_bytes() == (tmp_path / name).read_bytes()
        assert name in text


def test_every_point_of_the_work_precision_diagram_is_labelled_with_its_steps(fabricated):
    _, right = figures.steps_figure(fabricated).axes
    assert sorted(text.get_text() for text in right.texts) == sorted(["20", "60", "200"] * 2)


def test_wrong_decision_counts_and_errors_are_absolute(dahneke):
    scene = variants.one(variants.at(dahneke, "wall"), 5.0, 20)
    impacts = prepare("x", scene, even_phases(2))
    answer = exact.Exact(restitution=0.5, stuck=False, contact_time=1e-8)
    outcome = Outcome(np.array([0.0, 0.6]), np.array([True, False]), np.zeros(2), np.zeros(2), steps=50, computing_time=2e-3)
    rows = rows_of(Job({"study": "steps"}, impacts, lambda *_: answer), outcome)
    assert [row["decided_wrongly"] for row in rows] == [1, 0]
    assert [row["energy_error"] for row in rows] == pytest.approx([0.25, 0.11])
    assert [row["energy_error_relative"] for row in rows] == pytest.approx([1.0, 0.44])
    assert rows[0]["time_per_step"] == pytest.approx(2e-5)


# --- variants ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
@pytest.mark.parametrize("target", ["wall", "sphere"])
def test_every_scene_can_be_put_to_a_wall_and_to_a_sphere(tmp_path, text, target):
    scene = variants.at(load(written(tmp_path, text)), target)
    assert scene.impact.target == target
    assert len(plan(variants.one(scene, 0.4, 50)).cases[0].radii) == (1 if target == "wall" else 2)


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_oblique_variant_has_every_law(tmp_path, text):
    model = variants.oblique(load(written(tmp_path, text))).model
    assert (model.tangential, model.rolling_friction, model.twisting) == ("jkr", "krijt", True)


def test_variants_are_validated(dahneke):
    with pytest.raises(ValueError, match="friction_coefficient is missing"):
        variants.changed(dahneke, model={"tangential": "jkr"})


def test_scene_without_adhesion_keeps_its_own_speeds(tmp_path):
    scene = load(written(tmp_path, edited(DAHNEKE, ("surface_energy = 0.11", "surface_energy = 0.0"))))
    assert variants.speeds(scene, (1.1, 2.0)) == (2.0, 3.2, 5.0)
    assert variants.reference_speed(scene) == 3.2


def test_stiffnesses_that_press_too_deep_are_left_out_with_the_reason(dahneke):
    jobs = Jobs(dahneke, replace(QUICK, modulus_ratios=(1.0, 1e-4), steps=(20,)))
    jobs.stiffness()
    assert [job.keys["modulus_ratio"] for job in jobs.jobs] == [1.0]
    assert "E_mod/E = 0.0001" in jobs.left_out[0] and "maximum_overlap" in jobs.left_out[0]


def test_help_of_the_verb_ends_with_an_example(capsys):
    with pytest.raises(SystemExit):
        cli.main(["cost", "--help"])
    text = capsys.readouterr().out
    assert "Reads" in text and "writes" in text
    assert text.rstrip().splitlines()[-2] == "example:"


# --- in LIGGGHTS ------------------------------------------------------------------------------------------------------



@pytest.mark.liggghts
@pytest.mark.parametrize("text", [DAHNEKE, MESH], ids=["primitive", "mesh"])
def test_impacts_side_by_side_are_those_of_a_deck_each(plugin, tmp_path, text):
    scene = variants.one(variants.at(load(written(tmp_path, text)), "wall"), 3.0, 40)
    phases = (0.2, 0.9)
    together = execute(prepare("together", scene, phases), tmp_path, plugin)
    for index, phase in enumerate(phases):
        single = execute(prepare(f"single{index}", scene, (phase,)), tmp_path, plugin)
        assert single.restitution[0] == pytest.approx(together.restitution[index], abs=LANES)


@pytest.mark.liggghts
def test_finished_batch_is_not_run_again_and_a_changed_one_is(plugin, tmp_path, dahneke):
    scene = variants.one(variants.at(dahneke, "sphere"), 5.0, 30)
    impacts = prepare("batch", scene, even_phases(2))
    first = execute(impacts, tmp_path, plugin)
    stamp = (tmp_path / "batch" / "run.json").stat().st_mtime_ns
    assert (tmp_path / "batch" / "in.deck").read_text() == render(impacts)
    assert execute(impacts, tmp_path, plugin).computing_time == first.computing_time
    assert (tmp_path / "batch" / "run.json").stat().st_mtime_ns == stamp
    assert len(execute(prepare("batch", scene, even_phases(3)), tmp_path, plugin).restitution) == 3


@pytest.fixture(scope="module")
def accuracy(plugin, tmp_path_factory, dahneke):
    """Steps and threshold studies with event correction, coarse steps only."""
    jobs = Jobs(dahneke, replace(QUICK, phases=5, steps=(20, 60)))
    jobs.steps()
    jobs.threshold()
    jobs.jobs = [job for job in jobs.jobs if job.keys["event_correction"] == "on"]
    return measure(jobs, tmp_path_factory.mktemp("accuracy"), plugin)


@pytest.mark.liggghts
@pytest.mark.parametrize(("steps", "target"), results.TARGETS.items())
def test_rebound_energy_is_as_accurate_as_promised(accuracy, steps, target):
    rows = accuracy.study("steps")
    rows = rows[rows["steps_per_collision"] == steps]
    assert set(zip(rows["target"], rows["normal"], strict=True)) == {
        (body, law) for body in ("wall", "sphere") for law in ("jkr", "jkr/simplified")
    }
    worst = results.worst(rows, "energy_error", ["target", "normal"])
    assert (worst["energy_error"] < target).all(), worst


@pytest.mark.liggghts
def test_stuck_or_rebound_is_right_two_per_cent_from_the_threshold(accuracy):
    near = accuracy.study("threshold")
    assert len(near) == 2 * 2 * 2 * 5
    assert near["decided_wrongly"].sum() == 0


@pytest.mark.liggghts
def test_fifty_times_fewer_steps_at_no_larger_error(plugin, tmp_path, dahneke):
    scene = variants.changed(dahneke, impact={"speeds": (2.6, 5.0)})
    jobs = Jobs(scene, QUICK)
    jobs.headline()
    real, reduced = results.headline(measure(jobs, tmp_path, plugin)).to_dict("records")
    assert real["run_steps"] >= results.STEP_SAVING * reduced["run_steps"]
    assert reduced["e_error"] <= real["e_error"]


@pytest.mark.liggghts
def test_error_of_normal_impacts_does_not_depend_on_the_stiffness(plugin, tmp_path, dahneke):
    jobs = Jobs(dahneke, replace(QUICK, steps=(20,)))
    jobs.stiffness()
    e = measure(jobs, tmp_path, plugin).table.groupby("phase")["e"]
    assert (e.max() - e.min()).max() < SIMILARITY
