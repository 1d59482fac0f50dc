# ruff: noqa: E501  (the lines of the page are as long as Markdown needs them)
"""Compare planned and unreduced runs of cases/ash_on_tube over several seeds, and write docs/fouling-seeds.md.

    python docs/studies/fouling_seeds.py [-o PAGE] [--runs DIR]

One run of a chaotic scene says little. Sixteen seeds take a quarter of an hour on two cores; whole runs in DIR are not repeated.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT))

from pyjkr.application import analysis, deck, scene, situation  # noqa: E402
from pyjkr.planning import plan, variants  # noqa: E402
from pyjkr.run import find_simulator  # noqa: E402

PAGE = HERE.parent / "fouling-seeds.md"
SEEDS = range(1, 17)
REAL = "real"
WAYS = (REAL, 0.01, 0.05)


def measure(directory: Path) -> dict[float | str, list[dict[str, float]]]:
    """What each seed ended with, unreduced and planned."""
    simulator = find_simulator()
    case = scene.load(ROOT / "cases" / "ash_on_tube" / "scene.toml")

    def one(way: float | str, seed: int) -> dict[str, float]:
        given = case.model_copy(update={"run": case.run.model_copy(update={"seed": seed, "frames": 1})})
        what = situation.situation(given)
        variant = variants.unreduced(what) if way == REAL else variants.planned(plan.plan(what, way))
        where = directory / f"{way}-{seed}"
        deck.simulate(given, variant, where, progress=False, simulator=simulator)
        return analysis.observables(given, variant, where)

    with ThreadPoolExecutor(2) as pool:
        started = {way: [pool.submit(one, way, seed) for seed in SEEDS] for way in WAYS}
        return {way: [each.result() for each in runs] for way, runs in started.items()}


def rows(found: dict[float | str, list[dict[str, float]]]) -> list[str]:
    """One row of the table for each number: mean and scatter of the real runs, mean differences with standard errors."""
    lines = []
    for name in found[REAL][0]:
        values = {way: np.array([each[name] for each in runs]) for way, runs in found.items()}
        real = values.pop(REAL)
        unit = f" [{analysis.UNITS[name]}]" if analysis.UNITS[name] else ""
        cells = [f"{name}{unit}", f"{real.mean():.4g}", f"{real.std(ddof=1):.2g}"]
        for planned in values.values():
            change = planned - real
            cells.append(f"{change.mean():+.2g} +- {change.std(ddof=1) / len(change) ** 0.5:.1g}")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


TEXT = """# A chaotic scene over several seeds

Where many spheres collide, the last digit of a speed decides who meets whom: one planned run beside one unreduced run shows the scatter,
not the error. Here `cases/ash_on_tube` is run with {count} seeds, unreduced (E_mod = E, every effect, 50 steps in a collision) and as planned at
1 % and at 5 %; differences are of the same seed, means with standard errors.

    python docs/studies/fouling_seeds.py

| number | unreduced, mean | scatter of one run | planned at 1 %, less unreduced | planned at 5 %, less unreduced |
|---|---|---|---|---|
{rows}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=PAGE, metavar="PAGE")
    parser.add_argument("--runs", type=Path, default=ROOT / "results" / "fouling-seeds", metavar="DIR", help="keeps the runs")
    options = parser.parse_args()
    options.output.write_text(TEXT.format(count=len(SEEDS), rows="\n".join(rows(measure(options.runs)))), encoding="utf-8")
    print(options.output)


if __name__ == "__main__":
    main()
