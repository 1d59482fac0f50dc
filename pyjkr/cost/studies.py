"""What is run: a list of jobs for each question about accuracy and cost.

Speeds are given by the sticking speed of the law at hand, so that every study sees the threshold, where errors are
largest. Errors are differences from the oracle, the largest over all phases of the first contact within a step.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from pyjkr.case import Case
from pyjkr.cost import exact, variants
from pyjkr.cost.exact import Exact
from pyjkr.cost.impacts import Impacts, even_phases, prepare
from pyjkr.errors import PlanError
from pyjkr.scene import Scene

LAWS = ("jkr/simplified", "jkr")
TARGETS = ("wall", "sphere")
# The main job, reduced and corrected, against the real stiffness with plain velocity Verlet: (E_mod/E, steps, correction).
HEADLINE = ((1.0, 200, False), (0.01, 20, True))
# Where effects are compared: the integrator's part in the outcome is small there, with or without correction.
EFFECT_STEPS = 200
THRESHOLD_FACTORS = (0.98, 1.02)
THRESHOLD_STEPS = 20
# Other dampings than the scene's: the weaker it is, the slower is the sticking speed beside what adhesion gives a sphere.
RESTITUTIONS = (0.5, 0.7, 0.9, 0.95, 0.99)
RESTITUTION_STEPS = (20, 60, 200)
RESTITUTION_SPEED_FACTORS = (1.1, 2.0, 8.0)
# What a sphere at a wall may do without: keys of the model, keys of the contact.
EFFECTS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "everything": ({}, {}),
    "no sliding": ({"tangential": "off"}, {}),
    "no rolling, no twisting": ({"rolling_friction": "off", "twisting": False}, {}),
    "no twisting": ({"twisting": False}, {}),
    "no neck (jkr/simplified)": ({"normal": "jkr/simplified"}, {}),
    "no damping (e = 1)": ({}, {"restitution_coefficient": 1.0}),
    "no event correction": ({"event_correction": False}, {}),
    "normal force alone": ({"tangential": "off", "rolling_friction": "off", "twisting": False}, {}),
}

Answer = Callable[[Scene, Case], Exact]


@dataclass(frozen=True)
class Setting:
    """How thorough a measurement is.

    Attributes
    ----------
    phases : int
        Phases of the first contact within a step.
    steps : tuple of int
        Steps per collision.
    speed_factors : tuple of float
        Speeds in units of the sticking speed.
    modulus_ratios : tuple of float
        E_mod/E, falling from 1.
    rounds : int
        Times that each timing is repeated, alternating.
    timed_impacts : int
        Impacts side by side in a timing.
    """

    phases: int
    steps: tuple[int, ...]
    speed_factors: tuple[float, ...]
    modulus_ratios: tuple[float, ...]
    rounds: int
    timed_impacts: int


FULL = Setting(
    phases=7,
    steps=(10, 20, 40, 60, 100, 200, 500, 1000),
    speed_factors=(1.1, 1.3, 1.7, 2.5, 4.0, 8.0),
    modulus_ratios=(1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001),
    rounds=7,
    timed_impacts=1000,
)
QUICK = Setting(
    phases=3,
    steps=(20, 60, 200),
    speed_factors=(1.1, 2.0, 8.0),
    modulus_ratios=(1.0, 0.1, 0.01),
    rounds=3,
    timed_impacts=200,
)


@dataclass(frozen=True)
class Job:
    """One batch to run, what it answers, and the right answer; `keys` are columns of the table."""

    keys: dict[str, Any]
    impacts: Impacts
    answer: Answer


class Jobs:
    """Jobs of a scene, and what had to be left out with the reason; every method adds one study."""

    def __init__(self, scene: Scene, setting: Setting) -> None:
        self.scene = scene
        self.setting = setting
        self.phases = even_phases(setting.phases)
        self.jobs: list[Job] = []
        self.left_out: list[str] = []

    @classmethod
    def of(cls, scene: Scene, setting: Setting) -> Jobs:
        """The jobs of all studies."""
        jobs = cls(scene, setting)
        studies = (jobs.steps, jobs.threshold, jobs.restitution, jobs.headline)
        for add in (*studies, jobs.stiffness, jobs.oblique, jobs.effects, jobs.times):
            add()
        return jobs

    def _add(
        self,
        keys: dict[str, Any],
        scene: Scene,
        phases: Sequence[float],
        answer: Answer = exact.normal,
        duration: float | None = None,
    ) -> bool:
        label = "_".join(str(value).replace("/", "-").replace(" ", "-") for value in keys.values())
        try:
            impacts = prepare(f"runs/{label}", scene, tuple(phases), duration)
        except PlanError as error:
            self._leave_out(keys, error)
            return False
        self.jobs.append(Job(keys, impacts, answer))
        return True

    def _leave_out(self, keys: dict[str, Any], error: PlanError) -> None:
        where = f"{keys['study']} at E_mod/E = {keys['modulus_ratio']:g} and {keys['speed']:.4g} m/s"
        line = f"{where}: {variants.refusal(error)}"
        if line not in self.left_out:
            self.left_out.append(line)

    def steps(self) -> None:
        """Steps per collision, with and without event correction, near the threshold and far from it."""
        for target, law, corrected in product(TARGETS, LAWS, (True, False)):
            base = variants.changed(variants.at(self.scene, target), model={"normal": law, "event_correction": corrected})
            for speed, steps in product(variants.speeds(base, self.setting.speed_factors), self.setting.steps):
                self._add(_keys("steps", target, law, corrected, steps, speed), variants.one(base, speed, steps), self.phases)

    def threshold(self) -> None:
        """Speeds just below and above the sticking speed."""
        for target, law, corrected in product(TARGETS, LAWS, (True, False)):
            base = variants.changed(variants.at(self.scene, target), model={"normal": law, "event_correction": corrected})
            sticking = variants.threshold(base)
            for factor in THRESHOLD_FACTORS if sticking > 0 else ():
                keys = _keys("threshold", target, law, corrected, THRESHOLD_STEPS, factor * sticking)
                self._add(keys, variants.one(base, factor * sticking, THRESHOLD_STEPS), self.phases)

    def restitution(self) -> None:
        """Dampings that the scene does not have, with event correction at a wall."""
        for law, e in product(LAWS, RESTITUTIONS):
            base = variants.at(self.scene, "wall")
            base = variants.changed(base, model={"normal": law, "event_correction": True}, contact={"restitution_coefficient": e})
            for speed, steps in product(variants.speeds(base, RESTITUTION_SPEED_FACTORS), RESTITUTION_STEPS):
                keys = _keys("restitution", "wall", law, True, steps, speed) | {"restitution_coefficient": e}
                self._add(keys, variants.one(base, speed, steps), self.phases)

    def headline(self) -> None:
        """The scene's own speeds for the same simulated time, where both stiffnesses are possible."""
        base = variants.at(self.scene, self.scene.impact.target)
        for speed in variants.own_speeds(self.scene):
            pair = []
            for ratio, steps, corrected in HEADLINE:
                keys = _keys("headline", base.impact.target, base.model.normal, corrected, steps, speed, ratio)
                variant = variants.one(base, speed, steps, ratio, event_correction=corrected)
                pair.append((keys, variant))
            try:
                duration = max(prepare("", variant, ()).case.duration for _, variant in pair)
            except PlanError as error:
                self._leave_out(pair[-1][0], error)
                continue
            for keys, variant in pair:
                self._add(keys, variant, self.phases, duration=duration)

    def stiffness(self) -> None:
        """Reduced stiffness in normal impacts: the similarity is exact, so all errors are those of the integrator."""
        base = variants.at(self.scene, self.scene.impact.target)
        speed = variants.reference_speed(base)
        for ratio, steps in product(self.setting.modulus_ratios, self.setting.steps):
            keys = _keys("stiffness", base.impact.target, base.model.normal, base.model.event_correction, steps, speed, ratio)
            self._add(keys, variants.one(base, speed, steps, ratio), self.phases)

    def oblique(self) -> None:
        """Reduced stiffness in oblique impacts: the similarity is not exact, and the error is physical too."""
        base = variants.oblique(self.scene)
        speed = variants.reference_speed(base)
        fine_enough = [steps for steps in self.setting.steps if steps >= THRESHOLD_STEPS]
        for originals, ratio, steps in product((False, True), self.setting.modulus_ratios, fine_enough):
            keys = _keys("oblique", "wall", base.model.normal, base.model.event_correction, steps, speed, ratio)
            keys["effect"] = "originals" if originals else "scaled"
            variant = variants.one(base, speed, steps, ratio)
            variant = variants.changed(variant, reduction={"use_original_surface_energy": originals})
            self._add(keys, variant, self.phases, exact.oblique)

    def effects(self) -> None:
        """Each effect switched off in turn: what becomes of the outcome of an oblique impact."""
        for name, variant, speed in _without(self.scene):
            keys = _keys("effects", "wall", variant.model.normal, variant.model.event_correction, EFFECT_STEPS, speed)
            self._add(keys | {"effect": name}, variant, self.phases)

    def times(self) -> None:
        """Computing time per step: many impacts at once, cut off at the end of the contact, alternating."""
        timed = even_phases(self.setting.timed_impacts)
        variants_of_effects = list(_without(self.scene))
        for turn in range(self.setting.rounds):
            for target, law, corrected in product(TARGETS, LAWS, (True, False)):
                base = variants.changed(variants.at(self.scene, target), model={"normal": law, "event_correction": corrected})
                speed = variants.reference_speed(base)
                keys = _keys("time", target, law, corrected, EFFECT_STEPS, speed) | {"turn": turn}
                self._add_timing(keys, variants.one(base, speed, EFFECT_STEPS), timed)
            for name, variant, speed in variants_of_effects:
                keys = _keys("effects time", "wall", variant.model.normal, variant.model.event_correction, EFFECT_STEPS, speed)
                self._add_timing(keys | {"effect": name, "turn": turn}, variant, timed)

    def _add_timing(self, keys: dict[str, Any], scene: Scene, phases: Sequence[float]) -> None:
        if self._add(keys, scene, phases):
            job = self.jobs.pop()
            case, contact_time = job.impacts.case, exact.normal(scene, job.impacts.case).contact_time
            length = case.collision_time if math.isnan(contact_time) else contact_time
            steps = case.flight_steps + round(length / case.time_step)
            impacts = dataclasses.replace(job.impacts, case=dataclasses.replace(case, steps=steps))
            self.jobs.append(dataclasses.replace(job, impacts=impacts))


def _keys(study: str, target: str, law: str, corrected: bool, steps: int, speed: float, ratio: float = 1.0) -> dict[str, Any]:
    return {
        "study": study,
        "target": target,
        "normal": law,
        "event_correction": "on" if corrected else "off",
        "modulus_ratio": ratio,
        "speed": speed,
        "steps_per_collision": steps,
    }


def _without(scene: Scene) -> Iterator[tuple[str, Scene, float]]:
    """(name, scene, normal speed) with each effect off in turn, all at one speed, at which a contact with a neck rebounds."""
    base = variants.changed(variants.oblique(scene), model={"normal": "jkr", "event_correction": True})
    speed = variants.reference_speed(base)
    for name, (model, contact) in EFFECTS.items():
        variant = variants.changed(base, model=model, contact=contact)
        yield name, variants.one(variant, speed, EFFECT_STEPS), speed
