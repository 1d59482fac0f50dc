# Law: none of its own; one normal impact of a scene, by LIGGGHTS or by the oracle.
# Covers: what the impact figures of Haervig et al. 2017 share (figs 5, 7, 8, 13), through plan, deck, run and compare.
# Assumes: scenes of one speed, one stiffness and one rule of the surface energy.
"""One impact of a study, and the row that it leaves."""

from __future__ import annotations

from pathlib import Path

from pyjkr import campaign, compare, plan
from pyjkr.case import Case, Plan
from pyjkr.compare import Outcome
from pyjkr.cost.variants import changed
from pyjkr.oracle.impact import impact
from pyjkr.oracle.normal import NormalContact
from pyjkr.run import find_simulator
from pyjkr.scene import Scene


class Nobody:
    """A watcher of a campaign who does not watch: the sweep shows points, not steps."""

    def step(self, case: Case, step: int) -> None:
        """Nothing."""

    def done(self, case: Case, was_there: bool) -> None:
        """Nothing."""


def alone(scene: Scene, speed: float, modulus_ratio: float, rule: str, steps_per_collision: int | None = None) -> Scene:
    """The scene with one speed [m/s], one stiffness and one rule of the surface energy.

    Parameters
    ----------
    scene : Scene
        Where to start.
    speed, modulus_ratio : float
        [m/s]; q = E_mod/E.
    rule : str
        `scaled` or `unmodified`. With the latter at q < 1 the reduced modulus is written into the scene as the real one,
        for a scene has at least one scaled ratio.
    steps_per_collision : int or None
        None leaves the scene's.
    """
    impact: dict = {"speeds": (speed,)}
    if steps_per_collision is not None:
        impact["steps_per_collision"] = steps_per_collision
    contact: dict = {}
    if rule == "unmodified":
        contact["effective_modulus"], modulus_ratio = scene.meeting.effective_modulus * modulus_ratio, 1.0
    reduction = {"modulus_ratios": (modulus_ratio,), "unmodified_ratios": None}
    return changed(scene, impact=impact, contact=contact, reduction=reduction)


def outcome(scene: Scene, engine: str, directory: Path) -> tuple[Case, Outcome]:
    """The only case of a scene, and what came of it.

    Parameters
    ----------
    scene : Scene
        Of one speed and one stiffness.
    engine : str
        `liggghts` or `oracle`.
    directory : Path
        Gets the run of LIGGGHTS.
    """
    planned: Plan = plan.plan(scene)
    if engine == "oracle":
        outcomes = compare.oracle_outcomes(planned)
    else:
        outcomes = campaign.execute(planned, directory, find_simulator(), watcher=Nobody())
    case = planned.cases[0]
    return case, outcomes[case.label]


def restitution(contact: NormalContact, mass: float, speed: float, relative_tolerance: float = 1e-9) -> float:
    """e_eff of the oracle at a speed [m/s]; the default is the accuracy of a drawn line."""
    return impact(contact, mass, speed, relative_tolerance=relative_tolerance, samples=2, stuck_periods=0.01).restitution
