"""How `max_error` is shared out among what makes errors: effects left out, stiffness reduction, time step.

Covers no law. `max_error` is a part of the impact's energy where e_eff^2 is looked at, of its speed for velocities and spins,
of the force for what holds or yields. Assumes that errors of different origin add up.
"""

from __future__ import annotations

# One half for the softening, which pays most; the other half for the time step and for each effect that is left out.
# Several effects left out at once may add up to more: the plan sums what it estimates and says so.
SOFTENING_SHARE = 1 / 2
STEP_SHARE = 1 / 4
EFFECT_SHARE = 1 / 4
