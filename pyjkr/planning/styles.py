"""Names for `pair_style gran` and `fix wall/gran`, and the properties they want: what is off is absent.

Covers the styles of this plug-in with adhesion, and stock `hertz`, `history`, `epsd2` without. Assumes one law for all contacts.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from pyjkr.planning.decision import Decision
from pyjkr.planning.situation import Effect


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
    def text(self) -> str:
        """Styles and keywords, as after `pair_style gran`."""
        return f"{self.pair} {self.keywords}".rstrip()

    @property
    def needs_friction(self) -> bool:
        """Whether the law reads coefficientFriction."""
        return self.tangential != "off" or self.twisting

    @property
    def properties(self) -> tuple[str, ...]:
        """Names of the `property/global` that the law reads; of rolling one of two, with Krijt's and with Chen's limit."""
        names = ["youngsModulus", "poissonsRatio", "coefficientRestitution"]
        names += ["coefficientFriction"] if self.needs_friction else []
        names += ["surfaceEnergy"] if self.normal != "hertz" else []
        names += ["surfaceEnergyOriginal", "youngsModulusOriginal"] if self.original_limits else []
        limits = {"krijt": "adhesionHysteresis|criticalRollingAngle", "epsd2": "coefficientRollingFriction"}
        return (*names, *(limits[self.rolling_friction],)) if self.rolling_friction in limits else tuple(names)


def of_effects(on: Collection[Effect]) -> Styles:
    """The contact law that simulates some effects and no others; what needs adhesion is off without it.

    Parameters
    ----------
    on : collection of str
        Effects, by their names in `situation.EFFECTS`.
    """
    adhesion, sliding, rolling = (effect in on for effect in ("adhesion", "sliding", "rolling"))
    return Styles(
        normal=("jkr" if "neck" in on else "jkr/simplified") if adhesion else "hertz",
        tangential=("jkr" if adhesion and "sliding_adhesion" in on else "history") if sliding else "off",
        rolling_friction=("krijt" if adhesion else "epsd2") if rolling else "off",
        twisting=adhesion and rolling and "twisting" in on,
        original_limits=adhesion and "original_limits" in on,
        damping="damping" in on,
        gravity="gravity" in on,
    )


def styles(decisions: Collection[Decision]) -> Styles:
    """The contact law of a set of decisions, as `effects.decide` makes them."""
    return of_effects([decision.effect for decision in decisions if decision.on])
