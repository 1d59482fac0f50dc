# Law: adhesive rolling resistance, an elastic-plastic spring (`rolling_friction krijt`), with an optional dashpot.
# Covers: Haervig et al. 2017 section 2.2, eqs 18-22 (eq. 20 with its denominator and sign mended), section 3.2; Chen
#   et al. 2019 eqs 1d, 3c, 11.
# Assumes: only the spring is truncated, the dashpot adds to it; history rotated with the contact by the caller;
#   normal from i to j.
"""Rolling of a contact. Moment on i: n x (k_r xi + eta_R v_L), and the opposite on j.

Sign: with v_L = -R (w_i - w_j) x n the power of both moments is k_r (w_i - w_j) . (n x xi) = -(k_r/R) xi . v_L:
stored, then dissipated.
"""

import numpy as np
from numpy.typing import ArrayLike

from .vectors import cross


def rolling_velocity(radius_i, radius_j, spin_i, spin_j, normal, slip_velocity) -> np.ndarray:
    """Rolling velocity v_L [m/s]: of the contact point past the mean of both surfaces.

    -R (w_i - w_j) x n + (1/2) (r_j - r_i)/(r_j + r_i) v_S, Haervig 2017 eq. 20 mended; an infinite radius_j is a
    wall: -r w_i x n + v_S/2.

    Parameters
    ----------
    radius_i, radius_j : [m], one per contact.
    spin_i, spin_j : [rad/s], vectors on the last axis; 0 for a wall that does not turn.
    normal : unit vector from i to j.
    slip_velocity : [m/s], v_S = u_i - u_j.
    """
    ratio = np.asarray(radius_i) / np.asarray(radius_j)
    effective_radius = np.asarray(radius_i) / (1 + ratio)
    asymmetry = (1 - ratio) / (1 + ratio)
    return -effective_radius[..., None] * cross(spin_i - spin_j, normal) + 0.5 * asymmetry[..., None] * slip_velocity


def rolling_stiffness(pull_off_force: ArrayLike, contact_radius_ratio: ArrayLike) -> ArrayLike:
    """Stiffness k_r = 4 F_C (a/a_0)^(3/2) [N = N m per m of displacement], Haervig 2017 eq. 21 and section 3.2.

    Parameters
    ----------
    pull_off_force : [N], of the ORIGINAL surface energy.
    contact_radius_ratio : [-], a/a_0 of the normal law as computed (a_mod/a_0,mod).
    """
    return 4 * np.asarray(pull_off_force) * np.asarray(contact_radius_ratio) ** 1.5


def critical_displacement_krijt(equilibrium_contact_radius: ArrayLike, adhesion_hysteresis: ArrayLike) -> ArrayLike:
    """xi_crit = (a_0/12) dgamma/gamma [m], Haervig 2017 eq. 18; a_0 [m] of the ORIGINAL surface energy and modulus."""
    return np.asarray(equilibrium_contact_radius) * adhesion_hysteresis / 12


def critical_displacement_angle(effective_radius: ArrayLike, critical_rolling_angle: ArrayLike) -> ArrayLike:
    """xi_crit = theta_crit R [m], Chen 2019 eqs 3c, 11."""
    return np.asarray(effective_radius) * critical_rolling_angle


def rolling_damping(
    damping_fraction: ArrayLike, stiffness: ArrayLike, reduced_inertia: ArrayLike, effective_radius: ArrayLike
) -> ArrayLike:
    """Dashpot eta_R = 2 x sqrt(k_r I_r/R) [kg m/s = N m per m/s]; 1/I_r = 1/I_i + 1/I_j [1/(kg m2)], x the fraction
    of critical."""
    return 2 * damping_fraction * np.sqrt(stiffness * reduced_inertia / effective_radius)


def truncated_displacement(displacement: np.ndarray, critical_displacement: ArrayLike) -> np.ndarray:
    """Rolling displacement [m] cut back to the length of the critical one, Haervig 2017 eq. 22."""
    length = np.linalg.norm(displacement, axis=-1, keepdims=True)
    critical = np.asarray(critical_displacement)[..., None]
    return displacement * np.where(length > critical, critical / np.where(length > 0, length, 1.0), 1.0)


def rolling_moment(stiffness, dashpot, displacement, velocity, normal) -> np.ndarray:
    """Moment on i [N m], n x (k_r xi + eta_R v_L); on j its opposite. Haervig 2017 eq. 21 with the opposing sign."""
    return cross(normal, np.asarray(stiffness)[..., None] * displacement + np.asarray(dashpot)[..., None] * velocity)
