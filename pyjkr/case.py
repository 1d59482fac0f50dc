"""The values that planning hands on: `Case`, one simulation; `Plan`, all of a scene; `LeftOut`, what is not simulated.

Covers no law and no decision; `plan.py` fills them in. All quantities in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pyjkr.contact import PairProperties
from pyjkr.scene import Scene

Rule = Literal["scaled", "unmodified"]


@dataclass(frozen=True, kw_only=True)
class Case:
    """One simulation. Units are SI; tuples run over LIGGGHTS atom types or spheres.

    Attributes
    ----------
    label : str
        Name of the case and of its directory.
    speed, normal_speed, tangential_speed : float
        Relative speed at contact and its parts [m/s].
    modulus_ratio : float
        q = E_mod/E.
    rule : str
        `scaled`: gamma_mod = gamma q^(2/5); `unmodified`: gamma left alone.
    pair : PairProperties
        Effective properties with the modified modulus and surface energy.
    original : PairProperties
        The same of the real material.
    youngs_moduli, youngs_moduli_original, poissons_ratios : tuple of float
        Per atom type [Pa], [Pa], [-].
    radii, densities, masses : tuple of float
        Per sphere [m], [kg/m3], [kg].
    periods : dict
        Collision time, period of the stuck oscillation and shortest period of every active mode by name [s].
    collision_time, time_step : float
        Shorter of Hertz collision and stuck period [s]; the step [s].
    start_gap : float
        Gap at step 0 [m]: (flight_steps + phase) normal_speed time_step.
    steps, dense_steps, dense_interval, coarse_interval : int
        Length of the run; frames every `dense_interval` steps until `dense_steps`, then every `coarse_interval`.
    skin : float
        Neighbour skin [m].
    stiffness_commands : tuple of str
        `hard_particles`, `soft_particles`, both or none.
    maximum_contact_radius, maximum_overlap, rupture_overlap : float
        Upper bounds of the contact radius and of the overlap [m]; overlap at which the contact ends [m].
    """

    label: str
    speed: float
    normal_speed: float
    tangential_speed: float
    modulus_ratio: float
    rule: Rule
    pair: PairProperties
    original: PairProperties
    youngs_moduli: tuple[float, ...]
    youngs_moduli_original: tuple[float, ...]
    poissons_ratios: tuple[float, ...]
    radii: tuple[float, ...]
    densities: tuple[float, ...]
    masses: tuple[float, ...]
    periods: dict[str, float]
    collision_time: float
    time_step: float
    flight_steps: int
    phase: float
    start_gap: float
    steps: int
    dense_steps: int
    dense_interval: int
    coarse_interval: int
    skin: float
    stiffness_commands: tuple[str, ...]
    maximum_contact_radius: float
    maximum_overlap: float
    rupture_overlap: float

    @property
    def contact_begins(self) -> float:
        """Time at which the surfaces first touch [s]: free flight at the speed of approach."""
        return (self.flight_steps + self.phase) * self.time_step

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return self.steps * self.time_step


@dataclass(frozen=True)
class LeftOut:
    """A case that is not simulated, because it may press deeper than the scene allows.

    Attributes
    ----------
    label, speed, modulus_ratio, rule
        As in `Case`.
    overlap : float
        Upper bound of the overlap, in effective radii.
    reason : str
        The same in words.
    """

    label: str
    speed: float
    modulus_ratio: float
    rule: Rule
    overlap: float
    reason: str


@dataclass(frozen=True)
class Plan:
    """All simulations of a scene."""

    scene: Scene
    cases: tuple[Case, ...]
    left_out: tuple[LeftOut, ...]
    warnings: tuple[str, ...]

    @property
    def total_steps(self) -> int:
        """Steps of all cases together."""
        return sum(case.steps for case in self.cases)
