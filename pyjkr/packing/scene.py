"""What is packed: spheres, their contact law at a modulus ratio, and the time step. Chen, Liu and Li 2019, sec. 4, table 1.

Covers the adhesion number, the series S, A, B and C of table 1, and the time scales of the contacts.
Assumes equal spheres and a floor of their material, no gravity, no fluid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from pyjkr import contact, scaling, timestep
from pyjkr.contact import PairProperties
from pyjkr.errors import PlanError
from pyjkr.limits import STABLE_FRACTION

# Two spheres meet at no more than this multiple of the inlet speed: one that rebounds without loss, and one that comes.
CLOSING_SPEEDS = 2.0


@dataclass(frozen=True, kw_only=True)
class Series:
    """A line of table 1 of Chen 2019.

    Attributes
    ----------
    name : str
        "S", "A-1", ...
    modulus_ratio : float
        q = E_R/E_O.
    scaled : bool
        Whether the surface energy of the normal law is gamma q^(2/5) (eq. 10) or stays gamma.
    originals : bool
        Whether the rolling, sliding and twisting limits keep gamma and E of the real material (eqs 11 and 12).
    """

    name: str
    modulus_ratio: float
    scaled: bool
    originals: bool


# Young's moduli in GPa: the printed surface energies 0.0293, 0.0222 and 0.0117 J/m2 and the ratios 0.26, 0.132 and 0.026 of
# sec. 4.3 are those of 1, 0.5 and 0.1 GPa over 3.8 GPa.
REAL_MODULUS = 3.8e9
REDUCED_MODULI = {"1": 1.0e9, "2": 0.5e9, "3": 0.1e9}


def series(name: str) -> Series:
    """A series of table 1 by its name: S, or A, B, C with -1, -2 or -3.

    Raises
    ------
    PlanError
        Where table 1 has no such line.
    """
    letter, _, number = name.partition("-")
    if name == "S":
        return Series(name=name, modulus_ratio=1.0, scaled=True, originals=True)
    if letter not in ("A", "B", "C") or number not in REDUCED_MODULI:
        known = ["S", *(f"{letter}-{number}" for letter in "ABC" for number in REDUCED_MODULI)]
        raise PlanError(f"packing: no series '{name}' in table 1 of Chen 2019. Known: {', '.join(known)}.")
    return Series(name=name, modulus_ratio=REDUCED_MODULI[number] / REAL_MODULUS, scaled=letter != "A", originals=letter == "C")


@dataclass(frozen=True, kw_only=True)
class PackingScene:
    """Spheres that rain on a floor, in a column that is periodic in x and y.

    Attributes
    ----------
    adhesion_number : float
        Ad = gamma/(rho U^2 R) of the real material, R = r/2 the effective radius (Liu 2015: w/(2 rho U^2 R), w = 2 gamma).
    modulus_ratio, scaled, originals
        As in `Series`.
    particles, seed : int
        How many, and of the random column.
    speed : float
        U of the rain [m/s].
    density, youngs_modulus, poissons_ratio, surface_energy : float
        Of the real material [kg/m3, Pa, -, J/m2].
    restitution_coefficient, friction_coefficient, critical_rolling_angle : float
        e without adhesion, mu, theta_crit [-, -, rad].
    rolling_damping : float
        Of `rolling_friction krijt`, over critical.
    box_in_radii : float
        Edge of the column's cross-section [r].
    inlet_fraction : float
        Solid fraction of the rain.
    steps_per_collision : int
        Time steps in the shorter of Hertz collision at U and stuck period.
    rest_fraction : float
        At rest when the kinetic energy is this part of what it was at the inlet.
    settling_time : float
        Longest time after the last sphere has come down [r/U].
    settling_acceleration : float
        Towards the floor, once the last sphere has come down [U^2/r]; 0 for none.
    """

    adhesion_number: float
    modulus_ratio: float
    scaled: bool
    originals: bool
    particles: int
    seed: int
    speed: float
    density: float
    youngs_modulus: float
    poissons_ratio: float
    surface_energy: float
    restitution_coefficient: float
    friction_coefficient: float
    critical_rolling_angle: float
    rolling_damping: float
    box_in_radii: float
    inlet_fraction: float
    steps_per_collision: int
    rest_fraction: float
    settling_time: float
    settling_acceleration: float = 0.0

    @property
    def radius(self) -> float:
        """r = 2 R [m], R from the adhesion number."""
        return 2 * self.surface_energy / (self.density * self.speed**2 * self.adhesion_number)

    @property
    def mass(self) -> float:
        """Of one sphere [kg]."""
        return 4 / 3 * math.pi * self.radius**3 * self.density

    @property
    def box(self) -> float:
        """Edge of the column [m]."""
        return self.box_in_radii * self.radius

    @property
    def time_unit(self) -> float:
        """r/U [s]."""
        return self.radius / self.speed

    @property
    def youngs_modulus_mod(self) -> float:
        """Young's modulus of the contact law [Pa]."""
        return self.youngs_modulus * self.modulus_ratio

    @property
    def surface_energy_mod(self) -> float:
        """gamma of the normal law [J/m2]; Chen 2019, eq. 10."""
        return scaling.surface_energy_mod(self.surface_energy, self.modulus_ratio) if self.scaled else self.surface_energy

    @property
    def inlet_energy(self) -> float:
        """Kinetic energy of all spheres at the inlet [J]."""
        return 0.5 * self.particles * self.mass * self.speed**2

    @cached_property
    def pair(self) -> PairProperties:
        """Two spheres, with the stiffness and surface energy of the contact law."""
        moduli, ratios = (self.youngs_modulus_mod,) * 2, (self.poissons_ratio,) * 2
        return PairProperties(
            effective_radius=self.radius / 2,
            effective_mass=self.mass / 2,
            effective_inertia=0.2 * self.mass * self.radius**2,
            effective_modulus=contact.effective_modulus(moduli, ratios),
            effective_shear_modulus=contact.effective_shear_modulus(moduli, ratios),
            surface_energy=self.surface_energy_mod,
            surface_energy_of_rolling=self.surface_energy if self.originals else self.surface_energy_mod,
            restitution_coefficient=self.restitution_coefficient,
        )

    @property
    def neck(self) -> float:
        """delta_C of the longest neck [m], that at the floor, R = r; Chen 2019, eq. 6."""
        return 2 ** (1 / 3) * -contact.rupture_overlap(self.pair, "jkr")

    @property
    def equilibrium_overlap(self) -> float:
        """delta_e = a_0^2/(3 R) [m]; Chen 2019, eq. 16."""
        return self.pair.equilibrium_contact_radius**2 / (3 * self.pair.effective_radius)

    @cached_property
    def time_scales(self) -> dict[str, float]:
        """Longest time step that each mode of the contact asks for [s].

        The collision at U and the stuck oscillation in `steps_per_collision` steps; sliding, rolling and twisting at the
        deepest point of an impact at twice U within half of Verlet's limit, since a sphere in the bed has many contacts.
        """
        pair = self.pair
        deepest = contact.maximum_contact_radius(pair, CLOSING_SPEEDS * self.speed)
        sliding, twisting = timestep.sliding_period(pair, deepest), timestep.twisting_period(pair, deepest)
        limits = {
            "sliding": timestep.verlet_limit(sliding, timestep.tangential_damping_ratio(pair, deepest, sliding)),
            "rolling": timestep.verlet_limit(timestep.rolling_period(pair, deepest), self.rolling_damping),
            "twisting": timestep.verlet_limit(twisting, timestep.tangential_damping_ratio(pair, deepest, twisting)),
        }
        hertz = timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, self.speed)
        return {
            "collision": hertz / self.steps_per_collision,
            "stuck": timestep.stuck_period(pair) / self.steps_per_collision,
            **{mode: STABLE_FRACTION * limit for mode, limit in limits.items()},
        }

    @property
    def limiting_mode(self) -> str:
        """Mode that sets the time step."""
        return min(self.time_scales, key=self.time_scales.__getitem__)

    @property
    def time_step(self) -> float:
        """Time step [s], the shortest of `time_scales`."""
        return self.time_scales[self.limiting_mode]
