"""A few spheres in LIGGGHTS, for probes and timings: values -> deck and data file -> run, kept where it is whole.

Covers no law: materials and styles are handed in. Sections: domain, material, contact law, integration, as in every deck of ours.
Assumes one material for all spheres and the wall, whose pair has the effective moduli asked for (Haervig 2017, eqs 2 and 15).
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import jinja2
import pandas as pd

from pyjkr import dump, templating
from pyjkr.errors import DumpError, PlanError
from pyjkr.run import Run, read_run, run_deck
from pyjkr.simulator import Simulator

TEMPLATE = "probe.in.j2"
DECK_NAME, DATA_NAME, DUMP_NAME = "in.deck", "spheres.data", "frames.dump"
COLUMNS = ("id", "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz", "tqx", "tqy", "tqz")
# Words that name a style; all others are keywords.
SLOTS = ("model", "tangential", "rolling_friction", "cohesion")
# Bins per side at most, and bins in search distances: LIGGGHTS' own choice is half of one.
BINS_PER_SIDE, BIN_SHARE = 200, 0.5


Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """One sphere: radius [m], density [kg/m3], position [m], velocity [m/s], spin [rad/s], constant force [N]."""

    radius: float
    density: float
    position: Vector
    velocity: Vector = (0.0, 0.0, 0.0)
    spin: Vector = (0.0, 0.0, 0.0)
    force: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Material:
    """What the contact law is given; names and units as `fix property/global` has them.

    Attributes
    ----------
    youngs_modulus, youngs_modulus_original : float
        Of both bodies [Pa]; the second only where `originals` is set.
    poissons_ratio, restitution_coefficient, friction_coefficient : float
        nu, e, mu.
    surface_energy, surface_energy_original : float
        gamma [J/m2].
    critical_rolling_angle : float or None
        xi_crit/R; None without rolling friction.
    originals : bool
        Whether the deck names the real values beside the softened ones.
    more : dict
        Further properties of the pair, of stock models.
    """

    youngs_modulus: float
    poissons_ratio: float
    restitution_coefficient: float
    friction_coefficient: float
    surface_energy: float
    youngs_modulus_original: float = 0.0
    surface_energy_original: float = 0.0
    critical_rolling_angle: float | None = None
    originals: bool = False
    more: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class ProbeDeck:
    """Everything one deck needs.

    Attributes
    ----------
    title : str
        First line of the deck.
    spheres : tuple of Sphere
        Ids count from 1.
    material, styles
        The law; styles as after `pair_style gran`, keywords too.
    time_step : float
        [s].
    runs : tuple of int
        Steps of each run command.
    skin : float
        Of the neighbour lists [m].
    box : tuple of float
        xlo xhi ylo yhi zlo zhi [m].
    boundary : str
        As LIGGGHTS has it.
    wall : bool
        Whether z = 0 is a wall.
    every : int
        Steps between frames; 0 for none.
    always_rebuild : bool
        New neighbour lists in every step.
    """

    title: str
    spheres: tuple[Sphere, ...]
    material: Material
    styles: str
    time_step: float
    runs: tuple[int, ...]
    skin: float
    box: tuple[float, ...]
    boundary: str = "f f f"
    wall: bool = False
    every: int = 0
    always_rebuild: bool = False


def poissons_ratio(effective_modulus: float, effective_shear_modulus: float) -> float:
    """nu of the one material whose pairs have both moduli: G/E = (1 - nu)/(2 (2 - nu)); Haervig 2017, eqs 2 and 15.

    Parameters
    ----------
    effective_modulus, effective_shear_modulus : float
        E, G [Pa].

    Raises
    ------
    PlanError
        Where no material has them.
    """
    share = effective_shear_modulus / effective_modulus
    ratio = (1 - 4 * share) / (1 - 2 * share)
    if not -1e-12 <= ratio <= 0.5:
        raise PlanError(f"probe: G/E = {share:.4g} of a pair belongs to no Poisson's ratio in 0..0.5. Correct the moduli of the scene.")
    return max(ratio, 0.0)


def split(styles: str) -> tuple[str, str]:
    """Styles and keywords apart: behind a wall's styles LIGGGHTS wants its shape, and the keywords last.

    Parameters
    ----------
    styles : str
        Both, in pairs of words.
    """
    words = styles.split()
    pairs = list(zip(words[::2], words[1::2], strict=True))
    return tuple(" ".join(" ".join(pair) for pair in pairs if (pair[0] in SLOTS) == slots) for slots in (True, False))


def box_around(spheres: Sequence[Sphere], duration: float = 0.0) -> tuple[float, ...]:
    """Box [m] that spheres which keep to their speed, or rebound with it, do not leave."""
    reach = max(4 * sphere.radius + math.hypot(*sphere.velocity) * duration for sphere in spheres)
    return tuple(
        edge(sphere.position[axis] for sphere in spheres) + sign * reach for axis in range(3) for edge, sign in ((min, -1), (max, 1))
    )


def render(deck: ProbeDeck, program: str = "") -> tuple[str, str]:
    """Texts of the deck and of its data file.

    Parameters
    ----------
    deck : ProbeDeck
        What to run.
    program : str
        Digest of the simulator: the deck of another build is another deck, so its run is not taken for this one's.
    """
    data = _data(deck)
    search = 2 * max(sphere.radius for sphere in deck.spheres) + deck.skin
    longest = max(high - low for low, high in zip(deck.box[::2], deck.box[1::2], strict=True))
    styles, keywords = split(deck.styles)
    text = _template().render(
        deck=deck,
        styles=styles,
        keywords=keywords,
        program=program,
        digest=hashlib.sha256(data.encode()).hexdigest()[:16],
        data_file=DATA_NAME,
        dump_file=DUMP_NAME,
        bin_size=max(BIN_SHARE * search, longest / BINS_PER_SIDE),
        per_type=_per_type(deck.material),
        per_pair=_per_pair(deck.material),
        forces=_forces(deck),
        columns=COLUMNS,
        formats=["%d"] + ["%.17g"] * (len(COLUMNS) - 1),
    )
    return text, data


def execute(deck: ProbeDeck, directory: Path, simulator: Simulator, *, ranks: int = 1) -> Run:
    """Run a deck, unless its whole run by the same program lies in the directory.

    Raises
    ------
    RunError
        As `pyjkr.run.run_deck`.
    """
    text, data = render(deck, program_digest(simulator))
    path = directory / DECK_NAME
    kept = read_run(directory)
    if kept and kept.ranks == ranks and path.read_text(encoding="utf-8") == text and (not deck.every or (directory / DUMP_NAME).is_file()):
        return kept
    directory.mkdir(parents=True, exist_ok=True)
    (directory / DUMP_NAME).unlink(missing_ok=True)
    (directory / DATA_NAME).write_text(data, encoding="ascii")
    path.write_text(text, encoding="utf-8")
    return run_deck(path, ranks=ranks, progress=False, simulator=simulator)


def frames(deck: ProbeDeck, run: Run) -> pd.DataFrame:
    """The frames of a run, one row per step and sphere.

    Raises
    ------
    DumpError
        Where the last one is not whole.
    """
    frame = dump.read(run.directory / DUMP_NAME)
    last = sum(deck.runs) // deck.every * deck.every
    if (frame["step"] == last).sum() != len(deck.spheres):
        raise DumpError(f"{run.directory}: the dump does not hold step {last}. Remove the directory and run again.")
    return frame


def program_digest(simulator: Simulator) -> str:
    """Digest of the program and the plug-in that it loads."""
    digest = hashlib.sha256()
    for file in (simulator.executable, simulator.preload):
        if file:
            digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


@functools.cache
def _template() -> jinja2.Template:
    """Compiled once: a verification renders a hundred decks."""
    environment = templating.environment()
    return environment.get_template(TEMPLATE)


def _forces(deck: ProbeDeck) -> list[tuple[list[int], Vector]]:
    """Ids of the spheres that one force acts on, for every force: LIGGGHTS has 32 groups."""
    found: dict[Vector, list[int]] = {}
    for number, sphere in enumerate(deck.spheres, start=1):
        if any(sphere.force):
            found.setdefault(sphere.force, []).append(number)
    return [(numbers, force) for force, numbers in found.items()]


def _per_type(material: Material) -> list[tuple[str, float]]:
    rows = [("youngsModulus", material.youngs_modulus), ("poissonsRatio", material.poissons_ratio)]
    return rows + ([("youngsModulusOriginal", material.youngs_modulus_original)] if material.originals else [])


def _per_pair(material: Material) -> list[tuple[str, float]]:
    rows = [
        ("coefficientRestitution", material.restitution_coefficient),
        ("coefficientFriction", material.friction_coefficient),
        ("surfaceEnergy", material.surface_energy),
    ]
    if material.originals:
        rows.append(("surfaceEnergyOriginal", material.surface_energy_original))
    if material.critical_rolling_angle is not None:
        rows.append(("criticalRollingAngle", material.critical_rolling_angle))
    return rows + list(material.more.items())


def _data(deck: ProbeDeck) -> str:
    """Text for `read_data`: id, type, diameter, density, place of each sphere, then velocities and spins."""
    lines = ["spheres of a probe", "", f"{len(deck.spheres)} atoms", "1 atom types", ""]
    lines += [f"{deck.box[2 * k]!r} {deck.box[2 * k + 1]!r} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    lines += ["", "Atoms", ""]
    for number, sphere in enumerate(deck.spheres, start=1):
        lines.append(f"{number} 1 {2 * sphere.radius!r} {sphere.density!r} " + " ".join(repr(float(x)) for x in sphere.position))
    lines += ["", "Velocities", ""]
    for number, sphere in enumerate(deck.spheres, start=1):
        lines.append(f"{number} " + " ".join(repr(float(x)) for x in (*sphere.velocity, *sphere.spin)))
    return "\n".join(lines) + "\n"
