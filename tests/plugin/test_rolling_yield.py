"""Yield force of a sphere on a wall.

A force along the wall holds below the yield of the rolling spring and rolls the sphere above it.

F_yield = M_crit/r with M_crit = 4 F_C theta_crit r (Chen 2019), or 4 F_C a_0/12 Delta gamma/gamma (Krijt 2014), of
the real surfaces whatever the stiffness of the run. The force acts at the centre and is answered at the wall, with
the lever arm r - overlap/2: 0.1 % less than r at the softest here, inside the bracket.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from jkr import Jkr, effective_modulus
from simulation import Materials, Simulation, Sphere
from trajectory import Trajectory, trajectory

from pyjkr.run import Simulator

pytestmark = pytest.mark.liggghts

BRACKET = 0.005
AT_REST = 1e-3  # what is left of the rise after two damped periods
DRIVEN = 0.02  # the rise of the force has died down to this part of the excess
YOUNGS, POISSON, ENERGY, DENSITY, RADIUS = 9.4e10, 0.22, 0.017, 2640.0, 4.3e-6
MASS = 4.0 / 3.0 * math.pi * RADIUS**3 * DENSITY
HYSTERESIS, ANGLE = 0.57, 0.0007
REAL = Jkr(RADIUS, effective_modulus(YOUNGS, POISSON), ENERGY)
XI_CRIT = {"adhesionHysteresis": REAL.a0 / 12.0 * HYSTERESIS, "criticalRollingAngle": ANGLE * RADIUS}
SOFTER = 1e-3
# The force rises as half a cosine in RISE periods of the rolling spring and is held as long; with rollingDamping 0.6
# what it overshoots by is below a tenth of the bracket.
RISE, HOLD, DAMPING = 3.0, 3.0, 0.6
STEPS_A_PERIOD = 14  # of the sliding mode, the fastest


def pushed(
    plugin: Simulator, directory: Path, rolling: str, force: float, modulus_ratio: float, model: str
) -> tuple[Trajectory, Jkr]:
    soft = Jkr(RADIUS, REAL.modulus * modulus_ratio, ENERGY * modulus_ratio**0.4)
    omega_rolling = math.sqrt(60.0 * math.pi * ENERGY / (7.0 * MASS))
    time_step = 2.0 * math.pi / (2.2 * math.sqrt(soft.stiffness / MASS)) / STEPS_A_PERIOD
    # the rolling spring belongs to the real surface energy: it may be the faster one in a soft run
    time_step = min(time_step, 2.0 * math.pi / omega_rolling / (4 * STEPS_A_PERIOD))
    period = 2.0 * math.pi / omega_rolling
    rise, total = int(RISE * period / time_step), int((RISE + HOLD) * period / time_step)
    properties = dict(
        youngsModulus=YOUNGS * modulus_ratio,
        poissonsRatio=POISSON,
        coefficientRestitution=0.45,
        coefficientFriction=0.8,
        surfaceEnergy=soft.energy,
        surfaceEnergyOriginal=ENERGY,
        youngsModulusOriginal=YOUNGS,
    )
    properties[rolling] = HYSTERESIS if rolling == "adhesionHysteresis" else ANGLE
    simulation = Simulation(
        [Sphere((0.0, 0.0, RADIUS - soft.settled), RADIUS, DENSITY)],
        Materials(1, properties),
        time_step,
        total,
        style=f"model {model} tangential jkr rolling_friction krijt",
        keywords=f"rollingDamping {DAMPING}",
        walls=["primitive type 1 zplane 0.0"],
        before_run=[
            f"variable push equal {force!r}*0.5*(1.0-cos(PI*(step<{rise})*step/{rise}+PI*(step>={rise})))",
            "fix push all addforce v_push 0.0 0.0",
        ],
        every=total // 120,
    )
    return trajectory(simulation, plugin, directory), soft


@pytest.mark.parametrize("modulus_ratio", [1.0, SOFTER])
@pytest.mark.parametrize("rolling", ["adhesionHysteresis", "criticalRollingAngle"])
def test_sphere_holds_below_the_yield_force_and_rolls_above_it(
    plugin: Simulator, tmp_path: Path, rolling: str, modulus_ratio: float
) -> None:
    critical = XI_CRIT[rolling]
    yield_force = 12.0 * math.pi * ENERGY * critical
    for model in ("jkr/simplified", "jkr"):
        held, _ = pushed(plugin, tmp_path / "held", rolling, (1 - BRACKET) * yield_force, modulus_ratio, model)
        rolled, soft = pushed(plugin, tmp_path / "rolled", rolling, (1 + BRACKET) * yield_force, modulus_ratio, model)
        # held: at rest at the end, less than a thousandth of xi_crit in a period of the rolling spring
        speed_held = RADIUS * np.abs(held["omegay"][5 * len(held) // 6 :]).max()
        assert speed_held * 2.0 * math.pi * math.sqrt(7.0 * MASS / (60.0 * math.pi * ENERGY)) < AT_REST * critical, (
            model
        )
        # rolled: as fast as the dashpot lets what exceeds the yield moment drive it, eta_R = 2 x sqrt(k_r I/R), k_r =
        # 4 F_C
        eta = 2.0 * DAMPING * math.sqrt(12.0 * math.pi * ENERGY * 0.4 * MASS * RADIUS**2)
        excess = (1 + BRACKET) * yield_force * (RADIUS - 0.5 * soft.settled) - yield_force * RADIUS
        assert RADIUS * rolled["omegay"][-1, 0] == pytest.approx(excess / eta, rel=DRIVEN), model
