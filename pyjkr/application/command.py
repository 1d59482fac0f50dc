"""What the verbs `plan`, `deck` and `run` do with a scene of many particles: decide, write, simulate, measure.

Covers no law. Results go to stdout, warnings and progress to stderr. `result.json` is written last, so that it is always whole.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pyjkr import plot
from pyjkr.application import analysis, deck, picture, places, scene, situation
from pyjkr.application.scene import Application
from pyjkr.errors import RunError, SceneError, ToleranceError
from pyjkr.planning import collisions, cost_model, estimate, table, variants
from pyjkr.planning.estimate import Estimate
from pyjkr.planning.plan import ApplicationPlan, plan
from pyjkr.progress import of_steps
from pyjkr.run import find_simulator
from pyjkr.simulator import Simulator

SCENE_COPY, RESULT_NAME, PLAN_NAME, VERIFICATION_NAME = "scene.toml", "result.json", "plan.txt", "verification.json"
EVOLUTION_NAME, PICTURE_NAME, EXPLANATION_NAME = "evolution.csv", "picture.png", "plan-explained.txt"


@dataclass(frozen=True)
class Ready:
    """A scene, planned: what to run it as, and what that costs."""

    scene: Application
    plan: ApplicationPlan
    variant: variants.Variant
    estimate: Estimate
    simulator: Simulator | None

    @property
    def comments(self) -> tuple[str, ...]:
        """For the head of the deck."""
        return table.comments(self.plan)


def prepare(path: Path, max_error: float, *, with_simulator: bool = False) -> Ready:
    """Read and plan a scene; warnings go to stderr.

    Parameters
    ----------
    path : Path
        Of the scene file.
    max_error : float
        Largest error of the result.
    with_simulator : bool
        Whether LIGGGHTS must be there; otherwise it is looked for, since it decides which cost model holds.

    Raises
    ------
    SceneError, PlanError
        Where the scene is wrong, or beyond the law.
    RunError
        Where LIGGGHTS is wanted and not found.
    """
    read = scene.load(path)
    try:
        simulator = find_simulator()
    except RunError:
        if with_simulator:
            raise
        simulator = None
    try:
        # Absurd numbers end in one line, not in warnings of numpy before it.
        with np.errstate(all="ignore"):
            made = plan(situation.situation(read), max_error)
            variant = variants.planned(made)
            cost = estimate.estimate(made, cost_model.load(simulator), around=deck.around(read, variant))
            deck.steps(read, variant)
    except (OverflowError, ZeroDivisionError, ValueError) as error:
        raise SceneError(f"{path}: its numbers lead beyond what can be computed ({error}). Look for a slip in an exponent.") from None
    for warning in (*made.warnings, *_too_short(read, made, variant)):
        print(f"pyjkr: warning: {warning}", file=sys.stderr)
    return Ready(read, made, variant, cost, simulator)


def _too_short(read: Application, made: ApplicationPlan, variant: variants.Variant) -> Iterator[str]:
    """Whether an impact of two bodies may not be over at the end: a softened one lasts longer than a real one."""
    if read.start not in ("pair", "single"):
        return
    meeting = made.situation.meetings[0]
    needed = places.GAP * read.radii[1] / meeting.speed + 2 * collisions.contact_time(variant.pair(meeting), meeting.speed)
    if read.run.duration < needed:
        yield (
            f"{read.source}: duration = {read.run.duration:g} s: flight and softened impact take {needed:.3g} s, so that the run may end"
            " in contact. Make it longer."
        )


def run_plan(path: Path, options: argparse.Namespace) -> None:
    """Plan, print why, write the deck; with `verify`, prove it.

    Raises
    ------
    ToleranceError
        Where a probe exceeds the limit.
    """
    ready = prepare(path, options.max_error, with_simulator=options.verify)
    directory = options.output or Path("results") / f"{name_of(path)}-plan"
    print(table.explain(ready.plan) if options.explain else table.text(ready.plan))
    print()
    print(cost_text(ready))
    (directory / VERIFICATION_NAME).unlink(missing_ok=True)
    written = write(ready, directory)
    print(f"pyjkr: wrote {written}", file=sys.stderr)
    if options.verify:
        _verify(ready, directory, not options.no_progress)


def run_deck(path: Path, options: argparse.Namespace) -> None:
    """Plan and render: to a directory, or to stdout."""
    ready = prepare(path, options.max_error)
    if options.explain:
        print(table.explain(ready.plan), file=sys.stderr)
    if options.output:
        print(write(ready, options.output))
    else:
        others = [name for name, _ in deck.files(ready.scene, ready.variant) if name != deck.DECK_NAME]
        if others:
            print(f"pyjkr: warning: the deck reads {' and '.join(others)}; -o DIR writes both", file=sys.stderr)
        print(deck.render(ready.scene, ready.variant, comments=ready.comments), end="")


def run_run(path: Path, options: argparse.Namespace) -> None:
    """Plan, run, measure, draw."""
    if options.engine == "oracle":
        raise SceneError(f"{path}: the oracle computes impacts of one pair, not scenes of many particles. Leave --engine out.")
    ready = prepare(path, options.max_error, with_simulator=not options.dry_run)
    directory = options.output or Path("results") / name_of(path)
    if options.dry_run:
        launch = f"mpirun -np {options.np} " if options.np > 1 else ""
        print(f"# pyjkr deck {path} -o '{directory}' && cd '{directory}' && {launch}liggghts-jkr -in {deck.DECK_NAME}")
        print(deck.render(ready.scene, ready.variant, comments=ready.comments))
        return
    directory.mkdir(parents=True, exist_ok=True)
    for name in (RESULT_NAME, EVOLUTION_NAME, PICTURE_NAME):
        (directory / name).unlink(missing_ok=True)
    if path.resolve() != (directory / SCENE_COPY).resolve():
        shutil.copyfile(path, directory / SCENE_COPY)
    run = deck.simulate(
        ready.scene, ready.variant, directory, comments=ready.comments, ranks=options.np,
        progress=False if options.no_progress else None, simulator=ready.simulator,
    )  # fmt: skip
    analysis.evolution(ready.scene, ready.variant, directory).to_csv(directory / EVOLUTION_NAME, index=False)
    plot.save(picture.picture(ready.scene, ready.variant, directory), directory / PICTURE_NAME)
    found = analysis.observables(ready.scene, ready.variant, directory)
    print(cost_text(ready))
    print()
    width = max(map(len, found))
    for name, value in found.items():
        print(f"{name:<{width}}  {value:.6g} {analysis.UNITS[name]}".rstrip())
    print(f"\n{run.steps} steps in {run.wall_time:.3g} s")
    _write_json(directory / RESULT_NAME, {**_numbers(ready), "wall_time": run.wall_time, "observables": found})
    print(f"pyjkr: wrote {directory / RESULT_NAME}", file=sys.stderr)


def write(ready: Ready, directory: Path) -> Path:
    """Write the deck with what it reads, and the plan beside it; return the deck's path."""
    path = deck.write(ready.scene, ready.variant, directory, comments=ready.comments)
    (directory / PLAN_NAME).write_text(f"{table.text(ready.plan)}\n\n{cost_text(ready)}\n", encoding="utf-8")
    (directory / EXPLANATION_NAME).write_text(table.explain(ready.plan) + "\n", encoding="utf-8")
    return path


def cost_text(ready: Ready) -> str:
    """Estimated steps, wall time and speed-up, one line each."""
    cost = ready.estimate
    origin = "" if cost.origin == "measured" else "; times of another machine, `pyjkr cost --calibrate` measures this one"
    lists = deck.neighbour_lists(ready.scene, ready.variant)
    return "\n".join(
        [
            f"estimated cost: {cost.steps} steps, {_duration(cost.wall_time)}{origin}",
            f"unreduced (E_mod = E, 50 steps per collision, all effects): {cost.unreduced_steps} steps,"
            f" {_duration(cost.unreduced_wall_time)}; planned is {cost.speed_up:.3g} times faster",
            f"neighbour lists: skin {lists.skin:.3g} m ({lists.limit}), made anew every {1 / lists.rebuild_rate:.3g} steps",
        ]
    )


def name_of(path: Path) -> str:
    """Name of a scene: that of its directory for `scene.toml`, of the file otherwise."""
    return path.resolve().parent.name if path.name == SCENE_COPY else path.stem


def _verify(ready: Ready, directory: Path, progress: bool) -> None:
    from pyjkr.planning import verify

    with of_steps("probes", progress) as report:
        damping = ready.scene.numerics.rolling_damping
        found = verify.verify(ready.plan, directory / "verify", ready.simulator, report, rolling_damping=damping)
    print()
    print(verify.text(found))
    _write_json(directory / VERIFICATION_NAME, verify.to_json(found))
    print(f"pyjkr: wrote {directory / VERIFICATION_NAME}", file=sys.stderr)
    if not found.holds:
        raise ToleranceError("a probe exceeds the limit; see the lines marked BAD")


def _numbers(ready: Ready) -> dict:
    made = ready.plan
    return {
        "title": made.situation.title,
        "max_error": made.max_error,
        "modulus_ratio": made.modulus_ratio,
        "binding": made.binding.name,
        "time_step": made.time_step,
        "limiting_mode": made.limiting_mode,
        "steps_per_collision": made.steps_per_collision,
        "styles": made.styles.text,
        "effects": {each.effect: each.on for each in made.decisions},
        "budget": {cause: value for cause, value in made.budget.items() if math.isfinite(value)},
        "estimated_speed_up": ready.estimate.speed_up,
        "warnings": list(made.warnings),
    }


def _write_json(path: Path, content: dict) -> None:
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    unfinished.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    unfinished.replace(path)


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.2g} s"
    return f"{seconds / 60:.2g} min" if seconds < 5400 else f"{seconds / 3600:.2g} h"
