"""One decision of a plan: what was looked at, its number, the threshold, and what follows."""

from __future__ import annotations

from dataclasses import dataclass

from pyjkr.planning.situation import Effect


@dataclass(frozen=True, kw_only=True)
class Decision:
    """Whether an effect is simulated, and why.

    Attributes
    ----------
    effect : str
        One of `situation.EFFECTS`.
    on : bool
        Whether the deck simulates it.
    number, threshold : float
        What decides: on where number > threshold, unless forced.
    measure : str
        What the number is, in words: "energy lost in the neck / impact energy".
    formula, source : str
        How the number was found, and where that is from (paper and equation).
    where : str
        Label of the meeting that decided.
    forced : bool
        The user's wish, against or with the number.
    """

    effect: Effect
    on: bool
    number: float
    threshold: float
    measure: str
    formula: str
    source: str
    where: str = ""
    forced: bool = False


@dataclass(frozen=True, kw_only=True)
class Limit:
    """One limit on how soft the material may be made.

    Attributes
    ----------
    name : str
        What is limited: "overlap in impacts", "pull-off against external force".
    smallest_ratio : float
        Smallest E_mod/E that keeps it; 0 where it does not bind, above 1 where even the real material breaks it.
    estimate : str
        The error or number at that ratio, in words.
    formula, source : str
        As in `Decision`.
    """

    name: str
    smallest_ratio: float
    estimate: str
    formula: str
    source: str
