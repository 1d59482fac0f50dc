"""Time scales of a contact, one function each, and the time step that resolves a collision.

Covers the Hertz collision time, the small oscillations of a stuck pair (normal, sliding, rolling, twisting) from
Haervig 2017 eqs 7-9, 14 and 21 and Chen 2019 eq. 1, and the Rayleigh time. Assumes solid homogeneous spheres.
"""

from __future__ import annotations

import math

from pyjkr.contact import PairProperties

# 4 sqrt(pi) Gamma(2/5)/(5 Gamma(9/10)) (15/16)^(2/5): Hertz contact time in units of (m^2/(R E^2 v))^(1/5).
HERTZ_COLLISION_TIME = 2.86826570
# d(F)/d(delta) at equilibrium in units of E a_0, from Haervig 2017, eqs 8-10.
STUCK_STIFFNESS = 6 / 5
# A solid sphere's slip under a force at its rim: 1/m + r^2/I = (1 + 5/2)/m.
SLIDING_INERTIA = 7 / 2
# Velocity Verlet is stable up to 2/omega = period/pi.
VERLET_LIMIT = 1 / math.pi


def hertz_collision_time(effective_radius: float, effective_mass: float, effective_modulus: float, speed: float) -> float:
    """Duration of an undamped Hertz impact [s]: 2.868 (m^2/(R E^2 v))^(1/5).

    Parameters
    ----------
    effective_radius, effective_mass, effective_modulus : float
        R [m], m [kg], E [Pa].
    speed : float
        Normal speed of approach [m/s].
    """
    return HERTZ_COLLISION_TIME * (effective_mass**2 / (effective_radius * effective_modulus**2 * speed)) ** 0.2


def stuck_period(pair: PairProperties) -> float:
    """Period of the normal oscillation about equilibrium [s]: 2 pi sqrt(m/(1.2 E a_0)); infinite without adhesion."""
    stiffness = STUCK_STIFFNESS * pair.effective_modulus * pair.equilibrium_contact_radius
    return _period(stiffness / pair.effective_mass)


def sliding_period(pair: PairProperties, contact_radius: float) -> float:
    """Period of the tangential spring with free spheres [s]: omega^2 = 28 G a/m; k_T = 8 G a, Haervig 2017, eq. 14.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m]; the largest one of the motion gives the shortest period.
    """
    return _period(8 * pair.effective_shear_modulus * contact_radius * SLIDING_INERTIA / pair.effective_mass)


def rolling_period(pair: PairProperties, contact_radius: float) -> float:
    """Period of the rolling spring without friction, its fastest mode [s]: omega^2 = k_r R/I_r; Haervig 2017, eq. 21.

    k_r = 4 F_C (a/a_0)^(3/2), with F_C of the surface energy that the rolling moment uses. A sphere that cannot slip
    on its wall rolls sqrt(7/2) times slower.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m]; the largest one of the motion gives the shortest period.
    """
    zero_load = pair.equilibrium_contact_radius
    if zero_load == 0:
        return math.inf
    pull_off = 3 * math.pi * pair.effective_radius * pair.surface_energy_of_rolling
    stiffness = 4 * pull_off * (contact_radius / zero_load) ** 1.5
    return _period(stiffness * pair.effective_radius / pair.effective_inertia)


def twisting_period(pair: PairProperties, contact_radius: float) -> float:
    """Period of the torsional spring [s]: omega^2 = k_T a^2/(2 I_r) = 4 G a^3/I_r; Chen 2019, eq. 1c.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m]; the largest one of the motion gives the shortest period.
    """
    return _period(4 * pair.effective_shear_modulus * contact_radius**3 / pair.effective_inertia)


def rayleigh_time(radius: float, density: float, youngs_modulus: float, poissons_ratio: float) -> float:
    """Travel time of a surface wave across a sphere [s]: pi r sqrt(rho/G)/(0.1631 nu + 0.8766).

    The criterion of LIGGGHTS' `fix check/timestep/gran`; here for comparison only.

    Parameters
    ----------
    radius, density, youngs_modulus, poissons_ratio : float
        r [m], rho [kg/m3], E_i [Pa] and nu_i of one particle.
    """
    shear_modulus = youngs_modulus / (2 * (1 + poissons_ratio))
    return math.pi * radius * math.sqrt(density / shear_modulus) / (0.1631 * poissons_ratio + 0.8766)


def collision_time(pair: PairProperties, speed: float) -> float:
    """The shorter of Hertz collision and stuck period [s]: both go as q^(-2/5) under Haervig 2017, eq. 24."""
    hertz = hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, speed)
    return min(hertz, stuck_period(pair))


def time_step(pair: PairProperties, speed: float, steps_per_collision: int) -> float:
    """Time step [s] that gives `steps_per_collision` steps to `collision_time`."""
    return collision_time(pair, speed) / steps_per_collision


def _period(square_of_frequency: float) -> float:
    return 2 * math.pi / math.sqrt(square_of_frequency) if square_of_frequency > 0 else math.inf
