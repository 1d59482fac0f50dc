"""What a run costs in wall time: spheres, contacts, neighbour lists and ranks, with coefficients measured on this machine.

Covers no law; every part of a contact law (normal, sliding, rolling, twisting) has its own time per contact and step, and they add up.
Assumes that ranks share the spheres evenly. Times in seconds.
"""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from pyjkr.errors import PlanError
from pyjkr.planning import probe_deck
from pyjkr.simulator import Simulator

FILE_NAME = "cost-model.json"
# What a contact law is made of.
PARTS = (
    "model hertz",
    "model jkr/simplified",
    "model jkr",
    "tangential history",
    "tangential jkr",
    "rolling_friction epsd2",
    "rolling_friction krijt",
    "twisting on",
)
# Styles of LIGGGHTS that cost about what a measured one does, and those that cost nothing.
LIKE = {"tangential no_history": "tangential history", "rolling_friction epsd": "rolling_friction epsd2"}
FREE = ("tangential off", "rolling_friction off")


@dataclass(frozen=True, kw_only=True)
class CostModel:
    """Coefficients of the wall time of a step.

    t = steps ((N (a + forces p) + contacts c(law) + idle d + rebuilds (N b + candidates e + bins f) + triangles w) / ranks
        + s + [ranks > 1] (m + ghosts g)) + frames (o + N q) + start

    Attributes
    ----------
    step : float
        s, whatever there is to do [s].
    sphere : float
        a: integration and all else, per sphere [s].
    idle : float
        d: a pair in the neighbour list that does not touch [s].
    rebuild_sphere, rebuild_candidate : float
        b, e: a new neighbour list, per sphere and per pair that is looked at, touching or not [s].
    rebuild_bin : float
        f: a bin, empty or not, in a new neighbour list [s].
    force : float
        p: a fix that pushes, such as gravity or drag, per sphere [s].
    triangle : float
        w: a triangle of a mesh wall, touched or not [s].
    frame, frame_sphere : float
        o, q: output, each and per sphere [s].
    start : float
        Of the program [s].
    message, ghost : float
        m, g: exchange between ranks, each, and per sphere at a face between them [s].
    laws : dict
        c of each part of a law, such as "model jkr" or "twisting on" [s].
    program, machine : str
        Digest of LIGGGHTS and plug-in, and name of the machine.
    origin : str
        "measured" here, or "shipped".
    """

    step: float
    sphere: float
    idle: float
    rebuild_sphere: float
    rebuild_candidate: float
    rebuild_bin: float
    force: float
    triangle: float
    frame: float
    frame_sphere: float
    start: float
    message: float
    ghost: float
    laws: Mapping[str, float]
    program: str = ""
    machine: str = ""
    origin: str = "measured"

    def contact(self, styles: str) -> float:
        """Time of one contact in one step [s].

        Parameters
        ----------
        styles : str
            As after `pair_style gran`, keywords too.

        Raises
        ------
        PlanError
            Where a part of the law has never been measured.
        """
        return sum(self.laws[part] for part in parts(styles))

    def step_time(
        self, styles: str, particles: float, contacts: float, *, idle: float = 0.0, rebuild_rate: float = 0.0,
        candidates: float = 0.0, bins: float = 0.0, forces: float = 0.0, triangles: float = 0.0, ranks: int = 1,
    ) -> float:  # fmt: skip
        """Wall time of one step [s].

        Parameters
        ----------
        styles : str
            As for `contact`.
        particles, contacts : float
            Spheres, and pairs that touch, walls among them.
        idle, candidates : float
            Pairs in the neighbour lists that do not touch; pairs looked at for new lists.
        rebuild_rate : float
            New neighbour lists per step.
        bins, forces, triangles : float
            Bins of the neighbour lists; fixes that push; triangles of mesh walls.
        ranks : int
            MPI processes.
        """
        shared = particles * (self.sphere + forces * self.force) + contacts * self.contact(styles) + idle * self.idle
        shared += rebuild_rate * (particles * self.rebuild_sphere + candidates * self.rebuild_candidate + bins * self.rebuild_bin)
        shared += triangles * self.triangle
        exchange = self.message + ghosts(particles, ranks) * self.ghost if ranks > 1 else 0.0
        return shared / ranks + self.step + exchange

    def loop_time(self, steps: float, styles: str, particles: float, contacts: float, *, frames: float = 0.0, **more: float) -> float:
        """Time [s] of `steps` times `step_time`, whose parameters the others are, and of output."""
        return steps * self.step_time(styles, particles, contacts, **more) + frames * (self.frame + particles * self.frame_sphere)

    def wall_time(self, steps: float, styles: str, particles: float, contacts: float, **more: float) -> float:
        """Time [s] from start to end of the program; parameters as for `loop_time`."""
        return self.start + self.loop_time(steps, styles, particles, contacts, **more)


NUMBERS = tuple(entry.name for entry in fields(CostModel) if entry.type == "float")


def ghosts(particles: float, ranks: int) -> float:
    """Spheres at the face between two ranks: (N/ranks)^(2/3), for domains as wide as they are high."""
    return (particles / ranks) ** (2 / 3) if ranks > 1 else 0.0


def parts(styles: str) -> tuple[str, ...]:
    """Parts of a law that cost time: "model jkr", "tangential jkr", "rolling_friction krijt", "twisting on".

    Parameters
    ----------
    styles : str
        As after `pair_style gran`, keywords too.

    Raises
    ------
    PlanError
        Where one of them is not among `PARTS`.
    """
    words = styles.split()
    pairs = [f"{slot} {name}" for slot, name in zip(words[::2], words[1::2], strict=False)]
    found = []
    for pair in pairs:
        part = LIKE.get(pair, pair)
        if part in PARTS:
            found.append(part)
        elif part.split()[0] in probe_deck.SLOTS and part not in FREE:
            raise PlanError(f"cost model: no time was measured for '{pair}'. Use one of {', '.join(PARTS)}.")
    return tuple(found)


def text(model: CostModel) -> str:
    """The coefficients as a table for a terminal."""
    rows = [(name, value) for name, value in asdict(model).items() if isinstance(value, float)]
    rows += [(f"a contact, {part}", time) for part, time in model.laws.items()]
    width = max(len(name) for name, _ in rows)
    lines = [f"{name:<{width}}  {value:.3g} s" for name, value in rows]
    return "\n".join([f"{model.origin}: {model.machine or 'another machine'}", *lines])


def machine_name() -> str:
    """Name of this machine and of its processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace").splitlines()
        processor = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        processor = platform.processor() or platform.machine()
    return f"{platform.node()}, {processor}, {os.cpu_count()} cores"


def cache_file() -> Path:
    """Where the coefficients of this machine are kept: XDG_CACHE_HOME/pyjkr, or ~/.cache/pyjkr (XDG Base Directory Specification)."""
    home = os.environ.get("XDG_CACHE_HOME", "")
    # A relative path is invalid by the specification.
    base = Path(home) if Path(home).is_absolute() else Path.home() / ".cache"
    return base / "pyjkr" / FILE_NAME


def store(model: CostModel, file: Path | None = None) -> Path:
    """Keep a model for the next plans; return its file.

    Raises
    ------
    PlanError
        Where the directory cannot be written.
    """
    file = file or cache_file()
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        unfinished = file.with_suffix(f".{os.getpid()}")
        unfinished.write_text(json.dumps(asdict(model), indent=1) + "\n", encoding="utf-8")
        unfinished.replace(file)
    except OSError as error:
        raise PlanError(
            f"{file}: the cost model cannot be kept: {error.strerror}. Set XDG_CACHE_HOME to a directory you may write."
        ) from None
    return file


def load(simulator: Simulator | None, file: Path | None = None) -> CostModel:
    """The model measured on this machine with this LIGGGHTS, or the shipped one.

    Parameters
    ----------
    simulator : Simulator or None
        Whose times are wanted; None takes the shipped model.
    file : Path or None
        None looks in the cache.
    """
    if simulator is None:
        return SHIPPED
    try:
        model = CostModel(**json.loads((file or cache_file()).read_text(encoding="utf-8")))
        numbers = [*model.laws.values(), *(getattr(model, name) for name in NUMBERS)]
        fits = model.program == probe_deck.program_digest(simulator) and model.machine == machine_name() and set(model.laws) == set(PARTS)
        return model if fits and all(math.isfinite(number) and number >= 0 for number in numbers) else SHIPPED
    except (OSError, ValueError, TypeError, AttributeError):
        return SHIPPED


# Measured by `timing.calibrate` on two cores of a virtual machine with AVX2; of another machine they give the order.
SHIPPED = CostModel(
    step=1.5e-7,
    sphere=1.1e-8,
    idle=6.0e-9,
    rebuild_sphere=1.1e-7,
    rebuild_candidate=4.1e-9,
    rebuild_bin=2.9e-10,
    force=4.9e-9,
    # Of a scene with a tube, with and without it.
    triangle=1.2e-7,
    frame=1e-5,
    frame_sphere=1.9e-6,
    start=0.045,
    message=2.0e-7,
    ghost=1.4e-7,
    laws={
        "model hertz": 3.55e-8,
        "model jkr/simplified": 3.27e-8,
        "model jkr": 3.6e-8,
        "tangential history": 4.7e-9,
        "tangential jkr": 3.0e-8,
        "rolling_friction epsd2": 1.6e-8,
        "rolling_friction krijt": 1.04e-8,
        "twisting on": 1.5e-9,
    },
    origin="shipped",
)
