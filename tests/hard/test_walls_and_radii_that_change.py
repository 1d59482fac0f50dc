"""Walls that move, and spheres that are smaller than any known when the run began."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere
from test_mesh_edges import quadrilateral, stl

from pyjkr.errors import RunError

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
YOUNG, POISSON, SURFACE_ENERGY = 2.3e9, 0.31, 0.061
RADIUS, DENSITY = 3.7e-6, 1250.0
WALL = AdhesivePair(effective_modulus(YOUNG, POISSON), RADIUS, SURFACE_ENERGY)
TIME_STEP = float(2 * np.pi * np.sqrt(sphere_mass(RADIUS, DENSITY) / WALL.stiffness)) / 130.0
HALF = 1.6e-4
# The moving mesh stands at v t, rounded to 1e-16 of the coordinates: 1e-12 of an overlap a step, over a thousand steps.
SAME_IN_THE_MOVING_FRAME = 1e-7


def materials():
    return Materials(
        2,
        {
            "youngsModulus": YOUNG,
            "poissonsRatio": POISSON,
            "coefficientRestitution": 0.77,
            "coefficientFriction": 0.37,
            "surfaceEnergy": SURFACE_ENERGY,
            "adhesionHysteresis": 0.61,
        },
    )


@pytest.mark.parametrize("impact_speed", [0.6, 7.1], ids=["sticks", "bounces"])
@pytest.mark.parametrize("model", MODELS)
def test_sphere_meets_a_moving_mesh_as_it_would_a_mesh_at_rest(plugin, tmp_path, figure, model, impact_speed):
    """The wall brings its speed into sliding, rolling, the previous overlap and the lists of near triangles; only the
    difference of the speeds may matter."""
    steps, frame_velocity = 900, np.array([1.3, -0.4, 2.9])
    velocity = np.array([0.9, 0.5, -impact_speed])
    plate = quadrilateral((-HALF, -HALF, 0.0), (HALF, -HALF, 0.0), (HALF, HALF, 0.0), (-HALF, HALF, 0.0))
    results = []
    for moving in (False, True):
        directory = tmp_path / ("moving" if moving else "resting")
        directory.mkdir()
        (directory / "mesh.stl").write_text(stl(plate))
        shift = frame_velocity if moving else np.zeros(3)
        words = " ".join(repr(float(v)) for v in frame_velocity)
        frame = Simulation(
            [Sphere((1.1e-6, 2.3e-6, RADIUS + 40.3 * impact_speed * TIME_STEP), RADIUS, DENSITY, tuple(velocity + shift))],
            materials(),
            TIME_STEP,
            steps,
            style=f"model {model} tangential jkr rolling_friction krijt",
            keywords="twisting on",
            box=(-1.8e-4, 1.8e-4) * 3,
            skin=1.7e-6,
            walls=["mesh n_meshes 1 meshes mesh"],
            setup=("fix mesh all mesh/surface file mesh.stl type 2 precision 1e-13",),
            before_run=(f"fix motion all move/mesh mesh mesh linear {words}",) if moving else (),
        ).run(plugin, directory)
        time = frame["step"].to_numpy()[:, None] * TIME_STEP
        results.append(
            np.hstack(
                [
                    (frame[["x", "y", "z"]].to_numpy() - shift * time) / RADIUS,
                    (frame[["vx", "vy", "vz"]].to_numpy() - shift) / impact_speed,
                    frame[["omegax", "omegay", "omegaz"]].to_numpy() * RADIUS / impact_speed,
                ]
            )
        )
    resting, moving = results
    touched = np.abs(resting[:, 5] + 1.0).max() > 0.1
    assert touched, "the sphere did not meet the wall"
    worst = np.abs(resting - moving).max()
    figure("largest difference of position, velocity and spin in the frame of the wall", worst, SAME_IN_THE_MOVING_FRAME)


def test_a_neck_too_long_for_what_was_known_before_the_run_is_one_error_and_no_lost_contact(plugin, tmp_path):
    """The search was sized for the smallest sphere of the first run; shrunk since, and run on without a new set-up, the
    neck of a sphere could leave the lists unseen."""
    small, smaller = 0.021 * RADIUS, 0.019 * RADIUS
    lines = (
        "run 1",
        "group first id 1",
        "group second id 2",
        f"set group first diameter {2 * small!r} density {DENSITY!r}",
        f"set group second diameter {2 * smaller!r} density {DENSITY!r}",
        f"set group second x {small + smaller - 1e-3 * smaller!r}",
        "run 20 pre no",
    )
    apart = [
        Sphere((0.0, 0.0, 0.0), RADIUS, DENSITY),
        Sphere((5.0 * RADIUS, 0.0, 0.0), 0.9 * RADIUS, DENSITY),
    ]
    with pytest.raises(RunError, match=r"model jkr: a sphere of radius \S+ is smaller than any known before the run; its neck"):
        Simulation(
            apart, materials(), TIME_STEP * 1e-3, 0, style="model jkr", skin=5.0 * RADIUS, run_lines=lines
        ).run(plugin, tmp_path)
