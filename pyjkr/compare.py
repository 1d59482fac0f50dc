"""Runs and oracle results -> `Comparison`: one row per case, and a verdict with named tolerances.

Covers the effective coefficient of restitution (Haervig 2017, sec. 5.1), sticking, the contact time, and how the two
scale with the modulus ratio (eq. 24, sec. 6.2). Assumes free flight before and after the contact.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pyjkr import scaling
from pyjkr.case import Case, Plan
from pyjkr.contact import PairProperties
from pyjkr.errors import DumpError
from pyjkr.oracle.impact import impact, sticking_speed
from pyjkr.oracle.normal import NormalContact
from pyjkr.plan import pair_properties
from pyjkr.run import Run

# Of e_eff against the oracle: event-corrected velocity Verlet at 2000 steps per collision reaches 1e-5, plain 1e-3.
RESTITUTION_TOLERANCE = 1e-3
# Of e_eff between stiffnesses: eq. 24 is exact for the discrete steps too when contact begins at the same phase, so
# only round-off differs: of the overlap, about 1e-16 r out of 1e-4 r in a step, amplified near the sticking threshold.
SIMILARITY_TOLERANCE = 1e-6
# Of the contact time's ratio to q^(-2/5).
CONTACT_TIME_TOLERANCE = 1e-3
# "Outpt time (%) = 0.00115 (13.4)" in LIGGGHTS' log.
OUTPUT_TIME = re.compile(r"^Outpt time \(%\) = (\S+)", re.MULTILINE)
# Points of an oracle curve, and the accuracy that a drawn line needs.
CURVE_POINTS = 90
CURVE_TOLERANCE = 1e-8


@dataclass(frozen=True)
class Outcome:
    """What one run, or one integration by the oracle, gave.

    Attributes
    ----------
    restitution : float
        e_eff: normal speed after over before; 0 if stuck.
    stuck : bool
        Whether the contact still holds at the end.
    contact_time : float
        From make to break [s]; NaN if stuck.
    time, velocity : ndarray
        Since the first touch [s]; of approach, negative after the turning point [m/s].
    steps : int
        Time steps; 0 for the oracle.
    wall_time, computing_time : float
        Of the whole program, and of its time loop without the writing of output [s]; NaN for the oracle.
    simulator : str or None
        What ran it; None for the oracle.
    """

    restitution: float
    stuck: bool
    contact_time: float
    time: np.ndarray
    velocity: np.ndarray
    steps: int = 0
    wall_time: float = math.nan
    computing_time: float = math.nan
    simulator: str | None = None


@dataclass(frozen=True)
class Check:
    """One line of the verdict: the worst value of something that must not exceed a tolerance."""

    name: str
    worst: float
    tolerance: float
    where: str

    @property
    def passed(self) -> bool:
        """Whether the worst value is within the tolerance; NaN is not."""
        return self.worst <= self.tolerance


@dataclass(frozen=True)
class Comparison:
    """All cases of a plan side by side.

    Attributes
    ----------
    plan : Plan
        What was simulated, and what was left out.
    engine : str
        `liggghts` or `oracle`.
    table : DataFrame
        One row per case.
    checks : tuple of Check
        The verdict in parts.
    outcomes : mapping
        Trajectories of the engine by case label.
    """

    plan: Plan
    engine: str
    table: pd.DataFrame
    checks: tuple[Check, ...]
    outcomes: Mapping[str, Outcome]

    @property
    def simulators(self) -> tuple[str, ...]:
        """What ran the cases, each once: more than one where an interrupted campaign went on with another."""
        return tuple(dict.fromkeys(outcome.simulator for outcome in self.outcomes.values() if outcome.simulator))

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


def outcome_of_run(case: Case, frame: pd.DataFrame, run: Run) -> Outcome:
    """Read an impact off the dump of its run.

    The break is extrapolated backwards from the last frame, in free flight, as the make is forwards from the first.

    Parameters
    ----------
    case : Case
        What was run.
    frame : DataFrame
        Its dump, as `pyjkr.dump.read` returns it.
    run : Run
        Its times and steps.

    Raises
    ------
    DumpError
        Where the last frame is not that of the last step.
    """
    first = frame[frame["id"] == 1].set_index("step")
    last_step = int(first.index[-1]) if len(first) else -1
    if last_step != case.steps:
        raise DumpError(
            f"{run.directory}: the dump ends at step {last_step} of {case.steps}. Remove the directory and run again."
        )
    height, rise = first["z"], first["vz"]
    if len(case.radii) == 2:
        second = frame[frame["id"] == 2].set_index("step")
        height, rise = height - second["z"], rise - second["vz"]
    overlap = sum(case.radii) - height.to_numpy()
    velocity = -rise.to_numpy()
    time = first.index.to_numpy() * case.time_step - case.contact_begins
    stuck = bool(overlap[-1] > case.rupture_overlap)
    rebound_speed = -velocity[-1]
    return Outcome(
        restitution=0.0 if stuck else float(rebound_speed / case.normal_speed),
        stuck=stuck,
        contact_time=math.nan if stuck else float(time[-1] - (case.rupture_overlap - overlap[-1]) / rebound_speed),
        time=time,
        velocity=velocity,
        steps=run.steps,
        wall_time=run.wall_time,
        computing_time=run.loop_time - output_time(run),
        simulator=run.simulator,
    )


def oracle_outcomes(plan: Plan) -> dict[str, Outcome]:
    """Every case of a plan integrated by the oracle, by label."""
    law = plan.scene.model.normal
    outcomes = {}
    for case in plan.cases:
        found = impact(_contact(case.pair, law), case.pair.effective_mass, case.normal_speed)
        outcomes[case.label] = Outcome(found.restitution, found.stuck, found.contact_time, found.time, found.velocity)
    return outcomes


def compare(plan: Plan, oracle: Mapping[str, Outcome], runs: Mapping[str, Outcome] | None) -> Comparison:
    """Set runs beside the oracle.

    Parameters
    ----------
    plan : Plan
        What was simulated.
    oracle : mapping
        Outcomes of the oracle by case label.
    runs : mapping or None
        Outcomes of the runs by case label; None where there are none and the oracle stands alone.
    """
    table = pd.DataFrame([_row(case, oracle[case.label], runs[case.label] if runs else None) for case in plan.cases])
    table["speed_up_steps"] = _speed_up(table, "steps")
    table["speed_up"] = _speed_up(table, "computing_time")
    engine = "liggghts" if runs else "oracle"
    return Comparison(plan, engine, table, tuple(_checks(table, engine)), runs or oracle)


def oracle_curves(plan: Plan) -> pd.DataFrame:
    """e_eff of the oracle over a fine range of speeds: the first scaled ratio for all of them, and each unmodified one.

    Returns
    -------
    DataFrame
        speed [m/s], modulus_ratio, rule, e_eff.
    """
    angle = math.cos(math.radians(plan.scene.impact.angle))
    law = plan.scene.model.normal
    rows = []
    drawn = dict.fromkeys((case.modulus_ratio, case.rule) for case in plan.cases)
    first_scaled = next((ratio for ratio, rule in drawn if rule == "scaled"), None)
    for ratio, rule in drawn:
        if rule == "scaled" and ratio != first_scaled:
            continue
        pair = pair_properties(plan.scene, ratio, rule)
        contact = _contact(pair, law)
        run_speeds = [case.speed for case in plan.cases]
        threshold = sticking_speed(contact, pair.effective_mass, relative_tolerance=CURVE_TOLERANCE) / angle
        slowest, fastest = min(run_speeds), max(run_speeds)
        speeds = [slowest, fastest]
        if threshold < fastest:
            # e_eff rises from 0 like a square root: points close above the threshold, and one at it.
            speeds += [threshold, *(threshold + np.geomspace(1e-4 * fastest, fastest - threshold, CURVE_POINTS)[:-1])]
        for speed in sorted(speed for speed in speeds if speed >= slowest):
            if speed <= threshold:
                e_eff = 0.0
            else:
                found = impact(contact, pair.effective_mass, speed * angle, relative_tolerance=CURVE_TOLERANCE, samples=2)
                e_eff = found.restitution
            rows.append({"speed": speed, "modulus_ratio": ratio, "rule": rule, "e_eff": e_eff})
    return pd.DataFrame(rows)


def _contact(pair: PairProperties, normal_law: str) -> NormalContact:
    return NormalContact(
        pair.effective_radius, pair.effective_modulus, pair.surface_energy, normal_law, pair.restitution_coefficient
    )


def _row(case: Case, oracle: Outcome, run: Outcome | None) -> dict[str, object]:
    return {
        "case": case.label,
        "speed": case.speed,
        "modulus_ratio": case.modulus_ratio,
        "rule": case.rule,
        "e_eff_liggghts": run.restitution if run else math.nan,
        "e_eff_oracle": oracle.restitution,
        "difference": run.restitution - oracle.restitution if run else math.nan,
        "stuck_liggghts": run.stuck if run else None,
        "stuck_oracle": oracle.stuck,
        "contact_time_liggghts": run.contact_time if run else math.nan,
        "contact_time_oracle": oracle.contact_time,
        "time_step": case.time_step,
        "steps": run.steps if run else case.steps,
        "wall_time": run.wall_time if run else math.nan,
        "computing_time": run.computing_time if run else math.nan,
    }


def _speed_up(table: pd.DataFrame, cost: str) -> pd.Series:
    """Cost at the real stiffness over cost, at the same speed and simulated time; NaN where the former was not run."""
    real = table[table["modulus_ratio"] == 1.0].drop_duplicates("speed").set_index("speed")[cost]
    return table["speed"].map(real) / table[cost]


def output_time(run: Run) -> float:
    """Time that LIGGGHTS spent on thermo lines and dumps [s], from its log: it samples the run and is no part of it."""
    return sum(float(seconds) for seconds in OUTPUT_TIME.findall(run.log.read_text(encoding="utf-8", errors="replace")))


def _checks(table: pd.DataFrame, engine: str) -> Iterable[Check]:
    if engine == "liggghts":
        names = table["case"]
        yield _worst("e_eff, LIGGGHTS against oracle", table["difference"].abs(), RESTITUTION_TOLERANCE, names)
        unlike = (table["stuck_liggghts"] != table["stuck_oracle"]).astype(float)
        yield _worst("sticking decided differently (cases)", unlike, 0.0, names, total=True)
    scaled = table[table["rule"] == "scaled"]
    e_eff = scaled.groupby("speed")[f"e_eff_{engine}"]
    if e_eff.size().max() > 1:
        spread = e_eff.max() - e_eff.min()
        yield _worst("e_eff, between stiffnesses (eq. 24)", spread, SIMILARITY_TOLERANCE, spread.index.map("{:g} m/s".format))
    real = scaled[scaled["modulus_ratio"] == 1.0].set_index("speed")[f"contact_time_{engine}"]
    reduced = scaled[(scaled["modulus_ratio"] != 1.0) & scaled["speed"].isin(real.index)]
    ratio = reduced[f"contact_time_{engine}"] / reduced["speed"].map(real) / reduced["modulus_ratio"].map(scaling.time_factor)
    deviation = (ratio - 1).abs().dropna()
    if len(deviation):
        yield _worst(
            "contact time, from (E/E_mod)^(2/5)", deviation, CONTACT_TIME_TOLERANCE, reduced["case"].loc[deviation.index]
        )


def _worst(name: str, values: pd.Series, tolerance: float, names: Iterable[str], total: bool = False) -> Check:
    """The check of a column; a NaN in it is the worst of all."""
    array = values.to_numpy(dtype=float)
    place = int(np.argmax(np.where(np.isnan(array), np.inf, array)))
    return Check(name, float(array.sum() if total else array[place]), tolerance, list(names)[place])
