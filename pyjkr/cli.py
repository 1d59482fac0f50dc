"""Command line: arguments and dispatch. Results go to stdout, progress and messages to stderr.

Exit status: 0 done, 1 outside tolerance, 2 usage or scene, 3 simulator failed, 130 interrupted.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from pyjkr import resources, scaling
from pyjkr.errors import PyjkrError, RunError, SceneError, ToleranceError

SCENE_COPY = "scene.toml"
INTERRUPTED = 130
FORMAT = argparse.RawDescriptionHelpFormatter


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb; return the exit status."""
    options = _parser().parse_args(arguments)
    try:
        options.verb(options)
        sys.stdout.flush()
    except PyjkrError as error:
        print(f"pyjkr: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print("pyjkr: interrupted; the same command goes on where this one stopped", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader, `head` for one, has enough; keep Python from complaining at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        # A disk that is full, a directory that may not be written.
        where = f"{error.filename}: " if error.filename else ""
        print(f"pyjkr: {where}{error.strerror or error}. Choose another directory with -o, or make room.", file=sys.stderr)
        return RunError.exit_code
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pyjkr",
        formatter_class=FORMAT,
        description="Adhesive impacts of small spheres at reduced stiffness: plans, LIGGGHTS decks, runs, comparison.",
        epilog="SCENE is a TOML file, or the name of a shipped case: " + ", ".join(resources.shipped_cases())
        + ".\n\nexample:\n  pyjkr run dahneke -o results/dahneke",
    )  # fmt: skip
    verbs = parser.add_subparsers(title="verbs", metavar="VERB", required=True)
    _add_scale(verbs)
    _add_plan(verbs)
    _add_deck(verbs)
    _add_run(verbs)
    _add_compare(verbs)
    _add_cost(verbs)
    return parser


def _add(verbs, name: str, action, summary: str, files: str, example: str) -> argparse.ArgumentParser:
    parser = verbs.add_parser(
        name, help=summary, formatter_class=FORMAT, description=f"{summary}\n\n{files}", epilog=f"example:\n  {example}"
    )
    parser.set_defaults(verb=action)
    return parser


def _add_scale(verbs) -> None:
    parser = _add(
        verbs, "scale", _scale, "Print the surface energy to use at a reduced stiffness (Haervig 2017, eq. 24).",
        "Reads a scene file, or the options; writes a table to stdout.",
        "pyjkr scale --modulus 271e6 --surface-energy 0.11 --ratio 0.1 0.01",
    )  # fmt: skip
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="take the values from a scene")
    parser.add_argument("--modulus", type=float, metavar="E", help="effective Young's modulus [Pa]")
    parser.add_argument("--surface-energy", type=float, metavar="GAMMA", help="surface energy of one surface [J/m2]")
    parser.add_argument("--ratio", type=float, nargs="+", metavar="Q", help="E_mod/E")


def _add_plan(verbs) -> None:
    parser = _add(
        verbs, "plan", _plan, "Print what would be simulated: cases, time steps, overlaps, warnings.",
        "Reads the scene; writes a table to stdout.", "pyjkr plan dahneke",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")


def _add_deck(verbs) -> None:
    parser = _add(
        verbs, "deck", _deck, "Render the LIGGGHTS decks of a scene.",
        "Reads the scene; writes DIR/<case>/in.deck and prints their paths, or with --case prints one deck.",
        "pyjkr deck dahneke --case 5.0mps_q0.1_scaled",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("-o", "--output", type=Path, metavar="DIR", help="write all decks here")
    target.add_argument("--case", metavar="LABEL", help="print the deck of one case, as `pyjkr plan` names it")


def _add_run(verbs) -> None:
    parser = _add(
        verbs, "run", _run, "Run every case of a scene and compare it with the oracle.",
        "Reads the scene; writes DIR/<case>/ (deck, log, dump), DIR/result.json, table.csv, table.txt and PNG figures,\n"
        "and the table to stdout. Finished cases are not run again. Exit status 1 where a tolerance is exceeded.",
        "pyjkr run dahneke -o results/dahneke",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the scene>")
    parser.add_argument("--engine", choices=("liggghts", "oracle"), help="default: liggghts where it is found, else oracle")
    parser.add_argument("--np", type=_ranks, default=1, metavar="N", help="MPI processes (default: 1)")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")
    parser.add_argument("--dry-run", action="store_true", help="print decks and commands, run nothing, write nothing")


def _add_compare(verbs) -> None:
    parser = _add(
        verbs, "compare", _compare, "Compare finished runs with the oracle once more.",
        "Reads DIR/scene.toml and the dumps in DIR, as `pyjkr run` left them; writes the result files anew,\n"
        "and the table to stdout.",
        "pyjkr compare results/dahneke",
    )  # fmt: skip
    parser.add_argument("directory", type=Path, metavar="DIR")


def _add_cost(verbs) -> None:
    parser = _add(
        verbs, "cost", _cost, "Measure what accuracy costs in time: steps, event correction, stiffness, effects.",
        "Reads the scene; runs LIGGGHTS many times and writes DIR/cost.csv, cost.json, PNG figures, the runs in DIR/runs/,\n"
        "and tables to stdout. Finished runs are not repeated. Exit status 1 where a promised accuracy is missed.",
        "pyjkr cost dahneke --quick -o results/dahneke-cost",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the scene>-cost")
    parser.add_argument("--quick", action="store_true", help="fewer phases, steps, speeds and repetitions")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write a Markdown page too, figures in figures/ beside it")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")


def _ranks(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} must be a whole number >= 1")
    return int(text)


def _load(name: str):
    from pyjkr.plan import plan
    from pyjkr.scene import load

    path = resources.scene_file(name)
    if not path.is_file() and path.suffix != ".toml":
        known = ", ".join(resources.shipped_cases())
        raise SceneError(f"{name}: neither a scene file nor a shipped case. Shipped: {known}.")
    scene = load(path)
    try:
        made = plan(scene)
    except (OverflowError, ZeroDivisionError) as error:
        raise SceneError(f"{path}: its numbers lead beyond what can be computed ({error}). Look for a slip in an exponent.") from None
    for warning in made.warnings:
        print(f"pyjkr: warning: {warning}", file=sys.stderr)
    return path, made


def _scale(options: argparse.Namespace) -> None:
    given = (options.modulus, options.surface_energy)
    if options.scene:
        if any(value is not None for value in given):
            raise SceneError("scale: give either SCENE or --modulus and --surface-energy, not both.")
        _, made = _load(options.scene)
        pair = made.cases[0].original
        modulus, energy = pair.effective_modulus, pair.surface_energy
        ratios = options.ratio or made.scene.reduction.modulus_ratios
    else:
        if any(value is None for value in (*given, options.ratio)):
            raise SceneError("scale: give SCENE, or all of --modulus, --surface-energy and --ratio.")
        modulus, energy, ratios = *given, options.ratio
    if not (0 < modulus < float("inf") and 0 <= energy < float("inf") and all(0 < ratio < float("inf") for ratio in ratios)):
        raise SceneError("scale: --modulus and --ratio must be > 0, --surface-energy >= 0, all finite.")
    print("   E_mod/E    E_mod [Pa]  gamma_mod [J/m2]     times   lengths    forces")
    for ratio in ratios:
        print(
            f"{ratio:10.4g}{ratio * modulus:14.6g}{scaling.surface_energy_mod(energy, ratio):18.6g}"
            f"{scaling.time_factor(ratio):10.4f}{scaling.length_factor(ratio):10.4f}{scaling.force_factor(ratio):10.4f}"
        )


def _plan(options: argparse.Namespace) -> None:
    from pyjkr import tables

    _, made = _load(options.scene)
    print(tables.plan_text(made))


def _deck(options: argparse.Namespace) -> None:
    from pyjkr import deck

    _, made = _load(options.scene)
    if options.output:
        for case in made.cases:
            print(deck.write(case, made.scene, options.output / case.label))
        return
    labels = {case.label: case for case in made.cases}
    if options.case not in labels:
        raise SceneError(f"no case {options.case!r}. `pyjkr plan {options.scene}` lists them.")
    print(deck.render(labels[options.case], made.scene), end="")


def _run(options: argparse.Namespace) -> None:
    from pyjkr import campaign, progress, report
    from pyjkr.compare import compare, oracle_outcomes

    path, made = _load(options.scene)
    directory = options.output or Path("results") / (path.parent.name if path.name == SCENE_COPY else path.stem)
    simulator = _simulator(options.engine, options.dry_run)
    if options.dry_run:
        _dry_run(made, directory, simulator, options.np)
        return
    directory.mkdir(parents=True, exist_ok=True)
    report.clear(directory)
    if path.resolve() != (directory / SCENE_COPY).resolve():
        shutil.copyfile(path, directory / SCENE_COPY)
    outcomes = None
    if simulator:
        with progress.of_plan(made, not options.no_progress) as cases:
            outcomes = campaign.execute(made, directory, simulator, ranks=options.np, watcher=cases)
    _finish(compare(made, oracle_outcomes(made), outcomes), directory)


def _compare(options: argparse.Namespace) -> None:
    from pyjkr import campaign, report
    from pyjkr.compare import compare, oracle_outcomes

    copy = options.directory / SCENE_COPY
    if not copy.is_file():
        raise SceneError(f"{options.directory}: holds no {SCENE_COPY}, so `pyjkr run` has not been here. Run it with -o first.")
    _, made = _load(str(copy))
    outcomes = campaign.collect(made, options.directory)
    report.clear(options.directory)
    _finish(compare(made, oracle_outcomes(made), outcomes), options.directory)


def _finish(comparison, directory: Path) -> None:
    from pyjkr import report, tables

    digest = hashlib.sha256((directory / SCENE_COPY).read_bytes()).hexdigest()
    report.write(comparison, directory, digest)
    print(tables.comparison_text(comparison))
    print(f"pyjkr: wrote {directory / report.RESULT_NAME}", file=sys.stderr)
    if not comparison.passed:
        raise ToleranceError("outside tolerance; see the lines marked BAD")


def _cost(options: argparse.Namespace) -> None:
    from pyjkr.cost import command, report, tables

    path, made = _load(options.scene)
    directory = options.output or Path("results") / f"{command.scene_name(path)}-cost"
    costs = command.run(
        made.scene, path, directory, quick=options.quick, progress=not options.no_progress, page_file=options.page
    )
    print(tables.text(costs))
    print(f"pyjkr: wrote {directory / report.RESULT_NAME}", file=sys.stderr)
    if not costs.passed:
        raise ToleranceError("outside tolerance; see the lines marked BAD")


def _simulator(engine: str | None, dry_run: bool):
    """The simulator to use; None for the oracle."""
    from pyjkr.run import find_simulator

    if engine == "oracle":
        return None
    try:
        return find_simulator()
    except RunError as error:
        if engine == "liggghts" and not dry_run:
            raise
        print(f"pyjkr: {error}\npyjkr: going on with --engine oracle", file=sys.stderr)
        return None


def _dry_run(made, directory: Path, simulator, ranks: int) -> None:
    from pyjkr import deck

    program = str(simulator.executable) if simulator else "liggghts-jkr"
    launch = f"mpirun -np {ranks} " if ranks > 1 else ""
    for case in made.cases:
        print(f"# cd '{directory / case.label}' && {launch}{program} -in {deck.DECK_NAME}")
        print(deck.render(case, made.scene))
