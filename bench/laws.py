"""The contact laws side by side, and the decks that run them on a bed.

Every deck reads the same data file and the same properties; only the styles differ. Frozen: no integrator and no
velocity, so the same contacts in every step. Live: velocity Verlet from random velocities.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

# Polystyrene of 3.8 GPa and 0.05 J/m2, softened to 50 MPa with gamma_mod = gamma (E_mod/E)^(2/5): two spheres of 1 um
# without load overlap by 0.9 % of their diameter.
YOUNGS_MODULUS = 50e6
YOUNGS_MODULUS_ORIGINAL = 3.8e9
SURFACE_ENERGY = 0.00885
SURFACE_ENERGY_ORIGINAL = 0.05
POISSONS_RATIO = 0.33
RESTITUTION = 0.8
FRICTION = 0.35
ROLLING_FRICTION = 0.1
ADHESION_HYSTERESIS = 0.2
# sjkr2 takes an energy per volume [J/m3]: with this one its force is that of JKR without load, about.
COHESION_ENERGY_DENSITY = 2e5
YIELD_RATIO = 0.1
# Sixty steps in the period of the stiffest mode, sliding of a stuck pair.
TIME_STEP = 5e-10
# Part of the mean diameter.
SKIN = 0.1
WARM_UP_STEPS = 10


class Mode(Enum):
    FROZEN = "frozen"
    LIVE = "live"


@dataclass(frozen=True)
class Law:
    """A combination of styles.

    Parameters
    ----------
    key
        Name in files and tables.
    styles
        As after `pair_style gran`.
    ours
        Needs the plug-in.
    baseline
        Key of the law that the pair time is compared with.
    """

    key: str
    styles: str
    ours: bool = False
    baseline: str = "hertz+history"


HERTZ = Law("hertz", "model hertz tangential off", baseline="hertz")
HERTZ_HISTORY = Law("hertz+history", "model hertz tangential history")
HERTZ_ROLLING = Law(
    "hertz+history+epsd2", "model hertz tangential history rolling_friction epsd2", baseline="hertz+history+epsd2"
)
STOCK = (
    HERTZ,
    HERTZ_HISTORY,
    HERTZ_ROLLING,
    Law("hertz+history+sjkr2", "model hertz tangential history cohesion sjkr2"),
    Law("thornton_ning+history", "model thornton_ning tangential history"),
)


def _ours(model: str) -> tuple[Law, ...]:
    slots = (
        ("", "", HERTZ),
        ("+jkr", " tangential jkr", HERTZ_HISTORY),
        ("+jkr+krijt", " tangential jkr rolling_friction krijt", HERTZ_ROLLING),
        ("+jkr+krijt+twisting", " tangential jkr rolling_friction krijt", HERTZ_ROLLING),
    )
    laws = []
    for suffix, styles, baseline in slots:
        for correction in ("on", "off"):
            keywords = " twisting on" if suffix.endswith("twisting") else ""
            key = model + suffix + ("" if correction == "on" else " (eventCorrection off)")
            laws.append(Law(key, f"model {model}{styles} eventCorrection {correction}{keywords}", True, baseline.key))
    return tuple(laws)


SIMPLIFIED = _ours("jkr/simplified")
FULL = _ours("jkr")
LAWS = STOCK + SIMPLIFIED + FULL
# The ones that the growth with N and the size distribution are measured with.
FEW = (HERTZ_ROLLING, SIMPLIFIED[4], FULL[4])

# The peer's: LAMMPS' pair_style granular.
LAMMPS_JKR = f"jkr {YOUNGS_MODULUS} 0.5 {POISSONS_RATIO} {SURFACE_ENERGY}"
LAMMPS_MINDLIN = f"{LAMMPS_JKR} tangential mindlin NULL 1.0 {FRICTION}"
LAMMPS_SDS = f"{LAMMPS_MINDLIN} rolling sds 1e-2 1e-9 {ROLLING_FRICTION}"
LAMMPS_LAWS = (
    Law("LAMMPS jkr", f"{LAMMPS_JKR} tangential linear_nohistory 0.0 0.0", baseline="hertz"),
    Law("LAMMPS jkr+mindlin", LAMMPS_MINDLIN),
    Law("LAMMPS jkr+mindlin+sds", LAMMPS_SDS, baseline=HERTZ_ROLLING.key),
    Law("LAMMPS jkr+mindlin+sds+marshall", f"{LAMMPS_SDS} twisting marshall", baseline=HERTZ_ROLLING.key),
)


def liggghts_deck(
    law: Law, mode: Mode, data: Path, *, radius: float, steps: int, program: str, final_dump: str | None = None
) -> str:
    """A deck of LIGGGHTS: a warm-up, then the run that counts.

    Parameters
    ----------
    law, mode
        What to run.
    data
        The bed.
    radius
        Mean radius [m].
    steps
        Steps of the run that counts.
    program
        Digest of the program: a deck of another build is another deck, so its runs are not taken for this one's.
    final_dump
        File for the last positions, or None.
    """
    lines = [
        f"# {law.key}, {mode.value}; program {program}",
        "atom_style granular",
        "atom_modify map array",
        "boundary p p p",
        "newton off",
        "communicate single vel yes",
        "units si",
        "soft_particles yes",
        "hard_particles yes",
        f'read_data "{data}"',
        f"neighbor {SKIN * 2.0 * radius:.17g} bin",
        f"neigh_modify delay 0 binsize {2.2 * radius:.17g}",
        f"fix p1 all property/global youngsModulus peratomtype {YOUNGS_MODULUS}",
        f"fix p2 all property/global poissonsRatio peratomtype {POISSONS_RATIO}",
        f"fix p3 all property/global coefficientRestitution peratomtypepair 1 {RESTITUTION}",
        f"fix p4 all property/global coefficientFriction peratomtypepair 1 {FRICTION}",
        f"fix p5 all property/global coefficientRollingFriction peratomtypepair 1 {ROLLING_FRICTION}",
        f"fix p6 all property/global cohesionEnergyDensity peratomtypepair 1 {COHESION_ENERGY_DENSITY}",
        f"fix p7 all property/global coefficientYieldRatio peratomtype {YIELD_RATIO}",
        f"fix p8 all property/global surfaceEnergy peratomtypepair 1 {SURFACE_ENERGY}",
        f"fix p9 all property/global surfaceEnergyOriginal peratomtypepair 1 {SURFACE_ENERGY_ORIGINAL}",
        f"fix p10 all property/global youngsModulusOriginal peratomtype {YOUNGS_MODULUS_ORIGINAL}",
        f"fix p11 all property/global adhesionHysteresis peratomtypepair 1 {ADHESION_HYSTERESIS}",
        f"pair_style gran {law.styles}",
        "pair_coeff * *",
        f"timestep {TIME_STEP}",
        "thermo_style custom step atoms ke",
        "thermo 100000",
    ]
    if mode is Mode.LIVE:
        lines.append("fix integrate all nve/sphere")
    if final_dump:
        lines += [
            f"dump last all custom {WARM_UP_STEPS + steps} {final_dump} x y z radius",
            'dump_modify last format "%.17g %.17g %.17g %.17g"',
        ]
    lines += [f"run {WARM_UP_STEPS}", f"run {steps}", ""]
    return "\n".join(lines)


def lammps_deck(law: Law, mode: Mode, data: Path, *, radius: float, steps: int) -> str:
    """The same for LAMMPS."""
    lines = [
        f"# {law.key}, {mode.value}",
        "units si",
        "atom_style sphere",
        "atom_modify map array",
        "boundary p p p",
        "newton off",
        "comm_modify vel yes",
        f'read_data "{data}"',
        f"neighbor {SKIN * 2.0 * radius:.17g} bin",
        "neigh_modify delay 0 every 1 check yes",
        "pair_style granular",
        f"pair_coeff * * {law.styles}",
        f"timestep {TIME_STEP}",
        "thermo_style custom step atoms ke",
        "thermo 100000",
        *(["fix integrate all nve/sphere"] if mode is Mode.LIVE else []),
        f"run {WARM_UP_STEPS}",
        f"run {steps}",
        "",
    ]
    return "\n".join(lines)
