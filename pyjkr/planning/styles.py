"""Names for `pair_style gran` and `fix wall/gran`, and the properties they want: what is off is absent.

Covers the styles of this plug-in with adhesion, and stock `hertz`, `history`, `epsd2` without. Assumes one law for all contacts.
"""

from __future__ import annotations

from dataclasses import dataclass

from pyjkr.planning.decision import Decision
from pyjkr.planning.effects import on


@dataclass(frozen=True, kw_only=True)
class Styles:
    """Contact law of a deck.

    Attributes
    ----------
    normal, tangential, rolling_friction : str
        Names; "off" for none.
    twisting, original_limits, damping, gravity : bool
        Whether the deck has them.
    """

    normal: str
    tangential: str
    rolling_friction: str
    twisting: bool
    original_limits: bool
    damping: bool
    gravity: bool

    @property
    def pair(self) -> str:
        """Styles as after `pair_style gran`."""
        words = ["model", self.normal]
        words += ["tangential", self.tangential] if self.tangential != "off" else []
        words += ["rolling_friction", self.rolling_friction] if self.rolling_friction != "off" else []
        return " ".join(words)

    @property
    def keywords(self) -> str:
        """Keywords behind the styles."""
        return "twisting on" if self.twisting else ""

    @property
    def properties(self) -> tuple[str, ...]:
        """Names of the `property/global` that the law reads; of rolling one of two, with Krijt's and with Chen's limit."""
        names = ["youngsModulus", "poissonsRatio", "coefficientRestitution"]
        names += ["coefficientFriction"] if self.tangential != "off" or self.twisting else []
        names += ["surfaceEnergy"] if self.normal != "hertz" else []
        names += ["surfaceEnergyOriginal", "youngsModulusOriginal"] if self.original_limits else []
        limits = {"krijt": "adhesionHysteresis|criticalRollingAngle", "epsd2": "coefficientRollingFriction"}
        return (*names, *(limits[self.rolling_friction],)) if self.rolling_friction in limits else tuple(names)


def styles(decisions: tuple[Decision, ...]) -> Styles:
    """The contact law of a set of decisions.

    Parameters
    ----------
    decisions : tuple of Decision
        From `effects.decide`.
    """
    adhesion = on(decisions, "adhesion")
    normal = ("jkr" if on(decisions, "neck") else "jkr/simplified") if adhesion else "hertz"
    sliding = "jkr" if on(decisions, "sliding_adhesion") else "history"
    rolling = "krijt" if adhesion else "epsd2"
    return Styles(
        normal=normal,
        tangential=sliding if on(decisions, "sliding") else "off",
        rolling_friction=rolling if on(decisions, "rolling") else "off",
        twisting=on(decisions, "twisting"),
        original_limits=on(decisions, "original_limits"),
        damping=on(decisions, "damping"),
        gravity=on(decisions, "gravity"),
    )
