// Sliding: spring and dashpot along the contact plane, cut off where an adhesive contact begins to slip.
// Haervig 2017 eqs 14, 16, 17 (Thornton 1991); Chen 2019 eqs 1b, 3a, and 12 for the original pull-off force.
// Coulomb limit mu |F_N + 2 F_C| on spring and dashpot together, F_N without damping.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_JKR_TANGENTIAL_H
#define PYJKR_KERNELS_JKR_TANGENTIAL_H

#include "history.h"
#include "pair_properties.h"

namespace pyjkr {

// F_S,crit [N]
inline double sliding_limit(double elastic_force, double pull_off_force_of_surfaces, double friction_coefficient) {
  return friction_coefficient * std::fabs(elastic_force + 2.0 * pull_off_force_of_surfaces);
}

struct SlidingStep {
  Vec3 displacement;   // after this step [m]
  Vec3 force;          // on partner i [N]
};

// One step: `displacement` already carries this step's slip. Where the limit is passed, the displacement is reset so
// that spring and dashpot together give the limit: the contact slips, it does not wind up.
inline SlidingStep slide(const Vec3& displacement, const Vec3& slip_velocity, double stiffness, double damping,
                         double limit) {
  const Vec3 dashpot = -damping * slip_velocity;
  const Vec3 trial = dashpot - stiffness * displacement;
  const double magnitude = norm(trial);
  if (magnitude <= limit) return {displacement, trial};
  const Vec3 force = (limit / magnitude) * trial;
  if (!(stiffness > 0.0)) return {{0.0, 0.0, 0.0}, force};
  return {(1.0 / stiffness) * (dashpot - force), force};
}

}  // namespace pyjkr

#endif
