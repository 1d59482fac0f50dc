"""Sum of squares over (e, ln v_s), its minimum, and the joint confidence region around it.

Covers the inversion of Chen, Liu, Li 2019, section 3, by least squares on the model itself in place of their fits
(13)-(14). Assumes independent normal errors; no linearisation: the region is where the sum of squares stays below its limit
(Bates and Watts 1988, section 6.1), because e_eff has no slope at the sticking threshold to linearise with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from pyjkr.calibrate.collision import Collision
from pyjkr.calibrate.measurements import Measurements
from pyjkr.calibrate.table import HIGHEST_RESTITUTION, LOWEST_RESTITUTION

# The search for v_s goes this far below the slowest point, in ln: there e_eff follows Hertz within the table's own decay.
DEEPEST = 7.0
# Nodes of the grids over e and ln v_s: of the whole domain, and of the region once it is framed.
COARSE, FINE = (61, 241), (121, 121)
STARTS = 3
FRAMINGS = 24
# A frame that shrinks less than this is close enough; one that cuts the region grows by this part on that side.
SETTLED, GROWTH = 0.8, 0.3


@dataclass(frozen=True)
class Region:
    """Nodes of a grid inside the joint confidence region.

    Parameters
    ----------
    restitution_coefficient, ln_sticking_speed : ndarray
        e [-] and ln(v_s / (1 m/s)) of the nodes on the rim, each moved outwards by one cell in all four ways.
    open_below : bool
        Whether it reaches the lowest v_s that was looked at.
    """

    restitution_coefficient: np.ndarray
    ln_sticking_speed: np.ndarray
    open_below: bool


class SumOfSquares:
    """The weighted sum of squared residuals of some measurements.

    Parameters
    ----------
    measurements : Measurements
        What to compare with. A sphere that stuck is a point at 0 and adds nothing where the model sticks as well.
    collision : Collision
        The model.
    """

    def __init__(self, measurements: Measurements, collision: Collision) -> None:
        self._collision = collision
        self._measured, self._ln_speed = measurements.restitution, np.log(measurements.speed)
        given = measurements.standard_deviation
        self._weight = 1.0 if given is None else 1.0 / given
        self.lower = np.array([LOWEST_RESTITUTION, self._ln_speed[0] - DEEPEST])
        self.upper = np.array([HIGHEST_RESTITUTION, self._ln_speed[measurements.rebounds].max()])

    def residuals(self, parameters: np.ndarray) -> np.ndarray:
        """Weighted differences model - measured at one (e, ln v_s)."""
        model = self._collision.restitution(np.exp(self._ln_speed - parameters[1]), parameters[0])
        return (model - self._measured) * self._weight

    def grid(self, restitution_coefficient: np.ndarray, ln_sticking_speed: np.ndarray) -> np.ndarray:
        """Sum of squares at every e (rows) and ln v_s (columns)."""
        total = np.zeros((len(ln_sticking_speed), len(restitution_coefficient)))
        weights = np.broadcast_to(self._weight, self._measured.shape)
        for place, measured, weight in zip(self._ln_speed, self._measured, weights, strict=True):
            model = self._collision.grid(np.exp(place - ln_sticking_speed), restitution_coefficient)
            total += ((model - measured) * weight) ** 2
        return total.T

    def axes(self, lower: np.ndarray, upper: np.ndarray, nodes: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
        """Nodes over e and ln v_s between two corners."""
        return np.linspace(lower[0], upper[0], nodes[0]), np.linspace(lower[1], upper[1], nodes[1])


def minimum(squares: SumOfSquares) -> tuple[np.ndarray, float]:
    """(e, ln v_s) of the least sum of squares, and that sum; the grid finds the valley, least squares its floor."""
    e, ln_speed = squares.axes(squares.lower, squares.upper, COARSE)
    values = squares.grid(e, ln_speed)
    best, least = None, np.inf
    for flat in np.argsort(values, axis=None)[:STARTS]:
        row, column = np.unravel_index(flat, values.shape)
        start = np.clip([e[row], ln_speed[column]], squares.lower + 1e-9, squares.upper - 1e-9)
        found = least_squares(
            squares.residuals, start, bounds=(squares.lower, squares.upper), x_scale=(0.1, 0.1), xtol=1e-14, ftol=1e-14, gtol=1e-14
        )
        for point, value in ((found.x, 2 * found.cost), (start, float(values.flat[flat]))):
            if value < least:
                best, least = point, value
    return best, least


def joint_region(squares: SumOfSquares, best: np.ndarray, limit: float) -> Region:
    """Where the sum of squares is at most `limit`: framed by ever closer grids, whatever its shape."""
    lower, upper, nodes = squares.lower, squares.upper, COARSE
    for _ in range(FRAMINGS):
        e, ln_speed = squares.axes(lower, upper, nodes)
        inside = squares.grid(e, ln_speed) <= limit
        cell = np.array([e[1] - e[0], ln_speed[1] - ln_speed[0]])
        rows, columns = np.nonzero(inside)
        # a region that fits between the nodes is around its minimum
        places = np.vstack([best, np.column_stack([e[rows], ln_speed[columns]])])
        low, high = places.min(axis=0), places.max(axis=0)
        # thin ends of the region slip through a coarse grid: where it reaches the frame, the frame has to grow
        cut = (low < lower + 0.5 * cell) & (lower > squares.lower), (high > upper - 0.5 * cell) & (upper < squares.upper)
        framed = not np.any(cut)
        low = np.where(cut[0], lower - GROWTH * (upper - lower), low - cell)
        high = np.where(cut[1], upper + GROWTH * (upper - lower), high + cell)
        low, high = np.maximum(low, squares.lower), np.minimum(high, squares.upper)
        if framed and nodes == FINE and inside.any() and np.all(high - low > SETTLED * (upper - lower)):
            break
        lower, upper, nodes = low, high, FINE
    padded = np.pad(inside, 1)
    rim = inside & ~(padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:])
    rows, columns = np.nonzero(rim)
    shift = np.array([(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)]) * cell
    around = np.clip(np.column_stack([e[rows], ln_speed[columns]])[:, None, :] + shift, squares.lower, squares.upper).reshape(-1, 2)
    around = np.vstack([around, best])
    open_below = bool(np.any(inside[:, 0])) and ln_speed[0] <= squares.lower[1] + 1e-12
    return Region(around[:, 0], around[:, 1], open_below)
