"""`PackingScene` -> LIGGGHTS' input and its data file; the run itself. Chen, Liu and Li 2019, sec. 4, fig. 8.

Spheres that rebound from the bed are sent back at the speed of the inlet once the rain has ended (ours: there is no gravity,
and what the paper does with them is not known).
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np

from pyjkr import dump, templating
from pyjkr.packing.column import column
from pyjkr.packing.scene import PackingScene
from pyjkr.run import Run, read_run, run_deck
from pyjkr.simulator import Simulator

DECK_NAME, DATA_NAME = "in.deck", "column.data"
SPHERES_NAME, CONTACTS_NAME = "spheres.dump", "contacts.dump"
STYLES = "model jkr tangential jkr rolling_friction krijt"
CONTACT_KEYWORDS = ("pos", "id", "force_normal", "history", "delta")
HISTORY = dump.jkr_history("jkr", "jkr", "krijt", twisting=True)
# Skin of the neighbour lists in radii, and in necks; bins in radii.
SKIN_IN_RADII, SKIN_IN_NECKS, BIN_IN_RADII = 0.4, 4.0, 2.5
# Length of one stretch of settling, after which the energy is looked at [r/U]; lines of thermo output in the rain.
CHUNK = 5.0
THERMO_LINES = 20
# Room above the column and below the floor [r].
ROOM_ABOVE, ROOM_BELOW = 40.0, 2.0


def write(scene: PackingScene, directory: Path) -> Path:
    """Write deck and data file; return the deck's path.

    Parameters
    ----------
    scene : PackingScene
        What to pack.
    directory : Path
        Exists.
    """
    places = column(scene.particles, scene.box_in_radii, scene.inlet_fraction, scene.seed) * scene.radius
    data = _data_file(scene, places)
    (directory / DATA_NAME).write_text(data, encoding="ascii")
    step = scene.time_step
    environment = templating.environment()
    columns = sum(len(dump.PAIR_COLUMNS[keyword]) for keyword in CONTACT_KEYWORDS) + len(HISTORY)
    rain_steps = math.ceil(float(places[-1, 2]) / scene.speed / step)
    text = environment.get_template("packing.in.j2").render(
        scene=scene,
        digest=hashlib.sha256(data.encode()).hexdigest()[:16],
        data_file=DATA_NAME,
        spheres_file=SPHERES_NAME,
        contacts_file=CONTACTS_NAME,
        styles=STYLES,
        keywords=f"eventCorrection on tangential_damping on twisting on rollingDamping {scene.rolling_damping!r}",
        skin=max(SKIN_IN_RADII * scene.radius, SKIN_IN_NECKS * scene.neck),
        bin_size=BIN_IN_RADII * scene.radius,
        rain_steps=rain_steps,
        thermo_interval=math.ceil(rain_steps / THERMO_LINES),
        chunks=math.ceil(scene.settling_time / CHUNK),
        chunk_steps=math.ceil(CHUNK * scene.time_unit / step),
        contact_keywords=" ".join(CONTACT_KEYWORDS),
        modes=", ".join(f"{mode} {limit!r}" for mode, limit in scene.time_scales.items()),
        columns=columns,
        entries=" ".join(f"c_contacts[{number}]" for number in range(1, columns + 1)),
    )
    deck = directory / DECK_NAME
    deck.write_text(text, encoding="utf-8")
    return deck


def simulate(scene: PackingScene, directory: Path, *, simulator: Simulator | None = None) -> Run:
    """Run the deck of a scene, unless its whole run lies in the directory already.

    Parameters
    ----------
    scene, directory
        As for `write`.
    simulator : Simulator, optional
        LIGGGHTS to use; None finds one.

    Raises
    ------
    RunError
        As `run_deck`.
    """
    deck = write(scene, directory)
    return read_run(directory) or run_deck(deck, progress=False, simulator=simulator)


def _data_file(scene: PackingScene, places: np.ndarray) -> str:
    """Text for `read_data`: id, type, diameter, density and place of each sphere, then velocities and spins."""
    top = float(places[-1, 2]) + ROOM_ABOVE * scene.radius
    lines = [f"rain of {len(places)} spheres", "", f"{len(places)} atoms", "1 atom types", ""]
    lines += [f"0.0 {scene.box!r} {axis}lo {axis}hi" for axis in "xy"]
    lines += [f"{-ROOM_BELOW * scene.radius!r} {top!r} zlo zhi", "", "Atoms", ""]
    for number, (x, y, z) in enumerate(places.tolist(), start=1):
        lines.append(f"{number} 1 {2 * scene.radius!r} {scene.density!r} {x!r} {y!r} {z!r}")
    lines += ["", "Velocities", ""]
    lines += [f"{number} 0.0 0.0 {-scene.speed!r} 0.0 0.0 0.0" for number in range(1, len(places) + 1)]
    return "\n".join(lines) + "\n"
