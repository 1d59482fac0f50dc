"""Time steps too large: where each mode becomes unstable, and what a run that blows up leaves behind."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, effective_shear_modulus
from simulation import Materials, Simulation, Sphere

from pyjkr import dump
from pyjkr.errors import DumpError, RunError

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
YOUNG, POISSON = 1.9e9, 0.29
RADIUS = 1.1e-6
# Undamped velocity Verlet: dt omega = 2. The spheres of the grid are half a percent apart, and just beyond the limit
# an amplitude
# needs some steps to show its growth.
VERLET_LIMIT = 2.0
MEASURED_WITHIN = 0.01
GRID = np.arange(1.90, 2.101, 0.01)
STEPS = 150


def stable_up_to(
    plugin, directory, model, omega_at_unit_mass, excite, keywords, tangential, surface_energy, **properties
):
    """Largest dt omega of a row of spheres of graded density, stuck to a plane, whose excitation does not grow."""
    wall = AdhesivePair(effective_modulus(YOUNG, POISSON), RADIUS, surface_energy)
    volume = 4.0 / 3.0 * np.pi * RADIUS**3
    time_step = 1e-9
    spheres = []
    for number, product in enumerate(GRID):
        density = float((omega_at_unit_mass * time_step / product) ** 2 / volume)
        offset, velocity, spin = excite(wall, product / time_step)
        place = (0.0, 9.0 * RADIUS * number, RADIUS - wall.equilibrium_overlap - offset)
        spheres.append(Sphere(place, RADIUS, density, velocity, spin))
    frame = Simulation(
        spheres,
        Materials(
            1,
            {
                "youngsModulus": YOUNG,
                "poissonsRatio": POISSON,
                "coefficientRestitution": 1.0,
                "coefficientFriction": 0.9,
                "surfaceEnergy": surface_energy,
                "adhesionHysteresis": 0.93,
                **properties,
            },
        ),
        time_step,
        STEPS,
        style=f"model {model} tangential {tangential} rolling_friction krijt",
        keywords=keywords,
        walls=["primitive type 1 zplane 0.0"],
        box=(-2.1e-5, 2.3e-5, -2.1e-5, 2.4e-4, -1.1e-5, 1.3e-4),
        skin=1.9e-6,
    ).run(plugin, directory)
    count = len(GRID)
    motion = np.concatenate(
        [
            (frame["z"].to_numpy().reshape(-1, count, 1) - (RADIUS - wall.equilibrium_overlap))
            / wall.equilibrium_overlap,
            frame[["vx", "vy", "vz"]].to_numpy().reshape(-1, count, 3) * time_step / wall.equilibrium_overlap,
            frame[["omegax", "omegay", "omegaz"]].to_numpy().reshape(-1, count, 3)
            * time_step
            * RADIUS
            / wall.equilibrium_overlap,
        ],
        axis=2,
    )
    size = np.abs(motion).max(axis=2)
    # the largest stable dt omega makes beats of 30 times the first amplitude
    grown = size[-STEPS // 2 :].max(axis=0) > 1e3 * size[:3].max(axis=0)
    assert not grown[0] and grown[-1], "the grid does not enclose the limit"
    return float(GRID[np.argmax(grown) - 1]), int(np.argmax(grown)), grown


SMALL = 1e-9  # of the equilibrium overlap: linear until it has grown a million times


def kick_normal(wall, omega):
    return SMALL * wall.equilibrium_overlap, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


def kick_sliding(wall, omega):
    speed = SMALL * wall.equilibrium_overlap * omega
    # the mode of a free sphere on a wall: 2/7 of the slip is translation, 5/7 rotation
    return 0.0, (2.0 / 7.0 * speed, 0.0, 0.0), (0.0, -5.0 / 7.0 * speed / RADIUS, 0.0)


def kick_rolling(wall, omega):
    return 0.0, (0.0, 0.0, 0.0), (SMALL * wall.equilibrium_overlap * omega / RADIUS, 0.0, 0.0)


def kick_twisting(wall, omega):
    return 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, SMALL * wall.equilibrium_overlap * omega / RADIUS)


def modes():
    modulus, shear = effective_modulus(YOUNG, POISSON), effective_shear_modulus(YOUNG, POISSON)

    def wall(surface_energy):
        return AdhesivePair(modulus, RADIUS, surface_energy)

    soft, strong = 0.053, 90.0  # J/m2; with the second a_0 is 1.3 R, and twisting is faster than the normal oscillation
    return {
        "normal": (kick_normal, "", "off", soft, np.sqrt(wall(soft).stiffness), {}),
        "sliding": (kick_sliding, "", "jkr", soft, ("tangential", np.sqrt(28.0 * shear), soft), {}),
        # k_r of the original surface energy, which may be many times the reduced one; in place, v_L is half of r omega
        "rolling": (
            kick_rolling,
            "",
            "off",
            soft,
            np.sqrt(5.0 * 3.0 * np.pi * 200.0 * soft),
            {"surfaceEnergyOriginal": 200.0 * soft},
        ),
        "twisting": (kick_twisting, "twisting on", "off", strong, ("twisting", np.sqrt(10.0 * shear), strong), {}),
    }


@pytest.mark.parametrize("mode", ["normal", "sliding", "rolling", "twisting"])
@pytest.mark.parametrize("model", MODELS)
def test_each_mode_is_stable_up_to_the_limit_of_velocity_verlet(plugin, tmp_path, figure, model, mode):
    """Forces are taken at half-step velocities and histories are summed step by step: an explicit spring can lose half
    of Verlet's limit by one misplaced half step. Found by a row of spheres, dt omega = 1.90 ... 2.10."""
    excite, keywords, tangential, surface_energy, omega, extra = modes()[mode]
    if isinstance(omega, tuple):
        kind, factor, energy = omega
        wall = AdhesivePair(effective_modulus(YOUNG, POISSON), RADIUS, energy)
        # the radius that the stiffness k_T takes: a_0 in the full law, sqrt(R delta_0) = a_0/sqrt(3) in the
        # simplified one
        a0 = wall.equilibrium_contact_radius
        stiff = a0 if model == "jkr" else a0 / np.sqrt(3.0)
        omega = factor * np.sqrt(stiff) if kind == "tangential" else factor * np.sqrt(stiff) * a0 / RADIUS
    limit, _, grown = stable_up_to(
        plugin, tmp_path, model, float(omega), excite, keywords, tangential, surface_energy, **extra
    )
    print(mode, model, limit, grown.astype(int))
    assert (np.diff(grown.astype(int)) >= 0).all()
    figure(
        "largest stable dt omega, relative distance from 2",
        abs(limit + 0.005 - VERLET_LIMIT) / VERLET_LIMIT,
        MEASURED_WITHIN,
    )


def blown_up(time_step_factor, **changes):
    """Five stuck spheres in a row with a time step that is too large by far, in a box that grows with them."""
    pair = AdhesivePair(effective_modulus(YOUNG, POISSON), 0.5 * RADIUS, 0.053)
    mass = 4.0 / 3.0 * np.pi * RADIUS**3 * 1300.0
    spacing = 2.0 * RADIUS - 1.07 * pair.equilibrium_overlap
    return Simulation(
        [Sphere((spacing * k, 0.0, 0.0), RADIUS, 1300.0) for k in range(-2, 3)],
        Materials(
            1,
            {
                "youngsModulus": YOUNG,
                "poissonsRatio": POISSON,
                "coefficientRestitution": 0.93,
                "coefficientFriction": 0.9,
                "surfaceEnergy": 0.053,
                "adhesionHysteresis": 0.87,
            },
        ),
        float(time_step_factor * np.sqrt(mass / pair.stiffness)),
        5000,
        style="model jkr tangential jkr rolling_friction krijt",
        every=1000,
        skin=0.9 * RADIUS,
        **changes,
    )


@pytest.mark.parametrize("factor", [13.0, 1.7e3, 2.9e6])
def test_run_that_blows_up_ends_with_an_error(plugin, tmp_path, figure, factor):
    """The first step throws the spheres through each other and out of the box: LIGGGHTS itself would end a run that
    lost spheres with exit status 0 unless told otherwise."""
    with pytest.raises(RunError, match=r"Lost atoms|lost|ERROR|not finite"):
        blown_up(factor).run(plugin, tmp_path)
    figure("runs recorded as complete", (tmp_path / "run.json").exists(), 0.0)


def test_not_a_number_in_a_dump_is_not_taken_for_a_result(plugin, tmp_path):
    """A force that is not a number spreads to positions, and LIGGGHTS writes them and ends with exit status 0."""
    lines = ["variable bad equal sqrt(-1.0)", "fix bad all addforce v_bad 0.0 0.0"]
    with pytest.raises((RunError, DumpError)) as raised:
        blown_up(1e-3, before_run=lines).run(plugin, tmp_path)
    if (tmp_path / "trajectory.txt").exists() and "nan" in (tmp_path / "trajectory.txt").read_text():
        with pytest.raises(DumpError, match="blew up"):
            dump.read(tmp_path / "trajectory.txt")
    assert "trajectory" in str(raised.value) or "finite" in str(raised.value) or "ERROR" in str(raised.value)
