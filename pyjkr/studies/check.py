"""What a study's figure must show, and whether it does."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One number that decides whether a figure is right.

    Parameters
    ----------
    name
        What is looked at.
    measured
        What came out.
    wanted
        What it must be, in words, with its tolerance.
    holds
        Whether it is.
    """

    name: str
    measured: float | str
    wanted: str
    holds: bool
