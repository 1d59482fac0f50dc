"""Decks: byte for byte the stored ones, read back as the planned numbers, and accepted by LIGGGHTS itself."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from scene_files import DAHNEKE, MESH, PAIR, edited, written

from pyjkr import deck, dump
from pyjkr.plan import plan
from pyjkr.scene import load

GOLDEN = Path(__file__).parent / "golden"
# A file name that a shell, a template and a LIGGGHTS comment could each trip over.
AWKWARD = 'Müller\'s $x {{ 2 }} #1 "a" &.toml'
# scene, name of its file, case, stored deck.
STORED = [
    (DAHNEKE, "scene.toml", "5.0mps_q0.1_scaled", "wall.deck"),
    (DAHNEKE, AWKWARD, "2.0mps_q0.2_unmodified", "wall_awkward_path.deck"),
    (MESH, "scene.toml", "0.5mps_q0.01_scaled", "mesh.deck"),
    (PAIR, "scene.toml", "1.5mps_q0.001_scaled", "pair.deck"),
]


def case_of(directory: Path, text: str, label: str | None = None, name: str = "scene.toml"):
    scene = load(written(directory, text, name))
    cases = plan(scene).cases
    return (next(case for case in cases if case.label == label) if label else cases[0]), scene


@pytest.mark.parametrize(("text", "name", "label", "stored"), STORED, ids=[item[3] for item in STORED])
def test_rendered_decks_equal_the_stored_ones(tmp_path, text, name, label, stored):
    rendered = deck.render(*case_of(tmp_path, text, label, name))
    assert rendered == (GOLDEN / stored).read_text(encoding="utf-8")


def test_an_awkward_directory_does_not_show_in_the_deck(tmp_path):
    case, scene = case_of(tmp_path, MESH)
    path = deck.write(case, scene, tmp_path / 'it\'s 100 % a "dir" & more')
    assert path.read_text(encoding="utf-8") == deck.render(case, scene)
    assert (path.parent / "wall.stl").is_file()


def test_no_comment_continues_on_the_next_line(tmp_path):
    text = deck.render(*case_of(tmp_path, edited(DAHNEKE, ("Dahneke in short", "salt &")), name=AWKWARD))
    assert not any(line.rstrip().endswith("&") for line in text.splitlines())


def test_numbers_read_back_as_the_planned_doubles(tmp_path):
    case, scene = case_of(tmp_path, PAIR, "1.5mps_q0.001_scaled")
    text = deck.render(case, scene)

    def numbers(pattern: str) -> list[float]:
        return [float(word) for word in re.search(pattern, text, re.MULTILINE)[1].split()]

    assert numbers(r"^timestep +(\S+)$") == [case.time_step]
    assert numbers(r"youngsModulus peratomtype (.*)$") == list(case.youngs_moduli)
    assert numbers(r"surfaceEnergy peratomtypepair (.*)$") == [2, *[case.pair.surface_energy] * 4]
    assert numbers(r"surfaceEnergyOriginal peratomtypepair (.*)$") == [2, *[0.04] * 4]
    assert numbers(r"youngsModulusOriginal peratomtype (.*)$") == [7.0e10, 3.4e9]
    assert numbers(r"create_atoms +1 single (.*) units box$")[2] == case.start_gap + 0.7e-6 + 1.9e-6


def test_two_spheres_meet_at_the_planned_speed_about_a_centre_of_mass_at_rest(tmp_path):
    case, scene = case_of(tmp_path, PAIR, "1.5mps_q0.001_scaled")
    first, second = (float(value) for value in re.findall(r"vz (\S+)$", deck.render(case, scene), re.MULTILINE))
    assert second - first == pytest.approx(1.5, rel=1e-15)
    assert first * case.masses[0] + second * case.masses[1] == pytest.approx(0, abs=1e-15 * case.masses[0])


@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_keywords_follow_all_styles_and_the_shape_of_a_wall(tmp_path, text):
    case, scene = case_of(tmp_path, text)
    for line in deck.render(case, scene).splitlines():
        if line.startswith("pair_style") or "wall/gran" in line:
            assert line.endswith(deck.contact_keywords(scene))
            assert deck.contact_styles(scene) in line


def test_styles_that_are_off_are_not_named(tmp_path):
    _, scene = case_of(tmp_path, DAHNEKE)
    assert deck.contact_styles(scene) == "model jkr/simplified"
    assert deck.contact_keywords(scene) == "eventCorrection on"


def stock(text: str) -> str:
    """The deck with the laws of the stock LIGGGHTS."""
    text = re.sub(r"model jkr(/simplified)?\b", "model hertz", text)
    text = re.sub(r"tangential jkr\b", "tangential history", text)
    return re.sub(r" (eventCorrection|twisting|rollingDamping) \S+| rolling_friction krijt", "", text)


@pytest.mark.liggghts
@pytest.mark.parametrize("text", [DAHNEKE, PAIR, MESH])
def test_stock_liggghts_reads_the_deck_and_gives_the_nominal_restitution(tmp_path, liggghts, text):
    # Without adhesion the contact ends at zero overlap with exactly the nominal coefficient; plain velocity Verlet at
    # 120 to 200 steps per collision is off by its first step and its last.
    case, scene = case_of(tmp_path, text)
    path = deck.write(case, scene, tmp_path / "a run's place")
    path.write_text(stock(path.read_text(encoding="utf-8")), encoding="utf-8")
    done = subprocess.run([liggghts.executable, "-in", path.name], cwd=path.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    frame = dump.read(path.parent / deck.DUMP_NAME)
    assert frame["step"].iloc[-1] == case.steps
    last = frame[frame["step"] == case.steps].set_index("id")
    rebound = last.loc[1, "vz"] - (last.loc[2, "vz"] if len(case.radii) == 2 else 0.0)
    assert rebound / case.normal_speed == pytest.approx(scene.meeting.restitution_coefficient, abs=5e-3)
