"""The rows of `Snapshot`s -> `pandas.DataFrame`, parsed in C by blocks and checked value by value.

A row too short or too long, a word that is no number and a number that is not finite are refused with the line.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from typing import Any, NoReturn

import numpy as np
import pandas as pd

from pyjkr.dump.snapshots import Snapshot
from pyjkr.errors import DumpError

INTEGER_COLUMNS = frozenset({"id", "type", "mol", "proc", "ix", "iy", "iz", "index", "id_multisphere"})
TEXT_COLUMNS = frozenset({"element"})

# Bytes of rows handed to the C parser at once: bounds the memory of the checks, and spares a call per snapshot.
_BLOCK_BYTES = 1 << 24
# pandas 3 parses decimal numbers to the nearest float by itself, and deprecates the option that older ones need for it.
_EXACT: dict[str, Any] = {"float_precision": "round_trip"} if int(pd.__version__.split(".")[0]) < 3 else {}


def blocks(snapshots: Sequence[Snapshot]) -> Iterator[list[Snapshot]]:
    block: list[Snapshot] = []
    size = 0
    for snapshot in snapshots:
        block.append(snapshot)
        size += snapshot.end - snapshot.start
        if size >= _BLOCK_BYTES:
            yield block
            block, size = [], 0
    if block:
        yield block


def parse(block: Sequence[Snapshot], allow_nonfinite: bool) -> pd.DataFrame:
    columns = block[0].columns
    text = b"".join(snapshot.body for snapshot in block)
    dtypes = {name: _dtype(name) for name in columns}
    if not text:
        return pd.DataFrame({name: pd.Series(dtype=dtype) for name, dtype in dtypes.items()})
    words = _words_per_line(text)
    # The C parser fills a short row and clips a long one without a word.
    if (words != len(columns)).any():
        row = int(np.argmax(words != len(columns)))
        fail_at_row(block, row, f"{words[row]} values where the header names {len(columns)} columns. The file is damaged.")
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


def _locate(block: Sequence[Snapshot], row: int) -> tuple[Snapshot, int]:
    """Snapshot that holds a row of the block, and the row's offset in its file."""
    for snapshot in block:
        if row < snapshot.count:
            break
        row -= snapshot.count
    offset = snapshot.start
    for _ in range(row):
        offset = snapshot.source.text.index(b"\n", offset) + 1
    return snapshot, offset


def fail_at_row(block: Sequence[Snapshot], row: int, what: str) -> NoReturn:
    snapshot, offset = _locate(block, row)
    snapshot.source.fail(offset, f"step {snapshot.step}: {what}")


def _fail_at_word(block: Sequence[Snapshot], text: bytes, error: Exception) -> NoReturn:
    columns = block[0].columns
    for row, line in enumerate(text.splitlines()):
        for name, word in zip(columns, line.decode("ascii", "replace").split(), strict=True):
            kind = {"int64": "a whole number", "float64": "a number"}.get(_dtype(name))
            if kind and not _is_number(word, whole=_dtype(name) == "int64"):
                fail_at_row(block, row, f"column '{name}': '{word[:40]}' is not {kind}. The file is damaged.")
    raise DumpError(f"{block[0].source.path}: {error}. The file is damaged.") from error


def _is_number(word: str, *, whole: bool) -> bool:
    try:
        value = float(word)
    except ValueError:
        return False
    return "_" not in word and (not whole or (value.is_integer() and abs(value) < 2**63))


def _refuse_nonfinite(frame: pd.DataFrame, block: Sequence[Snapshot]) -> None:
    for name in frame.select_dtypes("float64"):
        bad = ~np.isfinite(frame[name].to_numpy())
        if bad.any():
            row = int(np.argmax(bad))
            whose = f"atom id {frame['id'].iloc[row]}, " if "id" in frame else ""
            fail_at_row(
                block,
                row,
                f"{whose}column '{name}' is {frame[name].iloc[row]}: the simulation blew up. "
                "Use a smaller time step, or pass allow_nonfinite=True to look at it.",
            )
