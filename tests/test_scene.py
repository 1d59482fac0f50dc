"""Scene files: what is read, and the one line that each fault ends in."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scene_files import DAHNEKE, MESH, PAIR, edited, written

from pyjkr import resources
from pyjkr.application import scene as application
from pyjkr.errors import SceneError
from pyjkr.scene import load


def complaint(directory: Path, text: str) -> str:
    path = written(directory, text)
    with pytest.raises(SceneError) as caught:
        load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message.removeprefix(f"{path}: ")


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_whole_scenes_are_read(tmp_path, text):
    assert load(written(tmp_path, text)).source == "scene.toml"


def test_every_shipped_case_is_a_valid_scene():
    assert resources.shipped_cases()
    for path in resources.shipped_cases().values():
        read = application.load if application.is_application(path) else load
        assert read(path).title


def test_values_arrive_in_si_units_and_under_their_names(tmp_path):
    scene = load(written(tmp_path, PAIR))
    assert scene.meeting.surface_energy == 0.04
    assert scene.impact.sphere_radius == 0.7e-6
    assert scene.impact.struck_material == "polystyrene"
    assert scene.reduction.modulus_ratios == (0.5, 0.001)
    assert scene.model.event_correction and scene.model.tangential_damping


def test_a_diameter_is_twice_the_radius(tmp_path):
    assert load(written(tmp_path, DAHNEKE)).impact.sphere_radius == 0.635e-6


def test_a_scene_cannot_be_changed(tmp_path):
    with pytest.raises(ValidationError):
        load(written(tmp_path, DAHNEKE)).impact.angle = 30.0


FAULTS = {
    "negative surface energy": (
        ("surface_energy = 0.11", "surface_energy = -0.02"),
        "contact 'polystyrene'-'quartz': surface_energy = -0.02 J/m2 must be >= 0. Set 0 for plain Hertz contact.",
    ),
    "unknown key": (
        ("surface_energy = 0.11", "surface_enrgy = 0.11"),
        "contact 'polystyrene'-'quartz': unknown key 'surface_enrgy'. Did you mean 'surface_energy'?",
    ),
    "unknown key of a material": (
        ("density = 1026.0", "densty = 1026.0"),
        "material 'polystyrene': unknown key 'densty'. Did you mean 'density'?",
    ),
    "unknown table": (("[figures]", "[figure]"), "unknown key 'figure'. Did you mean 'figures'?"),
    "unknown key like none": (("[figures]", "[figures]\nqqq = 2"), "figures: unknown key 'qqq'. Known: velocity_speed."),
    "nan": (
        ("effective_modulus = 271e6", "effective_modulus = nan"),
        "contact 'polystyrene'-'quartz': effective_modulus = nan Pa must be a finite number. Give the unreduced value.",
    ),
    "infinity": (
        ("diameter = 1.27e-6", "diameter = inf"),
        "impact: diameter = inf m must be a finite number. Give the diameter of the flying sphere.",
    ),
    "infinite speed": (("3.2, 5.0]", "inf]"), "impact: speeds[1] = inf m/s must be a finite number. Give the speed of approach."),
    "no speeds": (("[2.0, 3.2, 5.0]", "[]"), "impact: speeds = () m/s must not be empty. Give the speed of approach."),
    "speed twice": (("3.2, 5.0]", "2.0, 5.0]"), "impact: speeds holds 2.0 twice. Remove one."),
    "text for a number": (
        ("density = 1026.0", 'density = "heavy"'),
        "material 'polystyrene': density = 'heavy' kg/m3 must be a number. Give the density of the solid.",
    ),
    "true for a number": (
        ("density = 1026.0", "density = true"),
        "material 'polystyrene': density = True kg/m3 must be a number. Give the density of the solid.",
    ),
    "no wall": (
        ('wall_material = "quartz"\n', ""),
        "impact: target = 'wall' needs wall_material. Name one of the [material.NAME] tables.",
    ),
    "unknown law": (
        ('normal = "jkr/simplified"', 'normal = "jkr/simple"'),
        "model: normal = 'jkr/simple' must be 'jkr/simplified' or 'jkr'. Did you mean 'jkr/simplified'?",
    ),
    "missing law": (('tangential = "off"\n', ""), "model: tangential is missing. Add it."),
    "missing table": (("[impact]", "[unpact]"), "unknown key 'unpact'. Did you mean 'impact'?"),
    "missing density": (
        ("density = 1026.0\n", ""),
        "material 'polystyrene': density is missing. Give it in kg/m3.",
    ),
    "no size": (
        ("diameter = 1.27e-6\n", ""),
        "impact: the sphere needs either radius or diameter [m]. Give exactly one of them.",
    ),
    "two stiffnesses": (
        ("density = 1026.0", "density = 1026.0\nyoungs_modulus = 3e9"),
        "contact 'polystyrene'-'quartz': effective_modulus contradicts youngs_modulus of material 'polystyrene'."
        " Keep the effective value (papers quote it) or those of both materials.",
    ),
    "no stiffness": (
        ("effective_modulus = 271e6\n", ""),
        "material 'polystyrene': youngs_modulus is missing. Give it in Pa, or effective_modulus in"
        " contact 'polystyrene'-'quartz'.",
    ),
    "both rolling limits": (
        (
            "restitution_coefficient = 0.86",
            "restitution_coefficient = 0.86\nadhesion_hysteresis = 0.2\ncritical_rolling_angle = 0.01",
        ),
        "contact 'polystyrene'-'quartz': adhesion_hysteresis and critical_rolling_angle both set the limit of rolling and"
        " contradict each other. Keep one: the first is Krijt's, the second Dominik and Tielens'.",
    ),
    "krijt without its parameter": (
        ('rolling_friction = "off"', 'rolling_friction = "krijt"'),
        "contact 'polystyrene'-'quartz': rolling_friction = 'krijt' needs adhesion_hysteresis or critical_rolling_angle."
        " Give one of them.",
    ),
    "twisting without krijt": (
        ('rolling_friction = "off"', 'rolling_friction = "off"\ntwisting = true'),
        "model: twisting = true needs rolling_friction = 'krijt'. Change one of the two.",
    ),
    "friction missing": (
        ('tangential = "off"', 'tangential = "jkr"'),
        "contact 'polystyrene'-'quartz': friction_coefficient is missing. model.tangential = 'jkr' needs it.",
    ),
    "unknown material": (
        ('wall_material = "quartz"', 'wall_material = "qartz"'),
        "impact names material 'qartz', which has no table. Add [material.qartz] or use one of 'polystyrene', 'quartz'.",
    ),
    "pair missing": (
        ('between = ["polystyrene", "quartz"]', 'between = ["quartz", "quartz"]'),
        'the impact needs a [[contact]] with between = ["polystyrene", "quartz"]. Add it.',
    ),
    "phase of a whole step": (
        ("phase = 0.37", "phase = 1.0"),
        "impact: phase = 1.0 must be < 1. It is the fraction of a step at which contact begins.",
    ),
    "speed shown but not run": (
        ("velocity_speed = 5.0", "velocity_speed = 4.0"),
        "figures: velocity_speed = 4.0 m/s is not in impact.speeds. Name one of them.",
    ),
    "rules that agree": (
        ("unmodified_ratios = [0.2]", "unmodified_ratios = [1.0]"),
        "reduction: unmodified_ratios = 1.0 repeats modulus_ratios = 1.0: the rules agree there. Remove it.",
    ),
    "too elastic": (
        ("restitution_coefficient = 0.86", "restitution_coefficient = 0.04"),
        "contact 'polystyrene'-'quartz': restitution_coefficient = 0.04 must be > 0.05. LIGGGHTS accepts 0.05 < e <= 1.",
    ),
    "keys of another target": (
        ('target = "wall"', 'target = "wall"\ntarget_radius = 3e-6'),
        "impact: target_radius belongs to target = 'sphere'. Remove it or change the target.",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_ends_in_one_line_that_says_where_what_and_how_to_fix_it(tmp_path, fault):
    change, message = FAULTS[fault]
    assert complaint(tmp_path, edited(DAHNEKE, change)) == message


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "external_force = -2e-8",
            "environment: external_force = -2e-08 N must be >= 0. Give the strongest force that may pull a contact apart.",
        ),
        (
            "acceleration = nan",
            "environment: acceleration = nan m/s2 must be a finite number. It acts on the mass of a sphere; 9.81 for its weight.",
        ),
        ("accelaration = 9.81", "environment: unknown key 'accelaration'. Did you mean 'acceleration'?"),
    ],
)
def test_an_environment_that_makes_no_sense_is_refused(tmp_path, line, message):
    assert complaint(tmp_path, f"{DAHNEKE}\n[environment]\n{line}\n") == message


def test_rolling_without_surface_energy_is_refused(tmp_path):
    assert complaint(tmp_path, edited(PAIR, ("surface_energy = 0.04", "surface_energy = 0.0"))) == (
        "contact 'polystyrene'-'silica & co': surface_energy = 0 leaves rolling_friction = 'krijt' without any moment."
        " Set rolling_friction = 'off', or a surface energy."
    )


def test_an_oblique_impact_of_two_spheres_is_refused(tmp_path):
    assert "needs target = 'wall'" in complaint(tmp_path, edited(PAIR, ("phase = 0.21", "phase = 0.21\nangle = 20.0")))


def test_twisting_without_sliding_needs_the_friction_coefficient_of_its_limit(tmp_path):
    text = edited(PAIR, ('tangential = "jkr"', 'tangential = "off"'), ("friction_coefficient = 0.4\n", ""))
    assert "friction_coefficient is missing. model.twisting = true needs it" in complaint(tmp_path, text)


def test_an_unknown_key_is_named_rather_than_the_key_that_it_hides(tmp_path):
    assert "unknown key 'speds'" in complaint(tmp_path, edited(DAHNEKE, ("speeds", "speds")))


def test_a_missing_table_is_named(tmp_path):
    head = DAHNEKE.split("[impact]")[0]
    assert complaint(tmp_path, head) == "the table [impact] is missing. Add it."


def test_a_missing_contact_list_is_named(tmp_path):
    head, tail = DAHNEKE.split("[[contact]]")
    assert complaint(tmp_path, head + "[impact]" + tail.split("[impact]")[1]) == "the table [contact] is missing. Add it."


def test_files_that_are_no_scenes_are_refused(tmp_path):
    assert "not valid TOML" in complaint(tmp_path, "title = ")
    (tmp_path / "latin.toml").write_bytes(b'title = "\xfc"')
    with pytest.raises(SceneError, match="UTF-8"):
        load(tmp_path / "latin.toml")
    with pytest.raises(SceneError, match="No such file"):
        load(tmp_path / "none.toml")


def test_the_name_of_the_file_cannot_be_set_from_inside(tmp_path):
    assert complaint(tmp_path, 'source = "x"\n' + DAHNEKE) == "unknown key 'source'. Remove it."


@given(value=st.floats(max_value=0.0, exclude_max=True, allow_nan=False, allow_infinity=False))
def test_no_negative_surface_energy_passes(tmp_path_factory, value):
    text = edited(DAHNEKE, ("surface_energy = 0.11", f"surface_energy = {value!r}"))
    assert "must be >= 0" in complaint(tmp_path_factory.mktemp("scene"), text)


def test_a_byte_order_mark_at_the_start_of_a_file_is_no_fault(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(DAHNEKE, encoding="utf-8-sig")
    assert load(path).title
