"""Progress bars on stderr: over the steps of one deck, and over all cases of a plan.

Both show step, rate and time left. A bar follows the thermo output, so it moves as often as that is printed.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from pyjkr.case import Case, Plan


@contextmanager
def of_run(name: str, total_steps: int | None, wanted: bool | None) -> Iterator[Callable[[int], None]]:
    """Shows one run while the block lasts; hands over the function to call with each new step.

    Parameters
    ----------
    name : str
        What stands before the bar.
    total_steps : int or None
        Steps of the whole run, where known.
    wanted : bool or None
        None shows it on a terminal only.
    """
    if not (sys.stderr.isatty() if wanted is None else wanted):
        yield lambda step: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _Rate(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        task = progress.add_task(name, total=total_steps)
        yield lambda step: progress.update(task, completed=step)


@contextmanager
def of_steps(name: str, wanted: bool) -> Iterator[Callable[[int, int], None]]:
    """Shows some work while the block lasts; hands over the function to call with how much is done, of how much.

    Parameters
    ----------
    name : str
        What stands before the bar.
    wanted : bool
        False shows nothing; True still shows nothing where stderr is not a terminal.
    """
    console = Console(stderr=True)
    columns = (TextColumn(name), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal), transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda done, every: bar.update(task, completed=done, total=every)


class _Rate(ProgressColumn):
    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f} steps/s")


@contextmanager
def of_plan(plan: Plan, wanted: bool) -> Iterator[Cases]:
    """Shows all cases of a plan while the block lasts; hands over what to tell of each case.

    Parameters
    ----------
    plan : Plan
        What is being run.
    wanted : bool
        False shows nothing; True still shows nothing where stderr is not a terminal.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("case {task.fields[case]}/{task.fields[cases]}"),
        BarColumn(),
        TextColumn("step {task.completed:.0f}/{task.total:.0f}  {task.fields[rate]}  {task.fields[left]}"),
    )
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal), transient=True) as progress:
        task = progress.add_task("", total=plan.total_steps, case=1, cases=len(plan.cases), rate="", left="")

        def show(cases: Cases) -> None:
            rate = cases.rate
            progress.update(
                task,
                completed=cases.steps,
                case=min(cases.finished + 1, len(plan.cases)),
                rate=f"{rate:,.0f} steps/s" if rate else "",
                left=_clock((plan.total_steps - cases.steps) / rate) + " left" if rate else "",
            )

        yield Cases(show)


@dataclass
class Cases:
    """How far the cases of a plan have come.

    Attributes
    ----------
    show : callable
        Called with this object after each change.
    finished : int
        Cases done.
    steps : int
        Steps done, those of the running case and of cases that were there already included.
    """

    show: Callable[[Cases], None]
    finished: int = 0
    steps: int = 0
    _before: int = 0
    _simulated: int = 0
    _started: float | None = None

    @property
    def rate(self) -> float:
        """Steps per second since the first case was started; 0 before. What was there already does not count."""
        if self._started is None:
            return 0.0
        ran = self._simulated + self.steps - self._before
        return ran / max(time.monotonic() - self._started, 1e-9)

    def step(self, case: Case, step: int) -> None:
        """The running case has come to a step."""
        if self._started is None:
            self._started = time.monotonic()
        self.steps = self._before + min(step, case.steps)
        self.show(self)

    def done(self, case: Case, was_there: bool) -> None:
        """A case has ended, or was there already."""
        self.finished += 1
        self._simulated += 0 if was_there else case.steps
        self._before += case.steps
        self.steps = self._before
        self.show(self)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}"
