"""The plan: similar motions at every stiffness, equal simulated time, and refusals before anything runs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scene_files import DAHNEKE, MESH, PAIR, edited, written

from pyjkr import resources
from pyjkr.errors import PlanError
from pyjkr.plan import FLIGHT_STEPS, plan
from pyjkr.scene import load

# A run ends on a whole frame, one step apart at 200 steps per collision, and lasts 1000 steps or more.
ROUNDING_OF_STEPS = 2e-3


def planned(directory, text):
    return plan(load(written(directory, text)))


def by_rule(made, rule, speed):
    return {case.modulus_ratio: case for case in made.cases if (case.rule, case.speed) == (rule, speed)}


def test_there_is_one_case_for_each_speed_ratio_and_rule(tmp_path):
    made = planned(tmp_path, DAHNEKE)
    assert [(case.speed, case.modulus_ratio, case.rule) for case in made.cases] == [
        (speed, ratio, rule)
        for speed in (2.0, 3.2, 5.0)
        for ratio, rule in ((1.0, "scaled"), (0.1, "scaled"), (0.2, "unmodified"))
    ]
    assert len({case.label for case in made.cases}) == 9


def test_numbers_of_dahnekes_sphere(tmp_path):
    # gamma q^(2/5) = 0.11 * 0.1^0.4 = 0.0437918; E_i = 2 (1 - nu^2) E; a_0/R = 0.262 (three digits).
    case = by_rule(planned(tmp_path, DAHNEKE), "scaled", 5.0)[0.1]
    assert case.pair.surface_energy == pytest.approx(0.0437918, rel=1e-6)
    assert case.pair.effective_modulus == pytest.approx(27.1e6, rel=1e-14)
    assert case.youngs_moduli == pytest.approx((2 * (1 - 0.33**2) * 27.1e6, 2 * (1 - 0.17**2) * 27.1e6), rel=1e-14)
    assert case.original.equilibrium_contact_radius / 0.635e-6 == pytest.approx(0.262, rel=2e-3)


def test_unmodified_cases_keep_the_surface_energy(tmp_path):
    assert by_rule(planned(tmp_path, DAHNEKE), "unmodified", 5.0)[0.2].pair.surface_energy == 0.11


@settings(max_examples=25, deadline=None)
@given(phase=st.floats(0, 0.999), ratio=st.floats(math.log(0.02), math.log(0.9)).map(math.exp), speed=st.floats(0.5, 6))
def test_discrete_motions_at_two_stiffnesses_are_similar(tmp_path_factory, phase, ratio, speed):
    text = edited(DAHNEKE, ("phase = 0.37", f"phase = {phase!r}"), ("[2.0, 3.2, 5.0]", f"[{speed!r}]"),
                  ("[1.0, 0.1]", f"[1.0, {ratio!r}]"), ("velocity_speed = 5.0", f"velocity_speed = {speed!r}"))  # fmt: skip
    made = planned(tmp_path_factory.mktemp("scene"), text)
    stiff, soft = by_rule(made, "scaled", speed).values()
    for name in ("time_step", "start_gap", "maximum_overlap"):
        assert getattr(soft, name) / getattr(stiff, name) == pytest.approx(ratio**-0.4, rel=1e-9)
    for case in (stiff, soft):
        steps_to_contact = case.start_gap / (case.normal_speed * case.time_step)
        assert steps_to_contact == pytest.approx(FLIGHT_STEPS + phase, rel=1e-14)
    assert soft.duration == pytest.approx(stiff.duration, rel=ROUNDING_OF_STEPS)


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_every_run_outlasts_four_collisions_of_its_softest_case(tmp_path, text):
    made = planned(tmp_path, text)
    for case in made.cases:
        slowest = max(
            max(other.periods["Hertz collision"], other.periods["stuck oscillation"])
            for other in made.cases
            if other.speed == case.speed
        )
        assert case.duration - case.contact_begins >= 4 * slowest


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_the_last_step_is_a_frame(tmp_path, text):
    for case in planned(tmp_path, text).cases:
        assert case.dense_steps % case.dense_interval == 0
        assert (case.steps - case.dense_steps) % case.coarse_interval == 0


def test_cases_that_press_too_deep_are_left_out_with_the_reason():
    made = plan(load(resources.scene_file("dahneke")))
    scaled = {(item.modulus_ratio, item.speed): item for item in made.left_out if item.rule == "scaled"}
    assert set(scaled) == {(0.01, 10.0), (0.01, 14.0), (0.01, 20.0)}
    assert scaled[0.01, 20.0].reason == "may press 0.87 R deep, limit 0.5 R"
    # At E_mod/E = 0.01 without eq. 24 the sphere rests 0.49 R deep.
    assert all(item.modulus_ratio == 0.01 for item in made.left_out)
    assert all(case.maximum_overlap <= 0.5 * case.pair.effective_radius for case in made.cases)


def test_a_scene_without_any_possible_case_is_refused(tmp_path):
    with pytest.raises(PlanError, match="every case may press deeper than maximum_overlap = 0.01 R"):
        planned(tmp_path, edited(DAHNEKE, ("[reduction]", "[reduction]\nmaximum_overlap = 0.01")))


def test_moduli_outside_liggghts_range_are_announced(tmp_path):
    hard, soft = (case for case in planned(tmp_path, PAIR).cases if case.speed == 1.5)
    assert hard.stiffness_commands == ("hard_particles",)
    assert soft.stiffness_commands == ("soft_particles",)
    assert all(case.stiffness_commands == () for case in planned(tmp_path, DAHNEKE).cases)
    wide = edited(PAIR, ("[0.5, 0.001]", "[0.02]"), ("3.4e9", "2e8"))
    assert planned(tmp_path, wide).cases[0].stiffness_commands == ("soft_particles", "hard_particles")


def test_enough_steps_of_a_jkr_contact_need_no_warning(tmp_path):
    assert planned(tmp_path, DAHNEKE).warnings == ()


def test_the_tabor_number_of_the_real_material_is_looked_at(tmp_path):
    assert "Tabor number 1.06" in planned(tmp_path, MESH).warnings[0]


def test_the_skin_is_longer_than_the_longest_neck(tmp_path):
    assert all(case.skin > -case.rupture_overlap > 0 for case in planned(tmp_path, PAIR).cases)
    with pytest.raises(PlanError, match="is shorter than the neck"):
        planned(tmp_path, PAIR + "\n[numerics]\nskin = 1e-10\n")


def test_an_oblique_impact_is_planned_by_its_normal_speed(tmp_path):
    case = planned(tmp_path, MESH).cases[0]
    assert case.normal_speed == pytest.approx(0.5 * math.cos(math.radians(40)))
    assert math.hypot(case.normal_speed, case.tangential_speed) == pytest.approx(0.5)
