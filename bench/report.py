"""Results -> the page of tables and its figures."""

from __future__ import annotations

import platform
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from bench import profile
from bench.instructions import InstructionCount
from bench.laws import Law, Mode
from bench.measure import Sample, Spread
from bench.solver import SolverRow

COLOURS = {"stock": "#777777", "simplified": "#1f77b4", "full": "#d62728", "LAMMPS": "#2ca02c"}


@dataclass
class Results:
    """All that was measured; what was not is empty.

    Parameters
    ----------
    command
        The command that made it.
    spheres, pairs, evaluations
        Of the bed.
    size_spread
        Of the bed with sizes.
    laws
        Samples of each law and mode, from repeats in alternating order.
    sizes
        The same on spheres of unequal size.
    growth
        Samples of each law and number of spheres.
    ranks
        Samples of each law and number of MPI ranks.
    instructions
        Of each law and mode.
    solver
        Rows of the contact solver alone.
    notes
        What was skipped, and why.
    """

    command: str
    spheres: int
    pairs: int
    evaluations: int
    size_spread: float
    laws: dict[tuple[Law, Mode], list[Sample]] = field(default_factory=dict)
    sizes: dict[tuple[Law, Mode], list[Sample]] = field(default_factory=dict)
    growth: dict[tuple[Law, int], list[Sample]] = field(default_factory=dict)
    ranks: dict[tuple[Law, int], list[Sample]] = field(default_factory=dict)
    instructions: dict[tuple[Law, Mode], InstructionCount] = field(default_factory=dict)
    solver: list[SolverRow] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def machine() -> str:
    """The processor's name and number of cores."""
    try:
        text = Path("/proc/cpuinfo").read_text()
        names = re.findall(r"^model name\s*: (.+)$", text, re.MULTILINE)
        return f"{names[0].strip()}, {len(names)} cores seen"
    except (OSError, IndexError):
        return platform.processor() or platform.machine()


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table, numbers to the right."""
    align = ["---", *["---:"] * (len(header) - 1)]
    lines = [header, align, *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def ratio_to_baseline(samples: dict[tuple[Law, Mode], list[Sample]], law: Law, mode: Mode) -> Spread | None:
    """Pair time over that of the law's baseline, repeat by repeat: what slows both at a time cancels.

    Parameters
    ----------
    samples
        Of all laws.
    law, mode
        Which.
    """
    base = next((found for (other, m), found in samples.items() if other.key == law.baseline and m is mode), None)
    if not base:
        return None
    return Spread.of([a.per_evaluation / b.per_evaluation for a, b in zip(samples[law, mode], base, strict=False)])


def page(results: Results) -> str:
    """The page.

    Parameters
    ----------
    results
        What was measured.
    """
    parts = [
        "# What a contact costs\n",
        f'Made by `{results.command}` on {machine()}. Wall time of LIGGGHTS\' pair loop (its own "Pair time"), serial '
        "unless told otherwise; all laws in one run in alternating order; median, and the quartiles of the repeats in "
        "brackets.\n",
    ]
    if results.laws:
        parts += [
            _bed_text(results),
            *(_laws_table(results.laws, mode) for mode in Mode),
            "![Pair time](figures/bench-laws.png)\n",
        ]
    parts.append(profile.text(results, table))
    if results.sizes:
        parts += [
            "## Unequal spheres\n\n"
            f"Radii uniform within 1 +- {results.size_spread:g} of the mean: no radius repeats.\n",
            *(_laws_table(results.sizes, mode, heading="###") for mode in Mode),
        ]
    if results.growth:
        parts += [
            "## Growth with the number of spheres\n",
            _growth_table(results),
            "![Growth](figures/bench-growth.png)\n",
        ]
    if results.ranks:
        parts += ["## MPI ranks\n", _ranks_table(results)]
    if results.instructions:
        parts += [_instructions_table(results)]
    if results.solver:
        parts += [_solver_table(results.solver), "![Solvers](figures/bench-solver.png)\n"]
    if results.notes:
        parts += ["## Not measured\n", "".join(f"- {note}\n" for note in results.notes)]
    return "\n".join(parts)


def figures(results: Results, folder: Path) -> list[Path]:
    """Draw what was measured.

    Parameters
    ----------
    results
        What was measured.
    folder
        For the PNG files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for name, draw, wanted in (
        ("bench-laws.png", _draw_laws, results.laws),
        ("bench-growth.png", _draw_growth, results.growth),
        ("bench-solver.png", _draw_solver, results.solver),
    ):
        if wanted:
            figure = draw(results)
            figure.savefig(folder / name, dpi=140, metadata={"Software": None})
            plt.close(figure)
            drawn.append(folder / name)
    return drawn


def _bed_text(results: Results) -> str:
    coordination = 2.0 * results.pairs / results.spheres
    return (
        "## The bed\n\n"
        f"{results.spheres:,} equal polystyrene spheres of 1 um in a periodic box, E reduced to 50 MPa, "
        f"{results.pairs:,} contacts (z = {coordination:.2f}). `newton off` evaluates a contact through a face of the "
        f"box from both sides: {results.evaluations:,} evaluations a step, by which the times are divided. Frozen: no "
        "integration, the same contacts in every step. Live: integrated from random velocities; contacts counted at "
        "start and end (LAMMPS: at start).\n"
    )


def _laws_table(samples: dict[tuple[Law, Mode], list[Sample]], mode: Mode, heading: str = "##") -> str:
    rows = []
    for (law, its_mode), found in samples.items():
        if its_mode is not mode or not found:
            continue
        cost, near = Spread.of([s.per_evaluation for s in found]), Spread.of([s.per_neighbour for s in found])
        ratio = ratio_to_baseline(samples, law, mode)
        mark = " *" if found[0].generic else ""
        rows.append(
            (
                f"`{law.key}`{mark}",
                _spread(cost, 1),
                f"{cost.least:.1f}",
                _spread(near, 1),
                f"{found[0].neighbours:,}",
                f"`{law.baseline}`",
                _spread(ratio, 2) if ratio else "",
            )
        )
    if not rows:
        return ""
    header = ("law", "ns per contact", "least", "ns per neighbour pair", "neighbour pairs", "against", "ratio")
    note = "\n\\* no compiled version of this combination in LIGGGHTS: it calls its models through virtual functions.\n"
    title = f"{heading} {mode.value.capitalize()}\n\n"
    return title + table(header, rows) + (note if any("*" in row[0] for row in rows) else "")


def _growth_table(results: Results) -> str:
    laws = list(dict.fromkeys(law for law, _ in results.growth))
    numbers = sorted({n for _, n in results.growth})
    rows = []
    for n in numbers:
        cells = [results.growth.get((law, n)) for law in laws]
        rows.append((f"{n:,}", *(_spread(Spread.of([s.per_evaluation for s in c]), 1) if c else "" for c in cells)))
    return "ns per contact, frozen.\n\n" + table(("spheres", *(f"`{law.key}`" for law in laws)), rows)


def _ranks_table(results: Results) -> str:
    laws = list(dict.fromkeys(law for law, _ in results.ranks))
    numbers = sorted({n for _, n in results.ranks})
    rows = []
    for law in laws:
        times = [Spread.of([1e3 * s.pair_time / s.steps for s in results.ranks[law, n]]) for n in numbers]
        rows.append((f"`{law.key}`", *(_spread(t, 3) for t in times), f"{times[0].median / times[-1].median:.2f}"))
    header = ("law", *(f"ms a step, {n} rank{'s' if n > 1 else ''}" for n in numbers), "faster by")
    return "Pair time, mean over the ranks; frozen.\n\n" + table(header, rows)


def _instructions_table(results: Results) -> str:
    rows = []
    for (law, mode), counted in results.instructions.items():
        base = next((c for (o, m), c in results.instructions.items() if o.key == law.baseline and m is mode), None)
        ratio = f"{counted.per_evaluation / base.per_evaluation:.3f}" if base else ""
        rows.append((f"`{law.key}`", mode.value, f"{counted.per_evaluation:.0f}", f"`{law.baseline}`", ratio))
    return (
        "## Instructions\n\n"
        "Inside the pair style, per contact, pairs that do not touch included; callgrind, 500 spheres. "
        "Repeatable to 1e-4.\n\n" + table(("law", "bed", "instructions per contact", "against", "ratio"), rows)
    )


def _solver_table(rows: list[SolverRow]) -> str:
    cells = [
        (r.method, f"{r.throughput_ns:.1f}", f"{r.latency_ns:.1f}", f"{r.root_error:.0e}", f"{r.force_error:.0e}")
        for r in rows
    ]
    header = ("method", "throughput ns", "latency ns", "error of u", "error of F")
    return (
        "## The contact solver alone\n\n"
        "u^4 - u = D and F = 8/3 u^6 - 4 u^3. Latency is what counts where contacts are "
        "evaluated one at a time. Processor time. Errors for 0 < D < 100: of u relative, of F over max(|F|, F_C). "
        "Roots of the last step belong to a D that was off by 0.02.\n\n" + table(header, cells)
    )


def _spread(value: Spread, digits: int) -> str:
    return f"{value.median:.{digits}f} ({value.low:.{digits}f}..{value.high:.{digits}f})"


def _colour(law: Law) -> str:
    if law.key.startswith("LAMMPS"):
        return COLOURS["LAMMPS"]
    return COLOURS["stock" if not law.ours else "simplified" if law.key.startswith("jkr/simplified") else "full"]


def _draw_laws(results: Results) -> plt.Figure:
    laws = list(dict.fromkeys(law for law, _ in results.laws))
    figure, axes = plt.subplots(
        1, 2, figsize=(11, 0.32 * len(laws) + 1.2), sharey=True, sharex=True, layout="constrained"
    )
    for axis, mode in zip(axes, Mode, strict=True):
        for row, law in enumerate(reversed(laws)):
            if found := results.laws.get((law, mode)):
                cost = Spread.of([s.per_evaluation for s in found])
                error = [[cost.median - cost.low], [cost.high - cost.median]]
                axis.barh(row, cost.median, xerr=error, color=_colour(law), height=0.7, ecolor="black", capsize=2)
                axis.text(cost.high, row, f" {cost.median:.0f}", va="center", fontsize=8)
        axis.set_title(f"{mode.value} bed, {results.spheres:,} spheres", fontsize=10)
        axis.set_xlabel("pair time per contact [ns]")
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].set_yticks(range(len(laws)), [law.key for law in reversed(laws)], fontsize=8)
    axes[0].set_ylim(-0.6, len(laws) - 0.4)
    return figure


def _draw_growth(results: Results) -> plt.Figure:
    figure, axis = plt.subplots(figsize=(6, 4), layout="constrained")
    for law in dict.fromkeys(law for law, _ in results.growth):
        numbers = sorted(n for other, n in results.growth if other is law)
        costs = [Spread.of([s.per_evaluation for s in results.growth[law, n]]) for n in numbers]
        medians = [c.median for c in costs]
        error = [[c.median - c.low for c in costs], [c.high - c.median for c in costs]]
        axis.errorbar(numbers, medians, yerr=error, marker="o", capsize=3, color=_colour(law), label=law.key)
    axis.set_xscale("log")
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("spheres")
    axis.set_ylabel("pair time per contact [ns]")
    axis.legend(frameon=False, fontsize=8)
    axis.spines[["top", "right"]].set_visible(False)
    return figure


def _draw_solver(results: Results) -> plt.Figure:
    rows = sorted(results.solver, key=lambda row: row.latency_ns, reverse=True)
    figure, axis = plt.subplots(figsize=(8.5, 0.36 * len(rows) + 0.9), layout="constrained")
    for place, row in enumerate(rows):
        chosen = row.method.startswith("ours")
        axis.barh(place, row.latency_ns, color=COLOURS["full" if chosen else "stock"], height=0.7)
        axis.text(row.latency_ns, place, f" {row.latency_ns:.0f} ns, error of F {row.force_error:.0e}", va="center", fontsize=8)
    axis.set_yticks(range(len(rows)), [row.method for row in rows], fontsize=8)
    axis.set_xlim(0.0, 1.35 * rows[0].latency_ns)
    axis.set_xlabel("latency of u and F together [ns]; error over max(|F|, F$_C$)")
    axis.spines[["top", "right"]].set_visible(False)
    return figure
