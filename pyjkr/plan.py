"""`Scene` -> `Plan`: one `Case` per modulus ratio, surface-energy rule and speed, with every number a deck needs.

Covers Haervig 2017 eq. 24 (modified surface energy), the time step, the start position, the length of the run and the
settings that LIGGGHTS wants at micrometre scale. Nothing is rendered or run here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pyjkr import contact as contact_laws
from pyjkr import limits, scaling, timestep
from pyjkr.case import Case, LeftOut, Plan, Rule
from pyjkr.contact import PairProperties
from pyjkr.errors import PlanError
from pyjkr.scene import Scene

# Steps of free flight before contact, the same for every stiffness, so that the discrete motions stay similar.
FLIGHT_STEPS = 20
# Length of a run in collision times of its slowest case: a sphere that is to rebound near the sticking threshold has
# left after less than two, one that still touches after four is stuck.
COLLISIONS_PER_RUN = 4
# Dump frames in one collision, and in what follows once every collision has ended.
FRAMES_PER_COLLISION = 400
DENSE_COLLISIONS = 3
FRAMES_AFTERWARDS = 25
# Particle Young's modulus [Pa] that LIGGGHTS 3.8 accepts without soft_particles or hard_particles.
STOCK_MODULUS_RANGE = (5e6, 1e9)
# Skin of the neighbour lists in radii of the smallest sphere, and in lengths of the longest neck.
SKIN_IN_RADII = 0.2
SKIN_IN_NECKS = 4


@dataclass(frozen=True, kw_only=True)
class _Draft:
    """A case before the length of its run is known."""

    speed: float
    modulus_ratio: float
    rule: Rule
    pair: PairProperties
    time_step: float
    slowest: float

    @property
    def label(self) -> str:
        return f"{self.speed!r}mps_q{self.modulus_ratio!r}_{self.rule}"


def plan(scene: Scene) -> Plan:
    """Work out every simulation of a scene.

    Parameters
    ----------
    scene : Scene
        What to simulate.

    Returns
    -------
    Plan
        Cases in the order of speed, then rule and falling stiffness; those left out with the reason; warnings.

    Raises
    ------
    PlanError
        Where no case is left, a time step is too long for a mode of the contact, or the environment pulls too hard.
    """
    drafts: list[_Draft] = []
    left_out: list[LeftOut] = []
    rules: list[tuple[Rule, float]] = [("scaled", q) for q in scene.reduction.modulus_ratios]
    rules += [("unmodified", q) for q in scene.reduction.unmodified_ratios]
    limit = scene.reduction.maximum_overlap
    for speed in scene.impact.speeds:
        normal_speed = speed * math.cos(math.radians(scene.impact.angle))
        for rule, ratio in rules:
            pair = pair_properties(scene, ratio, rule)
            draft = _draft(scene, pair, speed, normal_speed, ratio, rule)
            deepest = contact_laws.maximum_overlap(pair, normal_speed) / pair.effective_radius
            if deepest > limit:
                reason = f"may press {deepest:.2f} R deep, limit {limit:g} R"
                left_out.append(LeftOut(draft.label, speed, ratio, rule, deepest, reason))
            else:
                drafts.append(draft)
    if not drafts:
        raise PlanError(
            f"{scene.source}: every case may press deeper than maximum_overlap = {limit:g} R."
            " Lower the speeds, or raise modulus_ratios."
        )
    durations = {draft.speed: 0.0 for draft in drafts}
    for draft in drafts:
        needed = (FLIGHT_STEPS + 1) * draft.time_step + COLLISIONS_PER_RUN * draft.slowest
        durations[draft.speed] = max(durations[draft.speed], needed)
    cases = tuple(_case(scene, draft, durations[draft.speed]) for draft in drafts)
    return Plan(scene, cases, tuple(left_out), limits.warnings(scene, cases))


def pair_properties(scene: Scene, modulus_ratio: float, rule: Rule) -> PairProperties:
    """Effective properties of the two bodies at a modulus ratio, with the surface energy of a rule."""
    contact = scene.meeting
    moduli = tuple(modulus * modulus_ratio for modulus in _youngs_moduli(scene))
    ratios = tuple(scene.material[name].poissons_ratio for name in _names(scene))
    radii, _, masses = _spheres(scene)
    inertias = [0.4 * mass * radius**2 for mass, radius in zip(masses, radii, strict=True)]
    energy = contact.surface_energy
    normal_energy = scaling.surface_energy_mod(energy, modulus_ratio) if rule == "scaled" else energy
    return PairProperties(
        effective_radius=1 / sum(1 / radius for radius in radii),
        effective_mass=1 / sum(1 / mass for mass in masses),
        effective_inertia=1 / sum(1 / inertia for inertia in inertias),
        effective_modulus=contact_laws.effective_modulus(moduli, ratios),
        effective_shear_modulus=contact_laws.effective_shear_modulus(moduli, ratios),
        surface_energy=normal_energy,
        surface_energy_of_rolling=energy if scene.reduction.use_original_surface_energy else normal_energy,
        restitution_coefficient=contact.restitution_coefficient,
    )


def _names(scene: Scene) -> tuple[str, str]:
    return scene.impact.material, scene.impact.struck_material


def _youngs_moduli(scene: Scene) -> tuple[float, float]:
    """Unreduced Young's moduli [Pa] of the flying sphere and of what it hits."""
    effective = scene.meeting.effective_modulus
    materials = [scene.material[name] for name in _names(scene)]
    if effective is None:
        return tuple(material.youngs_modulus for material in materials)
    return tuple(contact_laws.particle_modulus(effective, material.poissons_ratio) for material in materials)


def _spheres(scene: Scene) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Radii, densities and masses of the spheres: one at a wall, else the flying one and the one that is hit."""
    impact = scene.impact
    radii = (impact.sphere_radius,) if impact.target == "wall" else (impact.sphere_radius, impact.target_radius)
    densities = tuple(scene.material[name].density for name in _names(scene)[: len(radii)])
    masses = tuple(4 / 3 * math.pi * radius**3 * density for radius, density in zip(radii, densities, strict=True))
    return radii, densities, masses


def _draft(scene: Scene, pair: PairProperties, speed: float, normal_speed: float, ratio: float, rule: Rule) -> _Draft:
    hertz = _hertz(pair, normal_speed)
    stuck = timestep.stuck_period(pair)
    return _Draft(
        speed=speed,
        modulus_ratio=ratio,
        rule=rule,
        pair=pair,
        time_step=timestep.time_step(pair, normal_speed, scene.impact.steps_per_collision),
        slowest=max(hertz, stuck) if math.isfinite(stuck) else hertz,
    )


def _hertz(pair: PairProperties, normal_speed: float) -> float:
    return timestep.hertz_collision_time(pair.effective_radius, pair.effective_mass, pair.effective_modulus, normal_speed)


def _case(scene: Scene, draft: _Draft, duration: float) -> Case:
    angle = math.radians(scene.impact.angle)
    normal_speed = draft.speed * math.cos(angle)
    pair, step = draft.pair, draft.time_step
    radii, densities, masses = _spheres(scene)
    types = len(set(_names(scene)))
    original = _youngs_moduli(scene)[:types]
    moduli = tuple(modulus * draft.modulus_ratio for modulus in original)
    deepest = contact_laws.maximum_contact_radius(pair, normal_speed)
    neck = contact_laws.rupture_overlap(pair, scene.model.normal)
    dense_interval = math.ceil(scene.impact.steps_per_collision / FRAMES_PER_COLLISION)
    dense = FLIGHT_STEPS + math.ceil(DENSE_COLLISIONS * draft.slowest / step)
    # The last step is to be a frame: what does not divide into coarse intervals goes to the dense ones.
    coarse_interval, rest = divmod(max(0, math.ceil(duration / step) - dense), FRAMES_AFTERWARDS)
    dense = dense_interval * math.ceil((dense + rest) / dense_interval)
    return Case(
        label=draft.label,
        speed=draft.speed,
        normal_speed=normal_speed,
        tangential_speed=draft.speed * math.sin(angle),
        modulus_ratio=draft.modulus_ratio,
        rule=draft.rule,
        pair=pair,
        original=pair_properties(scene, 1.0, "scaled"),
        youngs_moduli=moduli,
        youngs_moduli_original=original,
        poissons_ratios=tuple(scene.material[name].poissons_ratio for name in _names(scene)[:types]),
        radii=radii,
        densities=densities,
        masses=masses,
        periods=_periods(scene, pair, normal_speed, deepest),
        collision_time=timestep.collision_time(pair, normal_speed),
        time_step=step,
        flight_steps=FLIGHT_STEPS,
        phase=scene.impact.phase,
        start_gap=(FLIGHT_STEPS + scene.impact.phase) * normal_speed * step,
        steps=dense + FRAMES_AFTERWARDS * coarse_interval,
        dense_steps=dense,
        dense_interval=dense_interval,
        coarse_interval=max(1, coarse_interval),
        skin=_skin(scene, min(radii), -neck),
        stiffness_commands=_stiffness_commands(moduli),
        maximum_contact_radius=deepest,
        maximum_overlap=contact_laws.overlap(pair, deepest),
        rupture_overlap=neck,
    )


def _periods(scene: Scene, pair: PairProperties, normal_speed: float, contact_radius: float) -> dict[str, float]:
    """Hertz collision time, and the periods of the modes that this model has at the deepest point of the impact [s]."""
    periods = {
        "Hertz collision": _hertz(pair, normal_speed),
        "stuck oscillation": timestep.stuck_period(pair),
        "normal": timestep.normal_period(pair, contact_radius),
    }
    if scene.model.tangential in ("history", "jkr"):
        periods["sliding"] = timestep.sliding_period(pair, contact_radius)
    if scene.model.rolling_friction == "krijt":
        radii, _, masses = _spheres(scene)
        periods["rolling"] = timestep.rolling_period(pair, contact_radius, timestep.spin_share(radii, masses))
        if scene.model.twisting:
            periods["twisting"] = timestep.twisting_period(pair, contact_radius)
    return {name: period for name, period in periods.items() if math.isfinite(period)}


def _skin(scene: Scene, smallest_radius: float, longest_neck: float) -> float:
    given = scene.numerics.skin
    if given is None:
        return max(SKIN_IN_RADII * smallest_radius, SKIN_IN_NECKS * longest_neck)
    if given <= longest_neck:
        raise PlanError(
            f"{scene.source}: numerics: skin = {given!r} m is shorter than the neck of {longest_neck:.3g} m that the contact"
            " stretches to. Leave it out and the plan chooses one."
        )
    return given


def _stiffness_commands(youngs_moduli: tuple[float, ...]) -> tuple[str, ...]:
    """LIGGGHTS' own switches for moduli outside its usual range."""
    lowest, highest = STOCK_MODULUS_RANGE
    soft = ("soft_particles",) if min(youngs_moduli) < lowest else ()
    return soft + (("hard_particles",) if max(youngs_moduli) > highest else ())
