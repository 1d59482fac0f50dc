"""The estimate: steps and times scale as they must, contacts and room follow from the situation, and real scenes take about as long."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from planning_situations import PAIR, SINGLE, bed, meeting, situation

from pyjkr.application import deck, places, scene
from pyjkr.application.situation import situation as of_scene
from pyjkr.contact import break_energy
from pyjkr.planning import estimate, neighbours, variants
from pyjkr.planning.cost_model import SHIPPED
from pyjkr.planning.estimate import BREAKING, DENSEST, GROWN, LOOSEST, Around
from pyjkr.planning.plan import plan
from pyjkr.resources import directory

BED = bed(meeting(PAIR, speed=1.3, slowest=0.4), particles=700)
# The time of a step and nothing else.
STEPS_ONLY = replace(
    SHIPPED, sphere=0.0, idle=0.0, rebuild_sphere=0.0, rebuild_candidate=0.0, start=0.0, frame=0.0, frame_sphere=0.0,
    laws=dict.fromkeys(SHIPPED.laws, 0.0),
)  # fmt: skip


def of(where=BED, model=SHIPPED, max_error=0.05, **more):
    return estimate.estimate(plan(where, max_error), model, **more)


def test_steps_fill_the_time_of_the_scene():
    made = plan(BED)
    assert of().steps == math.ceil(BED.time / made.time_step)
    assert of().unreduced_steps == math.ceil(BED.time / variants.unreduced(BED).time_step)


def test_half_the_step_doubles_the_time_of_steps_and_not_of_output():
    made = plan(BED)
    around = Around(frames=40)
    fixed = SHIPPED.start + 40 * (SHIPPED.frame + 700 * SHIPPED.frame_sphere)
    # Lists are made anew by motion, not by steps: without them all is by step.
    model = replace(SHIPPED, rebuild_sphere=0.0, rebuild_candidate=0.0)
    whole = estimate.estimate(made, model, around=around).wall_time - fixed
    halved = estimate.estimate(replace(made, step=replace(made.step, value=made.time_step / 2)), model, around=around).wall_time - fixed
    # Steps are rounded up; the shortest skin, two steps long at high speed, does not bind here.
    assert halved == pytest.approx(2 * whole, rel=2 / of().steps)


@pytest.mark.parametrize("ratio", [0.1, 1e-3])
def test_with_steps_alone_stiffness_speeds_up_by_its_power(ratio):
    # Stuck pairs: every time is m^(1/2) E^(-1/5) gamma^(-1/2)..., so that with gamma_mod = gamma q^(2/5) it goes as q^(-2/5).
    made = plan(BED)
    real = variants.unreduced(BED).time_step
    softened = replace(made, modulus_ratio=ratio, step=replace(made.step, value=real * ratio**-0.4))
    found = estimate.estimate(softened, STEPS_ONLY)
    assert found.speed_up == pytest.approx(ratio**-0.4, rel=1e-9)
    assert found.unreduced_wall_time / found.wall_time == pytest.approx(ratio**-0.4, rel=2 / found.steps)


def test_speed_up_is_known_without_a_duration():
    timeless = replace(BED, time=0.0)
    assert of(timeless).speed_up == of().speed_up
    assert (of(timeless).steps, of(timeless).wall_time) == (0, SHIPPED.start)


def test_twice_the_spheres_take_twice_the_time_less_what_a_step_takes_anyway():
    model = replace(SHIPPED, step=0.0, start=0.0)
    assert of(replace(BED, particles=1400), model).wall_time == pytest.approx(2 * of(BED, model).wall_time, rel=1e-12)


def test_an_effect_more_costs_its_part_of_the_law():
    made = plan(BED)
    free = replace(SHIPPED, laws=SHIPPED.laws | {"rolling_friction krijt": 0.0, "twisting on": 0.0})
    unreduced = variants.unreduced(BED)
    assert "krijt" in unreduced.styles.text and unreduced.styles.twisting
    parts = SHIPPED.laws["rolling_friction krijt"] + SHIPPED.laws["twisting on"]
    found, cheaper = (estimate.estimate(made, model).unreduced_wall_time for model in (SHIPPED, free))
    assert found - cheaper == pytest.approx(estimate.contacts(BED) * parts * of().unreduced_steps, rel=1e-9)


def test_what_is_around_costs_what_the_model_says():
    steps, plain = of().steps, of().wall_time
    assert of(around=Around(frames=9)).wall_time - plain == pytest.approx(9 * (SHIPPED.frame + 700 * SHIPPED.frame_sphere))
    assert of(around=Around(forces=3)).wall_time - plain == pytest.approx(steps * 700 * 3 * SHIPPED.force)
    assert of(around=Around(triangles=144)).wall_time - plain == pytest.approx(steps * 144 * SHIPPED.triangle)
    # An empty box never pays for bins what LIGGGHTS' own would take.
    wide = of(around=Around(box_volume=1.0)).neighbours
    assert wide.bin_size > of().neighbours.bin_size


def test_two_ranks_take_more_than_half_the_time_and_less_than_all_of_it():
    alone, shared = of().wall_time - SHIPPED.start, of(ranks=2).wall_time - SHIPPED.start
    assert alone / 2 < shared < alone


def test_pairs_across_periodic_boundaries_are_those_of_a_lattice_of_points_at_random():
    rng = np.random.default_rng(11)
    ends = rng.random((200_000, 3))
    directions = rng.normal(size=(200_000, 3))
    radius, lengths = 1e-6, (9e-6, 14e-6)
    ends = ends[:, :2] * lengths + 2 * radius * (directions / np.linalg.norm(directions, axis=1)[:, None])[:, :2]
    crossed = ((ends < 0) | (ends > lengths)).sum() / len(ends)
    # Some 36000 crossings.
    assert estimate.crossing(BED, lengths) == pytest.approx(crossed, rel=0.03)
    crossed_time = of(around=Around(periodic_lengths=lengths)).wall_time - of().wall_time
    law = SHIPPED.contact(plan(BED).styles.text) * estimate.contacts(BED) + SHIPPED.idle * 700 * of().neighbours.idle
    assert crossed_time == pytest.approx(of().steps * estimate.crossing(BED, lengths) * law)


@pytest.mark.parametrize(("contacts", "fraction"), [(0.0, 0.0), LOOSEST, DENSEST, (12.0, DENSEST[1])])
def test_solid_fraction_is_that_of_the_packings_at_their_ends(contacts, fraction):
    assert estimate.solid_fraction(contacts) == pytest.approx(fraction)


def test_contacts_are_counted_once_for_a_pair_and_grow_with_a_structure():
    assert estimate.contacts(BED) == pytest.approx(GROWN * 700 * 4 / 2)
    lone = situation(meeting(SINGLE), particles=3, contacts_per_particle=1.0)
    assert estimate.contacts(lone) == 3
    # A strength is tested on a structure that is there.
    assert estimate.contacts(replace(BED, about="strength")) == 700 * 4 / 2


def test_an_impact_that_breaks_all_contacts_many_times_leaves_hardly_any_and_a_slow_one_all():
    def left(speed: float) -> float:
        return estimate.mean_contacts(bed(meeting(PAIR, speed=speed, slowest=speed), about="impact")) / 4.0

    pair = meeting(PAIR).pair
    # Kinetic energy of one sphere (twice the effective mass) that could break 1/BREAKING times its share of contacts, 4/2.
    half = math.sqrt(2 * break_energy(pair) * 2 / BREAKING / (2 * pair.effective_mass))
    assert left(half) == pytest.approx(0.5, rel=1e-3)
    assert left(1e-3 * half) == pytest.approx(1.0, rel=1e-5)
    assert left(100 * half) < 2e-4


def test_break_energy_is_the_work_of_the_law():
    pair = meeting(PAIR).pair
    unit = pair.pull_off_force * pair.equilibrium_contact_radius**2 / pair.effective_radius
    assert pytest.approx(break_energy(pair) / unit, abs=5e-5) == 0.2574


@pytest.mark.parametrize("name", ["head_on_pair", "oblique_wall", "ash_on_tube", "agglomerate_break_up", "dust_coagulation", "packed_bed"])
@pytest.mark.parametrize("max_error", [0.01, 0.05])
def test_every_shipped_scene_has_an_estimate(name, max_error):
    where = of_scene(scene.load(directory("cases") / name / "scene.toml"))
    found = of(where, max_error=max_error)
    assert found.steps > 0
    assert SHIPPED.start < found.wall_time < found.unreduced_wall_time
    assert found.speed_up > 1
    assert 0 < found.neighbours.skin <= neighbours.MOST_SKIN_IN_RADII * min(min(at.radii) for at in where.meetings)


@pytest.mark.liggghts
def test_a_scene_in_liggghts_has_the_contacts_and_makes_the_lists_that_are_estimated(plugin, tmp_path):
    # Counts and not times: whoever else is at work on the machine does not change them.
    dust = scene.load(directory("cases") / "dust_coagulation" / "scene.toml")
    where = of_scene(dust)
    variant = variants.planned(plan(where))
    lists = deck.neighbour_lists(dust, variant)
    run = deck.simulate(dust, variant, tmp_path, simulator=plugin, progress=False)
    log = run.log.read_text()
    builds = int(re.search(r"Neighbor list builds = (\d+)", log)[1])
    assert "Dangerous builds = 0" in log
    # All are taken to be as fast as the two fastest spheres fly at each other: several times more than there are.
    assert builds < lists.rebuild_rate * run.steps < 10 * builds
    entries = [int(count) for count in re.findall(r"NUMBER OF ENTRIES\s+(\d+)", (tmp_path / deck.CONTACTS_NAME).read_text())]
    assert 0.5 < np.mean(entries) / estimate.contacts(where) < 2
    assert len(places.spheres(dust).radii) == where.particles
