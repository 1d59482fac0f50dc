"""Which styles exist together, and what is said of those that do not.

Properties that are missing, senseless or contradict each other.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulation import Materials, Simulation, Sphere
from trajectory import trajectory

from pyjkr.run import Simulator, run_deck

pytestmark = pytest.mark.liggghts

NORMALS = ("jkr/simplified", "jkr")
TANGENTIALS = ("off", "no_history", "history", "jkr")
ROLLINGS = ("off", "epsd2", "krijt")
# what else Debian's LIGGGHTS 3.8 has, by the *_model_*.h it installs
OTHER_NORMALS = (
    "hertz",
    "hooke",
    "hooke/stiffness",
    "hooke/hysteresis",
    "hertz/stiffness",
    "thornton_ning",
    "edinburgh",
    "luding",
)
OTHER_TANGENTIALS = ("tan_luding",)
OTHER_ROLLINGS = ("cdt", "epsd", "epsd3", "luding")
COHESIONS = ("sjkr", "sjkr2", "easo/capillary/viscous", "washino/capillary/viscous")
SURFACES = ("multicontact",)

PROPERTIES: dict[str, object] = dict(
    youngsModulus=[6.1e7, 8.3e7],
    poissonsRatio=[0.29, 0.36],
    coefficientRestitution=[[0.71, 0.64], [0.64, 0.55]],
    coefficientFriction=[[0.4, 0.33], [0.33, 0.47]],
    coefficientRollingFriction=[[0.021, 0.032], [0.032, 0.043]],
    surfaceEnergy=[[0.031, 0.022], [0.022, 0.047]],
    adhesionHysteresis=[[0.11, 0.23], [0.23, 0.34]],
)
RADIUS, SMALLER = 2.3e-5, 1.9e-5


def simulation(style: str, keywords: str = "", **changes: object) -> Simulation:
    """A pair of two types and two sizes over a wall, touching all at once. A property set to None is left out."""
    properties = {name: value for name, value in (PROPERTIES | changes).items() if value is not None}
    gap = 2.0 * math.sqrt(RADIUS * SMALLER) - 2e-7
    return Simulation(
        [
            Sphere((0.0, 0.0, RADIUS - 1e-7), RADIUS, 2510.0, (0.011, 0.017, -0.013), (13.0, 29.0, 7.0)),
            Sphere((gap, 0.0, SMALLER - 1e-7), SMALLER, 2740.0, (-0.019, 0.005, 0.003), (3.0, -31.0, 11.0), type=2),
        ],
        Materials(2, properties),
        time_step=1.1e-8,
        steps=30,
        style=style,
        keywords=keywords,
        walls=["primitive type 1 zplane 0.0"],
        every=10,
    )


def named(kind: str, names: tuple[str, ...]) -> list[str]:
    return ["", *(f" {kind} {name}" for name in names)]


COMBINATIONS = [
    f"model {normal}{tangential}{rolling}"
    for normal, tangential, rolling in itertools.product(
        NORMALS, named("tangential", TANGENTIALS), named("rolling_friction", ROLLINGS)
    )
]


@pytest.mark.parametrize("style", COMBINATIONS)
def test_every_combination_of_the_table_runs_with_pairs_and_walls(
    plugin: Simulator, tmp_path: Path, style: str
) -> None:
    t = trajectory(simulation(style), plugin, tmp_path)
    moments = np.abs([t[f"tq{axis}"] for axis in "xyz"])
    assert len(t) == 4 and np.isfinite(moments).all() and (t["fz"] != 0.0).all()
    # moments come from sliding and rolling alone
    turned = "history" in style or "tangential jkr" in style or "epsd2" in style or "krijt" in style
    assert (moments[:, 1:] > 0.0).any() == turned


def test_an_off_that_is_named_changes_nothing(plugin: Simulator, tmp_path: Path) -> None:
    dumps = []
    for number, style in enumerate(
        (
            "model jkr",
            "model jkr tangential off",
            "model jkr rolling_friction off",
            "model jkr tangential off rolling_friction off",
        )
    ):
        simulation(style).run(plugin, tmp_path / str(number))
        dumps.append((tmp_path / str(number) / "trajectory.txt").read_bytes())
    assert dumps[0] == dumps[1] == dumps[2] == dumps[3]


REFUSED = [
    *(f"model {normal} tangential jkr" for normal in OTHER_NORMALS),
    *(f"model {normal} tangential history rolling_friction krijt" for normal in OTHER_NORMALS),
    *(f"model jkr tangential {tangential}" for tangential in OTHER_TANGENTIALS),
    *(
        f"model {normal} tangential jkr rolling_friction {rolling}"
        for normal, rolling in itertools.product(NORMALS, OTHER_ROLLINGS)
    ),
    *(
        f"model {normal} tangential jkr cohesion {cohesion}"
        for normal, cohesion in itertools.product(NORMALS, COHESIONS)
    ),
    *(f"model jkr/simplified tangential jkr rolling_friction krijt surface {surface}" for surface in SURFACES),
    "tangential jkr",
    "rolling_friction krijt",
]


@pytest.mark.parametrize("style", REFUSED)
def test_every_other_combination_is_refused_with_the_list_of_those_that_exist(
    plugin: Simulator, tmp_path: Path, style: str
) -> None:
    error = simulation(style).refused(plugin, tmp_path)
    for part in ("jkr/simplified|jkr", "off|no_history|history|jkr", "off|epsd2|krijt"):
        assert part in error


def test_wall_alone_with_a_combination_that_does_not_exist_is_refused_too(plugin: Simulator, tmp_path: Path) -> None:
    good = simulation("model jkr tangential jkr")
    deck = good.deck().replace(
        "fix wall0 all wall/gran model jkr tangential jkr",
        "fix wall0 all wall/gran model jkr tangential jkr rolling_friction cdt",
    )

    class Altered(Simulation):
        def deck(self) -> str:
            return deck

    error = replace(Altered(**{name: getattr(good, name) for name in good.__dataclass_fields__})).refused(
        plugin, tmp_path
    )
    assert "jkr/simplified|jkr" in error and "off|epsd2|krijt" in error


KRIJT = "model jkr tangential jkr rolling_friction krijt"
INFINITE = "1e999"  # LIGGGHTS reads it as infinity


def pairs(value: object) -> list[list[object]]:
    """A good matrix but for the pair (1,2)."""
    return [[0.31, value], [value, 0.47]]


# style, changed properties, words the error must say
BAD = [
    (KRIJT, dict(surfaceEnergy=None), ("surfaceEnergy", "missing")),
    (KRIJT, dict(surfaceEnergy=pairs(-0.022)), ("surfaceEnergy", "-0.022", "(1,2)")),
    (KRIJT, dict(surfaceEnergy=pairs(INFINITE)), ("surfaceEnergy", "inf", "(1,2)")),
    (KRIJT, dict(surfaceEnergyOriginal=pairs(-0.7)), ("surfaceEnergyOriginal", "-0.7", "(1,2)")),
    (KRIJT, dict(surfaceEnergyOriginal=pairs(INFINITE)), ("surfaceEnergyOriginal", "inf", "(1,2)")),
    (KRIJT, dict(surfaceEnergyOriginal=pairs(0.0)), ("surfaceEnergyOriginal", "surfaceEnergy", "(1,2)")),
    (
        KRIJT,
        dict(surfaceEnergy=pairs(0.0), surfaceEnergyOriginal=pairs(0.022)),
        ("surfaceEnergyOriginal", "surfaceEnergy", "(1,2)"),
    ),
    (KRIJT, dict(adhesionHysteresis=None), ("adhesionHysteresis", "criticalRollingAngle")),
    (KRIJT, dict(criticalRollingAngle=0.009), ("adhesionHysteresis", "criticalRollingAngle", "exactly one")),
    (KRIJT, dict(adhesionHysteresis=pairs(-0.1)), ("adhesionHysteresis", "-0.1", "(1,2)")),
    (KRIJT, dict(adhesionHysteresis=pairs(INFINITE)), ("adhesionHysteresis", "inf", "(1,2)")),
    (KRIJT, dict(adhesionHysteresis=None, criticalRollingAngle=pairs(-0.2)), ("criticalRollingAngle", "-0.2", "(1,2)")),
    (
        KRIJT,
        dict(adhesionHysteresis=None, criticalRollingAngle=pairs(INFINITE)),
        ("criticalRollingAngle", "inf", "(1,2)"),
    ),
    (KRIJT, dict(youngsModulusOriginal=[7.7e9, -3.3e9]), ("youngsModulusOriginal", "-3.3e+09", "(2,2)")),
    (KRIJT, dict(youngsModulusOriginal=[7.7e9, 0.0]), ("youngsModulusOriginal", "(2,2)")),
    (KRIJT, dict(youngsModulusOriginal=[INFINITE, 7.7e9]), ("youngsModulusOriginal", "inf", "(1,1)")),
    ("model jkr tangential jkr", dict(coefficientFriction=None), ("coefficientFriction", "missing")),
    ("model jkr tangential jkr", dict(coefficientFriction=pairs(-0.4)), ("coefficientFriction", "-0.4", "(1,2)")),
    ("model jkr tangential jkr", dict(coefficientFriction=pairs(INFINITE)), ("coefficientFriction", "inf", "(1,2)")),
    ("model jkr", dict(youngsModulus=None), ("youngsModulus", "missing")),
    ("model jkr", dict(youngsModulus=[6.1e7, -8.3e7]), ("youngsModulus", "-8.3e+07", "(2,2)")),
    ("model jkr", dict(youngsModulus=[INFINITE, 8.3e7]), ("youngsModulus", "inf", "(1,1)")),
    ("model jkr", dict(poissonsRatio=None), ("poissonsRatio", "missing")),
    ("model jkr", dict(poissonsRatio=[INFINITE, 0.36]), ("poissonsRatio", "inf", "(1,1)")),
    ("model jkr", dict(poissonsRatio=[0.29, 1.7]), ("poissonsRatio",)),
    ("model jkr", dict(coefficientRestitution=None), ("coefficientRestitution", "missing")),
    ("model jkr", dict(coefficientRestitution=pairs(INFINITE)), ("coefficientRestitution", "inf", "(1,2)")),
    ("model jkr", dict(coefficientRestitution=pairs(-0.5)), ("coefficientRestitution", "-0.5", "(1,2)")),
    ("model jkr", dict(coefficientRestitution=pairs(1.6)), ("coefficientRestitution",)),
    ("model jkr", dict(coefficientRestitution=pairs(0.0)), ("coefficientRestitution",)),
]


@pytest.mark.parametrize(
    ("style", "changes", "words"), BAD, ids=[f"{style.split()[-1]}-{changes}" for style, changes, _ in BAD]
)
def test_bad_property_is_one_error_that_names_it_and_its_type_pair(
    plugin: Simulator, tmp_path: Path, style: str, changes: dict[str, object], words: tuple[str, ...]
) -> None:
    error = simulation(style, **changes).refused(plugin, tmp_path)
    assert all(word in error for word in words), error
    assert (tmp_path / "log.liggghts").read_text(errors="replace").count("ERROR") == 1


@pytest.mark.parametrize(
    "name",
    ["surfaceEnergy", "surfaceEnergyOriginal", "adhesionHysteresis", "youngsModulusOriginal", "coefficientFriction"],
)
def test_nan_is_refused_before_the_first_step_where_the_log_ends_with_the_property(
    plugin: Simulator, tmp_path: Path, name: str
) -> None:
    # LIGGGHTS' own reader of numbers refuses the word before any contact model sees it; the line it stands in names
    # the property
    nan: object = ["nan", 7.7e9] if name == "youngsModulusOriginal" else pairs("nan")
    simulation(KRIJT, **{name: nan}).refused(plugin, tmp_path)
    log = (tmp_path / "log.liggghts").read_text(errors="replace")
    assert log.count("ERROR") == 1 and f"property/global {name} " in log[: log.index("ERROR")].splitlines()[-1]


@pytest.mark.parametrize("value", ["-0.2", INFINITE, "nan"])
def test_senseless_rolling_damping_is_refused(plugin: Simulator, tmp_path: Path, value: str) -> None:
    assert "rollingDamping" in simulation(KRIJT, f"rollingDamping {value}").refused(plugin, tmp_path)


@pytest.mark.parametrize("keyword", ["computeElasticPotential", "computeDissipatedEnergy"])
def test_energy_switches_of_liggghts_are_refused_by_name(plugin: Simulator, tmp_path: Path, keyword: str) -> None:
    assert keyword in simulation("model jkr tangential jkr", f"{keyword} on").refused(plugin, tmp_path)


def test_neck_longer_than_the_sphere_is_refused_with_what_to_change(plugin: Simulator, tmp_path: Path) -> None:
    error = simulation("model jkr", surfaceEnergy=4.4e4).refused(plugin, tmp_path)
    assert "youngsModulus" in error and "surfaceEnergy" in error


def test_skin_shorter_than_the_neck_at_a_primitive_wall_is_refused_with_the_skin_to_set(
    plugin: Simulator, tmp_path: Path
) -> None:
    soft = replace(simulation("model jkr", surfaceEnergy=31.0), skin=1e-8)
    assert "neighbor" in soft.refused(plugin, tmp_path)


def test_properties_that_no_style_asks_for_may_be_missing(plugin: Simulator, tmp_path: Path) -> None:
    bare = simulation("model jkr", coefficientFriction=None, coefficientRollingFriction=None, adhesionHysteresis=None)
    assert len(trajectory(bare, plugin, tmp_path / "bare")) == 4
    krijt = simulation("model jkr rolling_friction krijt", coefficientFriction=None, coefficientRollingFriction=None)
    assert len(trajectory(krijt, plugin, tmp_path / "krijt")) == 4
    assert "coefficientFriction" in replace(krijt, keywords="twisting on").refused(plugin, tmp_path / "twisting")


def test_originals_equal_to_the_values_of_the_law_change_nothing(plugin: Simulator, tmp_path: Path) -> None:
    same = dict(surfaceEnergyOriginal=PROPERTIES["surfaceEnergy"], youngsModulusOriginal=PROPERTIES["youngsModulus"])
    frames = [
        trajectory(simulation(KRIJT, "twisting on", **extra), plugin, tmp_path / name)
        for name, extra in (("without", {}), ("with", same))
    ]
    for column in ("x", "y", "z", "fx", "fy", "fz", "tqx", "tqy", "tqz"):
        # the modulus is mixed here a second time: the round-off of a mixing rule
        assert frames[1][column] == pytest.approx(
            frames[0][column], rel=1e-13, abs=1e-13 * np.abs(frames[0][column]).max()
        )


INSERTION = """\
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
region box block -1e-5 1e-5 -1e-5 1e-5 0.0 2e-5 units box volume_limit 1e-20
create_box 2 box
neighbor 5e-7 bin
neigh_modify delay 0
hard_particles yes
fix m1 all property/global youngsModulus peratomtype 3.8e8 4.1e8
fix m2 all property/global poissonsRatio peratomtype 0.33 0.29
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.7 0.6 0.6 0.5
fix m4 all property/global coefficientFriction peratomtypepair 2 0.3 0.4 0.4 0.2
fix m5 all property/global surfaceEnergy peratomtypepair 2 0.05 0.03 0.03 0.02
fix m6 all property/global criticalRollingAngle peratomtypepair 2 0.008 0.009 0.009 0.007
pair_style gran model {model} tangential jkr rolling_friction krijt twisting on
pair_coeff * *
timestep 2e-10
fix floor all wall/gran model {model} tangential jkr rolling_friction krijt primitive type 2 zplane 0.0 twisting on
fix small all particletemplate/sphere 15485863 atom_type 1 density constant 1100 radius constant 0.8e-6 volume_limit 1e-20
fix large all particletemplate/sphere 15485867 atom_type 1 density constant 1100 radius constant 1.1e-6 volume_limit 1e-20
fix mix all particledistribution/discrete 32452843 2 small 0.5 large 0.5
fix pack all insert/pack seed 49979687 distributiontemplate mix insert_every once overlapcheck yes all_in yes &
    vel constant 0.0 0.0 -1.7 particles_in_region 20 region box
fix integrate all nve/sphere
thermo 500
thermo_modify lost error
run 1500
"""


@pytest.mark.parametrize("model", ["jkr", "jkr/simplified"])
def test_spheres_inserted_of_one_type_meet_a_wall_of_a_type_without_a_template(plugin, tmp_path, model):
    # LIGGGHTS answers for the smallest sphere of a type without a template with a radius of 1000.
    (tmp_path / "in.deck").write_text(INSERTION.format(model=model))
    run_deck(tmp_path / "in.deck", simulator=plugin, progress=False)
