"""What probes are made of: the numbers that they compare, spheres in lanes, the deck of a variant, what is read back.

Covers Haervig 2017, eq. A.9 (overlap without load). Assumes that a lane does not feel the next one, and one material for all spheres of
a probe and its wall: what is softened is the pair, so each kind of contact gets probes of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from pyjkr import contact
from pyjkr.contact import PairProperties
from pyjkr.planning import probe_deck
from pyjkr.planning.probe_deck import Material, ProbeDeck, Sphere, Vector
from pyjkr.planning.situation import Meeting
from pyjkr.planning.variants import Variant

# Between lanes, in radii of the largest sphere: beyond any neighbour list.
LANE_IN_RADII = 5
# Factor on the density of a sphere whose motion is prescribed: contact forces change no digit of its speed.
HEAVY = 1e18
SKIN_IN_RADII, SKIN_IN_NECKS = 0.2, 4.0
STILL: tuple[Vector, Vector, Vector] = ((0.0, 0.0, 0.0),) * 3


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One number that a probe looks at.

    Attributes
    ----------
    name : str
        "e_eff^2", "sticking", "tangential speed", ...
    values : ndarray
        Of all lanes; not a number where there is none, as the speed of rebound of what sticks.
    relative : bool
        Whether the error is taken relative to the reference's value.
    floor : float
        Least that a relative error is taken of: what a moment that hardly matters is to be compared with.
    decision : bool
        Whether it is one of yes and no: stuck or not, held or not. The error is the part of the lanes that decided differently.
    margin : ndarray or None
        How clear a decision is: the energy with which a sphere leaves, in parts of the impact's, 0 of those that stick. Lanes where
        neither run leaves with more than `max_error` are on the threshold, where no energy within `max_error` decides, and are not counted.
    promised : bool
        Whether the plan promises it; if not it is shown, not judged.
    note : str
        Why not.
    """

    name: str
    values: np.ndarray
    relative: bool = False
    floor: float = 0.0
    decision: bool = False
    margin: np.ndarray | None = None
    promised: bool = True
    note: str = ""


@dataclass(frozen=True)
class Probe:
    """One small experiment.

    Attributes
    ----------
    label : str
        For tables and directories.
    meeting : Meeting
        Whose contact it is.
    deck : callable
        Variant -> deck.
    read : callable
        Frames and variant -> quantities.
    """

    label: str
    meeting: Meeting
    deck: Callable[[Variant], ProbeDeck]
    read: Callable[[pd.DataFrame, Variant], list[Quantity]] = field(repr=False)


def material(variant: Variant, meeting: Meeting) -> Material:
    """What the deck of a variant gives to the contact of a meeting."""
    pair, real = variant.pair(meeting), meeting.pair
    nu = probe_deck.poissons_ratio(real.effective_modulus, real.effective_shear_modulus)
    adhesive = pair.surface_energy > 0
    return Material(
        youngs_modulus=contact.particle_modulus(pair.effective_modulus, nu),
        poissons_ratio=nu,
        restitution_coefficient=pair.restitution_coefficient,
        friction_coefficient=meeting.friction_coefficient,
        surface_energy=pair.surface_energy,
        youngs_modulus_original=contact.particle_modulus(real.effective_modulus, nu),
        surface_energy_original=real.surface_energy,
        critical_rolling_angle=meeting.critical_rolling / real.effective_radius if variant.styles.rolling_friction == "krijt" else None,
        originals=adhesive and "original_limits" in variant.effects,
    )


def deck(title: str, variant: Variant, meeting: Meeting, spheres: Sequence[Sphere], steps: int, **more) -> ProbeDeck:
    """The deck of a probe in the styles of a variant; what `more` names is taken in place of the variant's.

    Parameters
    ----------
    title : str
        Of the deck.
    variant, meeting
        Law, and what meets.
    spheres : sequence of Sphere
        All of them.
    steps : int
        Of the run.
    **more
        Fields of `ProbeDeck`.
    """
    return ProbeDeck(
        title=f"{title}, {variant.name}",
        spheres=tuple(spheres),
        material=more.pop("material", None) or material(variant, meeting),
        styles=more.pop("styles", variant.styles.text),
        time_step=variant.time_step,
        runs=(steps,),
        skin=max(SKIN_IN_RADII * min(meeting.radii), SKIN_IN_NECKS * neck(variant, meeting)),
        every=more.pop("every", steps),
        wall=more.pop("wall", len(meeting.radii) == 1),
        **more,
    )


def placed(meeting: Meeting, lane: int, motion: tuple[Vector, Vector, Vector], gap: float, **first) -> list[Sphere]:
    """Spheres of one lane: the first above the second, or above the wall.

    Parameters
    ----------
    meeting : Meeting
        Who meets.
    lane : int
        Number of the lane.
    motion : tuple
        Offset of the first from contact [m], its velocity relative to the second [m/s], its spin [rad/s].
    gap : float
        Between the surfaces [m], negative for an overlap.
    **first
        `force` [N] on the first; the second is pulled the other way. `density_factor` of both.
    """
    offset, velocity, spin = motion
    y = lane * LANE_IN_RADII * max(meeting.radii)
    masses = [density * r**3 for density, r in zip(meeting.densities, meeting.radii, strict=True)]
    share = masses[1] / sum(masses) if len(masses) == 2 else 1.0
    place = (offset[0], y + offset[1], sum(meeting.radii) + gap + offset[2])
    factor = first.pop("density_factor", 1.0)
    spheres = [
        Sphere(radius=meeting.radii[0], density=factor * meeting.densities[0], position=place,
               velocity=tuple(share * v for v in velocity), spin=spin, **first)
    ]  # fmt: skip
    if len(masses) == 2:
        # Spins that do not slip on each other.
        other = tuple(-meeting.radii[0] / meeting.radii[1] * w for w in spin)
        spheres.append(
            Sphere(radius=meeting.radii[1], density=factor * meeting.densities[1], position=(0.0, y, 0.0),
                   velocity=tuple((share - 1) * v for v in velocity), spin=other,
                   force=tuple(-f for f in first.get("force", (0.0, 0.0, 0.0))))
        )  # fmt: skip
    return spheres


def last(frame: pd.DataFrame) -> pd.DataFrame:
    """The last frame, by identifier."""
    return frame[frame["step"] == frame["step"].max()].sort_values("id")


def relative(end: pd.DataFrame, meeting: Meeting) -> tuple[np.ndarray, np.ndarray, pd.DataFrame, pd.DataFrame]:
    """Place and velocity of every first sphere relative to its second one or to the wall, and the spheres themselves."""
    many = len(meeting.radii)
    first, second = end.iloc[::many], end.iloc[1::many]
    place, speed = (first[[f"{v}{axis}" for axis in "xyz"]].to_numpy() for v in ("", "v"))
    if many == 2:
        return place - second[["x", "y", "z"]].to_numpy(), speed - second[["vx", "vy", "vz"]].to_numpy(), first, second
    place[:, :2] = 0.0
    return place, speed, first, second


def neck(variant: Variant, meeting: Meeting) -> float:
    """Length of the longest neck [m]; 0 where the law has none."""
    return -contact.rupture_overlap(variant.pair(meeting), variant.styles.normal)


def rest_overlap(pair: PairProperties) -> float:
    """Overlap without load [m]: a_0^2/(3 R); Haervig 2017, eq. A.9 at a_0."""
    return pair.equilibrium_contact_radius**2 / (3 * pair.effective_radius)
