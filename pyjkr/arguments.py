"""Arguments of the command line: what each verb takes, and what its help says it reads and writes.

Imports nothing heavy, so that help and slips of the finger are answered at once.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

from pyjkr import resources

FORMAT = argparse.RawDescriptionHelpFormatter
Verb = tuple[str, argparse.ArgumentParser]


def parser(actions: Mapping[str, Callable[[argparse.Namespace], None]]) -> argparse.ArgumentParser:
    """The parser of `pyjkr`.

    Parameters
    ----------
    actions : mapping
        What each verb does, by its name.
    """
    made = argparse.ArgumentParser(
        prog="pyjkr",
        formatter_class=FORMAT,
        description="Adhesive impacts of small spheres at reduced stiffness: plans, LIGGGHTS decks, runs, comparison.",
        epilog="SCENE is a TOML file, or the name of a shipped case: " + ", ".join(resources.shipped_cases())
        + ".\nSWEEP is a TOML file, or a case with a study: " + ", ".join(resources.shipped_sweeps())
        + ".\n\nexample:\n  pyjkr run dahneke -o results/dahneke",
    )  # fmt: skip
    verbs = made.add_subparsers(title="verbs", metavar="VERB", required=True)
    for add in (_add_scale, _add_plan, _add_deck, _add_run, _add_compare, _add_calibrate, _add_sweep, _add_cost):
        name, verb = add(verbs)
        verb.set_defaults(verb=actions[name])
    return made


def _verb(verbs, name: str, summary: str, files: str, example: str) -> argparse.ArgumentParser:
    return verbs.add_parser(
        name, help=summary, formatter_class=FORMAT, description=f"{summary}\n\n{files}", epilog=f"example:\n  {example}"
    )


def _add_scale(verbs) -> Verb:
    parser = _verb(
        verbs, "scale", "Print the surface energy to use at a reduced stiffness (Haervig 2017, eq. 24).",
        "Reads a scene file, or the options; writes a table to stdout.",
        "pyjkr scale --modulus 271e6 --surface-energy 0.11 --ratio 0.1 0.01",
    )  # fmt: skip
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="take the values from a scene")
    parser.add_argument("--modulus", type=float, metavar="E", help="effective Young's modulus [Pa]")
    parser.add_argument("--surface-energy", type=float, metavar="GAMMA", help="surface energy of one surface [J/m2]")
    parser.add_argument("--ratio", type=float, nargs="+", metavar="Q", help="E_mod/E")
    return "scale", parser


def _add_plan(verbs) -> Verb:
    parser = _verb(
        verbs, "plan", "Decide what to simulate: effects, stiffness, time step; for impacts, cases and overlaps.",
        "Reads the scene; writes tables to stdout. Of a scene of many particles it decides on everything that the scene leaves\n"
        "open, writes the deck that runs, plan.txt and plan-explained.txt to DIR, and with --verify runs probes of the scene at\n"
        "the planned and at the real stiffness (DIR/verify/, DIR/verification.json). Exit status 1 where one exceeds the limit.",
        "pyjkr plan ash_on_tube --max-error 1%",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    _add_max_error(parser)
    parser.add_argument("--explain", action="store_true", help="print every derived number with its formula and source")
    parser.add_argument("--verify", action="store_true", help="measure the error and the time saved in small runs of LIGGGHTS")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the scene>-plan")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")
    return "plan", parser


def _add_deck(verbs) -> Verb:
    parser = _verb(
        verbs, "deck", "Render the LIGGGHTS decks of a scene.",
        "Reads the scene; writes DIR/<case>/in.deck and prints their paths, or with --case prints one deck. Of a scene of many\n"
        "particles there is one deck, DIR/in.deck with what it reads; without -o it goes to stdout.",
        "pyjkr deck dahneke --case 5.0mps_q0.1_scaled",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    target = parser.add_mutually_exclusive_group()
    target.add_argument("-o", "--output", type=Path, metavar="DIR", help="write all decks here")
    target.add_argument("--case", metavar="LABEL", help="print the deck of one case, as `pyjkr plan` names it")
    _add_max_error(parser)
    parser.add_argument("--explain", action="store_true", help="print every derived number of the plan to stderr")
    return "deck", parser


def _add_run(verbs) -> Verb:
    parser = _verb(
        verbs, "run", "Run every case of a scene and compare it with the oracle.",
        "Reads the scene; writes DIR/<case>/ (deck, log, dump), DIR/result.json, table.csv, table.txt and PNG figures,\n"
        "and the table to stdout. Finished cases are not run again. Exit status 1 where a tolerance is exceeded.\n"
        "A scene of many particles is planned and run; it writes DIR/in.deck, dumps, evolution.csv, picture.png, result.json.",
        "pyjkr run dahneke -o results/dahneke",
    )  # fmt: skip
    parser.add_argument("scene", metavar="SCENE")
    _add_max_error(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the scene>")
    parser.add_argument("--engine", choices=("liggghts", "oracle"), help="default: liggghts where it is found, else oracle")
    parser.add_argument("--np", type=_count, default=1, metavar="N", help="MPI processes (default: 1)")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")
    parser.add_argument("--dry-run", action="store_true", help="print decks and commands, run nothing, write nothing")
    return "run", parser


def _add_compare(verbs) -> Verb:
    parser = _verb(
        verbs, "compare", "Compare finished runs with the oracle once more.",
        "Reads DIR/scene.toml and the dumps in DIR, as `pyjkr run` left them; writes the result files anew,\n"
        "and the table to stdout.",
        "pyjkr compare results/dahneke",
    )  # fmt: skip
    parser.add_argument("directory", type=Path, metavar="DIR")
    parser.add_argument("--data", type=Path, metavar="FILE", help="measured points (CSV: speed,restitution) to draw beside the model")
    return "compare", parser


def _add_calibrate(verbs) -> Verb:
    parser = _verb(
        verbs, "calibrate", "Find damping and surface energy that reproduce measured rebounds (Chen 2019, section 3).",
        "Reads a CSV file with the columns speed [m/s], restitution [-] and, where known, standard_deviation; a restitution of 0\n"
        "is a sphere that stuck; writes DIR/result.json, calibration.csv (curve and band) and calibration.png, and a table to stdout.",
        "pyjkr calibrate rebounds.csv --diameter 1.27e-6 --density 1026 --modulus 271e6 --modulus-mod 27.1e6",
    )  # fmt: skip
    parser.add_argument("data", type=Path, metavar="DATA", help="CSV file: speed,restitution[,standard_deviation]")
    size = parser.add_mutually_exclusive_group(required=True)
    size.add_argument("--radius", type=float, metavar="R", help="radius of the sphere [m]")
    size.add_argument("--diameter", type=float, metavar="D", help="diameter of the sphere [m]")
    weight = parser.add_mutually_exclusive_group(required=True)
    weight.add_argument("--density", type=float, metavar="RHO", help="density of the sphere [kg/m3]")
    weight.add_argument("--mass", type=float, metavar="M", help="mass of the sphere [kg]")
    parser.add_argument("--target", choices=("wall", "sphere"), default="wall", help="what it meets: a wall (default) or its like")
    parser.add_argument("--law", choices=("jkr", "jkr/simplified"), default="jkr", help="contact law (default: jkr)")
    parser.add_argument("--modulus", type=float, metavar="E", help="effective Young's modulus of the pair [Pa]: names gamma")
    parser.add_argument("--modulus-mod", type=float, metavar="E_MOD", help="modulus of the simulation [Pa]: names gamma_mod")
    parser.add_argument("--confidence", type=float, default=0.99, metavar="P", help="that all intervals hold together (default: 0.99)")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of DATA>-calibration")
    return "calibrate", parser


def _add_sweep(verbs) -> Verb:
    parser = _verb(
        verbs, "sweep", "Evaluate a study at many points: the figures of the papers, or a scene of your own.",
        "Reads a sweep file (TOML), or that of a shipped case; writes DIR/table.csv, PNG figures, result.json, what each point\n"
        "leaves behind (decks, logs, dumps) in DIR/points/, and the checks to stdout. Finished points are kept at once and not\n"
        "evaluated again: after Ctrl-C or a failure the same command goes on. With --scheduler the workers of a Dask cluster\n"
        "evaluate the points; they need pyjkr and LIGGGHTS of the same versions. Rows come back to DIR, while decks, logs and\n"
        "dumps stay on the machine of the worker, in a directory of the same name; Ctrl-C lets points end that it has begun.\n"
        "Exit status 1 where a check does not hold, 3 where a point failed: then there is no table, no figure and no result.json.",
        "pyjkr sweep haervig_fig12 -o results/haervig_fig12",
    )  # fmt: skip
    parser.add_argument("sweep", metavar="SWEEP", help="a TOML file, or the name of a shipped case that has a sweep.toml")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the sweep>")
    parser.add_argument("--workers", type=_count, metavar="N", help="processes on this machine (default: one per core)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786, in place of --workers")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")
    return "sweep", parser


def _add_cost(verbs) -> Verb:
    parser = _verb(
        verbs, "cost", "Measure what accuracy costs in time: steps, event correction, stiffness, effects.",
        "Reads the scene; runs LIGGGHTS many times and writes DIR/cost.csv, cost.json, PNG figures, the runs in DIR/runs/,\n"
        "and tables to stdout. Finished runs are not repeated. Exit status 1 where a promised accuracy is missed.",
        "pyjkr cost dahneke --quick -o results/dahneke-cost",
    )  # fmt: skip
    parser.add_argument("scene", nargs="?", metavar="SCENE")
    parser.add_argument("--calibrate", action="store_true", help="measure what LIGGGHTS costs on this machine, for the estimates of plan")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: results/<name of the scene>-cost")
    parser.add_argument("--quick", action="store_true", help="fewer phases, steps, speeds and repetitions")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write a Markdown page too, figures in figures/ beside it")
    parser.add_argument("--no-progress", action="store_true", help="no progress bar; it is shown on a terminal only")
    return "cost", parser


class _MaxError(argparse.Action):
    """Keeps that it was given: scenes of impacts are planned only then."""

    def __call__(self, parser, namespace, values, option_string=None) -> None:
        namespace.max_error, namespace.max_error_given = values, True


def _add_max_error(parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(max_error_given=False)
    parser.add_argument(
        "--max-error", type=_part, default=0.05, action=_MaxError, metavar="X",
        help="largest error of the result, such as 1%% or 0.01 (default: 5%%); of scenes of many particles",
    )  # fmt: skip


def _part(text: str) -> float:
    try:
        return float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} must be a number such as 0.01, or 1%") from None


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} must be a whole number >= 1")
    return int(text)
