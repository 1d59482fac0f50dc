"""The verb `pyjkr calibrate`: what is computed, written and printed.

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
