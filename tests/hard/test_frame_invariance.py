"""Frame invariance: the same collision turned, mirrored, with its partners exchanged, moved along."""

from __future__ import annotations

import numpy as np
import pytest
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
MATERIALS = Materials(
    2,
    {
        "youngsModulus": [2.3e9, 1.7e9],
        "poissonsRatio": [0.31, 0.23],
        "coefficientRestitution": [[0.83, 0.77], [0.77, 0.71]],
        "coefficientFriction": [[0.43, 0.37], [0.37, 0.29]],
        "surfaceEnergy": [[0.061, 0.047], [0.047, 0.039]],
        "surfaceEnergyOriginal": [[0.073, 0.067], [0.067, 0.053]],
        "youngsModulusOriginal": [3.1e9, 2.9e9],
        "adhesionHysteresis": [[0.81, 0.59], [0.59, 0.66]],
    },
)
RADII = (1.3e-6, 0.9e-6)
DENSITIES = (1100.0, 1250.0)
NORMAL = np.array([0.6, 0.64, 0.48])
GAP = 2e-9
FIRST = np.array([0.2e-6, -0.3e-6, 0.1e-6])
POSITIONS = np.array([FIRST, FIRST + (sum(RADII) + GAP) * NORMAL / np.linalg.norm(NORMAL)])
VELOCITIES = np.array([[1.1, 2.3, 0.4], [-2.9, -1.7, 0.7]])
SPINS = np.array([[3.1e5, -2.2e5, 6.4e5], [-1.7e5, 2.6e5, 5.3e5]])
TIME_STEP = 1.1e-10
# The first bounces off after 140 steps, the second sticks, slides, rolls and twists for the whole run.
SPEED_FACTORS = {"rebounds": 1.07, "sticks": 0.11}
STEPS = 1500

# Round-off of an overlap is 1e-16 of a coordinate, 1e-14 of the overlap; a collision magnifies it some ten times.
SAME_IN_EVERY_FRAME = 1e-10
# Sums of a few numbers, rounded once a step.
MOMENTUM_ROUND_OFF = 1e-12

UNTURNED, AT_REST = np.eye(3), np.zeros(3)
TURN, _ = np.linalg.qr(np.random.default_rng(20).normal(size=(3, 3)))
TURN = TURN * np.linalg.det(TURN)
MIRROR = np.diag([1.0, 1.0, -1.0]) @ TURN.T
FRAMES = {
    "turned": {"matrix": TURN},
    "mirrored": {"matrix": MIRROR},
    "exchanged": {"exchange": True},
    "moving along": {"frame_velocity": np.array([7.3, -11.0, 5.9])},
}


def collide(plugin, directory, model, factor, matrix=UNTURNED, exchange=False, frame_velocity=AT_REST):
    """The collision in another frame, described in the original one: arrays of snapshot, sphere, component."""
    parity = np.linalg.det(matrix)  # spins and moments are axial vectors
    spheres = [
        Sphere(
            matrix @ POSITIONS[k],
            RADII[k],
            DENSITIES[k],
            matrix @ (factor * VELOCITIES[k]) + frame_velocity,
            parity * matrix @ (factor * SPINS[k]),
            k + 1,
        )
        for k in range(2)
    ]
    order = slice(None, None, -1 if exchange else 1)
    frame = Simulation(
        spheres[order],
        MATERIALS,
        TIME_STEP,
        STEPS,
        every=3,
        box=(-4e-5, 4e-5) * 3,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on rollingDamping 0.03",
    ).run(plugin, directory)
    times = frame["step"].to_numpy().reshape(-1, 2)[:, :1, None] * TIME_STEP

    def vectors(*columns):
        return frame[list(columns)].to_numpy().reshape(-1, 2, 3)[:, order]

    return {
        "position": (vectors("x", "y", "z") - times * frame_velocity) @ matrix,
        "velocity": (vectors("vx", "vy", "vz") - frame_velocity) @ matrix,
        "spin": parity * vectors("omegax", "omegay", "omegaz") @ matrix,
        "force": vectors("fx", "fy", "fz") @ matrix,
        "moment": parity * vectors("tqx", "tqy", "tqz") @ matrix,
        "mass": frame["mass"].to_numpy().reshape(-1, 2)[0, order],
    }


def stays_in_contact(run):
    distance = np.linalg.norm(run["position"][:, 1] - run["position"][:, 0], axis=1)
    return distance[-1] < 1.001 * sum(RADII)


@pytest.fixture(scope="module")
def originals(plugin, tmp_path_factory):
    return {
        (model, outcome): collide(plugin, tmp_path_factory.mktemp("original"), model, factor)
        for model in MODELS
        for outcome, factor in SPEED_FACTORS.items()
    }


@pytest.mark.parametrize("outcome", SPEED_FACTORS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", FRAMES)
def test_oblique_collision_is_the_same_in_another_frame(plugin, tmp_path, originals, figure, name, model, outcome):
    """Sliding, rolling and twisting histories are vectors in the contact plane with signs of their own: a wrong sign
    or an axis treated apart shows only when the frame is turned, mirrored, exchanged or moved."""
    original = originals[model, outcome]
    assert stays_in_contact(original) == (outcome == "sticks")
    seen = collide(plugin, tmp_path, model, SPEED_FACTORS[outcome], **FRAMES[name])
    worst = max(
        np.abs(seen[what] - original[what]).max() / np.abs(original[what]).max()
        for what in ("position", "velocity", "spin", "force", "moment")
    )
    figure(
        "largest difference of position, velocity, spin, force, moment over the run, relative to the largest value",
        worst,
        SAME_IN_EVERY_FRAME,
    )


@pytest.mark.parametrize("outcome", SPEED_FACTORS)
@pytest.mark.parametrize("model", MODELS)
def test_free_pair_conserves_momentum_and_angular_momentum(originals, figure, model, outcome):
    """The moments of a contact on its two unequal partners must add up with the lever arms of the tangential force,
    also in the steps in which the contact is made and broken, where forces are weighted."""
    run = originals[model, outcome]
    mass = run["mass"][:, None]
    inertia = 0.4 * mass * np.array(RADII)[:, None] ** 2
    linear = mass * run["velocity"]
    orbital, spin = np.cross(run["position"], linear), inertia * run["spin"]
    total = linear.sum(axis=1)
    figure(
        "drift of linear momentum, relative to the largest of one sphere",
        np.abs(total - total[0]).max() / np.abs(linear).max(),
        MOMENTUM_ROUND_OFF,
    )
    total = orbital.sum(axis=1) + spin.sum(axis=1)
    figure(
        "drift of angular momentum, relative to the largest orbital or spin part of one sphere",
        np.abs(total - total[0]).max() / max(np.abs(orbital).max(), np.abs(spin).max()),
        MOMENTUM_ROUND_OFF,
    )


@pytest.mark.parametrize("model", MODELS)
def test_impact_on_a_plane_is_the_same_on_all_six_planes(plugin, tmp_path, figure, model):
    """Walls of either orientation along either axis take other paths through the simulator than pairs do, and a wall
    has no second sphere to balance a wrong sign."""
    radius, plane = 1.7e-6, 0.4e-6
    velocity, spin = np.array([1.9, -1.2, -2.7]), np.array([2.3e5, 4.1e5, -3.7e5])
    seen = []
    for axis in range(3):
        for side in (1.0, -1.0):
            # x -> y -> z -> x, then a mirror in the plane for the other side
            matrix = np.roll(np.eye(3), axis + 1, axis=0) @ np.diag([1.0, 1.0, side])
            parity = np.linalg.det(matrix)
            position = matrix @ np.array([0.3e-6, -0.2e-6, radius + 1.4e-9]) + plane * np.abs(
                matrix @ np.array([0.0, 0.0, 1.0])
            )
            word = "xyz"[int(np.flatnonzero(matrix[:, 2])[0])]
            frame = Simulation(
                [Sphere(position, radius, 1150.0, matrix @ velocity, parity * matrix @ spin)],
                MATERIALS,
                1.3e-10,
                900,
                every=3,
                style=f"model {model} tangential jkr rolling_friction krijt",
                keywords="twisting on rollingDamping 0.07",
                walls=[f"primitive type 2 {word}plane {plane!r}"],
                box=(-4e-5, 4e-5) * 3,
            ).run(plugin, tmp_path / f"{word}{side:+.0f}")
            seen.append(
                {
                    "velocity": frame[["vx", "vy", "vz"]].to_numpy() @ matrix,
                    "spin": parity * frame[["omegax", "omegay", "omegaz"]].to_numpy() @ matrix,
                    "force": frame[["fx", "fy", "fz"]].to_numpy() @ matrix,
                    "moment": parity * frame[["tqx", "tqy", "tqz"]].to_numpy() @ matrix,
                }
            )
    assert np.abs(seen[0]["force"]).max() > 0.0
    worst = max(
        np.abs(run[what] - seen[0][what]).max() / np.abs(seen[0][what]).max() for run in seen[1:] for what in seen[0]
    )
    figure(
        "largest difference of velocity, spin, force, moment over the run, relative to the largest value",
        worst,
        SAME_IN_EVERY_FRAME,
    )
