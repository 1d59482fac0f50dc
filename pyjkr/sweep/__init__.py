"""Sweeps: a study evaluated at many points, on all cores or on a cluster, each finished point kept at once.

`load` reads and validates the file, `execute` evaluates what is missing, `report` writes table, checks and figures.
"""

from pyjkr.sweep.executing import Execution, execute
from pyjkr.sweep.file import Sweep, load, sweep_file
from pyjkr.sweep.report import Report, report

__all__ = ["Execution", "Report", "Sweep", "execute", "load", "report", "sweep_file"]
