"""Probes of contacts that last: where they yield to sliding, rolling and twisting, whether they hold a pull, how deep a stack presses.

Covers Haervig 2017, eqs 17 and 21 (limits of sliding and rolling), Chen 2019, eq. 3 (of twisting), Haervig 2017, sec. 6.2 (contacts that
hold). Assumes a prescribed, slow motion for the limits, so that no dashpot and no inertia are part of them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np
import pandas as pd

from pyjkr import contact, timestep
from pyjkr.contact import PairProperties
from pyjkr.planning import probe_deck, probe_parts
from pyjkr.planning.measures import QUARTER_TURN
from pyjkr.planning.probe_deck import ProbeDeck, Sphere
from pyjkr.planning.probe_impacts import COLLISIONS
from pyjkr.planning.probe_parts import Probe, Quantity
from pyjkr.planning.situation import Meeting
from pyjkr.planning.variants import Variant

Motion = Literal["sliding", "rolling", "twisting"]
# Steps of a contact that is moved until it yields, and its way in critical displacements: the moment is read once it has yielded.
YIELD_STEPS, YIELD_WAY = 400, 2.0
# Component of the torque that tells a moment: rolling and sliding along x turn about y, twisting about the normal.
TORQUE = {"sliding": "tqy", "rolling": "tqy", "twisting": "tqz"}
# The stack: layers of four spheres in contact along the diagonals of a body-centred lattice; periods of one contact until it rests.
LAYERS, STACK_PERIODS = 5, 80
# Only the rest counts, which damping does not change; e of the stack.
STACK_RESTITUTION = 0.3
# Part of the volume strain: three directions.
DIRECTIONS = 3
NOT_PROMISED = "in an impact a moment that softening lowers acts for longer, and the product is kept"


def yields(meeting: Meeting, motion: Motion, floor: float, *, promised: bool = True) -> Probe:
    """A contact without load that slides, rolls or twists at a prescribed, slow pace until its moment no longer rises.

    Parameters
    ----------
    meeting : Meeting
        Whose contact it is.
    motion : str
        "sliding", "rolling" or "twisting".
    floor : float
        Moment [N m] that the error is taken of at least: the one of the load, which a smaller limit could not change.
    promised : bool
        Whether the limit is part of the result.
    """
    label = f"{meeting.label}: {motion}"

    def deck(variant: Variant) -> ProbeDeck:
        pair, duration = variant.pair(meeting), YIELD_STEPS * variant.time_step
        pace = YIELD_WAY * _critical(meeting, pair, motion) / duration
        spin, along = (0.0, 0.0, 0.0), pace if motion == "sliding" else 0.0
        if motion == "rolling":
            # v_L = R omega (1 + r_1/r_2) = r_1 omega for two spheres that do not slip, and at a wall.
            spin, along = (0.0, pace / meeting.radii[0], 0.0), pace if len(meeting.radii) == 1 else 0.0
        elif motion == "twisting":
            spin = (0.0, 0.0, pace / meeting.radii[0])
        moved = ((0.0, 0.0, 0.0), (along, 0.0, 0.0), spin)
        spheres = probe_parts.placed(meeting, 0, moved, -probe_parts.rest_overlap(pair), density_factor=probe_parts.HEAVY)
        if motion == "sliding":
            spheres = [replace(sphere, spin=(0.0, 0.0, 0.0)) for sphere in spheres]
        # Elastic: a dashpot goes with the root of the mass, which is not that of the scene.
        elastic = replace(probe_parts.material(variant, meeting), restitution_coefficient=1.0)
        return probe_parts.deck(
            label, variant, meeting, spheres, YIELD_STEPS, box=probe_deck.box_around(spheres, duration),
            styles=_styles(variant, motion), material=elastic,
        )  # fmt: skip

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        moment = np.abs(probe_parts.last(frame)[TORQUE[motion]].to_numpy()[:1])
        note = "" if promised else NOT_PROMISED
        return [Quantity(name=f"moment of {motion}", values=moment, relative=True, floor=floor, promised=promised, note=note)]

    return Probe(label, meeting, deck, read)


def moment_of_loads(meeting: Meeting, load: float) -> float:
    """Moment [N m] that limits are compared with: of the load, or of the slowest impact over a quarter turn; as in `measures`."""
    if load > 0:
        return load * max(meeting.radii)
    return 0.5 * meeting.pair.effective_mass * meeting.slowest_speed**2 / QUARTER_TURN


def _styles(variant: Variant, motion: Motion) -> str:
    """Only what is looked at: of rolling and sliding both torques are about y."""
    styles = variant.styles
    if motion == "sliding":
        return replace(styles, rolling_friction="off", twisting=False).text
    if motion == "rolling":
        return replace(styles, tangential="off", twisting=False).text
    return styles.text


def _critical(meeting: Meeting, pair: PairProperties, motion: Motion) -> float:
    """Displacement [m] at which a contact without load yields: mu 2 F_C/(8 G a_0), xi_crit; r_1 times the angle of twisting.

    The limits are those of the real material, which are the larger ones; the springs are those of the pair.
    """
    if motion == "rolling":
        return meeting.critical_rolling
    radius, force = max(pair.equilibrium_contact_radius, meeting.pair.equilibrium_contact_radius), 2 * meeting.pair.pull_off_force
    slide = meeting.friction_coefficient * force / (8 * pair.effective_shear_modulus * radius)
    # (2/3) a F_crit over k_T a^2/2.
    return slide if motion == "sliding" else 4 / 3 * slide / radius * meeting.radii[0]


def pull(meeting: Meeting, force: float) -> Probe:
    """A contact without load that is suddenly pulled with a force [N]."""
    label = f"{meeting.label}: pull {force:.3g} N"

    def deck(variant: Variant) -> ProbeDeck:
        pair = variant.pair(meeting)
        spheres = probe_parts.placed(meeting, 0, probe_parts.STILL, -probe_parts.rest_overlap(pair), force=(0.0, 0.0, force))
        duration = COLLISIONS * timestep.collision_time(pair, meeting.speed)
        away = 0.5 * force / pair.effective_mass * duration**2
        box = tuple(edge + sign * away for edge, sign in zip(probe_deck.box_around(spheres), (-1, 1) * 3, strict=True))
        return probe_parts.deck(label, variant, meeting, spheres, math.ceil(duration / variant.time_step), box=box)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        apart, *_ = probe_parts.relative(probe_parts.last(frame), meeting)
        end = sum(meeting.radii) + probe_parts.neck(variant, meeting)
        return [Quantity(name="held", values=(np.linalg.norm(apart, axis=1) < end).astype(float), decision=True)]

    return Probe(label, meeting, deck, read)


def stack(meeting: Meeting, load: float) -> Probe:
    """Twenty like spheres on each other, each contact pressed with `load` [N], less what friction takes; the lowest four do not move."""
    radius = 2 * meeting.pair.effective_radius
    density = meeting.pair.effective_mass * 2 / (4 / 3 * math.pi * radius**3)
    like, cell = replace(meeting, radii=(radius, radius), densities=(density, density)), 4 / math.sqrt(3) * radius
    label = f"stack of {meeting.label}"

    def deck(variant: Variant) -> ProbeDeck:
        pair = variant.pair(like)
        distance = 2 * radius - probe_parts.rest_overlap(pair)
        # Neighbours touch along the diagonals: half of the cell's face diagonal across, the rest down.
        down = math.sqrt(distance**2 - cell**2 / 2)
        spheres = []
        for layer in range(LAYERS):
            shift = (layer % 2) * cell / 2
            # A top sphere leans on four contacts under its diagonals, cos = down/distance.
            force = -4 * load * down / distance if layer == LAYERS - 1 else 0.0
            heavy = probe_parts.HEAVY if layer == 0 else 1.0
            spheres += [
                Sphere(radius=radius, density=density * heavy, position=(shift + i * cell, shift + j * cell, layer * down),
                       force=(0.0, 0.0, force))
                for i in range(2) for j in range(2)
            ]  # fmt: skip
        box = (-cell / 4, 1.75 * cell, -cell / 4, 1.75 * cell, -4 * radius, LAYERS * down + 4 * radius)
        pressed = max(_loaded_overlap(pair, load), probe_parts.rest_overlap(pair))
        period = timestep.normal_period(pair, math.sqrt(pair.effective_radius * pressed))
        # A variant that is to follow impacts may take longer steps than a pressed contact allows; LIGGGHTS tells what comes of it.
        # Without adhesion and load nothing moves.
        steps = math.ceil(STACK_PERIODS * period / variant.time_step) if math.isfinite(period) else 1
        damped = replace(probe_parts.material(variant, like), restitution_coefficient=STACK_RESTITUTION)
        return probe_parts.deck(label, variant, like, spheres, steps, box=box, boundary="p p f", material=damped, wall=False)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        places = probe_parts.last(frame)[["x", "y", "z"]].to_numpy()
        i, j = np.triu_indices(len(places), 1)
        apart = places[i] - places[j]
        apart[:, :2] -= 2 * cell * np.round(apart[:, :2] / (2 * cell))
        overlaps = 2 * radius - np.linalg.norm(apart, axis=1)
        touching = overlaps > contact.rupture_overlap(variant.pair(like), variant.styles.normal)
        strain = DIRECTIONS * float(np.mean(overlaps[touching])) / (2 * radius) if touching.any() else 0.0
        return [
            Quantity(name="volume strain by overlaps", values=np.array([strain])),
            Quantity(name="coordination number", values=np.array([2 * np.count_nonzero(touching) / len(places)]), relative=True),
        ]

    return Probe(label, like, deck, read)


def _loaded_overlap(pair: PairProperties, load: float) -> float:
    """Hertz' overlap [m] under the load and twice the pull-off force: F = (4/3) E sqrt(R) delta^(3/2)."""
    force = load + 2 * pair.pull_off_force
    return (3 * force / (4 * pair.effective_modulus * math.sqrt(pair.effective_radius))) ** (2 / 3)
