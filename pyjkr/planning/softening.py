"""How soft the material may be made: limits on q = E_mod/E with gamma_mod = gamma q^(2/5), each with formula and source.

Covers Haervig 2017 eq. 24 and secs 3.2 and 6, Chen 2019 eqs 10-12 and 16-17: what is not similar, what outer forces do, how deep
contacts press. Half of `max_error` goes into what softening changes. Assumes one q for all materials.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.optimize import brentq

from pyjkr import contact as contact_laws
from pyjkr import scaling
from pyjkr.limits import NEGLIGIBLE_FRACTION
from pyjkr.planning import collisions, oblique, steps
from pyjkr.planning.budget import SOFTENING_SHARE
from pyjkr.planning.decision import Decision, Limit
from pyjkr.planning.effects import on
from pyjkr.planning.measures import lasts
from pyjkr.planning.situation import Meeting, Situation

# Below it adhesion of dense systems may change; Haervig 2017, sec. 6.
DENSE_RATIO = 1e-3
# Part of the volume strain: three directions.
DIRECTIONS = 3
# Contacts that an agglomerate loses more or less by softening, in parts of all: per 1 - q^(2/5), which resistance to sliding and
# rolling loses while fragments rearrange, and the square of the energy of a radius of sliding over that of the impact; and per
# strain of the whole body by deeper overlaps. From ensembles of runs, docs/break-up.md.
LOST_RESISTANCE, MOST_LOST, BODY_STRAIN = 0.012, 0.15, 0.03
# Just above a jump of an estimate.
ROUND_OFF = 1e-6
# Lowest ratio looked for.
LOWEST = 1e-12


def limits(situation: Situation, decisions: tuple[Decision, ...], max_error: float) -> tuple[Limit, ...]:
    """Every limit on the softening of a situation.

    Parameters
    ----------
    situation, decisions
        What may happen, what is simulated.
    max_error : float
        Of the result, as in `effects.decide`.
    """
    allowed = SOFTENING_SHARE * max_error
    found = [_normal_impacts(decisions), _oblique_impacts(situation, decisions, allowed), _overlap_in_impacts(situation, decisions)]
    if lasts(situation):
        found.append(_overlap_at_rest(situation, decisions, allowed))
    found.append(_force_in_impacts(situation, decisions, allowed))
    if on(decisions, "adhesion"):
        found += [_tabor(situation), _pull_off(situation, decisions)]
        if lasts(situation) and not on(decisions, "original_limits") and situation.about != "impact":
            found.append(_scaled_strength(decisions, allowed))
    if situation.many_contacts and lasts(situation):
        found.append(
            Limit(
                name="many contacts at a time", smallest_ratio=DENSE_RATIO, estimate="adhesion of dense systems kept down to it",
                formula="q >= 1e-3", source="Haervig 2017, sec. 6",
            )
        )  # fmt: skip
    if situation.spheres_across > 1:
        found.append(_break_up(situation, decisions, allowed))
    found.append(_saturation(situation, decisions, max_error))
    found.append(_modulus_range(situation))
    return tuple(found)


def binding(found: tuple[Limit, ...]) -> Limit:
    """The limit that allows the least softening."""
    return max(found, key=lambda limit: limit.smallest_ratio)


def ratio(found: tuple[Limit, ...]) -> float:
    """Smallest E_mod/E that keeps every limit, 1 at most; two digits, rounded up."""
    smallest = binding(found).smallest_ratio
    if smallest >= 1:
        return 1.0
    unit = 10.0 ** (math.floor(math.log10(smallest)) - 1)
    return min(1.0, float(f"{math.ceil(smallest / unit * (1 - 1e-12)) * unit:.2g}"))


def _normal_impacts(decisions: tuple[Decision, ...]) -> Limit:
    exact = "gamma_mod = gamma q^(2/5)" if on(decisions, "adhesion") else "e does not depend on E"
    source = "Haervig 2017, eq. 24; Chen 2019, eq. 10" if on(decisions, "adhesion") else "Tsuji et al. 1992: damping ~ overlap^(1/4)"
    return Limit(name="normal impacts", smallest_ratio=0.0, estimate="similar exactly: no error", formula=exact, source=source)


def _oblique_impacts(situation: Situation, decisions: tuple[Decision, ...], allowed: float) -> Limit:
    name, source = "oblique impacts", "docs/lever-arm.md; Haervig 2017, eqs 17, 20-22; oracle"
    formula = "0.5 (overlap/r) v_t/v + 0.65 v_t t_c/(r_i + r_j) + (5/2) M t_c/(m r v), less their real values"
    if all(meeting.tangential_speed == 0 for meeting in situation.meetings):
        return Limit(name=name, smallest_ratio=0.0, estimate="none happen", formula="v_t = 0", source="scene")

    def excess(q: float) -> float:
        return sum(oblique.change(situation, decisions, q).values()) - allowed

    smallest = _smallest(excess)
    at = max(smallest, LOWEST)
    found = oblique.change(situation, decisions, at * (1 + ROUND_OFF))
    parts = ", ".join(f"{cause} {value:.2g}" for cause, value in found.items() if value > 0)
    if smallest > 0 and sum(found.values()) < 0.9 * allowed:
        parts += f"; softer it would stop within {oblique.FEWEST_PERIODS} periods, too few for an estimate"
    if not situation.about_single_impacts:
        text = f"single rebounds are not the result: within {allowed:g} of v they would need {smallest:.2g}"
        return Limit(name=name, smallest_ratio=0.0, estimate=text, formula=formula, source=source)
    return Limit(name=name, smallest_ratio=smallest, estimate=f"{allowed:g} of v: {parts}", formula=formula, source=source)


def _overlap_in_impacts(situation: Situation, decisions: tuple[Decision, ...]) -> Limit:
    adhesion, allowed = on(decisions, "adhesion"), situation.maximum_overlap

    def depth(meeting: Meeting) -> float:
        pair = collisions.softened(meeting, 1.0, adhesion=adhesion)
        return collisions.overlap_in_impact(pair, meeting.speed) / pair.effective_radius

    meeting = max(situation.meetings, key=depth)
    return Limit(
        name="overlap in impacts", smallest_ratio=(depth(meeting) / allowed) ** 2.5,
        estimate=f"{allowed:g} R at {meeting.speed:g} m/s ({meeting.label}); real {depth(meeting):.2g} R",
        formula="overlap/R ~ q^(-2/5) <= limit", source="small strain of Hertz and JKR; Haervig 2017, eqs 8-10 integrated",
    )  # fmt: skip


def _overlap_at_rest(situation: Situation, decisions: tuple[Decision, ...], allowed: float) -> Limit:
    adhesion = on(decisions, "adhesion")

    def strain(meeting: Meeting, q: float) -> float:
        pair = collisions.softened(meeting, q, adhesion=adhesion)
        distance = sum(meeting.radii) if len(meeting.radii) == 2 else 2 * meeting.radii[0]
        return DIRECTIONS * overlap_at_rest(situation, pair) / distance

    def excess(q: float) -> float:
        return max(strain(meeting, q) - strain(meeting, 1.0) for meeting in situation.meetings) - allowed

    load = f" under {situation.weight_carried:.3g} N" if situation.weight_carried > 0 else ""
    return Limit(
        name="overlap of contacts at rest", smallest_ratio=_smallest(excess), estimate=f"solid fraction changed by {allowed:g}{load}",
        formula="3 (delta(q) - delta(1))/(r_i + r_j), delta_0 = a_0^2/(3R) ~ q^(-2/5)" if adhesion
        else "3 (delta(q) - delta(1))/(r_i + r_j), delta = (3 W/(4 E sqrt R))^(2/3) ~ q^(-2/3)",
        source="Chen 2019, eqs 16-17" if adhesion else "Hertz; Haervig 2017, eq. 8 with gamma = 0",
    )  # fmt: skip


def overlap_at_rest(situation: Situation, pair: contact_laws.PairProperties) -> float:
    """Overlap of a contact that carries the largest weight [m]; Haervig 2017, eqs 8-10."""
    weight = situation.weight_carried
    zero_load = pair.equilibrium_contact_radius
    # 4 F_C (s^3 - s^(3/2)) = W: a quadratic in s^(3/2); Hertz without adhesion.
    if zero_load > 0:
        root = (1 + math.sqrt(1 + weight / pair.pull_off_force)) / 2
        radius = zero_load * root ** (2 / 3)
    else:
        radius = (3 * weight * pair.effective_radius / (4 * pair.effective_modulus)) ** (1 / 3)
    return contact_laws.overlap(pair, radius)


def _force_in_impacts(situation: Situation, decisions: tuple[Decision, ...], allowed: float) -> Limit:
    adhesion = on(decisions, "adhesion")
    law = "jkr" if on(decisions, "neck") else "jkr/simplified"

    def acceleration(meeting: Meeting, speed: float) -> float:
        """Of the two bodies relative to each other; a gas drags at both, whatever else pulls is taken at the lighter one."""
        weight = situation.gravity if on(decisions, "gravity") else 0.0
        if math.isfinite(meeting.drag_time):
            return weight + len(meeting.radii) * (situation.gas_speed + speed) / meeting.drag_time
        return weight + situation.pulling_force / meeting.pair.effective_mass

    def change(meeting: Meeting) -> float:
        """Speed that the force gives during a contact over that of the impact, per 1/q^(2/5) - 1."""
        pair = collisions.softened(meeting, 1.0, adhesion=adhesion)
        sticks = collisions.sticking_speed(pair, law)
        if sticks >= meeting.speed:
            return 0.0
        speed = max(meeting.slowest_speed, sticks)
        return acceleration(meeting, speed) * collisions.contact_time(pair, speed) / speed

    worst = max(change(meeting) for meeting in situation.meetings)
    return Limit(
        name="outer force during an impact", smallest_ratio=(worst / (worst + allowed)) ** 2.5 if worst > 0 else 0.0,
        estimate=f"changes speeds by {allowed:g} of the impact's" if worst > 0 else "no outer force, or every impact sticks",
        formula="(g + F/m + (U + v)/t_drag) (t_c(q) - t_c(1))/v, t_c ~ q^(-2/5)", source="Chen 2019, eq. 18; momentum",
    )  # fmt: skip


def break_up_change(situation: Situation, modulus_ratio: float, adhesion: bool = True) -> float:
    """Change of the contacts that are left of a body which breaks in an impact, in parts of all; docs/break-up.md.

    Parameters
    ----------
    situation : Situation
        With `spheres_across`.
    modulus_ratio : float
        q.
    adhesion : bool
        Whether it is simulated.
    """
    return sum(max((_break_up_parts(situation, meeting, modulus_ratio, adhesion) for meeting in situation.meetings), key=sum))


def _break_up_parts(situation: Situation, meeting: Meeting, q: float, adhesion: bool) -> tuple[float, float]:
    soft, real = (collisions.softened(meeting, ratio, adhesion=adhesion) for ratio in (q, 1.0))
    sphere = max(meeting.radii)
    resists = 2 * meeting.friction_coefficient * real.pull_off_force * sphere
    share = resists / (0.5 * collisions.masses(meeting)[0] * meeting.speed**2)
    deeper = collisions.overlap_in_impact(soft, meeting.speed) - collisions.overlap_in_impact(real, meeting.speed)
    return min(MOST_LOST, LOST_RESISTANCE * share**2) * (1 - q**0.4), BODY_STRAIN * situation.spheres_across * deeper / sphere


def _break_up(situation: Situation, decisions: tuple[Decision, ...], allowed: float) -> Limit:
    adhesion = on(decisions, "adhesion")
    smallest = _smallest(lambda q: break_up_change(situation, q, adhesion) - allowed)
    at = max(smallest, LOWEST)
    resistance, strain = max((_break_up_parts(situation, meeting, at, adhesion) for meeting in situation.meetings), key=sum)
    return Limit(
        name="break-up of bodies of many spheres", smallest_ratio=smallest,
        estimate=f"{allowed:g} of the contacts: resistance {resistance:.2g}, strain of the body {strain:.2g}",
        formula=f"min({MOST_LOST:g}, {LOST_RESISTANCE:g} (4 mu F_C r/(m v^2))^2) (1 - q^(2/5))"
        f" + {BODY_STRAIN:g} n (delta(q) - delta(1))/r, n across the body",
        source="measured in ensembles of runs, docs/break-up.md",
    )  # fmt: skip


def _tabor(situation: Situation) -> Limit:
    pairs = [meeting.pair for meeting in situation.meetings if meeting.pair.surface_energy > 0]
    number = min(scaling.tabor_number(pair.effective_radius, pair.effective_modulus, pair.surface_energy) for pair in pairs)
    return Limit(
        name="Tabor number of the real material", smallest_ratio=math.inf if number < scaling.TABOR_OF_DMT else 0.0,
        estimate=f"{number:.3g}, JKR from {scaling.TABOR_OF_JKR:g}; softening would hide a DMT contact",
        formula="(4 R gamma^2/(E^2 z_0^3))^(1/3)", source="Haervig 2017, eq. 1",
    )  # fmt: skip


def _pull_off(situation: Situation, decisions: tuple[Decision, ...]) -> Limit:
    law = "jkr" if on(decisions, "neck") else "jkr/simplified"
    held = {
        meeting.label: contact_laws.holding_force(meeting.pair, law) for meeting in situation.meetings if meeting.pair.surface_energy > 0
    }
    weight = max(max(collisions.masses(meeting)) for meeting in situation.meetings) * situation.gravity
    acting = {"pulling force": situation.pulling_force, "weight carried": situation.weight_carried, "weight": weight}
    if not on(decisions, "gravity"):
        acting = {"pulling force": situation.pulling_force}
    strongest = max(acting, key=lambda name: acting[name])
    label = min(held, key=lambda name: held[name])
    share = acting[strongest] / held[label]
    return Limit(
        name="pull-off against outer forces", smallest_ratio=scaling.smallest_modulus_ratio(share / NEGLIGIBLE_FRACTION),
        estimate=f"{strongest} {acting[strongest]:.3g} N, {share:.2g} of the {held[label]:.3g} N that real {label} holds",
        formula=f"F <= {NEGLIGIBLE_FRACTION:g} {'' if law == 'jkr' else '(8/9) '}q^(2/5) F_C", source="Haervig 2017, secs 2.1, 6",
    )  # fmt: skip


def _scaled_strength(decisions: tuple[Decision, ...], allowed: float) -> Limit:
    uses = on(decisions, "rolling") or on(decisions, "sliding_adhesion")
    return Limit(
        name="strength of rolling and sliding", smallest_ratio=(1 - allowed) ** 2.5 if uses else 0.0,
        estimate=f"lost by {allowed:g}" if uses else "neither is simulated",
        formula="1 - q^(2/5)", source="Haervig 2017, sec. 3.2; Chen 2019, eqs 11-12",
    )  # fmt: skip


def _saturation(situation: Situation, decisions: tuple[Decision, ...], max_error: float) -> Limit:
    name, source = "time step bound by rolling", "Haervig 2017, eq. 21 with real F_C; Chen 2019, sec. 4"
    if not (on(decisions, "rolling") and on(decisions, "original_limits")):
        return Limit(name=name, smallest_ratio=0.0, estimate="every time scale grows alike", formula="t ~ q^(-2/5)", source=source)
    modes = [mode for mode in steps.modes(situation, decisions, 1.0, max_error) if mode.binds]
    rolling = min(mode.limit for mode in modes if mode.name == "rolling")
    others = min(mode.limit for mode in modes if mode.name != "rolling")
    return Limit(
        name=name, smallest_ratio=min(1.0, (others / rolling) ** 2.5), estimate="softer gains no time, k_r stays",
        formula="(t_others/t_rolling)^(5/2)", source=source,
    )  # fmt: skip


def _modulus_range(situation: Situation) -> Limit:
    softest = min(_particle_modulus(meeting) for meeting in situation.meetings)
    return Limit(
        name="LIGGGHTS' range of moduli", smallest_ratio=0.0,
        estimate=f"below {min(1.0, steps.SOFTEST_MODULUS / softest):.2g} the deck says soft_particles",
        formula="youngsModulus >= 5e6 Pa without it", source="LIGGGHTS 3.8, fix property/global youngsModulus",
    )  # fmt: skip


def _particle_modulus(meeting: Meeting) -> float:
    """Young's modulus of the spheres [Pa], as if both materials were alike."""
    return contact_laws.particle_modulus(meeting.pair.effective_modulus, meeting.poissons_ratio)


def _smallest(excess: Callable[[float], float]) -> float:
    """Smallest q in (LOWEST, 1] at which an error that grows with softening stays within; 0 where it never exceeds."""
    if excess(LOWEST) <= 0:
        return 0.0
    return math.exp(brentq(lambda log_q: excess(math.exp(log_q)), math.log(LOWEST), 0.0, xtol=1e-9))
