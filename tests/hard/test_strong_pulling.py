"""Strong pulling: loads near the pull-off force of a softened contact."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

YOUNG, POISSON, SURFACE_ENERGY, RADIUS, DENSITY = 2.7e9, 0.31, 0.057, 1.2e-6, 1400.0
MASS = sphere_mass(RADIUS, DENSITY)
STEPS = 60_000
BOX = (-1.1e-5, 1.3e-5, -1.1e-5, 1.3e-5, -1.7e-5, 9e-5)
# The load grows by 1e-6 of itself a step; past the largest one the sphere starts to leave as slowly as a pendulum its
# upper
# dead point, and the load grows meanwhile: measured 1e-3.
LOAD_AT_DETACHMENT = 3e-3


# The load reaches its end as exp(-10), and the overlap there is ten times as sensitive to it as at rest.
LEFT_OF_THE_APPROACH = 1e-3


@pytest.mark.parametrize("ratio", [0.97, 1e-2, 1e-3])
@pytest.mark.parametrize("model, share", [("jkr", 1.0), ("jkr/simplified", 8.0 / 9.0)])
def test_softened_contact_lets_go_at_its_own_pull_off_force(plugin, tmp_path, figure, model, share, ratio):
    """Under prescribed load the full law lets go at F_C of the reduced surface energy, F_C q^(2/5), at a stretched
    neck; the simplified law at delta = 0, at 8/9 of it. At q = 1e-3 that is a sixteenth of the real force: gravity
    or drag may do it."""
    softened = AdhesivePair(effective_modulus(ratio * YOUNG, POISSON), RADIUS, ratio**0.4 * SURFACE_ENERGY)
    expected = share * 3.0 * np.pi * RADIUS * SURFACE_ENERGY * ratio**0.4
    period = 2.0 * np.pi * np.sqrt(MASS / softened.stiffness)
    frame = Simulation(
        [Sphere((0.0, 0.0, RADIUS - softened.equilibrium_overlap), RADIUS, DENSITY)],
        Materials(
            1,
            {
                "youngsModulus": ratio * YOUNG,
                "youngsModulusOriginal": YOUNG,
                "poissonsRatio": POISSON,
                "coefficientRestitution": 0.23,
                "coefficientFriction": 0.41,
                "surfaceEnergy": ratio**0.4 * SURFACE_ENERGY,
                "surfaceEnergyOriginal": SURFACE_ENERGY,
                "adhesionHysteresis": 0.73,
            },
        ),
        float(period / 60.0),
        STEPS,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on",
        walls=["primitive type 1 zplane 0.0"],
        every=10,
        skin=0.9 * RADIUS,
        box=BOX,
        before_run=[
            f"variable load equal {expected!r}*(0.95*(1.0-exp(-step/3000.0))+0.06*step/{STEPS}.0)",
            "fix pull all addforce 0.0 0.0 v_load",
            "thermo_modify lost ignore norm no",
        ],  # it flies off and leaves the box
    ).run(plugin, tmp_path)
    overlap = RADIUS - frame["z"].to_numpy()
    gone = overlap <= (softened.rupture_overlap if model == "jkr" else 0.0)
    assert gone[-1]
    # before it lets go the sphere follows the load slowly; it runs away once the load is passed
    step = frame["step"].to_numpy()
    load = expected * (0.95 * (1.0 - np.exp(-step / 3000.0)) + 0.06 * step / STEPS)
    at = load[np.argmax(gone)]
    figure(
        "load at which the sphere leaves the wall, relative distance from F_C q^(2/5) times 1 or 8/9",
        abs(at / expected - 1.0),
        LOAD_AT_DETACHMENT,
    )
    static = (load < 0.98 * expected) & (step > STEPS // 3)
    figure(
        "error of the contact force under the load, relative to F_C",
        np.abs(softened.force(overlap[static]) + load[static]).max() / softened.pull_off_force,
        LOAD_AT_DETACHMENT,
    )


@pytest.mark.parametrize("model, share", [("jkr", 1.0), ("jkr/simplified", 8.0 / 9.0)])
def test_softened_contact_holds_just_below_its_pull_off_force(plugin, tmp_path, figure, model, share):
    """Half a percent below the last load that it can bear, the stiffness is nearly gone and the sphere swings far and
    slowly: an integrator that loses or makes energy at the neck tears it off."""
    ratio = 1e-2
    softened = AdhesivePair(effective_modulus(ratio * YOUNG, POISSON), RADIUS, ratio**0.4 * SURFACE_ENERGY)
    load = 0.995 * share * softened.pull_off_force
    # the static overlap under that load, by bisection on the rising branch
    low, high = (
        (-(3.0 ** (-2.0 / 3.0)) * abs(softened.rupture_overlap) * 0.99999 if model == "jkr" else 0.0),
        softened.equilibrium_overlap,
    )
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if softened.force(middle) < -load else (low, middle)
    start = (
        max(low, 1e-3 * softened.equilibrium_overlap)
        if model == "jkr/simplified"
        else 1e-3 * softened.equilibrium_overlap
    )
    period = 2.0 * np.pi * np.sqrt(MASS / softened.stiffness)
    steps = 30_000
    frame = Simulation(
        [Sphere((0.0, 0.0, RADIUS - start), RADIUS, DENSITY)],
        Materials(
            1,
            {
                "youngsModulus": ratio * YOUNG,
                "poissonsRatio": POISSON,
                "coefficientRestitution": 0.23,
                "coefficientFriction": 0.41,
                "surfaceEnergy": ratio**0.4 * SURFACE_ENERGY,
                "adhesionHysteresis": 0.73,
            },
        ),
        float(period / 60.0),
        steps,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on",
        walls=["primitive type 1 zplane 0.0"],
        every=100,
        skin=0.9 * RADIUS,
        box=BOX,
        # from 0.9 of the load to all of it, so that the swing into the neck does not carry the sphere past the hump
        before_run=[
            f"variable load equal {load!r}*(0.9+0.1*(1.0-exp(-step/3000.0)))",
            "fix pull all addforce 0.0 0.0 v_load",
        ],
    ).run(plugin, tmp_path)
    overlap = RADIUS - frame["z"].to_numpy()
    figure(
        "distance from the overlap that balances the load / equilibrium overlap",
        abs(overlap[-1] - low) / softened.equilibrium_overlap,
        LEFT_OF_THE_APPROACH,
    )
