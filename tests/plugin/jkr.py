"""JKR and the mixing rules in mpmath, from the properties a deck names: what the runs of these tests are compared with.

Haervig 2017 eqs 2, 7 to 10 and 15. A wall is a partner of infinite radius, and of the same material here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from mpmath import mp, mpf, workdps

DIGITS = 40
EPSILON = 2.0**-52
RUPTURE_HAT = 0.27516060407455222  # delta_C R/a_0^2 = 1/(2 6^(1/3))
LOSS_HAT = 0.25741351095852878  # make-break loss over F_C a_0^2/R
STICKING_HAT = 0.71751447506481  # sqrt(2 LOSS_HAT): sticking speed over sqrt(F_C a_0^2/(R m)) at e = 1


def effective_modulus(
    youngs: float, poisson: float, youngs_j: float | None = None, poisson_j: float | None = None
) -> float:
    youngs_j, poisson_j = youngs_j or youngs, poisson_j or poisson
    return 1.0 / ((1.0 - poisson**2) / youngs + (1.0 - poisson_j**2) / youngs_j)


def effective_shear_modulus(youngs: float, poisson: float) -> float:
    """Of two partners of the same material: 1/G = 2 (2 - nu)/G_i, G_i = E_i/(2 (1 + nu))."""
    return youngs / (4.0 * (1.0 + poisson) * (2.0 - poisson))


@dataclass(frozen=True)
class Jkr:
    """Effective radius [m], modulus [Pa], surface energy of one surface [J/m2]."""

    radius: float
    modulus: float
    energy: float

    @property
    def pull_off(self) -> float:
        return 3.0 * math.pi * self.radius * self.energy

    @property
    def a0(self) -> float:
        return (9.0 * math.pi * self.energy * self.radius**2 / self.modulus) ** (1.0 / 3.0)

    @property
    def rupture(self) -> float:
        """Overlap at which the neck snaps [m], negative."""
        return -RUPTURE_HAT * self.a0**2 / self.radius

    @property
    def settled(self) -> float:
        """Overlap without load [m]."""
        return self.a0**2 / (3.0 * self.radius)

    @property
    def stiffness(self) -> float:
        """dF/d(overlap) without load [N/m]."""
        return 1.2 * self.modulus * self.a0

    def _contact_radius(self, overlap: mpf) -> mpf:
        """Largest root of overlap(a), the change of sign tested."""
        R, E, g = mpf(self.radius), mpf(self.modulus), mpf(self.energy)  # noqa: N806
        if g == 0:
            return mp.sqrt(R * overlap)
        last = mp.cbrt(mp.pi * g * R**2 / (4 * E))
        c = 2 * mp.sqrt(mp.pi * g / E) * R
        if overlap * R <= last**2 - c * mp.sqrt(last):
            return last
        b = mp.sqrt(last) + mp.root(max(overlap, 0) * R, 4) + mp.cbrt(c)
        for _ in range(400):
            step = (b**4 - c * b - overlap * R) / (4 * b**3 - c)
            b -= step
            if abs(step) < b * mpf(10) ** (5 - DIGITS):
                break
        near = b * (1 + mpf(10) ** -18)
        assert near**4 - c * near > overlap * R
        return b * b

    def _force(self, overlap: mpf) -> mpf:
        a = self._contact_radius(overlap)
        R, E, g = mpf(self.radius), mpf(self.modulus), mpf(self.energy)  # noqa: N806
        return 4 * E * a**3 / (3 * R) - 4 * mp.sqrt(mp.pi * g * E * a**3)

    def contact_radius(self, overlap: float) -> float:
        with workdps(DIGITS):
            return float(self._contact_radius(mpf(overlap)))

    def force(self, overlap: float) -> float:
        with workdps(DIGITS):
            return float(self._force(mpf(overlap)))

    def force_change(self, overlap: float, rounding: float) -> float:
        """Largest change of the force when the overlap moves by `rounding` either way [N]."""
        with workdps(DIGITS):
            d, h = mpf(overlap), mpf(rounding)
            here = self._force(d)
            return float(
                max(
                    abs(self._force(d + h) - here),
                    abs(self._force(max(d - h, mpf(0)) if self.energy == 0 else d - h) - here),
                )
            )
