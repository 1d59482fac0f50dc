# ruff: noqa: E501  (the lines of the page are as long as Markdown needs them)
"""Measure what softening does to an agglomerate that hits a wall, and write docs/break-up.md.

    python docs/studies/break_up.py [-o PAGE] [--runs DIR]

Runs LIGGGHTS with the plug-in on `cases/agglomerate_break_up` at other sizes and speeds; kept runs in DIR are not repeated.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT))

from pyjkr import scaling  # noqa: E402
from pyjkr.application import analysis, deck, scene, situation  # noqa: E402
from pyjkr.planning import softening, variants  # noqa: E402
from pyjkr.planning.styles import of_effects  # noqa: E402
from pyjkr.run import find_simulator  # noqa: E402

PAGE = HERE.parent / "break-up.md"
SEEDS = range(1, 13)
# Radius [m] and speed [m/s] of 150 spheres of polystyrene, from hardly broken to shattered.
IMPACTS = ((2.5e-6, 3.0), (50e-6, 0.25), (50e-6, 0.5), (50e-6, 1.0), (150e-6, 1.5))
RATIOS = (1.0, 0.1, 0.01)
STEPS = 20


@dataclass(frozen=True)
class Outcome:
    """Contacts left, in parts of all: mean and standard error; the part of spheres in the largest fragment, likewise."""

    contacts: float
    contacts_error: float
    largest: float
    largest_error: float


def impact(radius: float, speed: float, seed: int) -> scene.Application:
    """The case at another size and speed; as long as three radii of the agglomerate at its speed."""
    case = scene.load(ROOT / "cases" / "agglomerate_break_up" / "scene.toml")
    duration = 50 * radius / speed
    return case.model_copy(
        update={
            "particles": (case.particles[0].model_copy(update={"radius": radius}),),
            "motion": case.motion.model_copy(update={"speed": speed}),
            "run": case.run.model_copy(update={"seed": seed, "frames": 4, "duration": duration}),
        }
    )


def outcome(radius: float, speed: float, modulus_ratio: float, original: bool, directory: Path) -> Outcome:
    """Mean of an ensemble."""
    simulator = find_simulator()

    def one(seed: int) -> tuple[float, float]:
        made = impact(radius, speed, seed)
        real = variants.unreduced(situation.situation(made))
        effects = real.effects | ({"original_limits"} if original else set())
        step = real.time_step * variants.UNREDUCED_STEPS / STEPS * scaling.time_factor(modulus_ratio)
        soft = replace(real, modulus_ratio=modulus_ratio, effects=frozenset(effects), styles=of_effects(effects), time_step=step)
        where = directory / f"{radius:g}-{speed:g}-{modulus_ratio:g}-{'original' if original else 'scaled'}-{seed}"
        deck.simulate(made, soft, where, progress=False, simulator=simulator)
        found = analysis.observables(made, soft, where)
        return found["contacts_left_share"], found["largest_fragment_share"]

    with ThreadPoolExecutor(2) as pool:
        found = np.array(list(pool.map(one, SEEDS)))
    mean, error = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(len(found))
    return Outcome(mean[0], error[0], mean[1], error[1])


def estimate(radius: float, speed: float, modulus_ratio: float) -> float:
    """What the plan takes for the change of the contacts left."""
    return softening.break_up_change(situation.situation(impact(radius, speed, 1)), modulus_ratio)


def rows(directory: Path) -> list[str]:
    """Rows of the table."""
    lines = []
    for radius, speed in IMPACTS:
        real = None
        for modulus_ratio, original in ((q, kept) for q in RATIOS for kept in ((False,) if q == 1 else (False, True))):
            found = outcome(radius, speed, modulus_ratio, original, directory)
            real = real or found
            change = found.contacts - real.contacts
            error = np.hypot(found.contacts_error, real.contacts_error)
            kind = "real" if modulus_ratio == 1 else "original" if original else "scaled"
            cells = [f"{radius * 1e6:g}", f"{speed:g}", f"{modulus_ratio:g}", kind,
                     f"{found.contacts:.3f} +- {found.contacts_error:.3f}", f"{found.largest:.2f} +- {found.largest_error:.2f}"]  # fmt: skip
            cells += ["", ""] if kind == "real" else [f"{change:+.3f} +- {error:.3f}", "" if original else f"{estimate(radius, speed, modulus_ratio):.3f}"]
            lines.append("| " + " | ".join(cells) + " |")
            print(lines[-1], file=sys.stderr)
    return lines


TEXT = """# What softening does to an agglomerate that breaks

An agglomerate hits a wall. While the shock runs through it, its contacts are impacts among neighbours: similar at reduced stiffness
if every force scales alike, limits of sliding and rolling too. Afterwards fragments turn and slide past each other over whole radii.
What resists then is a force over a length that does not scale: with scaled limits it is weaker by (E_mod/E)^(2/5), with the original
ones it is right, but they were too strong during the shock. Neither is exact. `pyjkr plan` bounds the softening by the sum

    min({most:g}, {lost:g} x^2) (1 - q^(2/5)) + {strain:g} n (delta(q) - delta(1))/r,    x = 2 mu F_C r/(m v^2/2)

in parts of the contacts: x weighs the energy of sliding by a radius against that of the impact, n counts the spheres across the body
and delta is the overlap in the impact. The form is reasoned, the three numbers are fitted to the table below, which a command makes:

    python docs/studies/break_up.py

{count} spheres of polystyrene, material as in `cases/agglomerate_break_up`, {seeds} agglomerates each, {steps} steps in a collision; standard
errors. "original" keeps the real surface energy in the limits of sliding, rolling and twisting (`surfaceEnergyOriginal`).

| r [um] | v [m/s] | E_mod/E | limits | contacts left | in the largest fragment | change of the contacts left | estimate |
|---|---|---|---|---|---|---|---|
{rows}

Scaled limits come closer than the original ones wherever they differ by more than the scatter: `original_limits` stays off for bodies that break in
impacts, although it is what holds beds together. Where hardly anything is left in contact nothing can be lost either.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=PAGE, metavar="PAGE")
    parser.add_argument("--runs", type=Path, default=ROOT / "results" / "break-up", metavar="DIR", help="keeps the runs")
    options = parser.parse_args()
    lines = rows(options.runs)
    options.output.write_text(
        TEXT.format(most=softening.MOST_LOST, lost=softening.LOST_RESISTANCE, strain=softening.BODY_STRAIN, count=150, seeds=len(SEEDS),
                    steps=STEPS, rows="\n".join(lines)),
        encoding="utf-8",
    )  # fmt: skip
    print(options.output)


if __name__ == "__main__":
    main()
