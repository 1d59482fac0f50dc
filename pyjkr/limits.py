"""What a plan must keep to: a time step that follows every mode of the contact, forces that do not pull it apart.

Covers the stability of velocity Verlet mode by mode, outer forces against the pull-off force of Haervig 2017 eq. 24,
and the Tabor number (eq. 1). A limit exceeded is a `PlanError`, one that comes near a warning.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pyjkr import contact as contact_laws
from pyjkr import scaling, timestep
from pyjkr.case import Case
from pyjkr.contact import PairProperties
from pyjkr.errors import PlanError
from pyjkr.scene import Scene

# The oscillations that a time step has to follow; the other periods of a case are collision times.
MODES = ("normal", "sliding", "rolling", "twisting")
# A warning where the time step exceeds this fraction of a period, or of the stability limit.
RESOLVED_FRACTION = 1 / 10
STABLE_FRACTION = 1 / 2
# A warning where outer forces exceed this fraction of what the contact holds.
NEGLIGIBLE_FRACTION = 1 / 10
# Of time steps that are a whole fraction of a period.
_ROUND_OFF = 1e-9


def warnings(scene: Scene, cases: Sequence[Case]) -> tuple[str, ...]:
    """Check all cases of a plan.

    Returns
    -------
    tuple of str
        One line for the Tabor number, for each mode that is poorly resolved and for each stiffness at which outer
        forces are not small: the worst case each.

    Raises
    ------
    PlanError
        Where a time step is longer than velocity Verlet can follow, or outer forces exceed what a contact holds.
    """
    real = cases[0].original
    tabor = scaling.tabor_warning(real.effective_radius, real.effective_modulus, real.surface_energy)
    return (*((tabor,) if tabor else ()), *_time_step_warnings(scene, cases), *_pull_warnings(scene, cases))


def stability_limit(scene: Scene, case: Case, mode: str) -> float:
    """Longest time step [s] that is stable for one mode of a case, at the deepest point of its impact."""
    model, pair, period = scene.model, case.pair, case.periods[mode]
    ratio = 0.0
    # eventCorrection takes the normal damping at the full step, which leaves the limit of the undamped oscillation.
    if mode == "normal" and not model.event_correction:
        ratio = timestep.normal_damping_ratio(pair, case.maximum_contact_radius, period)
    elif mode in ("sliding", "twisting") and model.tangential_damping:
        ratio = timestep.tangential_damping_ratio(pair, case.maximum_contact_radius, period)
    elif mode == "rolling":
        # 2 x sqrt(k_r I_r/R) is critical for x = 1 where the spins do not slip.
        ratio = model.rolling_damping * math.sqrt(timestep.spin_share(case.radii, case.masses))
    return timestep.verlet_limit(period, ratio)


def _time_step_warnings(scene: Scene, cases: Sequence[Case]) -> Iterator[str]:
    steps_now = scene.impact.steps_per_collision
    for mode in MODES:
        with_mode = [case for case in cases if mode in case.periods]
        if not with_mode:
            continue
        case = max(with_mode, key=lambda case: case.time_step / stability_limit(scene, case, mode))
        period, limit = case.periods[mode], stability_limit(scene, case, mode)
        where = (
            f"case {case.label}: the time step of {case.time_step:.3g} s makes {period / case.time_step:.2g} steps in a period of"
            f" the {mode} mode, whose stability limit is {limit:.3g} s (dt omega = {2 * math.pi * limit / period:.3g})."
        )
        resolved = min(RESOLVED_FRACTION * period, STABLE_FRACTION * limit)
        well = math.ceil(steps_now * case.time_step / resolved * (1 - _ROUND_OFF))
        if case.time_step >= limit:
            least = math.floor(steps_now * case.time_step / limit) + 1
            raise PlanError(
                f"{scene.source}: {where} The run would blow up. Set steps_per_collision to {least} at least, better to {well}."
            )
        if case.time_step > resolved * (1 + _ROUND_OFF):
            yield f"{where} Raise steps_per_collision to {well}."


def _pull_warnings(scene: Scene, cases: Sequence[Case]) -> Iterator[str]:
    # The least holding first: it decides whether the plan is refused.
    for held, case in sorted({_held(scene, case.pair): case for case in reversed(cases)}.items()):
        pull, share = _pull(scene, case), _pull(scene, case) / _held(scene, case.original) if held > 0 else 0.0
        if held == 0 or pull <= NEGLIGIBLE_FRACTION * held * (1 + _ROUND_OFF):
            continue
        least, good = (_rounded_up(scaling.smallest_modulus_ratio(share / part)) for part in (1.0, NEGLIGIBLE_FRACTION))
        where = (
            f"case {case.label}: the environment may pull with {pull:.3g} N, {pull / held:.0%} of the {held:.3g} N that the"
            f" contact holds at E_mod/E = {case.modulus_ratio:g} ({_origin(scene)}, {case.pair.pull_off_force:.3g} N)."
        )
        enough = (
            f"From modulus_ratio = {good} on it is below {NEGLIGIBLE_FRACTION:.0%}."
            if share <= NEGLIGIBLE_FRACTION
            else f"No modulus_ratio helps against that: it is {share:.0%} of what the real contact holds."
        )
        if pull > held:
            need = f" Set modulus_ratios to {least} or more." if share <= 1 else ""
            raise PlanError(f"{scene.source}: {where} The contact would not last.{need} {enough}")
        yield f"{where} {enough}"


def _pull(scene: Scene, case: Case) -> float:
    """Strongest force of the environment on a contact [N]: the acceleration acts on the heaviest sphere."""
    return scene.environment.external_force + scene.environment.acceleration * max(case.masses)


def _held(scene: Scene, pair: PairProperties) -> float:
    return contact_laws.holding_force(pair, scene.model.normal)


def _origin(scene: Scene) -> str:
    return "8/9 of F_C,mod" if scene.model.normal == "jkr/simplified" else "F_C,mod"


def _rounded_up(ratio: float) -> str:
    """Three digits, none of them rounded down."""
    unit = 10.0 ** (math.floor(math.log10(ratio)) - 2)
    return f"{math.ceil(ratio / unit) * unit:.3g}"
