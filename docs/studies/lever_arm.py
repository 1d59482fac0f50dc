# ruff: noqa: E501  (the lines of the page are as long as Markdown needs them)
"""Measure what the lever arm of the tangential force does to oblique impacts under softening, and write docs/lever-arm.md.

    python docs/studies/lever_arm.py [-o PAGE]

Runs LIGGGHTS with the plug-in (arm r - delta/2, its own) and the oracle (arms r - delta/2 and r). Less than a minute.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests")]

from simulation import Materials, Simulation, Sphere  # noqa: E402

from pyjkr import oracle  # noqa: E402
from pyjkr.run import Simulator, find_simulator  # noqa: E402

PAGE = HERE.parent / "lever-arm.md"
RADIUS, DENSITY, YOUNGS, POISSON, ENERGY, RESTITUTION, FRICTION = 1e-6, 1050.0, 3.8e9, 0.34, 0.05, 0.7, 0.3
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
SPEED, ANGLE = 8.0, 45.0
SOFTENING = (1.0, 0.1, 0.01, 0.001)
STEPS = 4000  # a collision
WALL = oracle.Wall((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Rebound:
    """After an impact: tangential velocity, surface speed r x spin, both over the tangential speed of impact; largest overlap / r."""

    tangential: float
    spin: float
    overlap: float = math.nan


def law(q: float) -> oracle.PairLaw:
    youngs = q * YOUNGS
    moduli = (youngs, POISSON, youngs, POISSON)
    return oracle.PairLaw(
        oracle.effective_modulus(*moduli),
        oracle.effective_shear_modulus(*moduli),
        ENERGY * q**0.4,
        RESTITUTION,
        FRICTION,
        adhesion_hysteresis=0.2,
    )


def collision_time(q: float) -> float:
    """Hertz, of the normal speed of impact [s]."""
    return 2.868 * (MASS**2 / (RADIUS * law(q).effective_modulus ** 2 * SPEED * math.cos(math.radians(ANGLE)))) ** 0.2


def velocity(angle: float) -> tuple[float, float, float]:
    return SPEED * math.sin(math.radians(angle)), 0.0, -SPEED * math.cos(math.radians(angle))


def in_oracle(q: float, arm: str, angle: float = ANGLE, **options: bool | oracle.PairLaw) -> Rebound:
    pair_law = options.pop("law", law(q))
    start = oracle.Assembly(
        np.array([[0.0, 0.0, 1.0001 * RADIUS]]),
        np.array([velocity(angle)]),
        np.zeros((1, 3)),
        np.array([RADIUS]),
        np.array([MASS]),
        pair_law,
        oracle.Options(lever_arm=arm, **{"rolling": False, **options}),
        [WALL],
    )
    run = oracle.follow(
        start, 20 * collision_time(q), samples=2000, relative_tolerance=1e-9, stop=lambda event: event.kind == "break"
    )
    tangential = velocity(angle)[0]
    deepest = float(np.max(RADIUS - run.position[:, 0, 2])) / RADIUS
    return Rebound(run.final.velocity[0, 0] / tangential, run.final.spin[0, 1] * RADIUS / tangential, deepest)


def in_liggghts(q: float, simulator: Simulator) -> Rebound:
    properties = dict(
        youngsModulus=q * YOUNGS,
        poissonsRatio=POISSON,
        coefficientRestitution=RESTITUTION,
        coefficientFriction=FRICTION,
        surfaceEnergy=ENERGY * q**0.4,
    )
    sphere = Sphere((0.0, 0.0, 1.0001 * RADIUS), RADIUS, DENSITY, velocity(ANGLE))
    simulation = Simulation(
        [sphere],
        Materials(1, properties),
        collision_time(q) / STEPS,
        4 * STEPS,
        style="model jkr/simplified tangential jkr",
        walls=["primitive type 1 zplane 0.0"],
        every=4 * STEPS,
    )
    with tempfile.TemporaryDirectory() as directory:
        last = simulation.run(simulator, Path(directory)).iloc[-1]
    tangential = velocity(ANGLE)[0]
    assert last["z"] > RADIUS and last["vz"] > 0, "the sphere has not left the wall"
    return Rebound(last["vx"] / tangential, last["omegay"] * RADIUS / tangential)


def change_of_angular_momentum(q: float, arm: str) -> float:
    """Of a free pair of equal spheres that meet as the sphere meets the wall, over its orbital angular momentum at contact."""
    half = np.array(velocity(ANGLE)) / 2
    position = np.array([[0.0, 0.0, 1.0001 * RADIUS], [0.0, 0.0, -1.0001 * RADIUS]])
    start = oracle.Assembly(
        position,
        np.array([half, -half]),
        np.zeros((2, 3)),
        np.full(2, RADIUS),
        np.full(2, MASS),
        law(q),
        oracle.Options(lever_arm=arm, rolling=False),
    )
    end = oracle.follow(
        start, 20 * collision_time(q), samples=2, relative_tolerance=1e-9, stop=lambda event: event.kind == "break"
    ).final

    def total(a: oracle.Assembly) -> np.ndarray:
        return np.sum(MASS * np.cross(a.position, a.velocity) + 0.4 * MASS * RADIUS**2 * a.spin, axis=0)

    return float(np.linalg.norm(total(end) - total(start)) / np.linalg.norm(total(start)))


def percent(value: float) -> str:
    return "0" if abs(value) < 5e-9 else f"{100 * value:+.2g} %" if abs(value) < 0.001 else f"{100 * value:+.2f} %"


def table(header: list[str], rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ["---"] * len(header), *rows])


def page(simulator: Simulator) -> str:
    liggghts = {q: in_liggghts(q, simulator) for q in SOFTENING}
    contact, radius = ({q: in_oracle(q, arm) for q in SOFTENING} for arm in ("contact", "radius"))
    agreement = max(
        max(abs(liggghts[q].tangential - contact[q].tangential), abs(liggghts[q].spin - contact[q].spin))
        for q in SOFTENING
    )

    def changes(runs: dict[float, Rebound], q: float) -> list[str]:
        return [percent(runs[q].tangential - runs[1.0].tangential), percent(runs[q].spin - runs[1.0].spin)]

    impacts = [
        [f"{q:g}", f"{contact[q].overlap:.4f}", *changes(liggghts, q), *changes(contact, q), *changes(radius, q)]
        for q in SOFTENING
    ]
    arms = [
        [
            f"{q:g}",
            f"{contact[q].overlap:.4f}",
            percent(contact[q].tangential - radius[q].tangential),
            percent(contact[q].spin - radius[q].spin),
            f"{(contact[q].tangential - radius[q].tangential) / contact[q].overlap:+.2f}",
            f"{(contact[q].spin - radius[q].spin) / contact[q].overlap:+.2f}",
        ]
        for q in SOFTENING
    ]
    momentum = [
        [f"{q:g}", *(percent(change_of_angular_momentum(q, arm)) for arm in ("contact", "radius"))] for q in SOFTENING
    ]
    q = 0.01
    originals = replace(law(q), surface_energy_original=ENERGY, effective_modulus_original=law(1.0).effective_modulus)
    real, soft = in_oracle(1.0, "radius", rolling=True), in_oracle(q, "radius", rolling=True, law=originals)
    plain = in_oracle(q, "radius", law=originals)
    others = [
        ["arm r - overlap/2", *changes(contact, q)],
        [
            "original surface energy in the sliding limit",
            percent(plain.tangential - radius[1.0].tangential),
            percent(plain.spin - radius[1.0].spin),
        ],
        [
            "the same, with rolling and its original moment",
            percent(soft.tangential - real.tangential),
            percent(soft.spin - real.spin),
        ],
    ]
    angles = []
    slopes = [
        max(abs(contact[q].tangential - radius[q].tangential), abs(contact[q].spin - radius[q].spin))
        / contact[q].overlap
        for q in SOFTENING
    ]
    for angle in (20.0, 45.0, 70.0):
        soft, hard, arm = (
            in_oracle(q, "contact", angle),
            in_oracle(1.0, "contact", angle),
            in_oracle(q, "radius", angle),
        )
        pairs = [
            (soft.tangential, hard.tangential),
            (soft.spin, hard.spin),
            (soft.tangential, arm.tangential),
            (soft.spin, arm.spin),
        ]
        angles.append([f"{angle:g}°", f"{soft.overlap:.4f}", *(percent(a - b) for a, b in pairs)])
        slopes.append(max(abs(soft.tangential - arm.tangential), abs(soft.spin - arm.spin)) / soft.overlap)
    bound = math.ceil(10 * max(slopes)) / 10
    return f"""# The lever arm of the tangential force

Written by `python docs/studies/lever_arm.py`.

LIGGGHTS applies the tangential force at the middle of the overlap: its lever arm is r - overlap/2, of pairs and at walls. With the arm r
oblique impacts under reduced stiffness (modulus E_mod = q E, surface energy ~ q^(2/5)) would be exactly similar; with r - overlap/2 they are
not, for overlap/r grows as q^(-2/5). This page measures by how much, and what the arm r would cost.

**What the plug-in does: it keeps r - overlap/2.** The error is at most {bound:.1f} x (largest overlap / r) of the tangential speed of
impact, in v_t and in r x spin: below an overlap of 1 % of the radius it can be forgotten. Look at it from 5 % on where spins or tangential
velocities are the result, and soften less: at {100 * contact[0.1].overlap:.0f} % (q = 0.1 here) it is {100 * slopes[1] * contact[0.1].overlap:.0f} %, at {100 * contact[0.01].overlap:.0f} % (q = 0.01) {100 * slopes[2] * contact[0.01].overlap:.0f} %. Normal rebound and sticking
do not know the arm, nor does the yield of rolling. The reasons:

- With the arm r a free pair does not conserve its angular momentum (third part of this page), at any stiffness, and the error grows with softening
  in the same way. Agglomerates touch again and again: an error of a conserved quantity adds up, one of a restitution coefficient does not.
- Between like materials the middle of the overlap is where the surfaces meet, and a wall is the limit of a large sphere. The arm r at walls alone
  would harm no conservation law, but end that.
- Every other LIGGGHTS model uses it.

To compare stiffnesses without it, the oracle has `Options(lever_arm="radius")`.

## Oblique impact on a wall

Polystyrene sphere, radius {RADIUS * 1e6:g} um, {SPEED:g} m/s at {ANGLE:g} degrees, no spin before; E = {YOUNGS / 1e9:g} GPa, nu = {POISSON}, gamma = {ENERGY} J/m2, e = {RESTITUTION}, mu = {FRICTION},
`jkr/simplified`, `tangential jkr`, no rolling moment. Change of the outcome against q = 1, over the tangential speed of impact:

{table(["q", "largest overlap / r", "LIGGGHTS: v_t", "r spin", "oracle, arm r - overlap/2: v_t", "r spin", "oracle, arm r: v_t", "r spin"], impacts)}

LIGGGHTS ({STEPS} steps a collision) and the oracle with the same arm differ by at most {100 * agreement:.2g} % of the tangential speed: the changes are the arm's.

At one q, arm r - overlap/2 against arm r, and the same divided by overlap / r:

{table(["q", "largest overlap / r", "v_t", "r spin", "v_t / (overlap / r)", "r spin / (overlap / r)"], arms)}

Other angles of impact (from the normal), arm r - overlap/2 at q = 0.01, against q = 1 and against arm r:

{table(["angle", "largest overlap / r", "v_t", "r spin", "against arm r: v_t", "r spin"], angles)}

## Angular momentum of a pair

Two equal free spheres meeting with the same relative velocity: change of the total angular momentum over its value, in the oracle.

{table(["q", "arm r - overlap/2", "arm r"], momentum)}

## Beside the other departures from similarity

At q = 0.01 against q = 1 (oracle, on the wall):

{table(["departure", "v_t", "r spin"], others)}

`surfaceEnergyOriginal`, which gives the right static strength, changes oblique impacts more than the arm does.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=PAGE, help="page to write (default: docs/lever-arm.md)")
    output = parser.parse_args().output
    output.write_text(page(find_simulator()), encoding="utf-8")
    print(output)


if __name__ == "__main__":
    main()
