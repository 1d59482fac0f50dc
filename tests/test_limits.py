"""Limits of a plan: the time step of each mode by name, outer forces against the reduced pull-off force."""

from __future__ import annotations

import dataclasses
import math
import re

import pytest
from scene_files import DAHNEKE, PAIR, edited, written
from simulation import Materials, Simulation, Sphere

from pyjkr import contact, limits, timestep
from pyjkr.contact import PairProperties
from pyjkr.errors import PlanError, RunError
from pyjkr.plan import plan
from pyjkr.scene import load

MODES = ["normal", "sliding", "rolling", "twisting"]


def planned(directory, text):
    return plan(load(written(directory, text)))


# --- time step --------------------------------------------------------------------------------------------------------


def slow_but_for(made, mode, share):
    """A case of which one mode alone is near its limit: the time step is `share` of it."""
    case = made.cases[0]
    case = dataclasses.replace(
        case, periods={name: period * (1 if name == mode else 1e6) for name, period in case.periods.items()}
    )
    return dataclasses.replace(case, time_step=share * limits.stability_limit(made.scene, case, mode))


@pytest.mark.parametrize("mode", MODES)
def test_a_time_step_beyond_the_limit_of_a_mode_is_refused_by_name_and_limit(tmp_path, mode):
    made = planned(tmp_path, PAIR)
    case = slow_but_for(made, mode, 1.001)
    limit = limits.stability_limit(made.scene, case, mode)
    shown = rf"in a period of the {mode} mode, whose stability limit is {re.escape(f'{limit:.3g}')} s \(dt omega = [\d.]+\)"
    with pytest.raises(
        PlanError, match=shown + r".*would blow up. Set steps_per_collision to 151 at least, better to \d+"
    ) as caught:
        limits.warnings(made.scene, [case])
    assert str(caught.value).startswith(f"scene.toml: case {case.label}: the time step of {case.time_step:.3g} s")


@pytest.mark.parametrize("mode", MODES)
def test_a_poorly_resolved_mode_is_warned_of_by_name_and_limit(tmp_path, mode):
    made = planned(tmp_path, PAIR)
    warnings = limits.warnings(made.scene, [slow_but_for(made, mode, 0.9)])
    assert [f"the {mode} mode, whose stability limit" in warning for warning in warnings] == [True]
    steps = int(re.search(r"Raise steps_per_collision to (\d+)", warnings[0])[1])
    assert steps >= 150 * 0.9 * 2
    assert limits.warnings(made.scene, [slow_but_for(made, mode, 0.9 * 150 / steps)]) == ()


def test_the_limit_is_two_without_damping_and_less_with_that_of_half_a_step_ago(tmp_path):
    text = edited(PAIR, ("rolling_damping = 0.3", "rolling_damping = 0.0\ntangential_damping = false"))
    free, damped = planned(tmp_path, text), planned(tmp_path, edited(PAIR, ("= 0.8\n", "= 0.2\n")))
    for mode in MODES:
        bounds = []
        for made in (free, damped):
            case = made.cases[0]
            bounds.append(2 * math.pi * limits.stability_limit(made.scene, case, mode) / case.periods[mode])
        assert bounds[0] == pytest.approx(2, rel=1e-12)
        # Damping of the normal force is taken at the full step.
        assert bounds[1] == pytest.approx(2, rel=1e-12) if mode == "normal" else bounds[1] < 1.95
    plain = planned(tmp_path, edited(PAIR, ("twisting = true", "twisting = true\nevent_correction = false")))
    assert limits.stability_limit(plain.scene, plain.cases[0], "normal") < 0.95 * plain.cases[0].periods["normal"] / math.pi


def test_rolling_does_not_slow_down_with_the_stiffness_and_is_refused(tmp_path):
    # The real rolling stiffness does not fall with E_mod: at 1e-5 it is the fastest mode.
    text = edited(
        PAIR, ("[0.5, 0.001]", "[1e-5]"), ("steps_per_collision = 150", "steps_per_collision = 12"), ("[0.3, 1.5]", "[0.02]")
    )
    with pytest.raises(PlanError, match=r"steps in a period of the rolling mode.*Set steps_per_collision to \d+ at least"):
        planned(tmp_path, edited(text, ("[reduction]", "[reduction]\nmaximum_overlap = 1.0")))


def test_strongly_damped_sliding_is_refused(tmp_path):
    # Undamped, ten steps a collision would do.
    text = edited(PAIR, ("steps_per_collision = 150", "steps_per_collision = 10"), ("[0.3, 1.5]", "[0.01]"))
    planned(tmp_path, text)
    with pytest.raises(PlanError, match="in a period of the sliding mode"):
        planned(tmp_path, edited(text, ("= 0.8\n", "= 0.06\n")))


# One sphere at rest on a wall, softened so far that twisting is not much slower than the normal mode, or with so large a
# real surface energy that rolling is faster.
RADIUS, DENSITY, POISSON, ENERGY = 1e-6, 1050.0, 0.33, 0.05
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
KICKS = {
    "normal": {"velocity": (0.0, 0.0, 1e-6)},
    "sliding": {"velocity": (1e-6, 0.0, 0.0)},
    "rolling": {"spin": (0.0, 0.1, 0.0)},
    "twisting": {"spin": (0.0, 0.0, 0.1)},
}
STYLES = {
    "normal": "",
    "sliding": "tangential jkr",
    "rolling": "rolling_friction krijt",
    "twisting": "rolling_friction krijt",
}
MOVING = {"sliding": "vx", "rolling": "omegay", "twisting": "omegaz"}


def grows(plugin, directory, mode: str, share: float, restitution: float, rolling_damping: float) -> bool:
    """Whether a small disturbance of one mode grows at this share of its stability limit."""
    young = 1e6 if mode == "twisting" else 3.8e9
    original = 20.0 if mode == "rolling" else ENERGY
    pair = PairProperties(
        effective_radius=RADIUS,
        effective_mass=MASS,
        effective_inertia=0.4 * MASS * RADIUS**2,
        effective_modulus=contact.effective_modulus((young, young), (POISSON, POISSON)),
        effective_shear_modulus=contact.effective_shear_modulus((young, young), (POISSON, POISSON)),
        surface_energy=ENERGY,
        surface_energy_of_rolling=original,
        restitution_coefficient=restitution,
    )
    a = pair.equilibrium_contact_radius
    share_of_spin = timestep.spin_share((RADIUS,), (MASS,))
    period = {
        "normal": timestep.normal_period(pair, a),
        "sliding": timestep.sliding_period(pair, a),
        "rolling": timestep.rolling_period(pair, a, share_of_spin),
        "twisting": timestep.twisting_period(pair, a),
    }[mode]
    ratio = {"normal": 0.0, "rolling": rolling_damping * math.sqrt(share_of_spin)}.get(mode)
    if ratio is None:
        ratio = timestep.tangential_damping_ratio(pair, a, period)
    height = RADIUS - a**2 / (3 * RADIUS)
    properties = {
        "youngsModulus": young,
        "poissonsRatio": POISSON,
        "coefficientRestitution": restitution,
        "coefficientFriction": 50.0,
        "surfaceEnergy": ENERGY,
        "surfaceEnergyOriginal": original,
        "adhesionHysteresis": 5.0,
    }
    keywords = {"rolling": f"rollingDamping {rolling_damping}", "twisting": "twisting on"}.get(mode, "")
    trajectory = Simulation(
        [Sphere((0, 0, height), RADIUS, DENSITY, **KICKS[mode])],
        Materials(1, properties),
        share * timestep.verlet_limit(period, ratio),
        400,
        style=f"model jkr {STYLES[mode]}",
        keywords=keywords,
        walls=["primitive type 1 zplane 0.0"],
        skin=2 * RADIUS,
        box=[-1e-5, 1e-5, -1e-5, 1e-5, -2e-6, 1e-5],
    ).run(plugin, directory)
    moved = trajectory["z"] - height if mode == "normal" else trajectory[MOVING[mode]]
    # 3 % beyond the limit a step multiplies by more than 1.1; what is stable keeps to the amplitude of its first periods.
    return bool(moved.abs().max() > 3 * moved.abs().iloc[:5].max())


@pytest.mark.liggghts
@pytest.mark.parametrize(
    ("mode", "restitution", "rolling_damping"),
    [
        ("normal", 0.999, 0.0),
        ("normal", 0.3, 0.0),
        ("sliding", 0.999, 0.0),
        ("sliding", 0.3, 0.0),
        ("rolling", 0.9, 0.0),
        ("rolling", 0.9, 0.6),
        ("twisting", 0.999, 0.0),
        ("twisting", 0.1, 0.0),
    ],
)
def test_the_stability_limit_of_each_mode_is_measured_within_3_percent(plugin, tmp_path, mode, restitution, rolling_damping):
    assert not grows(plugin, tmp_path / "below", mode, 0.97, restitution, rolling_damping)
    try:
        assert grows(plugin, tmp_path / "above", mode, 1.03, restitution, rolling_damping)
    except RunError as error:
        assert "Lost atoms" in str(error)


# --- outer forces -----------------------------------------------------------------------------------------------------

# F_C = 3 pi R gamma = 3 pi 0.635e-6 0.11 N = 6.583162e-7 N for Dahneke's sphere, 4/3 pi R^3 1026 kg/m3 = 1.100418e-15 kg.
PULL_OFF, SPHERE = 6.583162e-7, 1.100418e-15


def pulled(directory, *, text=DAHNEKE, **environment):
    lines = "".join(f"{key} = {value!r}\n" for key, value in environment.items())
    return planned(directory, edited(text, ("unmodified_ratios = [0.2]\n", "")) + "\n[environment]\n" + lines)


def test_weak_forces_need_no_warning(tmp_path):
    assert pulled(tmp_path, external_force=0.099 * 8 / 9 * 0.1**0.4 * PULL_OFF).warnings == ()
    assert pulled(tmp_path, acceleration=9.81).warnings == ()


def test_a_force_above_a_tenth_of_the_reduced_pull_off_force_is_warned_of_with_the_numbers(tmp_path):
    force = 0.05 * PULL_OFF
    (warning,) = pulled(tmp_path, external_force=force).warnings
    held = 8 / 9 * 0.1**0.4 * PULL_OFF
    assert warning.startswith("case 2.0mps_q0.1_scaled: the environment may pull with 3.29e-08 N, 14% of the ")
    assert f"{held:.3g} N that the contact holds at E_mod/E = 0.1 (8/9 of F_C,mod, {0.1**0.4 * PULL_OFF:.3g} N)" in warning
    # (0.05/(0.1 * 8/9))^(5/2) = 0.2372
    assert warning.endswith("From modulus_ratio = 0.238 on it is below 10%.")
    ratio = edited(DAHNEKE, ("[1.0, 0.1]", "[1.0, 0.238]"))
    assert pulled(tmp_path, text=ratio, external_force=force).warnings == ()


def test_the_full_model_holds_the_whole_pull_off_force(tmp_path):
    full = edited(DAHNEKE, ('"jkr/simplified"', '"jkr"'))
    assert "14% of the" in pulled(tmp_path, external_force=0.05 * PULL_OFF).warnings[0]
    (warning,) = pulled(tmp_path, text=full, external_force=0.05 * PULL_OFF).warnings
    assert "13% of the" in warning
    assert "(F_C,mod, " in warning


def test_a_force_above_the_reduced_pull_off_force_is_refused_with_the_ratio_that_would_do(tmp_path):
    # 0.5 F_C against 8/9 0.1^0.4 F_C = 0.354 F_C; (0.5 * 9/8)^(5/2) = 0.2373.
    with pytest.raises(PlanError) as caught:
        pulled(tmp_path, external_force=0.5 * PULL_OFF)
    message = str(caught.value)
    assert message.startswith("scene.toml: case 2.0mps_q0.1_scaled: the environment may pull with 3.29e-07 N, 141% of the ")
    assert "The contact would not last. Set modulus_ratios to 0.238 or more." in message
    assert message.endswith("it is 56% of what the real contact holds.")
    softest = edited(DAHNEKE, ("[1.0, 0.1]", "[1.0, 0.238]"))
    assert len(pulled(tmp_path, text=softest, external_force=0.5 * PULL_OFF).warnings) == 2


def test_a_force_above_the_real_pull_off_force_has_no_remedy_in_the_ratio(tmp_path):
    with pytest.raises(
        PlanError, match="No modulus_ratio helps against that: it is 124% of what the real contact holds"
    ) as caught:
        pulled(tmp_path, external_force=1.1 * PULL_OFF)
    assert "Set modulus_ratios" not in str(caught.value)


def test_an_acceleration_pulls_at_the_mass_of_the_heaviest_sphere_beside_the_force(tmp_path):
    share = 0.03 * PULL_OFF
    (warning,) = pulled(tmp_path, external_force=share, acceleration=share / SPHERE).warnings
    assert f"may pull with {2 * share:.3g} N" in warning
    made = planned(tmp_path, PAIR + "\n[environment]\nacceleration = 1e5\n")
    heaviest = max(made.cases[0].masses) * 1e5
    assert any(f"may pull with {heaviest:.3g} N" in warning for warning in made.warnings)


def test_without_adhesion_there_is_nothing_to_pull_off(tmp_path):
    plain = edited(DAHNEKE, ("surface_energy = 0.11", "surface_energy = 0.0"))
    assert not any("environment" in warning for warning in pulled(tmp_path, text=plain, external_force=1.0).warnings)


def test_unmodified_surface_energy_holds_as_much_as_the_real_one(tmp_path):
    made = planned(tmp_path, DAHNEKE + f"\n[environment]\nexternal_force = {0.05 * PULL_OFF!r}\n")
    assert ["q0.1_scaled" in warning for warning in made.warnings] == [True]
