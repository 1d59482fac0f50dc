# Law: simplified JKR with sliding and rolling resistance; an oblique impact on a wall under a constant force along it.
# Covers: Haervig et al. 2017 sections 5.1 and 5.3, fig. 9, eqs 18-25; F_yield = M_crit/R (the paper's lacks 1/R).
# Assumes: the angle is between path and wall, the force acts from the start and along the motion; no rolling dashpot.
"""From lambda, Ad and e to an impact that can be planned, the force under which it rolls, and the border of its rebound."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pyjkr.case import Case
from pyjkr.oracle import rolling
from pyjkr.oracle.impact import sticking_speed
from pyjkr.oracle.normal import NormalContact, equilibrium_contact_radius, pull_off_force
from pyjkr.scene import Scene
from pyjkr.studies import lanes

# A solid sphere that rolls without slip has the inertia m + I/r^2 = (7/5) m.
ROLLING_INERTIA = 7 / 5


@dataclass(frozen=True)
class Setup:
    """An impact: its scene and case, and the real contact that decides when it yields; `lever` as `reaction_lever` has it."""

    scene: Scene
    case: Case
    yield_force: float
    critical_displacement: float
    rolling_period: float
    lever: float


def reaction_lever(point: dict, elasticity: float) -> float:
    """Lever of the wall's reaction about the centre, over r: LIGGGHTS has it act half way into the overlap a_0^2/(3 R)."""
    # a_0^3 = 9 pi gamma R^2/E, with gamma and E by Ad and lambda; q^(-1/5) of it with eq. 24
    ratio = (3 * math.pi * point["adhesiveness"] / elasticity) ** (1 / 3) * point["modulus_ratio"] ** -0.2
    return 1 - ratio**2 / 6


def normal_speed(point: dict) -> float:
    """v sin psi [m/s], of Ad."""
    return math.sqrt(3 * point["surface_energy"] / (point["adhesiveness"] * point["density"] * point["radius"]))


def critical_elasticity(point: dict) -> float:
    """lambda [-] below which the oracle sticks: its sticking speed goes as E^(-1/3)."""
    speed = normal_speed(point)
    modulus = 1e6 * point["density"] * speed**2
    contact = NormalContact(point["radius"], modulus, point["surface_energy"], restitution_coefficient=point["restitution_coefficient"])
    mass = 4 / 3 * math.pi * point["radius"] ** 3 * point["density"]
    return 1e6 * (sticking_speed(contact, mass) / speed) ** 3


def prepare(point: dict, elasticity: float) -> Setup:
    """Scene, case and yield force of the impacts of one lambda; Haervig 2017, section 5.1."""
    speed = normal_speed(point)
    modulus = elasticity * point["density"] * speed**2
    scene = Scene.model_validate(
        {
            "title": "oblique impact on a wall under a constant force",
            "model": {"normal": "jkr/simplified", "tangential": "jkr", "rolling_friction": "krijt"},
            "material": {"solid": {"density": point["density"], "poissons_ratio": point["poissons_ratio"]}},
            "contact": (
                {
                    "between": ("solid", "solid"),
                    "effective_modulus": modulus,
                    "surface_energy": point["surface_energy"],
                    "restitution_coefficient": point["restitution_coefficient"],
                    "friction_coefficient": point["friction_coefficient"],
                    "adhesion_hysteresis": point["adhesion_hysteresis"],
                },
            ),
            "impact": {
                "radius": point["radius"],
                "material": "solid",
                "target": "wall",
                "wall_material": "solid",
                "speeds": (speed / math.sin(math.radians(point["angle"])),),
                "angle": 90.0 - point["angle"],
                "steps_per_collision": point["steps_per_collision"],
            },
            "reduction": {"modulus_ratios": (point["modulus_ratio"],), "use_original_surface_energy": point["original_rolling"]},
        }
    )
    case = lanes.only_case(scene)
    real = NormalContact(point["radius"], modulus, point["surface_energy"])
    stiffness = float(rolling.rolling_stiffness(pull_off_force(real), 1.0))
    critical = float(rolling.critical_displacement_krijt(equilibrium_contact_radius(real), point["adhesion_hysteresis"]))
    period = 2 * math.pi * math.sqrt(ROLLING_INERTIA * case.masses[0] * point["radius"] / stiffness)
    lever = reaction_lever(point, elasticity)
    return Setup(scene, case, stiffness * critical / point["radius"], critical, period, lever)


def lane_of(setup: Setup, force: float) -> lanes.Lane:
    """The flying sphere under a force in units of F_yield."""
    case = setup.case
    return lanes.Lane(
        height=case.radii[0] + case.start_gap, speed=case.tangential_speed, approach=case.normal_speed, force=force * setup.yield_force
    )
