"""Contact lists of the jkr models in real runs: necks are in them, every column and every history value has its name."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from simulation import Materials, Simulation, Sphere

from pyjkr import contact, dump
from pyjkr.contact import PairProperties
from pyjkr.run import Simulator

YOUNG, POISSON, ENERGY = (3.8e9, 5.1e9), (0.33, 0.24), 0.05
# Without damping, so that the lists, which LIGGGHTS computes with the velocities of the full step, hold the very forces
# of the run.
MATERIALS = Materials(
    2,
    {
        "youngsModulus": YOUNG,
        "poissonsRatio": POISSON,
        "coefficientRestitution": 1.0,
        "coefficientFriction": 0.4,
        "surfaceEnergy": ENERGY,
        "adhesionHysteresis": 0.3,
    },
)
RADIUS, PARTNER = 1e-6, 1.7e-6
DENSITY = 1050.0
TIME_STEP, STEPS, EVERY = 2e-11, 300, 20
# Sums of the same doubles in another order, of positions 1e4 times an overlap.
ROUND_OFF = 1e-9

KEYWORDS = ("pos", "id", "force", "torque", "history", "contactArea", "delta")
STYLE = "model jkr tangential jkr rolling_friction krijt"
HISTORY = dump.jkr_history("jkr", "jkr", "krijt", twisting=True)

# Wide, because LIGGGHTS refuses meshes that span less than 1e-4 length units.
FLOOR = """\
solid floor
facet normal 0 0 1
outer loop
vertex -2e-4 -1e-4 0
vertex 2e-4 -1e-4 0
vertex 2e-4 3e-4 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -2e-4 -1e-4 0
vertex 2e-4 3e-4 0
vertex -2e-4 3e-4 0
endloop
endfacet
endsolid floor
"""


def pair_with(radius: float) -> PairProperties:
    """Effective properties; the masses do not matter here."""
    return PairProperties(
        effective_radius=radius,
        effective_mass=2e-15,
        effective_inertia=3e-28,
        effective_modulus=contact.effective_modulus(YOUNG, POISSON),
        effective_shear_modulus=contact.effective_shear_modulus(YOUNG, POISSON),
        surface_energy=ENERGY,
        surface_energy_of_rolling=ENERGY,
        restitution_coefficient=0.9,
    )


def with_list(compute: str, columns: int) -> tuple[str, ...]:
    numbered = [f"c_list[{number}]" for number in range(1, columns + 1)]
    return (
        f"compute list all {compute} {' '.join(KEYWORDS)}",
        f"dump list all local {EVERY} list.txt {' '.join(numbered)}",
        f'dump_modify list format "{" ".join(["%.17g"] * columns)}"',
    )


def columns(table: dict[str, tuple[str, ...]]) -> int:
    return sum(len(table[keyword]) for keyword in KEYWORDS) + len(HISTORY)


@pytest.fixture(scope="module")
def pair_lists(plugin: Simulator, tmp_path_factory: pytest.TempPathFactory) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Two spheres that touch, twist and roll while they are drawn apart: list and trajectory, by step."""
    directory = tmp_path_factory.mktemp("pair")
    simulation = Simulation(
        [
            Sphere((0, 0, 0), RADIUS, DENSITY, velocity=(0.004, 0.01, 0.05), spin=(1e3, 2e3, 3e3), type=1),
            Sphere((0, 0, RADIUS + PARTNER - 1e-10), PARTNER, DENSITY, velocity=(0, 0, 0.25), type=2),
        ],
        MATERIALS,
        TIME_STEP,
        STEPS,
        style=STYLE,
        keywords="twisting on",
        every=EVERY,
        before_run=with_list("pair/gran/local", columns(dump.PAIR_COLUMNS)),
    )
    trajectory = simulation.run(plugin, directory)
    return dump.read_contacts(directory / "list.txt", KEYWORDS, history_names=HISTORY), trajectory


@pytest.fixture(scope="module")
def wall_lists(plugin: Simulator, tmp_path_factory: pytest.TempPathFactory) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A sphere that touches a mesh, twists and rolls while it is drawn away: list and trajectory, by step."""
    directory = tmp_path_factory.mktemp("wall")
    (directory / "floor.stl").write_text(FLOOR)
    height = RADIUS - 1e-10
    simulation = Simulation(
        [Sphere((3e-6, -2e-6, height), RADIUS, DENSITY, velocity=(0.004, 0.01, 0.3), spin=(1e3, 2e3, 3e3), type=1)],
        MATERIALS,
        TIME_STEP,
        STEPS,
        style=STYLE,
        keywords="twisting on",
        setup=("fix floor all mesh/surface file floor.stl type 2",),
        walls=("mesh n_meshes 1 meshes floor",),
        box=(-2.1e-4, 2.1e-4, -1.1e-4, 3.1e-4, -1e-6, 1e-5),
        every=EVERY,
        before_run=with_list("wall/gran/local", columns(dump.WALL_COLUMNS)),
    )
    trajectory = simulation.run(plugin, directory)
    return dump.read_contacts(directory / "list.txt", KEYWORDS, history_names=HISTORY, wall=True), trajectory


def vectors(frame: pd.DataFrame, *names: str) -> np.ndarray:
    return frame[list(names)].to_numpy()


def xyz(frame: pd.DataFrame, name: str) -> np.ndarray:
    return vectors(frame, *(f"{name}_{axis}" for axis in "xyz"))


def assert_necks(contacts: pd.DataFrame, overlap: np.ndarray, rupture: float) -> None:
    np.testing.assert_allclose(contacts["overlap"], overlap, rtol=0, atol=ROUND_OFF * RADIUS)
    assert (contacts["overlap"] < 0).sum() > 5
    assert contacts["overlap"].min() > rupture
    # LIGGGHTS' lens is none.
    assert (contacts["contact_area"][contacts["overlap"] < 0] < 0).all()


@pytest.mark.liggghts
def test_a_neck_is_listed_with_its_negative_overlap_and_no_lens(pair_lists):
    contacts, spheres = pair_lists
    first, second = (spheres[spheres["id"] == number] for number in (1, 2))
    assert contacts["step"].tolist() == list(range(0, STEPS + 1, EVERY))
    assert (contacts["id1"] + contacts["id2"] == 3).all()
    distance = np.linalg.norm(vectors(first, *"xyz") - vectors(second, *"xyz"), axis=1)
    radius = 1 / (1 / RADIUS + 1 / PARTNER)
    assert_necks(contacts, RADIUS + PARTNER - distance, contact.rupture_overlap(pair_with(radius), "jkr"))


@pytest.mark.liggghts
def test_a_neck_at_a_mesh_wall_is_listed_with_its_negative_overlap(wall_lists):
    contacts, spheres = wall_lists
    assert contacts["step"].tolist() == list(range(0, STEPS + 1, EVERY))
    assert (contacts["id"] == 1).all()
    rupture = contact.rupture_overlap(pair_with(RADIUS), "jkr")
    assert_necks(contacts, RADIUS - spheres["z"].to_numpy(), rupture)


@pytest.mark.liggghts
@pytest.mark.parametrize("lists", ["pair_lists", "wall_lists"])
def test_listed_forces_and_torques_are_those_of_the_run(request, lists):
    contacts, spheres = request.getfixturevalue(lists)
    number = "id1" if lists == "pair_lists" else "id"
    own = spheres.set_index(["step", "id"]).loc[list(zip(contacts["step"], contacts[number], strict=True))]
    # The first snapshot is taken before any step.
    run = contacts["step"].to_numpy() > 0
    for name, columns_of_atom in (("force", ("fx", "fy", "fz")), ("torque", ("tqx", "tqy", "tqz"))):
        listed, whole = xyz(contacts, name)[run], vectors(own, *columns_of_atom)[run]
        np.testing.assert_allclose(listed, whole, rtol=0, atol=ROUND_OFF * np.abs(whole).max())


@pytest.mark.liggghts
@pytest.mark.parametrize("lists", ["pair_lists", "wall_lists"])
def test_the_radius_of_the_contact_gives_the_normal_force_back(request, lists):
    contacts, _ = request.getfixturevalue(lists)
    radius = RADIUS if lists == "wall_lists" else 1 / (1 / RADIUS + 1 / PARTNER)
    pair = pair_with(radius)
    a = contact.contact_radius(contacts["overlap"], pair)
    # Haervig 2017, eqs 8 and 9: 4 E a^3/(3 R) - 4 sqrt(pi gamma E a^3).
    modulus = pair.effective_modulus
    elastic = 4 * modulus * a**3 / (3 * radius) - 4 * np.sqrt(np.pi * ENERGY * modulus * a**3)
    normal = np.tile([0.0, 0.0, 1.0], (len(contacts), 1))
    if lists == "pair_lists":
        apart = vectors(contacts, "x1", "y1", "z1") - vectors(contacts, "x2", "y2", "z2")
        normal = apart / np.linalg.norm(apart, axis=1)[:, None]
    listed = (xyz(contacts, "force") * normal).sum(axis=1)
    run = contacts["step"].to_numpy() > 0
    # Overlaps are differences of positions 1e4 times as large.
    np.testing.assert_allclose(listed[run], elastic[run], rtol=0, atol=1e-8 * pair.pull_off_force)


@pytest.mark.liggghts
@pytest.mark.parametrize("lists", ["pair_lists", "wall_lists"])
def test_history_values_bear_the_names_of_what_they_hold(request, lists):
    contacts, spheres = request.getfixturevalue(lists)
    run = contacts[contacts["step"] > 0]
    last = run.iloc[-1]
    assert (run["in_contact"] == 1).all()
    # In the plane of contact, and along the slip: u = v + r omega x (-z) for the sphere below, mirrored at the wall.
    for name in ("sliding_displacement", "rolling_displacement"):
        lateral = np.linalg.norm(xyz(run, name)[:, :2], axis=1)
        assert (np.abs(xyz(run, name)[:, 2]) < 1e-3 * lateral).all()
    sign = 1 if lists == "wall_lists" or last["id1"] == 1 else -1
    first = run.iloc[0]
    assert sign * first["sliding_displacement_y"] > 0
    # Twist about the normal from i to j: up from the sphere below, down to the wall; its spin is 3000 rad/s.
    twist = run["twisting_angle"].to_numpy() / (run["step"].to_numpy() * TIME_STEP)
    assert twist[0] == pytest.approx(-3e3 if lists == "wall_lists" else 3e3, rel=0.05)
    # Half-step speed of separation, as the step after will find it.
    speed = spheres[spheres["id"] == 1].set_index("step")["vz"]
    if lists == "pair_lists":
        speed = spheres[spheres["id"] == 2].set_index("step")["vz"] - speed
    np.testing.assert_allclose(run["carried_speed"], speed.loc[run["step"]], atol=0.01)


# Every style and keyword once or more, with one normal model or the other.
COMBINATIONS = [
    ("jkr", "off", "off", {"event_correction": True}),
    ("jkr", "no_history", "krijt", {"event_correction": False}),
    ("jkr", "history", "epsd2", {"event_correction": False}),
    ("jkr", "jkr", "krijt", {"event_correction": True, "twisting": True}),
    ("jkr/simplified", "off", "epsd2", {"event_correction": False}),
    ("jkr/simplified", "history", "krijt", {"event_correction": True, "twisting": True}),
    ("jkr/simplified", "jkr", "off", {"event_correction": False}),
    ("jkr/simplified", "jkr", "krijt", {"event_correction": False, "twisting": True}),
]


@pytest.mark.liggghts
@pytest.mark.parametrize(("normal", "tangential", "rolling", "keywords"), COMBINATIONS)
def test_a_contact_keeps_as_many_values_as_have_names(plugin, tmp_path, normal, tangential, rolling, keywords):
    names = dump.jkr_history(normal, tangential, rolling, **keywords)
    words = {"event_correction": "eventCorrection", "twisting": "twisting"}

    def simulation(values: int) -> Simulation:
        return Simulation(
            [Sphere((0, 0, 0), RADIUS, DENSITY, type=1), Sphere((0, 0, RADIUS + PARTNER - 1e-10), PARTNER, DENSITY, type=2)],
            Materials(2, MATERIALS.properties | {"coefficientRollingFriction": 0.1}),
            TIME_STEP,
            1,
            style=f"model {normal} tangential {tangential} rolling_friction {rolling}",
            keywords=" ".join(f"{words[key]} {'on' if value else 'off'}" for key, value in keywords.items()),
            before_run=(
                "compute list all pair/gran/local history",
                "dump list all local 1 list.txt " + " ".join(f"c_list[{number}]" for number in range(1, values + 1)),
            ),
        )

    simulation(len(names)).run(plugin, tmp_path)
    assert len(dump.read_contacts(tmp_path / "list.txt", ("history",), history_names=names)) == 2
    assert "out-of-range" in simulation(len(names) + 1).refused(plugin, tmp_path / "more")
