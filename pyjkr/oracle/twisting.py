# Law: twisting resistance about the contact normal, spring and dashpot with a limit (`krijt` with `twisting on`).
# Covers: Chen et al. 2019 eqs 1c, 3b (Marshall 2009 eqs 32-33): stiffness k_T a^2/2, dashpot eta_T a^2/2, limit
#   (2/3) a F_S,crit.
# Assumes: the slider of tangential.py, in the angle about the normal; a is the JKR contact radius in both models.
"""Twisting of a contact. Moment on i: -f n, and the opposite on j; f = stiffness angle + dashpot rate, yielding and
capped as sliding is."""

import numpy as np
from numpy.typing import ArrayLike

from .normal import NormalContact, contact_radius, contact_radius_slope
from .tangential import Slider
from .vectors import dot


def twisting(
    contact: NormalContact, sliding: Slider, overlap: ArrayLike, original_radius_ratio: ArrayLike = 1.0
) -> Slider:
    """Spring, dashpot and limit of twisting [N m/rad, N m s/rad, N m] at one overlap.

    Parameters
    ----------
    contact : the normal contact; without surface energy there is no twisting moment.
    sliding : the sliding slider of the same contact at the same overlap: k_T, eta_T, F_S,crit.
    overlap : [m], positive in compression.
    original_radius_ratio : [-], a_0/a_0,mod; scales the a of the limit where stiffness is reduced.
    """
    adhesive = np.asarray(contact.surface_energy) > 0
    a = contact_radius(contact, overlap)
    slope = contact_radius_slope(contact, overlap)
    slope = np.where(np.isfinite(slope), slope, 0.0)  # a is held constant beyond the rupture
    polar, polar_slope = adhesive * a**2 / 2, adhesive * a * slope
    arm, arm_slope = adhesive * 2 / 3 * original_radius_ratio * a, adhesive * 2 / 3 * original_radius_ratio * slope
    return Slider(
        stiffness=sliding.stiffness * polar,
        dashpot=sliding.dashpot * polar,
        limit=sliding.limit * arm,
        stiffness_slope=sliding.stiffness_slope * polar + sliding.stiffness * polar_slope,
        limit_slope=sliding.limit_slope * arm + sliding.limit * arm_slope,
    )


def twisting_rate(spin_i: np.ndarray, spin_j: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Relative spin about the normal (w_i - w_j) . n [rad/s], as a vector of one component on the last axis."""
    return dot(spin_i - spin_j, normal)
