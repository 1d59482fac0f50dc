"""What runs in a worker: one point evaluated, failures handed back as values; and the life of a local worker.

A worker outlives neither an interrupt nor its parent, and takes the LIGGGHTS it runs with it.
"""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import shutil
import signal
import threading
import time
import traceback
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, NoReturn


class _Ended(BaseException):
    """The worker was told to end."""


# Of this process; read by local workers only, which do one thing at a time.
_under_way = threading.Event()


def evaluate(module: str, point: dict[str, Any], directory: str) -> dict[str, Any]:
    """Evaluate one point in its own directory.

    Parameters
    ----------
    module : str
        Full name of the study's module.
    point : dict
        As the study made it.
    directory : str
        The point's own; made where it is missing, also on another machine.

    Returns
    -------
    dict
        `rows` as they come back from JSON, and `seconds`; or `error`, one message, and `traceback`. A failure is a
        value, because not every exception survives the way from one process to another.
    """
    started = time.perf_counter()
    try:
        _under_way.set()
        Path(directory).mkdir(parents=True, exist_ok=True)
        rows = importlib.import_module(module).evaluate(point, Path(directory))
        return {"rows": json.loads(json.dumps(rows, default=_plain)), "seconds": time.perf_counter() - started}
    except _Ended:
        os._exit(1)
    except Exception as error:
        message = str(error) or "no message"
        kind = "" if type(error).__module__.startswith("pyjkr.") else f"{type(error).__name__}: "
        return {"error": kind + message, "traceback": traceback.format_exc()}
    finally:
        _under_way.clear()


def _plain(value: Any) -> Any:
    """numpy's numbers as Python's."""
    if hasattr(value, "item"):
        return value.item()
    raise TypeError(f"a row holds a {type(value).__name__}, which JSON cannot; rows are flat dicts of numbers, texts and booleans")


def begin_worker(scratch: str) -> None:
    """Prepare a process of the pool.

    Parameters
    ----------
    scratch : str
        Directory for what its programs leave for a moment.
    """
    # Open MPI keeps a directory for all runs of a user and removes it when empty: a run that starts while another ends may
    # find it gone and stops in MPI_Init. A directory of its own for each worker, which runs one LIGGGHTS at a time.
    own = Path(scratch) / str(os.getpid())
    own.mkdir(parents=True, exist_ok=True)
    os.environ["OMPI_MCA_orte_tmpdir_base"] = str(own)  # noqa: SIM112 - Open MPI's own spelling
    # Ctrl-C reaches the whole group of the terminal; the parent decides. A handler, not SIG_IGN: LIGGGHTS would inherit that.
    signal.signal(signal.SIGINT, lambda number, frame: None)
    signal.signal(signal.SIGTERM, _end)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    threading.Thread(target=_end_with_parent, args=(scratch,), daemon=True).start()


def _end(number: int, frame: Any) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if not _under_way.is_set():
        os._exit(1)
    # Unwinds the evaluation, which ends the LIGGGHTS that it runs.
    raise _Ended


def _end_with_parent(scratch: str) -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        shutil.rmtree(scratch, ignore_errors=True)
        os.kill(os.getpid(), signal.SIGTERM)
