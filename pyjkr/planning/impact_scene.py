"""`Scene` of single impacts -> `Situation`, so that a deck of a shipped case can be planned too.

Covers no law. Assumes the scene's speeds along the path and its angle from the surface normal; nothing lasts but what sticks.
"""

from __future__ import annotations

import math

from pyjkr.plan import pair_properties
from pyjkr.planning.collisions import sticking_speed
from pyjkr.planning.situation import Meeting, Situation
from pyjkr.scene import Scene


def situation_of_impact(scene: Scene) -> Situation:
    """What may happen in a scene of impacts, its slowest to its fastest.

    Parameters
    ----------
    scene : Scene
        Of one sphere on a wall or another sphere.
    """
    impact, contact = scene.impact, scene.meeting
    pair = pair_properties(scene, 1.0, "scaled")
    angle = math.radians(impact.angle)
    radii = (impact.sphere_radius,) if impact.target == "wall" else (impact.sphere_radius, impact.target_radius)
    names = (impact.material, impact.struck_material)
    densities = tuple(scene.material[name].density for name in names[: len(radii)])
    heaviest = max(4 / 3 * math.pi * radius**3 * density for radius, density in zip(radii, densities, strict=True))
    slowest = min(impact.speeds) * math.cos(angle)
    limit = math.inf
    if contact.adhesion_hysteresis is not None:
        limit = pair.equilibrium_contact_radius * contact.adhesion_hysteresis / 12
    elif contact.critical_rolling_angle is not None:
        limit = contact.critical_rolling_angle * pair.effective_radius
    meeting = Meeting(
        label=f"{names[0]} on {names[1]}",
        pair=pair,
        radii=radii,
        densities=densities,
        speed=max(impact.speeds) * math.cos(angle),
        slowest_speed=slowest,
        tangential_speed=max(impact.speeds) * math.sin(angle),
        friction_coefficient=contact.friction_coefficient or 0.0,
        critical_rolling=limit,
        poissons_ratio=max(scene.material[name].poissons_ratio for name in names),
    )
    given = scene.reduction.maximum_overlap if "maximum_overlap" in scene.reduction.model_fields_set else Situation.maximum_overlap
    return Situation(
        title=scene.title,
        source=scene.source,
        about="impact",
        meetings=(meeting,),
        many_contacts=False,
        lasting=slowest <= sticking_speed(pair, scene.model.normal),
        pulling_force=scene.environment.external_force,
        gravity=scene.environment.acceleration,
        weight_carried=scene.environment.acceleration * heaviest,
        contacts_per_particle=1.0,
        maximum_overlap=given,
    )
