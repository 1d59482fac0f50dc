"""The verb `pyjkr sweep`: a progress bar on stderr, the files, the verdict on stdout."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pyjkr.errors import ToleranceError
from pyjkr.sweep.executing import Watcher, execute
from pyjkr.sweep.file import SWEEP_NAME, load, sweep_file
from pyjkr.sweep.report import RESULT_NAME, checks_text, clear, report
from pyjkr.sweep.store import owned


def run_sweep(options: argparse.Namespace) -> None:
    """Run the verb.

    Parameters
    ----------
    options : Namespace
        `sweep`, `output`, `workers`, `scheduler`, `no_progress`, as `pyjkr.arguments` makes them.

    Raises
    ------
    PyjkrError
        SceneError of a sweep file; RunError where points failed; ToleranceError where a check does not hold.
    KeyboardInterrupt
        After the workers have ended.
    """
    path = sweep_file(options.sweep)
    sweep = load(path)
    # Before anything is touched: settings may contradict each other.
    count = len(sweep.points)
    directory = options.output or Path("results") / (path.parent.name if path.name == SWEEP_NAME else path.stem)
    with owned(directory):
        clear(directory)
        with _bar(count, not options.no_progress) as watcher:
            execution = execute(sweep, directory, workers=options.workers, scheduler=options.scheduler, watcher=watcher)
        if execution.reused:
            print(f"pyjkr: {execution.reused} of {count} points were finished before", file=sys.stderr)
        made = report(sweep, execution, directory)
    print(checks_text(made.checks))
    print(f"pyjkr: wrote {directory / RESULT_NAME}", file=sys.stderr)
    if not made.passed:
        raise ToleranceError("a check does not hold; see the lines marked BAD")


@contextmanager
def _bar(total: int, wanted: bool) -> Iterator[Watcher]:
    console = Console(stderr=True)
    columns = (TextColumn("points"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[failed]}"), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal), transient=True) as progress:
        task = None

        def show(finished: int, failed: int) -> None:
            nonlocal task
            if task is None:
                # Points that were there already say nothing about the time left.
                task = progress.add_task("", total=total, completed=finished + failed, failed="")
            progress.update(task, completed=finished + failed, failed=f"{failed} failed" if failed else "")

        yield show
