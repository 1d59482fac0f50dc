"""Extreme parameters: overlaps, sizes, surface energies and restitution at the ends of what LIGGGHTS takes."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
# LIGGGHTS refuses coefficients of restitution of 0.05 and below.
SMALLEST_RESTITUTION = 0.0501
POISSON = 0.29

# Root and powers of the law: a few units in the last place of max(abs(F), F_C); the rounding of the overlap comes on
# top.
LAW_ROUND_OFF = 1e-12
# The two roots of the quartic meet at rupture: what round-off leaves of the difference is its square root.
NEXT_TO_RUPTURE = 1e-7
# A distance is rounded three times: difference, square root, radius sum.
OVERLAP_ROUNDINGS = 4.0
EPSILON = np.finfo(float).eps


def properties(**changes):
    return {
        "youngsModulus": 1.9e9,
        "poissonsRatio": POISSON,
        "coefficientRestitution": 0.87,
        "coefficientFriction": 0.41,
        "surfaceEnergy": 0.053,
        "adhesionHysteresis": 0.73,
        **changes,
    }


OVERLAPS = np.array(
    [1e-16, 3e-16, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5]
)


@pytest.mark.parametrize("surface_energy", [0.0, 1e-12, 0.053, 10.0])
@pytest.mark.parametrize("radius", [1.3e-9, 0.7e-6, 0.9e-3], ids=["1.3 nm", "0.7 um", "0.9 mm"])
@pytest.mark.parametrize("model", MODELS)
def test_force_follows_the_law_from_1e_minus_16_to_one_half_of_the_radius(
    plugin, tmp_path, figure, model, radius, surface_energy
):
    """The reduced overlap spans up to 25 decades: the quartic for the contact radius loses its small root to
    cancellation if solved naively, and at gamma = 1e-12 or R = 1 nm absolute thresholds would show."""
    young = 2.1e12 if surface_energy == 10.0 else 1.9e9  # stiff enough that necks are shorter than the spheres
    if surface_energy == 0.053 and radius < 1e-8:
        young = 6.7e10
    other = 1.4 * radius
    effective_radius = radius * other / (radius + other)
    pair = AdhesivePair(effective_modulus(young, POISSON), effective_radius, surface_energy)
    spheres = []
    for number, overlap in enumerate(OVERLAPS):
        # the left sphere at the origin of x keeps all digits of the overlap that there are
        y = 8.0 * radius * number
        spheres += [
            Sphere((0.0, y, 0.0), radius, 1700.0),
            Sphere((radius + other - overlap * effective_radius, y, 0.0), other, 1900.0),
        ]
    steps = Simulation(
        spheres,
        Materials(1, properties(youngsModulus=young, surfaceEnergy=surface_energy)),
        1e-15,
        0,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on",
    ).run(plugin, tmp_path)
    left, right = (steps[k::2].reset_index(drop=True) for k in range(2))
    distance = (right["x"] - left["x"]).to_numpy()
    overlap = (radius + other) - distance
    force = -left["fx"].to_numpy()
    touching = overlap > 0.0
    assert touching[3:].all() and (force[~touching] == 0.0).all()
    expected = np.where(touching, pair.force(np.where(touching, overlap, 1e-30)), 0.0)
    rounding = OVERLAP_ROUNDINGS * EPSILON * (radius + other)
    spread = np.abs(pair.force(np.maximum(overlap, 0.0) + rounding) - pair.force(np.maximum(overlap, 0.0)))
    scale = np.maximum(np.abs(expected), pair.pull_off_force)
    off = np.maximum(np.abs(force - expected) - spread, 0.0) / np.where(scale > 0.0, scale, np.inf)
    figure(
        "error of the force beyond the rounding of the overlap, relative to max(|F|, F_C)",
        off[touching].max(),
        LAW_ROUND_OFF,
    )
    assert (right["fx"] == -left["fx"]).all()


CASES = {
    # radius of the smaller sphere, size ratio, surface energy, Young's modulus
    "R 1 nm": (1.1e-9, 1.7, 0.053, 6.7e10),
    "R 1 mm": (1.3e-3, 1.7, 0.053, 2.3e9),
    "gamma 0": (0.9e-6, 1.3, 0.0, 2.3e9),
    "gamma 1e-12": (0.9e-6, 1.3, 1e-12, 2.3e9),
    "gamma 10": (0.9e-6, 1.3, 10.0, 2.1e12),
    "size ratio 1e4": (7e-9, 1e4, 0.053, 2.9e10),
}
# A collision of some hundred steps at second order, e = 1; measured 4e-5 at most.
ENERGY_ERROR_OF_A_COLLISION = 5e-4
# The sticking oscillation of the smallest e dies out exponentially; what is left is round-off of the equilibrium.
LEFT_AFTER_DAMPING = 1e-9


def scales(case):
    small, ratio, surface_energy, young = CASES[case]
    radii, densities = (small, ratio * small), (1700.0, 1900.0)
    pair = AdhesivePair(effective_modulus(young, POISSON), radii[0] * radii[1] / sum(radii), surface_energy)
    masses = [sphere_mass(r, d) for r, d in zip(radii, densities, strict=True)]
    reduced = masses[0] * masses[1] / sum(masses)
    return radii, densities, pair, masses, reduced, surface_energy, young


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("model", MODELS)
def test_elastic_collision_at_extreme_parameters_keeps_its_energy(plugin, tmp_path, figure, model, case):
    """With e = 1 nothing is lost but, in the full law, the known work of the neck; 1e4 in size is 1e12 in mass, and a
    neck of a nanometre sphere is as long as a tenth of it."""
    radii, densities, pair, masses, reduced, surface_energy, young = scales(case)
    # fast enough to come off again: five times the work of adhesion, or a Hertz overlap of a hundredth of the radius
    hertz = 8.0 / 15.0 * pair.modulus * np.sqrt(pair.radius) * (0.01 * pair.radius) ** 2.5
    energy = 5.0 * pair.energy_unit if surface_energy > 1e-6 else hertz
    speed = float(np.sqrt(2.0 * energy / reduced))
    duration = 2.87 * (reduced**2 / (pair.radius * pair.modulus**2 * speed)) ** 0.2
    gap = 0.3 * speed * duration / 200.0
    spheres = [
        Sphere((0.0, 0.0, 0.0), radii[0], densities[0], (speed * masses[1] / sum(masses), 0.0, 0.0)),
        Sphere((sum(radii) + gap, 0.0, 0.0), radii[1], densities[1], (-speed * masses[0] / sum(masses), 0.0, 0.0)),
    ]
    frame = Simulation(
        spheres,
        Materials(1, properties(youngsModulus=young, surfaceEnergy=surface_energy, coefficientRestitution=1.0)),
        float(duration / 200.0),
        900,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on",
    ).run(plugin, tmp_path)
    velocity = frame["vx"].to_numpy().reshape(-1, 2)
    assert np.abs(frame["fx"].to_numpy()[-2:]).max() == 0.0
    loss = 0.0
    if model == "jkr" and surface_energy > 0.0:
        ends = pair.energy(np.array([pair.rupture_overlap, 0.0]))
        loss = float(ends[0] - ends[1])
    rebound = velocity[-1, 1] - velocity[-1, 0]
    figure(
        "error of the relative kinetic energy after the collision, relative to that before",
        abs(0.5 * reduced * rebound**2 + loss - energy) / energy,
        ENERGY_ERROR_OF_A_COLLISION,
    )
    assert (frame[["omegax", "omegay", "omegaz"]] == 0.0).all().all()


@pytest.mark.parametrize("case", [case for case in CASES if not case.startswith("gamma 0")])
@pytest.mark.parametrize("model", MODELS)
def test_strongly_damped_pair_comes_to_rest_at_the_equilibrium_overlap(plugin, tmp_path, figure, model, case):
    """At the smallest e that LIGGGHTS takes damping and adhesion are both strong where the force is near 0: a damping
    that divides by the force or the overlap gives NaN there."""
    radii, densities, pair, masses, reduced, surface_energy, young = scales(case)
    time_step = float(2.0 * np.pi * np.sqrt(reduced / pair.stiffness) / 120.0)
    speed = 0.3 * float(np.sqrt(pair.energy_unit / reduced))
    spheres = [
        Sphere((0.0, 0.0, 0.0), radii[0], densities[0], (speed * masses[1] / sum(masses), 0.0, 0.0)),
        Sphere(
            (sum(radii) - 0.03 * pair.equilibrium_overlap, 0.0, 0.0),
            radii[1],
            densities[1],
            (-speed * masses[0] / sum(masses), 0.0, 0.0),
        ),
    ]
    frame = Simulation(
        spheres,
        Materials(
            1,
            properties(youngsModulus=young, surfaceEnergy=surface_energy, coefficientRestitution=SMALLEST_RESTITUTION),
        ),
        time_step,
        4000,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on",
        every=4000,
    ).run(plugin, tmp_path)
    end = frame[frame["step"] == 4000]
    overlap = sum(radii) - np.ptp(end["x"].to_numpy())
    rounding = OVERLAP_ROUNDINGS * EPSILON * sum(radii)
    figure(
        "distance from the equilibrium overlap beyond its rounding, relative",
        max(abs(overlap - pair.equilibrium_overlap) - rounding, 0.0) / pair.equilibrium_overlap,
        LEFT_AFTER_DAMPING,
    )


def test_neck_is_followed_to_its_rupture_point(plugin, tmp_path, figure):
    """At the tensile end of the neck da/d(delta) diverges: two roots of the quartic meet there, a solver stalls or
    jumps to the wrong branch, and the contact must end within the step that passes the point."""
    radii, young, surface_energy = (1.1e-6, 0.8e-6), 1.9e9, 0.053
    pair = AdhesivePair(effective_modulus(young, POISSON), radii[0] * radii[1] / sum(radii), surface_energy)
    length = -pair.rupture_overlap
    # spheres so heavy that nothing changes their speed: three stretches ever slower
    speed = 0.7
    first, second, third = (length * fraction for fraction in (1e-3, 1e-6, 1e-9))
    stretches = [(first, 990), (second, 20_000), (third, 20_000)]
    lines, travelled = [], 0.0
    for step, steps in stretches:
        lines += [f"timestep {step / speed!r}", f"run {steps}"]
        travelled += step * steps
    start = travelled - 0.5 * third * stretches[2][1] - length  # rupture in the middle of the last stretch
    frame = Simulation(
        [
            Sphere((0.0, 0.0, 0.0), radii[0], 1e30),
            Sphere((sum(radii) - start, 0.0, 0.0), radii[1], 1e30, (speed, 0.0, 0.0)),
        ],
        Materials(1, properties(coefficientRestitution=1.0)),
        1e-12,
        sum(n for _, n in stretches),
        style="model jkr tangential jkr rolling_friction krijt",
        keywords="twisting on eventCorrection off",
        every=10,
        run_lines=lines,
        box=(-5e-5, 5e-5) * 3,
    ).run(plugin, tmp_path)
    x = frame["x"].to_numpy().reshape(-1, 2)
    force = -frame["fx"].to_numpy().reshape(-1, 2)[:, 0]
    overlap = sum(radii) - (x[:, 1] - x[:, 0])
    assert start > 0.0 and overlap.min() < pair.rupture_overlap
    held = force != 0.0
    step_of_dump = 10 * third
    figure(
        "last dumped overlap at which the neck holds, distance from rupture / delta_C",
        abs(overlap[held].min() / pair.rupture_overlap - 1.0),
        1.5 * step_of_dump / length,
    )
    assert not (held & (overlap < pair.rupture_overlap - third)).any()
    # next to rupture the force changes as the root of what is left of the neck: the rounding of the overlap, magnified
    rounding = OVERLAP_ROUNDINGS * EPSILON * sum(radii)
    expected = pair.force(overlap[held])
    spread = np.abs(pair.force(overlap[held] + rounding) - expected)
    assert np.isfinite(force).all()
    figure(
        "error of the force on the way beyond the rounding of the overlap, relative to F_C",
        (np.maximum(np.abs(force[held] - expected) - spread, 0.0) / pair.pull_off_force).max(),
        NEXT_TO_RUPTURE,
    )


@pytest.mark.parametrize("correction", ["on", "off"])
def test_contact_of_the_initial_state_becomes_a_neck_in_the_first_step(plugin, tmp_path, figure, correction):
    """LIGGGHTS computes the forces of the initial state without letting histories change; a contact that overlaps then
    and is stretched beyond delta = 0 by the first step is known from nothing but the positions."""
    radii, pair = (1.1e-6, 0.8e-6), AdhesivePair(effective_modulus(1.9e9, POISSON), 1.1e-6 * 0.8e-6 / 1.9e-6, 0.053)
    speed, step = 0.7, -1e-2 * pair.rupture_overlap
    frame = Simulation(
        [
            Sphere((0.0, 0.0, 0.0), radii[0], 1e30),
            Sphere((sum(radii) - 0.4 * step, 0.0, 0.0), radii[1], 1e30, (speed, 0.0, 0.0)),
        ],
        Materials(1, properties(coefficientRestitution=1.0)),
        step / speed,
        3,
        style="model jkr tangential jkr rolling_friction krijt",
        keywords=f"eventCorrection {correction}",
    ).run(plugin, tmp_path)
    force = -frame["fx"].to_numpy()[::2] / pair.pull_off_force
    # a stretch of 2 % of the neck's length changes the force by less than a hundredth of F_C
    figure(
        "largest distance of the force of the first steps from -8/9 F_C, relative to F_C",
        np.abs(force + 8.0 / 9.0).max(),
        0.02,
    )
