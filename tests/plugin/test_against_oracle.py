"""Clusters in LIGGGHTS and in the oracle: with the time step, the plug-in's trajectories tend to the oracle's.

Both start from the same numbers. The largest difference over all snapshots is taken relative to the impact: of
velocities and r x spin over the speed, of positions over speed x duration. It must fall with the time step, and be
small at the smallest one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from simulation import Materials, Simulation, Sphere
from trajectory import trajectory

from pyjkr import oracle
from pyjkr.run import Simulator

pytestmark = pytest.mark.liggghts

SNAPSHOTS = 10
FINEST = 400  # steps a collision
CLOSE = 1e-4  # at FINEST; measured: 3e-7 to 7.4e-5
ORDER = 1.1  # from FINEST/8 on; measured: 1.2 to 2.3. Springs yield and rolling reaches its limit within a step: first order
RADIUS, DENSITY, YOUNGS, POISSON, ENERGY = 0.61e-6, 1047.0, 3.3e9, 0.34, 0.053
MODELS = ("jkr/simplified", "jkr")


@dataclass(frozen=True)
class Case:
    """Spheres, free or on the floor z = 0; `softening` is E_mod/E with gamma ~ E^(2/5), the originals beside them."""

    spheres: list[Sphere]
    duration: float  # in Hertz collision times at `speed`
    model: str = "jkr"
    speed: float = 6.0
    floor: bool = False
    twisting: bool = True
    rolling_damping: float = 0.0
    event_correction: str = "on"
    friction: float = 0.21
    restitution: float = 0.74
    hysteresis: float = 0.31
    softening: float = 1.0
    expected: set[str] = field(default_factory=set)  # kinds of events that the case is about

    @property
    def collision_time(self) -> float:
        """Of a sphere of RADIUS on a wall."""
        modulus, mass = self.softening * YOUNGS / (2 * (1 - POISSON**2)), 4 / 3 * math.pi * RADIUS**3 * DENSITY
        return 2.868 * (mass**2 / (RADIUS * modulus**2 * self.speed)) ** 0.2

    @property
    def surface_energy(self) -> float:
        return ENERGY * self.softening**0.4

    def in_oracle(self) -> oracle.Trajectory:
        radius = np.array([sphere.radius for sphere in self.spheres])
        youngs = self.softening * YOUNGS
        law = oracle.PairLaw(
            effective_modulus=oracle.effective_modulus(youngs, POISSON, youngs, POISSON),
            effective_shear_modulus=oracle.effective_shear_modulus(youngs, POISSON, youngs, POISSON),
            surface_energy=self.surface_energy,
            restitution_coefficient=self.restitution,
            friction_coefficient=self.friction,
            adhesion_hysteresis=self.hysteresis,
            surface_energy_original=ENERGY,
            effective_modulus_original=oracle.effective_modulus(YOUNGS, POISSON, YOUNGS, POISSON),
        )
        start = oracle.Assembly(
            *(
                np.array([getattr(sphere, name) for sphere in self.spheres], dtype=float)
                for name in ("position", "velocity", "spin")
            ),
            radius,
            4 / 3 * math.pi * radius**3 * DENSITY,
            law,
            oracle.Options(self.model, twisting=self.twisting, rolling_damping=self.rolling_damping),
            [oracle.Wall((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))] if self.floor else [],
        )
        return oracle.follow(start, self.duration * self.collision_time, samples=SNAPSHOTS + 1, relative_tolerance=1e-8)

    def in_liggghts(
        self, plugin: Simulator, directory: Path, steps_a_collision: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions [m], velocities [m/s], spins [rad/s]: snapshots x spheres x 3."""
        every = round(self.duration * steps_a_collision / SNAPSHOTS)
        properties = dict(
            youngsModulus=self.softening * YOUNGS,
            youngsModulusOriginal=YOUNGS,
            poissonsRatio=POISSON,
            coefficientRestitution=self.restitution,
            coefficientFriction=self.friction,
            surfaceEnergy=self.surface_energy,
            surfaceEnergyOriginal=ENERGY,
            adhesionHysteresis=self.hysteresis,
        )
        t = trajectory(
            Simulation(
                self.spheres,
                Materials(1, properties),
                time_step=self.duration * self.collision_time / (SNAPSHOTS * every),
                steps=SNAPSHOTS * every,
                style=f"model {self.model} tangential jkr rolling_friction krijt",
                keywords=f"twisting {'on' if self.twisting else 'off'} rollingDamping {self.rolling_damping} "
                f"eventCorrection {self.event_correction}",
                walls=["primitive type 1 zplane 0.0"] if self.floor else [],
                every=every,
            ),
            plugin,
            directory,
        )
        return tuple(np.stack([t[name + axis] for axis in "xyz"], axis=-1) for name in ("", "v", "omega"))

    def differences(
        self, plugin: Simulator, directory: Path, reference: oracle.Trajectory, steps_a_collision: int
    ) -> np.ndarray:
        """Largest of each: positions, velocities, spins."""
        position, velocity, spin = self.in_liggghts(plugin, directory, steps_a_collision)
        radius = np.array([sphere.radius for sphere in self.spheres])[:, None]
        length = self.speed * self.duration * self.collision_time
        return np.array(
            [
                np.abs(position - reference.position).max() / length,
                np.abs(velocity - reference.velocity).max() / self.speed,
                np.abs((spin - reference.spin) * radius).max() / self.speed,
            ]
        )


def equilibrium(radius_i: float, radius_j: float = math.inf) -> float:
    """Overlap without load of the real material [m]."""
    contact = oracle.NormalContact(
        oracle.effective_radius(radius_i, radius_j),
        oracle.effective_modulus(YOUNGS, POISSON, YOUNGS, POISSON),
        ENERGY,
        "jkr",
    )
    return float(oracle.equilibrium_overlap(contact))


def oblique_wall() -> Case:
    sphere = Sphere((0.0, 0.0, 1.003 * RADIUS), RADIUS, DENSITY, (5.9, -2.1, -6.3), (0.4e6, 2.3e6, -7.1e6))
    return Case([sphere], 2.1, floor=True, expected={"make", "slip", "roll", "spin", "break"})


def oblique_pair() -> Case:
    normal, small = np.array([0.48, 0.6, 0.64]), 0.57 * RADIUS
    apart = 1.002 * (RADIUS + small)
    spheres = [
        Sphere((0.0, 0.0, 0.0), RADIUS, DENSITY, (2.9, 1.3, 1.7), (0.9e6, -1.4e6, 2.2e6)),
        Sphere(tuple(apart * normal), small, DENSITY, (-3.4, -4.9, -2.8), (1.7e6, 9.6e6, 10.4e6)),
    ]
    return Case(spheres, 1.4, speed=9.0, softening=0.11, rolling_damping=0.13, expected={"make", "roll", "break"})


def necking_pair() -> Case:
    normal, small = np.array([0.6, 0.0, 0.8]), 0.71 * RADIUS
    apart = RADIUS + small - equilibrium(RADIUS, small)
    away = 2.2 * normal + 0.9 * np.array([0.8, 0.0, -0.6]) + np.array([0.0, 0.4, 0.0])
    spheres = [
        Sphere((0.0, 0.0, 0.0), RADIUS, DENSITY, tuple(-0.3 * away), (0.5e6, -0.2e6, 1.9e6)),
        Sphere(tuple(apart * normal), small, DENSITY, tuple(0.7 * away), (-0.4e6, 0.6e6, -0.3e6)),
    ]
    return Case(spheres, 1.2, speed=2.5, expected={"break"})


def struck_chain() -> Case:
    step = 2 * RADIUS - equilibrium(RADIUS, RADIUS)
    spheres = [Sphere((k * step, 0.0, 0.0), RADIUS, DENSITY) for k in range(2)]
    spheres += [Sphere(((1 + math.cos(0.7)) * step, math.sin(0.7) * step, 0.0), RADIUS, DENSITY)]
    hit = np.array([-0.81, 0.45, 0.37]) / np.linalg.norm([-0.81, 0.45, 0.37])
    spheres.insert(
        0,
        Sphere(
            tuple(2.004 * RADIUS * hit), RADIUS, DENSITY, tuple(-5.0 * hit + [0.3, 2.4, -0.8]), (1.1e6, 0.3e6, -0.7e6)
        ),
    )
    return Case(spheres, 3.0, friction=0.33, rolling_damping=0.07, expected={"make", "roll"})


def cluster_on_wall() -> Case:
    gap, height = 2 * RADIUS - equilibrium(RADIUS, RADIUS), RADIUS - equilibrium(RADIUS)
    corners = (
        gap
        / math.sqrt(3)
        * np.array([[math.cos(a), math.sin(a)] for a in (0.2, 0.2 + 2 * math.pi / 3, 0.2 + 4 * math.pi / 3)])
    )
    spheres = [Sphere((x, y, height), RADIUS, DENSITY) for x, y in corners]
    top = height + math.sqrt(gap**2 - gap**2 / 3) + 0.01 * RADIUS
    spheres.append(
        Sphere((0.04 * RADIUS, -0.02 * RADIUS, top), 0.93 * RADIUS, DENSITY, (1.6, -0.9, -4.8), (0.6e6, 1.2e6, -0.9e6))
    )
    return Case(spheres, 2.2, floor=True, friction=0.4, expected={"make", "roll"})


CASES = {case.__name__: case for case in (oblique_wall, oblique_pair, necking_pair, struck_chain, cluster_on_wall)}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", CASES)
def test_trajectories_tend_to_those_of_the_oracle(plugin: Simulator, tmp_path: Path, name: str, model: str) -> None:
    case = replace(CASES[name](), model=model)
    reference = case.in_oracle()
    assert case.expected <= {event.kind for event in reference.events}
    steps = [FINEST // 8, FINEST // 4, FINEST // 2, FINEST]
    errors = np.array([case.differences(plugin, tmp_path / str(n), reference, n) for n in steps])
    order = np.polyfit(-np.log(steps), np.log(errors.max(axis=1)), 1)[0]
    assert np.all(errors[-1] < CLOSE), f"position, velocity, spin: {errors}"
    assert order > ORDER, f"order {order} of {errors}"
