"""Decisions on effects against the oracle, which is run with and without each of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_situations import PAIR, SINGLE, UNEQUAL, at_angle, bed, change, contact, energy_kept, meeting, outcome, situation

from pyjkr import oracle
from pyjkr.errors import PlanError
from pyjkr.planning import collisions
from pyjkr.planning.budget import EFFECT_SHARE
from pyjkr.planning.effects import decide, on
from pyjkr.planning.situation import EFFECTS, Situation
from pyjkr.planning.styles import styles

# Interpolation of the table against direct integration of the oracle.
INTERPOLATION = 1e-4
# The speeds of a situation are looked at one by one: the largest change between two of them may be missed by so much.
BETWEEN_SPEEDS = 0.02
# Estimates by impulses are bounds: measured 1.0 to 3.0 times too high for friction, 1.2 to 5.2 for rolling.
SLIDING_BOUND, ROLLING_BOUND = 3.5, 6.0

# Sticking speed of the test's sphere on a wall with the full law [m/s].
STICKS = oracle.sticking_speed(
    oracle.NormalContact(1e-6, meeting().pair.effective_modulus, 0.05, "jkr", 0.7), meeting().pair.effective_mass
)


def decision(found, effect):
    return next(made for made in found if made.effect == effect)


@pytest.mark.parametrize("max_error", [0.01, 0.1])
@pytest.mark.parametrize("over_sticking", [0.8, 1.2, 4.0, 20.0, 200.0])
def test_adhesion_is_on_where_the_oracle_changes_by_it(over_sticking, max_error):
    at = meeting(speed=over_sticking * STICKS)
    made = decision(decide(situation(at), max_error), "adhesion")
    measured = abs(0.7**2 - energy_kept(at))
    assert made.number == pytest.approx(measured, abs=INTERPOLATION)
    assert made.on == (measured > EFFECT_SHARE * max_error)
    if not made.on:
        assert measured < max_error


@pytest.mark.parametrize("over_sticking", [0.5, 1.3, 5.0, 60.0, 400.0])
def test_neck_is_on_where_the_laws_differ(over_sticking):
    at = meeting(speed=over_sticking * STICKS)
    made = decision(decide(situation(at, wishes={"adhesion": "on"}), 0.02), "neck")
    measured = abs(energy_kept(at, "jkr") - energy_kept(at, "jkr/simplified"))
    assert made.number == pytest.approx(measured, abs=INTERPOLATION)
    assert made.on == (measured > EFFECT_SHARE * 0.02)


def test_neck_looks_at_all_speeds_of_a_meeting():
    # Where all impacts stick, and where all are fast, the laws agree; between both they do not.
    at = meeting(speed=300 * STICKS, slowest=0.1 * STICKS, modulus=2e11)
    made = decision(decide(situation(at), 0.02), "neck")
    speeds = np.geomspace(at.slowest_speed, at.speed, 41)
    measured = max(abs(energy_kept(at, "jkr", speed=v) - energy_kept(at, "jkr/simplified", speed=v)) for v in speeds)
    assert made.number == pytest.approx(measured, rel=BETWEEN_SPEEDS * 5)
    assert made.on


@pytest.mark.parametrize("restitution", [0.5, 0.9, 0.997])
def test_damping_is_on_where_the_oracle_changes_by_it(restitution):
    at = meeting(speed=30 * STICKS, restitution=restitution)
    made = decision(decide(situation(at), 0.05), "damping")
    measured = max(abs(energy_kept(at, law) - energy_kept(at, law, restitution=1.0)) for law in ("jkr", "jkr/simplified"))
    assert made.number == pytest.approx(measured, abs=INTERPOLATION)
    assert made.on == (measured > EFFECT_SHARE * 0.05)


def test_damping_stays_where_an_impact_sticks_by_it_alone():
    # Both laws stick here, so the neck may go; without damping the simplified law would let the sphere go.
    at = meeting(speed=0.05 * STICKS, restitution=0.9)
    found = decide(situation(at), 0.05)
    assert energy_kept(at, "jkr/simplified") == 0 and energy_kept(at, "jkr/simplified", restitution=1.0) == pytest.approx(1.0)
    assert not on(found, "neck") and on(found, "damping")


@pytest.mark.parametrize(("radii", "degrees"), [(SINGLE, 3), (SINGLE, 45), (SINGLE, 70), (PAIR, 45), (UNEQUAL, 20)])
def test_sliding_is_no_less_than_what_the_oracle_changes_without_it(radii, degrees):
    at = at_angle(radii, 12.0, degrees)
    made = decision(decide(situation(at), 0.05), "sliding")
    measured = change(outcome(at, rolling=False), outcome(at, rolling=False, sliding=False))
    assert measured <= made.number <= SLIDING_BOUND * measured
    assert made.on
    assert measured > EFFECT_SHARE * 0.05


def test_grazing_friction_too_weak_to_matter_is_left_out():
    at = at_angle(SINGLE, 12.0, 45, friction=2e-3)
    made = decision(decide(situation(at), 0.2), "sliding")
    measured = change(outcome(at, rolling=False), outcome(at, rolling=False, sliding=False))
    assert measured <= made.number
    assert not made.on and measured < 0.2


@pytest.mark.parametrize(("speed", "max_error"), [(6.0, 0.02), (45.0, 0.2)])
def test_adhesive_part_of_sliding_is_no_less_than_what_the_oracle_changes_without_it(speed, max_error):
    at = at_angle(SINGLE, speed, 65)
    made = decision(decide(situation(at, wishes={"adhesion": "on"}), max_error), "sliding_adhesion")
    measured = change(outcome(at, rolling=False), outcome(at, rolling=False, adhesion_of_sliding=False))
    assert measured <= made.number
    if made.on:
        assert measured > max_error
    else:
        assert measured < max_error


@pytest.mark.parametrize(("radii", "degrees"), [(SINGLE, 20), (SINGLE, 45), (SINGLE, 65), (UNEQUAL, 45)])
def test_rolling_is_no_less_than_what_the_oracle_changes_without_it(radii, degrees):
    at = at_angle(radii, 8.0, degrees)
    made = decision(decide(situation(at), 0.05), "rolling")
    measured = change(outcome(at), outcome(at, rolling=False))
    assert measured <= made.number <= ROLLING_BOUND * measured
    assert not made.on and measured < 0.05
    assert on(decide(situation(at), 2 * measured), "rolling")


def test_rolling_by_slip_alone_is_bounded_too():
    # Hardly any friction, hence no spin: at a wall half of the slip still rolls the contact (Haervig 2017, eq. 20).
    at = at_angle(SINGLE, 8.0, 65, friction=0.003)
    made = decision(decide(situation(at, wishes={"sliding": "on"}), 0.05), "rolling")
    measured = change(outcome(at), outcome(at, rolling=False))
    assert 1e-4 < measured <= made.number


@pytest.mark.parametrize("law", ["jkr", "jkr/simplified"])
@pytest.mark.parametrize("over_sticking", [1.01, 1.1, 1.5, 3.0, 10.0, 300.0])
@pytest.mark.parametrize("restitution", [0.3, 0.7, 1.0])
def test_contact_time_is_a_close_upper_bound(law, over_sticking, restitution):
    at = meeting(restitution=restitution)
    speed = over_sticking * oracle.sticking_speed(contact(at), at.pair.effective_mass)
    measured = oracle.impact(contact(at, law), at.pair.effective_mass, speed, samples=2).contact_time
    assert measured <= collisions.contact_time(at.pair, speed) <= 1.7 * measured


def test_equal_spheres_do_not_roll_on_each_other_in_flight():
    at = at_angle(PAIR, 8.0, 45)
    made = decision(decide(situation(at), 0.05), "rolling")
    assert made.number == 0 and not made.on
    assert change(outcome(at), outcome(at, rolling=False)) < 1e-6


def test_rolling_is_on_where_an_oblique_impact_sticks():
    at = at_angle(SINGLE, 1.0, 60)
    found = decide(situation(at), 0.1)
    assert on(found, "rolling") and not on(found, "twisting")
    # Stuck without rolling resistance it rolls on, with it less.
    free, held = outcome(at, rolling=False), outcome(at)
    assert change(free, held) > 0.1


def test_twisting_is_off_where_the_oracle_does_not_feel_it():
    at = at_angle(SINGLE, 8.0, 45)
    assert not on(decide(situation(at, about="strength", lasting=True), 0.05), "twisting")
    assert change(outcome(at), outcome(at, twisting=True)) < 1e-7
    assert on(decide(bed(at), 0.05), "twisting")


def test_gravity_is_off_where_falling_changes_little():
    at = meeting(speed=0.05, energy=0.0)
    for way, is_on in ((1e-7, False), (1e-3, True)):
        made = decision(decide(situation(at, gravity=9.81, falling_length=way), 0.02), "gravity")
        # Speed at the impact after the fall, squared.
        exact = (0.05**2 + 2 * 9.81 * way) / 0.05**2 - 1
        assert made.number == pytest.approx(exact, rel=1e-9)
        assert made.on is is_on


def test_loads_that_last_decide_on_adhesion_in_a_bed():
    # Fast impacts, so that they alone would leave adhesion out.
    at = meeting(speed=300 * STICKS, modulus=2e13)
    held = oracle.pull_off_force(oracle.NormalContact(1e-6, 1e9, 0.05, "jkr", 0.7))
    for share, is_on in ((1e-3, False), (0.1, True)):
        # Against the sphere's own weight, however much rests on others: one at the top is held by nothing else.
        gravity = held / share / collisions.masses(at)[0]
        made = decision(decide(bed(at, gravity=gravity, weight_carried=1e3 * held / share), 0.05), "adhesion")
        assert made.number == pytest.approx(share, rel=1e-9)
        assert made.on is is_on


def test_original_limits_follow_what_the_scene_is_about():
    at = at_angle(SINGLE, 8.0, 45)
    assert not on(decide(situation(at), 0.01), "original_limits")
    for about in ("strength", "structure"):
        made = decision(decide(bed(at, about=about), 0.01), "original_limits")
        assert made.on and made.number == pytest.approx(1 - 0.01**0.4)
    # What real limits would do to the impact, and scaled ones to strength: the sizes that the decision rests on.
    assert change(outcome(at, 0.01, originals=True), outcome(at)) > 0.1


def test_scene_without_adhesion_is_stock_hertz():
    found = decide(situation(at_angle(SINGLE, 8.0, 45, energy=0.0)), 0.05)
    assert {made.effect for made in found if made.on} == {"sliding", "damping"}
    made = styles(found)
    assert made.pair == "model hertz tangential history" and made.keywords == ""
    assert "surfaceEnergy" not in made.properties


@pytest.mark.parametrize(
    ("wishes", "pair", "keywords"),
    [
        ({}, "model jkr tangential jkr rolling_friction krijt", "twisting on"),
        ({"twisting": "off"}, "model jkr tangential jkr rolling_friction krijt", ""),
        ({"sliding_adhesion": "off", "rolling": "off"}, "model jkr tangential history", ""),
        ({"neck": "off", "sliding": "off"}, "model jkr/simplified rolling_friction krijt", "twisting on"),
        ({"adhesion": "off"}, "model hertz tangential history", ""),
        ({"adhesion": "off", "rolling": "on", "sliding": "on"}, "model hertz tangential history rolling_friction epsd2", ""),
    ],
)
def test_wishes_force_and_what_is_off_is_absent(wishes, pair, keywords):
    found = decide(bed(wishes=wishes), 0.05)
    assert (styles(found).pair, styles(found).keywords) == (pair, keywords)
    for effect in wishes:
        assert decision(found, effect).forced


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (situation(meeting(energy=0.0), wishes={"adhesion": "on"}), "surface_energy is 0"),
        (bed(wishes={"adhesion": "off", "neck": "on"}), "needs adhesion"),
        (bed(wishes={"rolling": "off", "twisting": "on"}), "needs rolling"),
        (situation(meeting(friction=0.0), wishes={"sliding": "on"}), "friction_coefficient is 0"),
        (situation(meeting(hysteresis=math.inf), wishes={"rolling": "on"}), "adhesion_hysteresis or critical_rolling_angle"),
    ],
)
def test_wishes_that_cannot_be_met_are_refused_in_one_line(made, words):
    with pytest.raises(PlanError, match=words) as caught:
        decide(made, 0.05)
    assert str(caught.value).startswith("scene.toml: effects: ") and "\n" not in str(caught.value)


def test_rolling_without_a_limit_is_left_out_and_said():
    made = decision(decide(bed(meeting(hysteresis=math.inf)), 0.05), "rolling")
    assert not made.on and made.forced and "no limit of rolling" in made.measure


def test_every_effect_is_decided_once_in_order_with_formula_and_source():
    found = decide(bed(at_angle(UNEQUAL, 8.0, 45), gravity=9.81, weight_carried=1e-12, falling_length=1e-4), 0.05)
    assert tuple(made.effect for made in found) == EFFECTS
    assert all(made.formula and made.source and made.measure for made in found if made.on)


@settings(max_examples=40, deadline=None)
@given(
    small=st.floats(1e-3, 0.1), factor=st.floats(1.0, 4.0), speed=st.floats(0.3, 60.0), degrees=st.floats(0.0, 80.0),
    about=st.sampled_from(["impact", "strength", "structure"]),
)  # fmt: skip
def test_a_larger_error_never_adds_an_effect(small, factor, speed, degrees, about):
    at = at_angle(SINGLE, speed, degrees)
    scene = situation(at, about=about, lasting=about != "impact", gravity=9.81, falling_length=1e-3)
    few, many = ({made.effect for made in decide(scene, error) if made.on} for error in (factor * small, small))
    assert few <= many


@settings(max_examples=40, deadline=None)
@given(slow=st.floats(0.3, 30.0), factor=st.floats(1.0, 30.0))
def test_adhesion_matters_less_the_faster(slow, factor):
    numbers = [decision(decide(situation(meeting(speed=v)), 0.05), "adhesion").number for v in (slow, factor * slow)]
    assert numbers[1] <= numbers[0] + INTERPOLATION


def test_defaults_of_a_situation_wish_nothing():
    assert Situation(title="t", source="s", about="impact", meetings=(), many_contacts=False, lasting=False).wishes == {}
