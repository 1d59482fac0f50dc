"""Steps and wall time of a plan, beside those of the same scene unreduced: E_mod = E, 50 steps a collision, every effect on.

Covers no law. Assumes that structures gain their contacts evenly, that impacts break them at once, that all spheres fly as fast as the
fastest, and that LIGGGHTS does not sort them (`atom_modify map array sort 0 0.0`): in a mostly empty box that takes longest of all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pyjkr import contact
from pyjkr.planning import neighbours, variants
from pyjkr.planning.cost_model import CostModel
from pyjkr.planning.neighbours import Neighbours, Surroundings
from pyjkr.planning.plan import ApplicationPlan
from pyjkr.planning.situation import Meeting, Situation
from pyjkr.planning.variants import Variant

# Solid fraction and coordination number of the loosest and the densest packing of adhesive spheres, measured over the whole range
# of adhesion by Liu et al., arXiv:1604.05150 (abstract); between them a straight line, below them one to the empty space.
LOOSEST, DENSEST = (2.11, 0.135), (6.40, 0.639)
# Mean number of contacts over that at the end, where structures grow: 0.68, 0.67 and 0.60 counted in the runs of dust_coagulation,
# packed_bed and ash_on_tube.
GROWN = 2 / 3
# Part of the kinetic energy that breaks contacts of an agglomerate: 445 contacts became 150 at 85 times the energy that breaks them
# all, 2 at 1e4 times; counted in two runs of agglomerate_break_up, at 3 m/s with 2.5 um and 1.5 m/s with 100 um.
BREAKING = 0.02


@dataclass(frozen=True, kw_only=True)
class Around:
    """What a deck has beside its contacts.

    Attributes
    ----------
    frames : int
        Of output.
    forces : int
        Fixes that push, each over all spheres: gravity; two of each size class in a gas.
    triangles : int
        Of mesh walls.
    box_volume : float
        Of the simulation box [m3]; 0 where it is not known.
    periodic_lengths : tuple of float
        Of the box along its periodic axes [m]: with `newton off`, LIGGGHTS works out a pair that crosses a boundary at both ends.
    """

    frames: int = 0
    forces: int = 0
    triangles: int = 0
    box_volume: float = 0.0
    periodic_lengths: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What a plan costs.

    Attributes
    ----------
    steps, unreduced_steps : int
        Time steps of the scene.
    wall_time, unreduced_wall_time : float
        From start to end of the program [s].
    speed_up : float
        Time of the unreduced steps over that of the planned ones, without start and output; also where the scene states no duration.
    neighbours : Neighbours
        Lists of the planned run.
    origin : str
        Of the coefficients: "measured" here, or "shipped".
    """

    steps: int
    wall_time: float
    unreduced_steps: int
    unreduced_wall_time: float
    speed_up: float
    neighbours: Neighbours
    origin: str


def estimate(plan: ApplicationPlan, model: CostModel, *, around: Around | None = None, ranks: int = 1) -> Estimate:
    """Steps and wall time of a plan.

    Parameters
    ----------
    plan : ApplicationPlan
        Its situation, decisions, stiffness, styles and time step.
    model : CostModel
        Coefficients of this machine.
    around : Around, optional
        Output, forces, walls and box of the deck; None for none.
    ranks : int
        MPI processes.

    Raises
    ------
    PlanError
        Where the model does not know a style, or no neighbour list can follow the spheres.
    """
    situation, around = plan.situation, around or Around()
    soft, real = variants.planned(plan), variants.unreduced(situation)
    (soft_step, lists), (real_step, _) = (_step_time(situation, variant, model, around, ranks) for variant in (soft, real))
    steps, unreduced_steps = (math.ceil(situation.time / variant.time_step) for variant in (soft, real))
    besides = model.wall_time(0, soft.styles.text, situation.particles, 0, frames=around.frames)
    return Estimate(
        steps=steps,
        wall_time=steps * soft_step + besides,
        unreduced_steps=unreduced_steps,
        unreduced_wall_time=unreduced_steps * real_step + besides,
        speed_up=real_step / real.time_step / (soft_step / soft.time_step),
        neighbours=lists,
        origin=model.origin,
    )


def surroundings(situation: Situation, variant: Variant, box_volume: float = 0.0) -> Surroundings:
    """What the neighbour lists of a scene depend on.

    Parameters
    ----------
    situation : Situation
        Radii, speeds, contacts per sphere.
    variant : Variant
        Time step, and stiffness for the necks.
    box_volume : float
        Of the simulation box [m3]; 0 where it is not known.
    """
    radii = [radius for meeting in situation.meetings for radius in meeting.radii]
    mean = sum(radii) / len(radii)
    law = variant.styles.normal
    necks = [-contact.rupture_overlap(variant.pair(meeting), law) for meeting in situation.meetings] if law == "jkr" else [0.0]
    return Surroundings(
        speed=max(math.hypot(meeting.speed, meeting.tangential_speed) for meeting in situation.meetings),
        time_step=variant.time_step,
        smallest_radius=min(radii),
        mean_radius=mean,
        largest_radius=max(radii),
        # Of the densest phase: lists too long for it cost more than lists too short for the rest.
        number_density=solid_fraction(situation.contacts_per_particle) / (4 / 3 * math.pi * mean**3),
        neck=max(necks),
        particles=situation.particles,
        box_volume=box_volume,
    )


def solid_fraction(contacts_per_particle: float) -> float:
    """Part of the space that spheres fill, guessed from how many they touch: 0.135 at 2.11, 0.639 at 6.40 (arXiv:1604.05150).

    Parameters
    ----------
    contacts_per_particle : float
        Coordination number.
    """
    (low, loose), (high, dense) = LOOSEST, DENSEST
    if contacts_per_particle <= low:
        return loose * contacts_per_particle / low
    return min(loose + (contacts_per_particle - low) / (high - low) * (dense - loose), dense)


def mean_contacts(situation: Situation) -> float:
    """Contacts per particle, averaged over the scene: most of the expected ones where they grow, what an impact leaves where it breaks."""
    expected = situation.contacts_per_particle
    if situation.about == "structure":
        return GROWN * expected
    pairs = [meeting for meeting in situation.meetings if len(meeting.radii) == 2 and meeting.pair.surface_energy > 0]
    if situation.about != "impact" or not situation.many_contacts or not pairs:
        return expected
    worst = max(pairs, key=_over_breaking)
    return expected / (1 + BREAKING * _over_breaking(worst) * 2 / max(expected, 1.0))


def contacts(situation: Situation) -> float:
    """Contacts of a scene: half of what its spheres count, since a pair is counted twice; at walls all."""
    only_walls = all(len(meeting.radii) == 1 for meeting in situation.meetings)
    return situation.particles * mean_contacts(situation) * (1.0 if only_walls else 0.5)


def crossing(situation: Situation, lengths: tuple[float, ...]) -> float:
    """Part of the pairs that crosses a periodic boundary: centres a diameter apart in any direction are half of it apart along an axis.

    Parameters
    ----------
    situation : Situation
        Sizes of its spheres.
    lengths : tuple of float
        Of the periodic axes [m].
    """
    radii = [radius for meeting in situation.meetings for radius in meeting.radii]
    return sum(min(sum(radii) / len(radii) / length, 1.0) for length in lengths)


def _over_breaking(meeting: Meeting) -> float:
    """Kinetic energy of a sphere over the energy that breaks one of its contacts."""
    pair = meeting.pair
    mass = max(4 / 3 * math.pi * density * radius**3 for density, radius in zip(meeting.densities, meeting.radii, strict=True))
    breaking = contact.break_energy(pair)
    return 0.5 * mass * meeting.speed**2 / breaking


def _step_time(situation: Situation, variant: Variant, model: CostModel, around: Around, ranks: int) -> tuple[float, Neighbours]:
    lists = neighbours.choose(surroundings(situation, variant, around.box_volume), model)
    n = situation.particles
    twice = 1 + crossing(situation, around.periodic_lengths)
    time = model.step_time(
        variant.styles.text, n, twice * contacts(situation), idle=twice * n * lists.idle, rebuild_rate=lists.rebuild_rate,
        candidates=n * lists.candidates, bins=n * lists.bins, forces=around.forces, triangles=around.triangles, ranks=ranks,
    )  # fmt: skip
    return time, lists
