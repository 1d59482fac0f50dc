"""The two copies of the pair loop, one for every machine and one with AVX2 and fused multiply-add, agree to round-off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from simulation import Materials, Simulation, Sphere

from pyjkr.run import Simulator

RADIUS, DENSITY = 0.61e-6, 1047.0
# Of the largest force: the overlap, 1e-3 to 1e-2 of the radius, has the round-off of the radius, some 1e-16/1e-3, and the
# force goes faster than the overlap.
ROUND_OFF = 1e-12
FORCES = ["fx", "fy", "fz", "tqx", "tqy", "tqz"]

MATERIALS = Materials(
    1,
    {
        "youngsModulus": 3.3e9,
        "poissonsRatio": 0.34,
        "coefficientRestitution": 0.83,
        "coefficientFriction": 0.33,
        "surfaceEnergy": 0.053,
        "adhesionHysteresis": 0.17,
    },
)


def cluster() -> list[Sphere]:
    """Thirty spheres of three sizes that overlap a little and move at random."""
    random = np.random.default_rng(5)
    spheres = []
    for x in range(3):
        for y in range(5):
            for z in range(2):
                place = 2 * 0.985 * RADIUS * np.array([x, y, z]) + 0.02 * RADIUS * random.normal(size=3)
                radius = RADIUS * (1.0, 0.97, 1.013)[(x + y + z) % 3]
                spheres.append(Sphere(place, radius, DENSITY, 2.1 * random.normal(size=3), 3e6 * random.normal(size=3)))
    return spheres


def with_avx2() -> bool:
    try:
        flags = Path("/proc/cpuinfo").read_text()
    except OSError:
        return False
    return " avx2" in flags and " fma" in flags


@pytest.mark.parametrize("model", ["jkr/simplified", "jkr"])
def test_both_copies_of_the_loop_agree_to_round_off(
    plugin: Simulator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, model: str
) -> None:
    if not with_avx2():
        pytest.skip("this machine has no AVX2 and FMA: there is one copy of the loop to run")
    simulation = Simulation(
        cluster(), MATERIALS, time_step=2e-11, steps=3, style=f"model {model} tangential jkr rolling_friction krijt", keywords="twisting on"
    )
    wide = simulation.run(plugin, tmp_path / "wide")
    monkeypatch.setenv("PYJKR_INSTRUCTIONS", "portable")
    portable = simulation.run(plugin, tmp_path / "portable")
    assert not np.array_equal(wide[FORCES], portable[FORCES]), "the same copy ran twice"
    for names in (FORCES[:3], FORCES[3:]):
        scale = np.abs(portable[names].to_numpy()).max()
        assert scale > 0.0
        np.testing.assert_allclose(wide[names], portable[names], rtol=0.0, atol=ROUND_OFF * scale)
