"""The time step against measured accuracy, frequencies of whole clusters from their stiffness matrix, and the real LIGGGHTS."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_situations import DENSITY, PAIR, SINGLE, at_angle, bed, meeting, situation
from simulation import Materials, Simulation, Sphere

from pyjkr import contact as contact_laws
from pyjkr import timestep
from pyjkr.planning import steps
from pyjkr.planning.budget import STEP_SHARE
from pyjkr.planning.effects import decide

PAGE = Path(__file__).parents[2] / "docs" / "accuracy-and-cost.md"
MAX_ERROR = 0.05


def chosen(scene, max_error=MAX_ERROR, ratio=1.0):
    return steps.choose(scene, decide(scene, max_error), ratio, max_error)


def rows_of(title: str) -> list[list[str]]:
    """Cells of a table of the measured page."""
    text = PAGE.read_text(encoding="utf-8").split(title, 1)[1].split("\n\n")[1]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


def test_errors_of_normal_impacts_are_those_of_the_measured_page():
    head, _, *rows = rows_of("**Largest error in e_eff^2 by time steps per collision")
    for number, error in steps.NORMAL_ERROR.items():
        measured = max(float(row[head.index(str(number))]) for row in rows if row[2] == "on")
        assert measured == pytest.approx(error, rel=0.5)


def test_errors_of_oblique_impacts_are_those_of_the_measured_page():
    head, _, *rows = rows_of("**Reduced stiffness, oblique impact")
    for number, error in steps.OBLIQUE_ERROR.items():
        measured = max(float(row[head.index(f"error, {number} steps")]) for row in rows)
        assert measured == pytest.approx(error, rel=0.5)


@settings(max_examples=40, deadline=None)
@given(max_error=st.floats(1e-4, 0.3), degrees=st.sampled_from([0, 45]), energy=st.sampled_from([0.0, 0.05]))
def test_steps_per_collision_keep_the_error_and_no_more(max_error, degrees, energy):
    scene = situation(at_angle(SINGLE, 8.0, degrees, energy=energy))
    found = decide(scene, max_error)
    number = steps.per_collision(scene, found, max_error)
    assert steps.error(scene, found, number) <= STEP_SHARE * max_error
    assert number == steps.FEWEST_STEPS or steps.error(scene, found, number - 1) > STEP_SHARE * max_error
    made = chosen(scene, max_error)
    assert made.steps_per_collision >= number * (1 - 1e-9)


def test_twenty_steps_are_enough_for_five_per_cent_and_sixty_for_a_thousandth():
    assert steps.per_collision(situation(), decide(situation(), MAX_ERROR), MAX_ERROR) == 20
    assert 55 <= steps.per_collision(situation(), decide(situation(), 1.2e-3), 1.2e-3) <= 60


def test_error_of_light_damping_without_neck_asks_for_more_steps():
    scene = situation(meeting(speed=3.0, restitution=0.99), wishes={"neck": "off"})
    assert steps.per_collision(scene, decide(scene, MAX_ERROR), MAX_ERROR) > 60
    scene = situation(meeting(speed=3.0, restitution=0.99), wishes={"neck": "on"})
    assert steps.per_collision(scene, decide(scene, MAX_ERROR), MAX_ERROR) == 20


def test_step_is_the_smallest_of_all_meetings_and_names_its_mode():
    small, large = meeting(SINGLE, speed=5.0), meeting((5e-6,), speed=9.0)
    made = chosen(situation(small, large))
    assert made.limiting.name == "collision"
    exact = timestep.collision_time(small.pair, 5.0) / 20
    assert made.value <= exact < made.value * 1.01
    assert {mode.name for mode in made.modes} >= {"collision", "normal", "flight", "Rayleigh", "equilibrium overlap"}
    assert made.value <= min(mode.limit for mode in made.modes if mode.binds)


def test_modes_that_are_off_have_no_limit():
    names = {mode.name for mode in chosen(situation()).modes}
    assert not names & {"sliding", "rolling", "twisting"}
    assert names | {"sliding", "rolling", "twisting"} == {mode.name for mode in chosen(bed()).modes}


def test_steps_grow_with_softening_like_the_collision():
    scene = situation(at_angle(PAIR, 8.0, 45))
    real, soft = chosen(scene), chosen(scene, ratio=0.01)
    assert soft.value / real.value == pytest.approx(0.01**-0.4, rel=0.02)


def test_fast_flight_is_bound_by_the_skin():
    # Grazing: the collision is slow, the way along the wall long.
    scene = situation(meeting(SINGLE, speed=0.01, tangential=2000.0))
    assert chosen(scene).limiting.name == "flight"


# --- among neighbours: highest frequency of the whole cluster from its stiffness matrix ----------------------------------


def highest_frequency(positions, radius, mass, normal, tangential) -> float:
    """omega [rad/s] of equal spheres that touch, springs of `normal` and `tangential` stiffness [N/m] at every contact."""
    count, inertia = len(positions), 0.4 * mass * radius**2
    stiffness = np.zeros((6 * count, 6 * count))
    for i in range(count):
        for j in range(i + 1, count):
            way = positions[j] - positions[i]
            if np.linalg.norm(way) > 2.001 * radius:
                continue
            n = way / np.linalg.norm(way)
            cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
            # Slip of i past j: u_i - u_j + r (w_i + w_j) x n; w x n = -cross w.
            slip = np.zeros((3, 6 * count))
            slip[:, 6 * i : 6 * i + 3], slip[:, 6 * j : 6 * j + 3] = np.eye(3), -np.eye(3)
            slip[:, 6 * i + 3 : 6 * i + 6] = slip[:, 6 * j + 3 : 6 * j + 6] = -radius * cross
            along, across = np.outer(n, n), np.eye(3) - np.outer(n, n)
            stiffness += slip.T @ (normal * along + tangential * across) @ slip
    masses = np.tile([mass] * 3 + [inertia] * 3, count)
    return math.sqrt(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(masses, masses))).max())


def cluster(kind: str, radius: float) -> np.ndarray:
    if kind == "chain":
        return 2 * radius * np.array([[i, 0.0, 0.0] for i in range(12)])
    steps_of = range(-2, 3)
    grid = np.array([[i, j, k] for i in steps_of for j in steps_of for k in steps_of], dtype=float)
    if kind == "cubic":
        return 2 * radius * grid
    return math.sqrt(2) * radius * grid[grid.sum(axis=1) % 2 == 0]


@pytest.mark.parametrize(("kind", "contacts"), [("chain", 2.0), ("cubic", 6.0), ("face-centred", 12.0)])
def test_step_is_stable_in_clusters(kind, contacts):
    at = meeting(PAIR, speed=3.0, tangential=3.0, restitution=0.999999)
    scene = bed(at, contacts_per_particle=contacts)
    made = chosen(scene, max_error=0.5)
    pair = at.pair
    radius = contact_laws.maximum_contact_radius(pair, at.speed)
    # Twice the frequency squared of the pair's mode is its stiffness over the effective mass.
    normal = (2 * math.pi / timestep.normal_period(pair, radius)) ** 2 * pair.effective_mass
    tangential = 8 * pair.effective_shear_modulus * radius
    mass = 2 * pair.effective_mass
    positions = cluster(kind, at.radii[0])
    modes = {mode.name: mode for mode in made.modes}
    # Velocity Verlet follows dt omega < 2; the plan keeps to a half of it where springs are of one kind.
    assert modes["normal"].limit * highest_frequency(positions, at.radii[0], mass, normal, 0.0) <= 1.0 + 1e-6
    assert modes["sliding"].limit * highest_frequency(positions, at.radii[0], mass, 0.0, tangential) <= 2.0
    assert made.value * highest_frequency(positions, at.radii[0], mass, normal, tangential) < 2.0


# --- in LIGGGHTS ---------------------------------------------------------------------------------------------------------


@pytest.mark.liggghts
@pytest.mark.parametrize("restitution", [0.5, 0.86])
@pytest.mark.parametrize("number", [20, 100])
def test_stock_hertz_is_as_accurate_as_the_plan_says(plugin, tmp_path, restitution, number):
    radius, speed, phases = 1e-6, 2.0, 7
    at = meeting(SINGLE, speed=speed, energy=0.0, restitution=restitution)
    made = steps.error(situation(at), decide(situation(at), MAX_ERROR), number)
    step = timestep.collision_time(at.pair, speed) / number
    starts = [(5 + (k + 0.5) / phases) * step * speed for k in range(phases)]
    spheres = [Sphere((4e-6 * k, 0.0, radius + start), radius, DENSITY, velocity=(0.0, 0.0, -speed)) for k, start in enumerate(starts)]
    # A wall of the same material: 1/E = 2 (1 - nu^2)/E_i.
    youngs = contact_laws.particle_modulus(at.pair.effective_modulus, 0.3)
    properties = dict(youngsModulus=youngs, poissonsRatio=0.3, coefficientRestitution=restitution)
    simulated = Simulation(
        spheres, Materials(1, properties), time_step=step, steps=3 * number, style="model hertz",
        walls=["primitive type 1 zplane 0.0"], every=3 * number,
    )  # fmt: skip
    frame = simulated.run(plugin, tmp_path)
    last = frame[frame["step"] == frame["step"].max()]
    errors = np.abs((last["vz"].to_numpy() / speed) ** 2 - restitution**2)
    assert len(errors) == phases
    assert errors.max() <= made
    assert errors.max() > made / 8
