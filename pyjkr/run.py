"""Deck -> `Run`: finds LIGGGHTS with the jkr styles, runs a deck with it and tells whether the run can be trusted.

Covers serial and Open MPI runs, progress, failures and interruption. A directory whose `run.json` says "complete" for the
present deck holds a whole run; without it, whatever files lie there are those of a run that failed or was stopped.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from pyjkr.errors import RunError

LAUNCHER = "liggghts-jkr"
PLUGIN = "libliggghts_jkr.so"
RECORD = "run.json"

_TAIL_LINES = 15
_POLL_SECONDS = 0.1
# mpirun gives its ranks 2 s to obey SIGTERM before it kills them.
_GRACE_SECONDS = 5.0
_LOOP = re.compile(r"Loop time of (\S+) on \d+ procs for (\d+) steps")
_MULTI_LINE_STEP = re.compile(r"-+ Step +(\d+) -")
_MULTI_LINE_VALUE = re.compile(r"\w+ += +(\S+)")


@dataclass(frozen=True)
class Simulator:
    """A LIGGGHTS to run decks with.

    Parameters
    ----------
    executable
        Program with the command line of `liggghts`.
    preload
        Shared object to load into it, or None.
    plugin
        Whether the jkr styles are there.
    """

    executable: Path
    preload: Path | None = None
    plugin: bool = False


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
    """

    directory: Path
    deck: Path
    log: Path
    ranks: int
    exit_status: int
    wall_time: float
    loop_time: float
    steps: int


# --- which simulator --------------------------------------------------------------------------------------------------


def find_simulator() -> Simulator:
    """Find a LIGGGHTS that has the jkr styles.

    Returns
    -------
    Simulator
        The first of: the program that `PYJKR_LIGGGHTS` names; `liggghts-jkr` beside this Python, inside the package, on
        the PATH, in `build/` of a source checkout; the stock `liggghts` with the plug-in inside the package preloaded.

    Raises
    ------
    RunError
        If there is none, or `PYJKR_LIGGGHTS` does not name a program.
    """
    package = Path(__file__).resolve().parent
    if named := os.environ.get("PYJKR_LIGGGHTS"):
        program = shutil.which(named)
        if program is None:
            raise RunError(f"PYJKR_LIGGGHTS={named}: not a program that can be run. Correct the variable, or unset it.")
        return Simulator(Path(program).absolute(), plugin=Path(program).name.startswith(LAUNCHER))
    on_path = shutil.which(LAUNCHER)
    candidates = [
        # Not resolved: in a virtual environment the interpreter is a link to the system's.
        Path(sys.executable).parent / LAUNCHER,
        package / "bin" / LAUNCHER,
        package / LAUNCHER,
        *([Path(on_path)] if on_path else []),
        package.parent / "build" / LAUNCHER,
    ]
    for candidate in candidates:
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return Simulator(candidate.absolute(), plugin=True)
    stock = shutil.which("liggghts")
    for plugin in (package / "lib" / PLUGIN, package / PLUGIN):
        if stock and plugin.is_file():
            return Simulator(Path(stock), preload=plugin, plugin=True)
    raise RunError(
        f"{LAUNCHER} not found beside {sys.executable}, on the PATH or in build/. "
        "Install it with `apt-get install libliggghts-dev` and `pip install .`, or type `make run` in the source directory."
    )


# --- what it says -----------------------------------------------------------------------------------------------------


@dataclass
class _Screen:
    """What LIGGGHTS has printed so far, read line by line."""

    steps: int = 0
    loop_time: float = 0.0
    current_step: int | None = None
    errors: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    tail: deque[str] = field(default_factory=lambda: deque(maxlen=_TAIL_LINES))
    _header: list[str] = field(default_factory=list)
    _multi_line: bool = False

    def read(self, line: str) -> None:
        self.tail.append(line)
        words = line.split()
        if "ERROR" in line:
            self.errors.append(line)
        elif "Lost atoms" in line:
            self._fault(line)
        elif "SIGINT/SIGTERM caught" in line:
            # LIGGGHTS then stops, prints the loop time of all the steps that were asked for, and exits with status 0.
            self._fault("stopped by a signal before its end")
        elif loop := _LOOP.search(line):
            self.loop_time += float(loop[1])
            self.steps += int(loop[2])
            self._header, self._multi_line = [], False
        elif "Step" in words and all(word[0].isalpha() for word in words):
            self._header = words
        elif multi := _MULTI_LINE_STEP.match(line):
            self.current_step, self._multi_line = int(multi[1]), True
        elif self._header and len(words) == len(self._header) and all(map(_is_number, words)):
            self.current_step = int(words[self._header.index("Step")])
            self._refuse_nonfinite(words, ", ".join(map(" = ".join, zip(self._header, words, strict=True))))
        elif self._multi_line:
            self._refuse_nonfinite(_MULTI_LINE_VALUE.findall(line), line)

    def _refuse_nonfinite(self, values: list[str], shown: str) -> None:
        if any(_is_number(value) and not math.isfinite(float(value)) for value in values):
            self._fault(f"thermo output is not finite at step {self.current_step}: {shown}")

    def _fault(self, what: str) -> None:
        if len(self.faults) < 3:
            self.faults.append(what)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


# --- run --------------------------------------------------------------------------------------------------------------


def run_deck(
    deck: Path,
    *,
    ranks: int = 1,
    total_steps: int | None = None,
    progress: bool | None = None,
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

    command, environment = _command(simulator, deck.name, log_name, ranks)
    screen = _Screen()
    started = time.monotonic()
    deadline = math.inf if timeout is None else started + timeout
    try:
        with (
            _bar(deck, total_steps, progress) as show,
            _program(command, environment, directory) as (process, terminal),
        ):
            for line in _lines(process, terminal, deadline):
                screen.read(line)
                show(screen.current_step)
            status = process.wait(None if timeout is None else max(0.0, deadline - time.monotonic()))
    except (TimeoutError, subprocess.TimeoutExpired):
        raise _failure(deck, log, screen, f"stopped after the {timeout:g} s it was given") from None
    wall_time = time.monotonic() - started
    if status != 0:
        raise _failure(deck, log, screen, _meaning(status))
    if screen.errors or screen.faults:
        raise _failure(deck, log, screen, "exit status 0, but " + "; ".join(screen.faults or screen.errors))
    run = Run(directory, deck, log, ranks, status, wall_time, screen.loop_time, screen.steps)
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
    }
    unfinished = run.directory / f".{RECORD}.{os.getpid()}"
    unfinished.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    unfinished.replace(run.directory / RECORD)


def _sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


# --- the program ------------------------------------------------------------------------------------------------------


def _command(simulator: Simulator, deck: str, log: str, ranks: int) -> tuple[list[str], dict[str, str]]:
    command = [str(simulator.executable), "-in", deck, "-log", log]
    environment = dict(os.environ)
    preload = None
    if simulator.preload:
        preload = " ".join(filter(None, [str(simulator.preload), environment.get("LD_PRELOAD")]))
    if ranks < 1:
        raise RunError(f"ranks = {ranks} must be >= 1.")
    if ranks == 1:
        return command, environment | ({"LD_PRELOAD": preload} if preload else {})
    mpirun = shutil.which("mpirun")
    if mpirun is None:
        raise RunError(f"mpirun not found, needed for {ranks} ranks. Install it with `apt-get install openmpi-bin`.")
    options = ["--oversubscribe", "--bind-to", "none", "-np", str(ranks)]
    if os.getuid() == 0:
        options.insert(0, "--allow-run-as-root")
    if preload:
        # For the ranks alone, not for mpirun itself.
        options += ["-x", f"LD_PRELOAD={preload}"]
    return [mpirun, *options, *command], environment


@contextmanager
def _program(command: list[str], environment: dict[str, str], directory: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """The running program and the terminal it prints to; none of its processes outlives the block.

    A terminal rather than a pipe: into a pipe LIGGGHTS prints blocks of many thermo lines at a time.
    """
    terminal, its_end = pty.openpty()
    try:
        process = subprocess.Popen(
            command,
            cwd=directory,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=its_end,
            stderr=its_end,
            start_new_session=True,
        )
    except OSError as error:
        os.close(terminal)
        raise RunError(f"{command[0]}: cannot be started: {error.strerror}. Install LIGGGHTS again.") from None
    finally:
        os.close(its_end)
    try:
        yield process, terminal
    finally:
        try:
            _end(process)
        finally:
            os.close(terminal)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End what is left of the program: SIGINT, which LIGGGHTS obeys at its next step, then SIGKILL."""
    if process.poll() is None:
        _signal_group(process.pid, signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE_SECONDS)
    # Ranks that outlive mpirun: Open MPI puts each into a group of its own, but leaves them in its session.
    for group in {process.pid} | _groups_of_session(process.pid):
        _signal_group(group, signal.SIGKILL)
    process.wait()


def _signal_group(group: int, number: signal.Signals) -> None:
    # It may have ended by itself; macOS says "not permitted" of a group of zombies.
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(group, number)


def _groups_of_session(session: int) -> set[int]:
    groups = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            # pid (name) state parent group session ...; the name may hold blanks and brackets.
            fields = stat.read_text(errors="replace").rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session:
            groups.add(int(fields[2]))
    return groups


def _lines(process: subprocess.Popen[bytes], terminal: int, deadline: float) -> Iterator[str]:
    rest = b""
    while True:
        if time.monotonic() > deadline:
            raise TimeoutError
        ended = process.poll() is not None
        ready, _, _ = select.select([terminal], [], [], 0.0 if ended else _POLL_SECONDS)
        if not ready:
            if ended:
                break
            continue
        try:
            chunk = os.read(terminal, 1 << 16)
        except OSError:  # EIO: nobody holds the other end any more.
            break
        if not chunk:
            break
        *lines, rest = (rest + chunk).split(b"\n")
        # LIGGGHTS prints stray bytes in some error messages.
        yield from (line.decode("utf-8", "replace").rstrip() for line in lines)
    if rest:
        yield rest.decode("utf-8", "replace").rstrip()


# --- what is shown ----------------------------------------------------------------------------------------------------


class _Rate(ProgressColumn):
    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f} steps/s")


@contextmanager
def _bar(deck: Path, total_steps: int | None, wanted: bool | None) -> Iterator[Callable[[int | None], None]]:
    """A function that shows the current step."""
    if not (sys.stderr.isatty() if wanted is None else wanted):
        yield lambda step: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _Rate(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(deck.parent.name, total=total_steps)
        shown: int | None = None

        def show(step: int | None) -> None:
            nonlocal shown
            if step is not None and step != shown:
                shown = step
                bar.update(task, completed=step)

        yield show


def _meaning(status: int) -> str:
    # A shell, and mpirun, report signal n as 128 + n.
    number = -status if status < 0 else status - 128
    try:
        return f"exit status {status} ({signal.Signals(number).name})"
    except ValueError:
        return f"exit status {status}"


def _failure(deck: Path, log: Path, screen: _Screen, what: str) -> RunError:
    try:
        tail = deque(log.read_text(encoding="utf-8", errors="replace").splitlines(), _TAIL_LINES)
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
