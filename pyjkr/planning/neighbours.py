"""Skin and bins of the neighbour lists for the least wall time: long lists are walked through in every step, short ones made anew often.

Covers no law; LIGGGHTS makes new lists once a sphere has moved half the skin (`neigh_modify delay 0 check yes`).
Assumes that spheres which do not touch are spread evenly over the space that spheres leave each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq

from pyjkr.errors import PlanError
from pyjkr.planning.cost_model import CostModel

# The lists of primitive walls hold the spheres within the skin: a neck must not reach out of it.
# Some versions take half of it there.
SKIN_IN_NECKS = 2.2
# At rest no skin is too short; ours.
LEAST_SKIN_IN_RADII = 0.02
# Longer skins than that reach past the next sphere and ask for more room at periodic boundaries than small scenes have; ours.
MOST_SKIN_IN_RADII = 2.0
# Bin sizes that are compared, in search distances; the first is LIGGGHTS' own choice, for spheres everywhere in the box.
BIN_SHARES = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


@dataclass(frozen=True, kw_only=True)
class Surroundings:
    """What neighbour lists depend on.

    Attributes
    ----------
    speed : float
        Of the fastest sphere [m/s].
    time_step : float
        [s].
    smallest_radius, mean_radius, largest_radius : float
        [m].
    number_density : float
        Spheres in a volume [1/m3].
    neck : float
        delta_C, longest neck of the softened contacts [m]; 0 where contacts end at zero overlap.
    particles : float
        How many spheres share the bins.
    box_volume : float
        Of the simulation box [m3]; 0 takes no count of bins.
    """

    speed: float
    time_step: float
    smallest_radius: float
    mean_radius: float
    largest_radius: float
    number_density: float
    neck: float = 0.0
    particles: float = 1.0
    box_volume: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Neighbours:
    """Settings of `neighbor` and `neigh_modify`, and what they cost.

    Attributes
    ----------
    skin, bin_size : float
        [m].
    rebuild_rate : float
        New lists per step, at most 1.
    idle, candidates, bins : float
        Per sphere, as for `CostModel.step_time`.
    step_time : float
        Time that all this takes, per sphere and step [s].
    limit : str
        What held the skin: "wall time", "necks", "motion in a step", "least skin" or "next spheres".
    """

    skin: float
    bin_size: float
    rebuild_rate: float
    idle: float
    candidates: float
    bins: float
    step_time: float
    limit: str


def choose(surroundings: Surroundings, model: CostModel) -> Neighbours:
    """The skin and bin size of the least wall time; the skin no shorter than necks and the motion of one step ask for.

    With d the distance at which spheres touch, D the largest diameter, s the skin, k the bins' size in D + s and V/N the room of a
    sphere in the box, a sphere and step cost A ((d + s)^3 - d^3) + (2 v dt/s) (b + C_k (D + s)^3 + f (V/N)/(k (D + s))^3).
    The derivative has one root for each k: times s^2 it rises with s.

    Parameters
    ----------
    surroundings : Surroundings
        Of the fastest phase of the scene.
    model : CostModel
        What lists cost.

    Raises
    ------
    PlanError
        Where spheres move so far in a step that no list can follow them.
    """
    s = surroundings
    bounds = {
        "necks": SKIN_IN_NECKS * s.neck,
        # New lists in every step follow spheres that move half a skin in it.
        "motion in a step": 2 * s.speed * s.time_step,
        "least skin": LEAST_SKIN_IN_RADII * s.smallest_radius,
    }
    limit = max(bounds, key=bounds.__getitem__)
    least, most = bounds[limit], MOST_SKIN_IN_RADII * s.smallest_radius
    if least > most:
        raise PlanError(
            f"neighbour lists: {limit} ask for a skin of {least:.3g} m, more than {MOST_SKIN_IN_RADII:g} radii of the smallest sphere."
            " Take a shorter time step or a stiffer material."
        )
    shares = BIN_SHARES if s.box_volume > 0 else BIN_SHARES[:1]
    return min((_best(s, model, share, (least, most), limit) for share in shares), key=lambda lists: lists.step_time)


def at(skin: float, surroundings: Surroundings, model: CostModel, limit: str = "", bin_share: float = BIN_SHARES[0]) -> Neighbours:
    """What a given skin [m] leads to, with bins of `bin_share` search distances."""
    s = surroundings
    touch, search = 2 * s.mean_radius, 2 * s.largest_radius + skin
    idle = s.number_density * 2 / 3 * math.pi * ((touch + skin) ** 3 - touch**3)
    candidates = s.number_density * 4 / 3 * math.pi * search**3 * looked_through(bin_share)
    bins = s.box_volume / s.particles / (bin_share * search) ** 3
    rate = min(1.0, 2 * s.speed * s.time_step / skin)
    lists = model.rebuild_sphere + candidates * model.rebuild_candidate + bins * model.rebuild_bin
    return Neighbours(
        skin=skin, bin_size=bin_share * search, rebuild_rate=rate, idle=idle, candidates=candidates, bins=bins,
        step_time=idle * model.idle + rate * lists, limit=limit,
    )  # fmt: skip


def looked_through(bin_share: float) -> float:
    """Space of the bins around a sphere that LIGGGHTS looks through, over that with bins of half the search distance.

    Those whose nearest corner is within the search distance of the nearest corner of the sphere's own bin.

    Parameters
    ----------
    bin_share : float
        Size of the bins in search distances.
    """
    return _stencil(bin_share) / _stencil(BIN_SHARES[0])


def _stencil(bin_share: float) -> float:
    """Volume of the stencil in cubes of the search distance."""
    reach = math.ceil(1 / bin_share)
    gaps = [max(abs(i) - 1, 0) ** 2 for i in range(-reach, reach + 1)]
    bins = sum(1 for i in gaps for j in gaps for k in gaps if (i + j + k) * bin_share**2 < 1)
    return bins * bin_share**3


def _best(s: Surroundings, model: CostModel, share: float, bounds: tuple[float, float], limit: str) -> Neighbours:
    least, most = bounds
    if _slope(s, model, share, least) >= 0:
        return at(least, s, model, limit, share)
    if _slope(s, model, share, most) < 0:
        return at(most, s, model, "next spheres", share)
    return at(brentq(lambda skin: _slope(s, model, share, skin), least, most, rtol=1e-12), s, model, "wall time", share)


def _slope(s: Surroundings, model: CostModel, share: float, skin: float) -> float:
    """Derivative of the time by the skin, times skin^2/(4/3 pi); rises with the skin."""
    touch, largest = 2 * s.mean_radius, 2 * s.largest_radius
    search = largest + skin
    motion = 2 * s.speed * s.time_step
    walk = s.number_density * 1.5 * model.idle * (touch + skin) ** 2 * skin**2
    fixed = model.rebuild_sphere / (4 / 3 * math.pi)
    look = s.number_density * looked_through(share) * model.rebuild_candidate * search**2 * (2 * skin - largest)
    empty = s.box_volume / s.particles / share**3 / search**3 * (1 + 3 * skin / search) * model.rebuild_bin / (4 / 3 * math.pi)
    return walk + motion * (look - fixed - empty)
