"""Contacts handed over: across MPI and periodic boundaries, rebuilds of the neighbour lists, restarts."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere

from pyjkr import dump, run

pytestmark = pytest.mark.liggghts

YOUNG, POISSON, SURFACE_ENERGY = 2.3e8, 0.31, 0.061
MATERIALS = Materials(
    2,
    {
        "youngsModulus": YOUNG,
        "poissonsRatio": POISSON,
        "coefficientRestitution": 0.67,
        "coefficientFriction": 0.43,
        "surfaceEnergy": SURFACE_ENERGY,
        "adhesionHysteresis": 0.81,
    },
)
RADII, DENSITIES = (1.3e-6, 1.1e-6), (1100.0, 1250.0)
MASSES = [sphere_mass(radius, density) for radius, density in zip(RADII, DENSITIES, strict=True)]
PAIR = AdhesivePair(effective_modulus(YOUNG, POISSON), RADII[0] * RADII[1] / sum(RADII), SURFACE_ENERGY)
TIME_STEP = 1.3e-9
STEPS, EVERY = 2200, 4  # two and a half turns of the pair
HALF_BOX = 2.1e-5
BOX = (-HALF_BOX, HALF_BOX) * 3
WIDE_SKIN = 4e-6  # one list lasts about half a turn
NARROW_SKIN = 1.1e-9  # a new list every one or two steps
# Rolling, twisting and sliding all move the contact while the pair turns.
EXTRA_SPINS = np.array([[4e5, -9e5, 7e5], [-6e5, 3e5, -8e5]])
KEYWORDS = "twisting on rollingDamping 0.03"

# Pair and list order decide only which partner is called i, and the arithmetic is exactly antisymmetric.
SAME_TO_THE_LAST_BIT = 0.0
# Positions are stored in the box: a shift by its length rounds them to 2e-21 m, 2e-12 of the overlap, and the neck's
# stiffness and the two turns make of it what they make of any disturbance of that size.
SAME_AFTER_ROUNDING_OF_THE_SHIFT = 1e-9
# A restart file holds every number in binary, but spheres may come back in another order.
SAME_AFTER_RESTART = 0.0


def turning_pair(model: str, **changes) -> Simulation:
    """A pair that turns fast enough for the centrifugal force to hold its neck stretched, overlap < 0 (model jkr)."""
    load = {"jkr": 0.93, "jkr/simplified": 0.61}[model] * PAIR.pull_off_force
    start = {"jkr": 0.02, "jkr/simplified": 0.43}[model] * PAIR.equilibrium_overlap
    distance = sum(RADII) - start
    reduced = MASSES[0] * MASSES[1] / sum(MASSES)
    spin = np.sqrt(load / (reduced * distance)) * np.array([0.0, 0.0, 1.0])
    axis = np.array([0.96, 0.28, 0.0])
    places = (-MASSES[1] / sum(MASSES) * distance * axis, MASSES[0] / sum(MASSES) * distance * axis)
    spheres = [
        Sphere(places[k], RADII[k], DENSITIES[k], np.cross(spin, places[k]), spin + EXTRA_SPINS[k], k + 1)
        for k in range(2)
    ]
    simulation = Simulation(
        spheres,
        MATERIALS,
        TIME_STEP,
        STEPS,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=KEYWORDS,
        every=EVERY,
        box=BOX,
        skin=WIDE_SKIN,
    )
    return dataclasses.replace(simulation, **changes)


def vectors(frame):
    """Arrays of snapshot, sphere, component."""
    spheres = frame["id"].nunique()
    names = {
        "position": "x y z",
        "velocity": "vx vy vz",
        "spin": "omegax omegay omegaz",
        "force": "fx fy fz",
        "moment": "tqx tqy tqz",
    }
    return {what: frame[columns.split()].to_numpy().reshape(-1, spheres, 3) for what, columns in names.items()}


def difference(seen, undisturbed, period=np.inf):
    """Largest difference of any vector, relative to the largest of its kind; positions modulo `period` along x."""
    worst = 0.0
    for what, reference in undisturbed.items():
        change = seen[what] - reference
        if what == "position" and np.isfinite(period):
            change[..., 0] -= np.round(change[..., 0] / period) * period
        worst = max(worst, np.abs(change).max() / np.abs(reference).max())
    return worst


def overlap(seen):
    return sum(RADII) - np.linalg.norm(seen["position"][:, 1] - seen["position"][:, 0], axis=1)


MODELS = ("jkr", "jkr/simplified")


@pytest.fixture(scope="module")
def undisturbed(plugin, tmp_path_factory):
    runs = {model: vectors(turning_pair(model).run(plugin, tmp_path_factory.mktemp("undisturbed"))) for model in MODELS}
    necked = overlap(runs["jkr"])[5:]
    assert (necked < 0.0).all() and (necked > PAIR.rupture_overlap).all(), (
        "the full law's pair is meant to hang by its neck"
    )
    assert (overlap(runs["jkr/simplified"]) > 0.0).all()
    return runs


# Boundaries between ranks: one at x = 0; two at x = 0 and beyond.
RANK_BOXES = {2: BOX, 3: (-HALF_BOX, 2 * HALF_BOX, *BOX[2:])}


@pytest.mark.parametrize("skin", [WIDE_SKIN, NARROW_SKIN], ids=["wide skin", "narrow skin"])
@pytest.mark.parametrize("ranks", RANK_BOXES)
@pytest.mark.parametrize("model", MODELS)
def test_turning_pair_is_handed_across_an_mpi_boundary(plugin, tmp_path, undisturbed, figure, model, ranks, skin):
    """The history of a neck that overlaps nothing must travel with its spheres, and both ranks that see the pair must
    reach the same force from histories of opposite sign."""
    decked = turning_pair(model, box=RANK_BOXES[ranks], skin=skin, boundary=f"f f f\nprocessors {ranks} 1 1")
    frame = decked.run(plugin, tmp_path, ranks)
    assert f"{ranks} by 1 by 1 MPI processor grid" in (tmp_path / "log.liggghts").read_text()
    right = frame["x"].to_numpy().reshape(-1, 2) > 0.0
    assert right.any(axis=0).all() and not right.all(axis=0).any(), "nothing was handed over"
    figure(
        "largest difference from the run on one rank, relative",
        difference(vectors(frame), undisturbed[model]),
        SAME_TO_THE_LAST_BIT,
    )


@pytest.mark.parametrize("model", MODELS)
def test_turning_pair_outlives_rebuilds_of_the_neighbour_lists(plugin, tmp_path, undisturbed, figure, model):
    """A list built while the surfaces are apart keeps a neck only if the search reaches beyond contact and the contact
    is still flagged; here a new one is built every one or two steps."""
    seen = vectors(turning_pair(model, skin=NARROW_SKIN).run(plugin, tmp_path))
    builds = [
        line for line in (tmp_path / "log.liggghts").read_text().splitlines() if line.startswith("Neighbor list builds")
    ]
    assert int(builds[0].split("=")[1]) > STEPS // 4
    figure(
        "largest difference from the run with hardly a rebuild, relative",
        difference(seen, undisturbed[model]),
        SAME_TO_THE_LAST_BIT,
    )


@pytest.mark.parametrize(
    "ranks, skin",
    [(1, 0.4e-6), (1, NARROW_SKIN), (2, NARROW_SKIN), (3, NARROW_SKIN)],
    ids=["skin of a third radius", "narrow skin", "narrow skin 2 ranks", "narrow skin 3 ranks"],
)
@pytest.mark.parametrize("model", MODELS)
def test_turning_pair_is_handed_across_a_periodic_boundary(plugin, tmp_path, undisturbed, figure, model, ranks, skin):
    """The partner of a neck is now the sphere, now its image; a sphere that crosses changes the sign of no history."""
    pair = turning_pair(model)
    inside = [
        dataclasses.replace(
            sphere, position=sphere.position - np.array([HALF_BOX if sphere.position[0] > 0.0 else 0.0, 0.0, 0.0])
        )
        for sphere in pair.spheres
    ]
    decked = turning_pair(
        model, spheres=inside, box=(-HALF_BOX, 0.0, *BOX[2:]), skin=skin, boundary=f"p f f\nprocessors {ranks} 1 1"
    )
    frame = decked.run(plugin, tmp_path, ranks)
    assert (np.abs(np.diff(frame["x"].to_numpy().reshape(-1, 2), axis=0)) > 0.5 * HALF_BOX).any(axis=0).all(), (
        "not every sphere crossed"
    )
    figure(
        "largest difference from the run away from boundaries, relative",
        difference(vectors(frame), undisturbed[model], HALF_BOX),
        SAME_AFTER_ROUNDING_OF_THE_SHIFT,
    )


# --- restarts
# -----------------------------------------------------------------------------------------------------------

PLATE = """\
solid plate
facet normal 0 0 1
outer loop
vertex -0.00011 -0.00013 0
vertex 0.00012 -0.00013 0
vertex 0.00012 0.00014 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -0.00011 -0.00013 0
vertex 0.00012 0.00014 0
vertex -0.00011 0.00014 0
endloop
endfacet
endsolid plate
"""
WALL = AdhesivePair(effective_modulus(YOUNG, POISSON), RADII[0], SURFACE_ENERGY)


def hanging_sphere(model: str, wall: str) -> Simulation:
    """A sphere that hangs from a wall by its neck (model jkr) and rolls along it."""
    load = {"jkr": 0.93, "jkr/simplified": 0.61}[model] * WALL.pull_off_force
    overlap = {"jkr": 0.02, "jkr/simplified": 0.43}[model] * WALL.equilibrium_overlap
    spin = np.array([2.3e5, -4.1e5, 3.7e5])
    velocity = -np.cross(spin, [0.0, 0.0, -RADII[0]])  # pure rolling
    words, setup = {
        "plane": ("primitive type 2 zplane 0.0", ()),
        "mesh": (
            "mesh n_meshes 1 meshes plate",
            ("atom_modify sort 0 0.0", "fix plate all mesh/surface file plate.stl type 2"),
        ),
    }[wall]
    return Simulation(
        [Sphere((0.3e-6, -0.2e-6, RADII[0] - overlap), RADII[0], DENSITIES[0], velocity, spin)],
        MATERIALS,
        TIME_STEP,
        STEPS,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=KEYWORDS,
        every=EVERY,
        skin=0.7e-6,
        box=(-1.6e-4, 1.6e-4, -1.6e-4, 1.6e-4, *BOX[4:]) if wall == "mesh" else BOX,
        walls=[words],
        setup=setup,
        before_run=[f"fix pull all addforce 0.0 0.0 {load!r}"],
    )


def restarted(simulation: Simulation, steps: int) -> str:
    """The deck of a simulation that goes on from state.restart."""
    lines = []
    for line in simulation.deck().splitlines():
        words = line.split()
        if line.startswith("region box"):
            line = "read_restart state.restart"
        elif words[0] in ("create_box", "create_atoms", "group", "set", "velocity", "write_restart") or line.startswith(
            "atom_modify map"
        ):
            continue
        elif words[0] == "run":
            line = f"run {steps}"
        lines.append(line)
    deck = []
    for line, repeats in itertools.groupby(lines):  # the run that was before the pause
        deck += [line] if line.startswith("run ") else repeats
    return "\n".join(deck) + "\n"


@pytest.mark.parametrize("scene", ["pair", "plane", "mesh"])
@pytest.mark.parametrize("model", MODELS)
def test_necked_and_rolling_contact_goes_on_after_a_restart(plugin, tmp_path, figure, model, scene):
    """The history of a neck between spheres that do not overlap is written only if it is still a contact to the
    simulator; without it the neck is gone, and the springs of rolling, sliding and twisting with it."""
    pause = 800
    simulation = turning_pair(model) if scene == "pair" else hanging_sphere(model, scene)
    paused = dataclasses.replace(
        simulation, run_lines=[f"run {pause}", "write_restart state.restart", f"run {STEPS - pause}"]
    )
    directories = [tmp_path / "paused", tmp_path / "restarted"]
    for directory in directories:
        directory.mkdir()
        (directory / "plate.stl").write_text(PLATE)
    reference = paused.run(plugin, directories[0])
    (directories[1] / "state.restart").write_bytes((directories[0] / "state.restart").read_bytes())
    (directories[1] / "in.deck").write_text(restarted(paused, STEPS - pause))
    run.run_deck(directories[1] / "in.deck", progress=False, simulator=plugin)
    seen = vectors(dump.read(directories[1] / "trajectory.txt"))
    # the dumped force of the pause itself is that of the step before here, of the set-up (full-step velocities) there
    seen = {what: values[1:] for what, values in seen.items()}
    reference = vectors(reference[reference["step"] > pause])
    gap = (overlap(reference) if scene == "pair" else RADII[0] - np.abs(reference["position"][:, 0, 2])) * -1.0
    assert (gap > 0.0).all() if model == "jkr" else (gap < 0.0).all()
    assert np.abs(reference["moment"]).max() > 0.0
    figure(
        "largest difference from the run that only paused, relative", difference(seen, reference), SAME_AFTER_RESTART
    )
