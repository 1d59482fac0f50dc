"""Stuck for long: pairs, chains and clusters that nothing damps, over millions of steps."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, effective_shear_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
YOUNG, POISSON, SURFACE_ENERGY = 1.9e9, 0.29, 0.053
DENSITY = 1300.0
STYLE = "model {} tangential jkr rolling_friction krijt"

PAIR_STEPS = 10_000_000
CHAIN_STEPS = 10_000_000
CLUSTER_STEPS = 6_000
# Velocity Verlet at 40 steps a period conserves a shadow energy; of the true one, (omega dt)^2/4 = 0.6 % breathes
# with the
# phase, a little more on the harder side of the anharmonic well.
BREATHING = 1e-2
# Highest and lowest value of a tenth of the run are known to what 400 samples show of them; measured 3e-7.
DRIFT_OF_ENERGY = 5e-6
# Momentum walks by one rounding a step: 1e-16 of the oscillation's, sqrt(1e7) steps, summed over 2e5 periods;
# measured 2e-8.
CREEP_OF_CENTRE = 1e-6
# The axis turns only by round-off: measured 6e-11.
CREEP_OF_AXIS = 1e-9
ROUND_OFF_SPIN = 1e-6
# Bounds of a quasi-periodic motion with four frequencies, from samples: two parts of the run differ by what they
# happened to
# sample; measured 3e-3 at most. A pumped or drained oscillation is off by its own size.
BOUND_OF_SAMPLES = 0.02
# The swing of the axis that belongs to the motion is 3e-4 rad; creep would add up over a thousand times that.
SWING_OF_AXIS = 1e-3
# Forces of a lattice at its equilibrium overlap are roundings of the overlap, 1e-16 of a coordinate of ten diameters,
# times the stiffness; measured 2e-12.
REST = 3e-11


def materials(**changes):
    return Materials(
        1,
        {
            "youngsModulus": YOUNG,
            "poissonsRatio": POISSON,
            "coefficientRestitution": 1.0,
            "coefficientFriction": 0.41,
            "surfaceEnergy": SURFACE_ENERGY,
            "adhesionHysteresis": 0.73,
            **changes,
        },
    )


def contact(radius_i, radius_j):
    return AdhesivePair(effective_modulus(YOUNG, POISSON), radius_i * radius_j / (radius_i + radius_j), SURFACE_ENERGY)


def energies(frame, radii, masses, neighbours):
    """Kinetic plus normal potential energy of every snapshot, of spheres whose contacts are known."""
    count = len(radii)
    x = frame[["x", "y", "z"]].to_numpy().reshape(-1, count, 3)
    v = frame[["vx", "vy", "vz"]].to_numpy().reshape(-1, count, 3)
    w = frame[["omegax", "omegay", "omegaz"]].to_numpy().reshape(-1, count, 3)
    kinetic = (0.5 * masses * (v**2).sum(-1) + 0.2 * masses * np.square(radii) * (w**2).sum(-1)).sum(-1)
    potential = sum(
        contact(radii[i], radii[j]).energy(radii[i] + radii[j] - np.linalg.norm(x[:, i] - x[:, j], axis=-1))
        for i, j in neighbours
    )
    return kinetic + potential, kinetic


@pytest.mark.parametrize("model", MODELS)
def test_stuck_pair_oscillates_for_ten_million_steps_without_drift(plugin, tmp_path, figure, model):
    """Nothing damps at e = 1, so any force that is not the gradient of an energy by a part in 1e10 shows after 2e5
    periods; the axis is oblique, so that round-off feeds sliding, rolling and twisting springs that nothing damps
    either."""
    radii = (1.1e-6, 0.8e-6)
    masses = np.array([sphere_mass(radius, DENSITY) for radius in radii])
    pair = contact(*radii)
    reduced = masses.prod() / masses.sum()
    omega = np.sqrt(pair.stiffness / reduced)
    axis = np.array([2.0, -6.0, 9.0]) / 11.0
    distance = sum(radii) - 1.37 * pair.equilibrium_overlap
    frame = Simulation(
        [
            Sphere((0.1e-6, 0.2e-6, -0.3e-6), radii[0], DENSITY),
            Sphere(np.array([0.1e-6, 0.2e-6, -0.3e-6]) + distance * axis, radii[1], DENSITY),
        ],
        materials(),
        float(2 * np.pi / omega / 40.0),
        PAIR_STEPS,
        style=STYLE.format(model),
        keywords="twisting on",
        every=PAIR_STEPS // 4000 - 1,
    ).run(plugin, tmp_path)
    energy, _ = energies(frame, radii, masses, [(0, 1)])
    figure("spread of the total energy, relative to its mean", np.ptp(energy) / energy.mean(), BREATHING)
    tenth = len(energy) // 10
    # the envelope of the breathing is sharp: highest and lowest value of the first and the last tenth
    drift = max(abs(end(energy[-tenth:]) - end(energy[:tenth])) for end in (np.max, np.min)) / energy.mean()
    figure("drift of the energy's bounds from the first to the last tenth, relative", drift, DRIFT_OF_ENERGY)
    x = frame[["x", "y", "z"]].to_numpy().reshape(-1, 2, 3)
    centre = (x * (masses / masses.sum())[:, None]).sum(1)
    figure(
        "creep of the centre of mass / equilibrium overlap",
        np.abs(centre - centre[0]).max() / pair.equilibrium_overlap,
        CREEP_OF_CENTRE,
    )
    direction = (x[:, 1] - x[:, 0]) / np.linalg.norm(x[:, 1] - x[:, 0], axis=1)[:, None]
    figure("creep of the axis [rad]", np.abs(np.cross(direction, axis)).max(), CREEP_OF_AXIS)
    spin = frame[["omegax", "omegay", "omegaz"]].to_numpy()
    speed = np.sqrt(2.0 * energy.mean() / reduced)
    figure(
        "largest spin of a sphere, times its radius, relative to the speed of the oscillation",
        np.abs(spin).max() * radii[0] / speed,
        ROUND_OFF_SPIN,
    )


@pytest.mark.parametrize("overlap_factor", [1.0, 1.33], ids=["normal at rest", "normal too"])
@pytest.mark.parametrize("model", MODELS)
def test_sliding_rolling_and_twisting_of_a_stuck_pair_neither_grow_nor_creep(
    plugin, tmp_path, figure, model, overlap_factor
):
    """Springs whose stiffness changes with the overlap and whose displacements turn with the pair are no gradient of
    an energy: a careless frame for the history pumps energy into the pair or lets it walk round. Angular momentum
    is 0, so the pair may swing but not turn."""
    radii, steps = (1.1e-6, 0.8e-6), 2_000_000
    masses = np.array([sphere_mass(radius, DENSITY) for radius in radii])
    inertias = 0.4 * masses * np.square(radii)
    pair = contact(*radii)
    reduced = masses.prod() / masses.sum()
    axis = np.array([2.0, -6.0, 9.0]) / 11.0
    first = np.cross(axis, [1.0, 0.0, 0.0]) / np.linalg.norm(np.cross(axis, [1.0, 0.0, 0.0]))
    speed = 0.05 * np.sqrt(pair.energy_unit / reduced)
    distance = sum(radii) - overlap_factor * pair.equilibrium_overlap
    shares = np.array([masses[1], -masses[0]])[:, None] / masses.sum()
    places, velocities = -distance * axis * shares, 0.5 * speed * np.cross(axis, first) * shares
    spin = 0.3 * speed / 1e-6 * (first + 0.8 * axis)
    spins = np.array([spin, -spin * inertias[0] / inertias[1]])
    spins -= np.cross(places, masses[:, None] * velocities).sum(0) / inertias.sum()
    frame = Simulation(
        [Sphere(places[k], radii[k], DENSITY, velocities[k], spins[k]) for k in range(2)],
        materials(coefficientFriction=0.92, adhesionHysteresis=0.98),
        float(2 * np.pi * np.sqrt(reduced / pair.stiffness) / 80.0),
        steps,
        style=STYLE.format(model),
        keywords="twisting on",
        every=199,
    ).run(plugin, tmp_path)
    energy, _ = energies(frame, radii, masses, [(0, 1)])
    quarters = np.array([part.max() for part in np.array_split(energy, 4)]) / energy[0]
    figure(
        "growth of the largest energy outside the springs, from the start to any quarter",
        quarters.max() - 1.0,
        BOUND_OF_SAMPLES,
    )
    x = frame[["x", "y", "z"]].to_numpy().reshape(-1, 2, 3)
    direction = (x[:, 1] - x[:, 0]) / np.linalg.norm(x[:, 1] - x[:, 0], axis=1)[:, None]
    figure(
        "largest angle between the axis and its first direction [rad]",
        np.linalg.norm(np.cross(direction, axis), axis=1).max(),
        SWING_OF_AXIS,
    )


@pytest.mark.parametrize("model", MODELS)
def test_stuck_chain_swings_for_millions_of_steps_without_drift(plugin, tmp_path, figure, model):
    """Five spheres in a bent row: every sphere but the ends feels two contacts, so speeds at the full step may not be
    guessed from one contact's force alone, and soft bending modes show what the springs lose or gain."""
    radii = np.array([1.1e-6, 0.8e-6, 1.3e-6, 0.9e-6, 1.2e-6])
    masses = np.array([sphere_mass(radius, DENSITY) for radius in radii])
    rng = np.random.default_rng(4)
    places = [np.array([-4.2e-6, 0.3e-6, -0.2e-6])]
    for k in range(4):
        direction = np.array([0.9, 0.3 * (-1) ** k, 0.2]) + 0.1 * rng.normal(size=3)
        pair = contact(radii[k], radii[k + 1])
        places.append(
            places[-1]
            + (radii[k] + radii[k + 1] - (1.0 + 0.07 * (k - 1.6)) * pair.equilibrium_overlap)
            * direction
            / np.linalg.norm(direction)
        )
    pair = contact(0.8e-6, 0.9e-6)
    fastest = np.sqrt(
        8.0 * effective_shear_modulus(YOUNG, POISSON) * pair.equilibrium_contact_radius * 7.0 / masses.min()
    )
    frame = Simulation(
        [Sphere(places[k], float(radii[k]), DENSITY) for k in range(5)],
        materials(coefficientFriction=0.92, adhesionHysteresis=0.98),
        float(2.0 / fastest / 8.0),
        CHAIN_STEPS,
        style=STYLE.format(model),
        keywords="twisting on",
        every=CHAIN_STEPS // 8000 - 1,
    ).run(plugin, tmp_path)
    energy, _ = energies(frame, radii, masses, [(k, k + 1) for k in range(4)])
    quarters = np.array([part.max() for part in np.array_split(energy, 4)]) / energy[0]
    figure(
        "growth of the largest energy outside the springs, from the start to any quarter",
        quarters.max() - 1.0,
        BOUND_OF_SAMPLES,
    )
    means = np.array([part.mean() for part in np.array_split(energy, 4)]) / energy[0]
    figure(
        "change of the mean energy outside the springs from the second to the last quarter, relative",
        abs(means[-1] - means[1]),
        BOUND_OF_SAMPLES,
    )
    x = frame[["x", "y", "z"]].to_numpy().reshape(-1, 5, 3)
    chord = x[:, -1] - x[:, 0]
    chord /= np.linalg.norm(chord, axis=1)[:, None]
    figure(
        "largest angle between the chord and its first direction [rad]",
        np.linalg.norm(np.cross(chord, chord[0]), axis=1).max(),
        3 * SWING_OF_AXIS,
    )


@pytest.mark.parametrize("model", MODELS)
def test_cluster_of_a_thousand_at_rest_stays_at_rest(plugin, tmp_path, figure, model):
    """2700 undamped contacts at their equilibrium: the force there is the difference of two equal terms, and its
    rounding drives every sphere; an error of the equilibrium in the tenth digit would set the cluster breathing."""
    radius, side = 0.9e-6, 10
    pair = contact(radius, radius)
    spacing = 2.0 * radius - pair.equilibrium_overlap
    cells = np.array([(i, j, k) for i in range(side) for j in range(side) for k in range(side)])
    places = (cells - 0.5 * (side - 1)) * spacing
    mass = sphere_mass(radius, DENSITY)
    frame = Simulation(
        [Sphere(place, radius, DENSITY) for place in places],
        materials(),
        float(2 * np.pi * np.sqrt(0.5 * mass / pair.stiffness) / 60.0),
        CLUSTER_STEPS,
        style=STYLE.format(model),
        keywords="twisting on",
        every=CLUSTER_STEPS // 8,
        box=(-1.6e-5, 1.6e-5) * 3,
    ).run(plugin, tmp_path)
    start = frame[frame["step"] == 0].sort_values("id")
    worst = {"speed": 0.0, "shift": 0.0, "spin": 0.0}
    for _, snapshot in frame.groupby("step"):
        worst["shift"] = max(
            worst["shift"], np.abs(snapshot[["x", "y", "z"]].to_numpy() - start[["x", "y", "z"]].to_numpy()).max()
        )
        worst["speed"] = max(worst["speed"], np.abs(snapshot[["vx", "vy", "vz"]].to_numpy()).max())
        worst["spin"] = max(worst["spin"], np.abs(snapshot[["omegax", "omegay", "omegaz"]].to_numpy()).max())
    unit_speed = np.sqrt(pair.energy_unit / mass)
    figure("largest shift of a sphere / equilibrium overlap", worst["shift"] / pair.equilibrium_overlap, REST)
    figure("largest speed of a sphere / speed of the adhesive well", worst["speed"] / unit_speed, REST)
    figure("largest spin of a sphere, times its radius / the same speed", worst["spin"] * radius / unit_speed, REST)
