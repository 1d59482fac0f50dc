"""The bar over all cases: it moves within a case, and its rate is that of what was really run."""

from __future__ import annotations

import io
from types import SimpleNamespace

import pytest
from rich.console import Console
from scene_files import DAHNEKE, written

from pyjkr import campaign, deck, progress
from pyjkr.plan import plan
from pyjkr.run import Simulator
from pyjkr.scene import load


@pytest.fixture
def made(tmp_path):
    return plan(load(written(tmp_path, DAHNEKE)))


def test_steps_within_a_case_count_and_never_beyond_its_end(made):
    seen = []
    cases = progress.Cases(lambda cases: seen.append((cases.finished, cases.steps)))
    first, second = made.cases[:2]
    cases.step(first, 17)
    cases.step(first, first.steps + 5)
    cases.done(first, was_there=False)
    cases.step(second, 3)
    assert seen == [(0, 17), (0, first.steps), (1, first.steps), (1, first.steps + 3)]


def test_the_rate_leaves_out_what_was_there_already(made, monkeypatch):
    now = iter([100.0, 110.0])
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(now)))
    cases = progress.Cases(lambda cases: None)
    cases.done(made.cases[0], was_there=True)
    assert cases.rate == 0
    cases.step(made.cases[1], 0)
    cases.step(made.cases[1], 500)
    assert cases.rate == 50


def test_the_bar_shows_case_step_rate_and_time_left(made, monkeypatch):
    screen = io.StringIO()
    monkeypatch.setattr(progress, "Console", lambda stderr: Console(file=screen, force_terminal=True, width=120))
    with progress.of_plan(made, wanted=True) as cases:
        cases.done(made.cases[0], was_there=False)
        cases.step(made.cases[1], 321)
    shown = screen.getvalue()
    assert f"case 2/{len(made.cases)}" in shown
    assert f"step {made.cases[0].steps + 321}/{made.total_steps}" in shown
    assert "steps/s" in shown
    assert "left" in shown


def test_no_bar_without_a_terminal(made, capfd):
    with progress.of_plan(made, wanted=True) as cases:
        cases.step(made.cases[0], 40)
    assert capfd.readouterr() == ("", "")


@pytest.mark.liggghts
def test_the_campaign_tells_steps_of_the_running_case(tmp_path, plugin: Simulator, made):
    short = type(made)(made.scene, made.cases[-2:], made.left_out, made.warnings)
    told = []

    class Watcher:
        def step(self, case, step):
            told.append((case.label, step))

        def done(self, case, was_there):
            told.append((case.label, "there" if was_there else "done"))

    campaign.execute(short, tmp_path, plugin, watcher=Watcher())
    for case in short.cases:
        steps = [step for label, step in told if label == case.label]
        assert steps[-1] == "done"
        assert steps[0] == 0
        assert steps[-2] == case.steps
        assert len(steps) > deck.THERMO_LINES / 2
    told.clear()
    campaign.execute(short, tmp_path, plugin, watcher=Watcher())
    assert told == [(case.label, "there") for case in short.cases]
