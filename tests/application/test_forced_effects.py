"""Each effect that a plan decides on, forced the other way, in LIGGGHTS: what was off changes next to nothing, what was on matters."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from application_scenes import CASES

from pyjkr.application import analysis, deck, scene, situation
from pyjkr.application.scene import Application
from pyjkr.planning import plan, probe_deck, probe_parts, variants
from pyjkr.planning.probe_deck import ProbeDeck, Sphere
from pyjkr.planning.styles import of_effects
from pyjkr.run import find_simulator

pytestmark = pytest.mark.liggghts
MAX_ERROR = 0.05

# A pair or a sphere of glass; no two numbers alike.
MADE_UP = """
title = "made up"
about = "impact"
[material.glass]
density = 2500.0
youngs_modulus = 63e9
poissons_ratio = 0.22
[[contact]]
between = ["glass", "glass"]
surface_energy = 0.02
restitution_coefficient = 0.83
friction_coefficient = 0.31
critical_rolling_angle = 0.007
[[particles]]
name = "beads"
material = "glass"
number = NUMBER
radius = RADIUS
start = "START"
WALL
[motion]
speed = SPEED
angle = ANGLE
gravity = 9.81
[run]
duration = DURATION
frames = 2
"""
WALL = '[wall]\nmaterial = "glass"\nshape = "plane"\n'


def made_up(directory: Path, *, start: str, radius: float, speed: float, angle: float = 0.0, restitution: float = 0.83,
            friction: float = 0.31) -> Application:  # fmt: skip
    """Watched for as long as a flight over half a radius takes."""
    values = {
        "NUMBER": 2 if start == "pair" else 1, "RADIUS": radius, "START": start, "SPEED": speed, "ANGLE": angle,
        "WALL": "" if start == "pair" else WALL, "DURATION": 0.5 * radius / (speed * math.cos(math.radians(angle))),
    }  # fmt: skip
    text = MADE_UP.replace("0.83", repr(restitution)).replace("0.31", repr(friction))
    for name, value in values.items():
        text = text.replace(name, str(value))
    path = directory / "made-up.toml"
    path.write_text(text, encoding="utf-8")
    return scene.load(path)


def shipped(name: str):
    return lambda directory: scene.load(CASES[name])


SCENES = {
    "head_on_pair": shipped("head_on_pair"),
    "oblique_wall": shipped("oblique_wall"),
    "fast bead": lambda directory: made_up(directory, start="pair", radius=0.5e-3, speed=0.9),
    "elastic pair": lambda directory: made_up(directory, start="pair", radius=5e-6, speed=1.1, restitution=0.9995),
    "smooth oblique": lambda directory: made_up(directory, start="single", radius=5e-6, speed=1.3, angle=25.0, friction=0.03),
    "slow oblique": lambda directory: made_up(directory, start="single", radius=5e-6, speed=0.7, angle=35.0),
    "falling": lambda directory: made_up(directory, start="single", radius=2e-3, speed=0.05),
}
DECIDED = [
    ("head_on_pair", "adhesion", True),
    ("head_on_pair", "neck", True),
    ("head_on_pair", "damping", True),
    ("head_on_pair", "sliding", False),
    ("head_on_pair", "rolling", False),
    ("head_on_pair", "gravity", False),
    ("oblique_wall", "sliding", True),
    ("oblique_wall", "rolling", True),
    ("oblique_wall", "neck", False),
    ("oblique_wall", "twisting", False),
    ("slow oblique", "gravity", False),
    ("oblique_wall", "sliding_adhesion", True),
    ("slow oblique", "original_limits", False),
    ("smooth oblique", "sliding_adhesion", False),
    ("fast bead", "adhesion", False),
    ("elastic pair", "damping", False),
    ("falling", "gravity", True),
]


def result(given: Application, directory: Path) -> np.ndarray:
    """What the scene is about, in parts of the impact: e_eff^2, v_t and r omega over the speed; stuck or not; the way if so [m]."""
    made = plan.plan(situation.situation(given), MAX_ERROR)
    variant = variants.planned(made)
    deck.simulate(given, variant, directory, progress=False)
    found = analysis.observables(given, variant, directory)
    speed = given.motion.speed
    values = [found["e_eff"] ** 2, found["spin"] * given.radii[1] / speed, found.get("tangential_speed", 0.0) / speed]
    way = found.get("distance_along_wall", 0.0)  if found["stuck"] else 0.0
    return np.array([*values, found["stuck"], way])


@pytest.mark.parametrize(("name", "effect", "decided"), DECIDED)
def test_forcing_an_effect_the_other_way(tmp_path, name, effect, decided):
    given = SCENES[name](tmp_path)
    auto = plan.plan(situation.situation(given), MAX_ERROR)
    assert auto.on(effect) is decided
    forced = given.model_copy(update={"effects": given.effects.model_copy(update={effect: "off" if decided else "on"})})
    assert plan.plan(situation.situation(forced), MAX_ERROR).on(effect) is not decided
    real, other = result(given, tmp_path / "auto"), result(forced, tmp_path / "forced")
    # A way has no impact to be measured by: relative to itself.
    scale = np.append(np.ones(len(real) - 1), real[-1] or 1.0)
    change = float((np.abs(real - other) / scale).max())
    assert change > MAX_ERROR if decided else change < MAX_ERROR, change


def test_real_limits_are_kept_where_a_sphere_sticks_and_rolls_on_and_stop_it_earlier(tmp_path):
    """At the same stiffness: forced off, the plan would not soften at all, and nothing would change but the time it takes."""
    given = scene.load(CASES["oblique_wall"])
    made = plan.plan(situation.situation(given), MAX_ERROR)
    assert made.on("original_limits")
    kept = variants.planned(made)
    without = replace(kept, effects=kept.effects - {"original_limits"}, styles=of_effects(kept.effects - {"original_limits"}))
    ways = []
    for name, variant in (("on", kept), ("off", without)):
        deck.simulate(given, variant, tmp_path / name, progress=False)
        ways.append(analysis.observables(given, variant, tmp_path / name)["distance_along_wall"])
    assert ways[1] > (1 + MAX_ERROR) * ways[0]


def test_twisting_is_kept_where_clusters_last_and_stops_spheres_that_spin_against_each_other(tmp_path):
    """Two dust spheres that stick spin against each other about the line of their centres, as fast as they met."""
    what = situation.situation(scene.load(CASES["dust_coagulation"]))
    made = plan.plan(what, MAX_ERROR)
    assert made.on("twisting")
    kept = variants.planned(made)
    without = replace(kept, effects=kept.effects - {"twisting"}, styles=of_effects(kept.effects - {"twisting"}))
    meeting = what.meetings[0]
    radius = meeting.radii[0]
    spin = meeting.slowest_speed / radius
    left = {}
    for name, variant in (("on", kept), ("off", without)):
        pair = variant.pair(meeting)
        apart = 2 * radius - pair.equilibrium_contact_radius**2 / (3 * pair.effective_radius)
        spheres = tuple(
            Sphere(radius=radius, density=meeting.densities[0], position=(0.0, 0.0, sign * apart / 2), spin=(0.0, 0.0, sign * spin))
            for sign in (-1, 1)
        )
        wanted = ProbeDeck(
            title=name, spheres=spheres, material=probe_parts.material(variant, meeting), styles=variant.styles.text,
            time_step=variant.time_step, runs=(2000,), skin=0.2 * radius, box=probe_deck.box_around(spheres), every=2000,
        )  # fmt: skip
        run = probe_deck.execute(wanted, tmp_path / name, find_simulator())
        frames = probe_deck.frames(wanted, run)
        last = frames[frames["step"] == 2000]
        left[name] = float(np.abs(last["omegaz"]).max() / spin)
    assert left["off"] == pytest.approx(1.0, abs=1e-9)
    assert left["off"] - left["on"] > MAX_ERROR
