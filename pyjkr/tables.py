"""`Plan` and `Comparison` as text for a terminal: tables, what is left out, the verdict."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pyjkr.case import Plan

if TYPE_CHECKING:
    from pyjkr.compare import Comparison


def plan_text(plan: Plan) -> str:
    """The cases of a plan as a table, and those left out."""
    lines = ["case                            time step [s]     steps  collision [s]  overlap/R  gamma_mod [J/m2]"]
    for case in plan.cases:
        lines.append(
            f"{case.label:<30}  {case.time_step:13.6e}  {case.steps:8d}  {case.collision_time:13.6e}"
            f"  {case.maximum_overlap / case.pair.effective_radius:9.3f}  {case.pair.surface_energy:16.6g}"
        )
    lines.append(f"{len(plan.cases)} cases, {plan.total_steps} steps; overlap is an upper bound")
    return "\n".join([*lines, *left_out_lines(plan)])


def comparison_text(comparison: Comparison) -> str:
    """The table, the cases left out, and the verdict, for a terminal."""
    lines = [
        "  speed  E_mod/E  surface     e_eff     e_eff     differ-  contact time [ns]"
        "       steps    wall  computing  speed-up in",
        "  [m/s]           energy      LIGGGHTS  oracle    ence     LIGGGHTS   oracle "
        "                [s]        [s]  steps   time",
    ]
    previous = None
    for row in comparison.table.itertuples(index=False):
        if previous not in (None, row.speed):
            lines.append("")
        previous = row.speed
        lines.append(
            f"{row.speed:7.3g} {row.modulus_ratio:8.3g}  {row.rule:<10}"
            f"  {_restitution(row.e_eff_liggghts, row.stuck_liggghts):<8}  {_restitution(row.e_eff_oracle, row.stuck_oracle):<8}"
            f"  {_or_dash(row.difference, '{:+.0e}'):<7}  {_or_dash(row.contact_time_liggghts * 1e9, '{:.4f}'):<9}"
            f"  {_or_dash(row.contact_time_oracle * 1e9, '{:.4f}'):<9}  {row.steps:8d}  {_or_dash(row.wall_time, '{:.2f}'):>6}"
            f"  {_or_dash(row.computing_time, '{:.4f}'):>9}  {_or_dash(row.speed_up_steps, '{:.2f}'):>5}"
            f"  {_or_dash(row.speed_up, '{:.2f}'):>5}"
        )
    angle = comparison.plan.scene.impact.angle
    if angle > 0:
        lines += ["", f"speeds are those along the path, {angle:g} degrees from the normal; e_eff is that of the normal part"]
    lines += ["", *left_out_lines(comparison.plan), *_verdict_lines(comparison), ""]
    return "\n".join(lines)


def left_out_lines(plan: Plan) -> list[str]:
    """One line for each modulus ratio and rule of which speeds are left out."""
    lines = []
    limit = plan.scene.reduction.maximum_overlap
    for ratio, rule in dict.fromkeys((item.modulus_ratio, item.rule) for item in plan.left_out):
        items = [item for item in plan.left_out if (item.modulus_ratio, item.rule) == (ratio, rule)]
        speeds = ", ".join(f"{item.speed:g}" for item in items)
        deepest = [item.overlap for item in items]
        depth = f"{min(deepest):.2f}" + (f" to {max(deepest):.2f}" if len(items) > 1 else "")
        lines.append(f"left out: E_mod/E = {ratio:g} {rule} at {speeds} m/s: may press {depth} R deep, limit {limit:g} R")
    return lines


def _verdict_lines(comparison: Comparison) -> list[str]:
    lines = [
        f"{'ok ' if check.passed else 'BAD'} {check.name}: {check.worst:.2g}, tolerance {check.tolerance:g}"
        + (f" (worst: {check.where})" if check.worst > 0 else "")
        for check in comparison.checks
    ]
    return [*lines, "all within tolerance" if comparison.passed else "OUTSIDE TOLERANCE"]


def _restitution(value: float, stuck: bool | None) -> str:
    return "-" if stuck is None else "stuck" if stuck else f"{value:.6f}"


def _or_dash(value: float, form: str) -> str:
    return "-" if math.isnan(value) else form.format(value)
