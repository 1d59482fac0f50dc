// What the normal law of one contact hands to sliding, rolling and twisting in the same contact and step.
// Lives inside one contact model (one pair style or one wall), so neither walls nor pairs can mix theirs up.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_CONTACT_RECORD_H
#define PYJKR_ADAPTERS_CONTACT_RECORD_H

#include "../kernels/history.h"
#include "../kernels/normal_laws.h"

namespace pyjkr {

struct ContactRecord {
  PairProperties pair;
  NormalState normal;
  double tangential_stiffness = 0.0;
  double tangential_damping = 0.0;
  double pull_off_force_original = 0.0;
  double time_in_contact = 0.0;    // of this step [s]: the time step, less in the step a contact is made
  bool update_history = false;
  Vec3 normal_i_to_j{};
  Vec3 relative_spin{};            // omega_i - omega_j; wall: omega_i
  Vec3 slip_velocity{};            // u_i - u_j at the contact
  double size_asymmetry = 0.0;     // (r_j - r_i)/(r_j + r_i); wall: 1
  double reduced_inertia = 0.0;    // 1/I_r = 1/I_i + 1/I_j
  Turn turn{};
};

}  // namespace pyjkr

#endif
