"""Instructions a contact, counted by valgrind's callgrind: the same on a busy machine as on a quiet one.

Only what runs inside the pair style's compute() is counted, and of two runs of different length the difference, so that
start-up and setup cancel.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from bench.bed import Contacts
from bench.laws import Law, Mode, liggghts_deck
from pyjkr.errors import RunError
from pyjkr.run import Simulator

SPHERES = 500
RUN_LENGTHS = (20, 120)
_COMPUTE = "LAMMPS_NS::PairGran::compute(int, int)"
_SUMMARY = re.compile(r"^(?:summary|totals): (\d+)", re.MULTILINE)


@dataclass(frozen=True)
class InstructionCount:
    """Instructions in a step of one law.

    Parameters
    ----------
    per_step
        Of the pair style.
    per_evaluation
        The same over the calls of the law, those for pairs that do not touch included.
    """

    per_step: float
    per_evaluation: float


def available() -> bool:
    """Whether valgrind is installed."""
    return shutil.which("valgrind") is not None


def read_callgrind(text: str) -> int:
    """Instructions in all of a callgrind file.

    Parameters
    ----------
    text
        The file that callgrind wrote.

    Raises
    ------
    RunError
        If it holds no sum.
    """
    found = _SUMMARY.search(text)
    if not found:
        raise RunError("no instruction count in callgrind's file: valgrind did not come to its end.")
    return int(found[1])


def count(
    law: Law,
    mode: Mode,
    data: Path,
    contacts: Contacts,
    radius: float,
    simulator: Simulator,
    program: str,
    folder: Path,
) -> InstructionCount:
    """Count the instructions of a law on a bed, or take the count made before.

    Parameters
    ----------
    law, mode, data, contacts, radius
        What to run on what.
    simulator, program
        LIGGGHTS with the plug-in, and its digest.
    folder
        Where to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "instructions.json"
    decks = [liggghts_deck(law, mode, data, radius=radius, steps=steps, program=program) for steps in RUN_LENGTHS]
    if record.exists():
        stored = json.loads(record.read_text())
        if stored["decks"] == decks:
            return InstructionCount(**stored["count"])
    totals = [_total(deck, simulator, folder / f"{steps}") for deck, steps in zip(decks, RUN_LENGTHS, strict=True)]
    per_step = (totals[1] - totals[0]) / (RUN_LENGTHS[1] - RUN_LENGTHS[0])
    result = InstructionCount(per_step, per_step / contacts.evaluations)
    record.write_text(json.dumps({"decks": decks, "count": vars(result)}, indent=1) + "\n")
    return result


def _total(deck: str, simulator: Simulator, folder: Path) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.deck").write_text(deck)
    environment = ["env", f"LD_PRELOAD={simulator.preload}"] if simulator.preload else []
    command = [
        "valgrind",
        "--tool=callgrind",
        "--collect-atstart=no",
        f"--toggle-collect={_COMPUTE}",
        "--callgrind-out-file=callgrind.out",
        *environment,
        str(simulator.executable),
        "-in",
        "in.deck",
    ]
    if environment:
        command.insert(1, "--trace-children=yes")
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    if done.returncode:
        raise RunError(f"{folder}: valgrind failed: {(done.stdout + done.stderr)[-800:]}")
    return read_callgrind((folder / "callgrind.out").read_text())
