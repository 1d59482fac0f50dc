"""Scene files of many particles: what is read, and what is refused with one line that names the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest
from application_scenes import BREAK_UP, CASES, changed, scene_of

from pyjkr.application import scene
from pyjkr.errors import SceneError


@pytest.mark.parametrize("name", CASES)
def test_shipped_case_reads_and_is_told_from_a_scene_of_impacts(name: str) -> None:
    path = CASES[name]
    assert scene.is_application(path)
    assert scene.load(path).number == {"head_on_pair": 2, "oblique_wall": 1, "agglomerate_break_up": 150}.get(name, 300)
    assert not scene.is_application(path.parents[1] / "dahneke" / "scene.toml")


# What is changed in the scene of a break-up, and what the message must say.
FAULTS = {
    "unknown key": (("radius = ", "radus = "), ["particles", "unknown key 'radus'", "Did you mean 'radius'?"]),
    "unknown table": (("[motion]", "[motions]"), ["unknown key 'motions'", "Did you mean 'motion'?"]),
    "unknown effect": (('about = "impact"', 'about = "impact"\n[effects]\nadhesoin = "on"'), ["effects", "'adhesion'"]),
    "wish": (('about = "impact"', 'about = "impact"\n[effects]\nneck = "yes"'), ["neck = 'yes'", "'auto', 'on' or 'off'"]),
    "negative radius": (("radius = ", "radius = -2.5e-6 # "), ["radius = -2.5e-06 m", "must be > 0"]),
    "about missing": (('about = "impact"', ""), ["about is missing", "'strength'"]),
    "about misspelt": (('about = "impact"', 'about = "strenght"'), ["about = 'strenght'", "Did you mean 'strength'?"]),
    "density": (("density = 1050.0", ""), ["material 'polystyrene'", "density is missing", "kg/m3"]),
    "modulus": (("youngs_modulus = 70e9", ""), ["material 'glass'", "youngs_modulus is missing", "Pa"]),
    "wrong wall": (('shape = "plane"', 'shape = "tube"\nradius = 1e-4\nlength = 2e-4'), ["wants a [wall] with shape = 'plane'"]),
    "tube size": (('shape = "plane"', 'shape = "tube"'), ["wall", "needs radius"]),
    "domain": (("[run]", "[domain]\nsize = [1e-4, 1e-4, 1e-4]\n[run]"), ["'agglomerate' has no [domain]", "Remove"]),
    "speed": (("speed = ", "speed = 0.0 # "), ["needs speed > 0", "m/s"]),
    "material": (('material = "glass"', 'material = "steel"'), ["'steel'", "[material.steel]"]),
    "pair number": (('start = "agglomerate"', 'start = "pair"'), ["start = 'pair' wants no [wall]"]),
    "two sizes": (("radius = ", "radii = [2.5e-6, 3e-6]\nshares = [0.5, 0.5] # "), ["equal spheres", "radius instead of radii"]),
    "contact missing": (('between = ["polystyrene", "glass"]', 'between = ["glass", "glass"]'), ["'glass'-'glass' never happens"]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_one_line_with_file_place_and_remedy(fault: str, tmp_path: Path) -> None:
    (old, new), wanted = FAULTS[fault]
    path = changed(tmp_path, BREAK_UP, (old, new))
    with pytest.raises(SceneError) as caught:
        scene.load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert [part for part in wanted if part not in message] == []


def test_missing_wall_is_asked_for(tmp_path: Path) -> None:
    # A bed's wall is of the beads' material: no contact is left over without it.
    path = changed(tmp_path, "packed_bed", ('[wall]\nmaterial = "glass"\nshape = "plane"', ""))
    with pytest.raises(SceneError, match=r"wants a \[wall\] with shape = 'plane'\. Add it"):
        scene.load(path)


def test_shares_must_add_up_and_classes_share_out_the_whole_number(tmp_path: Path) -> None:
    ash = scene_of("ash_on_tube")
    assert [count for _, count in ash.particles[0].classes] == [150, 105, 45]
    seven = changed(tmp_path, "ash_on_tube", ("number = 300", "number = 7"))
    # 3.5, 2.45, 1.05: the largest remainder gets the sphere that is left over.
    assert [count for _, count in scene.load(seven).particles[0].classes] == [4, 2, 1]
    with pytest.raises(SceneError, match=r"shares add up to 0\.9, not 1"):
        scene.load(changed(tmp_path, "ash_on_tube", ("0.5, 0.35, 0.15", "0.4, 0.35, 0.15")))


def test_periodic_axes_must_be_those_of_the_start(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"start = 'cloud' wants periodic = \['x', 'y', 'z'\]"):
        scene.load(changed(tmp_path, "dust_coagulation", ('["x", "y", "z"]', '["x", "y"]')))


def test_effective_modulus_is_refused_with_what_to_give_instead(tmp_path: Path) -> None:
    path = changed(tmp_path, "dust_coagulation", ("surface_energy = 0.025", "surface_energy = 0.025\neffective_modulus = 3.6e10"))
    with pytest.raises(SceneError, match=r"Give youngs_modulus of each material instead"):
        scene.load(path)
