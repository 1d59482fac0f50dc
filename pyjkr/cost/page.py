"""`Costs` -> a page in Markdown, with the tables, the figures and the command that made it."""

from __future__ import annotations

import shutil
from pathlib import Path

from pyjkr.cost import report, results, tables
from pyjkr.cost.results import Costs
from pyjkr.cost.variants import ASSUMED_FRICTION, ASSUMED_HYSTERESIS

PAGE = """\
# Accuracy and cost

Scene: {title}. Made by

    {command} --page docs/accuracy-and-cost.md

which runs LIGGGHTS, compares with the oracle and writes `cost.csv` (every impact), `cost.json` (every table) and the figures.
Errors are the largest over {phases} phases of the first contact within a step. Those of e_eff^2 are parts of the energy of the
impact, those of v_t and r omega parts of its speed. Orders are fitted on log axes from {asymptotic} steps per collision on.
Computing times are those of LIGGGHTS' time loop without output, of many impacts side by side; compare them within a table
only: its runs alternate, and the numbers are medians.

## Verdict

{verdict}

## Steps per collision, with and without event correction

Steps per collision: the shorter of Hertz's collision time and the period of the stuck oscillation, over the time step. Speeds:
{speeds} times the sticking speed, which is where a contact leaves slowest and errors are largest.

![Largest error against steps per collision and against computing time](figures/cost-steps.png)

{energy_error}

{e_error}

Next to the sticking speed e_eff^2 is small: relative to itself its error is larger than as a part of the impact's energy.

{energy_error_relative}

{equal_error}

{threshold}

With weaker damping the law `jkr/simplified` sticks only at lower speeds. There adhesion alone accelerates the sphere to a
multiple of its speed within the contact, and the same error of the force is a larger part of the impact's energy.

{restitution}

{times}

## Stiffness reduction

In a normal impact Haervig's eq. 24 is an exact similarity: the error at a number of steps per collision is the same at every
stiffness, and the steps for the same simulated time fall as (E_mod/E)^(2/5). In an oblique one it is not exact: contacts press
deeper, which changes the lever of the tangential force, and rolling resistance does not scale. That change is physical, no
time step removes it; `change` is taken between two solutions of the oracle. `originals`: the real surface energy is kept in
the limits of sliding and twisting and in rolling.

![Steps and error at reduced stiffness; physical change of an oblique impact](figures/cost-stiffness.png)

{stiffness}

{oblique}

{assumed}

## Which effect matters

The same oblique impact with the law `jkr`, each effect left out in turn, at 200 steps per collision. `Matters`: a speed of the
outcome changes by more than {matters:.0%} of the impact speed. What does not matter for a scene need not be simulated.

![Change of the outcome and computing time without each effect](figures/cost-effects.png)

{effects}

## The main job

All speeds of the scene that both stiffnesses allow, for the same simulated time.

{headline}

{left_out}
"""


def write(costs: Costs, directory: Path, page: Path, command: str) -> None:
    """Write the page, and copy the figures into `figures/` beside it.

    Parameters
    ----------
    costs : Costs
        What to show.
    directory : Path
        Where `report.write` left the figures.
    page : Path
        File to write.
    command : str
        What made it.
    """
    (page.parent / "figures").mkdir(parents=True, exist_ok=True)
    for name in report.FIGURES:
        if (directory / name).is_file():
            shutil.copyfile(directory / name, page.parent / "figures" / name)
    page.write_text(_text(costs, command), encoding="utf-8")


def _text(costs: Costs, command: str) -> str:
    steps = costs.study("steps")
    base = steps[(steps["target"] == "wall") & (steps["normal"] == costs.scene.model.normal)]
    speeds = sorted(base["speed"].unique())
    near = costs.study("threshold")
    near = near[(near["target"] == "wall") & (near["normal"] == costs.scene.model.normal)]["speed"]
    sticking = near.mean() if len(near) else float("nan")
    studies = (tables.equal_error, tables.threshold, tables.restitution, tables.times)
    studies += (tables.stiffness, tables.oblique, tables.effects, tables.headline)
    shown = {study.__name__: _table(study(costs)) for study in studies}
    shown |= {name: _table(tables.errors(costs, name)) for name in ("energy_error", "e_error", "energy_error_relative")}
    return PAGE.format(
        title=costs.scene.title,
        command=command,
        phases=steps["phase"].nunique(),
        asymptotic=results.ASYMPTOTIC_STEPS,
        verdict="\n".join(f"- {line}" for line in tables.verdict(costs)),
        speeds=", ".join(f"{speed / sticking:.2g}" for speed in speeds),
        assumed=_assumed(costs),
        matters=results.MATTERS,
        left_out="\n".join(f"- left out: {line}" for line in costs.left_out),
        **shown,
    )


def _table(table: tables.Table) -> str:
    return f"**{table.title}**\n\n{tables.markdown(table)}"


def _assumed(costs: Costs) -> str:
    contact = costs.scene.meeting
    given = []
    if contact.friction_coefficient is None:
        given.append(f"friction_coefficient = {ASSUMED_FRICTION}")
    if contact.adhesion_hysteresis is None and contact.critical_rolling_angle is None:
        given.append(f"adhesion_hysteresis = {ASSUMED_HYSTERESIS}")
    return f"Assumed, since the scene gives none: {', '.join(given)}." if given else ""
