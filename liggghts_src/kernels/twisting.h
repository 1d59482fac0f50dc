// Twisting: torsional spring and dashpot about the contact normal with the moment at which the whole area slips.
// Chen 2019 eqs 1c, 3b (Marshall 2009 eqs 32, 33): k_T a^2/2, eta_T a^2/2, limit (2/3) a F_S,crit.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_TWISTING_H
#define PYJKR_KERNELS_TWISTING_H

#include <cmath>

namespace pyjkr {

struct TwistingStep {
  double angle;    // after this step [rad]
  double moment;   // on i about the normal that the relative spin was taken about [N m]
};

// (2/3) a F_S,crit [N m], a of the real contact.
inline double twisting_limit(double contact_radius, double sliding_limit) {
  return 2.0 / 3.0 * contact_radius * sliding_limit;
}

// One step: `angle` already carries this step's twist. Spring and sum are cut at the limit as in slide().
inline TwistingStep twist(double angle, double relative_spin, double stiffness, double damping, double limit) {
  const double kept = stiffness * std::fabs(angle) > limit ? std::copysign(limit / stiffness, angle) : angle;
  const double moment = -stiffness * kept - damping * relative_spin;
  return {kept, std::fabs(moment) > limit ? std::copysign(limit, moment) : moment};
}

}  // namespace pyjkr

#endif
