"""Measured rows -> conclusions: largest errors, orders of convergence, targets, the saving of the main job.

Covers no running and no drawing. Errors are absolute: of e_eff, and of e_eff^2 as a part of the impact's energy.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pyjkr.compare import Check
from pyjkr.cost.variants import OBLIQUE_ANGLE
from pyjkr.scene import Scene

# Error of the rebound energy ratio e_eff^2 that event correction promises, by steps per collision.
TARGETS = {20: 1e-2, 60: 1e-3}
# The reduced main job against the real one.
STEP_SAVING = 50
# Steps per collision from which on errors follow a power law.
ASYMPTOTIC_STEPS = 20
# Errors below are round-off of the overlap, amplified near the threshold, and say nothing about the order.
ROUND_OFF = 1e-10
# An effect matters where leaving it out changes a speed of the outcome by more than this part of the impact speed.
MATTERS = 1e-2
LAW_KEYS = ["target", "normal", "event_correction"]


@dataclass(frozen=True)
class Costs:
    """All that was measured for a scene.

    Attributes
    ----------
    scene : Scene
        What it is about.
    table : DataFrame
        One row per impact, or per timing of many.
    left_out : tuple of str
        What could not be run, with the reason.
    """

    scene: Scene
    table: pd.DataFrame
    left_out: tuple[str, ...]

    def study(self, name: str) -> pd.DataFrame:
        """The rows of one study."""
        return self.table[self.table["study"] == name]

    @property
    def checks(self) -> tuple[Check, ...]:
        """The verdict in parts."""
        return tuple(_checks(self))

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


def convergence_order(steps: Sequence[float], errors: Sequence[float]) -> float:
    """p of error ~ steps^-p, fitted on log axes from 20 steps per collision on; NaN with fewer than two usable points."""
    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    usable = (steps >= ASYMPTOTIC_STEPS) & (errors > ROUND_OFF)
    if usable.sum() < 2:
        return float("nan")
    return float(-np.polyfit(np.log(steps[usable]), np.log(errors[usable]), 1)[0])


def worst(rows: pd.DataFrame, error: str, keys: Sequence[str]) -> pd.DataFrame:
    """The row of the largest error for each combination of keys; a NaN counts as the largest of all."""
    order = rows.assign(_error=rows[error].fillna(np.inf)).sort_values("_error", kind="stable")
    return order.groupby(list(keys), sort=True).tail(1).drop(columns="_error").sort_values(list(keys)).reset_index(drop=True)


def errors_by_steps(costs: Costs, error: str = "energy_error") -> pd.DataFrame:
    """Largest error over speeds and phases: one row per target, law and correction, one column per number of steps."""
    found = worst(costs.study("steps"), error, [*LAW_KEYS, "steps_per_collision"])
    wide = found.pivot(index=LAW_KEYS, columns="steps_per_collision", values=error)
    wide["order"] = [convergence_order(wide.columns, line) for line in wide.to_numpy()]
    return wide.reset_index()


def steps_for_equal_error(costs: Costs) -> pd.DataFrame:
    """Steps without correction that give the error of 20 and 60 with it, from the power law fitted to the former."""
    rows = []
    found = errors_by_steps(costs)
    counts = [column for column in found.columns if column not in (*LAW_KEYS, "order")]
    fine = [count for count in counts if count >= ASYMPTOTIC_STEPS]
    for (target, law), part in found.groupby(["target", "normal"]):
        with_it, without = (part[part["event_correction"] == word].iloc[0] for word in ("on", "off"))
        slope, level = np.polyfit(np.log(fine), np.log(without[fine].to_numpy(dtype=float)), 1)
        for steps in (count for count in TARGETS if count in counts):
            needed = math.exp((math.log(with_it[steps]) - level) / slope)
            rows.append({"target": target, "normal": law, "steps": steps, "error": with_it[steps], "steps_without": needed})
    return pd.DataFrame(rows)


def errors_by_restitution(costs: Costs) -> pd.DataFrame:
    """Largest error over speeds and phases with event correction: one row per law and e, one column per number of steps."""
    rows = costs.study("restitution")
    found = rows.groupby(["normal", "restitution_coefficient", "steps_per_collision"])["energy_error"].max()
    slowest = rows.groupby(["normal", "restitution_coefficient"])["speed"].min().rename("slowest")
    return found.unstack("steps_per_collision").join(slowest).reset_index()


def time_per_step(costs: Costs) -> pd.DataFrame:
    """Computing time of one impact and one step [s], median of all turns, and the correction's factor on it."""
    found = costs.study("time").groupby(LAW_KEYS)["time_per_step"].median().unstack("event_correction")
    ratio = _ratio_by_turn(costs.study("time"), ["target", "normal"], "event_correction", "on", "off")
    return found.assign(ratio=ratio).reset_index()


def steps_with_time(costs: Costs) -> pd.DataFrame:
    """Largest errors as in `errors_by_steps`, long, with the computing time of one collision [s]."""
    found = worst(costs.study("steps"), "energy_error", [*LAW_KEYS, "steps_per_collision"])
    per_step = costs.study("time").groupby(LAW_KEYS)["time_per_step"].median()
    times = [per_step[tuple(key)] for key in found[LAW_KEYS].to_numpy()]
    return found.assign(collision_computing_time=found["steps_per_collision"] * times)


def stiffness(costs: Costs) -> pd.DataFrame:
    """Normal impacts: largest error, and steps for the same simulated time, that of one collision at the real stiffness."""
    rows = worst(costs.study("stiffness"), "energy_error", ["modulus_ratio", "steps_per_collision"])
    real = rows[rows["modulus_ratio"] == 1.0].set_index("steps_per_collision")["time_step"]
    rows["steps_for_time"] = rows["steps_per_collision"] * rows["steps_per_collision"].map(real) / rows["time_step"]
    return rows


def oblique(costs: Costs) -> pd.DataFrame:
    """Oblique impacts: largest error of the integrator, and change with the stiffness, both in parts of the impact speed."""
    rows = costs.study("oblique").copy()
    keys = ["effect", "modulus_ratio", "steps_per_collision"]
    columns = [f"{name}_{kind}" for name in ("tangential", "spin") for kind in ("error", "change")]
    for name in ("tangential", "spin"):
        real = rows[rows["modulus_ratio"] == 1.0].groupby("effect")[f"{name}_exact"].first()
        rows[f"{name}_change"] = (rows[f"{name}_exact"] - rows["effect"].map(real)).abs()
        rows[f"{name}_error"] = (rows[name] - rows[f"{name}_exact"]).abs()
    return rows.groupby(keys)[columns].max().reset_index()


def effects(costs: Costs) -> pd.DataFrame:
    """Largest change of the outcome without an effect, in parts of the impact speed, and the computing time without it."""
    rows, times = costs.study("effects").copy(), costs.study("effects time").assign(all="")
    whole = rows[rows["effect"] == "everything"].set_index("phase")
    # e is in parts of the normal speed alone.
    factors = {"e": math.cos(math.radians(OBLIQUE_ANGLE)), "tangential": 1.0, "spin": 1.0}
    for name, factor in factors.items():
        rows[f"{name}_change"] = factor * (rows[name] - rows["phase"].map(whole[name])).abs()
    columns = [f"{name}_change" for name in factors]
    found = rows.groupby("effect", sort=False).agg(
        {"e": "mean", "tangential": "mean", "spin": "mean"} | dict.fromkeys(columns, "max")
    )
    found["largest_change"] = found[columns].max(axis=1)
    found["time_per_step"] = times.groupby("effect")["time_per_step"].median()
    found["time_ratio"] = [_ratio_by_turn(times, ["all"], "effect", name, "everything").iloc[0] for name in found.index]
    return found.reset_index()


def headline(costs: Costs) -> pd.DataFrame:
    """The main job twice: steps and computing time of all speeds together, largest errors; the real stiffness first."""
    keys = ["modulus_ratio", "steps_per_collision", "event_correction"]
    rows = costs.study("headline").groupby([*keys, "speed"]).agg(
        run_steps=("run_steps", "first"),
        computing_time=("computing_time", "first"),
        e_error=("e_error", "max"),
        energy_error=("energy_error", "max"),
        decided_wrongly=("decided_wrongly", "sum"),
    )
    rows = rows.reset_index().groupby(keys).agg(
        slowest=("speed", "min"),
        fastest=("speed", "max"),
        run_steps=("run_steps", "sum"),
        computing_time=("computing_time", "sum"),
        e_error=("e_error", "max"),
        energy_error=("energy_error", "max"),
        decided_wrongly=("decided_wrongly", "sum"),
    )
    return rows.reset_index().sort_values("modulus_ratio", ascending=False).reset_index(drop=True)


def _ratio_by_turn(rows: pd.DataFrame, keys: list[str], column: str, above: str, below: str) -> pd.Series:
    """Median over the turns of a ratio of times taken one after the other, which a busy machine disturbs alike."""
    wide = rows.pivot(index=[*keys, "turn"], columns=column, values="time_per_step")
    return (wide[above] / wide[below]).groupby(level=keys).median()


def _checks(costs: Costs) -> Iterator[Check]:
    rows = costs.study("steps")
    for steps, tolerance in TARGETS.items():
        corrected = rows[(rows["event_correction"] == "on") & (rows["steps_per_collision"] == steps)]
        if len(corrected):
            line = worst(corrected, "energy_error", ["study"]).iloc[0]
            yield Check(f"error of e_eff^2 at {steps} steps a collision", line["energy_error"], tolerance, place(line))
    near = costs.study("threshold")
    near = near[near["event_correction"] == "on"]
    if len(near):
        wrong = near[near["decided_wrongly"] > 0]
        where = place(wrong.iloc[0]) if len(wrong) else ""
        yield Check("sticking decided wrongly, 2 % from the threshold", float(len(wrong)), 0.0, where)
    job = headline(costs)
    if len(job) == 2:
        real, reduced = job.iloc[0], job.iloc[1]
        yield Check("steps of the main job, over those unreduced", reduced["run_steps"] / real["run_steps"], 1 / STEP_SAVING, "")
        # Where the unreduced job is far from the threshold it may be better than anyone needs.
        limit = max(real["e_error"], TARGETS[reduced["steps_per_collision"]])
        yield Check("error of the main job in e_eff, reduced", reduced["e_error"], limit, f"unreduced {real['e_error']:.2g}")


def place(line: pd.Series) -> str:
    """Where an error was found."""
    return f"{line['normal']}, {line['target']}, {line['speed']:.4g} m/s"
