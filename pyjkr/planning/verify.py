"""The proof of a plan by small runs: probes at the planned settings beside a fine reference at the real stiffness, and both times.

Covers what `probes` lists. Assumes that the reference (400 steps a collision, E_mod = E, all effects) is right; LIGGGHTS runs both.
A directory keeps its runs: a second call goes on where the first was stopped.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from pyjkr.planning import probe_deck, timing, variants
from pyjkr.planning.plan import ApplicationPlan
from pyjkr.planning.probe_parts import Probe, Quantity
from pyjkr.planning.probes import not_probed, probes
from pyjkr.planning.situation import Situation
from pyjkr.planning.variants import Variant
from pyjkr.planning.verification import Row, Verification, text, to_json
from pyjkr.simulator import Simulator

__all__ = ["Row", "Verification", "compare", "run_probe", "step_times", "text", "to_json", "verify"]

# The bed that is timed: spheres along its edge, steps of a run, runs of a start, starts in turn.
BED_EDGE, BED_STEPS, BED_RUNS, BED_TURNS = 8, 20, 10, 3
# From so many contacts a sphere on it is timed in a bed of touching spheres, below among spheres apart.
BED_FROM = 1.0


def verify(
    plan: ApplicationPlan, directory: Path, simulator: Simulator, report: Callable[[int, int], None] = lambda done, all: None, *,
    rolling_damping: float = 0.0,
) -> Verification:  # fmt: skip
    """Run the probes of a plan.

    Parameters
    ----------
    plan : ApplicationPlan
        What to prove.
    directory : Path
        Gets one directory per run; whole runs of the same decks and program are not repeated.
    simulator : Simulator
        LIGGGHTS to use.
    report : callable
        Told how many probes are done, of how many.
    rolling_damping : float
        Of `rolling_friction krijt`, over critical, as the scene sets it.

    Raises
    ------
    RunError, DumpError
        Where a run fails or its dump is not whole.
    """
    situation, planned = plan.situation, variants.planned(plan)
    if planned.styles.rolling_friction == "epsd2":
        # Stock rolling belongs to no JKR contact: a coefficient that probes do not know, and no promise.
        planned = replace(planned, styles=replace(planned.styles, rolling_friction="off"))
    wanted = probes(situation, plan.max_error, rolling_damping)
    rows: list[Row] = []
    for done, probe in enumerate(wanted, start=1):
        rows += run_probe(probe, planned, variants.reference(situation, probe.meeting), plan.max_error, directory, simulator)
        report(done, len(wanted))
    unreduced = variants.unreduced(situation)
    soft, real = step_times(situation, (planned, unreduced), directory, simulator)
    duration = situation.time * situation.particles
    return Verification(
        title=situation.title,
        max_error=plan.max_error,
        budget=dict(plan.budget),
        rows=tuple(rows),
        not_probed=not_probed(situation),
        planned_step_time=soft,
        unreduced_step_time=real,
        planned_wall_time=duration / planned.time_step * soft,
        unreduced_wall_time=duration / unreduced.time_step * real,
        speed_up=real / unreduced.time_step / (soft / planned.time_step),
    )


def run_probe(
    probe: Probe, planned: Variant, reference: Variant, max_error: float, directory: Path, simulator: Simulator
) -> list[Row]:
    """Both runs of a probe, compared.

    Parameters
    ----------
    probe : Probe
        What to run.
    planned, reference : Variant
        How.
    max_error : float
        Limit of every error that is not a decision.
    directory, simulator
        As for `verify`.
    """
    found = []
    for variant in (planned, reference):
        deck = probe.deck(variant)
        run = probe_deck.execute(deck, directory / variant.name / _folder(probe.label), simulator)
        found.append(probe.read(probe_deck.frames(deck, run), variant))
    rows = (compare(probe.label, ours, theirs, max_error) for ours, theirs in zip(*found, strict=True))
    return [row for row in rows if row]


def step_times(
    situation: Situation, ways: tuple[Variant, ...], directory: Path, simulator: Simulator
) -> tuple[float, ...]:
    """Wall time [s] of one step and sphere in each variant: starts of LIGGGHTS in turn, of each the fastest run.

    Whatever else the machine does only adds time, and in turn it does so to all alike.

    Parameters
    ----------
    situation : Situation
        Whether its spheres lie in a bed or apart.
    ways : tuple of Variant
        Their styles are timed; in a bed of the model's own material, since the numbers do not change the time.
    directory, simulator
        As for `verify`.
    """
    distance = timing.TOUCHING if situation.contacts_per_particle >= BED_FROM else timing.APART
    times: dict[str, list[float]] = {variant.name: [] for variant in ways}
    for turn in range(BED_TURNS):
        for variant in ways:
            bed = timing.Bed(
                styles=variant.styles.text, edge=BED_EDGE, distance=distance, skin=0.1, steps=BED_STEPS, runs=BED_RUNS
            )
            measured = timing.measure(bed, directory / "timing" / f"{variant.name}-{turn}", simulator)
            times[variant.name].append(measured.loop_time / BED_STEPS / bed.spheres)
    return tuple(min(times[variant.name]) for variant in ways)


def compare(label: str, ours: Quantity, theirs: Quantity, max_error: float) -> Row | None:
    """Values of the plan and of the reference as a row; None where one of them has none, for a decision beside it tells."""
    if ours.decision:
        return _decided(label, ours, theirs, max_error)
    errors = np.abs(ours.values - theirs.values)
    if ours.relative:
        errors = np.where(errors > 0, errors / np.maximum(np.abs(theirs.values), theirs.floor), errors)
    if np.isnan(errors).all():
        return None
    worst = int(np.nanargmax(errors))
    return Row(
        probe=label, quantity=ours.name, planned=float(ours.values[worst]), reference=float(theirs.values[worst]),
        error=float(errors[worst]), limit=max_error if ours.promised else None, note=ours.note,
    )  # fmt: skip


def _decided(label: str, ours: Quantity, theirs: Quantity, max_error: float) -> Row:
    differ = ours.values != theirs.values
    clear, note = differ, ""
    if ours.margin is not None:
        clear = differ & (np.maximum(ours.margin, theirs.margin) > max_error)
        near = np.count_nonzero(differ & ~clear)
        note = f"{near} of {len(differ)} on the threshold, leaving with less than max_error of the energy" if near else ""
    return Row(
        probe=label, quantity=ours.name, planned=float(np.mean(ours.values)), reference=float(np.mean(theirs.values)),
        error=float(np.mean(clear)), limit=0.0, note=note,
    )  # fmt: skip


def _folder(label: str) -> str:
    """A directory for a label, its own even where signs that files do not like are all that tells two labels apart."""
    return re.sub(r"[^A-Za-z0-9.]+", "-", label).strip("-") + "-" + hashlib.sha256(label.encode()).hexdigest()[:6]
