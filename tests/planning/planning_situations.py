"""Situations for the tests of planning, and what the oracle makes of their impacts.

The oracle integrates the motion (`pyjkr.oracle.follow`, `impact`); the plan works with an interpolated table and with impulses.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from pyjkr import oracle, timestep
from pyjkr.contact import PairProperties
from pyjkr.planning.situation import Meeting, Situation

# Polystyrene, 1 um radius, as in docs/lever-arm.md; no two numbers are equal.
EFFECTIVE_MODULUS, POISSON, ENERGY, DENSITY, RESTITUTION, FRICTION, HYSTERESIS = 2.15e9, 0.34, 0.05, 1050.0, 0.7, 0.3, 0.31
SINGLE, PAIR, UNEQUAL = (1e-6,), (1e-6, 1e-6), (1e-6, 4e-6)


def meeting(
    radii=SINGLE, *, speed=8.0, slowest=None, tangential=0.0, energy=ENERGY, restitution=RESTITUTION, friction=FRICTION,
    hysteresis=HYSTERESIS, modulus=EFFECTIVE_MODULUS,
) -> Meeting:  # fmt: skip
    """A meeting at normal speeds `slowest` to `speed`."""
    masses = [4 / 3 * math.pi * radius**3 * DENSITY for radius in radii]
    inertias = [0.4 * mass * radius**2 for mass, radius in zip(masses, radii, strict=True)]
    pair = PairProperties(
        effective_radius=1 / sum(1 / radius for radius in radii),
        effective_mass=1 / sum(1 / mass for mass in masses),
        effective_inertia=1 / sum(1 / inertia for inertia in inertias),
        effective_modulus=modulus,
        effective_shear_modulus=modulus * (1 - POISSON) / (2 * (2 - POISSON)),
        surface_energy=energy,
        surface_energy_of_rolling=energy,
        restitution_coefficient=restitution,
    )
    return Meeting(
        label="test", pair=pair, radii=tuple(radii), densities=(DENSITY,) * len(radii), speed=speed,
        slowest_speed=speed if slowest is None else slowest, tangential_speed=tangential, friction_coefficient=friction,
        critical_rolling=pair.equilibrium_contact_radius * hysteresis / 12, poissons_ratio=POISSON,
    )  # fmt: skip


def at_angle(radii, speed: float, degrees: float, **keys) -> Meeting:
    """An oblique meeting; the angle is from the normal."""
    angle = math.radians(degrees)
    return meeting(radii, speed=speed * math.cos(angle), tangential=speed * math.sin(angle), **keys)


def situation(*meetings: Meeting, about="impact", **keys) -> Situation:
    """A situation; of single contacts that do not last, unless said."""
    named = {"many_contacts": False, "lasting": False} | keys
    return Situation(title="test", source="scene.toml", about=about, meetings=meetings or (meeting(),), **named)


def bed(*meetings: Meeting, about="structure", **keys) -> Situation:
    """Many contacts that last."""
    return situation(
        *meetings, about=about, **({"many_contacts": True, "lasting": True, "contacts_per_particle": 4.0, "time": 1e-3} | keys)
    )


def contact(at: Meeting, law="jkr", ratio=1.0, restitution=None, energy=None) -> oracle.NormalContact:
    """The oracle's normal contact, softened by Haervig 2017, eq. 24."""
    pair = at.pair
    gamma = pair.surface_energy if energy is None else energy
    e = pair.restitution_coefficient if restitution is None else restitution
    return oracle.NormalContact(pair.effective_radius, ratio * pair.effective_modulus, ratio**0.4 * gamma, law, e)


def energy_kept(at: Meeting, law="jkr", ratio=1.0, speed=None, **keys) -> float:
    """e_eff^2 of a normal impact in the oracle."""
    return oracle.impact(contact(at, law, ratio, **keys), at.pair.effective_mass, speed or at.speed, samples=2).restitution ** 2


@cache
def outcome(
    at: Meeting, ratio=1.0, law="jkr", originals=False, adhesion_of_sliding=True, force=(0.0, 0.0), duration=0.0, **options
) -> np.ndarray:
    """Relative velocity (normal, tangential) and r omega of every sphere after an impact, over the impact speed; in the oracle.

    `force` [N] acts on a single sphere, along the wall and towards it; `duration` [s] is followed, if given, else until it has left.
    """
    pair, radii = at.pair, np.array(at.radii)
    masses = 4 / 3 * math.pi * radii**3 * DENSITY
    gamma = pair.surface_energy
    law_of_pair = oracle.PairLaw(
        ratio * pair.effective_modulus, ratio * pair.effective_shear_modulus, ratio**0.4 * gamma, pair.restitution_coefficient,
        at.friction_coefficient, adhesion_hysteresis=12 * at.critical_rolling / pair.equilibrium_contact_radius if gamma else 0.0,
        surface_energy_original=(gamma if originals else None) if adhesion_of_sliding else 1e-9 * gamma,
        effective_modulus_original=pair.effective_modulus if originals else None,
    )  # fmt: skip
    shares = [1.0] if len(radii) == 1 else [masses[1] / masses.sum(), -masses[0] / masses.sum()]
    heights = [radii[0] * (1 + 1e-7)] if len(radii) == 1 else [radii.sum() * (1 + 1e-7), 0.0]
    start = oracle.Assembly(
        np.array([[0.0, 0.0, height] for height in heights]),
        np.array([[share * at.tangential_speed, 0.0, -share * at.speed] for share in shares]),
        np.zeros((len(radii), 3)), radii, masses, law_of_pair, oracle.Options(law, **options),
        [oracle.Wall((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))] if len(radii) == 1 else [],
        external_force=np.array([[force[0], 0.0, -force[1]]] * len(radii)) if any(force) else None,
    )  # fmt: skip
    softened = replace(pair, effective_modulus=ratio * pair.effective_modulus, surface_energy=ratio**0.4 * gamma)
    if not duration:
        duration = 6 * timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, softened.effective_modulus, at.speed)
        duration = max(duration, 6 * timestep.stuck_period(softened)) if gamma else duration
    end = oracle.follow(start, duration, samples=2, relative_tolerance=1e-7, stop=lambda event: event.kind == "break").final
    relative = end.velocity[0] - (end.velocity[1] if len(radii) == 2 else 0.0)
    return np.array([relative[2], relative[0], *(end.spin[:, 1] * radii)]) / math.hypot(at.speed, at.tangential_speed)


def change(first: np.ndarray, second: np.ndarray) -> float:
    """Largest difference of two outcomes."""
    return float(np.abs(first - second).max())
