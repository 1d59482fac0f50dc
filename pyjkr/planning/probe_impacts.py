"""Probes of impacts: head-on and oblique, and how far what sticks to a wall rolls before it rests.

Covers e_eff and sticking (Haervig 2017, sec. 6.1), tangential speed and spin (sec. 3), rolling resistance that stops a sphere (eqs 18, 21).
Assumes spheres that do not spin before the impact.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from pyjkr import timestep
from pyjkr.planning import collisions, probe_deck, probe_parts
from pyjkr.planning.probe_deck import ProbeDeck
from pyjkr.planning.probe_parts import Probe, Quantity
from pyjkr.planning.situation import Meeting
from pyjkr.planning.variants import Variant

# Steps of free flight before contact, and fractions of a step at which contact begins: errors depend on them.
FLIGHT_STEPS = 5
PHASES = (0.1, 0.3, 0.5, 0.7, 0.9)
# A sphere that leaves near the sticking threshold has left after less than two collision times.
COLLISIONS = 6
# Frames of a sphere that rolls until it rests; it is watched for so many times of stopping, and periods of sticking and of rolling.
# At rest it still swings about its place: of the last two periods the middle counts.
FRAMES, STOPS, SETTLING_PERIODS, SWINGS, READ_SWINGS = 400, 1.5, 4, 4, 2
NOT_PROMISED = "speeds after one oblique impact are not what the scene is about"


def impact(meeting: Meeting, speed: float, along: float, *, promised: bool = True) -> Probe:
    """Impacts that begin at several fractions of a step.

    Parameters
    ----------
    meeting : Meeting
        Who meets.
    speed, along : float
        Normal and tangential speed [m/s].
    promised : bool
        Whether speeds after an oblique impact are part of the result; e_eff^2 and sticking always are.
    """
    kind = f"oblique {speed:.4g}, {along:.4g} m/s" if along else f"head-on {speed:.4g} m/s"

    def deck(variant: Variant) -> ProbeDeck:
        spheres = _flying(meeting, variant, speed, along)
        duration = COLLISIONS * timestep.collision_time(variant.pair(meeting), speed)
        steps = FLIGHT_STEPS + math.ceil(duration / variant.time_step)
        box = probe_deck.box_around(spheres, steps * variant.time_step)
        return probe_parts.deck(f"{meeting.label}: {kind}", variant, meeting, spheres, steps, box=box)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        apart, velocity, first, second = probe_parts.relative(probe_parts.last(frame), meeting)
        distance = np.linalg.norm(apart, axis=1)
        stuck = distance < sum(meeting.radii) + probe_parts.neck(variant, meeting)
        kept = np.where(stuck, 0.0, np.sum(velocity * apart, axis=1) / distance / speed) ** 2
        decided = Quantity(name="sticking", values=stuck.astype(float), decision=True, margin=kept)
        if not along:
            return [Quantity(name="e_eff^2", values=kept), decided]
        # What sticks without rolling resistance rolls on at its speed; with it `way` is to be looked at, or two spheres turn as one.
        settles = len(meeting.radii) == 2 or math.isfinite(meeting.critical_rolling)
        over = np.where(stuck & settles, np.nan, 1 / math.hypot(speed, along))
        spins = np.concatenate([spin["omegay"].to_numpy() * r * over for spin, r in zip((first, second), meeting.radii, strict=False)])
        speeds = {"normal speed": velocity[:, 2] * over, "tangential speed": velocity[:, 0] * over, "spin times radius": spins}
        note = "" if promised else NOT_PROMISED
        return [*(Quantity(name=name, values=values, promised=promised, note=note) for name, values in speeds.items()), decided]

    return Probe(f"{meeting.label}: {kind}", meeting, deck, read)


def way(meeting: Meeting, rolling_damping: float = 0.0) -> Probe:
    """Spheres that hit a wall obliquely, stick, and roll until resistance has stopped them.

    Parameters
    ----------
    meeting : Meeting
        A sphere and a wall, with a limit of rolling.
    rolling_damping : float
        Of `rolling_friction krijt`, over critical: a setting of the scene, the same in both runs; it shortens the way.
    """
    label = f"{meeting.label}: rolls until it rests, {meeting.speed:.4g}, {meeting.tangential_speed:.4g} m/s"

    def deck(variant: Variant) -> ProbeDeck:
        spheres = _flying(meeting, variant, meeting.speed, meeting.tangential_speed)
        every = max(1, math.ceil(watched(meeting, variant) / variant.time_step / FRAMES))
        steps = every * FRAMES
        box = probe_deck.box_around(spheres, steps * variant.time_step)
        styles = variant.styles.text
        if variant.styles.rolling_friction == "krijt" and rolling_damping > 0:
            styles += f" rollingDamping {rolling_damping!r}"
        return probe_parts.deck(label, variant, meeting, spheres, steps, box=box, every=every, styles=styles)

    def read(frame: pd.DataFrame, variant: Variant) -> list[Quantity]:
        places = frame.pivot(index="step", columns="id", values="x").to_numpy()
        end = probe_parts.last(frame)
        stuck = end["z"].to_numpy() < meeting.radii[0] + probe_parts.neck(variant, meeting)
        frames = math.ceil(READ_SWINGS * _swing(meeting) / (watched(meeting, variant) / FRAMES))
        swinging = places[-frames:]
        # A sphere first touches at x = 0.
        rest = np.where(stuck, (swinging.max(axis=0) + swinging.min(axis=0)) / 2, np.nan)
        decided = Quantity(name="sticking", values=stuck.astype(float), decision=True)
        return [Quantity(name="way rolled until at rest", values=rest, relative=True), decided]

    return Probe(label, meeting, deck, read)


def watched(meeting: Meeting, variant: Variant) -> float:
    """Time for which a sphere that rolls until it rests is watched [s].

    It rolls on with 5/7 of its tangential speed, and 4 F_C xi_crit stops (7/5) m r^2 omega: in m r v_t/(4 F_C xi_crit).
    """
    moment = 4 * meeting.pair.pull_off_force * meeting.critical_rolling
    stop = collisions.masses(meeting)[0] * meeting.radii[0] * meeting.tangential_speed / moment
    return STOPS * stop + SETTLING_PERIODS * timestep.stuck_period(variant.pair(meeting)) + SWINGS * _swing(meeting)


def _swing(meeting: Meeting) -> float:
    """Period of a sphere that swings about its place on the spring of rolling [s], of the real material; Haervig 2017, eq. 21.

    It does not slip, which makes it sqrt(7/4) slower than `timestep.rolling_period`.
    """
    share = timestep.spin_share(meeting.radii, collisions.masses(meeting))
    return math.sqrt(7 / 4) * timestep.rolling_period(meeting.pair, meeting.pair.equilibrium_contact_radius, share)


def _flying(meeting: Meeting, variant: Variant, speed: float, along: float) -> list[probe_deck.Sphere]:
    """One lane for each fraction of a step at which contact begins, at x = 0."""
    spheres = []
    for lane, phase in enumerate(PHASES):
        flight = (FLIGHT_STEPS + phase) * variant.time_step
        motion = ((-along * flight, 0.0, 0.0), (along, 0.0, -speed), (0.0, 0.0, 0.0))
        spheres += probe_parts.placed(meeting, lane, motion, speed * flight)
    return spheres
