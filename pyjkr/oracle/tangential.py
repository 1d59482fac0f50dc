# Law: adhesive sliding (`tangential jkr`), a spring that yields and a dashpot beside it, their sum capped by friction.
# Covers: Haervig et al. 2017 section 2.1, eqs 14-17 and 6; Chen et al. 2019 eqs 1b, 3a, 12 (sliding limit with the
#   original surface energy).
# Assumes: history rotated with the contact by the caller; vectors on the last axis, one contact per row.
"""Sliding of a contact, and the spring-dashpot-slider that sliding and twisting share.

The spring yields at the limit L: k |s| <= L, and beyond it the contact slips plastically along the spring,
s' = v - lambda s/|s| with lambda >= 0 keeping k |s| = L. The load is spring + dashpot, capped:
f = min(1, L/|k s + eta v|) (k s + eta v). It never makes energy: f is the point nearest to k s + eta v within the ball
of radius L, and k s lies in that ball, so (f - k s) . v >= 0. (Stock `tangential history` truncates the spring alone
and drops the dashpot while it slides. Resetting the spring so that spring + dashpot = L, as some codes do, stretches it
against v where eta v alone exceeds L, and hands energy back.)

The direction of a yielding spring follows the slip over a way of L/k. Where that is far less than the contact slips
(friction below about 0.01, or 0.05 without adhesion) the equations are stiff and the integration slow.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .normal import (
    Model,
    NormalContact,
    contact_radius_slope,
    damping_ratio,
    elastic_force,
    normal_stiffness,
    tangential_radius,
)
from .vectors import cross, dot


@dataclass(frozen=True)
class Slider:
    """Spring, dashpot and limit of one resisting load at one overlap; and the derivatives with respect to the overlap
    of spring and limit.

    Units: N/m, kg/s, N for sliding; N m/rad, N m s/rad, N m for twisting.
    """

    stiffness: ArrayLike
    dashpot: ArrayLike
    limit: ArrayLike
    stiffness_slope: ArrayLike
    limit_slope: ArrayLike


def effective_shear_modulus(
    youngs_modulus_i: float, poissons_ratio_i: float, youngs_modulus_j: float, poissons_ratio_j: float
) -> float:
    """Effective shear modulus G [Pa], 1/G = sum (2 - nu)/G_i with G_i = E_i/(2 (1 + nu_i)), Haervig 2017 eq. 15."""
    compliance = [
        2 * (1 + nu) * (2 - nu) / modulus
        for modulus, nu in ((youngs_modulus_i, poissons_ratio_i), (youngs_modulus_j, poissons_ratio_j))
    ]
    return 1.0 / sum(compliance)


def tangential_stiffness(contact: NormalContact, effective_shear_modulus: ArrayLike, overlap: ArrayLike) -> ArrayLike:
    """Stiffness k_T [N/m]: 8 G sqrt(R overlap) (simplified, Haervig 2017 eq. 14) or 8 G a (full, Chen 2019 eq. 1b)."""
    return 8 * effective_shear_modulus * tangential_radius(contact, overlap)


def tangential_damping(contact: NormalContact, stiffness: ArrayLike, effective_mass: ArrayLike) -> ArrayLike:
    """Dashpot eta_T = 2 sqrt(5/6) abs(beta) sqrt(k_T m) [kg/s], Haervig 2017 eq. 16."""
    return 2 * np.sqrt(5 / 6) * damping_ratio(contact.restitution_coefficient) * np.sqrt(stiffness * effective_mass)


def sliding_limit(
    contact: NormalContact, friction_coefficient: ArrayLike, pull_off_force: ArrayLike, overlap: ArrayLike
) -> ArrayLike:
    """Largest tangential force mu abs(F_N + 2 F_C) [N], Haervig 2017 eq. 17.

    Parameters
    ----------
    contact : the (possibly stiffness-reduced) normal contact that gives F_N, without damping.
    friction_coefficient : [-].
    pull_off_force : [N], F_C of the ORIGINAL surface energy (Chen 2019 eq. 12).
    overlap : [m], positive in compression.
    """
    return friction_coefficient * np.abs(elastic_force(contact, overlap) + 2 * pull_off_force)


def sliding(
    contact: NormalContact,
    effective_shear_modulus: ArrayLike,
    friction_coefficient: ArrayLike,
    pull_off_force: ArrayLike,
    effective_mass: ArrayLike,
    overlap: ArrayLike,
    damping: bool = True,
    slopes: bool = True,
) -> Slider:
    """Spring, dashpot and limit of sliding at one overlap [m]; the other parameters as in the functions above.

    `damping` off drops the dashpot; `slopes` off leaves the derivatives out (nan), which only a slipping contact needs.
    """
    radius = tangential_radius(contact, overlap)
    stiffness = 8 * effective_shear_modulus * radius
    dashpot = tangential_damping(contact, stiffness, effective_mass) if damping else 0.0 * stiffness
    net = elastic_force(contact, overlap) + 2 * pull_off_force
    limit = friction_coefficient * np.abs(net)
    if not slopes:
        return Slider(stiffness, dashpot, limit, np.nan, np.nan)
    radius = np.maximum(radius, 1e-300)  # slopes diverge at overlap 0, where nothing slides yet
    slope = (
        contact.effective_radius / (2 * radius)
        if contact.model is Model.SIMPLIFIED
        else contact_radius_slope(contact, overlap)
    )
    slope, normal_slope = (
        np.where(np.isfinite(value), value, 0.0) for value in (slope, normal_stiffness(contact, overlap))
    )  # constant beyond rupture
    return Slider(
        stiffness=stiffness,
        dashpot=dashpot,
        limit=limit,
        stiffness_slope=8 * effective_shear_modulus * slope,
        limit_slope=friction_coefficient * np.sign(net) * normal_slope,
    )


def slip_velocity(velocity_i, velocity_j, spin_i, spin_j, arm_i, arm_j, normal) -> np.ndarray:
    """Tangential velocity v_S = u_i - u_j [m/s] of the surfaces at the contact; arms [m] from the centres, normal
    from i to j."""
    u = velocity_i - velocity_j + cross(arm_i * spin_i + arm_j * spin_j, normal)
    return u - normal * dot(u, normal)


def resistance(
    slider: Slider, displacement: np.ndarray, velocity: np.ndarray, yielding: ArrayLike = False
) -> np.ndarray:
    """Resisting load f of a slider, spring + dashpot capped at the limit; the force on i is -f.

    Parameters
    ----------
    slider : stiffness, dashpot and limit.
    displacement, velocity : [m], [m/s] (or [rad], [rad/s]), vectors on the last axis.
    yielding : where the spring is at its limit, whatever the last digits of the displacement say.
    """
    limit = _column(slider.limit)
    spring = _column(slider.stiffness) * displacement
    if np.any(yielding):
        spring = np.where(_column(yielding), limit * _direction(displacement), spring)
    total = spring + _column(slider.dashpot) * velocity
    length = np.sqrt(dot(total, total))
    return total * np.where(length > limit, limit / np.where(length > 0, length, 1.0), 1.0)


def returned_displacement(slider: Slider, displacement: np.ndarray) -> np.ndarray:
    """Displacement after the spring has yielded: unchanged while k |s| <= L, else cut back along itself to L/k."""
    spring = _column(slider.stiffness) * np.sqrt(dot(displacement, displacement))
    limit = _column(slider.limit)
    return displacement * np.where(spring > limit, limit / np.where(spring > 0, spring, 1.0), 1.0)


def slip_rate(slider: Slider, displacement: np.ndarray, velocity: np.ndarray, overlap_rate: ArrayLike) -> np.ndarray:
    """Multiplier lambda = (s/|s|) . v - d(L/k)/dt [m/s] that keeps the spring at the limit, negative where the
    contact would rather stick again.

    Parameters
    ----------
    slider : stiffness, limit and their slopes.
    displacement, velocity : [m], [m/s], the last in the frame that turns with the contact.
    overlap_rate : [m/s].
    """
    stiffness = np.where(slider.stiffness > 0, slider.stiffness, np.inf)
    room_slope = slider.limit_slope / stiffness - slider.limit * slider.stiffness_slope / stiffness**2
    return dot(_direction(displacement), velocity)[..., 0] - room_slope * overlap_rate


def plastic_rate(slider: Slider, displacement: np.ndarray, velocity: np.ndarray, overlap_rate: ArrayLike) -> np.ndarray:
    """s' = v - lambda s/|s| [m/s] of a yielding spring."""
    return velocity - _column(slip_rate(slider, displacement, velocity, overlap_rate)) * _direction(displacement)


def _direction(displacement: np.ndarray) -> np.ndarray:
    length = np.sqrt(dot(displacement, displacement))
    return displacement / np.where(length > 0, length, 1.0)


def _column(value: ArrayLike) -> np.ndarray:
    return np.asarray(value)[..., np.newaxis]
