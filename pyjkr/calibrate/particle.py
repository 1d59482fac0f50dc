"""The particle of a rebound experiment: what is known beforehand, and how speeds turn into gamma E^(-2/5) and back.

Covers the similarity group of Chen, Liu, Li 2019, eqs 9 and 10 (Haervig et al. 2017, eq. 24). Assumes a solid sphere that
meets a flat wall or its like; E is the effective modulus throughout, gamma the energy of one surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from pyjkr.errors import PyjkrError

# m v_*^2 = F_C a_0^2/R = K (gamma E^(-2/5))^(5/3) R^(4/3), from F_C = 3 pi R gamma and a_0^3 = 9 pi gamma R^2/E.
ENERGY_OF_GROUP = 3 * math.pi * (9 * math.pi) ** (2 / 3)


class CalibrationError(PyjkrError):
    """Measurements that cannot be read, or from which nothing can be learnt."""

    exit_code = 2


@dataclass(frozen=True, kw_only=True)
class Particle:
    """One sphere, what it meets, and the moduli to name surface energies for.

    Parameters
    ----------
    radius : float
        r [m].
    density, mass : float or None
        [kg/m3], [kg]; exactly one of them.
    target : str
        "wall", or "sphere" for a second sphere like the first; speeds are then relative ones.
    effective_modulus : float or None
        E of the real pair [Pa], 1/E = sum (1 - nu_i^2)/E_i; without it only gamma E^(-2/5) is named.
    effective_modulus_mod : float or None
        E_mod of the simulation [Pa].

    Raises
    ------
    CalibrationError
        Where a value is missing, given twice or out of range.
    """

    radius: float
    density: float | None = None
    mass: float | None = None
    target: Literal["wall", "sphere"] = "wall"
    effective_modulus: float | None = None
    effective_modulus_mod: float | None = None

    def __post_init__(self) -> None:
        if (self.density is None) == (self.mass is None):
            raise CalibrationError("particle: give exactly one of density [kg/m3] and mass [kg].")
        units = {"radius": "m", "density": "kg/m3", "mass": "kg", "effective_modulus": "Pa", "effective_modulus_mod": "Pa"}
        for name, unit in units.items():
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise CalibrationError(f"particle: {name} = {value!r} {unit} must be positive and finite. Correct it.")
        if self.target not in ("wall", "sphere"):
            raise CalibrationError(f"particle: target = {self.target!r} must be 'wall' or 'sphere'.")

    @property
    def effective_radius(self) -> float:
        """R [m]: r at a wall, r/2 for two like spheres."""
        return self.radius if self.target == "wall" else 0.5 * self.radius

    @property
    def effective_mass(self) -> float:
        """m [kg]: the mass at a wall, half of it for two like spheres."""
        mass = self.mass if self.mass is not None else 4 / 3 * math.pi * self.radius**3 * self.density
        return mass if self.target == "wall" else 0.5 * mass

    def speed_unit(self, group: float) -> float:
        """v_* = sqrt(F_C a_0^2/(R m)) [m/s] of a group gamma E^(-2/5) [J m^-2 Pa^-0.4]."""
        return (ENERGY_OF_GROUP * group ** (5 / 3) * self.effective_radius ** (4 / 3) / self.effective_mass) ** 0.5

    def group(self, speed_unit: float) -> float:
        """gamma E^(-2/5) [J m^-2 Pa^-0.4] of a speed v_* [m/s]: `speed_unit` inverted."""
        return (self.effective_mass * speed_unit**2 / (ENERGY_OF_GROUP * self.effective_radius ** (4 / 3))) ** 0.6


def similarity_group(surface_energy: float, effective_modulus: float) -> float:
    """gamma E^(-2/5) [J m^-2 Pa^-0.4]: what a rebound knows of surface energy and stiffness; Chen 2019, eq. 10."""
    return surface_energy * effective_modulus**-0.4


def surface_energy_of(group: float, effective_modulus: float) -> float:
    """gamma [J/m2] that goes with a modulus [Pa]: `similarity_group` inverted."""
    return group * effective_modulus**0.4


def chen_group(speed_ratio: float) -> float:
    """(Ad El^(-2/5))^(-5/6) of Chen 2019, eq. 9, at v/v_*: its fig. 5 has this abscissa; a sphere at a wall.

    Ad = gamma/(rho v^2 r) and El = E/(rho v^2) with m = 4/3 pi rho r^3 give (v_*/v)^2 = K/(4 pi/3) (Ad El^(-2/5))^(5/3).
    """
    return speed_ratio * math.sqrt(ENERGY_OF_GROUP / (4 * math.pi / 3))
