"""Fixtures shared by the tests: the simulators that this machine has, and small decks of stock LIGGGHTS."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from pyjkr.errors import RunError
from pyjkr.run import Simulator, find_simulator

STOCK_LIGGGHTS = Path("/usr/bin/liggghts")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "liggghts: runs the real LIGGGHTS")


@pytest.fixture(scope="session")
def liggghts() -> Simulator:
    """The stock LIGGGHTS of Debian; where it may be missing, the test is skipped, in continuous integration it fails."""
    if not STOCK_LIGGGHTS.exists():
        reason = f"{STOCK_LIGGGHTS} is missing: apt-get install liggghts"
        pytest.fail(reason) if os.environ.get("CI") else pytest.skip(reason)
    return Simulator(STOCK_LIGGGHTS)


# Three glass spheres in a row on a mesh floor, overlapping a little. No two parameters are equal, none is 1.
_SPHERES = """\
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
region box block -0.02 0.02 -0.021 0.021 -0.001 0.04 units box
create_box 1 box
neighbor 0.0005 bin
neigh_modify delay 0
fix young all property/global youngsModulus peratomtype 5.e6
fix poisson all property/global poissonsRatio peratomtype 0.45
fix restitution all property/global coefficientRestitution peratomtypepair 1 0.8
fix friction all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1.3e-5
create_atoms 1 single 0 0 0.00195 units box
create_atoms 1 single 0.0038 0.0002 0.00195 units box
create_atoms 1 single 0.0076 0 0.00195 units box
set group all density 2500 diameter 0.004
velocity all set 0.02 0.01 0.0
fix mesh all mesh/surface file floor.stl type 1
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes mesh
fix gravity all gravity 9.81 vector 0.0 0.0 -1.0
fix integrate all nve/sphere
thermo 10
"""

_FLOOR = """\
solid floor
facet normal 0 0 1
outer loop
vertex -0.02 -0.021 0
vertex 0.02 -0.021 0
vertex 0.02 0.021 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -0.02 -0.021 0
vertex 0.02 0.021 0
vertex -0.02 0.021 0
endloop
endfacet
endsolid floor
"""


@pytest.fixture
def spheres_deck(tmp_path: Path) -> Callable[..., Path]:
    """Writes a deck of three spheres on a floor, with the lines given at its end, in a directory with an awkward name."""

    def write(*lines: str) -> Path:
        directory = tmp_path / "it's a run"
        directory.mkdir(exist_ok=True)
        (directory / "floor.stl").write_text(_FLOOR)
        deck = directory / "in.spheres"
        deck.write_text(_SPHERES + "\n".join(lines) + "\n")
        return deck

    return write


@pytest.fixture(scope="session")
def plugin() -> Simulator:
    """LIGGGHTS with the jkr styles: skipped where it was not built, in continuous integration a failure."""
    try:
        simulator = find_simulator()
    except RunError as error:
        pytest.fail(str(error)) if os.environ.get("CI") else pytest.skip(str(error))
    if not simulator.plugin:
        reason = f"{simulator.executable} has no jkr styles: pip install ."
        pytest.fail(reason) if os.environ.get("CI") else pytest.skip(reason)
    return simulator
