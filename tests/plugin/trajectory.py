"""Dumped trajectories as plain arrays, and what these tests read off them: frequencies, snapshots by id."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from simulation import Simulation

from pyjkr.run import Simulator


class Trajectory:
    """`trajectory["vx"]`.

    Rows are snapshots, columns are spheres in the order of their ids. No sphere may come or go.
    """

    def __init__(self, frame):
        frame.attrs = {}  # the box of every snapshot would be copied at each step of the work below
        self.step = np.unique(frame["step"].to_numpy())
        self._columns = {name: frame[name].to_numpy().reshape(len(self.step), -1) for name in frame.columns}

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __len__(self) -> int:
        return len(self.step)


def trajectory(simulation: Simulation, simulator: Simulator, directory: Path) -> Trajectory:
    return Trajectory(simulation.run(simulator, directory))


def angular_frequency(times: np.ndarray, values: np.ndarray) -> float:
    """Of an oscillation about its mean: from its upward crossings, each interpolated in a straight line."""
    values = values - 0.5 * (values.max() + values.min())
    up = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    assert len(up) >= 3, "too few oscillations to tell their frequency"
    crossings = times[up] - values[up] * (times[up + 1] - times[up]) / (values[up + 1] - values[up])
    return 2.0 * np.pi * (len(up) - 1) / (crossings[-1] - crossings[0])
