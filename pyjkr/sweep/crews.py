"""Who evaluates the points: processes on this machine, or the workers of a Dask cluster.

Both take points through `submit` and hand back `concurrent.futures.Future`s. `close` is for the end of the work, `abort` for
its interruption: it ends what this machine runs, and tells a cluster to forget what it has not begun.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any, Protocol

from pyjkr.errors import RunError
from pyjkr.sweep import working
from pyjkr.sweep.store import pyjkr_version

# How long a scheduler may take to answer, and a cluster to show its first worker [s].
ANSWER_SECONDS = 5.0
WORKER_SECONDS = 30.0
# A worker that is told to end gives its LIGGGHTS 5 s to end (pyjkr.process); then it is killed [s].
END_SECONDS = 8.0


class Crew(Protocol):
    """Evaluates points."""

    # How many points to hand over at a time; None for all.
    width: int | None

    def submit(self, task: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin one."""

    def restart(self) -> None:
        """Go on after a worker has died."""

    def close(self) -> None:
        """End after the work."""

    def abort(self) -> None:
        """End in the middle of it."""


def crew(workers: int | None, scheduler: str | None) -> Crew:
    """The crew that a user asks for: that of a scheduler where one is named."""
    return Cluster(scheduler) if scheduler else Processes(workers or cores())


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Processes:
    """Worker processes on this machine."""

    def __init__(self, workers: int) -> None:
        self.width: int | None = workers
        self._others = multiprocessing.active_children()
        self._scratch = tempfile.TemporaryDirectory(prefix="pyjkr-", ignore_cleanup_errors=True)
        self._start()

    def _start(self) -> None:
        # Spawned: forked workers would inherit the threads' locks of the progress bar and of numerical libraries.
        context = multiprocessing.get_context("spawn")
        begin = {"initializer": working.begin_worker, "initargs": (self._scratch.name,)}
        self._executor = ProcessPoolExecutor(self.width, mp_context=context, **begin)

    def submit(self, task: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin one point."""
        with _interrupts_later():
            return self._executor.submit(task, *arguments)

    def restart(self) -> None:
        """New processes in place of those that a dead one has taken with it."""
        self._end()
        self._start()

    def close(self) -> None:
        """End the processes after the work."""
        self._executor.shutdown()
        self._scratch.cleanup()

    def abort(self) -> None:
        """End the processes and the LIGGGHTS that they run."""
        self._end()
        self._scratch.cleanup()

    def _end(self) -> None:
        self._executor.shutdown(wait=False, cancel_futures=True)
        mine = [process for process in multiprocessing.active_children() if process not in self._others]
        for process in mine:
            process.terminate()
        deadline = time.monotonic() + END_SECONDS
        for process in mine:
            process.join(max(0.0, deadline - time.monotonic()))
            if process.is_alive():
                process.kill()
                process.join()


@contextmanager
def _interrupts_later() -> Iterator[None]:
    """Holds Ctrl-C back: a worker that starts is to find it blocked until it has its own handler."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Cluster:
    """The workers of a Dask scheduler. They need the same pyjkr and LIGGGHTS, not the same files."""

    width: int | None = None

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client
            from distributed.comm import resolve_address
        except ImportError:
            raise RunError("--scheduler needs Dask. Install it with `pip install 'pyjkr[cluster]'`.") from None
        try:
            # A client with an address that it cannot read is left half open, and complains when it is cleared away.
            resolve_address(address)
            self._client = Client(address, timeout=ANSWER_SECONDS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise RunError(f"scheduler {address}: no answer ({reason}). Start it with `dask scheduler`, or correct the address.") from None
        try:
            self._meet(address)
        except BaseException:
            self._client.close(timeout=ANSWER_SECONDS)
            raise
        self._executor = self._client.get_executor(pure=False)
        self._futures: list[Future[Any]] = []

    def _meet(self, address: str) -> None:
        """Refuse workers that cannot evaluate a point as this machine would."""
        try:
            self._client.wait_for_workers(1, timeout=WORKER_SECONDS)
        except TimeoutError:
            raise RunError(f"scheduler {address}: no worker after {WORKER_SECONDS:g} s. Start one with `dask worker {address}`.") from None
        try:
            versions = self._client.run(pyjkr_version)
        except Exception as error:
            reason = (str(error) or type(error).__name__).splitlines()[0]
            raise RunError(f"scheduler {address}: its workers cannot run pyjkr ({reason}). Install {pyjkr_version()} there.") from None
        for worker, version in versions.items():
            if version != pyjkr_version():
                raise RunError(f"worker {worker} has pyjkr {version}, this machine {pyjkr_version()}. Install the same on both.")

    def submit(self, task: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Begin one point."""
        future = self._executor.submit(task, *arguments)
        self._futures.append(future)
        return future

    def restart(self) -> None:
        """Nothing: the scheduler replaces its workers."""

    def close(self) -> None:
        """Leave the cluster as it was."""
        self._client.close(timeout=ANSWER_SECONDS)

    def abort(self) -> None:
        """Forget what has not begun; what a worker runs comes to its end."""
        for future in self._futures:
            future.cancel()
        self.close()
