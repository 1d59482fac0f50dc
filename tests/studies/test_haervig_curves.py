"""Figs 3 and 4 of Haervig et al. 2017: force over overlap and torque over rolled distance, LIGGGHTS on the curves of the oracle."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
import pytest

from pyjkr.studies import force_overlap, lanes, rolling_torque

pytestmark = pytest.mark.liggghts

STUDIES = {
    # other ratios than the shipped sweeps have
    force_overlap: force_overlap.Settings(modulus_ratio=0.03, deepest=1.7, markers=5),
    rolling_torque: rolling_torque.Settings(modulus_ratio=0.04, adhesion_hysteresis=0.7, steps=60),
}
# Derived in closed form from eqs 7-10: well from overlap 0 to equilibrium over F_C a_0^2/R.
WELL = 0.167045209
# Digits of WELL.
NINE_DIGITS = 1e-8


@pytest.fixture(scope="module")
def tables(plugin, tmp_path_factory) -> dict:
    found = {}
    for study, settings in STUDIES.items():
        rows = []
        for point in study.points(settings):
            rows += study.evaluate(point, tmp_path_factory.mktemp("point"))
        found[study] = pd.DataFrame(rows)
    return found


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.__name__)
def test_every_check_of_the_figure_holds(tables, study) -> None:
    checks = study.checks(tables[study], STUDIES[study])
    assert len(checks) >= 10
    assert [check.name for check in checks if not check.holds] == []


@pytest.mark.parametrize(("study", "column"), [(force_overlap, "force"), (rolling_torque, "torque")], ids=["force", "torque"])
@pytest.mark.parametrize("variant", ["original", "E reduced", "E and gamma reduced"])
def test_a_curve_wrong_by_a_millionth_is_noticed(tables, study, column, variant) -> None:
    wrong = tables[study].copy()
    wrong.loc[wrong["variant"] == variant, column] *= 1 + 1e-6
    failed = [check.name for check in study.checks(wrong, STUDIES[study]) if not check.holds]
    assert any(name.startswith(f"{variant}: ") for name in failed)


def test_rows_of_liggghts_that_are_missing_fulfil_no_check_of_it(tables) -> None:
    table = tables[rolling_torque]
    empty = table[table["variant"] != "original"]
    with pytest.raises((IndexError, TypeError, ValueError, KeyError)):
        rolling_torque.checks(empty, STUDIES[rolling_torque])
    assert math.isnan(lanes.worst([]))


def test_separation_energy_is_the_closed_form(tables) -> None:
    rows = tables[force_overlap]
    nodes = rows[(rows["variant"] == "original") & (rows["kind"] == "integral")]
    energy = -(nodes["weight"] * nodes["force"]).sum()
    # a_0^2/R is three equilibrium overlaps
    unit = nodes["pull_off_force"].iloc[0] * 3 * nodes["equilibrium_overlap"].iloc[0]
    assert energy / unit == pytest.approx(WELL, rel=NINE_DIGITS)


def test_limit_of_the_real_contact_is_pi_radius_a0_hysteresis(tables) -> None:
    # pi R a_0 Delta gamma, Krijt et al. 2014; numbers of Haervig 2017, fig. 5
    radius, modulus, energy, hysteresis = 0.635e-6, 271e6, 0.11, 0.7
    a0 = (9 * math.pi * energy * radius**2 / modulus) ** (1 / 3)
    rows = tables[rolling_torque]
    for variant in ("original", "corrected"):
        plateau = rows[rows["variant"] == variant]["torque"].iloc[-1]
        assert plateau == pytest.approx(math.pi * radius * a0 * hysteresis * energy, rel=1e-12)


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.__name__)
def test_figure_is_drawn(tables, study, tmp_path: Path) -> None:
    for name, figure in study.figures(tables[study], STUDIES[study]).items():
        figure.savefig(tmp_path / name, format="png")
        assert (tmp_path / name).stat().st_size > 10_000
