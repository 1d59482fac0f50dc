"""The verb `pyjkr cost`: measure a scene, with a progress bar, and leave the files."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pyjkr.cost import page, report
from pyjkr.cost.measure import measure
from pyjkr.cost.results import Costs
from pyjkr.cost.studies import FULL, QUICK, Jobs
from pyjkr.run import find_simulator
from pyjkr.scene import Scene


def run(scene: Scene, source: Path, directory: Path, *, quick: bool, progress: bool, page_file: Path | None = None) -> Costs:
    """Measure what accuracy costs for a scene; finished runs are not repeated.

    Parameters
    ----------
    scene : Scene
        What to measure.
    source : Path
        Its file.
    directory : Path
        Gets `runs/`, `cost.csv`, `cost.json` and the figures.
    quick : bool
        Fewer phases, steps, speeds, stiffnesses and repetitions.
    progress : bool
        Show a bar, where stderr is a terminal.
    page_file : Path or None
        Markdown page to write, with its figures in `figures/` beside it.

    Raises
    ------
    RunError, DumpError
        Where LIGGGHTS is missing or a run fails.
    """
    simulator = find_simulator()
    directory.mkdir(parents=True, exist_ok=True)
    report.clear(directory)
    jobs = Jobs.of(scene, QUICK if quick else FULL)
    with _bar(len(jobs.jobs), progress) as done:
        costs = measure(jobs, directory, simulator, done)
    report.write(costs, directory, hashlib.sha256(source.read_bytes()).hexdigest(), str(simulator.executable))
    if page_file:
        page.write(costs, directory, page_file, f"pyjkr cost {scene_name(source)}" + (" --quick" if quick else ""))
    return costs


def scene_name(source: Path) -> str:
    """Name of a shipped case by its directory, of any other scene by its file."""
    return source.parent.name if source.name == "scene.toml" else source.stem


@contextmanager
def _bar(total: int, wanted: bool) -> Iterator[Callable[[int], None]]:
    console = Console(stderr=True)
    columns = (TextColumn("batch"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal), transient=True) as progress:
        task = progress.add_task("", total=total)
        yield lambda done: progress.update(task, completed=done)
