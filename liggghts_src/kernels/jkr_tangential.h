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

// Slip velocity at the end of a step, v_S = known + F dt/(2 m_S), as far as it is known before the force F of the step is.
// share = 1/(1 + eta_T dt/(2 m_S)) solves for F.
struct SlipAtEnd {
  Vec3 known;
  double share;
};

// Beyond this eta_T dt/m_S the damping goes over to the speed of half a step ago. A sphere with many contacts feels all
// their dashpots, of which one contact knows its own: carrying on the slip would shorten the stable time step there.
constexpr double kCarriedDamping = 0.25;

// As in damped_force(): the contact's own force is known to change, all others are taken to stay. `carried` is the slip
// velocity of the step before with its own impulse; `step_per_mass` = dt/m_S, 1/m_S = 7/(2 m) of solid spheres free to spin.
inline SlipAtEnd slip_at_end(const Vec3& slip_velocity, const Vec3& carried, double damping, double step_per_mass) {
  const double number = damping * step_per_mass;
  const double ratio = number * (1.0 / kCarriedDamping);
  const double weight = 0.5 / (1.0 + ratio * ratio * ratio * ratio);
  return {slip_velocity + weight * (slip_velocity - carried), 1.0 / (1.0 + weight * number)};
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
inline SlidingStep slide(const Vec3& displacement, const SlipAtEnd& slip, double stiffness, double damping, double limit) {
  SlidingStep step{displacement, {0.0, 0.0, 0.0}};
  const double spring_square = stiffness * stiffness * dot(displacement, displacement);
  if (spring_square > limit * limit) step.displacement = (limit / std::sqrt(spring_square)) * displacement;
  step.force = -slip.share * (stiffness * step.displacement + damping * slip.known);
  const double square = dot(step.force, step.force);
  if (square > limit * limit) step.force = (limit / std::sqrt(square)) * step.force;
  return step;
}

inline SlidingStep slide(const Vec3& displacement, const Vec3& slip_velocity, double stiffness, double damping,
                         double limit) {
  return slide(displacement, SlipAtEnd{slip_velocity, 1.0}, stiffness, damping, limit);
}

}  // namespace pyjkr

#endif
