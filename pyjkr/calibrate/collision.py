"""Dimensionless rebound of a normal impact, interpolated: e_eff over speed and damping, from `table.npz`.

Covers Chen, Liu, Li 2019 eqs 5-9 (law `jkr`) and Haervig et al. 2017 sections 2.1 and 5.2 (law `jkr/simplified`).
Assumes what `table.py` assumes; its interpolation error is tested against direct integration.

With v_s the sticking speed, beta the damping ratio and the energy of the make-break set apart,
    e_eff^2 = (1 - (v_s/v)^2) exp(-G 2 pi abs(beta)/sqrt(1 - beta^2)),
G is a smooth function of order 1 over t = sqrt(ln(v/v_s)) and sqrt(abs(beta)): it is bounded at the threshold, where e_eff
rises like sqrt(v - v_s), and goes to 1 at high speed, where Hertz is left.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.interpolate import InterpolatedUnivariateSpline, RectBivariateSpline

from pyjkr.calibrate.table import HIGHEST_RESTITUTION, HIGHEST_SPEED_RATIO, LOWEST_RESTITUTION, PATH
from pyjkr.oracle import Model, damping_ratio

Law = Literal["jkr", "jkr/simplified"]
# G - 1 falls as a power of the speed beyond the table. With eps = (a_0/a)^(3/2) ~ v^(-3/5) of the deepest contact, adhesion
# changes the force at a given overlap in the order eps^2 only; the damping of the full law, by its a, in the order eps.
DECAY = {Model.FULL: 0.6, Model.SIMPLIFIED: 1.2}
# Of the splines in t and in sqrt(abs(beta)).
DEGREE = 5


class Collision:
    """Rebound of one law, for all damping and speeds.

    Parameters
    ----------
    law : str
        "jkr" or "jkr/simplified".
    """

    def __init__(self, law: Law) -> None:
        self.law = Model(law)
        name = self.law.name.lower()
        with np.load(PATH) as table:
            self._root_beta, self._t = table["root_beta"], table["t"]
            self._loss = RectBivariateSpline(self._t, self._root_beta, table[f"loss_{name}"], kx=DEGREE, ky=DEGREE)
            # The simplified law sticks by damping alone: v_s goes as the square root of beta.
            offset = np.log(self._root_beta) if self.law is Model.SIMPLIFIED else 0.0
            self._sticking = InterpolatedUnivariateSpline(self._root_beta, np.log(table[f"sticking_{name}"]) - offset, k=DEGREE)

    def sticking_ratio(self, restitution_coefficient: npt.ArrayLike) -> np.ndarray:
        """v_s/v_* [-], v_* = sqrt(F_C a_0^2/(R m)).

        Parameters
        ----------
        restitution_coefficient : array_like
            e without adhesion [-], within the table.
        """
        root = self._root(restitution_coefficient)
        return np.exp(self._sticking(root)) * (root if self.law is Model.SIMPLIFIED else 1.0)

    def restitution(self, speed_ratio: npt.ArrayLike, restitution_coefficient: npt.ArrayLike) -> np.ndarray:
        """e_eff [-], 0 where the sphere sticks; the arguments are broadcast.

        Parameters
        ----------
        speed_ratio : array_like
            v/v_s [-], over the sticking speed of this damping.
        restitution_coefficient : array_like
            e without adhesion [-], within the table.
        """
        ratio, root = np.broadcast_arrays(np.asarray(speed_ratio, dtype=float), self._root(restitution_coefficient))
        return self._rebound(ratio, root**2, lambda t: self._loss.ev(t, root))

    def grid(self, speed_ratio: np.ndarray, restitution_coefficient: np.ndarray) -> np.ndarray:
        """e_eff [-] of every speed ratio (rows, any shape) at every damping (last axis): one pass of the spline."""
        flat, back = np.unique(np.asarray(speed_ratio, dtype=float), return_inverse=True)
        damping, order = np.unique(self._root(restitution_coefficient), return_inverse=True)
        values = self._rebound(flat[:, None], damping**2, lambda t: self._loss(t[:, 0], damping))
        return values[back.reshape(-1)][:, order.reshape(-1)].reshape(*np.shape(speed_ratio), -1)

    def _rebound(self, ratio: np.ndarray, abs_beta: np.ndarray, loss) -> np.ndarray:
        moving = np.maximum(ratio, 1.0)
        inside = np.minimum(moving, HIGHEST_SPEED_RATIO)
        excess = (loss(np.sqrt(np.log(inside))) - 1) * (inside / moving) ** DECAY[self.law]
        hertz = 2 * math.pi * abs_beta / np.sqrt(1 - abs_beta**2)
        return np.sqrt((1 - moving**-2) * np.exp(-(1 + excess) * hertz))

    def _root(self, restitution_coefficient: npt.ArrayLike) -> np.ndarray:
        given = np.asarray(restitution_coefficient, dtype=float)
        if np.any((given < LOWEST_RESTITUTION * (1 - 1e-9)) | (given > HIGHEST_RESTITUTION * (1 + 1e-9))):
            raise ValueError(
                f"restitution_coefficient must be within {LOWEST_RESTITUTION} and {HIGHEST_RESTITUTION}, the ends of the table"
            )
        return np.clip(np.sqrt(damping_ratio(given)), self._root_beta[0], self._root_beta[-1])


@cache
def collision(law: Law) -> Collision:
    """The table of a law, read once."""
    return Collision(law)
