"""Finished points on disk: one JSON file each, written whole or not at all, under a name that says what decides its rows.

The name is a digest of study, its version, the version of pyjkr and the point: whatever changes one of them asks for a
new evaluation, and going back to earlier settings finds the earlier points again. One sweep at a time owns a directory.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from pyjkr.errors import RunError
from pyjkr.sweep.file import Sweep

POINTS = "points"
LOCK = "lock"
FAILURE = "error.txt"
# Hexadecimal digits of a key: 64 bits, two of a million points meet with a probability of 3e-8.
DIGITS = 16


@dataclass(frozen=True)
class Finished:
    """Rows of a point, and how long they took [s]."""

    rows: list[dict[str, Any]]
    seconds: float


@dataclass(frozen=True)
class Store:
    """The finished points of one sweep in a directory."""

    directory: Path
    study: str
    version: int

    @classmethod
    def of(cls, sweep: Sweep, directory: Path) -> Store:
        """That of a sweep whose output goes to a directory."""
        return cls(Path(directory).absolute() / POINTS, sweep.study, sweep.module.VERSION)

    def key(self, point: dict[str, Any]) -> str:
        """Name of a point's file and directory."""
        text = json.dumps(self._what(point), sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]

    def place(self, point: dict[str, Any]) -> Path:
        """Directory of a point's own files."""
        return self.directory / self.key(point)

    def read(self, point: dict[str, Any]) -> Finished | None:
        """A finished point; None where it is missing, damaged or of another point."""
        try:
            kept = json.loads(self._file(point).read_text(encoding="utf-8"))
            what = self._what(point)
            rows = kept["rows"]
            if {key: kept[key] for key in what} != what or not all(isinstance(row, dict) for row in rows):
                return None
            return Finished(rows, float(kept["seconds"]))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def write(self, point: dict[str, Any], finished: Finished) -> None:
        """Keep a finished point."""
        (self.place(point) / FAILURE).unlink(missing_ok=True)
        text = json.dumps(self._what(point) | {"seconds": finished.seconds, "rows": finished.rows}, indent=1)
        write_whole(self._file(point), text + "\n")

    def write_failure(self, point: dict[str, Any], text: str) -> Path:
        """Leave what is known about a failure in the point's directory."""
        file = self.place(point) / FAILURE
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text + "\n", encoding="utf-8")
        return file

    def _file(self, point: dict[str, Any]) -> Path:
        return self.directory / f"{self.key(point)}.json"

    def _what(self, point: dict[str, Any]) -> dict[str, Any]:
        return {"study": self.study, "version": self.version, "pyjkr": pyjkr_version(), "point": point}


@contextmanager
def owned(directory: Path) -> Iterator[None]:
    """Keeps other sweeps out of a directory; the system takes the lock back from a process that is killed.

    Raises
    ------
    RunError
        Where another sweep is at work there.
    """
    (directory / POINTS).mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(directory / POINTS / LOCK, timeout=0):
            yield
    except Timeout:
        raise RunError(f"{directory}: another sweep is at work there. Wait for its end, or choose another directory with -o.") from None


def write_whole(file: Path, text: str) -> None:
    """Write a file beside, then move it into place: nobody sees half of it."""
    unfinished = file.with_name(f".{file.name}.{os.getpid()}")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(file)


def pyjkr_version() -> str:
    """Version of the package; "source" where it is used without being installed."""
    try:
        return importlib.metadata.version("pyjkr")
    except importlib.metadata.PackageNotFoundError:
        return "source"
