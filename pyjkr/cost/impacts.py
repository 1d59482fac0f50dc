"""Many equal impacts in one LIGGGHTS deck, that differ in the phase of the first contact within a step alone.

One start of LIGGGHTS takes longer than all impacts of a deck. Assumes that the lanes are too far apart to touch.
A finished batch is not run again: `run.json` beside the deck tells whether it is whole, and deck and simulator still the same.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pyjkr import deck, dump
from pyjkr.case import Case
from pyjkr.compare import output_time
from pyjkr.errors import DumpError
from pyjkr.plan import plan
from pyjkr.run import Run, Simulator, read_run, run_deck
from pyjkr.scene import Scene

TEMPLATE = "impacts.in.j2"
# Distance of two lanes, in radii of the largest sphere: beyond any neighbour list.
LANE_IN_RADII = 5


@dataclass(frozen=True)
class Impacts:
    """A batch: one case of a scene, started once for every phase.

    Attributes
    ----------
    label : str
        Directory below the output.
    scene : Scene
        Of one speed and one stiffness.
    case : Case
        What the plan makes of it.
    phases : tuple of float
        Fraction of a step at which each first contact falls.
    """

    label: str
    scene: Scene
    case: Case
    phases: tuple[float, ...]


@dataclass(frozen=True)
class Outcome:
    """What became of a batch; arrays run over its phases.

    Attributes
    ----------
    restitution : ndarray
        Normal speed after over before; 0 if stuck.
    stuck : ndarray
        Whether the contact still holds at the end.
    tangential, spin : ndarray
        Speed along the wall, and spin times radius, over the speed of the impact.
    steps : int
        Of the whole batch.
    computing_time : float
        Of its time loop without output [s].
    """

    restitution: np.ndarray
    stuck: np.ndarray
    tangential: np.ndarray
    spin: np.ndarray
    steps: int
    computing_time: float


def even_phases(count: int) -> tuple[float, ...]:
    """Phases in the middle of `count` equal parts of a step."""
    return tuple((index + 0.5) / count for index in range(count))


def prepare(label: str, scene: Scene, phases: tuple[float, ...], duration: float | None = None) -> Impacts:
    """A batch of the only case of a scene.

    Parameters
    ----------
    label, scene, phases
        As in `Impacts`.
    duration : float or None
        Simulated time [s]; None leaves the plan's.

    Raises
    ------
    PlanError
        Where the plan has no case: too deep an overlap, too long a time step.
    """
    case = plan(scene).cases[0]
    if duration is not None:
        case = dataclasses.replace(case, steps=math.ceil(duration / case.time_step))
    return Impacts(label, scene, case, phases)


def render(impacts: Impacts) -> str:
    """Text of the deck."""
    case = impacts.case
    lanes = [
        {"phase": phase, "place": index * _lane(case), "distance": sum(case.radii) + _gap(case, phase)}
        for index, phase in enumerate(impacts.phases)
    ]
    return deck.render_template(TEMPLATE, case, impacts.scene, box=deck.box(case, impacts.scene, _span(impacts)), lanes=lanes)


def execute(impacts: Impacts, directory: Path, simulator: Simulator) -> Outcome:
    """Run a batch, unless it is done, and read it.

    Raises
    ------
    RunError, DumpError
        Where the run fails or its dump is not whole.
    """
    place = directory / impacts.label
    return _read(impacts, _finished(impacts, place, simulator) or _run(impacts, place, simulator))


def _lane(case: Case) -> float:
    return LANE_IN_RADII * max(case.radii)


def _span(impacts: Impacts) -> float:
    return (len(impacts.phases) - 1) * _lane(impacts.case)


def _gap(case: Case, phase: float) -> float:
    return (case.flight_steps + phase) * case.normal_speed * case.time_step


def _finished(impacts: Impacts, place: Path, simulator: Simulator) -> Run | None:
    """The whole run of this very batch with this very simulator, if there is one: errors and times of two builds do not mix."""
    run = read_run(place)
    if run is None or not (place / deck.DUMP_NAME).is_file() or run.deck.read_text(encoding="utf-8") != render(impacts):
        return None
    built = max(file.stat().st_mtime for file in (simulator.executable, simulator.preload) if file)
    return run if run.simulator == simulator.name and run.log.stat().st_mtime > built else None


def _run(impacts: Impacts, place: Path, simulator: Simulator) -> Run:
    place.mkdir(parents=True, exist_ok=True)
    (place / deck.DUMP_NAME).unlink(missing_ok=True)
    if impacts.scene.impact.target == "wall" and impacts.scene.impact.wall == "mesh":
        half_width = deck.plate_half_width(impacts.case, _span(impacts))
        (place / deck.MESH_NAME).write_text(deck.plate(half_width), encoding="ascii")
    path = place / deck.DECK_NAME
    path.write_text(render(impacts), encoding="utf-8")
    return run_deck(path, progress=False, simulator=simulator)


def _read(impacts: Impacts, run: Run) -> Outcome:
    case, count = impacts.case, len(impacts.phases)
    frame = dump.read(run.directory / deck.DUMP_NAME)
    last = frame[frame["step"] == case.steps].set_index("id").sort_index()
    if len(last) != count * len(case.radii):
        raise DumpError(f"{run.directory}: the dump does not hold step {case.steps}. Remove the directory and run again.")
    flying, struck = last.iloc[:count], last.iloc[count:]
    distance, velocity = flying["z"].to_numpy(), flying["vz"].to_numpy()
    if len(struck):
        distance, velocity = distance - struck["z"].to_numpy(), velocity - struck["vz"].to_numpy()
    stuck = sum(case.radii) - distance > case.rupture_overlap
    return Outcome(
        restitution=np.where(stuck, 0.0, velocity / case.normal_speed),
        stuck=stuck,
        tangential=flying["vx"].to_numpy() / case.speed,
        spin=flying["omegay"].to_numpy() * case.radii[0] / case.speed,
        steps=run.steps,
        computing_time=run.loop_time - output_time(run),
    )
