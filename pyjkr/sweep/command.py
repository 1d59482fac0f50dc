"""The verb `pyjkr sweep`: its arguments, a progress bar on stderr, the files, the verdict on stdout."""

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

SUMMARY = "Evaluate a study at many points, on all cores or on a cluster: the figures of the papers, or a scene of your own."
FILES = (
    "Reads a sweep file (TOML), or that of a shipped case; writes DIR/table.csv, PNG figures, result.json, what each point\n"
    "leaves behind (decks, logs, dumps) in DIR/points/, and the checks to stdout. Finished points are kept at once and not\n"
    "evaluated again: after Ctrl-C or a failure the same command goes on. With --scheduler the workers of a Dask cluster\n"
    "evaluate the points; they need pyjkr and LIGGGHTS of the same versions. Rows come back to DIR, while decks, logs and\n"
    "dumps stay on the machine of the worker, in a directory of the same name. Exit status 1 where a check does not hold,\n"
    "3 where a point failed: then there is no table, no figure and no result.json."
)
EXAMPLE = "pyjkr sweep haervig_fig12 -o results/haervig_fig12"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("sweep", metavar="SWEEP", help="a TOML file, or the name of a shipped case that has a sweep.toml")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the sweep>")
    parser.add_argument("--workers", type=_workers, metavar="N", help="processes on this machine (default: one per core)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786, in place of --workers")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")


def _workers(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} must be a whole number >= 1")
    return int(text)


def run_sweep(options: argparse.Namespace) -> None:
    """Run the verb.

    Parameters
    ----------
    options : Namespace
        `sweep`, `output`, `workers`, `scheduler`, `no_progress`, as `add_arguments` makes them.

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
