"""The adhesive contact by other means, for judging runs: Newton from above for the contact radius, closed-form energy.

Haervig 2017 eqs 7-10, Chen 2019 eqs 1a and 6. Shares no line with the kernels. Accepts arrays; SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def effective_modulus(young: float, poisson: float) -> float:
    """Effective Young's modulus [Pa] of two surfaces of one material."""
    return young / (2.0 * (1.0 - poisson**2))


def effective_shear_modulus(young: float, poisson: float) -> float:
    """Effective shear modulus [Pa] of two surfaces of one material."""
    return young / (4.0 * (2.0 - poisson) * (1.0 + poisson))


@dataclass(frozen=True)
class AdhesivePair:
    """Effective modulus [Pa], effective radius [m] and surface energy [J/m2] of a contact."""

    modulus: float
    radius: float
    surface_energy: float

    @property
    def pull_off_force(self) -> float:
        """F_C [N], positive."""
        return 3.0 * math.pi * self.radius * self.surface_energy

    @property
    def equilibrium_contact_radius(self) -> float:
        """a_0 [m]."""
        return (9.0 * math.pi * self.surface_energy * self.radius**2 / self.modulus) ** (1.0 / 3.0)

    @property
    def equilibrium_overlap(self) -> float:
        """delta_0 [m], where the elastic force is 0."""
        return self.equilibrium_contact_radius**2 / (3.0 * self.radius)

    @property
    def rupture_overlap(self) -> float:
        """-delta_C [m]."""
        return -(self.equilibrium_contact_radius**2) / (2.0 * 6.0 ** (1.0 / 3.0) * self.radius)

    @property
    def stiffness(self) -> float:
        """dF/d(delta) at the equilibrium overlap [N/m]."""
        return 1.2 * self.modulus * self.equilibrium_contact_radius

    @property
    def energy_unit(self) -> float:
        """F_C a_0^2/R [J], the scale of the adhesive well."""
        return self.pull_off_force * self.equilibrium_contact_radius**2 / self.radius

    def contact_radius_ratio(self, overlap: float | Array) -> Array:
        """a/a_0 on the stable branch: largest root of s^2 - (2/3) sqrt(s) = delta R/a_0^2, in v = sqrt(s)."""
        x = np.asarray(overlap, float) * self.radius / self.equilibrium_contact_radius**2
        v = (
            1.0 + np.maximum(x, 0.0) ** 0.25
        )  # above the root, where the quartic is convex: Newton comes down and stays above
        for _ in range(80):
            v = np.maximum(v - (v**4 - 2.0 / 3.0 * v - x) / (4.0 * v**3 - 2.0 / 3.0), 6.0 ** (-1.0 / 3.0))
        return v**2

    def force(self, overlap: float | Array) -> Array:
        """Elastic force [N], repulsive positive; Hertz where the surface energy is 0."""
        if self.surface_energy == 0.0:
            return 4.0 / 3.0 * self.modulus * math.sqrt(self.radius) * np.asarray(overlap, float) ** 1.5
        s = self.contact_radius_ratio(overlap)
        return 4.0 * self.pull_off_force * (s**3 - s**1.5)

    def energy(self, overlap: float | Array) -> Array:
        """Elastic plus surface energy [J], 0 at the equilibrium overlap: integral of F d(delta) in s = a/a_0."""
        s = self.contact_radius_ratio(overlap)
        work = 2.0 * s**5 / 5.0 - 2.0 * s**3.5 / 3.0 + s**2 / 6.0
        at_equilibrium = 2.0 / 5.0 - 2.0 / 3.0 + 1.0 / 6.0
        return 4.0 * self.energy_unit * (work - at_equilibrium)


def sphere_mass(radius: float, density: float) -> float:
    """Mass of a sphere [kg]."""
    return 4.0 / 3.0 * math.pi * radius**3 * density
