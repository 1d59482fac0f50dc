"""The proof of a plan by small runs: probes at the planned settings beside a fine reference at the real stiffness, and both times.

Covers what `probes` lists. Assumes that the reference (400 steps a collision, E_mod = E, all effects) is right; LIGGGHTS runs both.
A directory keeps its runs: a second call goes on where the first was stopped.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pyjkr.planning import probe_deck, timing, variants
from pyjkr.planning.plan import ApplicationPlan
from pyjkr.planning.probes import Probe, Quantity, probes
from pyjkr.planning.situation import Situation
from pyjkr.planning.variants import Variant
from pyjkr.simulator import Simulator

# The bed that is timed: spheres along its edge, steps of a run, runs of a start, starts in turn.
BED_EDGE, BED_STEPS, BED_RUNS, BED_TURNS = 8, 20, 10, 3
# From so many contacts a sphere on it is timed in a bed of touching spheres, below among spheres apart.
BED_FROM = 1.0


@dataclass(frozen=True, kw_only=True)
class Row:
    """One quantity of one probe.

    Attributes
    ----------
    probe, quantity : str
        What was looked at.
    planned, reference : float
        Values where they differ most.
    error : float
        Largest difference: in parts of the impact's energy (e_eff^2) or speed, of the reference's value (yield moment, coordination),
        of the diameter (overlap); parts of the phases that were decided differently (sticking, held).
    limit : float
        `max_error`, or 0 for decisions.
    holds : bool
        Whether the error is within it.
    """

    probe: str
    quantity: str
    planned: float
    reference: float
    error: float
    limit: float
    holds: bool


@dataclass(frozen=True, kw_only=True)
class Verification:
    """What the probes found.

    Attributes
    ----------
    rows : tuple of Row
        Every quantity.
    planned_step_time, unreduced_step_time : float
        Of one step and sphere in a bed, measured in turn [s].
    planned_wall_time, unreduced_wall_time : float
        Of the scene's spheres over its duration, at that pace [s].
    speed_up : float
        Unreduced over planned, for the same simulated time.
    """

    rows: tuple[Row, ...]
    planned_step_time: float
    unreduced_step_time: float
    planned_wall_time: float
    unreduced_wall_time: float
    speed_up: float

    @property
    def holds(self) -> bool:
        """Whether every error is within its limit."""
        return all(row.holds for row in self.rows)


def verify(
    plan: ApplicationPlan, directory: Path, simulator: Simulator, report: Callable[[int, int], None] = lambda done, all: None
) -> Verification:
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

    Raises
    ------
    RunError, DumpError
        Where a run fails or its dump is not whole.
    """
    situation, planned = plan.situation, variants.planned(plan)
    wanted = probes(situation, planned)
    rows: list[Row] = []
    for done, probe in enumerate(wanted, start=1):
        rows += run_probe(probe, planned, variants.reference(situation, probe.meeting), plan.max_error, directory, simulator)
        report(done, len(wanted))
    unreduced = variants.unreduced(situation)
    soft, real = step_times(situation, (planned, unreduced), directory, simulator)
    duration = situation.time * situation.particles
    return Verification(
        rows=tuple(rows),
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
    return [_row(probe.label, ours, theirs, max_error) for ours, theirs in zip(*found, strict=True)]


def step_times(
    situation: Situation, ways: tuple[Variant, ...], directory: Path, simulator: Simulator
) -> tuple[float, ...]:
    """Wall time [s] of one step and sphere in each variant: starts of LIGGGHTS in turn, of each the fastest run.

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


def _row(label: str, ours: Quantity, theirs: Quantity, max_error: float) -> Row:
    errors = np.abs(ours.values - theirs.values)
    if ours.relative:
        errors = np.where(errors > 0, errors / np.abs(theirs.values), 0.0)
    worst = int(np.argmax(errors))
    error = float(np.mean(errors > 0)) if ours.exact else float(errors[worst])
    limit = 0.0 if ours.exact else max_error
    return Row(
        probe=label, quantity=ours.name, planned=float(ours.values[worst]), reference=float(theirs.values[worst]),
        error=error, limit=limit, holds=bool(error <= limit),
    )  # fmt: skip


def _folder(label: str) -> str:
    """A directory for a label, its own even where signs that files do not like are all that tells two labels apart."""
    return re.sub(r"[^A-Za-z0-9.]+", "-", label).strip("-") + "-" + hashlib.sha256(label.encode()).hexdigest()[:6]
