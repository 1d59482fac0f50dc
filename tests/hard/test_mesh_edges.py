"""Mesh walls: from one triangle to the next, over an edge, on a corner."""

from __future__ import annotations

import numpy as np
import pytest
from adhesive_pair import AdhesivePair, effective_modulus, sphere_mass
from simulation import Materials, Simulation, Sphere

pytestmark = pytest.mark.liggghts

MODELS = ("jkr", "jkr/simplified")
YOUNG, POISSON, SURFACE_ENERGY = 1.9e9, 0.29, 0.053
RADIUS, DENSITY = 4.3e-6, 1300.0
MASS = sphere_mass(RADIUS, DENSITY)
WALL = AdhesivePair(effective_modulus(YOUNG, POISSON), RADIUS, SURFACE_ENERGY)
PERIOD = float(2 * np.pi * np.sqrt(MASS / WALL.stiffness))
TIME_STEP = PERIOD / 110.0
# LIGGGHTS refuses meshes of less than 1e-4 length units.
BOX = (-1.7e-4, 1.7e-4) * 3
# Within this distance of an edge LIGGGHTS counts a contact on the faces of both its triangles, with any contact
# model. Its default
# of 1e-8 length units is as long as two steps of the spheres here.
PRECISION = 1e-13
# Edges below this angle [degrees] belong to neither triangle; LIGGGHTS' default of 0.256 would drop the contact on an
# edge of 0.2 degrees while its width of 0.0035 radii is passed.
CURVATURE = 1e-3
# A mesh wall computes distances by other arithmetic than a plane: 1e-16 of a coordinate in the overlap.
SAME_AS_A_PLANE = 1e-9


def materials(**changes):
    return Materials(
        2,
        {
            "youngsModulus": YOUNG,
            "poissonsRatio": POISSON,
            "coefficientRestitution": 0.79,
            "coefficientFriction": 0.41,
            "surfaceEnergy": SURFACE_ENERGY,
            "adhesionHysteresis": 0.73,
            **changes,
        },
    )


def stl(triangles) -> str:
    lines = ["solid mesh"]
    for triangle in triangles:
        normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        lines.append("facet normal {:.17g} {:.17g} {:.17g}".format(*(normal / np.linalg.norm(normal))))
        lines += [
            "outer loop",
            *("vertex {:.17g} {:.17g} {:.17g}".format(*corner) for corner in triangle),
            "endloop",
            "endfacet",
        ]
    return "\n".join([*lines, "endsolid mesh"]) + "\n"


def quadrilateral(a, b, c, d):
    a, b, c, d = (np.array(corner, float) for corner in (a, b, c, d))
    return [(a, b, c), (a, c, d)]


def mesh_run(plugin, directory, triangles, sphere, steps, model, keywords="twisting on rollingDamping 0.03", **changes):
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "mesh.stl").write_text(stl(triangles))
    return Simulation(
        [sphere],
        materials(),
        TIME_STEP,
        steps,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=keywords,
        box=BOX,
        skin=1.9e-6,
        walls=["mesh n_meshes 1 meshes mesh"],
        setup=("atom_modify sort 0 0.0", f"fix mesh all mesh/surface file mesh.stl type 2 precision {PRECISION!r} curvature {CURVATURE!r}"),
        **changes,
    ).run(plugin, directory)


HALF = 1.2e-4
FLAT = quadrilateral(
    (-HALF, -0.9 * HALF, 0.0), (HALF, -0.9 * HALF, 0.0), (HALF, 1.1 * HALF, 0.0), (-HALF, 1.1 * HALF, 0.0)
)
VECTORS = (
    ["x", "y", "z"],
    ["vx", "vy", "vz"],
    ["omegax", "omegay", "omegaz"],
    ["fx", "fy", "fz"],
    ["tqx", "tqy", "tqz"],
)


@pytest.mark.parametrize("pull", [0.0, 0.93], ids=["pressed", "hanging by its neck"])
@pytest.mark.parametrize("model", MODELS)
def test_sphere_rolls_from_one_triangle_to_the_next_as_on_a_plane(plugin, tmp_path, figure, model, pull):
    """At the common edge the contact passes to another triangle with another history: the springs would start from
    nothing, both triangles would pull at once, or the contact would count as broken and made again."""
    pull = pull if model == "jkr" else 0.6 * pull
    overlap = WALL.equilibrium_overlap * (1.13 if pull == 0.0 else 0.02 if model == "jkr" else 0.43)
    spin = np.array([3.1e5, 4.7e5, 2.9e5])
    velocity = -np.cross(spin, [0.0, 0.0, -RADIUS])
    # the diagonal from (-HALF, -0.9 HALF) to (HALF, 1.1 HALF) is met after a third of the way
    steps = 2400
    start = np.array([0.31 * HALF, 0.41 * HALF, RADIUS - overlap]) - velocity * TIME_STEP * steps / 3.0
    sphere = Sphere(start, RADIUS, DENSITY, velocity, spin)
    lines = [f"fix pull all addforce 0.0 0.0 {float(pull * WALL.pull_off_force)!r}"]
    mesh = mesh_run(plugin, tmp_path / "mesh", FLAT, sphere, steps, model, before_run=lines)
    plane = Simulation(
        [sphere],
        materials(),
        TIME_STEP,
        steps,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords="twisting on rollingDamping 0.03",
        box=BOX,
        skin=1.9e-6,
        walls=["primitive type 2 zplane 0.0"],
        setup=("atom_modify sort 0 0.0",),
        before_run=lines,
    ).run(plugin, tmp_path / "plane")
    side = (mesh["y"] - 0.1 * HALF) - mesh["x"]
    assert side.iloc[0] * side.iloc[-1] < 0.0, "the sphere did not cross the diagonal"
    necked = mesh["z"].to_numpy()[200:] > RADIUS
    assert necked.all() if pull and model == "jkr" else not necked.any()
    worst = max(
        np.abs(mesh[v].to_numpy() - plane[v].to_numpy()).max() / np.abs(plane[v].to_numpy()).max() for v in VECTORS
    )
    figure(
        "largest difference of position, velocity, spin, force, moment from the run on a primitive plane, relative",
        worst,
        SAME_AS_A_PLANE,
    )


# A step changes the dashpot's and the springs' forces by a hundredth; the finite force of a new contact is 8/9.
CHANGE_IN_A_STEP = 0.05
@pytest.mark.parametrize("angle", [0.35, 0.0035], ids=["20 degrees", "0.2 degrees"])
@pytest.mark.parametrize("first", [0, 2], ids=["from its owner", "to its owner"])
@pytest.mark.parametrize("model", MODELS)
def test_sphere_rolls_over_a_convex_edge_without_a_jump(plugin, tmp_path, figure, model, angle, first):
    """On the edge the normal turns from one plate's to the other's while two triangles, and no more than one contact,
    touch the sphere: counting both adds the adhesion of a second contact, counting neither drops the history."""
    slope = np.array([np.cos(angle), -np.sin(angle)])
    plates = [
        *quadrilateral((-HALF, -HALF, 0.0), (0.0, -HALF, 0.0), (0.0, 0.9 * HALF, 0.0), (-HALF, 0.9 * HALF, 0.0)),
        *quadrilateral(
            (0.0, -HALF, 0.0),
            (HALF * slope[0], -HALF, HALF * slope[1]),
            (HALF * slope[0], 0.9 * HALF, HALF * slope[1]),
            (0.0, 0.9 * HALF, 0.0),
        ),
    ]
    speed, steps = 2.3, 2600
    start = -0.5 * speed * TIME_STEP * steps
    sphere = Sphere(
        (start, 0.13 * HALF, RADIUS - WALL.equilibrium_overlap),
        RADIUS,
        DENSITY,
        (speed, 0.0, 0.0),
        (0.0, speed / RADIUS, 0.0),
    )
    # LIGGGHTS gives an edge to one of its triangles, by their order
    triangles = plates[first:] + plates[:first]
    frame = mesh_run(plugin, tmp_path, triangles, sphere, steps, model, keywords="twisting on")
    x, moment = frame["x"].to_numpy(), frame["tqy"].to_numpy()
    assert x[0] < 0.0 and x[-1] > 0.3 * RADIUS, "the sphere did not get over the edge"
    force = frame[["fx", "fy", "fz"]].to_numpy()
    jump = np.linalg.norm(np.diff(force, axis=0), axis=1).max() / WALL.pull_off_force
    assert (moment[np.abs(x) < 0.1 * RADIUS] != 0.0).all(), "the rolling history was dropped on the edge"
    figure("largest change of the force in a step / F_C", jump, CHANGE_IN_A_STEP)


@pytest.mark.parametrize("corner", ["of a box", "of four triangles", "of an edge"])
@pytest.mark.parametrize("model", MODELS)
def test_sphere_on_a_corner_feels_one_contact(plugin, tmp_path, figure, model, corner):
    """Three plates of two triangles each meet in the corner, all at the same distance: each would give the full force."""
    inward = {
        "of a box": [((1, 0, 0), (0, 1, 0)), ((0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0))],
        "of four triangles": [
            ((1, 0, 0), (0, 1, 0)),
            ((0, 1, 0), (-1, 0, 0)),
            ((-1, 0, 0), (0, -1, 0)),
            ((0, -1, 0), (1, 0, 0)),
        ],
        "of an edge": [((1, 0, 0.2), (0, 1, 0)), ((0, 1, 0), (-1, 0, 0.2))],
    }[corner]
    towards = {
        "of a box": np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0),
        "of four triangles": np.array([0.0, 0.0, 1.0]),
        "of an edge": np.array([0.0, 0.0, 1.0]),
    }[corner]
    triangles = []
    for first, second in inward:
        first, second = np.array(first, float), np.array(second, float)
        if corner == "of a box":
            triangles += quadrilateral((0, 0, 0), HALF * first, HALF * (first + second), HALF * second)
        else:
            triangles.append((np.zeros(3), HALF * first, HALF * second))
    overlap = 2.3 * WALL.equilibrium_overlap
    sphere = Sphere(-towards * (RADIUS - overlap), RADIUS, DENSITY)
    frame = mesh_run(plugin, tmp_path, triangles, sphere, 0, model)
    force = frame[["fx", "fy", "fz"]].to_numpy()[0]
    expected = -towards * float(WALL.force(overlap))
    figure("error of the force, relative", np.linalg.norm(force - expected) / np.linalg.norm(expected), 1e-9)
    rest = mesh_run(
        plugin,
        tmp_path / "rest",
        triangles,
        Sphere(-towards * (RADIUS - WALL.equilibrium_overlap), RADIUS, DENSITY),
        3000,
        model,
        every=3000,
    )
    moved = np.linalg.norm(rest[["x", "y", "z"]].to_numpy()[-1] - rest[["x", "y", "z"]].to_numpy()[0])
    figure("shift of the resting sphere / equilibrium overlap", moved / WALL.equilibrium_overlap, 1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_sphere_in_a_concave_edge_touches_both_walls(plugin, tmp_path, figure, model):
    """What keeps an edge from counting twice must not take one of two walls away: in a groove both faces are nearest."""
    plates = [
        *quadrilateral((-HALF, -HALF, 0.0), (HALF, -HALF, 0.0), (HALF, HALF, 0.0), (-HALF, HALF, 0.0)),
        *quadrilateral((0.0, -HALF, 0.0), (0.0, HALF, 0.0), (0.0, HALF, HALF), (0.0, -HALF, HALF)),
    ]
    overlaps = 0.7 * WALL.equilibrium_overlap, 1.6 * WALL.equilibrium_overlap
    sphere = Sphere((RADIUS - overlaps[0], 0.13 * HALF, RADIUS - overlaps[1]), RADIUS, DENSITY)
    frame = mesh_run(plugin, tmp_path, plates, sphere, 0, model, keywords="")
    expected = np.array([WALL.force(overlaps[0]), 0.0, WALL.force(overlaps[1])])
    error = np.abs(frame[["fx", "fy", "fz"]].to_numpy()[0] - expected).max() / WALL.pull_off_force
    figure("error of the force / F_C", error, SAME_AS_A_PLANE)
