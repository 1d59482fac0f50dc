"""The exceptions of pyjkr: one class per stage of the flow, each with the exit status of the command line.

The message of each says where, what and how to fix it; see `docs/design.md` for the rooms that raise them.
"""


class PyjkrError(Exception):
    """Anything a user of pyjkr can put right."""

    exit_code = 3


class SceneError(PyjkrError):
    """A scene file that cannot be read, or that asks for something unphysical."""

    exit_code = 2


class PlanError(PyjkrError):
    """A scene for which no sensible time step, start position or output can be planned."""

    exit_code = 2


class DumpError(PyjkrError):
    """A file of simulator output that is missing, cut short, damaged or full of NaN."""

    exit_code = 3


class RunError(PyjkrError):
    """A simulator that is not installed, or a run that failed."""

    exit_code = 3


class ToleranceError(PyjkrError):
    """A result outside the tolerance it was asked to meet."""

    exit_code = 1
