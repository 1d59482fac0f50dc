"""Decks as text: what is off is absent, properties of all pairs of materials stand where LIGGGHTS looks for them."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import pytest
from application_scenes import ALL, NAMES, changed, scene_of, variant, with_values

from pyjkr.application import deck, places, scene, situation
from pyjkr.application.scene import Application
from pyjkr.errors import PlanError
from pyjkr.planning import plan, table, variants

# What each effect puts into the deck of the tube, commands only; and what must go with it, though it is an effect of its own.
TRACES = {
    "adhesion": ("jkr", "surfaceEnergy", "Original", "krijt", "criticalRollingAngle", "rollingDamping"),
    "neck": ("model jkr ",),
    "sliding": ("tangential", "coefficientFriction"),
    "sliding_adhesion": ("tangential jkr",),
    "rolling": ("rolling_friction", "krijt", "criticalRollingAngle", "rollingDamping", "twisting"),
    "twisting": ("twisting",),
    "damping": ("peratomtypepair 2 0.6 0.7 0.7 0.6",),
    "gravity": ("gravity",),
    "original_limits": ("surfaceEnergyOriginal", "youngsModulusOriginal"),
}
# Rolling without adhesion asks for a property that the tube has not; twisting reads the friction coefficient too.
GOES_WITH = {"adhesion": ("rolling",), "sliding": ("twisting",)}
THREE_MATERIALS = """\
title = "three materials"
about = "structure"
[material.soft]
density = 1000.0
youngs_modulus = 2e9
poissons_ratio = 0.3
[material.hard]
density = 3000.0
youngs_modulus = 60e9
poissons_ratio = 0.2
[material.floor]
youngs_modulus = 200e9
poissons_ratio = 0.28
[[particles]]
name = "a"
material = "soft"
number = 1
radius = 0.5e-3
start = "rain"
[[particles]]
name = "b"
material = "hard"
number = 1
radius = 0.4e-3
start = "rain"
[wall]
material = "floor"
shape = "plane"
[motion]
speed = 1.0
[domain]
size = [6e-3, 6e-3, 4e-3]
periodic = ["x", "y"]
[run]
duration = 6e-3
seed = 4
frames = 10
"""
CONTACTS = {("soft", "soft"): 0.55, ("soft", "hard"): 0.65, ("hard", "hard"): 0.75, ("floor", "soft"): 0.5, ("hard", "floor"): 0.9}


def three_materials(directory: Path) -> scene.Application:
    """Spheres of two materials above a floor of a third; every contact has its own e, mu and gamma."""
    contacts = "".join(
        f'[[contact]]\nbetween = ["{a}", "{b}"]\nsurface_energy = {e / 10}\nrestitution_coefficient = {e}\n'
        f"friction_coefficient = {e / 2}\ncritical_rolling_angle = {e / 100}\n"
        for (a, b), e in CONTACTS.items()
    )
    path = directory / "scene.toml"
    path.write_text(THREE_MATERIALS + contacts, encoding="utf-8")
    return scene.load(path)


def commands(text: str) -> list[str]:
    """Commands of a deck, words a space apart: comments away, continued lines joined."""
    lines = text.replace("&\n", " ").splitlines()
    return [" ".join(line.split()) for line in lines if line.strip() and not line.lstrip().startswith("#")]


def named(text: str, name: str) -> list[str]:
    """Words of the one `fix property/global` of that name, behind it."""
    (found,) = [line.split() for line in commands(text) if f"property/global {name} " in line]
    return found[found.index(name) + 2 :]


def rendered(given: scene.Application, off: Collection[str] = (), modulus_ratio: float = 0.01) -> str:
    return deck.render(given, variant(given, off=off, modulus_ratio=modulus_ratio))


@pytest.mark.parametrize("effect", ALL)
def test_what_is_off_is_absent_and_what_is_on_is_there(effect: str) -> None:
    given = scene_of("ash_on_tube")
    whole = "\n".join(commands(rendered(given)))
    without = "\n".join(commands(rendered(given, off=(effect, *GOES_WITH.get(effect, ())))))
    assert [trace for trace in TRACES[effect] if trace not in whole] == []
    assert [trace for trace in TRACES[effect] if trace in without] == []
    assert "coefficientRestitution" in without


def test_real_stiffness_needs_no_originals_and_says_so() -> None:
    given = scene_of("ash_on_tube")
    text = rendered(given, modulus_ratio=1.0)
    assert "Original" not in text
    assert "Real stiffness: E_mod = E" in text
    moduli = [given.material[name].youngs_modulus for name in given.materials]
    assert list(map(float, named(text, "youngsModulus"))) == moduli


def test_without_adhesion_the_deck_asks_for_stock_liggghts_alone() -> None:
    given = scene_of("packed_bed")
    text = rendered(given, off=("adhesion", "rolling"))
    assert "needs LIGGGHTS 3.8" in text
    assert "pair_style gran model hertz tangential history" in commands(text)
    assert "jkr" not in "".join(commands(text))


def test_without_a_gas_there_is_no_drag() -> None:
    text = rendered(scene_of("packed_bed"))
    assert "viscous" not in text
    assert "addforce" not in text


def test_matrices_stand_row_by_row_and_the_wall_has_its_type(tmp_path: Path) -> None:
    given = three_materials(tmp_path)
    assert given.materials == ("soft", "hard", "floor")
    text = rendered(given, modulus_ratio=0.01)
    pairs = {frozenset(pair): e for pair, e in CONTACTS.items()}
    # The floor never meets itself: LIGGGHTS wants a number, that of the first contact.
    wanted = [pairs.get(frozenset((a, b)), 0.55) for a in given.materials for b in given.materials]
    # Haervig 2017, eq. 24: 0.01^(2/5).
    soft = 0.01**0.4
    for name, values in (
        ("coefficientRestitution", wanted),
        ("coefficientFriction", [e / 2 for e in wanted]),
        ("surfaceEnergy", [e / 10 * soft for e in wanted]),
        ("surfaceEnergyOriginal", [e / 10 for e in wanted]),
        ("criticalRollingAngle", [e / 100 for e in wanted]),
    ):
        number, *rest = named(text, name)
        assert number == "3"
        assert list(map(float, rest)) == pytest.approx(values, rel=1e-11)
    assert list(map(float, named(text, "youngsModulus"))) == pytest.approx([2e7, 6e8, 2e9], rel=1e-11)
    (wall,) = [line for line in commands(text) if "wall/gran" in line]
    assert "primitive type 3 zplane 0.0" in wall
    # Rows are seen as rows.
    assert re.search(r"peratomtypepair 3 &\n +0\.55 0\.65 0\.5 &\n +0\.65 0\.75 0\.9 &\n +0\.5 0\.9 0\.55\n", text)


def test_pairs_that_never_meet_are_spoken_of_only_where_there_are_any(tmp_path: Path) -> None:
    assert "never meet" in rendered(three_materials(tmp_path))
    assert "never meet" not in rendered(scene_of("packed_bed"))


def test_drag_of_each_size_class(tmp_path: Path) -> None:
    gas = {"viscosity": 4e-5, "velocity": "[0.2, 0.0, -0.3]", "radii": "[4e-6, 7e-6, 12e-6]", "shares": "[0.5, 0.35, 0.15]"}
    given = scene.load(with_values(tmp_path, "ash_on_tube", number=300, **gas))
    lines = commands(rendered(given))
    for index, (first, last, radius) in enumerate(((1, 150, 4e-6), (151, 255, 7e-6), (256, 300, 12e-6)), start=1):
        assert f"group size_{index} id <> {first} {last}" in lines
        (drag,) = [line.split()[-1] for line in lines if line.startswith(f"fix drag_{index} size_{index} viscous ")]
        stokes = 6 * 3.141592653589793 * 4e-5 * radius
        assert float(drag) == pytest.approx(stokes, rel=1e-11)
        (push,) = [line.split()[-3:] for line in lines if line.startswith(f"fix push_{index} size_{index} addforce ")]
        assert list(map(float, push)) == pytest.approx([0.2 * stokes, 0.0, -0.3 * stokes], rel=1e-11)


def test_data_file_holds_every_digit_and_the_deck_its_checksum() -> None:
    given = scene_of("ash_on_tube")
    written = dict(deck.files(given, variant(given)))
    assert list(written) == [deck.DATA_NAME, deck.MESH_NAME, deck.DECK_NAME]
    start = places.spheres(given)
    rows = [line.split() for line in written[deck.DATA_NAME].split("Atoms\n\n")[1].split("\n\nVelocities")[0].splitlines()]
    assert [[float(word) for word in row[4:]] for row in rows] == start.positions.tolist()
    assert [float(row[2]) / 2 for row in rows] == start.radii.tolist()
    assert {row[1] for row in rows} == {"1"}
    other = scene.Application.model_validate(given.model_dump() | {"run": {**given.run.model_dump(), "seed": 8}})
    assert deck.render(other, variant(other)) != written[deck.DECK_NAME]


@pytest.mark.parametrize("name", NAMES)
def test_deck_reads_well(name: str) -> None:
    given = scene_of(name)
    decided = plan.plan(situation.situation(given), 0.05)
    text = deck.render(given, variants.planned(decided), comments=table.comments(decided))
    assert max(map(len, text.splitlines())) <= 130
    # No blanks at ends of lines, no two empty lines, no noise of round-off.
    assert not re.search(r"[ \t]\n|\n\n\n|[1-9]\d{12,}", text)
    assert text.endswith("\n")
    assert f"run              {deck.steps(given, variants.planned(decided))[0]}\n" in text


def test_numbers_are_short_and_keep_twelve_digits() -> None:
    shown = {0.1 + 0.2: "0.3", 3.8e9: "3.8e9", 0.0084: "0.0084", 1050.0: "1050", -0.0: "0", 2.47e-08: "2.47e-8", 1e5: "1e5",
             1 / 3: "0.333333333333", -12345.678: "-12345.678", 9.99999999999999e-7: "1e-6"}  # fmt: skip
    assert {value: deck._number(value) for value in shown} == shown
    assert deck._number(150) == 150
    assert deck._number("all") == "all"


def with_skin(given: Application, skin: float) -> Application:
    return given.model_copy(update={"numerics": given.numerics.model_copy(update={"skin": skin})})


def test_skin_and_bins_are_short_numbers_and_never_below_what_was_asked_for() -> None:
    given = scene_of("ash_on_tube")
    text = deck.render(with_skin(given, 1.2345678e-6), variant(given))
    assert "neighbor         1.24e-6 bin" in text
    assert "neighbor         1.2e-6 bin" in deck.render(with_skin(given, 1.2e-6), variant(given))
    # Half of what a sphere looks for: its diameter and the skin.
    (size,) = [line.split()[-1] for line in commands(text) if line.startswith("neigh_modify")]
    assert float(size) >= 0.5 * (2 * given.radii[1] + 1.24e-6)


def test_last_frame_is_the_end_and_less_than_a_frame_late() -> None:
    for name in NAMES:
        given = scene_of(name)
        chosen = variant(given)
        total, interval = deck.steps(given, chosen)
        assert total % interval == 0
        assert given.run.frames / 2 <= total / interval <= given.run.frames
        late = total * chosen.time_step - given.run.duration
        assert -1e-9 * given.run.duration <= late < interval * chosen.time_step
    assert [deck.steps(given, chosen, count * chosen.time_step) for count in (1, 30, 31, 100)] == [(1, 1), (30, 1), (32, 2), (100, 4)]


MISSING = {
    "friction": ("friction_coefficient = 0.4", (), r"friction_coefficient is missing; .* or set \[effects\] sliding = 'off'"),
    "limit of rolling": ("critical_rolling_angle = 0.0084", (), "rolling needs adhesion_hysteresis or critical_rolling_angle"),
    "rolling friction": ("", ("adhesion",), "coefficient_rolling_friction is missing; rolling without adhesion needs it"),
}


@pytest.mark.parametrize("what", MISSING)
def test_property_that_an_effect_needs_is_asked_for(what: str, tmp_path: Path) -> None:
    line, off, message = MISSING[what]
    given = scene.load(changed(tmp_path, "packed_bed", (line, "#"))) if line else scene_of("packed_bed")
    with pytest.raises(PlanError, match=rf"scene\.toml: contact 'glass'-'glass': .*{message}"):
        rendered(given, off=off)


def test_one_kind_of_rolling_limit_for_all_contacts(tmp_path: Path) -> None:
    path = changed(tmp_path, "ash_on_tube", ("critical_rolling_angle = 0.0084  # rad, as", "adhesion_hysteresis = 0.2 # as"))
    with pytest.raises(PlanError, match="Give the same for all"):
        rendered(scene.load(path))


def test_title_cannot_break_out_of_its_comment(tmp_path: Path) -> None:
    given = scene.load(changed(tmp_path, "packed_bed", ('title = "Bed of', 'title = "& Bed of')))
    assert rendered(given).splitlines()[0] == "# + Bed of 1 mm glass beads under their own weight"
