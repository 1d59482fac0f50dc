"""A program under watch: its command line, its output line by line, and its end, whatever happens.

Covers serial and Open MPI runs. None of the program's processes outlives the block that started it.
"""

from __future__ import annotations

import os
import pty
import select
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pyjkr.errors import RunError
from pyjkr.simulator import Simulator

_POLL_SECONDS = 0.1
# mpirun gives its ranks 2 s to obey SIGTERM before it kills them.
_GRACE_SECONDS = 5.0

# A typing slip must not start a thousand processes; a few a core are slow but harmless.
_RANKS_PER_CORE = 8

# One process without networks: Open MPI starts in a third of the time.
_ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self"}

_SCRATCH = "OMPI_MCA_orte_tmpdir_base"


def command(simulator: Simulator, deck: str, log: str, ranks: int) -> tuple[list[str], dict[str, str]]:
    """Words and environment that start LIGGGHTS on a deck in its own directory."""
    words = [str(simulator.executable), "-in", deck, "-log", log]
    environment = dict(os.environ)
    if ranks == 1:
        # Open MPI looks for networks and starts a daemon for one process too, which takes longer than a small run.
        environment = _ALONE | environment
    preload = None
    if simulator.preload:
        preload = " ".join(filter(None, [str(simulator.preload), environment.get("LD_PRELOAD")]))
    if ranks < 1:
        raise RunError(f"ranks = {ranks} must be >= 1.")
    most = _RANKS_PER_CORE * (os.cpu_count() or 1)
    if ranks > most:
        raise RunError(f"ranks = {ranks} is more than {_RANKS_PER_CORE} a core of this machine ({most}). Ask for fewer.")
    if ranks == 1:
        return words, environment | ({"LD_PRELOAD": preload} if preload else {})
    mpirun = shutil.which("mpirun")
    if mpirun is None:
        raise RunError(f"mpirun not found, needed for {ranks} ranks. Install it with `apt-get install openmpi-bin`.")
    options = ["--oversubscribe", "--bind-to", "none", "-np", str(ranks)]
    if os.getuid() == 0:
        options.insert(0, "--allow-run-as-root")
    if preload:
        # For the ranks alone, not for mpirun itself.
        options += ["-x", f"LD_PRELOAD={preload}"]
    return [mpirun, *options, *words], environment


@contextmanager
def program(command: list[str], environment: dict[str, str], directory: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """The running program and the terminal it prints to; none of its processes outlives the block.

    A terminal rather than a pipe: into a pipe LIGGGHTS prints blocks of many thermo lines at a time.
    """
    # Open MPI keeps one directory for all runs of a user and removes it when empty: a run that starts while another ends
    # may find it gone and stops in MPI_Init. So each run gets its own.
    with (
        tempfile.TemporaryDirectory(prefix="pyjkr-", ignore_cleanup_errors=True) as scratch,
        _started(command, {_SCRATCH: scratch} | environment, directory) as started,
    ):
        yield started


@contextmanager
def _started(command: list[str], environment: dict[str, str], directory: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    try:
        terminal, its_end = pty.openpty()
    except OSError as error:
        raise RunError(f"no terminal for {command[0]}: {error}. Too many programs run on this machine; end some.") from None
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


def lines_of(process: subprocess.Popen[bytes], terminal: int, deadline: float) -> Iterator[str]:
    """What the program prints, line by line until it ends; TimeoutError past the deadline of `time.monotonic`."""
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


def meaning(status: int) -> str:
    """An exit status in words."""
    # A shell, and mpirun, report signal n as 128 + n.
    number = -status if status < 0 else status - 128
    try:
        return f"exit status {status} ({signal.Signals(number).name})"
    except ValueError:
        return f"exit status {status}"
