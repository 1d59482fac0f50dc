"""Shared by the tests of `pyjkr.application`: the shipped cases, changes to them, ways to run them, and frames made by hand."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from pyjkr import resources
from pyjkr.application import scene, situation
from pyjkr.application.analysis import Frame
from pyjkr.application.scene import Application
from pyjkr.planning import variants
from pyjkr.planning.styles import of_effects
from pyjkr.planning.variants import Variant

NAMES = ("head_on_pair", "oblique_wall", "ash_on_tube", "agglomerate_break_up", "dust_coagulation", "packed_bed")
CASES = {name: resources.directory("cases") / name / "scene.toml" for name in NAMES}
BREAK_UP = "agglomerate_break_up"
ALL = ("adhesion", "neck", "sliding", "sliding_adhesion", "rolling", "twisting", "damping", "gravity", "original_limits")


def scene_of(name: str) -> Application:
    """A shipped case."""
    return scene.load(CASES[name])


def changed(directory: Path, name: str, *changes: tuple[str, str]) -> Path:
    """A shipped case with pieces of its text replaced, each of which it must hold."""
    text = CASES[name].read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path = directory / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def with_values(directory: Path, name: str, **values: object) -> Path:
    """A shipped case with other values of keys, wherever they stand: no test hangs on the numbers of a case."""
    text = CASES[name].read_text(encoding="utf-8")
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        assert count, key
    path = directory / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def variant(given: Application, *, modulus_ratio: float = 0.01, off: Iterable[str] = (), steps: int = 20) -> Variant:
    """All effects but those named, softened, `steps` steps in the shortest collision of the softened material."""
    on = frozenset(ALL) - frozenset(off)
    shortest = variants.shortest_collision(situation.situation(given))
    # Times go as q^(-2/5); Haervig 2017, eq. 24.
    return Variant(
        name="test", effects=on, modulus_ratio=modulus_ratio, styles=of_effects(on), time_step=shortest * modulus_ratio**-0.4 / steps
    )


def frame(
    positions: object, *, radii: object = 1.0, density: float = 1.0, pairs: object = (), at_wall: object = False, velocities: object = 0.0,
    spins: object = 0.0, time: float = 0.0,
) -> Frame:  # fmt: skip
    """Spheres at hand-made places; what is one number holds for all."""
    places = np.array(positions, dtype=float)
    sizes = np.broadcast_to(np.asarray(radii, dtype=float), len(places)).copy()
    return Frame(
        time=time,
        radii=sizes,
        masses=4 / 3 * math.pi * sizes**3 * density,
        positions=places,
        velocities=np.broadcast_to(np.asarray(velocities, dtype=float), places.shape).copy(),
        spins=np.broadcast_to(np.asarray(spins, dtype=float), places.shape).copy(),
        pairs=np.array(pairs, dtype=np.int64).reshape(-1, 2),
        at_wall=np.broadcast_to(np.asarray(at_wall, dtype=bool), len(places)).copy(),
    )
