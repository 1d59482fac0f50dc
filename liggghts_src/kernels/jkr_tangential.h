// Sliding: spring and dashpot along the contact plane, cut off where an adhesive contact begins to slip.
// Haervig 2017 eqs 14, 16, 17 (Thornton 1991); Chen 2019 eqs 1b, 3a, and 12 for the original pull-off force.
// Coulomb limit mu |F_N + 2 F_C| on the spring, and on spring and dashpot together; F_N without damping.
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

// One step: `displacement` already carries this step's slip.
//
// The spring yields at the limit, and spring and dashpot together are cut at it. Resetting the spring to what is left
// of the limit beside the dashpot, as some codes do, would stretch it against the motion whenever the dashpot alone
// passes the limit, and make energy; with a spring that holds no more than the limit, (spring + dashpot, cut) - spring
// never does work on the motion.
inline SlidingStep slide(const Vec3& displacement, const Vec3& slip_velocity, double stiffness, double damping,
                         double limit) {
  SlidingStep step{displacement, {0.0, 0.0, 0.0}};
  const double spring_square = stiffness * stiffness * dot(displacement, displacement);
  if (spring_square > limit * limit) step.displacement = (limit / std::sqrt(spring_square)) * displacement;
  step.force = -stiffness * step.displacement - damping * slip_velocity;
  const double square = dot(step.force, step.force);
  if (square > limit * limit) step.force = (limit / std::sqrt(square)) * step.force;
  return step;
}

}  // namespace pyjkr

#endif
