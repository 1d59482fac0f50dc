"""Scene files of many particles: TOML -> a frozen, validated `Application` in SI units.

Covers spheres of any number of materials and sizes that meet each other and a wall, and six ways for them to start.
Assumes spheres, one wall at most, no fluid but a uniform drag. Every fault ends in one line, as in `pyjkr.scene`.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from pyjkr.planning.situation import About, Wish
from pyjkr.scene import Contact, Material, _fault, _quantity, _refuse_repeats, _Table, read, validated

# "pair": two spheres fly at each other. "single": one sphere flies at a wall. "agglomerate": one made of all the spheres flies
# at a wall. "cloud": spheres at random in a periodic block, with random velocities. "rain": spheres at random in a column above
# a floor, which fall. "stream": spheres at random in a block upstream of a tube, which fly at it.
Start = Literal["pair", "single", "agglomerate", "cloud", "rain", "stream"]
WALL_OF: dict[str, tuple[str, ...]] = {
    "pair": (),
    "single": ("plane",),
    "agglomerate": ("plane",),
    "cloud": (),
    "rain": ("plane",),
    "stream": ("tube",),
}
PERIODIC_OF: dict[str, tuple[str, ...]] = {"cloud": ("x", "y", "z"), "rain": ("x", "y")}
# Starts that need domain.size, the block in which the spheres are put at random.
FILLED = ("cloud", "rain", "stream")
SHARES_ROUND_OFF = 1e-6


class Effects(_Table):
    """What is simulated: "auto" leaves it to the plan, "on" and "off" force it. Names as in `planning.situation.EFFECTS`."""

    adhesion: Wish = "auto"
    neck: Wish = "auto"
    sliding: Wish = "auto"
    sliding_adhesion: Wish = "auto"
    rolling: Wish = "auto"
    twisting: Wish = "auto"
    damping: Wish = "auto"
    gravity: Wish = "auto"
    original_limits: Wish = "auto"


class Particles(_Table):
    """Spheres of one material: `radius`, or `radii` with the `shares` of their number; all entries start alike."""

    name: str
    material: str
    number: Annotated[int, _quantity("", "Give how many spheres.", ge=1)]
    start: Start
    radius: Annotated[float, _quantity("m", "Give the radius of the spheres.", gt=0)] | None = None
    radii: tuple[Annotated[float, _quantity("m", "Give the radius of each class.", gt=0)], ...] = ()
    shares: tuple[Annotated[float, _quantity("", "It is the part of the number, 0 to 1.", gt=0, le=1)], ...] = ()

    @property
    def classes(self) -> tuple[tuple[float, int], ...]:
        """Radius [m] and number of each size class; the numbers add up, largest remainders first."""
        if self.radius is not None:
            return ((self.radius, self.number),)
        wanted = [share * self.number for share in self.shares]
        counts = [math.floor(value) for value in wanted]
        order = sorted(range(len(wanted)), key=lambda index: counts[index] - wanted[index])
        for index in order[: self.number - sum(counts)]:
            counts[index] += 1
        return tuple((radius, count) for radius, count in zip(self.radii, counts, strict=True) if count)

    @model_validator(mode="after")
    def _sizes_are_complete(self) -> Particles:
        if (self.radius is None) == (not self.radii):
            raise _fault(f"'{self.name}' needs either radius or radii [m]. Give exactly one of them.")
        if len(self.radii) != len(self.shares):
            raise _fault(f"'{self.name}': radii and shares must be as many. Give each radius its part of the number.")
        _refuse_repeats("radii", self.radii)
        if self.shares and abs(sum(self.shares) - 1) > SHARES_ROUND_OFF:
            raise _fault(f"'{self.name}': shares add up to {sum(self.shares):g}, not 1. Correct them.")
        if self.start == "agglomerate" and self.radii:
            raise _fault(f"'{self.name}': an agglomerate is built of equal spheres. Give radius instead of radii.")
        return self


class Wall(_Table):
    """The wall: the plane z = 0 below the spheres, or a tube along y around the origin."""

    material: str
    shape: Literal["plane", "tube"]
    radius: Annotated[float, _quantity("m", "Give the outer radius of the tube.", gt=0)] | None = None
    length: Annotated[float, _quantity("m", "Give the length of the tube.", gt=0)] | None = None

    @model_validator(mode="after")
    def _tube_has_its_size(self) -> Wall:
        for key in ("radius", "length"):
            if self.shape == "tube" and getattr(self, key) is None:
                raise _fault(f"shape = 'tube' needs {key}. Give it in m.")
            if self.shape == "plane" and getattr(self, key) is not None:
                raise _fault(f"{key} belongs to shape = 'tube'. Remove it or change the shape.")
        return self


class Motion(_Table):
    """How the spheres move at the start, and what pulls at them.

    `speed`: of approach in a pair; of flight towards the wall otherwise. `angle`: between flight and wall normal, towards +x.
    `spread`: standard deviation of each component of a cloud's velocities. `gravity` acts along -z.
    """

    speed: Annotated[float, _quantity("m/s", "Give 0 for spheres at rest.", ge=0)] = 0.0
    angle: Annotated[float, _quantity("degrees", "It is measured from the surface normal.", ge=0, lt=90)] = 0.0
    spread: Annotated[float, _quantity("m/s", "Give 0 for none.", ge=0)] = 0.0
    gravity: Annotated[float, _quantity("m/s2", "Give 9.81, or 0 for none.", ge=0)] = 0.0


class Gas(_Table):
    """A uniform gas: Stokes' drag 6 pi viscosity r (velocity - v) on every sphere, whatever its neighbours."""

    viscosity: Annotated[float, _quantity("Pa s", "Leave [gas] out for no drag.", gt=0)]
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Domain(_Table):
    """The block in which spheres are put at random [m]; periodic along the axes named, where the block is the whole domain."""

    size: tuple[
        Annotated[float, _quantity("m", "Give x, y and z.", gt=0)],
        Annotated[float, _quantity("m", "Give x, y and z.", gt=0)],
        Annotated[float, _quantity("m", "Give x, y and z.", gt=0)],
    ]
    periodic: tuple[Literal["x", "y", "z"], ...] = ()


class Duration(_Table):
    """How long, and what is kept: `frames` snapshots at even intervals, or fewer, at least half. `seed` decides all that is random."""

    duration: Annotated[float, _quantity("s", "Give the time to simulate.", gt=0)]
    seed: Annotated[int, _quantity("", "Give any whole number.", ge=0)] = 1
    frames: Annotated[int, _quantity("", "One is the end alone.", ge=1, le=10000)] = 40


class Numerics(_Table):
    """Settings that belong to no effect. `rolling_damping`: of `rolling_friction krijt`, over critical; lets piles come to rest."""

    rolling_damping: Annotated[float, _quantity("", "Set 0 for none.", ge=0)] = 0.0
    skin: Annotated[float, _quantity("m", "Leave it out and the deck chooses one.", gt=0)] | None = None


class Application(_Table):
    """A validated scene of many particles. Quantities are in SI units, of the real material."""

    title: str
    about: About | None = None
    effects: Effects = Effects()
    material: dict[str, Material]
    contact: Annotated[tuple[Contact, ...], Field(min_length=1)]
    particles: Annotated[tuple[Particles, ...], Field(min_length=1)]
    wall: Wall | None = None
    motion: Motion = Motion()
    gas: Gas | None = None
    domain: Domain | None = None
    run: Duration
    numerics: Numerics = Numerics()
    source: Annotated[str, Field(init=False)] = "scene"

    @property
    def start(self) -> Start:
        """How the spheres start; the same for all entries."""
        return self.particles[0].start

    @property
    def number(self) -> int:
        """Of all spheres."""
        return sum(entry.number for entry in self.particles)

    @property
    def materials(self) -> tuple[str, ...]:
        """Names of the materials in use, in the order of their atom types."""
        used = [entry.material for entry in self.particles] + ([self.wall.material] if self.wall else [])
        return tuple(dict.fromkeys(used))

    @property
    def radii(self) -> tuple[float, ...]:
        """Smallest and largest radius [m]."""
        every = [radius for entry in self.particles for radius, _ in entry.classes]
        return min(every), max(every)

    def pair(self, first: str, second: str) -> Contact:
        """The contact of two materials."""
        return next(contact for contact in self.contact if set(contact.between) == {first, second})

    @property
    def periodic(self) -> tuple[bool, bool, bool]:
        """Whether the domain is periodic along x, y and z."""
        axes = self.domain.periodic if self.domain else ()
        return ("x" in axes, "y" in axes, "z" in axes)

    @model_validator(mode="after")
    def _says_what_it_is_about(self) -> Application:
        if not self.title.isprintable():
            raise _fault("title must be one line of printable characters.")
        if self.about is None:
            raise _fault("about is missing. Set 'impact', 'strength' or 'structure': what the result must be right about.")
        return self

    @model_validator(mode="after")
    def _start_has_what_it_needs(self) -> Application:
        start = self.start
        if any(entry.start != start for entry in self.particles):
            raise _fault(f"particles start in several ways; the first is '{start}'. Let all start alike.")
        shapes = WALL_OF[start]
        if bool(shapes) != (self.wall is not None) or (self.wall and self.wall.shape not in shapes):
            wanted = f"a [wall] with shape = '{shapes[0]}'. Add it" if shapes else "no [wall]. Remove it"
            raise _fault(f"start = '{start}' wants {wanted}, or change the start.")
        if (start in FILLED) != (self.domain is not None):
            raise _fault(f"start = '{start}' {'needs [domain] with size. Add' if start in FILLED else 'has no [domain]. Remove'} it.")
        axes = PERIODIC_OF.get(start, ())
        if self.domain and tuple(sorted(self.domain.periodic)) != axes:
            raise _fault(f"domain: start = '{start}' wants periodic = {list(axes)!r}. Change it.")
        fixed = {"pair": 2, "single": 1}.get(start)
        if fixed is not None and self.number != fixed:
            raise _fault(f"particles: start = '{start}' has {fixed} sphere{'s' * (fixed > 1)}, not {self.number}. Change number.")
        if start == "agglomerate" and len(self.particles) > 1:
            raise _fault("particles: an agglomerate is built of equal spheres. Keep one [[particles]].")
        moved = self.motion.spread if start == "cloud" else self.motion.speed
        if moved == 0 and not (start == "rain" and self.motion.gravity > 0):
            raise _fault(f"motion: start = '{start}' needs {'spread' if start == 'cloud' else 'speed'} > 0. Give it in m/s.")
        if self.motion.angle > 0 and start not in ("single", "agglomerate"):
            raise _fault(f"motion: angle belongs to start = 'single' or 'agglomerate', not '{start}'. Remove it.")
        return self

    @model_validator(mode="after")
    def _materials_and_contacts_match(self) -> Application:
        named = [(f"particles '{entry.name}'", entry.material) for entry in self.particles]
        named += [("wall", self.wall.material)] if self.wall else []
        named += [("contact", name) for contact in self.contact for name in contact.between]
        for table, name in named:
            if name not in self.material:
                known = ", ".join(repr(key) for key in self.material)
                raise _fault(f"{table} names material '{name}', which has no table. Add [material.{name}] or use one of {known}.")
        spheres = list(dict.fromkeys(entry.material for entry in self.particles))
        wanted = {frozenset(pair) for pair in itertools.combinations_with_replacement(spheres, 2)}
        if self.start == "single":
            wanted = set()
        if self.start == "pair":
            wanted = {frozenset(spheres)}
        wanted |= {frozenset((name, self.wall.material)) for name in spheres} if self.wall else set()
        given = [frozenset(contact.between) for contact in self.contact]
        for index, pair in enumerate(given):
            names = "'-'".join(self.contact[index].between)
            if pair in given[:index]:
                raise _fault(f"contact '{names}' is given twice. Keep one of them.")
            if pair not in wanted:
                raise _fault(f"contact '{names}' never happens in this scene. Remove it.")
        for pair in sorted(wanted - set(given), key=sorted):
            between = ", ".join(f'"{name}"' for name in sorted(pair) * (3 - len(pair)))
            raise _fault(f"the scene needs a [[contact]] with between = [{between}]. Add it.")
        for contact in self.contact:
            if contact.effective_modulus is not None:
                raise _fault(
                    "effective_modulus belongs to impacts of one pair. Give youngs_modulus of each material instead;"
                    " equal ones have 2 (1 - nu^2) times the effective value."
                )
        for name in self.materials:
            if self.material[name].youngs_modulus is None:
                raise _fault(f"material '{name}': youngs_modulus is missing. Give it in Pa.")
        for name in spheres:
            if self.material[name].density is None:
                raise _fault(f"material '{name}': density is missing. Give it in kg/m3.")
        return self


def load(path: str | Path) -> Application:
    """Read and validate a scene file of many particles.

    Parameters
    ----------
    path : str or Path
        TOML file with [[particles]].

    Returns
    -------
    Application
        Frozen; all quantities in SI units.

    Raises
    ------
    SceneError
        One line: file, table, key, rule, remedy.
    """
    return validated(Application, Path(path))


def is_application(path: str | Path) -> bool:
    """Whether a scene file is one of many particles: it has [[particles]], where a scene of impacts has [impact]."""
    return "particles" in read(Path(path))
