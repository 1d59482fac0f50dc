"""`python -m pyjkr.calibrate.table` writes `table.npz`: the outcome of every normal impact, from the oracle.

Covers Chen, Liu, Li 2019 eqs 5-9 (law `jkr`) and Haervig 2017 eqs 3, 5, 8-13 (law `jkr/simplified`) in their own units.
Assumes a central impact without other forces; `collision.py` reads the table and says what its entries mean.
"""

from __future__ import annotations

import argparse
import math
import os
from pathlib import Path

import numpy as np

from pyjkr.oracle import Model, NormalContact, damping_ratio, impact, sticking_speed

PATH = Path(__file__).with_name("table.npz")
# Restitution coefficients without adhesion that the table spans. LIGGGHTS wants more than 0.05; above 0.998 damping takes
# less than 0.4 % of the energy, and no measurement tells how much less.
LOWEST_RESTITUTION, HIGHEST_RESTITUTION = 0.05, 0.998
# Nodes over the square root of abs(beta), and over t = sqrt(ln(v/v_s)), up to v = 1e4 v_s.
DAMPING_NODES, SPEED_NODES, HIGHEST_SPEED_RATIO = 56, 72, 1e4
# Of the integration; the sticking speed must be far closer than (v - v_s)/v_s of the node next to it.
TOLERANCE = 1e-11
# t of the two impacts from which the limit t -> 0 is extrapolated, together with the first node.
NEXT_TO_STICKING = (0.01, 0.02)

# Contact with a_0 = R = m = 1: F_C = 1/3, so that the unit of speed sqrt(F_C a_0^2/(R m)) is 1/sqrt(3).
_ENERGY = 1 / (9 * math.pi)
_SPEED_UNIT = 3**-0.5


def contact(restitution_coefficient: float, law: str) -> NormalContact:
    """The contact of the table: equilibrium contact radius, effective radius and modulus 1, to go with a mass of 1."""
    return NormalContact(1.0, 1.0, _ENERGY, Model(law), restitution_coefficient)


def restitution_of(abs_beta: float) -> float:
    """Restitution coefficient [-] without adhesion of a damping ratio; Haervig 2017, eq. 12 inverted."""
    return math.exp(-math.pi * abs_beta / math.sqrt(1 - abs_beta**2))


def excess_loss(squared_restitution: float, speed_ratio: float, abs_beta: float) -> float:
    """Damping loss over that of Hertz, G = -ln(e_eff^2/(1 - (v_s/v)^2)) / (2 pi abs(beta)/sqrt(1 - beta^2)) [-]."""
    hertz = 2 * math.pi * abs_beta / math.sqrt(1 - abs_beta**2)
    return -math.log(squared_restitution / (1 - speed_ratio**-2)) / hertz


def column(abs_beta: float, law: str, t: np.ndarray) -> tuple[float, np.ndarray]:
    """Sticking speed in units of sqrt(F_C a_0^2/(R m)), and G over t, at one damping ratio."""
    touching = contact(restitution_of(abs_beta), law)
    sticking = sticking_speed(touching, 1.0, relative_tolerance=TOLERANCE)

    def loss(place: float) -> float:
        ratio = math.exp(place**2)
        found = impact(touching, 1.0, ratio * sticking, relative_tolerance=TOLERANCE, samples=2, stuck_periods=0.01)
        return excess_loss(found.restitution**2, ratio, abs_beta)

    values = np.array([loss(place) for place in t[1:]])
    near = (*NEXT_TO_STICKING, t[1])
    limit = np.polyval(np.polyfit(near, [*map(loss, NEXT_TO_STICKING), values[0]], 2), 0.0)
    return sticking / _SPEED_UNIT, np.concatenate([[limit], values])


def build() -> dict[str, np.ndarray]:
    """All arrays of the table."""
    edges = np.sqrt(damping_ratio(np.array([HIGHEST_RESTITUTION, LOWEST_RESTITUTION])))
    root_beta = np.linspace(*edges, DAMPING_NODES)
    t = np.linspace(0.0, math.sqrt(math.log(HIGHEST_SPEED_RATIO)), SPEED_NODES)
    table = {"root_beta": root_beta, "t": t}
    for model in Model:
        columns = [column(root**2, model.value, t) for root in root_beta]
        name = model.name.lower()
        table[f"sticking_{name}"] = np.array([sticking for sticking, _ in columns])
        table[f"loss_{name}"] = np.array([values for _, values in columns]).T
    return table


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(prog="python -m pyjkr.calibrate.table", description="Integrate all impacts anew: minutes.")
    parser.add_argument("-o", "--output", type=Path, default=PATH, metavar="FILE", help="default: the table of the package")
    path = parser.parse_args().output
    unfinished = path.with_name(f".{os.getpid()}.npz")
    np.savez_compressed(unfinished, **build())
    unfinished.replace(path)
    print(path)


if __name__ == "__main__":
    main()
