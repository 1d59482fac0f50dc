"""The right answers: the oracle's outcome of a case, normal (Haervig 2017, eqs 3, 8-13) or oblique (its sections 2 and 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from pyjkr.case import Case
from pyjkr.contact import PairProperties
from pyjkr.oracle import Assembly, Options, PairLaw, Wall, follow
from pyjkr.oracle.impact import impact
from pyjkr.oracle.normal import NormalContact
from pyjkr.scene import Scene

# The oblique impact is followed to this accuracy, far below the errors of the time steps that are judged by it.
OBLIQUE_TOLERANCE = 1e-8
# An impact that still touches after so many collision times is stuck.
COLLISIONS_FOLLOWED = 4


@dataclass(frozen=True)
class Exact:
    """Outcome of one impact, as in `impacts.Outcome`.

    Attributes
    ----------
    restitution, tangential, spin : float
        Over the speed of the impact (`restitution`: over its normal part).
    stuck : bool
        Whether the contact never ends.
    contact_time : float
        [s]; NaN if stuck.
    """

    restitution: float
    stuck: bool
    contact_time: float
    tangential: float = math.nan
    spin: float = math.nan


def normal(scene: Scene, case: Case) -> Exact:
    """Outcome of a normal impact, or of the normal part of an oblique one."""
    return _normal(case.pair, scene.model.normal, case.normal_speed)


@cache
def _normal(pair: PairProperties, law: str, speed: float) -> Exact:
    contact = NormalContact(
        pair.effective_radius, pair.effective_modulus, pair.surface_energy, law, pair.restitution_coefficient
    )
    found = impact(contact, pair.effective_mass, speed, samples=2, stuck_periods=0.01)
    return Exact(found.restitution, found.stuck, found.contact_time)


def oblique(scene: Scene, case: Case) -> Exact:
    """Outcome of an oblique impact on a wall with sliding, rolling and twisting."""
    contact, model = scene.meeting, scene.model
    real = case.original if scene.reduction.use_original_surface_energy else case.pair
    law = PairLaw(
        case.pair.effective_modulus,
        case.pair.effective_shear_modulus,
        case.pair.surface_energy,
        contact.restitution_coefficient,
        contact.friction_coefficient,
        adhesion_hysteresis=contact.adhesion_hysteresis,
        critical_rolling_angle=contact.critical_rolling_angle,
        surface_energy_original=case.pair.surface_energy_of_rolling,
        effective_modulus_original=real.effective_modulus,
    )
    options = Options(
        model=model.normal,
        sliding=model.tangential != "off",
        tangential_damping=model.tangential_damping,
        rolling=model.rolling_friction == "krijt",
        rolling_damping=model.rolling_damping,
        twisting=model.twisting,
    )
    duration = COLLISIONS_FOLLOWED * max(case.periods[name] for name in ("Hertz collision", "stuck oscillation"))
    velocity, spin = _followed(law, options, case.radii[0], case.masses[0], case.tangential_speed, case.normal_speed, duration)
    return replace(normal(scene, case), tangential=velocity / case.speed, spin=spin * case.radii[0] / case.speed)


@cache
def _followed(
    law: PairLaw, options: Options, radius: float, mass: float, tangential_speed: float, normal_speed: float, duration: float
) -> tuple[float, float]:
    """Speed along the wall [m/s] and spin [rad/s] after an impact."""
    start = Assembly(
        position=np.array([[0.0, 0.0, radius * (1 + 1e-6)]]),
        velocity=np.array([[tangential_speed, 0.0, -normal_speed]]),
        spin=np.zeros((1, 3)),
        radius=np.array([radius]),
        mass=np.array([mass]),
        laws=law,
        options=options,
        walls=[Wall((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))],
    )
    end = follow(start, duration, samples=2, relative_tolerance=OBLIQUE_TOLERANCE, stop=_parted).final
    return float(end.velocity[0, 0]), float(end.spin[0, 1])


def _parted(event) -> bool:
    return event.kind == "break"
