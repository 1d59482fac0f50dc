"""What measurements cannot tell, or contradict: one line each, with what to add or to look at.

Covers the limits of the inversion of Chen, Liu, Li 2019, section 3. gamma and E enter a rebound as gamma E^(-2/5) alone
(eq. 9), so that one of them always has to come from elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from pyjkr.calibrate.table import HIGHEST_RESTITUTION, LOWEST_RESTITUTION

if TYPE_CHECKING:
    from pyjkr.calibrate.inversion import Calibration

# Width of the interval of e from which the damping counts as poorly known, and ratio of the ends of that of the group.
WIDE_RESTITUTION, WIDE_GROUP = 0.1, 3.0
# Above so many sticking speeds points that fall short of the curve ever more, the faster they are, count; how many, how sure.
PLATEAU, FEWEST_OF_TREND, SIGNIFICANT = 2.0, 4, 1e-3
# gamma E^(-2/5) of solids: from 1 mJ/m2 and 1 TPa to 5 J/m2 and 1 MPa [J m^-2 Pa^-0.4].
PLAUSIBLE_GROUP = (1.6e-8, 2e-2)
# Surface energies [J/m2] of one surface: below that of any solid, above that of clean metals.
PLAUSIBLE_ENERGY = (1e-4, 10.0)
# Largest sphere [m] whose rebound adhesion could change, and fastest elastic impact [m/s]: generously.
LARGEST_RADIUS, FASTEST = 1e-3, 1e3
# With fewer degrees of freedom the scatter itself is hardly known.
FEWEST_DEGREES = 3
# Misses two points by more than round-off [-].
MISSED = 1e-6


def of(found: Calibration) -> tuple[str, ...]:
    """All caveats of a calibration."""
    return tuple([*_units(found), *_damping(found), *_adhesion(found), *_scatter(found), *_order(found)])


def _units(found: Calibration) -> Iterator[str]:
    particle, fastest = found.particle, found.measurements.speed[-1]
    if particle.radius > LARGEST_RADIUS:
        yield f"radius = {particle.radius:g} m is that of no microsphere. Is it given in m?"
    if fastest > FASTEST:
        yield f"the fastest point is at {fastest:g} m/s, where nothing stays elastic. Is the speed given in m/s?"
    named = [("gamma", found.surface_energy, "J/m2", PLAUSIBLE_ENERGY)] if found.surface_energy else []
    for name, estimate, unit, (low, high) in [*named, ("gamma E^(-2/5)", found.group, "J m^-2 Pa^-0.4", PLAUSIBLE_GROUP)]:
        if not low <= estimate.value <= high and not (estimate.lower == 0 and estimate.value < low):
            yield (
                f"{name} = {estimate.value:.3g} {unit} is that of no solid ({low:g} to {high:g}). Look at the units of speed"
                " (m/s), radius (m), density (kg/m3) and modulus (Pa)."
            )
            return


def _damping(found: Calibration) -> Iterator[str]:
    e = found.restitution_coefficient
    if not LOWEST_RESTITUTION * 1.001 < e.value < HIGHEST_RESTITUTION * 0.9999:
        yield (
            f"the best restitution coefficient without adhesion is at the end of the table, {e.value:g}: the curve wants"
            f" {'less' if e.value > 0.5 else 'more'} damping than the model can have."
        )
    if e.lower is not None and e.upper - e.lower > WIDE_RESTITUTION:
        yield (
            f"the damping is poorly known: e without adhesion may be anything from {e.lower:.3g} to {e.upper:.3g}."
            " Add faster impacts, on the plateau."
        )


def _adhesion(found: Calibration) -> Iterator[str]:
    group, slowest = found.group, found.measurements.speed[0]
    if found.region is None:
        yield (
            "two points fix two numbers and leave nothing to judge the scatter by: no uncertainty. Give standard deviations, or"
            " more points."
        )
        if found.chi_square > MISSED**2:
            yield (
                "no curve of this law goes through both points: the one drawn is the closest."
                " Pick one point on the plateau and one at clearly lower restitution."
            )
    elif group.lower == 0:
        few = found.degrees_of_freedom < FEWEST_DEGREES
        why = "the points are too few" if few else "no point is near enough to sticking"
        remedy = "impacts" if few else f"impacts slower than {slowest:g} m/s"
        yield (
            f"the adhesion is only bounded above, gamma E^(-2/5) <= {group.upper:.3g} J m^-2 Pa^-0.4: {why}."
            f" Add {remedy}, or state standard deviations."
        )
    elif group.upper > WIDE_GROUP * group.lower:
        yield (
            f"the adhesion is poorly known: gamma E^(-2/5) may be anything from {group.lower:.3g} to {group.upper:.3g}"
            " J m^-2 Pa^-0.4. Add points between sticking and the plateau."
        )


def _scatter(found: Calibration) -> Iterator[str]:
    given = found.measurements.standard_deviation
    if given is not None and found.degrees_of_freedom > 0 and found.widened:
        times = (found.chi_square / found.degrees_of_freedom) ** 0.5
        yield (
            f"the points lie {times:.2g} times farther from the curve than their standard deviations say; intervals are widened"
            " to match. The model leaves out plastic loss, roughness and spread of sizes."
        )


def _order(found: Calibration) -> Iterator[str]:
    points = found.measurements
    stuck = points.speed[~points.rebounds]
    if len(stuck) and stuck.max() > points.speed[points.rebounds].min():
        yield (
            f"a sphere stuck at {stuck.max():g} m/s, others rebounded from {points.speed[points.rebounds].min():g} m/s on: the"
            " threshold is blurred, and the model has a sharp one."
        )
    fast = points.rebounds & (points.speed > PLATEAU * found.sticking_speed.value)
    if fast.sum() < FEWEST_OF_TREND or len(np.unique(points.speed[fast])) < 2:
        return
    residual = points.restitution - found.curve(points.speed)[0]
    trend = stats.linregress(np.log(points.speed[fast]), residual[fast], alternative="less")
    if trend.pvalue < SIGNIFICANT:
        yield (
            f"above {points.speed[fast][0]:.3g} m/s the restitution falls behind the curve with growing speed: likely plastic loss,"
            " which the model does not have. Leave the fastest points out."
        )
