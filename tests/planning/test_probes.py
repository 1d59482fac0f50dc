"""Probes in LIGGGHTS beside closed forms of the papers and the oracle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from planning_situations import FRICTION, PAIR, SINGLE, UNEQUAL, bed, contact, energy_kept, meeting, situation

from pyjkr import contact as contact_laws
from pyjkr import oracle
from pyjkr.planning import collisions, probe_contacts, probe_deck, probe_impacts, probe_parts, variants
from pyjkr.planning.probes import not_probed, probes, sticking_probes, sticks_and_rolls
from pyjkr.planning.styles import of_effects

# Steps of a prescribed motion do not end exactly where the contact yields; round-off of a torque that is read in full.
ROUND_OFF = 1e-9
# Error of e_eff^2 of 400 steps a collision, docs/accuracy-and-cost.md: 6e-6.
FINE = 1e-5


def soft(at, ratio=0.01, originals=True, steps=60) -> variants.Variant:
    """All effects at a stiffness, some steps in a collision."""
    effects = variants.all_effects(bed(at)) | ({"original_limits"} if originals else set())
    made = variants.Variant(name="planned", effects=frozenset(effects), modulus_ratio=ratio, styles=of_effects(effects), time_step=1.0)
    return replace(made, time_step=variants.timestep.collision_time(made.pair(at), at.speed) / steps)


def values(probe, variant, directory, simulator) -> dict[str, np.ndarray]:
    """What a probe reads, by name."""
    deck = probe.deck(variant)
    run = probe_deck.execute(deck, directory, simulator)
    return {each.name: each.values for each in probe.read(probe_deck.frames(deck, run), variant)}


def limit(at, motion, overlap) -> float:
    """Moment at which a contact without load yields: Haervig 2017, eqs 17 and 21; Chen 2019, eq. 3."""
    force = 2 * FRICTION * at.pair.pull_off_force
    if motion == "rolling":
        return 4 * at.pair.pull_off_force * at.critical_rolling
    # LIGGGHTS' lever arm is shorter by its part of the overlap, by the radii of a pair; at a wall by half of it.
    arm = at.radii[0] - overlap * (at.radii[0] / sum(at.radii) if len(at.radii) == 2 else 0.5)
    return force * arm if motion == "sliding" else 2 / 3 * at.pair.equilibrium_contact_radius * force


@pytest.mark.liggghts
@pytest.mark.parametrize("radii", [SINGLE, UNEQUAL])
@pytest.mark.parametrize("motion", ["sliding", "rolling", "twisting"])
def test_limits_are_those_of_the_papers_at_real_and_at_reduced_stiffness(plugin, tmp_path, radii, motion):
    at = meeting(radii, speed=1.0)
    for variant in (variants.reference(bed(at), at), soft(at)):
        found = values(probe_contacts.yields(at, motion, 0.0), variant, tmp_path / variant.name, plugin)[f"moment of {motion}"]
        wanted = limit(at, motion, probe_parts.rest_overlap(variant.pair(at)))
        # The arm of unequal spheres is only known to its part of the overlap.
        assert found[0] == pytest.approx(wanted, rel=ROUND_OFF if motion != "sliding" else 2e-3)


@pytest.mark.liggghts
def test_scaled_limits_lose_strength_with_the_surface_energy(plugin, tmp_path):
    at = meeting(PAIR, speed=1.0)
    found = values(probe_contacts.yields(at, "rolling", 0.0), soft(at, originals=False), tmp_path, plugin)["moment of rolling"]
    assert found[0] == pytest.approx(0.01**0.4 * limit(at, "rolling", 0.0), rel=ROUND_OFF)


@pytest.mark.liggghts
@pytest.mark.parametrize("radii", [SINGLE, UNEQUAL])
def test_impacts_leave_with_the_energy_of_the_oracle(plugin, tmp_path, radii):
    at = meeting(radii, speed=8.0)
    found = values(probe_impacts.impact(at, at.speed, 0.0), variants.reference(situation(at), at), tmp_path, plugin)
    assert found["e_eff^2"] == pytest.approx(energy_kept(at), abs=FINE)
    assert not found["sticking"].any()


@pytest.mark.liggghts
def test_speeds_next_to_the_sticking_speed_are_decided_as_the_oracle_does(plugin, tmp_path):
    at = meeting(PAIR, speed=8.0, slowest=0.5)
    below, above = sticking_probes(at, 0.01)
    assert below < oracle.sticking_speed(contact(at), at.pair.effective_mass) < above
    assert energy_kept(at, speed=above) == pytest.approx(0.02, abs=2e-3)
    for speed, stuck in ((below, 1.0), (above, 0.0)):
        found = values(probe_impacts.impact(at, speed, 0.0), variants.reference(situation(at), at), tmp_path / f"{stuck}", plugin)
        assert np.all(found["sticking"] == stuck)


def test_nothing_is_asked_next_to_a_sticking_speed_that_the_scene_does_not_reach():
    assert sticking_probes(meeting(PAIR, speed=8.0, slowest=7.0), 0.05) == ()
    assert sticking_probes(meeting(PAIR, speed=8.0, slowest=0.5, energy=0.0), 0.05) == ()


@pytest.mark.liggghts
def test_a_pull_is_held_below_the_pull_off_force_and_not_above(plugin, tmp_path):
    at = meeting(PAIR, speed=1.0)
    # Sudden: the work of the force up to where the neck would snap under it goes into motion, which 0.3 F_C does not break.
    for share, held in ((0.3, 1.0), (1.1, 0.0)):
        probe = probe_contacts.pull(at, share * at.pair.pull_off_force)
        assert values(probe, variants.reference(bed(at), at), tmp_path / f"{share}", plugin)["held"] == held


@pytest.mark.liggghts
def test_a_stack_presses_as_deep_as_the_load_on_each_contact_wants(plugin, tmp_path):
    # Friction would take its part of the load.
    at = meeting(PAIR, speed=1.0, friction=0.0)
    load = 0.5 * at.pair.pull_off_force
    variant = soft(at)
    probe = probe_contacts.stack(at, load)
    found = values(probe, variant, tmp_path, plugin)
    pair = variant.pair(probe.meeting)
    radii = np.linspace(pair.equilibrium_contact_radius, 3 * pair.equilibrium_contact_radius, 20001)
    s = radii / pair.equilibrium_contact_radius
    # Haervig 2017, eq. 8.
    radius = np.interp(load, 4 * pair.pull_off_force * (s**3 - s**1.5), radii)
    wanted = 3 * contact_laws.overlap(pair, radius) / sum(probe.meeting.radii)
    # Layers sink and contacts turn away from their diagonals, by some parts of the strain itself, here 1 %.
    assert found["volume strain by overlaps"][0] == pytest.approx(wanted, rel=0.02)
    assert found["coordination number"][0] == 6.4


@pytest.mark.liggghts
def test_the_way_rolled_follows_from_the_limits_of_sliding_and_rolling(plugin, tmp_path):
    at = meeting((5e-6,), speed=0.08, tangential=1.0)
    assert sticks_and_rolls(situation(at), at)
    mass, radius = collisions.masses(at)[0], at.radii[0]
    friction, moment = limit(at, "sliding", 0.0) / radius, limit(at, "rolling", 0.0)
    # It slides while v > r omega: slip falls by (7/2) F/m, less (5/2) M/(m r); then it rolls, and (7/5) m dv/dt = -M/r.
    sliding = at.tangential_speed / ((7 / 2 * friction - 5 / 2 * moment / radius) / mass)
    left = at.tangential_speed - friction / mass * sliding
    way = (at.tangential_speed + left) / 2 * sliding + 7 / 10 * mass * left**2 * radius / moment
    # The spring takes xi_crit to reach its limit, and turns the sphere back by as much.
    way -= at.critical_rolling / 2
    probe = probe_impacts.way(at)
    found = values(probe, variants.reference(situation(at), at), tmp_path, plugin)
    assert found["sticking"].all()
    # While it slides its load swings, which is not in the closed form; that is a twentieth of the way.
    assert found["way rolled until at rest"] == pytest.approx(way, rel=0.01)
    assert np.ptp(found["way rolled until at rest"]) < 1e-3 * way


@pytest.mark.parametrize(("about", "judged"), [("impact", True), ("structure", False)])
def test_speeds_after_oblique_impacts_are_judged_only_where_they_are_the_result(about, judged):
    at = meeting(PAIR, speed=8.0, tangential=8.0)
    scene = situation(at) if about == "impact" else bed(at)
    names = [probe.label for probe in probes(scene, 0.05)]
    assert any("oblique" in name for name in names)
    oblique = next(probe for probe in probes(scene, 0.05) if "oblique" in probe.label)
    spheres = oblique.deck(soft(at)).spheres
    frame = _frame(spheres)
    found = {each.name: each for each in oblique.read(frame, soft(at))}
    assert found["spin times radius"].promised == judged
    assert found["sticking"].promised
    assert bool(found["spin times radius"].note) != judged


def _frame(spheres) -> pd.DataFrame:
    columns = [f"{v}{axis}" for v in ("", "v", "omega") for axis in "xyz"]
    rows = [[0, number, *sphere.position, *sphere.velocity, *sphere.spin] for number, sphere in enumerate(spheres, start=1)]
    return pd.DataFrame(rows, columns=["step", "id", *columns])


def test_a_bed_is_probed_for_its_limits_its_pull_and_its_overlaps():
    at = meeting(PAIR, speed=1.0)
    labels = [probe.label for probe in probes(bed(at, pulling_force=1e-9, weight_carried=1e-9), 0.05)]
    for word in ("sliding", "rolling", "twisting", "pull", "stack"):
        assert any(word in label for label in labels), word
    lone = [probe.label for probe in probes(situation(at), 0.05)]
    assert not any(word in label for label in lone for word in ("sliding", "twisting", "pull", "stack"))
    unlimited = replace(at, critical_rolling=math.inf)
    assert not any("rolling" in probe.label for probe in probes(bed(unlimited), 0.05))


def test_what_no_probe_looks_at_is_said():
    at = meeting((5e-6,), speed=0.08, tangential=1.0)
    assert not_probed(situation(at)) == ()
    assert any("rolls until it rests" in probe.label for probe in probes(situation(at), 0.05))
    # A limit of rolling so small that the sphere rolls ten thousand times as far.
    slippery = situation(replace(at, critical_rolling=1e-4 * at.critical_rolling))
    assert "until at rest" in not_probed(slippery)[0]
    assert not any("rolls until it rests" in probe.label for probe in probes(slippery, 0.05))
    assert any("body of many spheres" in line for line in not_probed(bed(meeting(PAIR), spheres_across=6.0)))
