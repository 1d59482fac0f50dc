# Law: adhesive normal contact of two elastic spheres, simplified JKR (`jkr/simplified`) and full JKR (`jkr`).
# Covers: Haervig et al. 2017 section 2.1, eqs 2, 7-13 with eq. 11 as 2 sqrt(5/6) (the printed 2 (5/6) does not
#   return e); Chen et al. 2019 eqs 1a, 6.
# Assumes: small strain, like surfaces (work of adhesion 2 gamma), repulsive forces positive. The contact radius is a
#   bracketed root.
"""Normal force of an adhesive contact.

Every function works in the scaled contact radius u = sqrt(a / a_1) with a_1 = max(a_0, sqrt(R |overlap|)), where
    overlap R / a_1^2 = u^4 - (2/3) eps u,   force / F_1 = 4 (u^6 - eps u^3),   F_1 = E a_1^3 / (3 R),   eps = (a_0 /
    a_1)^(3/2),
so that strongly adhesive contacts (eps = 1) and Hertz (eps = 0) share one form without overflow or special cases.
"""

from dataclasses import dataclass
from enum import Enum
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

CRITICAL = 6.0 ** (-1.0 / 3.0)  # u at rupture over sqrt(a_0 / a_1): there d(overlap)/du = 4 u^3 - (2/3) eps = 0
MANY = 8  # contacts from which the roots are cheaper all at once
ROOT_TOLERANCE = 4.0 * np.finfo(float).eps  # the tightest that brentq accepts


class Model(str, Enum):
    """The two normal laws, named as in an input deck."""

    SIMPLIFIED = "jkr/simplified"
    FULL = "jkr"


@dataclass(frozen=True)
class NormalContact:
    """Properties of one normal contact; arrays (one entry per contact) are accepted for the numbers.

    Parameters
    ----------
    effective_radius : [m], 1/R = 1/r_i + 1/r_j; the radius itself at a wall (Haervig 2017 eq. 2).
    effective_modulus : [Pa], 1/E = sum (1 - nu^2)/E (Haervig 2017 eq. 2).
    surface_energy : [J/m2], of one surface, >= 0; 0 is Hertz.
    model : "jkr/simplified" or "jkr".
    restitution_coefficient : [-], in (0, 1]; what damping alone would return (Haervig 2017 eq. 12).

    Raises
    ------
    ValueError : if a value is out of range or the model is unknown.
    """

    effective_radius: ArrayLike
    effective_modulus: ArrayLike
    surface_energy: ArrayLike
    model: Model | str = Model.SIMPLIFIED
    restitution_coefficient: ArrayLike = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", Model(self.model))
        for name in ("effective_radius", "effective_modulus", "surface_energy", "restitution_coefficient"):
            value = np.asarray(getattr(self, name), dtype=float)
            good = value >= 0 if name == "surface_energy" else value > 0
            if not np.all(good & np.isfinite(value)):
                raise ValueError(
                    f"{name} = {getattr(self, name)} must be finite and {'>= 0' if name == 'surface_energy' else '> 0'}"
                )
        if np.any(np.asarray(self.restitution_coefficient) > 1):
            raise ValueError(f"restitution_coefficient = {self.restitution_coefficient} must be <= 1")


def effective_radius(radius_i: ArrayLike, radius_j: ArrayLike) -> ArrayLike:
    """Effective radius [m] of two spheres, Haervig 2017 eq. 2; an infinite radius is a wall."""
    return 1.0 / (1.0 / np.asarray(radius_i) + 1.0 / np.asarray(radius_j))


def effective_modulus(
    youngs_modulus_i: float, poissons_ratio_i: float, youngs_modulus_j: float, poissons_ratio_j: float
) -> float:
    """Effective Young's modulus [Pa] of two bodies, Haervig 2017 eq. 2."""
    return 1.0 / ((1 - poissons_ratio_i**2) / youngs_modulus_i + (1 - poissons_ratio_j**2) / youngs_modulus_j)


def damping_ratio(restitution_coefficient: ArrayLike) -> ArrayLike:
    """abs(beta) [-] of Haervig 2017 eq. 12: 0 for e = 1, towards 1 for e -> 0."""
    log_e = np.log(restitution_coefficient)
    return -log_e / np.sqrt(log_e**2 + np.pi**2)


def equilibrium_contact_radius(contact: NormalContact) -> ArrayLike:
    """Contact radius a_0 [m] at which the elastic force vanishes, Haervig 2017 eq. 7."""
    return np.cbrt(9 * np.pi * contact.surface_energy * np.square(contact.effective_radius) / contact.effective_modulus)


def equilibrium_overlap(contact: NormalContact) -> ArrayLike:
    """Overlap a_0^2/(3 R) [m] at which the elastic force vanishes, Haervig 2017 section 3.1."""
    return equilibrium_contact_radius(contact) ** 2 / (3 * contact.effective_radius)


def pull_off_force(contact: NormalContact) -> ArrayLike:
    """Pull-off force F_C = 3 pi R gamma [N], a positive magnitude, Haervig 2017 section 2.1."""
    return 3 * np.pi * contact.effective_radius * contact.surface_energy


def rupture_overlap(contact: NormalContact) -> ArrayLike:
    """Overlap [m], <= 0, at which a separating contact ends: 0 (simplified) or -a_0^2/(2 6^(1/3) R) (full; Chen 2019
    eq. 6)."""
    if contact.model is Model.SIMPLIFIED:
        return 0.0 * np.asarray(contact.effective_radius)
    return -(equilibrium_contact_radius(contact) ** 2) * CRITICAL / (2 * contact.effective_radius)


def scaled_root(reach: float, critical: float) -> float:
    """Root w >= 0 of w sqrt(6 c^2 + 4 c w + w^2) = reach, bracketed; the scaled contact radius is then u = c + w.

    With c = u at rupture, u^4 - (2/3) eps u + 3 c^4 = w^2 (6 c^2 + 4 c w + w^2): the double root at rupture is gone,
    the left side is monotone and near rupture w is as well determined as the square root of the distance to it.
    """
    if reach <= 0.0:
        return 0.0  # at rupture, or beyond it by the round-off or the trial step of an integrator
    if critical == 0.0:
        return sqrt(reach)
    square, linear = 6.0 * critical * critical, 4.0 * critical
    upper = min(sqrt(reach), reach / sqrt(square)) * (1 + 1e-15)  # either term alone; widened against round-off
    lower = reach / sqrt(square + upper * (linear + upper)) * (1 - 1e-15)
    return brentq(lambda w: w * sqrt(square + w * (linear + w)) - reach, lower, upper, xtol=1e-300, rtol=ROOT_TOLERANCE)


def scaled_roots(reach: np.ndarray, critical: np.ndarray) -> np.ndarray:
    """`scaled_root` of many contacts at once: Newton from the upper end of the bracket.

    f(w) = w sqrt(6 c^2 + 4 c w + w^2) - reach grows and is convex, so the iterates fall monotonically to the root:
    the bracket needs no keeping.
    """
    square, linear = 6.0 * critical * critical, 4.0 * critical
    with np.errstate(divide="ignore", invalid="ignore"):
        w = np.fmin(np.sqrt(reach), reach / np.sqrt(square))  # either term alone
        for _ in range(60):
            slope = np.sqrt(square + w * (linear + w))
            step = (w * slope - reach) / (slope + w * (critical * 2 + w) / slope)
            w = w - np.where(w > 0, step, 0.0)
            if np.all(np.abs(step[w > 0]) <= ROOT_TOLERANCE * w[w > 0]):
                break
    return w


@dataclass(frozen=True)
class Indentation:
    """An overlap [m] with its root solved, to be given in place of the overlap where several laws are asked at the
    same one."""

    overlap: np.ndarray
    scaled: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def indentation(contact: NormalContact, overlap: ArrayLike) -> Indentation:
    """Solve once for what every function below needs at this overlap [m]."""
    return Indentation(np.asarray(overlap, dtype=float), _scaled(contact, overlap))


def _overlap(overlap: ArrayLike | Indentation) -> ArrayLike:
    return overlap.overlap if isinstance(overlap, Indentation) else overlap


def _scaled(
    contact: NormalContact, overlap: ArrayLike | Indentation
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(a_1 [m], eps [-], c [-], w [-]) of the module's docstring and `scaled_root`."""
    if isinstance(overlap, Indentation):
        return overlap.scaled
    overlap, zero_load = np.asarray(overlap, dtype=float), equilibrium_contact_radius(contact)
    scale = np.maximum(zero_load, np.sqrt(contact.effective_radius * np.abs(overlap)))
    scale = np.where(scale == 0.0, contact.effective_radius, scale)  # Hertz at overlap 0: any length will do
    root_ratio = np.sqrt(zero_load / scale)
    critical = CRITICAL * root_ratio
    reach = np.sqrt(np.maximum(contact.effective_radius * overlap / scale**2 + 3 * critical**4, 0.0))
    if reach.ndim == 0:
        return scale, root_ratio**3, critical, np.float64(scaled_root(float(reach), float(critical)))
    reach, critical = np.broadcast_arrays(reach, critical)
    if reach.size < MANY:
        root = np.fromiter(
            map(scaled_root, reach.ravel().tolist(), critical.ravel().tolist()), float, reach.size
        ).reshape(reach.shape)
    else:
        root = scaled_roots(reach, critical)
    return scale, root_ratio**3, critical, root


def contact_radius(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """Contact radius a [m] on the stable branch, Haervig 2017 eq. 10.

    Parameters
    ----------
    contact : properties of the contact.
    overlap : [m], positive in compression; below the rupture of the neck (both models) the value at rupture is held.

    Returns
    -------
    [m]; 0 for a Hertz contact that does not touch.
    """
    scale, _, critical, root = _scaled(contact, overlap)
    return scale * (critical + root) ** 2


def elastic_force(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """Elastic and adhesive normal force [N], repulsive positive, without damping, Haervig 2017 eqs 8-9.

    Parameters
    ----------
    contact : properties of the contact.
    overlap : [m], positive in compression. The simplified law is this same curve, cut at overlap 0 by whoever follows
        the contact.
    """
    scale, eps, critical, root = _scaled(contact, overlap)
    cubed = (critical + root) ** 3
    return 4 * contact.effective_modulus * scale**3 / (3 * contact.effective_radius) * cubed * (cubed - eps)


def normal_stiffness(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """d(elastic force)/d(overlap) [N/m], from Haervig 2017 eqs 8-10; infinite at the rupture of the neck."""
    scale, eps, critical, root = _scaled(contact, overlap)
    u = critical + root
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (24 * u**5 - 12 * eps * u**2) / _overlap_slope(critical, root)
    return np.nan_to_num(contact.effective_modulus * scale / 3 * slope, nan=0.0, posinf=np.inf, neginf=-np.inf)


def contact_radius_slope(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """d(contact radius)/d(overlap) [-], from Haervig 2017 eq. 10; infinite at the rupture of the neck."""
    scale, _, critical, root = _scaled(contact, overlap)
    with np.errstate(divide="ignore", invalid="ignore"):
        return contact.effective_radius / scale * 2 * (critical + root) / _overlap_slope(critical, root)


def _overlap_slope(critical: ArrayLike, root: ArrayLike) -> ArrayLike:
    """4 u^3 - (2/3) eps, written in w so that nothing cancels near rupture."""
    return 4 * root * (3 * critical**2 + root * (3 * critical + root))


def damping_coefficient(contact: NormalContact, overlap: ArrayLike, effective_mass: ArrayLike) -> ArrayLike:
    """Coefficient eta_N [kg/s] of the damping force eta_N d(overlap)/dt, Haervig 2017 eqs 11-13 or Marshall 2009
    (Chen 2019 eq. 1a).

    Simplified: 2 sqrt(5/6) abs(beta) sqrt(S_n m), S_n = 2 E sqrt(R overlap). Full: sqrt(5) abs(beta) sqrt(m (4/3) E
    a), in the neck too.
    For Hertz the two are the same number, and return the restitution coefficient exactly.
    """
    beta, modulus = damping_ratio(contact.restitution_coefficient), contact.effective_modulus
    if contact.model is Model.SIMPLIFIED:
        stiffness = 2 * modulus * np.sqrt(contact.effective_radius * np.maximum(_overlap(overlap), 0.0))
        return 2 * np.sqrt(5 / 6) * beta * np.sqrt(stiffness * effective_mass)
    return np.sqrt(5) * beta * np.sqrt(effective_mass * 4 / 3 * modulus * contact_radius(contact, overlap))


def tangential_radius(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """Length [m] that sets the tangential stiffness: sqrt(R overlap) (simplified, Haervig 2017 eq. 14) or a (full,
    Chen 2019 eq. 1b)."""
    if contact.model is Model.SIMPLIFIED:
        return np.sqrt(contact.effective_radius * np.maximum(_overlap(overlap), 0.0))
    return contact_radius(contact, overlap)


def stored_energy(contact: NormalContact, overlap: ArrayLike) -> ArrayLike:
    """Work [J] done against the elastic force since the contact formed at overlap 0; Haervig 2017 eq. 23 is its value
    at equilibrium."""
    scale, eps, critical, root = _scaled(contact, overlap)
    energy = contact.effective_modulus * scale**5 / (3 * np.square(contact.effective_radius))
    return energy * (scaled_energy(critical + root, eps) - scaled_energy(np.cbrt(2 * eps / 3), eps))


def scaled_energy(u: ArrayLike, eps: ArrayLike) -> ArrayLike:
    """Integral of 4 (u^6 - eps u^3) over d(u^4 - (2/3) eps u), from u = 0."""
    return 4 * u**4 * (0.4 * u**6 - 2 / 3 * eps * u**3 + eps**2 / 6)
