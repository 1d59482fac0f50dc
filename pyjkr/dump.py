"""Dump files of LIGGGHTS (`dump custom` and `dump local`, plain or gzip) to tidy `pandas.DataFrame`.

Layout: LIGGGHTS manual, `dump` and `compute pair/gran/local`; the columns of the two computes were read off real runs of 3.8.
Assumes text dumps in SI units; a file is read whole or refused, never in part.
"""

from __future__ import annotations

import csv
import glob
import gzip
import io
import math
import os
import re
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pandas as pd

from pyjkr.errors import DumpError

Bounds = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
Paths = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]

INTEGER_COLUMNS = frozenset({"id", "type", "mol", "proc", "ix", "iy", "iz", "index", "id_multisphere"})
TEXT_COLUMNS = frozenset({"element"})

_GZIP_MAGIC = b"\x1f\x8b"
_SINGLE_VALUE_ITEMS = frozenset({"TIMESTEP", "TIME", "UNITS", "LABEL"})
# Bytes of rows handed to the C parser at once: bounds the memory of the checks, and spares a call per snapshot.
_BLOCK_BYTES = 1 << 24
# pandas 3 parses decimal numbers to the nearest float by itself, and deprecates the option that older ones need for it.
_EXACT: dict[str, Any] = {"float_precision": "round_trip"} if int(pd.__version__.split(".")[0]) < 3 else {}


@dataclass(frozen=True)
class _Source:
    """The text of one file, and how to say where in it something is wrong."""

    path: Path
    text: bytes

    def fail(self, offset: int, what: str) -> NoReturn:
        line = self.text.count(b"\n", 0, offset) + 1
        raise DumpError(f"{self.path}:{line}: {what}")


@dataclass(frozen=True)
class _Snapshot:
    """Header of one snapshot, and where its rows start and end in the file."""

    source: _Source
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


def read(path: Paths, *, allow_nonfinite: bool = False) -> pd.DataFrame:
    """Read text dumps of `dump custom` or `dump local` into one tidy frame.

    Parameters
    ----------
    path
        A file, a glob pattern, or several files; each plain or gzip (told by content) with any number of snapshots.
    allow_nonfinite
        Keep NaN and infinite values instead of refusing the file.

    Returns
    -------
    pandas.DataFrame
        One row per snapshot and entry, snapshots in order of time: `step` and the columns of the dump under their own
        names. `step`, `id`, `type` and their like are int64, `element` is text, everything else float64.
        `attrs["box"]` maps each step, those without entries too, to ((xlo, xhi), (ylo, yhi), (zlo, zhi)) [m].
        A step written twice with the same content counts once.

    Raises
    ------
    DumpError
        With file, line and remedy: a file that is missing, empty, binary, cut short or damaged; a step written twice
        with different content; an atom twice in one step; a value that is not a number or not finite.
    """
    snapshots = [snapshot for file in _expand(path) for snapshot in _snapshots(_load(file))]
    snapshots = _in_order_of_time(snapshots)
    columns = snapshots[0].columns
    for snapshot in snapshots:
        if snapshot.columns != columns:
            snapshot.source.fail(
                snapshot.offset,
                f"step {snapshot.step} has columns '{' '.join(snapshot.columns)}', earlier ones '{' '.join(columns)}'. "
                "Read dumps of different layout one by one.",
            )
    frame = pd.concat([_parse(block, allow_nonfinite) for block in _blocks(snapshots)], ignore_index=True)
    frame.insert(0, "step", np.repeat([s.step for s in snapshots], [s.count for s in snapshots]).astype(np.int64))
    _refuse_repeated_atoms(frame, snapshots)
    frame.attrs["box"] = {snapshot.step: snapshot.box for snapshot in snapshots}
    return frame


# --- files ------------------------------------------------------------------------------------------------------------


def _expand(path: Paths) -> list[Path]:
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


def _load(path: Path) -> _Source:
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
    source = _Source(path, raw)
    if not raw.strip():
        raise DumpError(f"{path}: the file is empty. Did the run stop before its first dump?")
    if b"\0" in raw[:4096]:
        raise DumpError(f"{path}: a binary file, not a text dump. Let FILE in `dump ID all custom N FILE ...` not end in .bin.")
    if not raw.startswith(b"ITEM:"):
        source.fail(0, "a dump starts with 'ITEM: TIMESTEP', this file does not. Name a file of `dump custom` or `dump local`.")
    return source


# --- headers ----------------------------------------------------------------------------------------------------------


def _snapshots(source: _Source) -> Iterator[_Snapshot]:
    position = 0
    while position < len(source.text):
        snapshot = _snapshot(source, position)
        yield snapshot
        position = snapshot.end


def _line(source: _Source, position: int) -> tuple[str, int]:
    end = source.text.find(b"\n", position)
    if end < 0:
        source.fail(position, "the file ends inside a snapshot. Run the simulation again, or cut this snapshot off.")
    return source.text[position:end].decode("ascii", "replace").strip(), end + 1


def _snapshot(source: _Source, offset: int) -> _Snapshot:
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
    snapshot = _Snapshot(source, offset, step, box, count, columns, position, end)
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


def _end_of_rows(source: _Source, start: int) -> int:
    if source.text.startswith(b"ITEM:", start):
        return start
    end = source.text.find(b"\nITEM:", start)
    return len(source.text) if end < 0 else end + 1


def _whole_number(source: _Source, offset: int, text: str, what: str) -> int:
    if not re.fullmatch(r"\d{1,18}", text):
        source.fail(offset, f"expected {what}, found '{text[:60]}'. The header is damaged.")
    return int(text)


def _bounds(source: _Source, position: int) -> tuple[Bounds, int]:
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


def _in_order_of_time(snapshots: Sequence[_Snapshot]) -> list[_Snapshot]:
    by_step: dict[int, _Snapshot] = {}
    for snapshot in snapshots:
        first = by_step.setdefault(snapshot.step, snapshot)
        if first is not snapshot and (first.columns, first.box, first.body) != (snapshot.columns, snapshot.box, snapshot.body):
            snapshot.source.fail(
                snapshot.offset,
                f"step {snapshot.step} is here a second time, with other content than in {first.source.path}. "
                "Two runs are mixed: read them one by one.",
            )
    return [by_step[step] for step in sorted(by_step)]


# --- rows -------------------------------------------------------------------------------------------------------------


def _blocks(snapshots: Sequence[_Snapshot]) -> Iterator[list[_Snapshot]]:
    block: list[_Snapshot] = []
    size = 0
    for snapshot in snapshots:
        block.append(snapshot)
        size += snapshot.end - snapshot.start
        if size >= _BLOCK_BYTES:
            yield block
            block, size = [], 0
    if block:
        yield block


def _parse(block: Sequence[_Snapshot], allow_nonfinite: bool) -> pd.DataFrame:
    columns = block[0].columns
    text = b"".join(snapshot.body for snapshot in block)
    dtypes = {name: _dtype(name) for name in columns}
    if not text:
        return pd.DataFrame({name: pd.Series(dtype=dtype) for name, dtype in dtypes.items()})
    words = _words_per_line(text)
    # The C parser fills a short row and clips a long one without a word.
    if (words != len(columns)).any():
        row = int(np.argmax(words != len(columns)))
        _fail_at_row(block, row, f"{words[row]} values where the header names {len(columns)} columns. The file is damaged.")
    try:
        frame: pd.DataFrame = pd.read_csv(
            io.BytesIO(text),
            sep=r"\s+",
            header=None,
            names=list(columns),
            index_col=False,
            dtype=dtypes,
            keep_default_na=False,
            na_values={name: ["nan", "-nan", "NaN"] for name in columns if dtypes[name] == "float64"},
            quoting=csv.QUOTE_NONE,
            engine="c",
            **_EXACT,
        )
    except (ValueError, OverflowError) as error:
        _fail_at_word(block, text, error)
    if not allow_nonfinite:
        _refuse_nonfinite(frame, block)
    return frame


def _dtype(column: str) -> str:
    if column in INTEGER_COLUMNS:
        return "int64"
    return "object" if column in TEXT_COLUMNS else "float64"


def _words_per_line(text: bytes) -> np.ndarray:
    characters = np.frombuffer(text, np.uint8)
    blank = characters <= ord(" ")
    starts = ~blank
    starts[1:] &= blank[:-1]
    ends_of_line = np.flatnonzero(characters == ord("\n"))
    first = np.concatenate(([0], ends_of_line[:-1] + 1))
    return np.add.reduceat(starts, first, dtype=np.int64)


def _locate(block: Sequence[_Snapshot], row: int) -> tuple[_Snapshot, int]:
    """Snapshot that holds a row of the block, and the row's offset in its file."""
    for snapshot in block:
        if row < snapshot.count:
            break
        row -= snapshot.count
    offset = snapshot.start
    for _ in range(row):
        offset = snapshot.source.text.index(b"\n", offset) + 1
    return snapshot, offset


def _fail_at_row(block: Sequence[_Snapshot], row: int, what: str) -> NoReturn:
    snapshot, offset = _locate(block, row)
    snapshot.source.fail(offset, f"step {snapshot.step}: {what}")


def _fail_at_word(block: Sequence[_Snapshot], text: bytes, error: Exception) -> NoReturn:
    columns = block[0].columns
    for row, line in enumerate(text.splitlines()):
        for name, word in zip(columns, line.decode("ascii", "replace").split(), strict=True):
            kind = {"int64": "a whole number", "float64": "a number"}.get(_dtype(name))
            if kind and not _is_number(word, whole=_dtype(name) == "int64"):
                _fail_at_row(block, row, f"column '{name}': '{word[:40]}' is not {kind}. The file is damaged.")
    raise DumpError(f"{block[0].source.path}: {error}. The file is damaged.") from error


def _is_number(word: str, *, whole: bool) -> bool:
    try:
        value = float(word)
    except ValueError:
        return False
    return "_" not in word and (not whole or (value.is_integer() and abs(value) < 2**63))


def _refuse_nonfinite(frame: pd.DataFrame, block: Sequence[_Snapshot]) -> None:
    for name in frame.select_dtypes("float64"):
        bad = ~np.isfinite(frame[name].to_numpy())
        if bad.any():
            row = int(np.argmax(bad))
            whose = f"atom id {frame['id'].iloc[row]}, " if "id" in frame else ""
            _fail_at_row(
                block,
                row,
                f"{whose}column '{name}' is {frame[name].iloc[row]}: the simulation blew up. "
                "Use a smaller time step, or pass allow_nonfinite=True to look at it.",
            )


def _refuse_repeated_atoms(frame: pd.DataFrame, snapshots: Sequence[_Snapshot]) -> None:
    if "id" not in frame:
        return
    repeated = frame.duplicated(["step", "id"]).to_numpy()
    if repeated.any():
        row = int(np.argmax(repeated))
        _fail_at_row(snapshots, row, f"atom id {frame['id'].iloc[row]} stands there twice. The file is damaged.")


# --- contacts ---------------------------------------------------------------------------------------------------------


def _vector(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{axis}" for axis in "xyz")


# Columns that each keyword of `compute pair/gran/local` makes, in the order in which LIGGGHTS 3.8 writes them whatever
# the order of the keywords. Forces and torques act on particle 1.
PAIR_COLUMNS: dict[str, tuple[str, ...]] = {
    "pos": ("x1", "y1", "z1", "x2", "y2", "z2"),
    "vel": ("vx1", "vy1", "vz1", "vx2", "vy2", "vz2"),
    "id": ("id1", "id2", "periodic"),
    "force": _vector("force"),
    "force_normal": _vector("force_normal"),
    "force_tangential": _vector("force_tangential"),
    "torque": _vector("torque"),
    "torque_normal": _vector("torque_normal"),
    "torque_tangential": _vector("torque_tangential"),
    "history": (),
    "contactArea": ("contact_area",),
    "delta": ("overlap",),
    "heatFlux": ("heat_flux",),
    "contactPoint": _vector("contact"),
}
# The same for `compute wall/gran/local`. Positions and velocities: first the wall at the contact, then the particle.
# Forces and torques act on the particle. It leaves the columns of `contactPoint` zero; `pos` holds that point.
WALL_COLUMNS: dict[str, tuple[str, ...]] = {
    **{keyword: columns for keyword, columns in PAIR_COLUMNS.items() if keyword != "contactPoint"},
    "pos": ("wall_x", "wall_y", "wall_z", "x", "y", "z"),
    "vel": ("wall_vx", "wall_vy", "wall_vz", "vx", "vy", "vz"),
    "id": ("mesh", "triangle", "id"),
}
# What the computes write when their command names no keyword.
DEFAULT_KEYWORDS = ("pos", "vel", "id", "force", "torque", "history", "contactArea")

_CONTACT_IDENTIFIERS = frozenset({"id1", "id2", "periodic", "mesh", "triangle", "id"})
# `dump local` writes six digits unless told otherwise, which rounds identifiers from here on.
_FIRST_ROUNDED_IDENTIFIER = 10**6


def read_contacts(
    path: Paths,
    keywords: Sequence[str] = (),
    *,
    n_history: int = 0,
    wall: bool = False,
    allow_nonfinite: bool = False,
) -> pd.DataFrame:
    """Read a `dump local` of `compute pair/gran/local` or `compute wall/gran/local` under full names.

    Parameters
    ----------
    path, allow_nonfinite
        As for `read`.
    keywords
        What the compute's command names, in any order; none means the compute's own default.
    n_history
        Number of history values per contact; the columns are `history_1`, `history_2`, ...
    wall
        True for `compute wall/gran/local`.

    Returns
    -------
    pandas.DataFrame
        One row per step and contact with the columns of `PAIR_COLUMNS` or `WALL_COLUMNS`, identifiers as int64.
        `overlap` [m] is positive in compression. Columns that are not the compute's keep their name.

    Raises
    ------
    DumpError
        As for `read`; also if the dump does not hold all columns of such a compute, or identifiers lost digits.
    """
    names = _contact_names(tuple(keywords) or DEFAULT_KEYWORDS, n_history, wall)
    frame = read(path, allow_nonfinite=allow_nonfinite)
    numbered = {column: match for column in map(str, frame) if (match := re.fullmatch(r"c_(\w+)\[(\d+)\]", column))}
    computes = {match[1] for match in numbered.values()}
    indices = sorted(int(match[2]) for match in numbered.values())
    if len(computes) != 1 or indices != list(range(1, len(names) + 1)):
        first = _expand(path)[0]
        raise DumpError(
            f"{first}: expected c_ID[1] ... c_ID[{len(names)}] of one compute, for the keywords "
            f"{' '.join(keywords) or '(default)'} and n_history = {n_history}; found {' '.join(numbered) or 'none'}. "
            "Give the keywords and the number of history values of the deck, and dump all columns."
        )
    frame = frame.rename(columns={column: names[int(match[2]) - 1] for column, match in numbered.items()})
    for name in _CONTACT_IDENTIFIERS.intersection(frame.columns):
        values = frame[name].to_numpy()
        fractional = values[values != np.rint(values)]
        if fractional.size:
            raise DumpError(
                f"{_expand(path)[0]}: '{name}' holds {fractional[0]:g}, not an identifier: the keywords are not those of "
                "the deck's compute. Give the deck's own."
            )
        large = values[values >= _FIRST_ROUNDED_IDENTIFIER]
        if large.size and all(float(f"{value:g}") == value for value in large):
            raise DumpError(
                f"{_expand(path)[0]}: '{name}' up to {large.max():g} has been rounded to six digits by the dump. "
                "Add `dump_modify ID format` with %.16g for every column to the deck."
            )
        frame[name] = values.astype(np.int64)
    return frame


def _contact_names(keywords: Sequence[str], n_history: int, wall: bool) -> list[str]:
    table = WALL_COLUMNS if wall else PAIR_COLUMNS
    style = "wall/gran/local" if wall else "pair/gran/local"
    for keyword in keywords:
        if keyword not in table:
            hint = " 'pos' holds that point." if keyword == "contactPoint" else ""
            raise DumpError(f"compute {style}: no columns known for keyword '{keyword}'.{hint} Known: {', '.join(table)}.")
    if {"heatFlux", "contactPoint"} <= set(keywords):
        raise DumpError(f"compute {style}: heatFlux and contactPoint overwrite each other in LIGGGHTS 3.8. Drop one.")
    if ("history" in keywords) != (n_history > 0):
        raise DumpError(f"compute {style}: n_history = {n_history} does not fit. Give it with 'history', and only then.")
    history = tuple(f"history_{number}" for number in range(1, n_history + 1))
    return [name for keyword in table if keyword in keywords for name in (history if keyword == "history" else table[keyword])]
