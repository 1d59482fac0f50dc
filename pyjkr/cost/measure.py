"""Jobs -> `Costs`: every batch run or found finished, and set beside the right answer."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from pyjkr.cost.impacts import Outcome, execute
from pyjkr.cost.results import Costs
from pyjkr.cost.studies import Job, Jobs
from pyjkr.run import Simulator

# Tells how many jobs are done.
Report = Callable[[int], None]


def measure(jobs: Jobs, directory: Path, simulator: Simulator, report: Report = lambda done: None) -> Costs:
    """Run every job that is not finished, and read all of them.

    Parameters
    ----------
    jobs : Jobs
        What to run.
    directory : Path
        Gets one directory per batch, below `runs/`.
    simulator : Simulator
        LIGGGHTS to use.
    report : callable
        Called with the number of jobs done.

    Raises
    ------
    RunError, DumpError
        At the first run that fails or whose dump cannot be read.
    """
    rows = []
    for done, job in enumerate(jobs.jobs, start=1):
        rows += rows_of(job, execute(job.impacts, directory, simulator))
        report(done)
    return Costs(jobs.scene, pd.DataFrame(rows), tuple(jobs.left_out))


def rows_of(job: Job, outcome: Outcome) -> list[dict[str, Any]]:
    """Lines of the table: one for each phase, with what was run, its errors, its steps and its time; one of a timing."""
    case, phases = job.impacts.case, job.impacts.phases
    run = job.keys | {
        "time_step": case.time_step,
        "run_steps": outcome.steps,
        "computing_time": outcome.computing_time,
        "time_per_step": outcome.computing_time / outcome.steps / len(phases),
    }
    if "turn" in job.keys:
        return [run]
    answer = job.answer(job.impacts.scene, case)
    energy = answer.restitution**2
    rows = []
    for index, phase in enumerate(phases):
        e = float(outcome.restitution[index])
        error = abs(e**2 - energy)
        rows.append(
            run
            | {
                "phase": phase,
                "e": e,
                "e_exact": answer.restitution,
                "e_error": abs(e - answer.restitution),
                "energy_error": error,
                "energy_error_relative": error / energy if energy > 0 else math.nan,
                "decided_wrongly": int(outcome.stuck[index] != answer.stuck),
                "tangential": float(outcome.tangential[index]),
                "tangential_exact": answer.tangential,
                "spin": float(outcome.spin[index]),
                "spin_exact": answer.spin,
            }
        )
    return rows
