"""A few spheres and walls in the real LIGGGHTS, described in Python: the shortest way from a case to its trajectory.

For tests of the contact models; users go through scenes and decks. SI units throughout.
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from pyjkr import dump, run

COLUMNS = [
    "id",
    "type",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "fx",
    "fy",
    "fz",
    "omegax",
    "omegay",
    "omegaz",
    "tqx",
    "tqy",
    "tqz",
    "radius",
    "mass",
]


@dataclass(frozen=True)
class Sphere:
    """One sphere: position [m], radius [m], density [kg/m3], velocity [m/s], spin [rad/s], atom type."""

    position: Sequence[float]
    radius: float
    density: float
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    spin: Sequence[float] = (0.0, 0.0, 0.0)
    type: int = 1


@dataclass(frozen=True)
class Materials:
    """Per-type and per-type-pair properties; a number stands for all types or pairs.

    `properties` maps a name of `fix property/global` to a number, a list (peratomtype) or a square list (peratomtypepair).
    """

    types: int
    properties: dict[str, object]

    PER_TYPE = ("youngsModulus", "poissonsRatio", "youngsModulusOriginal")

    def lines(self) -> list[str]:
        lines = []
        for name, value in self.properties.items():
            if name in self.PER_TYPE:
                values = [value] * self.types if isinstance(value, int | float) else list(value)
                kind = "peratomtype"
            else:
                if isinstance(value, int | float):
                    value = [[value] * self.types] * self.types
                values = [self.types, *(number for row in value for number in row)]
                kind = "peratomtypepair"
            text = " ".join(v if isinstance(v, str) else repr(v) for v in values)
            lines.append(f"fix {name} all property/global {name} {kind} {text}")
        return lines


@dataclass(frozen=True)
class Simulation:
    """Everything one deck needs. `walls` are the words after `wall/gran STYLE`, e.g. "primitive type 2 zplane 0.0"."""

    spheres: Sequence[Sphere]
    materials: Materials
    time_step: float
    steps: int
    style: str = "model jkr/simplified tangential jkr rolling_friction krijt"
    keywords: str = ""
    walls: Sequence[str] = ()
    box: Sequence[float] = ()  # xlo xhi ylo yhi zlo zhi; default: room around the spheres
    boundary: str = "f f f"
    skin: float | None = None
    every: int = 1  # steps between snapshots
    before_run: Sequence[str] = ()  # lines before the last run command
    after_run: Sequence[str] = ()
    run_lines: Sequence[str] | None = None  # in place of `run STEPS`
    setup: Sequence[str] = ()  # lines before the pair style
    columns: Sequence[str] = field(default_factory=lambda: COLUMNS)

    def deck(self) -> str:
        largest = max(sphere.radius for sphere in self.spheres)
        smallest = min(sphere.radius for sphere in self.spheres)
        skin = self.skin if self.skin is not None else 0.5 * smallest
        box = self.box
        if not box:
            box = []
            for axis in range(3):
                at = [sphere.position[axis] for sphere in self.spheres]
                box += [min(at) - 20 * largest, max(at) + 20 * largest]
        lines = [
            "atom_style granular",
            "atom_modify map array",
            f"boundary {self.boundary}",
            "newton off",
            "communicate single vel yes",
            "units si",
            "hard_particles yes",
            "soft_particles yes",
            "region box block " + " ".join(repr(float(edge)) for edge in box) + " units box",
            f"create_box {self.materials.types} box",
            f"neighbor {skin!r} bin",
            "neigh_modify delay 0",
            *self.materials.lines(),
            *self.setup,
            f"pair_style gran {self.style} {self.keywords}",
            "pair_coeff * *",
            f"timestep {self.time_step!r}",
        ]
        for number, wall in enumerate(self.walls):
            lines.append(f"fix wall{number} all wall/gran {self.style} {wall} {self.keywords}")
        for number, s in enumerate(self.spheres, start=1):
            lines.append(f"create_atoms {s.type} single " + " ".join(repr(float(v)) for v in s.position) + " units box")
            lines.append(f"group one id {number}")
            lines.append(f"set group one diameter {2 * s.radius!r} density {s.density!r}")
            lines.append("velocity one set " + " ".join(repr(float(v)) for v in s.velocity) + " units box")
            for axis, value in zip("xyz", s.spin, strict=True):
                lines.append(f"set group one omega{axis} {float(value)!r}")
            lines.append("group one delete")
        number_formats = " ".join("%d" if c in ("id", "type") else "%.17g" for c in self.columns)
        lines += [
            "fix integrate all nve/sphere",
            "thermo_style custom step atoms ke",
            f"thermo {max(1, self.steps // 10)}",
            "thermo_modify lost error norm no",
            f"dump trajectory all custom {self.every} trajectory.txt " + " ".join(self.columns),
            f'dump_modify trajectory sort id format "{number_formats}"',
            *self.before_run,
            *(self.run_lines if self.run_lines is not None else [f"run {self.steps}"]),
            *self.after_run,
        ]
        return "\n".join(lines) + "\n"

    def run(self, simulator: run.Simulator, directory: Path, ranks: int = 1) -> pd.DataFrame:
        """Trajectory: one row per snapshot and sphere, sorted by step and id."""
        directory.mkdir(parents=True, exist_ok=True)
        deck = directory / "in.deck"
        deck.write_text(self.deck())
        run.run_deck(deck, ranks=ranks, progress=False, simulator=simulator)
        return dump.read(directory / "trajectory.txt")

    def refused(self, simulator: run.Simulator, directory: Path) -> str:
        """The ERROR line of a deck that must not start; fails if it does."""
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "in.deck").write_text(self.deck())
        done = subprocess.run([simulator.executable, "-in", "in.deck"], cwd=directory, capture_output=True, check=False)
        text = done.stdout.decode(errors="replace")
        errors = [line for line in text.splitlines() if line.startswith("ERROR")]
        assert done.returncode != 0 and errors, text[-2000:]
        assert "Step" not in text, "the first step was taken before the error"
        return errors[0]
