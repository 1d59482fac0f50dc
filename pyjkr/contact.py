"""One pair in contact: effective properties (Haervig 2017, eqs 2 and 15) and the lengths, forces and energies of JKR.

Covers equilibrium (eq. 7), pull-off, the neck's rupture (Chen 2019, eq. 6), and the deepest overlap an impact can reach.
Assumes small strain: the formulas are evaluated for any overlap, and the plan leaves out what presses too deep.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

# Overlap at rupture in units of a_0^2/R: 1/(2 6^(1/3)); Chen 2019, eq. 6.
RUPTURE_OVERLAP_SCALE = 1 / (2 * 6 ** (1 / 3))
# Contact radius at zero overlap in units of a_0: Haervig 2017, eq. 10 with zero overlap.
CONTACT_RADIUS_AT_ZERO_OVERLAP = (2 / 3) ** (2 / 3)
# Pull of a contact at zero overlap in units of F_C: Haervig 2017, eqs 8-10 with zero overlap. There jkr/simplified ends.
FORCE_AT_ZERO_OVERLAP = 8 / 9
# sqrt(a/a_0) at rupture: 4 v^3 = 2/3.
ROOT_AT_RUPTURE = 6 ** (-1 / 3)
# Newton's method in `contact_radius`: after three steps 6e-7 is left over all overlaps, after four round-off.
NEWTON_STEPS = 5


@dataclass(frozen=True, kw_only=True)
class PairProperties:
    """Effective properties of two bodies that touch, as the contact law sees them.

    Attributes
    ----------
    effective_radius : float
        R [m], 1/R = 1/r_i + 1/r_j; the sphere's radius at a wall.
    effective_mass : float
        m [kg], 1/m = 1/m_i + 1/m_j; the sphere's mass at a wall.
    effective_inertia : float
        I_r [kg m2], 1/I_r = 1/I_i + 1/I_j; the sphere's at a wall.
    effective_modulus : float
        E [Pa], 1/E = sum (1 - nu_i^2)/E_i; modified when the stiffness is reduced.
    effective_shear_modulus : float
        G [Pa], 1/G = sum (2 - nu_i)/G_i; modified when the stiffness is reduced.
    surface_energy : float
        gamma of the normal law [J/m2], of one surface.
    surface_energy_of_rolling : float
        gamma in F_C of the rolling moment [J/m2]: the original one where it is kept, else the same.
    restitution_coefficient : float
        e of the contact without adhesion.
    """

    effective_radius: float
    effective_mass: float
    effective_inertia: float
    effective_modulus: float
    effective_shear_modulus: float
    surface_energy: float
    surface_energy_of_rolling: float
    restitution_coefficient: float

    @property
    def pull_off_force(self) -> float:
        """F_C = 3 pi R gamma [N], a positive magnitude."""
        return 3 * math.pi * self.effective_radius * self.surface_energy

    @property
    def equilibrium_contact_radius(self) -> float:
        """a_0 = (9 pi gamma R^2/E)^(1/3) [m]; Haervig 2017, eq. 7."""
        return (9 * math.pi * self.surface_energy * self.effective_radius**2 / self.effective_modulus) ** (1 / 3)


def effective_modulus(youngs_moduli: tuple[float, float], poissons_ratios: tuple[float, float]) -> float:
    """Effective Young's modulus E [Pa] of two materials; Haervig 2017, eq. 2."""
    return 1 / sum((1 - nu**2) / modulus for modulus, nu in zip(youngs_moduli, poissons_ratios, strict=True))


def effective_shear_modulus(youngs_moduli: tuple[float, float], poissons_ratios: tuple[float, float]) -> float:
    """Effective shear modulus G [Pa] of two materials; Haervig 2017, eq. 15."""
    shear_moduli = [modulus / (2 * (1 + nu)) for modulus, nu in zip(youngs_moduli, poissons_ratios, strict=True)]
    return 1 / sum((2 - nu) / shear for shear, nu in zip(shear_moduli, poissons_ratios, strict=True))


def particle_modulus(effective: float, poissons_ratio: float) -> float:
    """Young's modulus [Pa] to give to one of two materials so that the pair has `effective`.

    Papers quote E, LIGGGHTS wants the particles' moduli. With (1 - nu_i^2)/E_i alike for both, Haervig 2017 eq. 2
    reads 1/E = 2 (1 - nu^2)/E_i.
    """
    return 2 * (1 - poissons_ratio**2) * effective


def rupture_overlap(pair: PairProperties, normal_law: str) -> float:
    """Overlap at which the contact ends [m]: 0 for `jkr/simplified`, -delta_C for `jkr` (Chen 2019, eq. 6)."""
    if normal_law == "jkr/simplified":
        return 0.0
    return -RUPTURE_OVERLAP_SCALE * pair.equilibrium_contact_radius**2 / pair.effective_radius


def maximum_contact_radius(pair: PairProperties, speed: float) -> float:
    """Contact radius at the deepest point of an impact without damping [m].

    Kinetic energy m v^2/2 equals the elastic work from zero overlap, integral F d(delta) with Haervig 2017 eqs 8-10.
    In units F_C a_0^2/R and s = a/a_0 its primitive is 4 (2/5 s^5 - 2/3 s^(7/2) + s^2/6). Damping only makes the true
    contact smaller, so this is an upper bound.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    speed : float
        Normal speed of approach [m/s].
    """
    kinetic_energy = 0.5 * pair.effective_mass * speed**2
    radius, modulus = pair.effective_radius, pair.effective_modulus
    # Hertz: m v^2/2 = (8/15) E sqrt(R) delta^(5/2) with delta = a^2/R.
    hertz = (15 * kinetic_energy * radius**2 / (8 * modulus)) ** (1 / 5)
    zero_load = pair.equilibrium_contact_radius
    if zero_load == 0:
        return hertz
    wanted = kinetic_energy / _unit_of_work(pair) + _work(CONTACT_RADIUS_AT_ZERO_OVERLAP)
    # Beyond s = 1 the force repels and the work grows without bound: one root, bracketed by the Hertz radius.
    upper = 2 + 2 * hertz / zero_load
    return zero_load * brentq(lambda s: _work(s) - wanted, 1.0, upper, xtol=1e-14, rtol=1e-13)


def break_energy(pair: PairProperties) -> float:
    """Energy that a contact takes from making to breaking [J]: work of the full law from zero overlap into the neck's end.

    0.2574 F_C a_0^2/R: primitive of Haervig 2017, eqs 8-10, up to the rupture of Chen 2019, eq. 6.
    """
    return _unit_of_work(pair) * (_work(ROOT_AT_RUPTURE**2) - _work(CONTACT_RADIUS_AT_ZERO_OVERLAP))


def _unit_of_work(pair: PairProperties) -> float:
    return pair.pull_off_force * pair.equilibrium_contact_radius**2 / pair.effective_radius


def _work(s: float) -> float:
    """Work of the force up to a contact radius s a_0, in F_C a_0^2/R."""
    return 4 * (0.4 * s**5 - 2 / 3 * s**3.5 + s**2 / 6)


def overlap(pair: PairProperties, contact_radius: float) -> float:
    """Overlap at a contact radius [m]: delta = a^2/R - 2 sqrt(pi gamma a/E); Haervig 2017, eq. A.9."""
    neck = 2 * math.sqrt(math.pi * pair.surface_energy * contact_radius / pair.effective_modulus)
    return contact_radius**2 / pair.effective_radius - neck


def contact_radius(overlap: npt.ArrayLike, pair: PairProperties) -> np.ndarray:
    """Contact radius a [m] of a JKR contact at given overlaps: the stable root of Haervig 2017, eq. 10.

    In v = sqrt(a/a_0) and x = overlap R/a_0^2 the equation is v^4 - (2/3) v = x, with a double root c = 6^(-1/3) at
    rupture. For w = v - c it reads w sqrt(w^2 + 4 c w + 6 c^2) = sqrt(x + 3 c^4), whose left side rises and is convex:
    Newton's method comes down to the root from any start above it. The area of contact is pi a^2.

    Parameters
    ----------
    overlap : array_like
        Overlap [m], positive in compression, negative in a neck.
    pair : PairProperties
        R, E and gamma of the normal law; arrays are accepted, one entry per contact.

    Returns
    -------
    ndarray
        a [m]; 0 where there is no contact: beyond rupture, or without overlap where gamma = 0 (Hertz: sqrt(R delta)).
    """
    overlap, radius, zero_load = np.broadcast_arrays(
        np.asarray(overlap, dtype=float), pair.effective_radius, pair.equilibrium_contact_radius
    )
    adhesive = zero_load > 0
    unit = np.where(adhesive, zero_load, 1.0)
    reduced = overlap * radius / unit**2
    c = ROOT_AT_RUPTURE
    square = reduced + 3 * c**4
    # Rupture itself is still contact, also where rounding the overlap moved it a little beyond.
    holds = square >= -4 * np.finfo(float).eps
    reach = np.sqrt(np.maximum(square, 0.0))
    # Either term of the root alone gives an upper bound.
    w = np.minimum(np.sqrt(reach), reach / (math.sqrt(6) * c))
    for _ in range(NEWTON_STEPS):
        root = np.sqrt(w * (w + 4 * c) + 6 * c**2)
        w = w - (w * root - reach) * root / (2 * w * (w + 3 * c) + 6 * c**2)
    hertz = np.sqrt(radius * np.maximum(overlap, 0.0))
    return np.where(adhesive, np.where(holds, zero_load * (c + w) ** 2, 0.0), hertz)


def holding_force(pair: PairProperties, normal_law: str) -> float:
    """Strongest steady pull that the contact withstands [N]: F_C for `jkr`; (8/9) F_C for `jkr/simplified`.

    The simplified contact ends at zero overlap, before the force reaches -F_C.
    """
    return pair.pull_off_force * (FORCE_AT_ZERO_OVERLAP if normal_law == "jkr/simplified" else 1.0)


def maximum_overlap(pair: PairProperties, speed: float) -> float:
    """Deepest overlap of an impact without damping [m], an upper bound of the damped one."""
    return overlap(pair, maximum_contact_radius(pair, speed))
