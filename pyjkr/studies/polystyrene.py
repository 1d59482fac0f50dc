# Law: none of its own; a scene of one sphere that meets a flat wall, from numbers.
# Covers: what the studies of Chen, Liu, Li 2019, figs 2-7 share: polystyrene of its table 1, and the scene of one impact.
# Assumes: only the effective modulus matters; both materials get Poisson's ratio of polystyrene.
"""Polystyrene of Chen, Liu, Li 2019, and one impact of it on a wall."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from pyjkr.scene import Scene

# Surface energy [J/m2]: Chen 2019, table 1. Modulus [Pa]: not printed in the text at hand; it makes the reduced moduli that
# follow from the surface energies of that table round, 1, 0.5 and 0.1 GPa.
SURFACE_ENERGY, EFFECTIVE_MODULUS = 0.05, 3.8e9
# Ours: handbook values of polystyrene.
DENSITY, POISSONS_RATIO = 1050.0, 0.33


class Sphere(BaseModel):
    """One sphere and the wall it meets: settings that the studies share."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    radius: float = Field(default=0.635e-6, gt=0)
    """[m]; Dahneke's sphere of 1.27 um."""
    density: float = Field(default=DENSITY, gt=0)
    """[kg/m3]"""
    effective_modulus: float = Field(default=EFFECTIVE_MODULUS, gt=0)
    """E [Pa] of sphere and wall."""
    surface_energy: float = Field(default=SURFACE_ENERGY, ge=0)
    """gamma [J/m2] of one surface."""


def impact_on_wall(
    sphere: Sphere,
    speed: float,
    restitution_coefficient: float,
    law: str,
    steps_per_collision: int,
    *,
    contact: dict[str, float] | None = None,
    rolling_damping: float = 0.0,
    reduction: dict[str, object] | None = None,
) -> Scene:
    """Scene of one normal impact, at the stiffness and surface energy that the sphere has unless `reduction` says otherwise.

    Parameters
    ----------
    sphere : Sphere
        With E and gamma as the contact law is to take them, reduced or not.
    speed : float
        [m/s]
    restitution_coefficient : float
        Without adhesion [-].
    law : str
        "jkr" or "jkr/simplified".
    steps_per_collision : int
        Time steps per collision.
    contact : dict or None
        More keys of the contact, such as `friction_coefficient`; with these the sphere also slides and rolls (`krijt`).
    rolling_damping : float
        Fraction of critical damping of the rolling mode [-].
    reduction : dict or None
        The table of that name of a scene file.
    """
    rolls = bool(contact)
    return Scene.model_validate(
        {
            "title": "polystyrene sphere on a wall",
            "model": {
                "normal": law,
                "tangential": "jkr" if rolls else "off",
                "rolling_friction": "krijt" if rolls else "off",
                "rolling_damping": rolling_damping,
            },
            "material": {
                "polystyrene": {"density": sphere.density, "poissons_ratio": POISSONS_RATIO},
                "wall": {"poissons_ratio": POISSONS_RATIO},
            },
            "contact": (
                {
                    "between": ("polystyrene", "wall"),
                    "effective_modulus": sphere.effective_modulus,
                    "surface_energy": sphere.surface_energy,
                    "restitution_coefficient": restitution_coefficient,
                    **(contact or {}),
                },
            ),
            "impact": {
                "radius": sphere.radius,
                "material": "polystyrene",
                "target": "wall",
                "wall_material": "wall",
                "speeds": (speed,),
                "steps_per_collision": steps_per_collision,
                "phase": 0.37,
            },
            "reduction": {"maximum_overlap": 1.0, **(reduction or {})},
        }
    )
