"""`Application` -> `Situation`: which contacts can happen in a scene, how fast, and what pulls at them.

Covers no law; speeds and forces are upper bounds from the start of the scene, energy and Stokes' drag.
Assumes spheres that do not speed up by anything but gravity and gas.
"""

from __future__ import annotations

import math

import numpy as np

from pyjkr import contact as contact_laws
from pyjkr.application import laws, places
from pyjkr.application.laws import Body
from pyjkr.application.scene import Application
from pyjkr.contact import PairProperties
from pyjkr.planning.situation import EFFECTS, Meeting, Situation

# Contacts that a sphere counts, to which the starts lead: chains and small clusters; a bed of spheres with friction, walls and
# surface counted (isostatic 4 to 6); a thin deposit.
CONTACTS = {"pair": 1.0, "single": 1.0, "cloud": 2.0, "rain": 5.0, "stream": 2.0}
# A stream meets its tube at all angles; half of what could hit does so at more than 60 degrees from the normal on the upper side
# of the tube where x > 0.87 of its radius. Slower normal approaches than v cos 60 are rare and stick anyway.
SLOWEST_SHARE_OF_STREAM = 0.5


def situation(scene: Application) -> Situation:
    """What may happen in a scene.

    Parameters
    ----------
    scene : Application
        All quantities of the real material.
    """
    start = places.spheres(scene)
    weights = start.masses * scene.motion.gravity
    fall = _falling_length(scene, start)
    return Situation(
        title=scene.title,
        source=scene.source,
        about=scene.about,
        meetings=tuple(_meeting(scene, start, *bodies) for bodies in laws.extremes(scene)),
        many_contacts=scene.start not in ("pair", "single"),
        lasting=_lasting(scene, start),
        pulling_force=_drag(scene, float(start.radii.max())),
        gas_speed=_gas_speed(scene),
        gravity=scene.motion.gravity,
        falling_length=fall,
        weight_carried=_column_weight(scene, start) if scene.start == "rain" else float(weights.max()),
        particles=scene.number,
        time=scene.run.duration,
        spheres_across=_spheres_across(scene, start),
        contacts_per_particle=_contacts(scene, start),
        wishes={effect: getattr(scene.effects, effect) for effect in EFFECTS},
    )


def _meeting(scene: Application, start: places.Spheres, first: Body, second: Body) -> Meeting:
    contact = scene.pair(first.material, second.material)
    bodies = [body for body in (first, second) if body.radius is not None]
    fastest, slowest, tangential = _speeds(scene, start, wall=second.radius is None)
    pair = laws.pair_properties(scene, first, second)
    return Meeting(
        label=_label(first, second),
        pair=pair,
        radii=tuple(body.radius for body in bodies),
        densities=tuple(scene.material[body.material].density for body in bodies),
        speed=fastest,
        slowest_speed=slowest,
        tangential_speed=tangential,
        friction_coefficient=contact.friction_coefficient or 0.0,
        critical_rolling=critical_rolling(scene, first, second, pair),
        poissons_ratio=max(scene.material[name].poissons_ratio for name in contact.between),
        drag_time=min((_drag_time(scene, body) for body in bodies), default=math.inf),
    )


def _label(first: Body, second: Body) -> str:
    sizes = [f"{body.radius * 1e6:g} um" for body in (first, second) if body.radius is not None]
    wall = " wall" if second.radius is None else ""
    return f"{first.material}-{second.material}{wall} {', '.join(dict.fromkeys(sizes))}"


def critical_rolling(scene: Application, first: Body, second: Body, pair: PairProperties) -> float:
    """xi_crit [m]: a_0/12 dgamma/gamma (Haervig 2017, eq. 18) or theta_crit R (Chen 2019, eq. 3); infinite where none is given."""
    contact = scene.pair(first.material, second.material)
    if contact.adhesion_hysteresis is not None:
        return pair.equilibrium_contact_radius / 12 * contact.adhesion_hysteresis
    if contact.critical_rolling_angle is not None:
        return contact.critical_rolling_angle * pair.effective_radius
    return math.inf


def _speeds(scene: Application, start: places.Spheres, *, wall: bool) -> tuple[float, float, float]:
    """Fastest and slowest normal approach whose outcome matters, and largest tangential speed [m/s]."""
    speed, angle = scene.motion.speed, math.radians(scene.motion.angle)
    blown = _gas_speed(scene)
    if scene.start == "pair":
        return speed, speed, 0.0
    if scene.start in ("single", "agglomerate"):
        normal, along = speed * math.cos(angle), speed * math.sin(angle)
        # Fragments meet each other and the wall at any angle, no faster than the agglomerate came.
        return (normal, normal, along) if scene.start == "single" else (speed, speed, speed)
    if scene.start == "cloud":
        velocities = start.velocities
        fastest = max(float(np.linalg.norm(velocities - each, axis=1).max()) for each in velocities)
        # A gas takes unlike spheres along at different rates.
        fastest += blown if len(set(start.masses.tolist())) > 1 else 0.0
        # Root mean square of one component of the velocity of two relative to each other.
        return fastest, math.sqrt(2) * scene.motion.spread, fastest
    if scene.start == "rain":
        gravity, height = scene.motion.gravity, scene.domain.size[2]
        fastest = math.hypot(math.sqrt(speed**2 + 2 * gravity * height), blown)
        # A sphere that comes to rest last falls about its diameter, into the next pocket.
        slowest = math.sqrt(4 * gravity * float(start.radii.min())) or speed
        return fastest, min(slowest, fastest), fastest
    fallen = math.sqrt(speed**2 + 2 * scene.motion.gravity * _falling_length(scene, start))
    fastest = math.hypot(fallen, blown)
    # Spheres of a stream follow each other; they meet where one has been stopped.
    return fastest, SLOWEST_SHARE_OF_STREAM * speed, fastest


def _falling_length(scene: Application, start: places.Spheres) -> float:
    """Way over which gravity may act before a contact [m]."""
    top = float((start.positions[:, 2] - start.radii).max())
    if scene.start in ("rain", "single", "agglomerate"):
        return top
    if scene.start == "stream":
        return top + scene.wall.radius
    fastest = scene.motion.speed if scene.start == "pair" else 3 * scene.motion.spread
    return fastest * scene.run.duration


def _column_weight(scene: Application, start: places.Spheres) -> float:
    """Weight of the column as wide as the largest sphere, out of the weight per area of the whole bed [N]."""
    pressure = float(start.masses.sum()) * scene.motion.gravity / (scene.domain.size[0] * scene.domain.size[1])
    return max(pressure * (2 * float(start.radii.max())) ** 2, float(start.masses.max()) * scene.motion.gravity)


def _drag(scene: Application, radius: float) -> float:
    """Stokes' drag on a sphere at rest [N]."""
    return 6 * math.pi * scene.gas.viscosity * radius * _gas_speed(scene) if scene.gas else 0.0


def _drag_time(scene: Application, body: Body) -> float:
    """m/(6 pi viscosity r) [s]: Stokes' drag stops a sphere in it."""
    return laws.mass(scene, body) / (6 * math.pi * scene.gas.viscosity * body.radius) if scene.gas else math.inf


def _gas_speed(scene: Application) -> float:
    return float(np.linalg.norm(scene.gas.velocity)) if scene.gas else 0.0


def _lasting(scene: Application, start: places.Spheres) -> bool:
    """Whether contacts stay: always where there are many spheres, of two bodies where they may stick.

    Sticking is judged by energy: an impact loses at least 1 - e^2 of its energy, and a contact as pull-off needs
    0.2574 F_C a_0^2/R (Johnson's make-break loss, from Haervig 2017 eqs 8-10).
    """
    if scene.start not in ("pair", "single"):
        return True
    pair = laws.pair_properties(scene, *laws.extremes(scene)[0])
    _, slowest, _ = _speeds(scene, start, wall=scene.wall is not None)
    left = 0.5 * pair.effective_mass * slowest**2 * pair.restitution_coefficient**2
    return left <= contact_laws.break_energy(pair)


def _spheres_across(scene: Application, start: places.Spheres) -> float:
    if scene.start != "agglomerate":
        return 1.0
    return float(np.ptp(start.positions, axis=0).max()) / (2 * float(start.radii.max())) + 1


def _contacts(scene: Application, start: places.Spheres) -> float:
    if scene.start != "agglomerate":
        return CONTACTS[scene.start]
    apart = np.linalg.norm(start.positions[:, None] - start.positions[None], axis=2)
    touching = apart < 2 * start.radii[0] * (1 + 1e-9)
    return float(touching.sum() - len(apart)) / len(apart)
