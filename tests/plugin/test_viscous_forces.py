"""Dashpots through LIGGGHTS, read off at step 0, when nothing is wound up yet.

F and M of a moving sphere less those of one at rest.

eta_N, eta_T = 2 sqrt(5/6) |beta| sqrt(k_T m), eta_R = 2 x sqrt(k_r I_r/R), twisting eta_T a^2/2; and friction that
only ever brakes.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from jkr import Jkr, effective_modulus, effective_shear_modulus
from simulation import Materials, Simulation, Sphere
from trajectory import Trajectory, trajectory

from pyjkr.run import Simulator

pytestmark = pytest.mark.liggghts

# round-off of the overlap: 4 eps R/overlap, half of it in a radius that goes as its root, and of the sums behind a
# difference
VISCOUS = 1e-11
YOUNGS, POISSON, ENERGY, DENSITY, RESTITUTION = 3.3e9, 0.24, 0.029, 2090.0, 0.62
MODULUS, SHEAR = effective_modulus(YOUNGS, POISSON), effective_shear_modulus(YOUNGS, POISSON)
BETA = -math.log(RESTITUTION) / math.sqrt(math.log(RESTITUTION) ** 2 + math.pi**2)
RADIUS, PARTNER, OVERLAP = 2.6e-6, 3.9e-6, 2.2e-8
FRACTION = 0.37
MODELS = ("jkr/simplified", "jkr")
PROPERTIES = dict(
    youngsModulus=YOUNGS,
    poissonsRatio=POISSON,
    coefficientRestitution=RESTITUTION,
    coefficientFriction=90.0,
    surfaceEnergy=ENERGY,
    criticalRollingAngle=0.3,
)


def mass(radius: float) -> float:
    return 4.0 / 3.0 * math.pi * radius**3 * DENSITY


def started(plugin: Simulator, directory: Path, model: str, setting: str, velocity, spin) -> Trajectory:
    """A sphere on a wall (contact below it), or to the right of a larger one (contact along -x)."""
    if setting == "wall":
        spheres = [Sphere((0.0, 0.0, RADIUS - OVERLAP), RADIUS, DENSITY, velocity, spin)]
    else:
        spheres = [
            Sphere((RADIUS + PARTNER - OVERLAP, 0.0, 0.0), RADIUS, DENSITY, velocity, spin),
            Sphere((0.0, 0.0, 0.0), PARTNER, DENSITY),
        ]
    simulation = Simulation(
        spheres,
        Materials(1, PROPERTIES),
        time_step=1e-12,
        steps=0,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=f"twisting on rollingDamping {FRACTION}",
        walls=["primitive type 1 zplane 0.0"] if setting == "wall" else [],
    )
    return trajectory(simulation, plugin, directory)


@pytest.mark.parametrize("setting", ["wall", "pair"])
@pytest.mark.parametrize("model", MODELS)
def test_dashpots_of_all_four_modes_are_those_of_the_contract(
    plugin: Simulator, tmp_path: Path, model: str, setting: str
) -> None:
    wall = setting == "wall"
    law = Jkr(RADIUS if wall else RADIUS * PARTNER / (RADIUS + PARTNER), MODULUS, ENERGY)
    m = mass(RADIUS) if wall else mass(RADIUS) * mass(PARTNER) / (mass(RADIUS) + mass(PARTNER))
    inertia_i, inertia_j = (0.4 * mass(r) * r**2 for r in (RADIUS, PARTNER))
    inertia = inertia_i if wall else inertia_i * inertia_j / (inertia_i + inertia_j)
    a = law.contact_radius(OVERLAP)
    carrying = a if model == "jkr" else math.sqrt(law.radius * OVERLAP)
    # 2 sqrt(5/6) sqrt(2 E c m) = sqrt(5) sqrt((4/3) E c m), c the radius that carries
    eta_n = math.sqrt(5.0) * BETA * math.sqrt(4.0 / 3.0 * MODULUS * carrying * m)
    k_t = 8.0 * SHEAR * carrying
    eta_t = 2.0 * math.sqrt(5.0 / 6.0) * BETA * math.sqrt(k_t * m)
    k_r = 4.0 * law.pull_off * (a / law.a0) ** 1.5
    eta_r = 2.0 * FRACTION * math.sqrt(k_r * inertia / law.radius)
    # along the contact (n: away from the partner), across it, and the third direction
    along, across, third = ("z", "x", "y") if wall else ("x", "y", "z")
    still = started(plugin, tmp_path / "still", model, setting, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert still[f"f{along}"][0, 0] == pytest.approx(law.force(OVERLAP), rel=VISCOUS, abs=VISCOUS * law.pull_off)
    assert all(
        still[f"{f}{axis}"][0, 0] == 0.0
        for f, axis in (("f", across), ("f", third), ("tq", "x"), ("tq", "y"), ("tq", "z"))
    )

    def move(name: str, speed: dict[str, float], spin: dict[str, float]) -> Trajectory:
        vectors = [tuple(d.get(axis, 0.0) for axis in "xyz") for d in (speed, spin)]
        return started(plugin, tmp_path / name, model, setting, *vectors)

    v, w = 0.23, 3.1e4
    apart = move("apart", {along: v}, {})
    assert apart[f"f{along}"][0, 0] - still[f"f{along}"][0, 0] == pytest.approx(-eta_n * v, rel=VISCOUS)
    slides = move("slides", {across: v}, {})
    assert slides[f"f{across}"][0, 0] == pytest.approx(-eta_t * v, rel=VISCOUS)
    arm = RADIUS - 0.5 * OVERLAP  # LIGGGHTS' own lever: half the overlap off either radius
    asymmetry = 1.0 if wall else (PARTNER - RADIUS) / (PARTNER + RADIUS)
    # sliding along +across about +third: the lever turns it with eta_T arm v, the rolling dashpot against v_L =
    # asymmetry v/2
    turn = eta_t * v * arm - eta_r * 0.5 * asymmetry * v
    assert abs(slides[f"tq{third}"][0, 0]) == pytest.approx(abs(turn), rel=VISCOUS)
    twists = move("twists", {}, {along: w})
    assert twists[f"tq{along}"][0, 0] == pytest.approx(-0.5 * eta_t * a * a * w, rel=VISCOUS)
    assert abs(twists[f"f{across}"][0, 0]) <= VISCOUS * law.pull_off
    # rolls without slip: only the rolling dashpot is left, against v_L = R omega
    rolls = move("rolls", {across: arm * w}, {third: w})
    assert abs(rolls[f"f{across}"][0, 0]) <= VISCOUS * eta_t * arm * w
    assert rolls[f"tq{third}"][0, 0] == pytest.approx(-eta_r * law.radius * w, rel=VISCOUS)
    if not wall:
        # partners feel opposite forces; the rolling and twisting moments are opposite too
        assert slides[f"f{across}"][0, 1] == -slides[f"f{across}"][0, 0]
        assert rolls[f"tq{third}"][0, 1] == pytest.approx(-rolls[f"tq{third}"][0, 0], rel=VISCOUS)
        assert twists[f"tq{along}"][0, 1] == -twists[f"tq{along}"][0, 0]


OBLIQUE = dict(
    youngsModulus=2.7e9,
    poissonsRatio=0.27,
    coefficientRestitution=0.6,
    coefficientFriction=0.35,
    adhesionHysteresis=0.1,
)


@pytest.mark.parametrize("energy", [0.0, 0.0005, 0.05])
@pytest.mark.parametrize("model", MODELS)
def test_friction_of_an_oblique_impact_never_drives_the_slip(
    plugin: Simulator, tmp_path: Path, model: str, energy: float
) -> None:
    radius, speed, approach = 5.3e-6, 7.0, 3.1
    simulation = Simulation(
        [Sphere((0.0, 0.0, radius + 1e-9), radius, 2310.0, (speed, 0.0, -approach))],
        Materials(1, OBLIQUE | dict(surfaceEnergy=energy)),
        time_step=2e-11,
        steps=2500,
        style=f"model {model} tangential jkr",
        walls=["primitive type 1 zplane 0.0"],
        every=10,
    )
    t = trajectory(simulation, plugin, tmp_path)
    slip = t["vx"][:, 0] - radius * t["omegay"][:, 0]
    driven = (t["fx"][:, 0] > 0.0) & (slip > 0.5 * speed)
    assert not driven.any(), (
        f"pushed along in {driven.sum()} of {(t['fz'][:, 0] != 0).sum()} snapshots in contact; vx up to {t['vx'].max()}"
    )
