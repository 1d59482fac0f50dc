"""Reduced stiffness: what becomes of a contact when E is lowered to E_mod.

Covers Haervig 2017, eq. 1 (Tabor number), eq. 24 (surface energy) and what follows from eq. 24 for lengths, times and
forces. Assumes adhesive impacts in the JKR range, without outer forces; q = E_mod/E throughout.
"""

from __future__ import annotations

# Least distance of two surfaces [m]; Haervig 2017, below eq. 1.
MINIMUM_SEPARATION = 1.65e-10
# JKR holds above, DMT below the second; Haervig 2017, below eq. 1 (Johnson and Greenwood).
TABOR_OF_JKR = 3.0
TABOR_OF_DMT = 0.1


def surface_energy_mod(surface_energy: float, modulus_ratio: float) -> float:
    """Surface energy that keeps sticking and rebound when the stiffness is reduced; Haervig 2017, eq. 24.

    Parameters
    ----------
    surface_energy : float
        gamma of the real material [J/m2].
    modulus_ratio : float
        q = E_mod/E.

    Returns
    -------
    float
        gamma_mod = gamma q^(2/5) [J/m2].
    """
    return surface_energy * modulus_ratio**0.4


def length_factor(modulus_ratio: float) -> float:
    """Factor on overlaps and slips: F_C and a_0^2/R of eqs 7 and 24 give q^(-2/5)."""
    return modulus_ratio**-0.4


def time_factor(modulus_ratio: float) -> float:
    """Factor on collision times and on the time step: q^(-2/5); Haervig 2017, sec. 6.2."""
    return modulus_ratio**-0.4


def force_factor(modulus_ratio: float) -> float:
    """Factor on forces, the pull-off force among them: q^(2/5), as gamma in F_C = 3 pi R gamma."""
    return modulus_ratio**0.4


def smallest_modulus_ratio(least_force_factor: float) -> float:
    """Lowest q at which forces keep at least a given share of their real value: `force_factor` inverted, share^(5/2).

    Above 1 no reduced stiffness, and not the real one either, is enough.
    """
    return least_force_factor**2.5


def contact_radius_factor(modulus_ratio: float) -> float:
    """Factor on contact radii: a_0 ~ (gamma/E)^(1/3) with eq. 24 gives q^(-1/5)."""
    return modulus_ratio**-0.2


def tabor_factor(modulus_ratio: float) -> float:
    """Factor on the Tabor number: (gamma/E)^(2/3) with eq. 24 gives q^(-2/5)."""
    return modulus_ratio**-0.4


def tabor_number(effective_radius: float, effective_modulus: float, surface_energy: float) -> float:
    """Tabor number lambda_T; Haervig 2017, eq. 1.

    Parameters
    ----------
    effective_radius : float
        R [m].
    effective_modulus : float
        E [Pa].
    surface_energy : float
        gamma [J/m2], of one surface.
    """
    return (4 * effective_radius * surface_energy**2 / (effective_modulus**2 * MINIMUM_SEPARATION**3)) ** (1 / 3)


def tabor_warning(effective_radius: float, effective_modulus: float, surface_energy: float) -> str | None:
    """A warning where JKR does not describe the real contact, else None.

    Takes the ORIGINAL modulus and surface energy: softening raises the Tabor number and would hide a DMT contact.
    """
    if surface_energy == 0:
        return None
    number = tabor_number(effective_radius, effective_modulus, surface_energy)
    if number >= TABOR_OF_JKR:
        return None
    regime = "the DMT range" if number < TABOR_OF_DMT else "between JKR and DMT"
    return (
        f"Tabor number {number:.3g} of the original material is below {TABOR_OF_JKR:g}: {regime}, where JKR overrates"
        " the contact radius (Haervig 2017, eq. 1). Take a larger or softer sphere, or another law."
    )
