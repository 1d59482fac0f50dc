"""Command line: what the verbs do. Results go to stdout, progress and messages to stderr.

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

from pyjkr import arguments as arguments_of
from pyjkr import resources, scaling
from pyjkr.errors import PyjkrError, RunError, SceneError, ToleranceError

SCENE_COPY = "scene.toml"
INTERRUPTED = 130


def main(words: Sequence[str] | None = None) -> int:
    """Run one verb; return the exit status."""
    options = arguments_of.parser(ACTIONS).parse_args(words)
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


def _path(name: str) -> Path:
    path = resources.scene_file(name)
    if not path.is_file() and path.suffix != ".toml":
        if name in resources.shipped_sweeps():
            raise SceneError(f"{name}: is a study of many points, not a scene. Type `pyjkr sweep {name}`.")
        known = ", ".join(resources.shipped_cases())
        raise SceneError(f"{name}: neither a scene file nor a shipped case. Shipped: {known}.")
    return path


def _many(name: str) -> Path | None:
    """Path of a scene of many particles; None where it is one of impacts."""
    from pyjkr.application.scene import is_application

    path = _path(name)
    return path if is_application(path) else None


def _load(name: str):
    from pyjkr.plan import plan
    from pyjkr.scene import load

    path = _path(name)
    if _many(name):
        raise SceneError(f"{path}: is a scene of many particles; this verb takes impacts of one pair. Use `pyjkr plan`, `deck` or `run`.")
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
    path = _many(options.scene)
    if path:
        from pyjkr.application import command

        command.run_plan(path, options)
        return
    for name in ("verify", "output"):
        if getattr(options, name):
            raise SceneError(f"{options.scene}: --{name} belongs to scenes of many particles; `pyjkr run` proves those of impacts.")
    from pyjkr import tables

    _, made = _load(options.scene)
    if options.explain or options.max_error_given:
        from pyjkr.planning import plan, table
        from pyjkr.planning.impact_scene import situation_of_impact

        best = plan.plan(situation_of_impact(made.scene), options.max_error)
        print(table.explain(best) if options.explain else table.text(best))
        return
    print(tables.plan_text(made))


def _refuse_max_error(options: argparse.Namespace) -> None:
    if options.max_error_given:
        raise SceneError(f"{options.scene}: a scene of impacts states its stiffness and steps itself; leave --max-error to `pyjkr plan`.")


def _deck(options: argparse.Namespace) -> None:
    path = _many(options.scene)
    if path:
        if options.case:
            raise SceneError(f"{path}: --case belongs to scenes of impacts; this one has one deck. Leave it out.")
        from pyjkr.application import command

        command.run_deck(path, options)
        return
    from pyjkr import deck

    _refuse_max_error(options)
    _, made = _load(options.scene)
    if options.explain:
        raise SceneError(f"{options.scene}: `pyjkr plan {options.scene} --explain` explains scenes of impacts.")
    if not options.output and not options.case:
        raise SceneError(f"{options.scene}: give -o DIR for all its decks, or --case LABEL for one of them.")
    if options.output:
        for case in made.cases:
            print(deck.write(case, made.scene, options.output / case.label))
        return
    labels = {case.label: case for case in made.cases}
    if options.case not in labels:
        raise SceneError(f"no case {options.case!r}. `pyjkr plan {options.scene}` lists them.")
    print(deck.render(labels[options.case], made.scene), end="")


def _run(options: argparse.Namespace) -> None:
    path = _many(options.scene)
    if path:
        from pyjkr.application import command

        command.run_run(path, options)
        return
    from pyjkr import campaign, progress, report
    from pyjkr.compare import compare, oracle_outcomes

    _refuse_max_error(options)
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
    from pyjkr.calibrate import measurements
    from pyjkr.compare import compare, oracle_outcomes

    copy = options.directory / SCENE_COPY
    if not copy.is_file():
        raise SceneError(f"{options.directory}: holds no {SCENE_COPY}, so `pyjkr run` has not been here. Run it with -o first.")
    measured = measurements.read(options.data) if options.data else None
    report.clear(options.directory)
    _, made = _load(str(copy))
    outcomes = campaign.collect(made, options.directory)
    _finish(compare(made, oracle_outcomes(made), outcomes), options.directory, measured)


def _finish(comparison, directory: Path, measured=None) -> None:
    from pyjkr import report, tables

    digest = hashlib.sha256((directory / SCENE_COPY).read_bytes()).hexdigest()
    report.write(comparison, directory, digest, measured)
    print(tables.comparison_text(comparison))
    print(f"pyjkr: wrote {directory / report.RESULT_NAME}", file=sys.stderr)
    if not comparison.passed:
        raise ToleranceError("outside tolerance; see the lines marked BAD")


def _cost(options: argparse.Namespace) -> None:
    if options.calibrate:
        _cost_model(options)
        return
    if not options.scene:
        raise SceneError("cost: give a SCENE, or --calibrate.")
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


def _cost_model(options: argparse.Namespace) -> None:
    from pyjkr.planning import cost_model, timing
    from pyjkr.progress import of_steps
    from pyjkr.run import find_simulator

    if options.scene:
        raise SceneError("cost: --calibrate measures this machine and takes no SCENE.")
    with of_steps("beds", not options.no_progress) as report:
        model = timing.calibrate(find_simulator(), report=report)
    print(cost_model.text(model))
    print(f"pyjkr: wrote {cost_model.store(model)}", file=sys.stderr)


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


def _calibrate(options: argparse.Namespace) -> None:
    from pyjkr.calibrate import command

    command.run_calibrate(options)


def _sweep(options: argparse.Namespace) -> None:
    from pyjkr.sweep import command

    command.run_sweep(options)


ACTIONS = {
    "scale": _scale, "plan": _plan, "deck": _deck, "run": _run, "compare": _compare, "calibrate": _calibrate,
    "sweep": _sweep, "cost": _cost,
}  # fmt: skip
