"""The verb `pyjkr calibrate`: arguments, and what is printed.

Covers no law. Results go to stdout, warnings to stderr.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pyjkr.calibrate import report
from pyjkr.calibrate.inversion import fit
from pyjkr.calibrate.measurements import read
from pyjkr.calibrate.particle import Particle

SUMMARY = "Find damping and surface energy that reproduce measured rebounds (Chen 2019, section 3)."
FILES = (
    "Reads a CSV file with the columns speed [m/s], restitution [-] and, where known, standard_deviation; a restitution of 0\n"
    "is a sphere that stuck. Writes DIR/result.json, calibration.csv (curve and band) and calibration.png, and a table to stdout."
)
EXAMPLE = "pyjkr calibrate rebounds.csv --diameter 1.27e-6 --density 1026 --modulus 271e6 --modulus-mod 27.1e6"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the verb."""
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


def run_calibrate(options: argparse.Namespace) -> None:
    """Calibrate, write the files, print the table.

    Raises
    ------
    CalibrationError
        Where the data or the particle make no sense.
    """
    particle = Particle(
        radius=options.radius if options.radius is not None else 0.5 * options.diameter,
        density=options.density,
        mass=options.mass,
        target=options.target,
        effective_modulus=options.modulus,
        effective_modulus_mod=options.modulus_mod,
    )
    found = fit(read(options.data), particle, options.law, confidence=options.confidence)
    for warning in found.warnings:
        print(f"pyjkr: warning: {warning}", file=sys.stderr)
    directory = options.output or Path("results") / f"{options.data.stem}-calibration"
    print(report.text(found))
    print(f"pyjkr: wrote {report.write(found, directory)}", file=sys.stderr)
