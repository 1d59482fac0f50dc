# ruff: noqa: E501  (the lines of the page are as long as Markdown needs them)
"""Plan, verify and run the six scenes of cases/ at 1 % and 5 %, beside the unreduced decks, and write docs/planned-scenes.md.

    python docs/studies/planned_scenes.py [-o PAGE] [--runs DIR]

Runs LIGGGHTS one at a time, planned and unreduced in turn, for about half an hour; whole runs in DIR are not repeated.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT))

from pyjkr import plot  # noqa: E402
from pyjkr.application import analysis, deck, picture, scene, situation  # noqa: E402
from pyjkr.planning import plan, variants, verify  # noqa: E402
from pyjkr.planning.plan import ApplicationPlan  # noqa: E402
from pyjkr.planning.verify import Verification  # noqa: E402
from pyjkr.run import find_simulator  # noqa: E402

PAGE = HERE.parent / "planned-scenes.md"
# Times that the planned run must be faster: collisions, and scenes of lasting contacts.
WANTED = {"head_on_pair": 20, "oblique_wall": 20, "ash_on_tube": 5, "agglomerate_break_up": 5, "dust_coagulation": 5, "packed_bed": 5}
ERRORS = (0.01, 0.05)
# Each way is run so often, in turn; where an unreduced run takes longer than so many seconds, less often.
REPEATS, LESS_OFTEN = 15, ((100.0, 1), (1.0, 3))


@dataclass(frozen=True)
class Planned:
    """One scene at one error."""

    name: str
    plan: ApplicationPlan
    verification: Verification
    steps: int
    loop_time: float
    unreduced_steps: int
    unreduced_loop_time: float
    repeats: int
    observables: dict[str, float]
    unreduced_observables: dict[str, float]

    @property
    def speed_up(self) -> float:
        return self.unreduced_loop_time / self.loop_time


def measure(name: str, directory: Path) -> list[Planned]:
    """Verify and run one scene at every error; the unreduced deck is the same for all."""
    simulator = find_simulator()
    given = scene.load(ROOT / "cases" / name / "scene.toml")
    what = situation.situation(given)
    plans = {error: plan.plan(what, error) for error in ERRORS}
    ways = {f"{error:g}": variants.planned(made) for error, made in plans.items()} | {"unreduced": variants.unreduced(what)}
    times: dict[str, list[float]] = {way: [] for way in ways}
    steps, found = {}, {}
    # Frames in between would take longer than two spheres do.
    timed = given.model_copy(update={"run": given.run.model_copy(update={"frames": 1})})
    repeat = 0
    while repeat < _repeats(times["unreduced"]):
        for way, variant in ways.items():
            where = directory / name / f"{way}-{repeat}"
            run = deck.simulate(timed, variant, where, progress=False, simulator=simulator)
            times[way].append(run.loop_time)
            steps[way] = run.steps
            if repeat == 0:
                found[way] = analysis.observables(timed, variant, where)
        repeat += 1
        print(name, {way: [f"{each:.3g}" for each in values] for way, values in times.items()}, file=sys.stderr)
    shown = directory / name / "picture"
    deck.simulate(given, ways[f"{ERRORS[-1]:g}"], shown, progress=False, simulator=simulator)
    middle = {way: statistics.median(values) for way, values in times.items()}
    plot.save(picture.picture(given, ways[f"{ERRORS[-1]:g}"], shown), PAGE.parent / "figures" / f"planned-{name}.png")
    return [
        Planned(
            name=name, plan=made, verification=verify.verify(made, directory / name / f"verify-{error:g}", simulator, rolling_damping=given.numerics.rolling_damping),
            steps=steps[f"{error:g}"], loop_time=middle[f"{error:g}"], unreduced_steps=steps["unreduced"],
            unreduced_loop_time=middle["unreduced"], repeats=repeat, observables=found[f"{error:g}"], unreduced_observables=found["unreduced"],
        )
        for error, made in plans.items()
    ]  # fmt: skip


def _repeats(unreduced: list[float]) -> int:
    longest = max(unreduced, default=0.0)
    return next((count for limit, count in LESS_OFTEN if longest > limit), REPEATS)


def table(every: list[Planned]) -> list[str]:
    lines = [
        "| scene | error asked for | effects that are on | E_mod/E | bound by | steps per collision | steps, unreduced | time [s], unreduced | faster | wanted | largest error of the probes | |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for each in every:
        made, rows = each.plan, [row for row in each.verification.rows if row.limit is not None]
        worst = max(rows, key=lambda row: row.error)
        effects = ", ".join(decision.effect for decision in made.decisions if decision.on)
        good = each.verification.holds and each.speed_up >= WANTED[each.name]
        lines.append(
            f"| {each.name} | {made.max_error:.0%} | {effects} | {made.modulus_ratio:g} | {made.binding.name} | {made.steps_per_collision:.3g}"
            f" | {each.steps}, {each.unreduced_steps} | {each.loop_time:.2g}, {each.unreduced_loop_time:.2g} ({each.repeats}) | {each.speed_up:.3g} | {WANTED[each.name]}"
            f" | {worst.error:.2g} ({worst.probe}: {worst.quantity}) | {'holds' if good else '**does not hold**'} |"
        )
    return lines


def outcomes(every: list[Planned]) -> list[str]:
    lines = ["| scene | error asked for | number | planned | unreduced |", "|---|---|---|---|---|"]
    for each in every:
        lines += [
            f"| {each.name} | {each.plan.max_error:.0%} | {name} {f'[{analysis.UNITS[name]}]' if analysis.UNITS[name] else ''} | {value:.4g} | {each.unreduced_observables[name]:.4g} |"
            for name, value in each.observables.items()
        ]
    return lines


TEXT = """# Six scenes, planned

`pyjkr plan` was given the six scenes of `cases/` and an error of 1 % and of 5 %. This page shows what it decided, what the probes of
`--verify` measured, and how long the whole runs took beside the unreduced decks: E_mod = E, every effect on, 50 steps in a collision.
Planned and unreduced runs took turns on one core; times are LIGGGHTS' loop times without frames in
between, medians of the number of runs in brackets.

    python docs/studies/planned_scenes.py

{table}

"largest error": of all probes that count, in the units of the error asked for. What a probe is, and what counts: docs/planning.md.

## What the runs ended with

Scenes of many collisions are chaotic: two right runs differ in them as two seeds do. Numbers of the single impacts must agree.

{outcomes}

## Pictures, of the runs at 5 %

{pictures}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=PAGE, metavar="PAGE")
    parser.add_argument("--runs", type=Path, default=ROOT / "results" / "planned-scenes", metavar="DIR", help="keeps the runs")
    options = parser.parse_args()
    every = [each for name in WANTED for each in measure(name, options.runs)]
    text = TEXT.format(
        table="\n".join(table(every)), outcomes="\n".join(outcomes(every)),
        pictures="\n\n".join(f"![{name}](figures/planned-{name}.png)" for name in WANTED),
    )  # fmt: skip
    options.output.write_text(text, encoding="utf-8")
    print(options.output)


if __name__ == "__main__":
    main()
