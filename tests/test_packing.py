"""Packings: what is packed, where it starts, and how a bed is measured, against crystals, chains and printed numbers."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from pyjkr import timestep
from pyjkr.errors import DumpError, PlanError
from pyjkr.packing import deck
from pyjkr.packing.bed import Bed, read_bed, voronoi_volumes
from pyjkr.packing.column import CLEARANCE, LOWEST, column
from pyjkr.packing.scene import PackingScene, series

# freud computes cells in single precision.
SINGLE_PRECISION = 2e-6
# Sums and roots of doubles.
ROUND_OFF = 1e-12


def scene(name: str = "S", **changed) -> PackingScene:
    line = series(name)
    values = dict(
        adhesion_number=3.0, modulus_ratio=line.modulus_ratio, scaled=line.scaled, originals=line.originals, particles=120, seed=4,
        speed=5.0, density=1050.0, youngs_modulus=3.8e9, poissons_ratio=0.33, surface_energy=0.05, restitution_coefficient=0.7,
        friction_coefficient=0.3, critical_rolling_angle=0.0085, rolling_damping=0.3, box_in_radii=10.0, inlet_fraction=0.04,
        steps_per_collision=20, rest_fraction=1e-5, settling_time=100.0,
    )  # fmt: skip
    return PackingScene(**{**values, **changed})


# Chen 2019, table 1, as printed.
@pytest.mark.parametrize(
    ("name", "printed"),
    [("S", 0.05), ("A-2", 0.05), ("B-1", 0.0293), ("B-2", 0.0222), ("B-3", 0.0117), ("C-1", 0.0293), ("C-3", 0.0117)],
)
def test_surface_energies_are_those_of_table_1(name, printed):
    assert scene(name).surface_energy_mod == pytest.approx(printed, abs=0.5e-4)


# Chen 2019, sec. 4.3, as printed.
@pytest.mark.parametrize(("name", "printed"), [("C-1", 0.26), ("C-2", 0.132), ("C-3", 0.026)])
def test_modulus_ratios_are_those_of_section_4_3(name, printed):
    assert series(name).modulus_ratio == pytest.approx(printed, abs=0.005 if name == "C-1" else 0.0005)


def test_only_series_c_keeps_the_rolling_resistance_of_the_real_material():
    rolling = {name: scene(name).pair.surface_energy_of_rolling for name in ("S", "A-3", "B-3", "C-3")}
    assert rolling["C-3"] == rolling["S"] == 0.05
    assert rolling["B-3"] == scene("B-3").surface_energy_mod < 0.05


def test_a_series_that_table_1_does_not_have_is_refused():
    with pytest.raises(PlanError, match=r"no series 'D-1'.*Known: S, A-1"):
        series("D-1")


def test_adhesion_number_is_work_of_adhesion_over_twice_the_density_speed_squared_and_effective_radius():
    own = scene(adhesion_number=2.7)
    effective_radius = 1 / (2 / own.radius)
    work_of_adhesion = 2 * own.surface_energy
    assert work_of_adhesion / (2 * own.density * own.speed**2 * effective_radius) == pytest.approx(2.7, rel=ROUND_OFF)


def test_time_steps_of_s_and_c_are_as_their_collision_times():
    real, reduced = scene("S"), scene("C-2")
    assert real.limiting_mode == reduced.limiting_mode == "collision"
    assert reduced.time_step / real.time_step == pytest.approx(reduced.modulus_ratio**-0.4, rel=ROUND_OFF)
    pair = real.pair
    collision = timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, 5.0)
    assert real.time_step == collision / 20


def test_rolling_with_the_real_surface_energy_limits_the_time_step_of_very_soft_spheres():
    # The rolling spring keeps its stiffness while collisions become slow.
    soft = scene("C-3", modulus_ratio=1e-7, rolling_damping=0.0)
    assert soft.limiting_mode == "rolling"
    assert soft.time_step < soft.time_scales["collision"]


def test_column_is_free_of_overlap_across_its_faces_and_has_its_solid_fraction():
    places = column(400, 12.0, 0.06, seed=3)
    apart = places[:, None] - places[None]
    apart[..., :2] -= 12.0 * np.round(apart[..., :2] / 12.0)
    distance = np.linalg.norm(apart, axis=-1) + 1e9 * np.eye(400)
    assert distance.min() > CLEARANCE
    assert places[:, 2].min() >= LOWEST
    height = 400 * 4 / 3 * math.pi / (0.06 * 12.0**2)
    assert 0.97 * height < places[-1, 2] - LOWEST < height
    assert (np.diff(places[:, 2]) >= 0).all()


def test_column_depends_on_its_seed_alone():
    assert np.array_equal(column(50, 12.0, 0.05, seed=1), column(50, 12.0, 0.05, seed=1))
    assert not np.array_equal(column(50, 12.0, 0.05, seed=1), column(50, 12.0, 0.05, seed=2))


@pytest.mark.parametrize(("box", "fraction"), [(5.0, 0.05), (12.0, 0.3), (12.0, 0.0)])
def test_a_column_that_cannot_be_filled_at_random_is_refused(box, fraction):
    with pytest.raises(PlanError, match="Set box_in_radii"):
        column(100, box, fraction, seed=1)


def test_decks_of_c_name_the_real_properties_and_those_of_b_do_not(tmp_path):
    texts = {}
    for name in ("S", "B-2", "C-2"):
        (tmp_path / name).mkdir()
        texts[name] = deck.write(scene(name), tmp_path / name).read_text()
    assert "surfaceEnergyOriginal peratomtypepair 1 0.05\n" in texts["C-2"]
    assert "youngsModulusOriginal peratomtype 3800000000.0\n" in texts["C-2"]
    assert "Original" not in texts["B-2"].split("# --- contact law")[0].split("criticalRollingAngle")[0].replace("gamma_O", "")
    columns = {(tmp_path / name / deck.DATA_NAME).read_text() for name in texts}
    assert len(columns) == 1, "all series start from the same column"


def test_another_seed_is_another_deck(tmp_path):
    first = deck.write(scene(), tmp_path).read_text()
    assert deck.write(dataclasses.replace(scene(), seed=5), tmp_path).read_text() != first


def test_an_acceleration_pulls_only_after_the_rain(tmp_path):
    own = scene(settling_acceleration=2e-3)
    text = deck.write(own, tmp_path).read_text()
    rain, settling = text.split("# --- settling")
    assert " gravity " not in rain and " gravity " not in deck.write(scene(), tmp_path).read_text()
    pull = next(line for line in settling.splitlines() if " gravity " in line).split()
    assert float(pull[4]) == pytest.approx(2e-3 * 25.0 / own.radius, rel=ROUND_OFF)
    assert pull[5:] == ["vector", "0.0", "0.0", "-1.0"]


def crystal(cells: int) -> tuple[np.ndarray, float]:
    """Face-centred cubic crystal of unit spheres that touch, the lowest layer on the floor, and its edge."""
    edge = 2 * math.sqrt(2)
    corner = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    shifts = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    shift = np.array([0.1, 0.1, 0.0])
    return ((corner + shifts).reshape(-1, 3) + shift) * edge + (0, 0, 1), cells * edge


def test_voronoi_cells_inside_a_crystal_are_those_of_close_packing():
    positions, box = crystal(4)
    volumes = voronoi_volumes(positions, box)
    inside = (positions[:, 2] > 4) & (positions[:, 2] < box - 4)
    assert inside.sum() > 50
    # pi/sqrt(18), Kepler.
    assert 4 / 3 * math.pi / volumes[inside] == pytest.approx(math.pi / math.sqrt(18), rel=SINGLE_PRECISION)


def test_voronoi_cells_fill_the_column_from_the_floor_to_a_radius_above_the_highest_point():
    random = np.random.default_rng(8)
    positions = random.uniform((0, 0, 0.4), (9.0, 9.0, 31.0), (300, 3))
    volumes = voronoi_volumes(positions, 9.0)
    assert volumes.sum() == pytest.approx(81.0 * (positions[:, 2].max() + 1), rel=SINGLE_PRECISION)
    assert volumes.min() > 0


def bed_of(positions: np.ndarray, pairs, radius: float = 1.0, box: float = 20.0) -> Bed:
    count = len(pairs)
    return Bed(positions=np.asarray(positions, dtype=float), radius=radius, box=box, pairs=np.asarray(pairs).reshape(-1, 2),
               overlaps=np.zeros(count), normal_forces=np.zeros(count), floor=np.asarray(positions)[:, 2] <= radius,
               kinetic_energy=0.0)  # fmt: skip


def test_packing_fraction_of_a_crystal_by_cells_and_by_slices():
    micron = 1e-6
    positions, box = crystal(6)
    bed = bed_of(positions * micron, [[0, k] for k in range(1, len(positions))], micron, box * micron)
    kepler = math.pi / math.sqrt(18)
    assert bed.packing_fraction == pytest.approx(kepler, rel=SINGLE_PRECISION)
    # The slab ends between layers, off by at most a part of one layer in some six.
    assert bed.slab_packing_fraction == pytest.approx(kepler, rel=0.05)


def test_a_sphere_belongs_to_the_bed_where_contacts_lead_to_the_floor():
    places = [(1, 1, 1), (1, 1, 3), (1, 1, 5), (9, 9, 12), (9, 9, 14)]
    bed = bed_of(np.array(places), [[0, 1], [1, 2], [3, 4]])
    assert bed.settled.tolist() == [True, True, True, False, False]
    assert bed.coordination_numbers.tolist() == [1, 2, 1, 1, 1]
    assert bed.height == 2 * (1 + 3 + 5) / 3
    assert bed.middle.tolist() == [False, True, False, False, False]


def test_a_bed_of_too_few_spheres_is_refused(tmp_path):
    rows = "1 1 0 0 1e-6 0 0 0\n"
    (tmp_path / deck.SPHERES_NAME).write_text(
        "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\n"
        "ITEM: ATOMS id type x y z vx vy vz\n" + rows
    )
    with pytest.raises(DumpError, match="1 spheres where 120 were packed"):
        read_bed(scene(), tmp_path)
