"""`Application` and one way to run it -> LIGGGHTS' input, its data file and its mesh; the run itself.

The template holds all of LIGGGHTS' syntax; here are the numbers that neither scene nor law carries: bins, drag, frames.
Only effects of the variant are in the deck.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from pyjkr import templating
from pyjkr.application import laws, places, shapes, situation
from pyjkr.application.laws import Law
from pyjkr.application.places import Spheres
from pyjkr.application.scene import Application
from pyjkr.errors import PlanError
from pyjkr.planning import estimate, neighbours
from pyjkr.planning.cost_model import SHIPPED
from pyjkr.planning.estimate import Around
from pyjkr.planning.neighbours import Neighbours
from pyjkr.planning.variants import Variant
from pyjkr.run import Run, read_run, run_deck
from pyjkr.simulator import Simulator

DECK_NAME, DATA_NAME, MESH_NAME = "in.deck", "spheres.data", "tube.stl"
SPHERES_NAME, CONTACTS_NAME = "spheres.dump", "contacts.dump"
# Spheres that the deck creates itself, one line each; more come from a data file.
INLINE = 2
# Joins the lines of one command.
CONTINUED = " &\n" + 17 * " "
ROUND_OFF = 1e-12
# Steps are 32-bit numbers in LIGGGHTS.
MOST_STEPS = 2**31 - 1
# Facets around a tube, 5 degrees each.
FACETS = 72
# Digits of the numbers in a deck: more would show round-off, 0.30000000000000004; places and velocities in the data file have all.
DIGITS = 12
# Powers of ten that are written out: 0.0084 and 1050, but 3.8e9.
WRITTEN_OUT = range(-4, 5)
# Of `fix mesh/surface` for micrometres in SI units: 1e-8 m and 0.256 degrees are LIGGGHTS' own.
MESH_PRECISION, MESH_CURVATURE = 1e-13, 1e-3


def render(
    scene: Application, variant: Variant, *, comments: Sequence[str] = (), duration: float | None = None
) -> str:
    """Text of the LIGGGHTS deck of a scene.

    Parameters
    ----------
    scene : Application
        What to simulate.
    variant : Variant
        Which effects, how soft, and the time step.
    comments : sequence of str
        For the head of the deck: why.
    duration : float, optional
        In place of that of the scene [s].

    Raises
    ------
    PlanError
        Where an effect that is on lacks its property.
    """
    return next(text for name, text in files(scene, variant, comments=comments, duration=duration) if name == DECK_NAME)


def files(
    scene: Application, variant: Variant, *, comments: Sequence[str] = (), duration: float | None = None
) -> Iterator[tuple[str, str]]:
    """Name and text of each file that a run needs, the deck last; parameters as for `render`."""
    law = laws.law(scene, variant)
    start = places.spheres(scene, law)
    if len(start.radii) > INLINE:
        yield DATA_NAME, data_file(scene, start)
    if scene.wall and scene.wall.shape == "tube":
        yield MESH_NAME, shapes.tube(scene.wall.radius, scene.wall.length, FACETS)
    yield DECK_NAME, _text(scene, law, start, comments, duration)


def write(
    scene: Application, variant: Variant, directory: Path, *, comments: Sequence[str] = (),
    duration: float | None = None,
) -> Path:  # fmt: skip
    """Write the deck, and the data file and mesh that it reads; return the deck's path.

    Parameters
    ----------
    scene, variant, comments, duration
        As for `render`.
    directory : Path
        Made where it is missing.
    """
    written = dict(files(scene, variant, comments=comments, duration=duration))
    directory.mkdir(parents=True, exist_ok=True)
    for name, text in written.items():
        (directory / name).write_text(text, encoding="utf-8")
    return directory / DECK_NAME


def simulate(
    scene: Application, variant: Variant, directory: Path, *, comments: Sequence[str] = (),
    duration: float | None = None, ranks: int = 1, progress: bool | None = None, simulator: Simulator | None = None,
) -> Run:  # fmt: skip
    """Run the deck of a scene, unless its whole run lies in the directory already.

    Parameters
    ----------
    scene, variant, directory, comments, duration
        As for `write`.
    ranks, progress, simulator
        As for `run_deck`.

    Raises
    ------
    RunError
        As `run_deck`.
    """
    wanted = dict(files(scene, variant, comments=comments, duration=duration))
    kept = read_run(directory)
    if kept and kept.ranks == ranks and all(_reads(directory / name, text) for name, text in wanted.items()):
        return kept
    for name in (SPHERES_NAME, CONTACTS_NAME):
        (directory / name).unlink(missing_ok=True)
    deck = write(scene, variant, directory, comments=comments, duration=duration)
    return run_deck(deck, ranks=ranks, total_steps=steps(scene, variant, duration)[0], progress=progress, simulator=simulator)


def _reads(path: Path, text: str) -> bool:
    return path.is_file() and path.read_text(encoding="utf-8") == text


def steps(scene: Application, variant: Variant, duration: float | None = None) -> tuple[int, int]:
    """Steps of the run, and from frame to frame: the last frame is the end, which is less than a frame late.

    There are as many frames as the scene asks for, or fewer, at least half, where they are few steps apart.
    """
    # A duration that is a whole number of steps is not made longer by round-off.
    needed = max(1, math.ceil((duration or scene.run.duration) / variant.time_step * (1 - ROUND_OFF)))
    interval = math.ceil(needed / scene.run.frames)
    total = math.ceil(needed / interval) * interval
    if total > MOST_STEPS:
        raise PlanError(f"{scene.source}: {total} steps of {variant.time_step:.3g} s; LIGGGHTS takes {MOST_STEPS}. Shorten run.duration.")
    return total, interval


def neighbour_lists(scene: Application, variant: Variant, start: Spheres | None = None) -> Neighbours:
    """Skin and bins of the least wall time, or the skin of the scene; by the shipped costs, so that a deck is the same everywhere.

    Parameters
    ----------
    scene, variant
        As for `render`.
    start : Spheres, optional
        Where the spheres start, where that is known already.
    """
    start = start or places.spheres(scene, laws.law(scene, variant))
    around = estimate.surroundings(situation.situation(scene), variant, math.prod(high - low for low, high in places.box(scene, start)))
    if scene.numerics.skin:
        needed = max(neighbours.SKIN_IN_NECKS * around.neck, 2 * around.speed * around.time_step)
        if scene.numerics.skin < needed:
            raise PlanError(
                f"{scene.source}: numerics: skin = {scene.numerics.skin:g} m is too short: necks and the motion of a step ask for"
                f" {needed:.3g} m. Leave it out and the deck chooses one."
            )
        return neighbours.at(scene.numerics.skin, around, SHIPPED, "as the scene says")
    return neighbours.choose(around, SHIPPED)


def around(scene: Application, variant: Variant) -> Around:
    """What costs time beside the contacts: frames, fixes that push, triangles, an empty box, periodic pairs."""
    start = places.spheres(scene, laws.law(scene, variant))
    bounds = places.box(scene, start)
    return Around(
        frames=scene.run.frames,
        forces=int(variant.styles.gravity and scene.motion.gravity > 0) + 2 * len(start.size_classes) * bool(scene.gas),
        triangles=2 * FACETS if scene.wall and scene.wall.shape == "tube" else 0,
        box_volume=math.prod(high - low for low, high in bounds),
        periodic_lengths=tuple(high - low for (low, high), periodic in zip(bounds, scene.periodic, strict=True) if periodic),
    )


def data_file(scene: Application, start: Spheres) -> str:
    """Text for `read_data`: id, type, diameter, density and place of each sphere, then velocities and spins."""
    types = {name: index for index, name in enumerate(scene.materials, start=1)}
    lines = [f"{len(start.radii)} spheres", "", f"{len(start.radii)} atoms", f"{len(types)} atom types", ""]
    lines += [f"{low!r} {high!r} {axis}lo {axis}hi" for (low, high), axis in zip(places.box(scene, start), "xyz", strict=True)]
    lines += ["", "Atoms", ""]
    rows = zip(start.materials, start.radii.tolist(), start.densities.tolist(), start.positions.tolist(), strict=True)
    for number, (name, radius, density, (x, y, z)) in enumerate(rows, start=1):
        lines.append(f"{number} {types[name]} {2 * radius!r} {density!r} {x!r} {y!r} {z!r}")
    lines += ["", "Velocities", ""]
    lines += [f"{number} {vx!r} {vy!r} {vz!r} 0.0 0.0 0.0" for number, (vx, vy, vz) in enumerate(start.velocities.tolist(), start=1)]
    return "\n".join(lines) + "\n"


def _text(scene: Application, law: Law, start: Spheres, comments: Sequence[str], duration: float | None) -> str:
    variant = law.variant
    environment = templating.environment(_number)
    environment.filters["numbers"] = _numbers
    materials, bounds = scene.materials, places.box(scene, start)
    total, interval = steps(scene, variant, duration)
    lists = neighbour_lists(scene, variant, start)
    inline = len(start.radii) <= INLINE

    def matrix(value: str | Callable) -> str:
        """Number of types, then the values row by row, each row on a line of its own; one value on the same line."""
        values = law.matrix(value if callable(value) else lambda contact: getattr(contact, value))
        rows = [_numbers(map(float, values[first : first + len(materials)])) for first in range(0, len(values), len(materials))]
        return (" " if len(rows) == 1 else CONTINUED).join([str(len(materials)), *rows])

    return environment.get_template("application.in.j2").render(
        scene=scene,
        law=law,
        matrix=matrix,
        comments=comments,
        variant=variant,
        boundary=" ".join("p" if periodic else "f" for periodic in scene.periodic),
        bounds=[value for pair in bounds for value in pair],
        types=len(materials),
        count=len(start.radii),
        data_file="" if inline else DATA_NAME,
        digest="" if inline else hashlib.sha256(data_file(scene, start).encode()).hexdigest()[:16],
        spheres=_inline(scene, start) if inline else [],
        skin=_rounded_up(lists.skin),
        bin_size=_rounded_up(lists.bin_size),
        moduli=[scene.material[name].youngs_modulus for name in materials],
        moduli_mod=[law.youngs_modulus(name) for name in materials],
        poissons_ratios=[scene.material[name].poissons_ratio for name in materials],
        surface_energies=list(dict.fromkeys(contact.surface_energy for contact in scene.contact)),
        hysteresis=scene.contact[0].adhesion_hysteresis is not None,
        limited=_limited(law),
        pairs=[f"{a}-{b}" for a in range(1, len(materials) + 1) for b in range(1, len(materials) + 1)],
        never_meet=len(scene.contact) < len(materials) * (len(materials) + 1) // 2,
        continued=CONTINUED,
        wall_type=materials.index(scene.wall.material) + 1 if scene.wall else 0,
        mesh_file=MESH_NAME,
        mesh_precision=MESH_PRECISION,
        mesh_curvature=MESH_CURVATURE,
        drag=_drag(scene, start),
        contacts_file="" if scene.start == "single" else CONTACTS_NAME,
        spheres_file=SPHERES_NAME,
        interval=interval,
        steps=total,
        duration=total * variant.time_step,
    )


def _inline(scene: Application, start: Spheres) -> list[dict]:
    return [
        {
            "type": scene.materials.index(name) + 1,
            "diameter": 2 * radius,
            "density": density,
            "position": position,
            "velocity": velocity,
        }
        for name, radius, density, position, velocity in zip(
            start.materials,
            start.radii.tolist(),
            start.densities.tolist(),
            start.positions.tolist(),
            start.velocities.tolist(),
            strict=True,
        )
    ]


def _drag(scene: Application, start: Spheres) -> list[dict]:
    """Coefficient of `fix viscous` and force of `fix addforce` of each size class."""
    if not scene.gas:
        return []
    classes = []
    for first, last, radius in start.size_classes:
        coefficient = 6 * math.pi * scene.gas.viscosity * radius
        force = [coefficient * component for component in scene.gas.velocity]
        classes.append({"first": first, "last": last, "radius": radius, "coefficient": coefficient, "force": force})
    return classes


def _limited(law: Law) -> str:
    styles = law.styles
    terms = ["sliding"] if styles.tangential == "jkr" else []
    terms += ["rolling"] if styles.rolling_friction == "krijt" else []
    terms += ["twisting"] if styles.twisting else []
    return " and ".join([", ".join(terms[:-1]), terms[-1]] if len(terms) > 1 else terms) or "no"


def _number(value: object) -> object:
    """Floats as text of `DIGITS` digits without noise of round-off: 3.8e9, 0.0084, 0; anything else as it is."""
    if not isinstance(value, float):
        return value
    mantissa, power = f"{value:.{DIGITS - 1}e}".split("e")
    if value == 0 or int(power) in WRITTEN_OUT:
        return f"{value + 0.0:.{DIGITS}g}"
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(power)}"


def _rounded_up(value: float) -> float:
    """To three digits: nothing hangs on more in a skin or a bin, but a skin must not get shorter."""
    power = math.floor(math.log10(value)) - 2
    # Round-off must not raise what has three digits already.
    return float(f"{math.ceil(float(f'{value / 10.0**power:.9g}'))}e{power}")


def _numbers(values: Iterable[object], separator: str = " ") -> str:
    return separator.join(str(_number(value)) for value in values)


