"""Time scales of a contact, one function each, and the time step that resolves a collision.

Covers the Hertz collision time, the small oscillations of a pair in contact (normal, sliding, rolling, twisting) from
Haervig 2017 eqs 7-9, 14 and 21 and Chen 2019 eq. 1, their damping, the time step up to which velocity Verlet follows
them, and the Rayleigh time. Assumes solid homogeneous spheres.
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
# eta = 2 sqrt(5/6) |beta| sqrt(k m); Haervig 2017, eqs 11 (its misprint mended) and 16.
DAMPING_FACTOR = 2 * math.sqrt(5 / 6)


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


def normal_period(pair: PairProperties, contact_radius: float) -> float:
    """Period of the normal oscillation about any contact radius [s]; Haervig 2017, eqs 8-10.

    d(F)/d(delta) = 2 E a (s^(3/2) - 1/2)/(s^(3/2) - 1/6) with s = a/a_0: 1.2 E a_0 at equilibrium, 2 E a for Hertz.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m], a_0 or more; the largest one of the motion gives the shortest period.
    """
    zero_load = pair.equilibrium_contact_radius
    power = (contact_radius / zero_load) ** 1.5 if zero_load > 0 else math.inf
    share = (power - 1 / 2) / (power - 1 / 6) if math.isfinite(power) else 1.0
    return _period(2 * pair.effective_modulus * contact_radius * share / pair.effective_mass)


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


def rolling_period(pair: PairProperties, contact_radius: float, spin_share: float = 1.0) -> float:
    """Period of the rolling spring without friction, its fastest mode [s]: omega^2 = c k_r R/I_r; Haervig 2017, eq. 21.

    k_r = 4 F_C (a/a_0)^(3/2), with F_C of the surface energy that the rolling moment uses. c is `spin_share`. A sphere
    that cannot slip on its wall rolls sqrt(7/4) times slower.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m]; the largest one of the motion gives the shortest period.
    spin_share : float
        Rolling velocity over R times the difference of the spins, see `spin_share`.
    """
    zero_load = pair.equilibrium_contact_radius
    if zero_load == 0:
        return math.inf
    pull_off = 3 * math.pi * pair.effective_radius * pair.surface_energy_of_rolling
    stiffness = 4 * pull_off * (contact_radius / zero_load) ** 1.5
    return _period(spin_share * stiffness * pair.effective_radius / pair.effective_inertia)


def spin_share(radii: tuple[float, ...], masses: tuple[float, ...]) -> float:
    """Rolling velocity over R abs(omega_i - omega_j) of spheres whose rolling moments spin them on the spot.

    Haervig 2017, eq. 20: v_L = -R (omega_i - omega_j) x n + (1/2) (r_j - r_i)/(r_j + r_i) v_S. Spins of like spheres do not
    slip, 1; the spin of one sphere at a wall slips by r omega, and half of that takes half of the rolling away, 1/2.

    Parameters
    ----------
    radii, masses : tuple of float
        Of one sphere at a wall, or of two spheres [m], [kg].
    """
    if len(radii) == 1:
        return 0.5
    # omega_i I_i = -omega_j I_j: the moments are equal and opposite.
    spins = [1 / (mass * radius**2) for mass, radius in zip(masses, radii, strict=True)]
    slip = (radii[0] * spins[0] - radii[1] * spins[1]) / sum(spins)
    effective_radius = radii[0] * radii[1] / sum(radii)
    return 1 - (radii[1] - radii[0]) / sum(radii) * slip / (2 * effective_radius)


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


def normal_damping_ratio(pair: PairProperties, contact_radius: float, period: float) -> float:
    """Damping ratio of the normal mode: eta_N/(2 m omega), eta_N = 2 sqrt(5/6) |beta| sqrt(2 E a m); Haervig 2017, eq. 11.

    Parameters
    ----------
    pair, contact_radius, period
        As for `tangential_damping_ratio`, with `normal_period`.
    """
    stiffness = 2 * pair.effective_modulus * contact_radius
    return _damping_factor(pair) * math.sqrt(stiffness / pair.effective_mass) * period / (4 * math.pi)


def tangential_damping_ratio(pair: PairProperties, contact_radius: float, period: float) -> float:
    """Damping ratio of the sliding or twisting mode: eta_T omega/(2 k_T), since spring and dashpot share their lever.

    Parameters
    ----------
    pair : PairProperties
        The pair.
    contact_radius : float
        a [m] at which the mode has its period.
    period : float
        `sliding_period` or `twisting_period` there [s].
    """
    stiffness = 8 * pair.effective_shear_modulus * contact_radius
    return _damping_factor(pair) * math.sqrt(pair.effective_mass / stiffness) * math.pi / period


def verlet_limit(period: float, damping_ratio: float = 0.0) -> float:
    """Longest time step [s] with which velocity Verlet follows an oscillation: dt omega = 2 (sqrt(1 + zeta^2) - zeta).

    LIGGGHTS damps with the velocity of half a step ago: x+ - 2 x + x- + 2 zeta h (x - x-) + h^2 x = 0, h = dt omega,
    loses its stability at the root -1, where h^2 + 4 zeta h = 4. Without damping that is h = 2, period/pi.

    Parameters
    ----------
    period : float
        Without damping [s].
    damping_ratio : float
        zeta: damping over critical damping, as far as it acts with the velocity of half a step ago.
    """
    return (math.sqrt(1 + damping_ratio**2) - damping_ratio) * period / math.pi


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


def _damping_factor(pair: PairProperties) -> float:
    """eta/sqrt(k m) = 2 sqrt(5/6) |beta|, beta = ln e/sqrt(ln^2 e + pi^2); Haervig 2017, eq. 12."""
    log_e = math.log(pair.restitution_coefficient)
    return DAMPING_FACTOR * abs(log_e) / math.hypot(log_e, math.pi)


def _period(square_of_frequency: float) -> float:
    return 2 * math.pi / math.sqrt(square_of_frequency) if square_of_frequency > 0 else math.inf
