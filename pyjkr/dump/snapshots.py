"""Dump files -> `Snapshot`: files found and unpacked, headers read, the text of the rows left as it is.

Layout: LIGGGHTS manual, `dump`. A file that is cut short or damaged is refused with the line.
"""

from __future__ import annotations

import glob
import gzip
import math
import os
import re
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from pyjkr.errors import DumpError

Bounds = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
Paths = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]

_GZIP_MAGIC = b"\x1f\x8b"
_SINGLE_VALUE_ITEMS = frozenset({"TIMESTEP", "TIME", "UNITS", "LABEL"})


@dataclass(frozen=True)
class Source:
    """The text of one file, and how to say where in it something is wrong."""

    path: Path
    text: bytes

    def fail(self, offset: int, what: str) -> NoReturn:
        line = self.text.count(b"\n", 0, offset) + 1
        raise DumpError(f"{self.path}:{line}: {what}")


@dataclass(frozen=True)
class Snapshot:
    """Header of one snapshot, and where its rows start and end in the file."""

    source: Source
    offset: int
    step: int
    box: Bounds
    count: int
    columns: tuple[str, ...]
    start: int
    end: int

    @property
    def body(self) -> bytes:
        return self.source.text[self.start : self.end]


def expand(path: Paths) -> list[Path]:
    if not isinstance(path, (str, os.PathLike)):
        files = [Path(p) for p in path]
        if not files:
            raise DumpError("no dump file given: the list of files is empty. Name at least one.")
        return files
    file = Path(path)
    if file.exists() or not glob.has_magic(str(file)):
        return [file]
    files = sorted(Path(match) for match in glob.glob(str(file)))
    if not files:
        raise DumpError(f"{file}: no file matches this pattern. Has the simulation run, and written its dump here?")
    return files


def load(path: Path) -> Source:
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        raise DumpError(f"{path}: no such file. Has the simulation run, and written its dump here?") from None
    except OSError as error:
        raise DumpError(f"{path}: cannot be read: {error.strerror}. Name a dump file.") from None
    if raw.startswith(_GZIP_MAGIC):
        try:
            raw = gzip.decompress(raw)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise DumpError(f"{path}: gzip data cut short or damaged ({error}). Write or copy the file again.") from None
    source = Source(path, raw)
    if not raw.strip():
        raise DumpError(f"{path}: the file is empty. Did the run stop before its first dump?")
    if b"\0" in raw[:4096]:
        raise DumpError(f"{path}: a binary file, not a text dump. Let FILE in `dump ID all custom N FILE ...` not end in .bin.")
    if not raw.startswith(b"ITEM:"):
        source.fail(0, "a dump starts with 'ITEM: TIMESTEP', this file does not. Name a file of `dump custom` or `dump local`.")
    return source


def snapshots_of(source: Source) -> Iterator[Snapshot]:
    position = 0
    while position < len(source.text):
        snapshot = _snapshot(source, position)
        yield snapshot
        position = snapshot.end


def _line(source: Source, position: int) -> tuple[str, int]:
    end = source.text.find(b"\n", position)
    if end < 0:
        source.fail(position, "the file ends inside a snapshot. Run the simulation again, or cut this snapshot off.")
    return source.text[position:end].decode("ascii", "replace").strip(), end + 1


def _snapshot(source: Source, offset: int) -> Snapshot:
    step: int | None = None
    count: int | None = None
    box: Bounds | None = None
    kind = ""
    position = offset
    while True:
        here = position
        line, position = _line(source, position)
        if not line.startswith("ITEM: "):
            source.fail(here, f"expected a line 'ITEM: ...' of a snapshot's header, found '{line[:60]}'. The file is damaged.")
        item = line.removeprefix("ITEM: ")
        if item == "TIMESTEP" and step is None:
            here = position
            line, position = _line(source, position)
            step = _whole_number(source, here, line, "a time step")
        elif item in _SINGLE_VALUE_ITEMS - {"TIMESTEP"}:
            _, position = _line(source, position)
        elif item.startswith("NUMBER OF ") and count is None:
            kind = item.removeprefix("NUMBER OF ")
            here = position
            line, position = _line(source, position)
            count = _whole_number(source, here, line, f"the number of {kind.lower()}")
        elif item.startswith("BOX BOUNDS") and box is None:
            box, position = _bounds(source, position)
        elif kind and (item == kind or item.startswith(kind + " ")):
            columns = tuple(item.removeprefix(kind).split())
            break
        else:
            source.fail(here, f"'{line[:60]}' does not belong here in a snapshot's header. The file is damaged.")
    if step is None or box is None or count is None:
        source.fail(here, f"the header above lacks {'TIMESTEP' if step is None else 'BOX BOUNDS'}. The file is damaged.")
    if not columns or len(set(columns)) < len(columns):
        source.fail(here, f"column names missing or repeated in '{line[:80]}'. Name every column once in the dump command.")
    end = _end_of_rows(source, position)
    snapshot = Snapshot(source, offset, step, box, count, columns, position, end)
    rows = source.text.count(b"\n", position, end)
    if end == len(source.text) and end > position and source.text[end - 1] != ord("\n"):
        source.fail(end, f"step {step}: the file ends inside a row. Run the simulation again, or cut this snapshot off.")
    if rows < count:
        source.fail(
            end - 1, f"step {step}: {rows} rows of {count} promised. The file is cut short: run again, or cut this step off."
        )
    if rows > count:
        source.fail(end - 1, f"step {step}: {rows} rows where {count} were promised. This header or the next is damaged.")
    return snapshot


def _end_of_rows(source: Source, start: int) -> int:
    if source.text.startswith(b"ITEM:", start):
        return start
    end = source.text.find(b"\nITEM:", start)
    return len(source.text) if end < 0 else end + 1


def _whole_number(source: Source, offset: int, text: str, what: str) -> int:
    if not re.fullmatch(r"\d{1,18}", text):
        source.fail(offset, f"expected {what}, found '{text[:60]}'. The header is damaged.")
    return int(text)


def _bounds(source: Source, position: int) -> tuple[Bounds, int]:
    bounds = []
    for axis in "xyz":
        here = position
        line, position = _line(source, position)
        try:
            # A third number is the tilt of a triclinic box, whose first two bound it.
            low, high, *_ = (float(word) for word in line.split())
        except ValueError:
            low, high = math.inf, -math.inf
        if not -math.inf < low <= high < math.inf:
            source.fail(here, f"expected the bounds of the box along {axis}, found '{line[:60]}'. The header is damaged.")
        bounds.append((low, high))
    return (bounds[0], bounds[1], bounds[2]), position
