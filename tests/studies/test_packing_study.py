"""The study of packings in the real LIGGGHTS, small: beds come to rest, C packs as S, A looser, forces are those of the law."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pydantic
import pytest

from pyjkr.contact import contact_radius
from pyjkr.errors import PlanError
from pyjkr.packing import deck
from pyjkr.packing.bed import read_bed
from pyjkr.packing.scene import PackingScene
from pyjkr.studies import packing

SETTINGS = packing.Settings(series=("S", "A-2", "C-2"), seeds=(1, 2), particles=300)
# Standard deviation of the packing fraction of one bed of 300 spheres, 160 of them counted: 0.009, from 0.0065 of ten beds of
# twice the size. Means of two differ by as much; four times that. Compilers and rounding choose among the beds as seeds do.
SCATTER = 0.036
# A-2 packs looser by 0.051 in the mean of ten; less than this is four standard deviations away.
LOOSER = 0.015
# Force of a contact from the digits of its overlap; what still moves at 1e-5 of the inlet's energy damps a little.
STATIC = 0.02


@pytest.fixture(scope="module")
def packed(plugin, tmp_path_factory) -> tuple[pd.DataFrame, dict[str, Path]]:
    root, rows, places = tmp_path_factory.mktemp("packings"), [], {}
    for point in packing.points(SETTINGS):
        places[point["label"]] = root / point["label"]
        places[point["label"]].mkdir()
        rows += packing.evaluate(point, places[point["label"]])
    return pd.DataFrame(rows), places


def summary(table: pd.DataFrame, name: str) -> pd.DataFrame:
    return table[(table["kind"] == "summary") & (table["series"] == name)]


def test_points_are_flat_and_tell_every_number():
    points = packing.points(SETTINGS)
    assert len(points) == 6 and len({point["label"] for point in points}) == 6
    assert {field.name for field in dataclasses.fields(PackingScene)} < set(points[0])
    assert all(isinstance(value, str | int | float | bool) for point in points for value in point.values())


def test_beds_come_to_rest_with_all_spheres_above_the_floor(packed):
    table, _ = packed
    found = {check.name: check for check in packing.checks(table, SETTINGS)}
    for name in ("packings that lost spheres", "least height over r, least distance over 2 r",
                 "kinetic energy left, over the inlet's", "spheres still in flight, share"):  # fmt: skip
        assert found[name].holds, found[name]


def test_c_packs_as_s_and_a_packs_looser(packed):
    table, _ = packed
    phi = {name: summary(table, name)["packing_fraction"].mean() for name in SETTINGS.series}
    assert phi["C-2"] == pytest.approx(phi["S"], abs=SCATTER)
    assert phi["A-2"] < phi["S"] - LOOSER


def test_mean_overlap_is_the_equilibrium_overlap_of_eq_16(packed):
    table, _ = packed
    for name in ("S", "C-2"):
        own = summary(table, name)
        ratio = own["mean_overlap"] / own["equilibrium_overlap"]
        assert ratio.mean() == pytest.approx(1, abs=packing.OVERLAP_TOLERANCE)


def test_cells_and_slices_give_the_same_packing_fraction(packed):
    table, _ = packed
    rows = table[table["kind"] == "summary"]
    assert rows["packing_fraction"].mean() == pytest.approx(rows["slab_packing_fraction"].mean(), rel=0.02)


def test_normal_forces_at_rest_are_those_of_the_law_at_the_overlaps(packed):
    _, places = packed
    point = next(point for point in packing.points(SETTINGS) if point["series"] == "C-2")
    scene = PackingScene(**{field.name: point[field.name] for field in dataclasses.fields(PackingScene)})
    bed = read_bed(scene, places[point["label"]])
    pair = scene.pair
    share = contact_radius(bed.overlaps, pair) / pair.equilibrium_contact_radius
    law = 4 * pair.pull_off_force * (share**3 - share**1.5)  # Chen 2019, eq. 1a, without its damping
    assert len(law) > 400
    assert np.abs(bed.normal_forces - law).max() < STATIC * pair.pull_off_force
    distance = bed.positions[bed.pairs[:, 0]] - bed.positions[bed.pairs[:, 1]]
    distance[:, :2] -= bed.box * np.round(distance[:, :2] / bed.box)
    assert 2 * bed.radius - np.linalg.norm(distance, axis=1) == pytest.approx(bed.overlaps, abs=1e-9 * bed.radius)


def test_distributions_count_every_sphere_and_contact_of_the_middle(packed):
    table, _ = packed
    own = table[(table["label"] == "S_Ad3_seed1") & (table["kind"] == "distribution")]
    counts = own.groupby("quantity")["count"].sum()
    row = summary(table, "S").iloc[0]
    assert counts["coordination_number"] == counts["local_packing_fraction"] == row["middle_spheres"]
    assert counts["overlap"] == row["middle_contacts"]
    mean = (own["count"] * (own["low"] + own["high"]) / 2)[own["quantity"] == "coordination_number"].sum() / row["middle_spheres"]
    assert mean == pytest.approx(row["coordination_number"])


def test_a_whole_run_is_read_and_not_repeated(packed, monkeypatch):
    table, places = packed
    point = packing.points(SETTINGS)[0]
    monkeypatch.setattr(deck, "run_deck", lambda *_, **__: pytest.fail("ran again"))
    again = pd.DataFrame(packing.evaluate(point, places[point["label"]]))
    before = table[table["label"] == point["label"]].reset_index(drop=True)
    pd.testing.assert_frame_equal(again, before[again.columns], check_dtype=False)


def test_checks_fail_where_the_stiffness_was_reduced_without_its_surface_energy(packed):
    # The rows of A-2 under the name of C-2.
    table = packed[0]
    table = table[table["series"] != "C-2"].replace({"series": {"A-2": "C-2"}})
    failed = {check.name for check in packing.checks(table, packing.Settings(series=("S", "C-2"), seeds=(1, 2), particles=300))
              if not check.holds}  # fmt: skip
    assert {"C-2: packing fraction over that of S",
            "C-2: cumulative distribution of local packing fraction, distance from that of S",
            "C-2: mean overlap over that of S, times (E_R/E_O)^(2/5), eq. 17"} <= failed  # fmt: skip


def test_figures_are_drawn_for_what_was_swept(packed):
    table, _ = packed
    drawn = packing.figures(table, SETTINGS)
    assert set(drawn) == {"snapshots", "local_structure", "contacts", "timing", "packing"}
    labels = [line.get_label() for line in drawn["local_structure"].axes[0].lines]
    assert labels == ["S", "C-2"]


def test_without_freud_nothing_is_run(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "freud", None)
    with pytest.raises(PlanError, match="pip install freud-analysis"):
        packing.evaluate(packing.points(SETTINGS)[0], tmp_path)
    assert not list(tmp_path.iterdir())


def test_settings_that_do_not_fit_are_refused():
    with pytest.raises(pydantic.ValidationError, match="no series 'Q'"):
        packing.Settings(series=("S", "Q"))
    with pytest.raises(pydantic.ValidationError, match="checked_adhesion_number = 3 is not one of"):
        packing.Settings(adhesion_numbers=(1.0,))
