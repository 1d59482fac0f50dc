"""What must not change: stock decks give the same bytes with and without the plug-in, and gamma = 0 gives stock Hertz.

The decks are those of Debian's liggghts-doc, shortened in run length alone, and one that is written here.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from simulation import Materials, Simulation, Sphere
from trajectory import trajectory

import pyjkr
from pyjkr.run import Simulator, run_deck

pytestmark = pytest.mark.liggghts

PLUGIN = "libliggghts_jkr.so"
EXAMPLES = Path("/usr/share/doc/liggghts/examples/LIGGGHTS/Tutorials_public")
# directory, deck, and the run length of the last run command [steps]
DECKS = [
    ("cohesion", "in.cohesion", 9000),
    ("cohesion", "in.noCohesion", 9000),
    ("meshGran", "in.meshGran", 4200),
    ("hysteresis", "in.hysteresis", 6000),
    ("contactModels", "in.newModels", 2400),
]
# Of the largest value: the same products in another order, half an ulp each step, in a collision that does not
# amplify it.
HERTZ = 1e-13


def preloaded(plugin: Simulator, stock: Simulator) -> Simulator:
    """Stock LIGGGHTS with the plug-in as a shared object."""
    if plugin.preload:
        return plugin
    program = Path(plugin.executable).resolve()
    package = Path(pyjkr.__file__).parent
    for folder in (program.parent, package / "lib", package, package.parent / "build"):
        if (folder / PLUGIN).is_file():
            return Simulator(stock.executable, preload=folder / PLUGIN, plugin=True)
    pytest.fail(f"{PLUGIN} is neither beside {program} nor in the package: build it, or pip install .")


def output(simulator: Simulator, deck: Path, source: Path | None, directory: Path) -> dict[str, bytes]:
    """Runs a copy of a deck and returns what it dumped, by file name."""
    if source:
        shutil.copytree(source, directory)
    (directory / "post").mkdir(parents=True, exist_ok=True)
    for old in (directory / "post").iterdir():
        old.unlink()
    (directory / deck.name).write_bytes(deck.read_bytes())
    run_deck(directory / deck.name, simulator=simulator, progress=False)
    return {file.name: file.read_bytes() for file in sorted((directory / "post").iterdir())}


def shortened(text: str, steps: int) -> str:
    """The deck with its last run cut to `steps` and those before it to a third of that."""
    runs = list(re.finditer(r"^run\s+(\d+)(\s+upto)?", text, re.MULTILINE))
    for number, found in reversed(list(enumerate(runs))):
        length = min(int(found[1]), steps if number == len(runs) - 1 else steps // 3)
        text = text[: found.start()] + f"run {length}{found[2] or ''}" + text[found.end() :]
    return text


@pytest.mark.parametrize(("folder", "deck", "steps"), DECKS)
def test_debian_example_gives_the_same_bytes_with_and_without_the_plugin(
    plugin: Simulator, liggghts: Simulator, tmp_path: Path, folder: str, deck: str, steps: int
) -> None:
    source = EXAMPLES / folder
    if not source.is_dir():
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{source} is missing: apt-get install liggghts-doc")
    short = tmp_path / deck
    text = (source / deck).read_bytes()
    short.write_text(shortened(text.decode(), steps))
    stock = output(liggghts, short, source, tmp_path / "stock")
    # `dump mesh/stl` and VTK meshes, and the spheres, of more than one step
    assert len(stock) >= 2 and all(stock.values())
    for name, simulator in (("launcher", plugin), ("preloaded", preloaded(plugin, liggghts))):
        assert output(simulator, short, source, tmp_path / name) == stock, name


def collisions(style: str, surface_energy: float | None, keywords: str = "") -> Simulation:
    """Three spheres of two sizes, spinning, on a floor and against each other.

    Normal, sliding and rolling all at work.
    """
    properties = dict(
        youngsModulus=[6.1e7, 8.3e7],
        poissonsRatio=[0.29, 0.36],
        coefficientRestitution=[[0.71, 0.64], [0.64, 0.55]],
        coefficientFriction=[[0.4, 0.33], [0.33, 0.47]],
        coefficientRollingFriction=[[0.021, 0.032], [0.032, 0.043]],
    )
    if surface_energy is not None:
        properties["surfaceEnergy"] = surface_energy
        properties["adhesionHysteresis"] = 0.26
    a, b = 2.3e-3, 1.7e-3
    return Simulation(
        [
            Sphere((0.0, 0.0, a - 1e-5), a, 2510.0, (0.31, 0.07, -0.2), (11.0, -23.0, 37.0)),
            Sphere((a + b + 3e-5, 2e-4, b + 4e-5), b, 2740.0, (-0.43, 0.05, -0.11), (-5.0, 41.0, 3.0), type=2),
            Sphere((1e-3, 4e-4, 2 * a + b + 2e-5), b, 2740.0, (0.0, -0.13, -0.53), (17.0, 7.0, -9.0), type=2),
        ],
        Materials(2, properties),
        time_step=7e-7,
        steps=6000,
        style=style,
        keywords=keywords,
        walls=["primitive type 1 zplane 0.0"],
        every=50,
    )


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
@pytest.mark.parametrize(
    "rest", ["", "tangential history", "tangential no_history", "tangential history rolling_friction epsd2"]
)
def test_without_surface_energy_the_trajectory_is_that_of_stock_hertz(
    plugin: Simulator, liggghts: Simulator, tmp_path: Path, model: str, rest: str
) -> None:
    stock = trajectory(collisions(f"model hertz {rest}", None), liggghts, tmp_path / "stock")
    ours = trajectory(collisions(f"model {model} {rest}", 0.0, "eventCorrection off"), plugin, tmp_path / "ours")
    assert (stock["fx"] != 0.0).any()
    for names in (
        ["x", "y", "z"],
        *([f"{quantity}{axis}" for axis in "xyz"] for quantity in ("v", "omega", "f", "tq")),
    ):
        scale = max(np.abs(stock[name]).max() for name in names)
        assert max(np.abs(ours[name] - stock[name]).max() for name in names) <= HERTZ * scale, names


def test_preloaded_plugin_and_launcher_give_the_same_bytes(
    plugin: Simulator, liggghts: Simulator, tmp_path: Path
) -> None:
    for style in (
        "model jkr/simplified tangential jkr rolling_friction krijt",
        "model jkr tangential jkr rolling_friction krijt",
    ):
        simulation = collisions(style, 0.8, "twisting on rollingDamping 0.2")
        dumps = []
        for name, simulator in (("launcher", plugin), ("preloaded", preloaded(plugin, liggghts))):
            simulation.run(simulator, tmp_path / name)
            dumps.append((tmp_path / name / "trajectory.txt").read_bytes())
        assert dumps[0] == dumps[1] and dumps[0].count(b"TIMESTEP") == 121


def test_stock_deck_gives_the_same_bytes_with_and_without_the_plugin(
    plugin: Simulator, liggghts: Simulator, tmp_path: Path
) -> None:
    simulation = collisions("model hertz tangential history rolling_friction epsd2", None)
    dumps = []
    for name, simulator in (("stock", liggghts), ("launcher", plugin), ("preloaded", preloaded(plugin, liggghts))):
        simulation.run(simulator, tmp_path / name)
        dumps.append((tmp_path / name / "trajectory.txt").read_bytes())
    assert dumps[0] == dumps[1] == dumps[2]
