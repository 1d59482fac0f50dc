"""Ways to run a scene: what is on in each, how soft, how fine."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from planning_situations import PAIR, bed, meeting, situation

from pyjkr import timestep
from pyjkr.planning import plan, variants

ADHESIVE = {"adhesion", "neck", "sliding", "sliding_adhesion", "rolling", "twisting", "damping"}


def test_unreduced_is_real_stiffness_with_every_effect_at_fifty_steps_of_the_shortest_collision():
    scene = bed(meeting(PAIR, speed=3.0, tangential=2.0), meeting(speed=5.0))
    variant = variants.unreduced(scene)
    assert variant.modulus_ratio == 1.0
    assert variant.effects == ADHESIVE
    shortest = min(timestep.collision_time(each.pair, each.speed) for each in scene.meetings)
    assert variant.time_step == pytest.approx(shortest / 50)


def test_a_wish_is_off_in_unreduced_and_on_in_the_reference_that_shows_what_it_does():
    scene = bed(meeting(PAIR), wishes={"rolling": "off"})
    assert "rolling" not in variants.unreduced(scene).effects
    assert "rolling" in variants.reference(scene, scene.meetings[0]).effects
    assert "krijt" in variants.reference(scene, scene.meetings[0]).styles.text


def test_the_reference_resolves_collision_and_every_period():
    at = meeting(PAIR, speed=3.0)
    step = variants.reference(bed(at), at).time_step
    assert step <= timestep.collision_time(at.pair, at.speed) / 400 * (1 + 1e-12)
    assert step <= min(variants.fastest_periods(at.pair, at)) / 100 * (1 + 1e-12)


def test_the_reference_without_adhesion_keeps_event_correction():
    at = meeting(energy=0.0, hysteresis=0.0)
    at = replace(at, critical_rolling=math.inf)
    assert variants.unreduced(situation(at)).styles.normal == "hertz"
    assert variants.reference(situation(at), at).styles.normal == "jkr/simplified"


def test_rolling_needs_a_limit_and_gravity_an_acceleration():
    at = replace(meeting(PAIR), critical_rolling=math.inf)
    assert {"rolling", "twisting", "gravity"}.isdisjoint(variants.all_effects(bed(at)))
    assert "gravity" in variants.all_effects(bed(at, gravity=9.81))


def test_a_planned_pair_is_softened_and_keeps_the_real_moment_of_rolling_with_original_limits():
    at = meeting(PAIR, speed=0.3, slowest=0.1)
    made = variants.planned(plan.plan(bed(at, pulling_force=0.002 * at.pair.pull_off_force), 0.05))
    assert "original_limits" in made.effects
    soft, q = made.pair(at), made.modulus_ratio
    assert q < 0.5
    assert soft.effective_modulus == pytest.approx(q * at.pair.effective_modulus)
    assert soft.pull_off_force == pytest.approx(q**0.4 * at.pair.pull_off_force)
    assert soft.surface_energy_of_rolling == at.pair.surface_energy
    without = replace(made, effects=made.effects - {"original_limits"}).pair(at)
    assert without.surface_energy_of_rolling == pytest.approx(q**0.4 * at.pair.surface_energy)


def test_what_is_off_is_absent_from_the_pair():
    at = meeting(PAIR)
    bare = variants.Variant(
        name="planned", effects=frozenset({"sliding"}), modulus_ratio=0.1, styles=variants.of_effects({"sliding"}), time_step=1e-9
    )
    assert bare.pair(at).surface_energy == 0
    assert bare.pair(at).restitution_coefficient == 1.0
