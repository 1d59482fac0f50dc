"""Compiles and runs solver.cpp: what the contact solver alone costs, by several methods."""

from __future__ import annotations

import csv
import hashlib
import io
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from pyjkr.errors import RunError

SOURCE = Path(__file__).resolve().parent / "solver.cpp"
KERNELS = SOURCE.parent.parent / "liggghts_src" / "kernels"
# Those of the plug-in.
FLAGS = ("-O3", "-DNDEBUG", "-std=c++17", "-fno-math-errno", "-fno-trapping-math", "-fno-tree-slp-vectorize", "-ffp-contract=fast")


@dataclass(frozen=True)
class SolverRow:
    """One method.

    Parameters
    ----------
    method
        Its name.
    throughput_ns, latency_ns
        u and F together: independent contacts; each waiting for the one before.
    root_error
        Largest relative error of u.
    force_error
        Largest error of F over max(|F|, F_C).
    """

    method: str
    throughput_ns: float
    latency_ns: float
    root_error: float
    force_error: float


def read_table(text: str) -> list[SolverRow]:
    """Read what the program prints.

    Parameters
    ----------
    text
        CSV with a header.
    """
    return [
        SolverRow(
            row["method"], *(float(row[key]) for key in ("throughput_ns", "latency_ns", "root_error", "force_error"))
        )
        for row in csv.DictReader(io.StringIO(text))
    ]


def measure(directory: Path, *, rounds: int, repeats: int) -> list[SolverRow]:
    """Compile where the sources have changed, and run.

    Parameters
    ----------
    directory
        For the program.
    rounds, repeats
        Passes over 4096 overlaps in a measurement, and measurements.

    Raises
    ------
    RunError
        If there is no compiler or it fails.
    """
    compiler = shutil.which("g++")
    if compiler is None:
        raise RunError("g++ not found. Install it with `apt-get install g++`.")
    sources = b"".join(file.read_bytes() for file in (SOURCE, *sorted(KERNELS.glob("*.h"))))
    program = directory.absolute() / f"solver-{hashlib.sha256(sources).hexdigest()[:12]}"
    if not program.exists():
        directory.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([compiler, *FLAGS, str(SOURCE), "-o", str(program)], capture_output=True, text=True)
        if done.returncode:
            raise RunError(f"{SOURCE}: does not compile:\n{done.stderr[-2000:]}")
    done = subprocess.run([str(program), str(rounds), str(repeats)], capture_output=True, text=True, check=True)
    return read_table(done.stdout)
