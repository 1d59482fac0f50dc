"""What `pyjkr plan --verify` runs: impacts, a contact that rolls until it yields, one that is pulled, a compressed stack.

Covers e_eff and sticking (Haervig 2017, sec. 6.1), tangential speed and spin (sec. 3), the yield moment 4 F_C xi_crit (eq. 21), contacts
that hold (sec. 6.2), overlaps at rest. Assumes that a scene goes wrong where its fastest, slowest or most loaded contact does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from pyjkr import contact, timestep
from pyjkr.contact import PairProperties
from pyjkr.planning import probe_deck
from pyjkr.planning.probe_deck import Material, ProbeDeck, Sphere, Vector
from pyjkr.planning.situation import Meeting, Situation
from pyjkr.planning.variants import Variant

# Steps of free flight before contact, and fractions of a step at which contact begins: errors depend on them.
FLIGHT_STEPS = 5
PHASES = (0.1, 0.3, 0.5, 0.7, 0.9)
# A sphere that leaves near the sticking threshold has left after less than two collision times.
COLLISIONS = 6
# Between lanes, in radii of the largest sphere: beyond any neighbour list.
LANE_IN_RADII = 5
# Factor on the density of a sphere whose motion is prescribed: contact forces change no digit of its speed.
HEAVY = 1e18
# Steps of the rolling probe, and its way in critical displacements: the moment is read once it has yielded.
ROLLING_STEPS, ROLLING_WAY = 400, 2.0
# The stack: layers of four spheres in contact along the diagonals of a body-centred lattice; periods of one contact until it rests.
LAYERS, STACK_PERIODS = 5, 150
# Only the rest counts, which damping does not change; e of the stack.
STACK_RESTITUTION = 0.3
SKIN_IN_RADII, SKIN_IN_NECKS = 0.2, 4.0


@dataclass(frozen=True)
class Quantity:
    """One number that a probe looks at.

    Attributes
    ----------
    name : str
        "e_eff^2", "sticking", "tangential speed", ...
    values : ndarray
        Of all phases.
    relative : bool
        Whether the error is taken relative to the reference's value.
    exact : bool
        Whether no difference is allowed: stuck or not, held or not.
    """

    name: str
    values: np.ndarray
    relative: bool = False
    exact: bool = False


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
    read: Callable[[pd.DataFrame, Variant], list[Quantity]]


def probes(situation: Situation, planned: Variant) -> list[Probe]:
    """Everything worth probing in a situation.

    Parameters
    ----------
    situation : Situation
        Its meetings, loads and what the result must be right about.
    planned : Variant
        What is on: yield is looked at where rolling is.
    """
    found = []
    lasting = situation.lasting or situation.about != "impact"
    for meeting in situation.meetings:
        for speed in sorted({meeting.slowest_speed, meeting.speed}):
            found.append(_impact(meeting, speed, 0.0))
        if meeting.tangential_speed > 0:
            found.append(_impact(meeting, meeting.speed, meeting.tangential_speed))
        adhesive = meeting.pair.surface_energy > 0 and situation.wishes.get("adhesion") != "off"
        if adhesive and lasting and "rolling" in planned.effects and math.isfinite(meeting.critical_rolling):
            found.append(_rolling(meeting))
        if adhesive and situation.pulling_force > 0:
            found.append(_pull(meeting, situation.pulling_force))
    pairs = [meeting for meeting in situation.meetings if len(meeting.radii) == 2]
    if situation.many_contacts and pairs:
        # The softest contact of the scene for its size: lowest E R.
        worst = min(pairs, key=lambda meeting: meeting.pair.effective_modulus * meeting.pair.effective_radius)
        if situation.weight_carried > 0 or worst.pair.surface_energy > 0:
            found.append(_stack(worst, situation.weight_carried))
    return found


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


def _deck(title: str, variant: Variant, meeting: Meeting, spheres: Sequence[Sphere], steps: int, **more) -> ProbeDeck:
    neck = -contact.rupture_overlap(variant.pair(meeting), variant.styles.normal)
    return ProbeDeck(
        title=f"{title}, {variant.name}",
        spheres=tuple(spheres),
        material=more.pop("material", None) or material(variant, meeting),
        styles=more.pop("styles", variant.styles.text),
        time_step=more.pop("time_step", variant.time_step),
        runs=(steps,),
        skin=max(SKIN_IN_RADII * min(meeting.radii), SKIN_IN_NECKS * neck),
        every=more.pop("every", steps),
        wall=more.pop("wall", len(meeting.radii) == 1),
        **more,
    )


def _placed(meeting: Meeting, lane: int, motion: tuple[Vector, Vector, Vector], gap: float, **first) -> list[Sphere]:
    """Spheres of one lane: offset of the first from contact, its velocity, its spin; a second one below, or the wall."""
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


def _impact(meeting: Meeting, speed: float, along: float) -> Probe:
    """Impacts that begin at several fractions of a step."""
    kind = f"oblique {speed:.4g}, {along:.4g} m/s" if along else f"head-on {speed:.4g} m/s"

    def deck(variant: Variant) -> ProbeDeck:
        spheres = []
        for lane, phase in enumerate(PHASES):
            flight = (FLIGHT_STEPS + phase) * variant.time_step
            motion = ((-along * flight, 0.0, 0.0), (along, 0.0, -speed), (0.0, 0.0, 0.0))
            spheres += _placed(meeting, lane, motion, speed * flight)
        duration = COLLISIONS * timestep.collision_time(variant.pair(meeting), speed)
        steps = FLIGHT_STEPS + math.ceil(duration / variant.time_step)
        box = probe_deck.box_around(spheres, steps * variant.time_step)
        return _deck(f"{meeting.label}: {kind}", variant, meeting, spheres, steps, box=box)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        apart, velocity, first, second = _relative(frame[frame["step"] == frame["step"].max()], meeting)
        stuck = np.linalg.norm(apart, axis=1) < sum(meeting.radii) - contact.rupture_overlap(variant.pair(meeting), variant.styles.normal)
        decided = Quantity("sticking", stuck.astype(float), exact=True)
        if not along:
            return [Quantity("e_eff^2", np.where(stuck, 0.0, velocity[:, 2] / speed) ** 2), decided]
        whole = math.hypot(speed, along)
        # What still touches rolls on for as long as it is watched; how far is a matter of time, not of the impact.
        free = np.where(stuck, 0.0, 1 / whole)
        spins = np.concatenate([spin["omegay"].to_numpy() * r * free for spin, r in zip((first, second), meeting.radii, strict=False)])
        return [
            Quantity("normal speed", velocity[:, 2] * free),
            Quantity("tangential speed", velocity[:, 0] * free),
            Quantity("spin times radius", spins),
            decided,
        ]

    return Probe(f"{meeting.label}: {kind}", meeting, deck, read)


def _rolling(meeting: Meeting) -> Probe:
    """A contact without load that rolls at a prescribed, slow spin until its moment no longer rises."""

    def deck(variant: Variant) -> ProbeDeck:
        pair = variant.pair(meeting)
        step = variant.time_step
        # v_L = R omega (1 + r_1/r_2) = r_1 omega for two spheres that do not slip, and at a wall.
        spin = ROLLING_WAY * meeting.critical_rolling / (meeting.radii[0] * ROLLING_STEPS * step)
        along = spin * meeting.radii[0] if len(meeting.radii) == 1 else 0.0
        motion = ((0.0, 0.0, 0.0), (along, 0.0, 0.0), (0.0, spin, 0.0))
        spheres = _placed(meeting, 0, motion, -_rest_overlap(pair), density_factor=HEAVY)
        box = probe_deck.box_around(spheres, ROLLING_STEPS * step)
        # Without sliding friction: the torque is that of rolling alone.
        styles = f"model {variant.styles.normal} tangential off rolling_friction krijt"
        return _deck(f"{meeting.label}: rolling", variant, meeting, spheres, ROLLING_STEPS, box=box, styles=styles)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        last = frame[frame["step"] == frame["step"].max()].sort_values("id")
        return [Quantity("yield moment", np.abs(last["tqy"].to_numpy()[:1]), relative=True)]

    return Probe(f"{meeting.label}: rolling", meeting, deck, read)


def _pull(meeting: Meeting, force: float) -> Probe:
    """A contact without load that is suddenly pulled."""

    def deck(variant: Variant) -> ProbeDeck:
        pair = variant.pair(meeting)
        still = ((0.0, 0.0, 0.0),) * 3
        spheres = _placed(meeting, 0, still, -_rest_overlap(pair), force=(0.0, 0.0, force))
        duration = COLLISIONS * timestep.collision_time(pair, meeting.speed)
        away = 0.5 * force / pair.effective_mass * duration**2
        box = tuple(edge + sign * away for edge, sign in zip(probe_deck.box_around(spheres), (-1, 1) * 3, strict=True))
        steps = math.ceil(duration / variant.time_step)
        return _deck(f"{meeting.label}: pull {force:.3g} N", variant, meeting, spheres, steps, box=box)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        apart, *_ = _relative(frame[frame["step"] == frame["step"].max()], meeting)
        end = sum(meeting.radii) - contact.rupture_overlap(variant.pair(meeting), variant.styles.normal)
        return [Quantity("held", (np.linalg.norm(apart, axis=1) < end).astype(float), exact=True)]

    return Probe(f"{meeting.label}: pull {force:.3g} N", meeting, deck, read)


def _stack(meeting: Meeting, load: float) -> Probe:
    """Twenty like spheres on each other, pressed until each contact carries `load` [N]; the lowest four do not move."""
    radius = 2 * meeting.pair.effective_radius
    density = meeting.pair.effective_mass * 2 / (4 / 3 * math.pi * radius**3)
    like = replace(meeting, radii=(radius, radius), densities=(density, density))

    def deck(variant: Variant) -> ProbeDeck:
        pair = variant.pair(like)
        distance = 2 * radius - _rest_overlap(pair)
        cell = 2 / math.sqrt(3) * 2 * radius
        # Neighbours touch along the diagonals: half of the cell's face diagonal across, the rest down.
        down = math.sqrt(distance**2 - cell**2 / 2)
        spheres = []
        for layer in range(LAYERS):
            shift = (layer % 2) * cell / 2
            for i in range(2):
                for j in range(2):
                    # A top sphere leans on four contacts under its diagonals, cos = down/distance.
                    force = -4 * load * down / distance if layer == LAYERS - 1 else 0.0
                    spheres.append(
                        Sphere(radius=radius, density=density * (HEAVY if layer == 0 else 1.0),
                               position=(shift + i * cell, shift + j * cell, layer * down), force=(0.0, 0.0, force))
                    )  # fmt: skip
        box = (-cell / 4, 1.75 * cell, -cell / 4, 1.75 * cell, -4 * radius, LAYERS * down + 4 * radius)
        pressed = max(_loaded_overlap(pair, load), _rest_overlap(pair))
        period = timestep.normal_period(pair, math.sqrt(pair.effective_radius * pressed))
        # A variant that is to follow impacts may take longer steps than a pressed contact allows; LIGGGHTS tells what comes of it.
        steps = math.ceil(STACK_PERIODS * period / variant.time_step)
        damped = replace(material(variant, like), restitution_coefficient=STACK_RESTITUTION)
        return _deck(f"stack of {meeting.label}", variant, like, spheres, steps, box=box, boundary="p p f", material=damped, wall=False)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        last = frame[frame["step"] == frame["step"].max()].sort_values("id")
        places = last[["x", "y", "z"]].to_numpy()
        cell = 4 / math.sqrt(3) * radius
        i, j = np.triu_indices(len(places), 1)
        apart = places[i] - places[j]
        apart[:, :2] -= 2 * cell * np.round(apart[:, :2] / (2 * cell))
        overlaps = 2 * radius - np.linalg.norm(apart, axis=1)
        touching = overlaps > contact.rupture_overlap(variant.pair(like), variant.styles.normal)
        strain = float(np.mean(overlaps[touching])) / (2 * radius) if touching.any() else 0.0
        return [
            Quantity("mean overlap over diameter", np.array([strain])),
            Quantity("coordination number", np.array([2 * np.count_nonzero(touching) / len(places)]), relative=True),
        ]

    return Probe(f"stack of {meeting.label}", like, deck, read)


def _rest_overlap(pair: PairProperties) -> float:
    """Overlap without load [m]: a_0^2/(3 R); Haervig 2017, eq. A.9 at a_0."""
    return pair.equilibrium_contact_radius**2 / (3 * pair.effective_radius)


def _loaded_overlap(pair: PairProperties, load: float) -> float:
    """Hertz' overlap [m] under the load and twice the pull-off force: F = (4/3) E sqrt(R) delta^(3/2)."""
    force = load + 2 * pair.pull_off_force
    return (3 * force / (4 * pair.effective_modulus * math.sqrt(pair.effective_radius))) ** (2 / 3)


def _relative(last: pd.DataFrame, meeting: Meeting) -> tuple[np.ndarray, np.ndarray, pd.DataFrame, pd.DataFrame]:
    """Place and velocity of every first sphere relative to its second one or to the wall, and the spheres themselves."""
    last = last.sort_values("id")
    many = len(meeting.radii)
    first, second = last.iloc[::many], last.iloc[1::many]
    place, speed = (first[[f"{v}{axis}" for axis in "xyz"]].to_numpy() for v in ("", "v"))
    if many == 2:
        return place - second[["x", "y", "z"]].to_numpy(), speed - second[["vx", "vy", "vz"]].to_numpy(), first, second
    place[:, :2] = 0.0
    return place, speed, first, second
