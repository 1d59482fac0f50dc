"""Fig. 10 of Haervig et al. 2017: rebound, rolling or sticking, at the real stiffness and at a hundredth of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pyjkr.errors import PlanError
from pyjkr.oracle import Assembly, Options, PairLaw, Wall, follow
from pyjkr.studies import deposition, lanes, rebound_map

pytestmark = pytest.mark.liggghts

SETTINGS = rebound_map.Settings(elasticity=(1.5e7, 7e8), forces=(0.5, 0.99, 1.01, 2.0), adhesion_hysteresis=0.8, angle=75.0)
# c of eq. 25 for e = 0.3: integration of the dimensionless collision in multiple precision.
C = 147.22656
# Of the displacement along the wall in four collision times, at 200 steps a collision and four times as many.
PATH_ERRORS = (2e-6, 5e-7)


@pytest.fixture(scope="module")
def table(plugin, tmp_path_factory) -> pd.DataFrame:
    rows = []
    for point in rebound_map.points(SETTINGS):
        rows += rebound_map.evaluate(point, tmp_path_factory.mktemp("point"))
    return pd.DataFrame(rows)


def test_every_check_of_the_figure_holds(table) -> None:
    checks = rebound_map.checks(table, SETTINGS)
    assert len(checks) == 7
    assert [check.name for check in checks if not check.holds] == []


def test_rebound_border_is_that_of_the_dimensionless_collision(table) -> None:
    borders = table[table["kind"] == "border"]
    # six digits of C
    assert borders["critical_elasticity"].to_numpy() == pytest.approx(C * 300**2.5, rel=1e-6)
    assert len(borders) == 2


def test_without_the_real_values_in_rolling_the_softened_sphere_rolls_too_early(plugin, tmp_path: Path) -> None:
    # M_crit goes as F_C a_0: q^(1/5) of the real one, 0.40 at q = 0.01
    point = next(point for point in rebound_map.points(SETTINGS) if point["kind"] == "map" and point["modulus_ratio"] == 0.01)
    naive = {**point, "original_rolling": False, "forces": [0.2, 0.43, 0.7]}
    rows = pd.DataFrame(rebound_map.evaluate(naive, tmp_path)).set_index("force")
    assert rows["outcome"].to_dict() == {0.2: "sticking", 0.43: "rolling", 0.7: "rolling"}


@pytest.mark.parametrize(
    ("column", "change", "words"),
    [
        ("outcome", {"sticking": "rolling"}, "between sticking and rolling"),
        ("outcome", {"rebound": "sticking"}, "wrong side"),
    ],
)
def test_a_sphere_on_the_wrong_side_of_a_border_is_noticed(table, column, change, words) -> None:
    wrong = table.copy()
    old, new = next(iter(change.items()))
    wrong.loc[wrong.index[(wrong[column] == old) & (wrong["modulus_ratio"] == 1.0)][-1], column] = new
    failed = [check.name for check in rebound_map.checks(wrong, SETTINGS) if not check.holds]
    assert any(words in name for name in failed) and "outcomes that differ between stiffnesses" in failed


def test_path_of_a_pulled_sphere_is_that_of_the_oracle(plugin, tmp_path: Path) -> None:
    """Sphere that sticks under 0.6 F_yield: place along the wall and spin after four collisions, integrated by other means."""
    errors = []
    for steps, allowed in zip((200, 800), PATH_ERRORS, strict=True):
        settings = SETTINGS.model_copy(update={"steps_per_collision": steps})
        point = rebound_map.points(settings)[0]
        setup = deposition.prepare(point, 1e8)
        case, lane = setup.case, deposition.lane_of(setup, 0.6)
        frame = lanes.run(case, setup.scene, [lane], tmp_path / str(steps), steps=case.steps, every=case.steps)
        last = frame.iloc[-1]
        contact = setup.scene.meeting
        law = PairLaw(
            case.pair.effective_modulus, case.pair.effective_shear_modulus, contact.surface_energy, contact.restitution_coefficient,
            contact.friction_coefficient, adhesion_hysteresis=contact.adhesion_hysteresis,
        )  # fmt: skip
        start = Assembly(
            position=np.array([[0.0, 0.0, lane.height]]), velocity=np.array([[lane.speed, 0.0, -lane.approach]]), spin=np.zeros((1, 3)),
            radius=np.array(case.radii), mass=np.array(case.masses), laws=law, options=Options(),
            walls=[Wall((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))], external_force=np.array([[lane.force, 0.0, 0.0]]),
        )  # fmt: skip
        end = follow(start, case.steps * case.time_step, samples=2, relative_tolerance=1e-9).final
        errors.append(max(abs(last["x"] / end.position[0, 0] - 1), abs(last["omegay"] / end.spin[0, 1] - 1)))
        assert errors[-1] < allowed
    # at least first order
    assert errors[1] < errors[0] / 3


def test_figure_is_drawn(table, tmp_path: Path) -> None:
    for stem, figure in rebound_map.figures(table, SETTINGS).items():
        figure.savefig(tmp_path / stem, format="png")
        assert (tmp_path / stem).stat().st_size > 10_000


def test_rolling_begins_where_the_force_at_its_real_lever_beats_the_torque(plugin, tmp_path: Path) -> None:
    # the wall holds half an overlap nearer to the centre than r: F_yield/(1 - delta/(2 r)), 1.00455 here
    point = next(point for point in rebound_map.points(SETTINGS) if point["kind"] == "map" and point["modulus_ratio"] == 0.01)
    close = {**point, "elasticity": 1e7, "forces": [1.0035, 1.0055]}
    rows = rebound_map.evaluate(close, tmp_path)
    assert [row["outcome"] for row in rows] == ["sticking", "rolling"]
    assert 1.0035 < 1 / rows[0]["lever"] < 1.0055


def test_lever_is_that_of_the_overlap_that_the_plan_knows() -> None:
    for point in rebound_map.points(SETTINGS):
        if point["kind"] == "map":
            setup = deposition.prepare(point, point["elasticity"])
            overlap = setup.case.pair.equilibrium_contact_radius**2 / (3 * setup.case.radii[0])
            assert setup.lever == pytest.approx(1 - 0.5 * overlap / setup.case.radii[0], rel=1e-12)


def test_a_force_that_hardly_ever_decides_is_refused_before_the_first_step() -> None:
    with pytest.raises(PlanError, match=r"1\.0005 F_yield is within 0\.1%.*Move it away"):
        rebound_map.points(SETTINGS.model_copy(update={"forces": (0.5, 1.0005)}))
