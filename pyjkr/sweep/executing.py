"""`Sweep` -> `Execution`: every point that is not finished evaluated, each kept as soon as it is done.

A point that fails is noted and does not stop the others. A worker that dies takes the points under way with it: each of
these is tried once more, alone, so that the one to blame is known.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import pandas as pd

from pyjkr.sweep import working
from pyjkr.sweep.crews import Crew, crew
from pyjkr.sweep.file import Sweep, module_name
from pyjkr.sweep.store import Finished, Store

Point = dict[str, Any]
# Told how many points are finished and how many have failed.
Watcher = Callable[[int, int], None]


@dataclass(frozen=True)
class Failure:
    """A point without rows.

    Attributes
    ----------
    label : str
        The point's own, or its numbers.
    message : str
        First line of what went wrong.
    file : Path
        All that is known about it.
    """

    label: str
    message: str
    file: Path


@dataclass(frozen=True)
class Execution:
    """What became of the points of a sweep.

    Attributes
    ----------
    table : DataFrame
        Rows of all finished points, in the order of the points.
    failures : tuple of Failure
        Points without rows.
    points : int
        How many there are.
    reused : int
        Points that were finished before.
    seconds : float
        Time spent on the finished points, in whatever run [s].
    """

    table: pd.DataFrame
    failures: tuple[Failure, ...]
    points: int
    reused: int
    seconds: float


def execute(
    sweep: Sweep,
    directory: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    watcher: Watcher = lambda finished, failed: None,
) -> Execution:
    """Evaluate every point that is not finished. The caller owns the directory (`store.owned`).

    Parameters
    ----------
    sweep : Sweep
        What to evaluate.
    directory : Path
        Gets `points/`, with one JSON file and one directory per point.
    workers : int or None
        Processes on this machine; None takes one per core.
    scheduler : str or None
        Address of a Dask scheduler, in place of processes on this machine.
    watcher : callable
        Told at the start and after each point how many are finished and how many have failed.

    Raises
    ------
    PyjkrError
        Where the settings leave no points, or there is no scheduler at the address.
    KeyboardInterrupt
        After the workers have ended; finished points are kept.
    """
    points, store = sweep.points, Store.of(sweep, directory)
    finished = {index: kept for index, point in enumerate(points) if (kept := store.read(point)) is not None}
    work = _Work(points, store, module_name(sweep.study), watcher, finished, deque(i for i in range(len(points)) if i not in finished))
    reused = len(finished)
    watcher(reused, 0)
    if work.waiting:
        hands = crew(workers, scheduler)
        try:
            work.run(hands)
        except BaseException:
            hands.abort()
            raise
        hands.close()
    rows = [row for _, kept in sorted(work.finished.items()) for row in kept.rows]
    return Execution(
        table=pd.DataFrame(rows),
        failures=tuple(failure for _, failure in sorted(work.failed.items())),
        points=len(points),
        reused=reused,
        seconds=sum(kept.seconds for kept in work.finished.values()),
    )


@dataclass
class _Work:
    """Points by their index: waiting, suspected of having killed a worker, under way, finished, failed."""

    points: list[Point]
    store: Store
    module: str
    watcher: Watcher
    finished: dict[int, Finished]
    waiting: deque[int]
    suspects: deque[int] = field(default_factory=deque)
    under_way: dict[Future[Any], int] = field(default_factory=dict)
    failed: dict[int, Failure] = field(default_factory=dict)
    done: SimpleQueue[Future[Any]] = field(default_factory=SimpleQueue)
    alone: bool = False

    def run(self, hands: Crew) -> None:
        while self.waiting or self.suspects or self.under_way:
            lost = not self._hand_out(hands)
            while self.under_way:
                future = self.done.get()
                lost |= not self._take(self.under_way.pop(future), future)
                # Every future of a broken pool fails: they are all awaited, and what they held is suspect.
                if not lost:
                    break
            if lost:
                hands.restart()

    def _hand_out(self, hands: Crew) -> bool:
        """Keep the crew busy; False where it has lost a worker."""
        if self.under_way and self.alone:
            return True
        self.alone = bool(self.suspects) and not self.under_way
        queue = self.suspects if self.alone else self.waiting
        width = 1 if self.alone else hands.width
        while queue and (width is None or len(self.under_way) < width):
            point = self.points[queue[0]]
            try:
                future = hands.submit(working.evaluate, self.module, point, str(self.store.place(point)))
            except BrokenExecutor:
                return False
            self.under_way[future] = queue.popleft()
            future.add_done_callback(self.done.put)
        return True

    def _take(self, index: int, future: Future[Any]) -> bool:
        """Keep what a point gave; False where its worker died."""
        point = self.points[index]
        try:
            answer = future.result()
        except BrokenExecutor:
            if self.alone:
                self._fail(index, "its worker died: killed, out of memory, or a crash in compiled code", "")
            else:
                self.suspects.append(index)
            return False
        except CancelledError:
            self._fail(index, "the scheduler dropped it: is it still there?", "")
            return True
        except Exception as error:
            # Of the cluster, not of the study, whose exceptions come as values.
            self._fail(index, f"{type(error).__name__}: {error}", "")
            return True
        if "error" in answer:
            self._fail(index, answer["error"], answer["traceback"])
            return True
        self.finished[index] = Finished(answer["rows"], answer["seconds"])
        self.store.write(point, self.finished[index])
        self.watcher(len(self.finished), len(self.failed))
        return True

    def _fail(self, index: int, message: str, trace: str) -> None:
        point = self.points[index]
        label = str(point.get("label") or ", ".join(f"{key} = {value}" for key, value in point.items())[:100])
        file = self.store.write_failure(point, f"{label}\n{message}\n\n{trace}".rstrip())
        self.failed[index] = Failure(label, message.splitlines()[0], file)
        self.watcher(len(self.finished), len(self.failed))
