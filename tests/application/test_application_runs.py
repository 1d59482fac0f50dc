"""Decks in LIGGGHTS: all are accepted, forces and materials act as they should, a run is kept and made again where it has changed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from application_scenes import NAMES, scene_of, variant, with_values
from test_application_deck import CONTACTS, three_materials

from pyjkr.application import analysis, deck, laws, picture, places, scene, situation
from pyjkr.planning import plan, table, variants
from pyjkr.simulator import Simulator

pytestmark = pytest.mark.liggghts


@pytest.mark.parametrize("name", NAMES)
def test_deck_is_accepted_and_the_first_frame_is_the_start(name: str, plugin: Simulator, tmp_path: Path) -> None:
    given = scene_of(name)
    decided = plan.plan(situation.situation(given), 0.05)
    chosen = variants.planned(decided)
    # A step a frame.
    short = given.run.frames * chosen.time_step
    run = deck.simulate(given, chosen, tmp_path, comments=table.comments(decided), duration=short, progress=False, simulator=plugin)
    assert run.steps == given.run.frames
    frames = analysis.frames(given, chosen, tmp_path)
    assert [round(frame.time / chosen.time_step) for frame in frames] == list(range(given.run.frames + 1))
    start = places.spheres(given, laws.law(given, chosen))
    assert frames[0].positions == pytest.approx(start.positions, rel=1e-11, abs=1e-11 * given.radii[0])
    assert frames[0].velocities == pytest.approx(start.velocities, rel=1e-11, abs=1e-15)
    assert frames[0].masses.sum() == pytest.approx(start.masses.sum(), rel=1e-12)
    measured = analysis.evolution(given, chosen, tmp_path)
    assert np.isfinite(measured.to_numpy()).all()
    if given.start == "agglomerate":
        assert measured["fragments"][0] == 1
    assert picture.draw(given, frames).axes[-1].get_xlabel().startswith("time")


def test_everything_on_at_real_stiffness_is_accepted(plugin: Simulator, tmp_path: Path) -> None:
    given = scene_of("ash_on_tube")
    chosen = variants.unreduced(situation.situation(given))
    run = deck.simulate(given, chosen, tmp_path, duration=60 * chosen.time_step, progress=False, simulator=plugin)
    # Every second step a frame, of which the scene wants 50.
    assert run.steps == 60
    assert "hard_particles" in run.deck.read_text()


def test_drag_leads_to_the_terminal_velocity_as_stokes_says(plugin: Simulator, tmp_path: Path) -> None:
    path = with_values(
        tmp_path, "ash_on_tube", number=3, radii="[4e-6, 7e-6, 12e-6]", shares="[0.33, 0.33, 0.34]", density=2400.0, viscosity=4e-5,
        speed=0.05, velocity="[0.2, 0.1, 0.4]", duration=2e-3, frames=20,
    )  # fmt: skip
    given = scene.load(path)
    chosen = variant(given, modulus_ratio=1e-4)
    deck.simulate(given, chosen, tmp_path / "run", progress=False, simulator=plugin)
    frames = analysis.frames(given, chosen, tmp_path / "run")
    radii = np.array([4e-6, 7e-6, 12e-6])
    assert frames[0].radii == pytest.approx(radii)
    relaxation = (2 / 9 * 2400.0 * radii**2 / 4e-5)[:, None]
    terminal = np.array([0.2, 0.1, 0.4]) + relaxation * np.array([0.0, 0.0, -9.81])
    start = np.array([0.0, 0.0, -0.05])
    for frame in frames:
        wanted = terminal + (start - terminal) * np.exp(-frame.time / relaxation)
        # First order in the time step over the relaxation time, here 1e-3 at most.
        assert chosen.time_step / relaxation.min() < 1e-3
        assert frame.velocities == pytest.approx(wanted, abs=1e-3 * 0.45)
    # The smallest has got there.
    assert frames[-1].velocities[0] == pytest.approx(terminal[0], abs=1e-3 * 0.45)


def test_each_material_rebounds_from_the_wall_as_its_contact_says(plugin: Simulator, tmp_path: Path) -> None:
    given = three_materials(tmp_path)
    start = places.spheres(given)
    # They fall side by side.
    assert np.linalg.norm(start.positions[0, :2] - start.positions[1, :2]) > start.radii.sum()
    # Stock Hertz returns e at 100 steps a collision within 0.01; the two differ by 0.4.
    chosen = variant(given, off=("adhesion", "sliding", "rolling"), modulus_ratio=0.01, steps=100)
    deck.simulate(given, chosen, tmp_path / "run", progress=False, simulator=plugin)
    last = analysis.frames(given, chosen, tmp_path / "run")[-1]
    assert last.velocities[:, 2] == pytest.approx([CONTACTS["floor", "soft"], CONTACTS["hard", "floor"]], abs=0.01)


def test_run_is_kept_and_one_that_changed_is_not(plugin: Simulator, tmp_path: Path) -> None:
    given = scene_of("dust_coagulation")
    chosen = variant(given, modulus_ratio=0.1)
    settings = {"duration": 2e-7, "progress": False, "simulator": plugin}
    first = deck.simulate(given, chosen, tmp_path / "a", **settings)
    dump = tmp_path / "a" / deck.SPHERES_NAME
    made = dump.stat().st_mtime_ns
    again = deck.simulate(given, chosen, tmp_path / "a", **settings)
    assert again.wall_time == first.wall_time
    assert dump.stat().st_mtime_ns == made
    # Another seed changes nothing but places and velocities.
    other = scene.Application.model_validate(given.model_dump() | {"run": {**given.run.model_dump(), "seed": 6}})
    deck.simulate(other, chosen, tmp_path / "a", **settings)
    assert dump.stat().st_mtime_ns != made
    # And back: the same run to the last bit, in another directory too.
    deck.simulate(given, chosen, tmp_path / "a", **settings)
    deck.simulate(given, chosen, tmp_path / "b", **settings)
    assert dump.read_bytes() == (tmp_path / "b" / deck.SPHERES_NAME).read_bytes()
    # A data file that someone changed is no longer the run's.
    data = tmp_path / "b" / deck.DATA_NAME
    data.write_text(data.read_text().replace("300 atoms", "300  atoms"))
    stamp = (tmp_path / "b" / deck.SPHERES_NAME).stat().st_mtime_ns
    deck.simulate(given, chosen, tmp_path / "b", **settings)
    assert (tmp_path / "b" / deck.SPHERES_NAME).stat().st_mtime_ns != stamp


def test_pair_keeps_its_momentum_and_its_rebound_is_that_of_the_closed_form(plugin: Simulator, tmp_path: Path) -> None:
    given = scene_of("head_on_pair")
    # Without adhesion the damping of Hertz returns e whatever the speed.
    chosen = variant(given, off=("adhesion", "sliding", "rolling", "gravity"), modulus_ratio=0.01, steps=200)
    deck.simulate(given, chosen, tmp_path, progress=False, simulator=plugin)
    frames = analysis.frames(given, chosen, tmp_path)
    momentum = max(float(np.abs(frame.masses @ frame.velocities).max()) for frame in frames)
    assert momentum < 1e-12 * frames[0].masses[0] * given.motion.speed
    assert analysis.observables(given, chosen, tmp_path)["e_eff"] == pytest.approx(0.8, abs=5e-3)
    assert max(len(frame.pairs) for frame in frames) == 1
    assert math.isclose(frames[-1].time, deck.steps(given, chosen)[0] * chosen.time_step)
