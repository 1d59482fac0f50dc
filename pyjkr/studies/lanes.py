# Law: none of its own; spheres side by side above one wall, each with its own height, motion and force, in one deck.
# Covers: what the force, torque and deposition figures of Haervig et al. 2017 share (figs 3, 4, 10).
# Assumes: lanes too far apart to touch; the wall is the plane z = 0, forces and motions lie in the x-z plane.
"""Many experiments in one start of LIGGGHTS, which takes longer than most of them."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from pyjkr import deck, dump, plan, resources
from pyjkr import scene as scenes
from pyjkr.case import Case
from pyjkr.contact import PairProperties
from pyjkr.errors import DumpError, PlanError, SceneError
from pyjkr.oracle.normal import NormalContact
from pyjkr.run import run_deck
from pyjkr.scene import Scene

TEMPLATE = "lanes.in.j2"
# Distance of two lanes in radii: beyond any neighbour list.
SPACING_IN_RADII = 5
# LIGGGHTS has 32 groups, `all` among them, and each pushed sphere needs one.
MOST_FORCES = 31
# Factor on the density of a sphere whose motion is prescribed: contact forces then change no speed in any digit.
HEAVY = 1e18


@dataclass(frozen=True, kw_only=True)
class Lane:
    """One sphere above the wall.

    Attributes
    ----------
    height : float
        Of the centre [m].
    speed, approach : float
        Along x, and towards the wall [m/s].
    spin : float
        About y [rad/s]; positive rolls along x.
    force : float
        Constant, along x [N].
    """

    height: float
    speed: float = 0.0
    approach: float = 0.0
    spin: float = 0.0
    force: float = 0.0


def run(
    case: Case,
    scene: Scene,
    lanes: Sequence[Lane],
    directory: Path,
    *,
    steps: int,
    every: int = 1,
    density_factor: float = 1.0,
    periodic: bool = False,
    time_step: float | None = None,
) -> pd.DataFrame:
    """Run spheres side by side in LIGGGHTS.

    Parameters
    ----------
    case, scene
        Materials, laws and time step, of a sphere at a wall.
    lanes : sequence of Lane
        The spheres; their ids count from 1.
    directory : Path
        Gets deck, log and dump; what is there is overwritten.
    steps, every : int
        Length of the run; steps between two frames.
    density_factor : float
        `HEAVY` prescribes the motion.
    periodic : bool
        Whether the box is periodic along x.
    time_step : float or None
        [s]; None takes that of the case.

    Returns
    -------
    DataFrame
        step, id, x, z, xu, vx, vz, omegay, fx, fz, tqy; xu is not wrapped at the periodic boundary.
    """
    if sum(lane.force != 0 for lane in lanes) > MOST_FORCES:
        raise PlanError(f"{directory}: {len(lanes)} pushed spheres in one deck, {MOST_FORCES} at most. Give fewer forces.")
    case = dataclasses.replace(case, steps=steps, time_step=time_step or case.time_step)
    spacing = SPACING_IN_RADII * case.radii[0]
    box = list(deck.box(case, scene, (len(lanes) - 1) * spacing))
    box[5] = max(box[5], *(lane.height + 4 * case.radii[0] for lane in lanes))
    if periodic:
        box[:2] = [-10 * case.radii[0], 10 * case.radii[0]]
    numbered = [
        {name: float(value) for name, value in dataclasses.asdict(lane).items()}
        | {"number": number, "moves": bool(lane.speed or lane.approach or lane.spin)}
        for number, lane in enumerate(lanes, start=1)
    ]
    text = deck.render_template(
        TEMPLATE, case, scene, box=tuple(box), lanes=numbered, spacing=spacing, every=every,
        density_factor=float(density_factor), periodic=periodic,
    )  # fmt: skip
    directory.mkdir(parents=True, exist_ok=True)
    (directory / deck.DUMP_NAME).unlink(missing_ok=True)
    path = directory / deck.DECK_NAME
    path.write_text(text, encoding="utf-8")
    run_deck(path, progress=False)
    frame = dump.read(directory / deck.DUMP_NAME)
    frames = steps // every + 1
    if frame["step"].max() != steps - steps % every or len(frame) != frames * len(lanes):
        raise DumpError(f"{directory}: the dump lacks spheres or its last step, {steps}. Remove the directory and run again.")
    frame.attrs = {}
    return frame


def shipped(name: str) -> tuple[Scene, str]:
    """A shipped scene and the checksum of its file, by which rows kept from an older scene are told apart.

    Parameters
    ----------
    name : str
        Of the case, such as `dahneke`.

    Raises
    ------
    SceneError
        Where there is no such case.
    """
    known = resources.shipped_cases()
    if name not in known:
        raise SceneError(f"settings: scene = '{name}' is no shipped case with a scene. Use one of {', '.join(known)}.")
    return scenes.load(known[name]), hashlib.sha256(known[name].read_bytes()).hexdigest()[:16]


def same_scene(point: dict) -> Scene:
    """The scene that a point was made from.

    Raises
    ------
    SceneError
        Where the shipped scene has changed since, or another machine has another one.
    """
    scene, digest = shipped(point["scene"])
    if digest != point["scene_sha256"]:
        raise SceneError(f"{scene.source}: '{point['scene']}' differs from the scene of this sweep. Use one version of pyjkr, start anew.")
    return scene


def only_case(scene: Scene) -> Case:
    """The only case of a scene of one speed, one stiffness and one rule."""
    return plan.plan(scene).cases[0]


def normal_contact(pair: PairProperties, normal_law: str) -> NormalContact:
    """The oracle's contact with the properties of a pair."""
    return NormalContact(pair.effective_radius, pair.effective_modulus, pair.surface_energy, normal_law, pair.restitution_coefficient)


def worst(values) -> float:
    """Largest magnitude; NaN where there is none, so that an empty column fulfils no check."""
    values = [abs(float(value)) for value in values]
    return math.nan if not values or any(map(math.isnan, values)) else max(values)
