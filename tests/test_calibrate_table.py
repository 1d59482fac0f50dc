"""The table of rebounds against direct integration, and against its own generator."""

from __future__ import annotations

import numpy as np
import pytest

from pyjkr.calibrate import table
from pyjkr.calibrate.collision import collision
from pyjkr.oracle import impact, sticking_speed

LAWS = ("jkr", "jkr/simplified")
# What the table promises: of e_eff^2 and of the sticking speed, relative. Measured: 2e-6 and 1e-7 over 120 random points.
SQUARED_RESTITUTION, STICKING = 1e-5, 1e-6


def direct(law: str, e: float, ratios: list[float]) -> tuple[float, list[float]]:
    """Sticking speed in units of v_*, and e_eff^2 at speeds over it."""
    contact = table.contact(e, law)
    sticking = sticking_speed(contact, 1.0, relative_tolerance=1e-11)
    found = [impact(contact, 1.0, sticking * ratio, relative_tolerance=1e-11, samples=2, stuck_periods=0.01) for ratio in ratios]
    return sticking * 3**0.5, [each.restitution**2 for each in found]  # v_* = sqrt(F_C a_0^2/(R m)) = sqrt(1/3)


@pytest.mark.parametrize("law", LAWS)
def test_table_agrees_with_direct_integration_at_random_points(law):
    random = np.random.default_rng(20190103)
    model = collision(law)
    for e in (*random.uniform(0.051, 0.997, 5).tolist(), 0.9971):
        ratios = (1 + np.exp(random.uniform(np.log(1e-4), np.log(9e3), 4))).tolist()
        sticking, squared = direct(law, e, ratios)
        assert float(model.sticking_ratio(e)) == pytest.approx(sticking, rel=STICKING)
        assert model.restitution(ratios, e) ** 2 == pytest.approx(squared, abs=SQUARED_RESTITUTION)


@pytest.mark.parametrize("law", LAWS)
def test_speeds_beyond_the_table_follow_its_power_law(law):
    _, squared = direct(law, 0.31, [1e5])
    model = collision(law)
    assert float(model.restitution(1e5, 0.31)) ** 2 == pytest.approx(squared[0], abs=SQUARED_RESTITUTION)
    assert float(model.restitution(1e12, 0.31)) == pytest.approx(0.31, abs=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_rebound_grows_from_zero_like_a_square_root_at_the_threshold(law):
    model = collision(law)
    assert model.restitution([0.2, 0.999999, 1.0], 0.7).tolist() == [0, 0, 0]
    near = model.restitution(1 + np.array([1e-8, 4e-8]), 0.7)
    assert near[1] / near[0] == pytest.approx(2, rel=1e-3)


# Sticking speeds of an independent integration, eight digits; in alpha = sqrt(5) |beta| for the full law.
@pytest.mark.parametrize(
    "law, e, sticking",
    [("jkr/simplified", 0.1, 9.5691224), ("jkr/simplified", 0.86, 0.46931637), ("jkr/simplified", 0.95, 0.25401452),
     ("jkr", table.restitution_of(0.1 / 5**0.5), 1.096349), ("jkr", table.restitution_of(1.2 / 5**0.5), 20.054452)],
)  # fmt: skip
def test_sticking_speed_is_that_of_an_independent_integration(law, e, sticking):
    assert float(collision(law).sticking_ratio(e)) == pytest.approx(sticking, rel=STICKING)


def test_grid_is_the_same_as_point_by_point():
    model = collision("jkr")
    ratios, damping = np.array([[3.0, 0.5], [1.2, 2e4], [3.0, 1.0]]), np.array([0.9, 0.2, 0.55])
    expected = model.restitution(ratios[..., None], damping)
    assert model.grid(ratios, damping) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("e", [0.0, 0.04, 0.9999, 1.2])
def test_damping_outside_the_table_is_refused(e):
    with pytest.raises(ValueError, match="within"):
        collision("jkr").sticking_ratio(e)


@pytest.mark.parametrize("law", LAWS)
def test_shipped_table_is_what_its_generator_makes(law):
    with np.load(table.PATH) as shipped:
        name, node = {"jkr": "full", "jkr/simplified": "simplified"}[law], 31
        t = shipped["t"]
        sticking, loss = table.column(float(shipped["root_beta"][node]) ** 2, law, t[:4])
        assert sticking == pytest.approx(shipped[f"sticking_{name}"][node], rel=1e-9)
        assert loss == pytest.approx(shipped[f"loss_{name}"][:4, node], abs=1e-6)
        assert len(t) == table.SPEED_NODES and len(shipped["root_beta"]) == table.DAMPING_NODES
    assert table.PATH.stat().st_size < 500_000
