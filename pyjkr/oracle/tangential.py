# Law: adhesive sliding, a spring and a dashpot in series with nothing, truncated by friction (`tangential jkr`).
# Covers: Haervig et al. 2017 section 2.1, eqs 14-17 and 6; Chen et al. 2019 eqs 1b, 3a, 12 (sliding limit with the original surface energy).
# Assumes: history rotated with the contact by the caller; vectors on the last axis, one contact per row.
"""Sliding of a contact, and the spring-dashpot-slider that sliding and twisting share.

The slider resists with f = k xi + eta v, xi' = v. The TOTAL f, spring and dashpot, may not exceed the limit: where it would, f keeps its
direction at the length of the limit, and the spring is reset so that spring + dashpot is that f. (Stock `tangential history` truncates the
spring alone and drops the dashpot while it slides.) In continuous time the reset is xi' = v - lambda f/|f|, lambda >= 0 keeping |f| at the limit.
Known weakness of this reset: where eta v exceeds the limit it leaves a spring stretched against v, which can hand energy back (not for eta v << limit).
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
    """Spring, dashpot and limit of one resisting load at one overlap, and their derivatives with respect to the overlap.

    Units: N/m, kg/s, N for sliding; N m/rad, N m s/rad, N m for twisting.
    """

    stiffness: ArrayLike
    dashpot: ArrayLike
    limit: ArrayLike
    stiffness_slope: ArrayLike
    dashpot_slope: ArrayLike
    limit_slope: ArrayLike


def effective_shear_modulus(youngs_modulus_i: float, poissons_ratio_i: float, youngs_modulus_j: float, poissons_ratio_j: float) -> float:
    """Effective shear modulus G [Pa], 1/G = sum (2 - nu)/G_i with G_i = E_i/(2 (1 + nu_i)), Haervig 2017 eq. 15."""
    compliance = [2 * (1 + nu) * (2 - nu) / modulus for modulus, nu in ((youngs_modulus_i, poissons_ratio_i), (youngs_modulus_j, poissons_ratio_j))]
    return 1.0 / sum(compliance)


def tangential_stiffness(contact: NormalContact, effective_shear_modulus: ArrayLike, overlap: ArrayLike) -> ArrayLike:
    """Stiffness k_T [N/m]: 8 G sqrt(R overlap) (simplified, Haervig 2017 eq. 14) or 8 G a (full, Chen 2019 eq. 1b)."""
    return 8 * effective_shear_modulus * tangential_radius(contact, overlap)


def tangential_damping(contact: NormalContact, stiffness: ArrayLike, effective_mass: ArrayLike) -> ArrayLike:
    """Dashpot eta_T = 2 sqrt(5/6) abs(beta) sqrt(k_T m) [kg/s], Haervig 2017 eq. 16."""
    return 2 * np.sqrt(5 / 6) * damping_ratio(contact.restitution_coefficient) * np.sqrt(stiffness * effective_mass)


def sliding_limit(contact: NormalContact, friction_coefficient: ArrayLike, pull_off_force: ArrayLike, overlap: ArrayLike) -> ArrayLike:
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
        return Slider(stiffness, dashpot, limit, np.nan, np.nan, np.nan)
    radius = np.maximum(radius, 1e-300)  # slopes diverge at overlap 0, where nothing slides yet
    slope = contact.effective_radius / (2 * radius) if contact.model is Model.SIMPLIFIED else contact_radius_slope(contact, overlap)
    slope, normal_slope = (np.where(np.isfinite(value), value, 0.0) for value in (slope, normal_stiffness(contact, overlap)))  # constant beyond rupture
    return Slider(
        stiffness=stiffness,
        dashpot=dashpot,
        limit=limit,
        stiffness_slope=8 * effective_shear_modulus * slope,
        dashpot_slope=dashpot * slope / (2 * radius),
        limit_slope=friction_coefficient * np.sign(net) * normal_slope,
    )


def slip_velocity(velocity_i, velocity_j, spin_i, spin_j, arm_i, arm_j, normal) -> np.ndarray:
    """Tangential velocity v_S = u_i - u_j [m/s] of the surfaces at the contact; arms [m] from the centres, normal from i to j."""
    u = velocity_i - velocity_j + cross(arm_i * spin_i + arm_j * spin_j, normal)
    return u - normal * dot(u, normal)


def resistance(slider: Slider, displacement: np.ndarray, velocity: np.ndarray, slipping: ArrayLike = True) -> np.ndarray:
    """Resisting load f of a slider; the force on i is -f.

    Parameters
    ----------
    slider : stiffness, dashpot and limit.
    displacement, velocity : [m], [m/s] (or [rad], [rad/s]), vectors on the last axis.
    slipping : where the limit applies; elsewhere spring + dashpot as they are.
    """
    trial = _column(slider.stiffness) * displacement + _column(slider.dashpot) * velocity
    length = np.linalg.norm(trial, axis=-1, keepdims=True)
    limit = _column(slider.limit)
    held = trial * np.where(length > 0, limit / np.where(length > 0, length, 1.0), 0.0)
    return np.where(_column(slipping), held, trial)


def returned_displacement(slider: Slider, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Displacement after the reset: unchanged within the limit, else (f - eta v)/k with f at the limit."""
    trial = _column(slider.stiffness) * displacement + _column(slider.dashpot) * velocity
    beyond = np.linalg.norm(trial, axis=-1, keepdims=True) > _column(slider.limit)
    stiffness = np.where(_column(slider.stiffness) > 0, _column(slider.stiffness), 1.0)
    reset = (resistance(slider, displacement, velocity) - _column(slider.dashpot) * velocity) / stiffness
    return np.where(beyond & (_column(slider.stiffness) > 0), reset, displacement)


def slip_rate(slider: Slider, displacement, velocity, acceleration, overlap_rate) -> np.ndarray:
    """Multiplier lambda [m/s] that keeps |f| at the limit, negative where the contact would rather stick again.

    Parameters
    ----------
    slider : stiffness, dashpot, limit and their slopes.
    displacement, velocity, acceleration : the last two in the frame that turns with the contact.
    overlap_rate : [m/s].
    """
    direction = slip_direction(slider, displacement, velocity)
    rate = _column(overlap_rate)
    loading = _column(slider.stiffness_slope) * rate * displacement + _column(slider.stiffness) * velocity
    loading = loading + _column(slider.dashpot_slope) * rate * velocity + _column(slider.dashpot) * acceleration
    excess = np.sum(direction * loading, axis=-1) - slider.limit_slope * overlap_rate
    return excess / np.where(slider.stiffness > 0, slider.stiffness, np.inf)


def slip_direction(slider: Slider, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Unit vector of spring + dashpot; 0 where both vanish."""
    trial = _column(slider.stiffness) * displacement + _column(slider.dashpot) * velocity
    length = np.linalg.norm(trial, axis=-1, keepdims=True)
    return trial / np.where(length > 0, length, 1.0)


def _column(value: ArrayLike) -> np.ndarray:
    return np.asarray(value)[..., np.newaxis]
