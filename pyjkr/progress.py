"""A progress bar over all cases of a plan, on stderr."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from pyjkr.campaign import Report
from pyjkr.case import Case, Plan


@contextmanager
def bar(plan: Plan, wanted: bool) -> Iterator[Report]:
    """Shows case, step, rate and time left while the block runs; hands over the function to call after each case.

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
        TextColumn("step {task.completed:.0f}/{task.total:.0f}  {task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal), transient=True) as progress:
        task = progress.add_task("", total=plan.total_steps, case=0, cases=len(plan.cases), rate="")
        state = {"case": 0, "ran": 0}

        def report(case: Case, was_there: bool) -> None:
            state["case"] += 1
            state["ran"] += 0 if was_there else case.steps
            elapsed = progress.tasks[task].elapsed or 0.0
            rate = f"{state['ran'] / elapsed:,.0f} steps/s" if elapsed and state["ran"] else ""
            progress.update(task, advance=case.steps, case=state["case"], rate=rate)

        yield report
