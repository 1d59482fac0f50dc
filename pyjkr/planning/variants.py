"""The ways in which a scene can be run: as planned, unreduced at 50 steps a collision, and as a fine reference.

Covers Haervig 2017, eq. 24 (softened surface energy) and the contract's style names. In "unreduced" and "reference" every effect is on
that the scene has the properties for; what the user switched off is off in "unreduced", which a speed-up is counted against, and on
in "reference", which is to show what it does. Assumes SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pyjkr import scaling, timestep
from pyjkr.contact import PairProperties, maximum_contact_radius
from pyjkr.planning.plan import ApplicationPlan
from pyjkr.planning.situation import Effect, Meeting, Situation
from pyjkr.planning.styles import Styles, of_effects

# Steps of a collision in an ordinary, unreduced simulation: what a plan's speed-up is counted against.
UNREDUCED_STEPS = 50
# And in the reference, whose error is some hundred times below that of 20 steps (docs/accuracy-and-cost.md).
REFERENCE_STEPS = 400
# Time steps of the reference in the shortest period of any mode, at least.
REFERENCE_RESOLUTION = 100


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One way to run a scene.

    Attributes
    ----------
    name : str
        "planned", "unreduced" or "reference".
    effects : frozenset
        What is on.
    modulus_ratio : float
        q = E_mod/E.
    styles : Styles
        Contact law.
    time_step : float
        [s].
    """

    name: str
    effects: frozenset[Effect]
    modulus_ratio: float
    styles: Styles
    time_step: float

    def pair(self, meeting: Meeting) -> PairProperties:
        """Properties of a meeting's contact in the normal law: softened, without what is off."""
        real, q = meeting.pair, self.modulus_ratio
        energy = scaling.surface_energy_mod(real.surface_energy, q) if "adhesion" in self.effects else 0.0
        kept = "original_limits" in self.effects and energy > 0
        return replace(
            real,
            effective_modulus=q * real.effective_modulus,
            effective_shear_modulus=q * real.effective_shear_modulus,
            surface_energy=energy,
            surface_energy_of_rolling=real.surface_energy if kept else energy,
            restitution_coefficient=real.restitution_coefficient if "damping" in self.effects else 1.0,
        )


def planned(plan: ApplicationPlan) -> Variant:
    """The variant of a plan."""
    return Variant(
        name="planned",
        effects=frozenset(decision.effect for decision in plan.decisions if decision.on),
        modulus_ratio=plan.modulus_ratio,
        styles=plan.styles,
        time_step=plan.time_step,
    )


def unreduced(situation: Situation) -> Variant:
    """Real stiffness, all effects but those that the user switched off, 50 steps in the shortest collision."""
    return _real(all_effects(situation), "unreduced", shortest_collision(situation) / UNREDUCED_STEPS)


def reference(situation: Situation, meeting: Meeting) -> Variant:
    """Real stiffness, all effects, 400 steps in the shortest collision of a meeting, 100 in the shortest period of any mode.

    Also those that the user switched off: what they would do is the error of leaving them out.
    """
    periods = fastest_periods(meeting.pair, meeting)
    step = min(timestep.collision_time(meeting.pair, meeting.speed) / REFERENCE_STEPS, min(periods) / REFERENCE_RESOLUTION)
    effects = all_effects(replace(situation, meetings=(meeting,), wishes={}))
    variant = _real(effects, "reference", step)
    # Event correction keeps the reference second order without adhesion too: gamma = 0 is Hertz to round-off.
    return variant if "adhesion" in effects else replace(variant, styles=replace(variant.styles, normal="jkr/simplified"))


def shortest_collision(situation: Situation) -> float:
    """Shortest collision time [s] of the real material: Hertz' or the period of the stuck pair, at the fastest approach."""
    return min(timestep.collision_time(meeting.pair, meeting.speed) for meeting in situation.meetings)


def fastest_periods(pair: PairProperties, meeting: Meeting) -> tuple[float, ...]:
    """Periods [s] of every mode of a contact that is pressed by a meeting's fastest impact."""
    radius = maximum_contact_radius(pair, meeting.speed)
    masses = tuple(4 / 3 * math.pi * density * r**3 for density, r in zip(meeting.densities, meeting.radii, strict=True))
    share = timestep.spin_share(meeting.radii, masses)
    modes = [timestep.normal_period(pair, radius), timestep.sliding_period(pair, radius), timestep.twisting_period(pair, radius)]
    return (*modes, timestep.rolling_period(pair, radius, share))


def all_effects(situation: Situation) -> frozenset[Effect]:
    """Effects of the real scene: what its properties allow, less what the user switched off. Originals are the values themselves."""
    rolls = any(meeting.pair.surface_energy > 0 and math.isfinite(meeting.critical_rolling) for meeting in situation.meetings)
    adhesive = any(meeting.pair.surface_energy > 0 for meeting in situation.meetings)
    possible: dict[Effect, bool] = {
        "adhesion": adhesive,
        "neck": adhesive,
        "sliding": True,
        "sliding_adhesion": adhesive,
        "rolling": rolls,
        "twisting": rolls,
        "damping": True,
        "gravity": situation.gravity > 0,
    }
    return frozenset(effect for effect, there in possible.items() if there and situation.wishes.get(effect) != "off")


def _real(effects: frozenset[Effect], name: str, time_step: float) -> Variant:
    return Variant(name=name, effects=effects, modulus_ratio=1.0, styles=of_effects(effects), time_step=time_step)
