"""Force curves of both models through LIGGGHTS: pairs of radius ratio 1, 3 and 100, primitive wall, mesh wall.

A curve is judged at the overlap that the dumped positions and radii give. LIGGGHTS computes it as r_i + r_j - |x_i -
x_j|, each with half an ulp of the sum of radii (position along the line, sum, square root of a square); the closed
form is asked for 1e-12 max(|F|, F_C) plus what moving the overlap by OVERLAP_ROUNDING of the sum of radii changes in
it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from jkr import EPSILON, Jkr, effective_modulus
from simulation import Materials, Simulation, Sphere
from trajectory import Trajectory, trajectory

from pyjkr.run import Simulator

pytestmark = pytest.mark.liggghts

CLOSED_FORM = 1e-12
NEXT_TO_RUPTURE = 1e-10  # within 1e-3 of delta_C of the rupture: the root is nearly double there
# of r_i + r_j: position, difference, square, root and sum, half an ulp each; and as much again for the overlap
# computed here
OVERLAP_ROUNDING = 4 * EPSILON
# |beta| = 0 at e = 1; masses so large that no force changes a speed, so the overlap is prescribed
HEAVY = 3.7e14

YOUNGS, POISSON, ENERGY = 4.1e9, 0.27, 0.043
MODULUS = effective_modulus(YOUNGS, POISSON)
PROPERTIES = Materials(
    1,
    dict(
        youngsModulus=YOUNGS,
        poissonsRatio=POISSON,
        coefficientRestitution=1.0,
        coefficientFriction=0.6,
        surfaceEnergy=ENERGY,
        adhesionHysteresis=0.15,
    ),
)
MODELS = ("jkr/simplified", "jkr")
RATIOS = (1.0, 3.0, 100.0)
SMALL = 1.9e-6

# A plate of 1.6 mm (a mesh must span 1e-4 length units at least), its normal along +z, the spheres well inside one
# triangle.
PLATE = """\
solid plate
facet normal 0 0 1
outer loop
vertex -0.0008 -0.0008 0
vertex 0.0008 -0.0008 0
vertex 0.0008 0.0008 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -0.0008 -0.0008 0
vertex 0.0008 0.0008 0
vertex -0.0008 0.0008 0
endloop
endfacet
endsolid plate
"""
MESH = ("fix plate all mesh/surface file plate.stl type 1",)


@dataclass(frozen=True)
class Contact:
    """Sphere `mover` against sphere `other`, or against the wall z = 0 where `other` is None. Ids as in the dump."""

    law: Jkr
    mover: int
    other: int | None

    def overlap(self, t: Trajectory, k: int) -> float:
        i = self.mover - 1
        if self.other is None:
            return t["radius"][k, i] - t["z"][k, i]
        j = self.other - 1
        assert t["y"][k, i] == t["y"][k, j] and t["z"][k, i] == t["z"][k, j]
        return (t["radius"][k, i] + t["radius"][k, j]) - abs(t["x"][k, i] - t["x"][k, j])

    def force(self, t: Trajectory, k: int) -> float:
        """Repulsion on the mover."""
        return t["fz" if self.other is None else "fx"][k, self.mover - 1]

    def size(self, t: Trajectory) -> float:
        return t["radius"][0, self.mover - 1] + (0.0 if self.other is None else t["radius"][0, self.other - 1])


def pair_law(ratio: float) -> Jkr:
    return Jkr(SMALL * ratio / (1.0 + ratio), MODULUS, ENERGY)


def row(setting: str, gaps: Sequence[float], speeds: Sequence[float]) -> tuple[list[Sphere], list[Contact]]:
    """Contacts side by side, contact k with overlap -gaps[k]; the mover separates with speeds[k]. setting.

    A ratio or a wall.
    """
    spheres: list[Sphere] = []
    contacts: list[Contact] = []
    for k, (gap, speed) in enumerate(zip(gaps, speeds, strict=True)):
        if setting in ("plane", "mesh"):
            spheres.append(Sphere((-3e-4 + k * 2.5 * SMALL, -4e-4, SMALL + gap), SMALL, HEAVY, (0.0, 0.0, speed)))
            contacts.append(Contact(Jkr(SMALL, MODULUS, ENERGY), len(spheres), None))
        else:
            ratio = float(setting)
            big, at = SMALL * ratio, 2.5 * SMALL * ratio * k
            spheres.append(Sphere((-big, at, 0.0), big, HEAVY))
            spheres.append(Sphere((SMALL + gap, at, 0.0), SMALL, HEAVY, (speed, 0.0, 0.0)))
            contacts.append(Contact(pair_law(ratio), len(spheres), len(spheres) - 1))
    return spheres, contacts


def run_row(
    plugin: Simulator,
    directory: Path,
    model: str,
    setting: str,
    spheres: list[Sphere],
    steps: int,
    run_lines: Sequence[str] | None = None,
) -> Trajectory:
    wall = {"plane": ["primitive type 1 zplane 0.0"], "mesh": ["mesh n_meshes 1 meshes plate"]}.get(setting, [])
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "plate.stl").write_text(PLATE)
    simulation = Simulation(
        spheres,
        PROPERTIES,
        time_step=1e-9,
        steps=steps,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="eventCorrection off",
        walls=wall,
        setup=MESH if setting == "mesh" else (),
        box=(-1e-3, 1e-3, -1e-3, 1e-3, -2e-5, 5e-5) if wall else (),
        run_lines=run_lines,
    )
    return trajectory(simulation, plugin, directory)


def check(contact: Contact, t: Trajectory, k: int, worst: list[float]) -> None:
    overlap, force, law = contact.overlap(t, k), contact.force(t, k), contact.law
    exact = law.force(overlap)
    near = law.energy > 0.0 and overlap < (1.0 - 1e-3) * law.rupture
    rounding = OVERLAP_ROUNDING * contact.size(t)
    allowed = (NEXT_TO_RUPTURE if near else CLOSED_FORM) * max(abs(exact), law.pull_off)
    beyond = abs(force - exact) - law.force_change(overlap, rounding)
    worst.append(beyond / max(abs(exact), law.pull_off))
    assert beyond <= allowed, (overlap / law.rupture, force / law.pull_off, exact / law.pull_off)


@pytest.mark.parametrize("setting", [*map(str, RATIOS), "plane", "mesh"])
@pytest.mark.parametrize("model", MODELS)
def test_pressed_surfaces_repel_as_the_closed_form_says(
    plugin: Simulator, tmp_path: Path, model: str, setting: str
) -> None:
    overlaps = np.concatenate([SMALL * np.geomspace(1e-12, 0.45, 25), [pair_law(1.0).settled]])
    spheres, contacts = row(setting, -overlaps, np.zeros_like(overlaps))
    t = run_row(plugin, tmp_path, model, setting, spheres, 0)
    worst: list[float] = []
    for contact, overlap in zip(contacts, overlaps, strict=True):
        if contact.overlap(t, 0) <= 0.0:
            continue  # 1e-12 R is lost in the rounding of a position
        assert contact.overlap(t, 0) == pytest.approx(overlap, abs=OVERLAP_ROUNDING * contact.size(t))
        check(contact, t, 0, worst)
        if contact.other is not None:
            assert t["fx"][0, contact.other - 1] == -contact.force(t, 0)
    assert len(worst) >= 20


@pytest.mark.parametrize("setting", [*map(str, RATIOS), "plane", "mesh"])
@pytest.mark.parametrize("model", MODELS)
def test_whole_loop_of_approach_and_separation_follows_the_law(
    plugin: Simulator, tmp_path: Path, model: str, setting: str
) -> None:
    # in from a gap of 0.7 delta_C to an overlap of 2.3 delta_C in 100 steps, out to -0.98 delta_C in 200, to -1.02 in
    # 100
    inward, outward, last, time_step = 100, 200, 100, 1e-9
    law = row(setting, [0.0], [0.0])[1][0].law
    unit = -law.rupture
    fast, slow, slowest = (
        way * unit / (steps * time_step) for way, steps in ((-3.0, inward), (3.28, outward), (0.04, last))
    )
    spheres, contacts = row(setting, [0.7 * unit], [fast])
    contact = contacts[0]
    lines = [f"group mover id {contact.mover}", f"run {inward}"]
    for speed, steps in ((slow, outward), (slowest, last)):
        velocity = f"0.0 0.0 {speed!r}" if contact.other is None else f"{speed!r} 0.0 0.0"
        lines += [f"velocity mover set {velocity} units box", f"run {steps}"]
    t = run_row(plugin, tmp_path, model, setting, spheres, inward + outward + last, lines)
    in_contact, worst, least, broken_at, held_at = False, [], 0.0, None, None
    for k, step in enumerate(t.step):
        overlap, force = contact.overlap(t, k), contact.force(t, k)
        in_contact = overlap > 0.0 or (model == "jkr" and in_contact and overlap > law.rupture)
        if in_contact:
            check(contact, t, k, worst)
            least, held_at = min(least, force), overlap
        else:
            assert force == 0.0, f"step {step}: a force without contact at overlap {overlap / unit} delta_C"
            if broken_at is None and worst:
                broken_at = overlap
    ends, grid = (law.rupture, 0.04 * unit / last) if model == "jkr" else (0.0, 3.28 * unit / outward)
    assert ends <= held_at <= ends + 1.01 * grid and ends - 1.01 * grid <= broken_at <= ends
    if model == "jkr":
        # a sample lies within half a grid step of the minimum, where the curve is a parabola
        assert -law.pull_off * (1 + CLOSED_FORM) <= least <= -law.pull_off * (1 - 1e-4)
    else:
        # the last sample before surfaces part lies a grid step at most above -(8/9) F_C
        assert least == pytest.approx(-8 / 9 * law.pull_off, abs=1.01 * law.stiffness * grid)
