"""An oblique impact that sticks and rolls until it rests, in LIGGGHTS: how its way depends on time step and stiffness."""

from __future__ import annotations

from dataclasses import replace

import pytest
from application_scenes import CASES

from pyjkr.application import analysis, deck, scene, situation
from pyjkr.planning import plan, steps, variants
from pyjkr.planning.variants import Variant

pytestmark = pytest.mark.liggghts


def way(variant: Variant, directory) -> float:
    """Distance rolled [m]."""
    given = scene.load(CASES["oblique_wall"])
    given = given.model_copy(update={"run": given.run.model_copy(update={"frames": 1})})
    deck.simulate(given, variant, directory, progress=False)
    return analysis.observables(given, variant, directory)["distance_along_wall"]


@pytest.mark.parametrize("max_error", [0.01, 0.05])
def test_way_at_the_planned_step_is_that_of_a_step_ten_times_shorter(tmp_path, max_error):
    made = plan.plan(situation.situation(scene.load(CASES["oblique_wall"])), max_error)
    planned = variants.planned(made)
    fine = replace(planned, time_step=planned.time_step / 10)
    allowed = steps.error(made.situation, made.decisions, made.steps_per_collision)
    assert allowed <= max_error / 4
    assert way(planned, tmp_path / "planned") == pytest.approx(way(fine, tmp_path / "fine"), rel=allowed)


@pytest.mark.parametrize("max_error", [0.01, 0.05])
def test_way_at_the_planned_stiffness_is_that_of_the_real_material(tmp_path, max_error):
    what = situation.situation(scene.load(CASES["oblique_wall"]))
    planned = variants.planned(plan.plan(what, max_error))
    assert way(planned, tmp_path / "planned") == pytest.approx(way(variants.unreduced(what), tmp_path / "real"), rel=max_error)
