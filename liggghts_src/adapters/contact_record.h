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
  ContactStiffness stiffness;
  double weight;             // of sliding and rolling loads: 1, or what the step of the make or the break leaves of them
  double time_in_contact;    // of this step [s]: the time step, less in the step a contact is made
  double time_step;
  bool is_new;               // no step before this one to carry a speed from
  bool update_history;
  // filled only where a jkr or krijt slot needs them
  double pull_off_force_original;
  Vec3 normal_i_to_j;
  Vec3 relative_spin;        // omega_i - omega_j; wall: omega_i
  Vec3 center_velocity;      // of i past j, tangential
  Vec3 slip_velocity;        // u_i - u_j at the contact
  double size_asymmetry;     // (r_j - r_i)/(r_j + r_i); wall: 1
  double reduced_inertia;    // 1/I_r = 1/I_i + 1/I_j; filled where rolling is damped
  Turn turn;
};

}  // namespace pyjkr

#endif
