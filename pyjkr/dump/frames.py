"""Text dumps of `dump custom` and `dump local`, plain or gzip -> one tidy `pandas.DataFrame`.

Assumes text dumps in SI units; a file is read whole or refused, never in part.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from pyjkr.dump.rows import blocks, fail_at_row, parse
from pyjkr.dump.snapshots import Paths, Snapshot, expand, load, snapshots_of


class Boxes(dict):
    """Box of each step. pandas copies `attrs` deeply at every operation; what nobody changes need not be copied."""

    def __deepcopy__(self, memo: object) -> Boxes:
        return self


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
    snapshots = [snapshot for file in expand(path) for snapshot in snapshots_of(load(file))]
    snapshots = _in_order_of_time(snapshots)
    columns = snapshots[0].columns
    for snapshot in snapshots:
        if snapshot.columns != columns:
            snapshot.source.fail(
                snapshot.offset,
                f"step {snapshot.step} has columns '{' '.join(snapshot.columns)}', earlier ones '{' '.join(columns)}'. "
                "Read dumps of different layout one by one.",
            )
    frame = pd.concat([parse(block, allow_nonfinite) for block in blocks(snapshots)], ignore_index=True)
    frame.insert(0, "step", np.repeat([s.step for s in snapshots], [s.count for s in snapshots]).astype(np.int64))
    _refuse_repeated_atoms(frame, snapshots)
    frame.attrs["box"] = Boxes({snapshot.step: snapshot.box for snapshot in snapshots})
    return frame


def _in_order_of_time(snapshots: Sequence[Snapshot]) -> list[Snapshot]:
    by_step: dict[int, Snapshot] = {}
    for snapshot in snapshots:
        first = by_step.setdefault(snapshot.step, snapshot)
        if first is not snapshot and (first.columns, first.box, first.body) != (snapshot.columns, snapshot.box, snapshot.body):
            snapshot.source.fail(
                snapshot.offset,
                f"step {snapshot.step} is here a second time, with other content than in {first.source.path}. "
                "Two runs are mixed: read them one by one.",
            )
    return [by_step[step] for step in sorted(by_step)]


def _refuse_repeated_atoms(frame: pd.DataFrame, snapshots: Sequence[Snapshot]) -> None:
    if "id" not in frame:
        return
    repeated = frame.duplicated(["step", "id"]).to_numpy()
    if repeated.any():
        row = int(np.argmax(repeated))
        fail_at_row(snapshots, row, f"atom id {frame['id'].iloc[row]} stands there twice. The file is damaged.")
