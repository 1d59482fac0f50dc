"""Which LIGGGHTS runs the decks: the program, what is preloaded into it, and where both are looked for."""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from pyjkr.errors import RunError

LAUNCHER = "liggghts-jkr"
PLUGIN = "libliggghts_jkr.so"


@dataclass(frozen=True)
class Simulator:
    """A LIGGGHTS to run decks with.

    Parameters
    ----------
    executable
        Program with the command line of `liggghts`.
    preload
        Shared object to load into it, or None.
    plugin
        Whether the jkr styles are there.
    """

    executable: Path
    preload: Path | None = None
    plugin: bool = False

    @property
    def name(self) -> str:
        """The program as a shell would be told to start it."""
        return f"LD_PRELOAD={self.preload} {self.executable}" if self.preload else str(self.executable)


def find_simulator() -> Simulator:
    """Find a LIGGGHTS that has the jkr styles.

    Returns
    -------
    Simulator
        The first of: the program that `PYJKR_LIGGGHTS` names; `liggghts-jkr` beside this Python, inside the package, on
        the PATH, in `build/` of a source checkout; the stock `liggghts` with the plug-in inside the package preloaded.

    Raises
    ------
    RunError
        If there is none, or `PYJKR_LIGGGHTS` does not name a program.
    """
    package = Path(__file__).resolve().parent
    if named := os.environ.get("PYJKR_LIGGGHTS"):
        program = shutil.which(named)
        if program is None:
            raise RunError(f"PYJKR_LIGGGHTS={named}: not a program that can be run. Correct the variable, or unset it.")
        return Simulator(Path(program).absolute(), plugin=Path(program).name.startswith(LAUNCHER))
    on_path = shutil.which(LAUNCHER)
    candidates = [
        # Not resolved: in a virtual environment the interpreter is a link to the system's.
        Path(sys.executable).parent / LAUNCHER,
        package / "bin" / LAUNCHER,
        package / LAUNCHER,
        *([Path(on_path)] if on_path else []),
        package.parent / "build" / LAUNCHER,
    ]
    for candidate in candidates:
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return Simulator(candidate.absolute(), plugin=True)
    stock = shutil.which("liggghts")
    for plugin in (package / "lib" / PLUGIN, package / PLUGIN):
        if stock and plugin.is_file():
            return Simulator(Path(stock), preload=plugin, plugin=True)
    raise RunError(
        f"{LAUNCHER} not found beside {sys.executable}, on the PATH or in build/. "
        "Install it with `apt-get install libliggghts-dev` and `pip install .`, or type `make run` in the source directory."
    )
