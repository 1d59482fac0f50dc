"""Whole plans: of shipped cases and of situations that are refused; their tables; that the planned deck is right."""

from __future__ import annotations

import math

import pytest
from planning_situations import PAIR, SINGLE, UNEQUAL, at_angle, bed, change, energy_kept, meeting, outcome, situation
from scene_files import DAHNEKE, edited, written
from simulation import Materials, Simulation, Sphere

from pyjkr import contact as contact_laws
from pyjkr import oracle
from pyjkr.errors import PlanError
from pyjkr.planning import table
from pyjkr.planning.impact_scene import situation_of_impact
from pyjkr.planning.plan import plan
from pyjkr.planning.situation import EFFECTS
from pyjkr.resources import scene_file
from pyjkr.scene import load

FULL = at_angle(UNEQUAL, 8.0, 45)


@pytest.fixture(scope="module")
def dahneke():
    return situation_of_impact(load(scene_file("dahneke")))


def test_dahneke_is_planned_soft_with_neck_and_without_friction(dahneke):
    made = plan(dahneke, 0.05)
    assert {effect for effect in EFFECTS if made.on(effect)} == {"adhesion", "neck", "damping"}
    assert made.styles.pair == "model jkr"
    # 0.5 R is what the scene allows at 20 m/s.
    assert made.binding.name == "overlap in impacts"
    assert made.modulus_ratio == pytest.approx(0.041)
    assert made.steps_per_collision >= 20 and made.limiting_mode == "collision"
    assert made.time_step == made.step.value


def test_situation_of_an_impact_is_that_of_its_scene(dahneke):
    (only,) = dahneke.meetings
    assert (only.slowest_speed, only.speed, only.tangential_speed) == (1.0, 20.0, 0.0)
    assert only.radii == (0.635e-6,) and dahneke.about == "impact" and dahneke.maximum_overlap == 0.5
    # Haervig 2017, fig. 5: F_C = 3 pi R gamma.
    assert only.pair.pull_off_force == pytest.approx(3 * math.pi * 0.635e-6 * 0.11)
    assert dahneke.lasting


def test_angle_and_environment_of_a_scene_reach_its_situation(tmp_path):
    text = edited(
        DAHNEKE,
        ('tangential = "off"', 'tangential = "jkr"'),
        ("restitution_coefficient = 0.86", "restitution_coefficient = 0.86\nfriction_coefficient = 0.3"),
        ("phase = 0.37", "phase = 0.37\nangle = 60.0"),
    )
    found = situation_of_impact(load(written(tmp_path, text + "\n[environment]\nacceleration = 9.81\nexternal_force = 1e-12\n")))
    (only,) = found.meetings
    assert only.tangential_speed == pytest.approx(only.speed * math.tan(math.radians(60)))
    assert only.friction_coefficient == 0.3 and found.gravity == 9.81 and found.pulling_force == 1e-12


@pytest.mark.parametrize("max_error", [0.02, 0.1])
@pytest.mark.parametrize(("radii", "degrees"), [(SINGLE, 45), (PAIR, 30), (UNEQUAL, 60)])
def test_planned_impact_is_within_the_error_of_the_full_one(radii, degrees, max_error):
    at = at_angle(radii, 8.0, degrees)
    made = plan(situation(at), max_error)
    options = {"rolling": made.on("rolling"), "sliding": made.on("sliding")}
    law = "jkr" if made.on("neck") else "jkr/simplified"
    planned = outcome(at, made.modulus_ratio, law, originals=made.on("original_limits"), **options)
    real = outcome(at, twisting=True)
    assert made.modulus_ratio < 1
    assert change(planned, real) + made.step.error <= max_error


def test_fast_impacts_are_planned_without_adhesion_and_within_the_error():
    at = meeting(speed=60.0, modulus=2e11)
    made = plan(situation(at), 0.05)
    assert made.styles.pair == "model hertz"
    assert abs(energy_kept(at) - 0.7**2) + made.step.error <= 0.05


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (situation(meeting(modulus=3e13), wishes={"adhesion": "on"}), "Tabor number .* DMT"),
        (situation(meeting(speed=90.0)), "R deep, limit 0.1 R"),
        (bed(pulling_force=5e-7), "exceeds the 4.71e-07 N"),
        (situation(meeting(slowest=0.0)), "must be above 0"),
    ],
    ids=["Tabor", "overlap", "pull", "speed"],
)
def test_what_no_stiffness_puts_right_is_refused_in_one_line(made, words):
    with pytest.raises(PlanError, match=words) as caught:
        plan(made, 0.05)
    text = str(caught.value)
    assert text.startswith("scene.toml: ") and "\n" not in text and text.endswith(".")


def test_refusals_begin_where_the_oracle_says():
    at = meeting(restitution=1.0)
    deepest = oracle.impact(
        oracle.NormalContact(1e-6, at.pair.effective_modulus, 0.05, "jkr", 1.0), at.pair.effective_mass, 40.0, samples=2
    ).maximum_overlap
    for allowed, is_right in ((1.01 * deepest / 1e-6, True), (0.99 * deepest / 1e-6, False)):
        scene = situation(meeting(speed=40.0, restitution=1.0), maximum_overlap=allowed)
        if is_right:
            assert plan(scene, 0.05).modulus_ratio > 0.9
        else:
            with pytest.raises(PlanError, match="R deep"):
                plan(scene, 0.05)


@pytest.mark.parametrize("max_error", [0.0, math.nan, 2.0])
def test_errors_that_make_no_sense_are_refused(max_error):
    with pytest.raises(PlanError, match="max_error"):
        plan(situation(), max_error)


def test_warnings_name_what_the_user_must_know():
    forced = plan(bed(FULL, wishes={"rolling": "off"}), 0.05)
    assert any("rolling is off, though it would matter" in line for line in forced.warnings)
    assert any("spin after a single oblique impact" in line for line in forced.warnings)
    hard = plan(situation(meeting(speed=1.0, modulus=2e11)), 0.05)
    assert any("Tabor number" in line for line in hard.warnings)
    heavy = plan(bed(gravity=9.81, weight_carried=2e-7), 0.05)
    assert heavy.modulus_ratio == 1.0 and any("allows no softening" in line for line in heavy.warnings)
    assert not plan(situation(), 0.05).warnings


def test_smaller_error_costs_more_steps_or_stiffness():
    loose, tight = (plan(situation(FULL), error) for error in (0.1, 0.004))
    assert tight.time_step < loose.time_step and tight.modulus_ratio > loose.modulus_ratio
    assert sum(tight.budget.values()) < 0.004 or any("add up" in line for line in tight.warnings)


def test_terminal_table_names_every_effect_limit_and_time_scale():
    made = plan(bed(FULL, gravity=9.81, weight_carried=1e-12), 0.05)
    text = table.text(made)
    for name in (*EFFECTS, *(limit.name for limit in made.limits), *(mode.name for mode in made.step.modes)):
        assert name in text
    assert f"{made.modulus_ratio:g}" in text and made.styles.pair in text


def test_explanation_gives_every_number_with_formula_and_source():
    made = plan(bed(FULL, gravity=9.81, weight_carried=1e-12), 0.05)
    text = table.explain(made)
    for each in (*made.decisions, *made.limits, *made.step.modes):
        assert each.formula in text and each.source in text


def test_comments_fit_into_a_deck():
    lines = table.comments(plan(bed(FULL), 0.05))
    assert all(len(line) <= 138 and "\n" not in line and line == line.rstrip() for line in lines)
    assert any("sliding_adhesion" in line for line in lines) and any("time step" in line for line in lines)


@pytest.mark.liggghts
@pytest.mark.parametrize("wishes", [{}, {"adhesion": "off"}, {"adhesion": "off", "sliding": "off"}, {"neck": "off", "rolling": "off"}])
def test_liggghts_runs_what_is_planned_to_the_planned_error(plugin, tmp_path, wishes):
    at = meeting(SINGLE, speed=6.0, tangential=0.0 if wishes.get("sliding") == "off" else 0.5)
    made = plan(situation(at, wishes=wishes), 0.05)
    q, styles, pair = made.modulus_ratio, made.styles, at.pair
    youngs = contact_laws.particle_modulus(pair.effective_modulus, 0.3)
    values = {
        "youngsModulus": q * youngs, "poissonsRatio": 0.3, "coefficientRestitution": pair.restitution_coefficient,
        "coefficientFriction": at.friction_coefficient, "surfaceEnergy": q**0.4 * pair.surface_energy,
        "surfaceEnergyOriginal": pair.surface_energy, "youngsModulusOriginal": youngs, "adhesionHysteresis|criticalRollingAngle": 0.3,
    }  # fmt: skip
    properties = {name.split("|")[0]: values[name] for name in styles.properties}
    height = at.radii[0] + 7.4 * at.speed * made.time_step
    number = math.ceil(7.4 + 3 * made.steps_per_collision)
    simulated = Simulation(
        [Sphere((0.0, 0.0, height), at.radii[0], at.densities[0], velocity=(at.tangential_speed, 0.0, -at.speed))],
        Materials(1, properties), time_step=made.time_step, steps=number, style=styles.pair, keywords=styles.keywords,
        walls=["primitive type 1 zplane 0.0"], every=number,
    )  # fmt: skip
    last = simulated.run(plugin, tmp_path).iloc[-1]
    law = "jkr" if styles.normal == "hertz" else styles.normal
    exact = energy_kept(at, law, energy=0.0 if styles.normal == "hertz" else None)
    assert last["vz"] > 0
    assert (last["vz"] / at.speed) ** 2 == pytest.approx(exact, abs=0.05 / 4)
