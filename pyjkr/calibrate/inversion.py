"""Measured restitution over speed -> damping and gamma E^(-2/5), each with its uncertainty: `fit`.

Covers Chen, Liu, Li 2019, section 3: the damping from the plateau, the group of eq. 9 from points nearer to sticking, and
the surface energy for a chosen modulus, eq. 10. Assumes that the particle loses energy by damping and adhesion alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy import stats

from pyjkr.calibrate import caveats
from pyjkr.calibrate.collision import Law, collision
from pyjkr.calibrate.measurements import Measurements, read
from pyjkr.calibrate.particle import CalibrationError, Particle, surface_energy_of
from pyjkr.calibrate.region import Region, SumOfSquares, joint_region, minimum
from pyjkr.calibrate.table import HIGHEST_RESTITUTION, LOWEST_RESTITUTION
from pyjkr.oracle import damping_ratio

# Stated standard deviations are doubted, and widened, where scatter so large has less than this probability.
IMPLAUSIBLE = 0.01


@dataclass(frozen=True)
class Estimate:
    """A number and its interval.

    Parameters
    ----------
    value : float
        Of the best curve.
    lower, upper : float or None
        Extent of the joint confidence region; 0 where the data set no lower bound, None where nothing can be said.
    """

    value: float
    lower: float | None = None
    upper: float | None = None


@dataclass(frozen=True)
class Calibration:
    """What a rebound experiment tells.

    Parameters
    ----------
    law : str
        "jkr" or "jkr/simplified".
    particle, measurements
        What was given.
    confidence : float
        With this probability all intervals hold together.
    restitution_coefficient : Estimate
        e without adhesion [-]; Haervig 2017, eq. 12.
    damping_ratio : Estimate
        abs(beta) [-] of the same equation.
    alpha : Estimate
        sqrt(5) abs(beta) [-], damping of the full law: eta_N = alpha sqrt(m (4/3) E a); Chen 2019, eq. 1a.
    sticking_speed : Estimate
        v_s [m/s].
    group : Estimate
        gamma E^(-2/5) [J m^-2 Pa^-0.4], all that rebounds know of gamma and E.
    surface_energy, surface_energy_mod : Estimate or None
        gamma [J/m2] for the E and for the E_mod of the particle, where it names them.
    chi_square : float
        Sum of squared residuals, over the given variances where there are any.
    degrees_of_freedom : int
        Rebounding points less the two unknowns.
    scatter : float or None
        Standard deviation of one restitution as the residuals show it [-].
    widened : bool
        Whether the residuals belied the stated standard deviations and widened the intervals.
    region : Region or None
        Joint confidence region.
    warnings : tuple of str
        What the data cannot tell, or contradict.
    """

    law: Law
    particle: Particle
    measurements: Measurements
    confidence: float
    restitution_coefficient: Estimate
    damping_ratio: Estimate
    alpha: Estimate
    sticking_speed: Estimate
    group: Estimate
    surface_energy: Estimate | None
    surface_energy_mod: Estimate | None
    chi_square: float
    degrees_of_freedom: int
    scatter: float | None
    widened: bool
    region: Region | None
    warnings: tuple[str, ...] = ()

    def curve(self, speed: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None]:
        """e_eff [-] over speed [m/s]: the best curve, and the lower and upper edge of its band.

        The band holds every curve of the joint region, so it covers the true curve at all speeds together.
        """
        model, speed = collision(self.law), np.asarray(speed, dtype=float)
        best = model.restitution(speed / self.sticking_speed.value, self.restitution_coefficient.value)
        if self.region is None:
            return best, None, None
        sticking = np.exp(self.region.ln_sticking_speed)
        curves = model.restitution(speed[:, None] / sticking, self.region.restitution_coefficient)
        return best, curves.min(axis=1), curves.max(axis=1)


def fit(measurements: Measurements | str | Path, particle: Particle, law: Law = "jkr", *, confidence: float = 0.99) -> Calibration:
    """Find the damping and the adhesion that reproduce measured rebounds.

    Parameters
    ----------
    measurements : Measurements or path
        Two rebounding points or more; two are met exactly, more by least squares.
    particle : Particle
        Size and mass, and the moduli to name surface energies for.
    law : str
        "jkr" or "jkr/simplified".
    confidence : float
        Probability with which all intervals and the band hold together.

    Raises
    ------
    CalibrationError
        Where the measurements determine nothing.
    """
    if not isinstance(measurements, Measurements):
        measurements = read(measurements)
    if law not in ("jkr", "jkr/simplified"):
        raise CalibrationError(f"law = {law!r} must be 'jkr' or 'jkr/simplified'.")
    if not 0 < confidence < 1:
        raise CalibrationError(f"confidence = {confidence!r} must lie between 0 and 1; 0.95 for example.")
    model = collision(law)
    squares = SumOfSquares(measurements, model)
    best, least = minimum(squares)
    freedom = int(measurements.rebounds.sum()) - 2
    scale = _scatter(measurements, least, freedom)
    region = _region(squares, best, least, freedom, scale, measurements, confidence)

    def estimate(quantity: Callable, falls_to_zero: bool = False) -> Estimate:
        return _estimate(quantity, best, region, falls_to_zero)

    restitution = _to_the_ends(estimate(lambda e, _: e))
    group = estimate(lambda e, ln_speed: particle.group(np.exp(ln_speed) / model.sticking_ratio(e)), True)
    found = Calibration(
        law=law,
        particle=particle,
        measurements=measurements,
        confidence=confidence,
        restitution_coefficient=restitution,
        damping_ratio=_damping(restitution),
        alpha=_damping(restitution, math.sqrt(5)),
        sticking_speed=estimate(lambda _, ln_speed: np.exp(ln_speed), True),
        group=group,
        surface_energy=_energy(group, particle.effective_modulus),
        surface_energy_mod=_energy(group, particle.effective_modulus_mod),
        chi_square=least,
        degrees_of_freedom=freedom,
        scatter=scale if measurements.standard_deviation is None else None,
        widened=measurements.standard_deviation is not None and scale != 1.0,
        region=region,
    )
    return replace(found, warnings=caveats.of(found))


def _scatter(measurements: Measurements, least: float, freedom: int) -> float | None:
    """Factor on the weights' unit: residual standard deviation, or 1 for stated ones that the residuals bear out."""
    if measurements.standard_deviation is None:
        return math.sqrt(least / freedom) if freedom > 0 else None
    if freedom > 0 and stats.chi2.sf(least, freedom) < IMPLAUSIBLE:
        return math.sqrt(least / freedom)
    return 1.0


def _region(
    squares: SumOfSquares, best: np.ndarray, least: float, freedom: int, scale: float | None, measurements: Measurements, confidence: float
) -> Region | None:
    if scale is None:
        return None
    known = measurements.standard_deviation is not None and scale == 1.0
    quantile = stats.chi2.ppf(confidence, 2) if known else 2 * stats.f.ppf(confidence, 2, freedom)
    # points on the curve to round-off leave a region, too small to show, and not none at all
    return joint_region(squares, best, least + quantile * max(scale, 1e-9) ** 2)


def _estimate(quantity: Callable, best: np.ndarray, region: Region | None, falls_to_zero: bool) -> Estimate:
    """A quantity of (e, ln v_s) and its extent over the region; 0 is its end where v_s has no lower bound and it falls with v_s."""
    value = float(quantity(*best))
    if region is None:
        return Estimate(value)
    over = quantity(region.restitution_coefficient, region.ln_sticking_speed)
    return Estimate(value, 0.0 if falls_to_zero and region.open_below else float(over.min()), float(over.max()))


def _to_the_ends(estimate: Estimate) -> Estimate:
    """Where the interval of e reaches the end of the table it reaches the end of what is possible."""
    if estimate.lower is None:
        return estimate
    lower = 0.0 if estimate.lower <= LOWEST_RESTITUTION + 1e-9 else estimate.lower
    return Estimate(estimate.value, lower, 1.0 if estimate.upper >= HIGHEST_RESTITUTION - 1e-9 else estimate.upper)


def _damping(restitution: Estimate, factor: float = 1.0) -> Estimate:
    """abs(beta), times a factor, of e: it falls from 1 at e = 0 to 0 at e = 1."""
    value = factor * float(damping_ratio(restitution.value))
    if restitution.lower is None:
        return Estimate(value)
    upper = 1.0 if restitution.lower == 0 else float(damping_ratio(restitution.lower))
    return Estimate(value, factor * abs(float(damping_ratio(restitution.upper))), factor * upper)


def _energy(group: Estimate, modulus: float | None) -> Estimate | None:
    if modulus is None:
        return None
    return Estimate(*(None if value is None else surface_energy_of(value, modulus) for value in (group.value, group.lower, group.upper)))
