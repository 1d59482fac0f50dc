"""What may happen in a scene, as far as a plan needs to know: who meets whom how fast, what pulls, what the scene is about.

Covers no law and no decision. Scenes of any kind are turned into a `Situation`, and every decision is a function of it.
Assumes spheres. All quantities in SI units, of the real material.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from pyjkr.contact import PairProperties

# What the result must be right about. "impact": rebound or sticking, velocities and spins after collisions. "strength":
# what holds and what yields under a load that lasts: rolling off, breaking up, resuspension. "structure": beds and
# agglomerates that grow from many impacts and stay.
About = Literal["impact", "strength", "structure"]
EFFECTS = ("adhesion", "neck", "sliding", "sliding_adhesion", "rolling", "twisting", "damping", "gravity", "original_limits")
Effect = Literal[
    "adhesion", "neck", "sliding", "sliding_adhesion", "rolling", "twisting", "damping", "gravity", "original_limits"
]
Wish = Literal["auto", "on", "off"]


@dataclass(frozen=True, kw_only=True)
class Meeting:
    """One kind of contact: two spheres, or a sphere and a wall, of certain sizes and materials.

    Attributes
    ----------
    label : str
        For tables: "ash-ash 1 um, 4 um".
    pair : PairProperties
        Effective properties of the real material.
    radii, densities : tuple of float
        Of the spheres [m], [kg/m3]: one at a wall, two otherwise.
    speed : float
        Fastest normal approach [m/s]; the deepest overlap follows from it.
    slowest_speed : float
        Slowest normal approach whose outcome matters [m/s]; the same as `speed` where there is one.
    tangential_speed : float
        Largest speed along the contact plane [m/s]; 0 for head-on.
    friction_coefficient : float
        mu.
    critical_rolling : float
        xi_crit of the real material [m]; infinite where it is not given.
    poissons_ratio : float
        Larger of the two.
    drag_time : float
        m/(6 pi viscosity r) of the sphere that a gas stops soonest [s]; infinite without gas.
    """

    label: str
    pair: PairProperties
    radii: tuple[float, ...]
    densities: tuple[float, ...]
    speed: float
    slowest_speed: float
    tangential_speed: float = 0.0
    friction_coefficient: float = 0.0
    critical_rolling: float = float("inf")
    poissons_ratio: float = 0.3
    drag_time: float = float("inf")


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What may happen in a scene.

    Attributes
    ----------
    title, source : str
        Of the scene; where it is from, for messages.
    about : str
        What the result must be right about.
    meetings : tuple of Meeting
        Every kind of contact that can happen, extremes of a size distribution included.
    many_contacts : bool
        Whether spheres touch several others at a time.
    lasting : bool
        Whether contacts stay: beds, agglomerates, spheres that stick.
    pulling_force : float
        Strongest force that the surroundings may exert on a contact [N]: drag, weight, shaking.
    gas_speed : float
        Of the gas, where there is one [m/s].
    gravity : float
        Acceleration that the scene states [m/s2]; 0 for none.
    falling_length : float
        Way over which gravity may change the speed of a sphere [m].
    weight_carried : float
        Largest weight that rests on one contact [N]: of a sphere, or of the column above it in a bed.
    particles, time : float
        How many spheres, how long the scene lasts [s]: what a run costs.
    spheres_across : float
        Spheres across the largest body of many that hits something as a whole; 1 for single spheres.
    contacts_per_particle : float
        Expected mean; 0.1 for a gas, 4 to 6 for a bed.
    maximum_overlap : float
        Deepest overlap that the scene allows, in effective radii; JKR is a theory of small strain.
    wishes : dict
        Effect -> "auto", "on" or "off", as the user forced it.
    """

    title: str
    source: str
    about: About
    meetings: tuple[Meeting, ...]
    many_contacts: bool
    lasting: bool
    pulling_force: float = 0.0
    gas_speed: float = 0.0
    gravity: float = 0.0
    falling_length: float = 0.0
    weight_carried: float = 0.0
    particles: int = 1
    time: float = 0.0
    spheres_across: float = 1.0
    contacts_per_particle: float = 1.0
    maximum_overlap: float = 0.1
    wishes: dict[Effect, Wish] = field(default_factory=dict)

    @property
    def about_single_impacts(self) -> bool:
        """Whether speed and spin after each impact are the result; beds, clusters and fragments forget them after the next one."""
        return self.about == "impact" and self.spheres_across == 1
