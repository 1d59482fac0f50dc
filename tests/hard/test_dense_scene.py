"""Dense scenes: hundreds of spheres with many contacts each, with and without the correction of events."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from scipy.spatial import cKDTree
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
YOUNG, POISSON, SURFACE_ENERGY, DENSITY = 2.1e9, 0.27, 0.049, 1350.0
RADIUS, SIDE = 0.9e-6, 7
PAIR = AdhesivePair(effective_modulus(YOUNG, POISSON), 0.5 * RADIUS, SURFACE_ENERGY)
MASS = sphere_mass(RADIUS, DENSITY)
PERIOD = float(2.0 * np.pi * np.sqrt(0.5 * MASS / PAIR.stiffness))
BOX = (-1.9e-5, 1.9e-5) * 3
# Both come to rest, with 1e-9 of the forces left; on the way damping is taken at the full or at the half step, which
# leaves the
# springs along the surfaces in other places, second order in the time step: measured 1e-7.
SAME_AT_REST = 1e-6
MOMENTUM_ROUND_OFF = 1e-12
# A collision at 60 steps a period costs plain Verlet up to some percent of its energy, either way; the corrected one
# 1e-3.
ENERGY_ERROR_WITH_CORRECTION = 0.01


def materials(restitution):
    return Materials(
        1,
        {
            "youngsModulus": YOUNG,
            "poissonsRatio": POISSON,
            "coefficientRestitution": restitution,
            "coefficientFriction": 0.37,
            "surfaceEnergy": SURFACE_ENERGY,
            "adhesionHysteresis": 0.71,
        },
    )


def lattice(spacing, jitter):
    cells = np.array([(i, j, k) for i in range(SIDE) for j in range(SIDE) for k in range(SIDE)]) - 0.5 * (SIDE - 1)
    return cells * spacing + jitter * np.random.default_rng(8).normal(size=(SIDE**3, 3))


def overlaps(places, radii):
    pairs = cKDTree(places).query_pairs(2.0 * radii.max() * 1.01, output_type="ndarray")
    overlap = (
        radii[pairs[:, 0]] + radii[pairs[:, 1]] - np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    )
    pairs = pairs[overlap > 0.0]
    order = np.lexsort(pairs.T)
    return {
        tuple(sorted(pair)): value
        for pair, value in zip(pairs[order].tolist(), overlap[overlap > 0.0][order], strict=True)
    }


@pytest.mark.parametrize("model", MODELS)
def test_compressed_cluster_comes_to_the_same_rest_with_and_without_event_correction(plugin, tmp_path, figure, model):
    """343 spheres, 882 contacts, squeezed and a little disordered: a sphere in the middle has six contacts, and a
    correction made for one collision must not leave a force behind where contacts stay."""
    places = lattice(2.0 * RADIUS - 1.6 * PAIR.equilibrium_overlap, 0.04 * PAIR.equilibrium_overlap)
    steps, ends = 5000, []
    for correction in ("on", "off"):
        frame = Simulation(
            [Sphere(place, RADIUS, DENSITY) for place in places],
            materials(0.13),
            PERIOD / 45.0,
            steps,
            style=f"model {model} tangential jkr rolling_friction krijt",
            keywords=f"twisting on rollingDamping 0.5 eventCorrection {correction}",
            every=steps,
            box=BOX,
        ).run(plugin, tmp_path / correction)
        ends.append(frame[frame["step"] == steps].sort_values("id"))
    first, second = (overlaps(end[["x", "y", "z"]].to_numpy(), np.full(SIDE**3, RADIUS)) for end in ends)
    assert first.keys() == second.keys() and len(first) == 3 * SIDE**2 * (SIDE - 1)
    difference = max(abs(first[pair] - second[pair]) for pair in first)
    figure(
        "largest difference of an overlap / equilibrium overlap", difference / PAIR.equilibrium_overlap, SAME_AT_REST
    )
    forces = [end[["fx", "fy", "fz"]].to_numpy() for end in ends]
    figure(
        "largest force left on a sphere / F_C",
        max(np.abs(force).max() for force in forces) / PAIR.pull_off_force,
        SAME_AT_REST,
    )


@pytest.mark.parametrize("correction", ["on", "off"])
@pytest.mark.parametrize("model", MODELS)
def test_collapsing_cloud_conserves_momentum(plugin, tmp_path, figure, model, correction):
    """Hundreds of contacts are made and broken in spheres that touch others already; the weights of events act on one
    contact, and must do so on both partners alike."""
    rng = np.random.default_rng(5)
    places = lattice(2.0 * RADIUS * 1.02, 0.004 * RADIUS)
    speed = 0.4 * np.sqrt(PAIR.energy_unit / MASS)
    velocities = -places / np.abs(places).max() * speed + 0.3 * speed * rng.normal(size=places.shape)
    spins = 0.1 * speed / RADIUS * rng.normal(size=places.shape)
    steps = 4000
    frame = Simulation(
        [
            Sphere(*item)
            for item in zip(places, [RADIUS] * len(places), [DENSITY] * len(places), velocities, spins, strict=True)
        ],
        materials(0.83),
        PERIOD / 60.0,
        steps,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=f"twisting on eventCorrection {correction}",
        every=steps // 4,
        box=BOX,
    ).run(plugin, tmp_path)
    x, v, w = (
        frame[names.split()].to_numpy().reshape(-1, len(places), 3)
        for names in ("x y z", "vx vy vz", "omegax omegay omegaz")
    )
    assert len(overlaps(x[-1], np.full(len(places), RADIUS))) > 300
    linear = MASS * v.sum(axis=1)
    figure(
        "drift of linear momentum, relative to the sum of the magnitudes",
        np.abs(linear - linear[0]).max() / (MASS * np.abs(v[0]).sum()),
        MOMENTUM_ROUND_OFF,
    )
    angular = MASS * np.cross(x, v).sum(axis=1) + 0.4 * MASS * RADIUS**2 * w.sum(axis=1)
    figure(
        "drift of angular momentum, relative to the sum of the magnitudes",
        np.abs(angular - angular[0]).max() / (MASS * np.abs(np.cross(x[0], v[0])).sum()),
        MOMENTUM_ROUND_OFF,
    )


def test_event_correction_keeps_the_energy_of_a_cloud_of_elastic_collisions(plugin, tmp_path, figure):
    """In the simplified law a collision at e = 1 gives back all energy; what the make and the break of a contact
    inside a step lose or gain is the error of the integrator, summed over a thousand collisions, some of three
    spheres at once."""
    rng = np.random.default_rng(6)
    places = lattice(2.0 * RADIUS * 1.03, 0.005 * RADIUS)
    speed = 1.9 * np.sqrt(PAIR.energy_unit / MASS)
    velocities = -places / np.abs(places).max() * speed + 0.5 * speed * rng.normal(size=places.shape)
    steps, change = 3000, {}
    for correction in ("on", "off"):
        frame = Simulation(
            [
                Sphere(*item)
                for item in zip(places, [RADIUS] * len(places), [DENSITY] * len(places), velocities, strict=True)
            ],
            materials(1.0),
            PERIOD / 60.0,
            steps,
            style="model jkr/simplified tangential off rolling_friction off",
            keywords=f"eventCorrection {correction}",
            every=steps,
            box=(-9e-5, 9e-5) * 3,
        ).run(plugin, tmp_path / correction)
        x, v = (frame[names.split()].to_numpy().reshape(-1, len(places), 3) for names in ("x y z", "vx vy vz"))
        energy = []
        for k in (0, -1):
            held = np.array(list(overlaps(x[k], np.full(len(places), RADIUS)).values()))
            # a contact's energy counted from its break at delta = 0
            energy.append(
                0.5 * MASS * (v[k] ** 2).sum() + (PAIR.energy(held) - PAIR.energy(0.0)).sum()
                if len(held)
                else 0.5 * MASS * (v[k] ** 2).sum()
            )
        change[correction] = abs(energy[1] / energy[0] - 1.0)
    figure("change of the total energy with eventCorrection on, relative", change["on"], ENERGY_ERROR_WITH_CORRECTION)
