"""Scenes derived from a scene: the same sphere at a wall or at another sphere, normally or obliquely, other laws or stiffness.

Every variant is validated like a scene file. What a scene leaves open and a study needs is assumed here, by name.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from pyjkr.errors import PlanError
from pyjkr.oracle.impact import sticking_speed
from pyjkr.oracle.normal import NormalContact
from pyjkr.plan import pair_properties
from pyjkr.scene import Scene

# Radius of the sphere that is hit over that of the flying one, where a scene has a wall: unlike, so that nothing cancels.
PAIR_RADIUS_RATIO = 1.7
# Of a contact whose scene gives none: ordinary values.
ASSUMED_FRICTION = 0.3
ASSUMED_HYSTERESIS = 0.3
OBLIQUE_ANGLE = 45.0
# Impact speeds of the studies in units of the sticking speed.
REFERENCE_SPEED_FACTOR = 2.0


def changed(scene: Scene, **tables: dict[str, Any]) -> Scene:
    """The scene with some keys of its tables changed.

    Parameters
    ----------
    scene : Scene
        Where to start.
    tables
        Keys and values by table, `contact` for the one contact; None removes a key.

    Raises
    ------
    pydantic.ValidationError
        Where the outcome is no valid scene.
    """
    content = scene.model_dump(exclude_unset=True)
    content.pop("figures", None)
    for table, keys in tables.items():
        old = content["contact"][0] if table == "contact" else content.get(table, {})
        new = {key: value for key, value in (old | keys).items() if value is not None}
        content[table] = (new,) if table == "contact" else new
    return Scene.model_validate(content)


def at(scene: Scene, target: str) -> Scene:
    """The scene's flying sphere at a `wall` or at another `sphere`, in a normal impact, with the normal law alone."""
    impact = scene.impact
    keys: dict[str, Any] = {"angle": None}
    normal_alone = {"tangential": "off", "rolling_friction": "off", "twisting": None, "rolling_damping": None}
    tables: dict[str, Any] = {"model": normal_alone}
    if target == "wall" and impact.target == "sphere":
        keys |= {"target": "wall", "wall_material": impact.target_material, "target_material": None, "target_radius": None}
    if target == "sphere" and impact.target == "wall":
        keys |= {
            "target": "sphere",
            "target_material": impact.wall_material,
            "target_radius": PAIR_RADIUS_RATIO * impact.sphere_radius,
            "wall_material": None,
            "wall": None,
        }
        materials = scene.model_dump(exclude_unset=True)["material"]
        materials[impact.wall_material].setdefault("density", scene.material[impact.material].density)
        tables["material"] = materials
    return changed(scene, impact=keys, **tables)


def oblique(scene: Scene) -> Scene:
    """The scene's sphere at a wall under 45 degrees, with sliding, rolling and twisting."""
    contact = scene.meeting
    limits: dict[str, Any] = {"friction_coefficient": contact.friction_coefficient or ASSUMED_FRICTION}
    if contact.adhesion_hysteresis is None and contact.critical_rolling_angle is None:
        limits["adhesion_hysteresis"] = ASSUMED_HYSTERESIS
    return changed(
        at(scene, "wall"),
        model={"tangential": "jkr", "rolling_friction": "krijt", "twisting": True},
        contact=limits,
        impact={"angle": OBLIQUE_ANGLE},
    )


def one(scene: Scene, normal_speed: float, steps_per_collision: int, modulus_ratio: float = 1.0, **model: Any) -> Scene:
    """The scene at one normal speed [m/s], one number of steps and one stiffness; `model` changes keys of its laws."""
    speed = normal_speed / math.cos(math.radians(scene.impact.angle))
    return changed(
        scene,
        impact={"speeds": (speed,), "steps_per_collision": steps_per_collision},
        reduction={"modulus_ratios": (modulus_ratio,), "unmodified_ratios": None},
        model=model,
    )


def threshold(scene: Scene) -> float:
    """Sticking speed of the scene at its real stiffness [m/s], normal; 0 where every impact rebounds."""
    pair = pair_properties(scene, 1.0, "scaled")
    contact = NormalContact(
        pair.effective_radius, pair.effective_modulus, pair.surface_energy, scene.model.normal, pair.restitution_coefficient
    )
    return _threshold(contact, pair.effective_mass)


_threshold = cache(sticking_speed)


def own_speeds(scene: Scene) -> tuple[float, ...]:
    """Normal speeds [m/s] of the scene itself, rising."""
    return tuple(sorted(speed * math.cos(math.radians(scene.impact.angle)) for speed in scene.impact.speeds))


def speeds(scene: Scene, factors: tuple[float, ...]) -> tuple[float, ...]:
    """Normal speeds [m/s]: multiples of the sticking speed, or those of the scene where no speed sticks."""
    sticking = threshold(scene)
    return tuple(factor * sticking for factor in factors) if sticking > 0 else own_speeds(scene)


def reference_speed(scene: Scene) -> float:
    """Normal speed [m/s] at which a study of one speed looks: twice the sticking speed, or the scene's middle speed."""
    own = own_speeds(scene)
    return REFERENCE_SPEED_FACTOR * threshold(scene) or own[len(own) // 2]


def refusal(error: PlanError) -> str:
    """A PlanError in one clause without the name of the scene, for the list of what is left out."""
    return str(error).partition(": ")[2].split(". ")[0]
