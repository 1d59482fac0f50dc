"""Small oscillations of a stuck sphere: each mode rings at its closed-form frequency.

Stuck at a_0 on a wall (mass m, radius r) or to an equal sphere. Along the normal k = 1.2 E a_0; sliding (7/2) k_T/m,
for the sphere rolls back as it slides: 28 G a_0/m for the full law, k_T = 8 G a_0, and 3^(-1/2) of that for the
simplified one, whose k_T = 8 G sqrt(R overlap); rolling 5 k_r/(7 m r) with k_r = 4 F_C; twisting (5/4) k_T a_0^2/(m
r^2): 10 G a_0^3/(m r^2) for the full law.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from jkr import Jkr, effective_modulus, effective_shear_modulus
from simulation import Materials, Simulation, Sphere
from trajectory import angular_frequency, trajectory

from pyjkr.run import Simulator

pytestmark = pytest.mark.liggghts

# Verlet at 60 steps a period rings (2 pi/60)^2/24 = 4.6e-4 too fast; lever arms are r - overlap/2, 1e-4 of r here
FREQUENCY = 1e-3
AMPLITUDE = 1e-2  # of the damped oscillation: the dashpot acts on half-step speeds
YOUNGS, POISSON, ENERGY, DENSITY, RADIUS = 8.7e9, 0.31, 0.023, 1930.0, 3.1e-6
MASS = 4.0 / 3.0 * math.pi * RADIUS**3 * DENSITY
SHEAR = effective_shear_modulus(YOUNGS, POISSON)
WALL = Jkr(RADIUS, effective_modulus(YOUNGS, POISSON), ENERGY)
PAIR = Jkr(0.5 * RADIUS, effective_modulus(YOUNGS, POISSON), ENERGY)
NORMAL = math.sqrt(WALL.stiffness / MASS)
# nothing yields: a large friction coefficient and hysteresis; e = 1: nothing damps
PROPERTIES = Materials(
    1,
    dict(
        youngsModulus=YOUNGS,
        poissonsRatio=POISSON,
        coefficientRestitution=1.0,
        coefficientFriction=40.0,
        surfaceEnergy=ENERGY,
        adhesionHysteresis=70.0,
    ),
)
MODELS = ("jkr/simplified", "jkr")
STEPS_A_PERIOD = 60
PERIODS = 5.2


def ring(
    plugin: Simulator,
    directory: Path,
    model: str,
    style: str,
    omega: float,
    spheres: list[Sphere],
    column: str,
    wall: bool = True,
    fastest: float = 0.0,
    keywords: str = "",
) -> float:
    """Measured angular frequency of `column` of the first sphere, relative to omega.

    The step follows the fastest mode.
    """
    time_step = 2.0 * math.pi / max(omega, fastest) / STEPS_A_PERIOD
    steps = int(PERIODS * 2.0 * math.pi / omega / time_step)
    every = max(1, int(2.0 * math.pi / omega / time_step / STEPS_A_PERIOD))
    simulation = Simulation(
        spheres,
        PROPERTIES,
        time_step,
        steps,
        style=f"model {model} {style}",
        keywords=keywords,
        walls=["primitive type 1 zplane 0.0"] if wall else [],
        every=every,
    )
    t = trajectory(simulation, plugin, directory)
    return angular_frequency(t.step * time_step, t[column][:, 0]) / omega


def stuck(velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)) -> list[Sphere]:
    return [Sphere((0.0, 0.0, RADIUS - WALL.settled), RADIUS, DENSITY, velocity, spin)]


def tangential_stiffness(model: str) -> float:
    return 8.0 * SHEAR * (WALL.a0 if model == "jkr" else math.sqrt(RADIUS * WALL.settled))


@pytest.mark.parametrize("model", MODELS)
def test_stuck_sphere_oscillates_along_the_normal(plugin: Simulator, tmp_path: Path, model: str) -> None:
    speed = 1e-3 * WALL.settled * NORMAL
    assert ring(plugin, tmp_path, model, "tangential jkr", NORMAL, stuck((0.0, 0.0, speed)), "vz") == pytest.approx(
        1.0, rel=FREQUENCY
    )


@pytest.mark.parametrize("model", MODELS)
def test_stuck_sphere_oscillates_along_the_wall(plugin: Simulator, tmp_path: Path, model: str) -> None:
    omega = math.sqrt(3.5 * tangential_stiffness(model) / MASS)
    speed = 1e-4 * WALL.settled * omega
    # the mode itself: F turns the sphere 5/2 times as fast as it moves it
    spheres = stuck((speed, 0.0, 0.0), (0.0, -2.5 * speed / RADIUS, 0.0))
    assert ring(plugin, tmp_path, model, "tangential jkr", omega, spheres, "vx") == pytest.approx(1.0, rel=FREQUENCY)


@pytest.mark.parametrize("model", MODELS)
def test_stuck_sphere_twists_on_the_wall(plugin: Simulator, tmp_path: Path, model: str) -> None:
    omega = math.sqrt(1.25 * tangential_stiffness(model) * WALL.a0**2 / (MASS * RADIUS**2))
    style = "tangential jkr rolling_friction krijt"
    spheres = stuck((0.0, 0.0, 0.0), (0.0, 0.0, 1e-4 * omega))
    got = ring(plugin, tmp_path, model, style, omega, spheres, "omegaz", fastest=2.2 * NORMAL, keywords="twisting on")
    assert got == pytest.approx(1.0, rel=FREQUENCY)


@pytest.mark.parametrize("model", MODELS)
def test_stuck_sphere_rolls_to_and_fro_on_the_wall(plugin: Simulator, tmp_path: Path, model: str) -> None:
    omega = math.sqrt(60.0 * math.pi * ENERGY / (7.0 * MASS))
    spin = 1e-3 * WALL.settled * omega / RADIUS
    spheres = stuck((spin * (RADIUS - 0.5 * WALL.settled), 0.0, 0.0), (0.0, spin, 0.0))
    style = "tangential jkr rolling_friction krijt"
    assert ring(plugin, tmp_path, model, style, omega, spheres, "omegay", fastest=2.2 * NORMAL) == pytest.approx(
        1.0, rel=FREQUENCY
    )


@pytest.mark.parametrize("model", MODELS)
def test_equal_spheres_roll_to_and_fro_on_each_other(plugin: Simulator, tmp_path: Path, model: str) -> None:
    omega = math.sqrt(15.0 * math.pi * ENERGY / MASS)
    half, spin = RADIUS - 0.5 * PAIR.settled, 1e-3 * WALL.settled * omega / RADIUS
    spheres = [Sphere((s * half, 0.0, 0.0), RADIUS, DENSITY, (0.0, 0.0, 0.0), (0.0, s * spin, 0.0)) for s in (-1, 1)]
    style = "tangential jkr rolling_friction krijt"
    got = ring(
        plugin,
        tmp_path,
        model,
        style,
        omega,
        spheres,
        "omegay",
        wall=False,
        fastest=2.2 * math.sqrt(2.0 * PAIR.stiffness / MASS),
    )
    assert got == pytest.approx(1.0, rel=FREQUENCY)


def test_rolling_damping_is_a_fraction_of_the_critical_one(plugin: Simulator, tmp_path: Path) -> None:
    # equal pair, counter-rotating: amplitude falls by exp(-2 pi x/sqrt(1 - x^2)) a period, and the period grows
    fraction = 0.13
    omega = math.sqrt(15.0 * math.pi * ENERGY / MASS)
    half, spin = RADIUS - 0.5 * PAIR.settled, 1e-3 * WALL.settled * omega / RADIUS
    spheres = [Sphere((s * half, 0.0, 0.0), RADIUS, DENSITY, (0.0, 0.0, 0.0), (0.0, s * spin, 0.0)) for s in (-1, 1)]
    time_step = 2.0 * math.pi / (2.2 * math.sqrt(2.0 * PAIR.stiffness / MASS)) / STEPS_A_PERIOD
    period = 2.0 * math.pi / (omega * math.sqrt(1.0 - fraction**2))
    steps = round(2.0 * period / time_step)
    simulation = Simulation(
        spheres,
        PROPERTIES,
        time_step,
        steps,
        style="model jkr tangential jkr rolling_friction krijt",
        keywords=f"rollingDamping {fraction}",
        every=steps // 200,
    )
    t = trajectory(simulation, plugin, tmp_path)
    times, values = t.step * time_step, t["omegay"][:, 1] / spin
    exact = np.exp(-fraction * omega * times) * (
        np.cos(2 * math.pi * times / period)
        - fraction / math.sqrt(1 - fraction**2) * np.sin(2 * math.pi * times / period)
    )
    assert np.abs(values - exact).max() <= AMPLITUDE
