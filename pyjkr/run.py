"""Deck -> `Run`: runs a deck with LIGGGHTS and tells whether the run can be trusted.

Covers progress, failures and interruption. A directory whose `run.json` says "complete" for the present deck holds a
whole run; without it, whatever files lie there are those of a run that failed or was stopped.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pyjkr import progress as bars
from pyjkr.errors import RunError
from pyjkr.process import command, lines_of, meaning, program
from pyjkr.screen import TAIL_LINES, Screen
from pyjkr.simulator import Simulator, find_simulator

RECORD = "run.json"


@dataclass(frozen=True)
class Run:
    """A run that ended well.

    Parameters
    ----------
    directory, deck, log
        Where it ran, the deck, and LIGGGHTS' log.
    ranks
        Number of MPI processes.
    exit_status
        0.
    wall_time
        Time from start to end of the program [s].
    loop_time
        Time in the time loop, summed over the `run` commands [s].
    steps
        Time steps, summed over the `run` commands.
    simulator
        LIGGGHTS that ran it, as `Simulator.name`; None where an older `run.json` does not say.
    """

    directory: Path
    deck: Path
    log: Path
    ranks: int
    exit_status: int
    wall_time: float
    loop_time: float
    steps: int
    simulator: str | None = None


def run_deck(
    deck: Path,
    *,
    ranks: int = 1,
    total_steps: int | None = None,
    progress: bool | None = None,
    on_step: Callable[[int], None] | None = None,
    simulator: Simulator | None = None,
    log_name: str = "log.liggghts",
    timeout: float | None = None,
) -> Run:
    """Run a deck in its own directory.

    Parameters
    ----------
    deck
        LIGGGHTS input script.
    ranks
        Number of MPI processes; `mpirun` is used for more than one.
    total_steps
        Time steps of the whole deck, for the progress bar.
    progress
        Show a progress bar on stderr; None shows it on a terminal only.
    on_step
        Called with the step of each line of thermo output.
    simulator
        LIGGGHTS to use; None finds one.
    log_name
        Name of the log, in the deck's directory.
    timeout
        Longest time the run may take [s]; None waits for ever.

    Returns
    -------
    Run
        Also recorded in `run.json`, for `read_run`.

    Raises
    ------
    RunError
        With the deck, the exit status, the ERROR lines and the end of the log: the program fails or is stopped, prints
        NaN or infinity in its thermo output, or loses atoms.
    """
    deck = Path(deck).absolute()
    directory = deck.parent
    log = directory / log_name
    try:
        digest = _sha256(deck)
    except OSError as error:
        raise RunError(f"{deck}: the deck cannot be read: {error.strerror}. Render it first.") from None
    simulator = simulator or find_simulator()
    for stale in (directory / RECORD, log):
        stale.unlink(missing_ok=True)

    words, environment = command(simulator, deck.name, log_name, ranks)
    screen = Screen()
    started = time.monotonic()
    deadline = math.inf if timeout is None else started + timeout
    try:
        with (
            bars.of_run(directory.name, total_steps, progress) as show,
            program(words, environment, directory) as (process, terminal),
        ):
            shown = None
            for line in lines_of(process, terminal, deadline):
                screen.read(line)
                if screen.current_step == shown:
                    continue
                shown = screen.current_step
                show(shown)
                if on_step:
                    on_step(shown)
            status = process.wait(None if timeout is None else max(0.0, deadline - time.monotonic()))
    except (TimeoutError, subprocess.TimeoutExpired):
        raise _failure(deck, log, screen, f"stopped after the {timeout:g} s it was given") from None
    wall_time = time.monotonic() - started
    if status != 0:
        raise _failure(deck, log, screen, meaning(status))
    if screen.errors or screen.faults:
        raise _failure(deck, log, screen, "exit status 0, but " + "; ".join(screen.faults or screen.errors))
    run = Run(directory, deck, log, ranks, status, wall_time, screen.loop_time, screen.steps, simulator.name)
    _record(run, digest)
    return run


def read_run(directory: Path) -> Run | None:
    """Look for a whole run in a directory.

    Parameters
    ----------
    directory
        Where `run_deck` ran.

    Returns
    -------
    Run or None
        None if no run came to its end there, or the deck has changed since.
    """
    directory = Path(directory).absolute()
    try:
        record = json.loads((directory / RECORD).read_text(encoding="utf-8"))
        deck = directory / record["deck"]
        if record["status"] != "complete" or record["deck_sha256"] != _sha256(deck):
            return None
        return Run(
            directory=directory,
            deck=deck,
            log=directory / record["log"],
            ranks=int(record["ranks"]),
            exit_status=int(record["exit_status"]),
            wall_time=float(record["wall_time"]),
            loop_time=float(record["loop_time"]),
            steps=int(record["steps"]),
            simulator=record.get("simulator"),
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _record(run: Run, digest: str) -> None:
    record = {
        "status": "complete",
        "deck": run.deck.name,
        "deck_sha256": digest,
        "log": run.log.name,
        "ranks": run.ranks,
        "exit_status": run.exit_status,
        "wall_time": run.wall_time,
        "loop_time": run.loop_time,
        "steps": run.steps,
        "simulator": run.simulator,
    }
    unfinished = run.directory / f".{RECORD}.{os.getpid()}"
    unfinished.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    unfinished.replace(run.directory / RECORD)


def _sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _failure(deck: Path, log: Path, screen: Screen, what: str) -> RunError:
    try:
        tail = deque(log.read_text(encoding="utf-8", errors="replace").splitlines(), TAIL_LINES)
    except OSError:
        tail = deque()
    # A program that crashes leaves its log unwritten.
    kind, lines = ("log", tail) if tail else ("output", screen.tail)
    errors = [error for error in dict.fromkeys(screen.errors) if error not in what]
    return RunError(
        "\n".join(
            [
                f"{deck}: {what}",
                *errors,
                f"last lines of the {kind}:",
                *(f"    {line}" for line in lines),
                f"whole log: {log}",
            ]
        )
    )
