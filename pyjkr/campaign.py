"""`Plan` -> outcomes: every case rendered, run and read back, in one directory per case.

Finished cases are not run again: `run.json` beside the deck tells whether the run is whole and the deck still the same.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Protocol

from pyjkr import compare, deck, dump
from pyjkr.case import Case, Plan
from pyjkr.compare import Outcome
from pyjkr.errors import DumpError, RunError
from pyjkr.run import Run, Simulator, read_run, run_deck


class Watcher(Protocol):
    """Who wants to know how far the cases have come."""

    def step(self, case: Case, step: int) -> None:
        """The running case has come to a step."""

    def done(self, case: Case, was_there: bool) -> None:
        """A case has ended, or was there already."""


def execute(plan: Plan, directory: Path, simulator: Simulator, *, ranks: int = 1, watcher: Watcher) -> dict[str, Outcome]:
    """Run every case that is not finished, and read all of them.

    Parameters
    ----------
    plan : Plan
        What to run.
    directory : Path
        Gets one directory per case.
    simulator : Simulator
        LIGGGHTS to use.
    ranks : int
        MPI processes.
    watcher : Watcher
        Told of every step that LIGGGHTS prints and of every case that is done.

    Raises
    ------
    RunError, DumpError
        At the first run that fails or whose dump cannot be read.
    """
    outcomes = {}
    for case in plan.cases:
        finished = _finished(plan, case, directory, ranks)
        if finished is not None:
            # its dump may have been cut or overwritten since: then the case is run again
            with suppress(DumpError):
                outcomes[case.label] = _read(case, finished)
        if case.label not in outcomes:
            outcomes[case.label] = _read(case, _run(plan, case, directory, simulator, ranks, watcher))
            finished = None
        watcher.done(case, finished is not None)
    return outcomes


def collect(plan: Plan, directory: Path) -> dict[str, Outcome]:
    """Read the cases that `execute` left in a directory.

    Raises
    ------
    RunError
        Where a case is missing, unfinished, or was rendered from another scene.
    """
    outcomes = {}
    for case in plan.cases:
        run = _finished(plan, case, directory, None)
        if run is None:
            raise RunError(
                f"{directory / case.label}: no finished run of this scene. Type `pyjkr run` with the same scene and -o."
            )
        outcomes[case.label] = _read(case, run)
    return outcomes


def _finished(plan: Plan, case: Case, directory: Path, ranks: int | None) -> Run | None:
    """The whole run of this very case, if there is one; on any number of ranks where `ranks` is None."""
    place = directory / case.label
    run = read_run(place)
    if run is None or not (place / deck.DUMP_NAME).is_file():
        return None
    if run.deck.read_text(encoding="utf-8") != deck.render(case, plan.scene) or ranks not in (None, run.ranks):
        return None
    return run


def _run(plan: Plan, case: Case, directory: Path, simulator: Simulator, ranks: int, watcher: Watcher) -> Run:
    path = deck.write(case, plan.scene, directory / case.label)
    (path.parent / deck.DUMP_NAME).unlink(missing_ok=True)
    return run_deck(
        path, ranks=ranks, progress=False, on_step=lambda step: watcher.step(case, step), simulator=simulator
    )


def _read(case: Case, run: Run) -> Outcome:
    return compare.outcome_of_run(case, dump.read(run.directory / deck.DUMP_NAME), run)
