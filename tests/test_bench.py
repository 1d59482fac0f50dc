"""The benchmarks: what they read from logs and how they count contacts. Nothing here is timed."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

# bench/ lies in the source tree and is not installed; appended, so that the installed pyjkr comes first.
sys.path.append(str(Path(__file__).resolve().parent.parent))

from bench import instructions, report, run, solver
from bench.bed import BedSpec, cached_bed, count_contacts, make_bed, repeated, write_data_file
from bench.laws import LAMMPS_LAWS, LAWS, Mode, lammps_deck, liggghts_deck
from bench.measure import Bench, Job, Sample, Spread, read_log
from pyjkr.errors import RunError
from pyjkr.run import Simulator

LIGGGHTS_LOG = """\
WARNING:
\tThe contact model you specified is not located in any whitelist.
Loop time of 0.5 on 1 procs for 10 steps with 500 atoms
Pair  time (%) = 0.0112 (94.5133)
Neigh time (%) = 0 (0)
Total # of neighbors = 2300
Loop time of 1.2 on 1 procs for 100 steps with 500 atoms
Pair  time (%) = 0.115 (95.1227)
Total # of neighbors = 2349
"""
LAMMPS_LOG = """\
Section |  min time  |  avg time  |  max time  |%varavg| %total
Pair    | 0.025      | 0.026      | 0.027      |   0.0 | 97.59
Total # of neighbors = 2368
"""


def test_the_last_run_of_a_log_counts() -> None:
    reading = read_log(LIGGGHTS_LOG)
    assert (reading.pair_time, reading.neighbours, reading.generic) == (0.115, 2349, True)


def test_the_mean_over_the_ranks_is_read_from_a_log_of_lammps() -> None:
    reading = read_log(LAMMPS_LOG)
    assert (reading.pair_time, reading.neighbours, reading.generic) == (0.026, 2368, False)


def test_a_log_without_a_whole_run_is_refused() -> None:
    with pytest.raises(RunError, match="did not come to its end"):
        read_log("LIGGGHTS (Version ...)\nERROR: Lost atoms")


def test_the_sum_of_a_callgrind_file_is_read() -> None:
    assert instructions.read_callgrind("events: Ir\nsummary: 94837868\n\nfn=(1)\ntotals: 94837868\n") == 94837868
    with pytest.raises(RunError, match="valgrind"):
        instructions.read_callgrind("events: Ir\n")


def test_the_solver_table_is_read() -> None:
    (row,) = solver.read_table("method,throughput_ns,latency_ns,root_error,force_error\nFerrari,1,2,3e-16,4e-15\n")
    assert row == solver.SolverRow("Ferrari", 1.0, 2.0, 3e-16, 4e-15)


def test_times_are_divided_by_what_was_evaluated() -> None:
    sample = Sample(pair_time=0.3, steps=200, contacts=1400.0, evaluations=1500.0, neighbours=2500, generic=False)
    assert sample.per_evaluation == pytest.approx(1000.0)
    assert sample.per_neighbour == pytest.approx(600.0)


# --- contacts ---------------------------------------------------------------------------------------------------------

# Two spheres of 0.6 and 0.5 across a face of a box of 10 x 11 x 12, and two in its middle that do not touch.
BOX = np.array([10.0, 11.0, 12.0])
POSITIONS = np.array([[0.2, 5.0, 5.0], [9.3, 5.0, 5.0], [5.0, 5.0, 5.0], [6.3, 5.0, 5.0]])
RADII = np.array([0.6, 0.5, 0.7, 0.55])


def test_a_contact_through_a_face_is_one_pair_and_two_evaluations() -> None:
    contacts = count_contacts(POSITIONS, RADII, BOX)
    assert (contacts.pairs, contacts.evaluations) == (1, 2)


def test_spheres_that_overlap_inside_the_box_are_one_pair_and_one_evaluation() -> None:
    contacts = count_contacts(POSITIONS + np.array([[0, 0, 0], [0, 0, 0], [0.1, 0, 0], [0, 0, 0]]), RADII, BOX)
    assert (contacts.pairs, contacts.evaluations) == (2, 3)


@given(st.integers(0, 2**32 - 1))
def test_contacts_are_those_that_all_pairs_compared_give(seed: int) -> None:
    random = np.random.default_rng(seed)
    positions, radii = random.uniform(-3.0, 14.0, (40, 3)), random.uniform(0.3, 1.2, 40)
    separation = positions[:, None] - positions[None]
    separation -= BOX * np.round(separation / BOX)
    touching = np.linalg.norm(separation, axis=-1) < radii[:, None] + radii[None]
    assert count_contacts(positions, radii, BOX).pairs == (np.count_nonzero(touching) - len(radii)) // 2


@pytest.fixture(scope="module")
def small_bed():
    return make_bed(BedSpec(200))


def test_neighbours_in_a_bed_overlap_by_what_was_asked_for(small_bed) -> None:
    spec = BedSpec(200)
    separation = small_bed.positions[:, None] - small_bed.positions[None]
    separation -= small_bed.box * np.round(separation / small_bed.box)
    distance = np.linalg.norm(separation, axis=-1)[np.triu_indices(200, 1)]
    overlap = 1.0 - np.min(distance) / (2.0 * spec.radius)
    assert spec.overlap <= overlap < 1.05 * spec.overlap
    assert 4.5 < 2.0 * small_bed.contacts.pairs / spec.spheres < 6.0


def test_a_bed_comes_back_from_its_file(small_bed, tmp_path: Path) -> None:
    spec = BedSpec(200)
    for bed in (cached_bed(spec, tmp_path), cached_bed(spec, tmp_path)):
        assert np.array_equal(bed.positions, small_bed.positions)
        assert bed.density == spec.density
    assert replace(spec, size_spread=0.1).key != spec.key


def test_a_repeated_bed_has_as_many_times_the_contacts(small_bed) -> None:
    assert repeated(small_bed, (1, 2, 3)).contacts.pairs == 6 * small_bed.contacts.pairs


def test_a_data_file_holds_every_position_exactly(small_bed, tmp_path: Path) -> None:
    file = tmp_path / "bed.data"
    write_data_file(small_bed, file, moving=True)
    atoms, velocities = file.read_text().split("Atoms")[1].split("Velocities")
    rows = np.array([line.split() for line in atoms.split("\n") if line.strip()], float)
    assert np.array_equal(rows[:, 4:], small_bed.positions)
    assert np.array_equal(rows[:, 2], 2.0 * small_bed.radii)
    moving = np.array([line.split() for line in velocities.split("\n") if line.strip()], float)
    assert np.array_equal(moving[:, 4:], small_bed.spins)


# --- decks and runs ---------------------------------------------------------------------------------------------------


def test_decks_of_two_laws_differ_in_nothing_but_the_styles() -> None:
    decks = [liggghts_deck(law, Mode.LIVE, Path("b"), radius=5e-7, steps=10, program="p").splitlines() for law in LAWS]
    for deck in decks[1:]:
        differing = [a for a, b in zip(decks[0], deck, strict=True) if a != b]
        assert all(line.startswith(("#", "pair_style")) for line in differing)


def test_a_frozen_bed_is_not_integrated() -> None:
    for deck in (
        liggghts_deck(LAWS[0], Mode.FROZEN, Path("b"), radius=5e-7, steps=10, program="p"),
        lammps_deck(LAMMPS_LAWS[0], Mode.FROZEN, Path("b"), radius=5e-7, steps=10),
    ):
        assert "nve" not in deck


def test_every_law_has_a_baseline_among_the_stock_laws() -> None:
    stock = {law.key for law in LAWS if not law.ours}
    assert {law.baseline for law in (*LAWS, *LAMMPS_LAWS)} <= stock
    assert len({law.key for law in LAWS}) == len(LAWS)


def test_every_law_comes_once_in_every_round() -> None:
    jobs = list(run._alternating(LAWS, Mode, "bed", 10, 3))
    for repeat in range(3):
        once = [(job.law, job.mode) for job in jobs if job.repeat == repeat]
        assert len(once) == len(set(once)) == len(LAWS) * len(Mode)
    assert [j.law for j in jobs[:10]] != [j.law for j in jobs[len(LAWS) * 2 :][:10]]


def test_ratios_are_taken_within_a_round() -> None:
    def samples(*times: float) -> list[Sample]:
        return [Sample(t, 1, 1.0, 1.0, 1, False) for t in times]

    ours = next(law for law in LAWS if law.ours)
    base = next(law for law in LAWS if law.key == ours.baseline)
    found = {(ours, Mode.LIVE): samples(2.0, 20.0, 6.0), (base, Mode.LIVE): samples(1.0, 10.0, 3.0)}
    assert report.ratio_to_baseline(found, ours, Mode.LIVE) == Spread(2.0, 2.0, 2.0, 2.0)
    assert report.ratio_to_baseline(found, ours, Mode.FROZEN) is None


def test_the_page_shows_what_was_measured_and_nothing_else() -> None:
    results = report.Results("command", 200, 500, 600, 0.2, notes=["a reason."])
    results.laws[LAWS[0], Mode.FROZEN] = [Sample(0.06, 100, 500.0, 600.0, 900, True)]
    text = report.page(results)
    assert "| `hertz` * | 1000.0 (1000.0..1000.0) |" in text
    assert "z = 5.00" in text and "- a reason." in text
    assert "MPI" not in text and "callgrind" not in text


def test_an_unknown_part_is_a_usage_error() -> None:
    with pytest.raises(SystemExit, match="unknown part"):
        run.main(["grwth"])


@pytest.mark.liggghts
def test_a_run_is_measured_once(plugin: Simulator, small_bed, tmp_path: Path) -> None:
    bench = Bench(tmp_path, plugin)
    contacts = bench.add_bed("small", small_bed, 5e-7)
    law = next(law for law in LAWS if law.key == "jkr+jkr+krijt")
    for mode in Mode:
        job = Job(law, mode, "small", 20)
        sample = bench.measure(job)
        assert sample.pair_time > 0.0 and sample.neighbours > contacts.pairs
        assert bench.done(job) == sample
        assert bench.done(replace(job, steps=30)) is None
        if mode is Mode.FROZEN:
            assert sample.evaluations == contacts.evaluations
