// tangential jkr: keeps the sliding displacement of a contact and applies the law of kernels/jkr_tangential.h.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_TANGENTIAL_MODEL_JKR_H
#define PYJKR_ADAPTERS_TANGENTIAL_MODEL_JKR_H

#include "../kernels/jkr_tangential.h"
#include "contact_record.h"
#include "liggghts_headers.h"

namespace pyjkr {

class TangentialModelJkr {
 public:
  static constexpr bool is_jkr = true;
  static constexpr bool is_off = false;

  TangentialModelJkr(LAMMPS_NS::LAMMPS*, LIGGGHTS::IContactHistorySetup* history, LIGGGHTS::ContactModels::ContactModelBase*) {
    // the displacement of i past j: changes sign where i and j change places
    slot_ = history->add_history_value("sliding_displacement_x", "1");
    history->add_history_value("sliding_displacement_y", "1");
    history->add_history_value("sliding_displacement_z", "1");
  }

  void forget(double* history) const { history[slot_] = history[slot_ + 1] = history[slot_ + 2] = 0.0; }

  // Force on i; the surface model's lever arms turn it into moments.
  Vec3 force(const ContactRecord& record, double* history) const {
    Vec3 displacement = load(history + slot_);
    if (record.update_history)
      displacement = turned(displacement, record.turn) + record.time_in_contact * record.slip_velocity;
    const double limit = sliding_limit(record.normal.elastic_force, record.pull_off_force_original,
                                       record.pair.material->friction_coefficient);
    const SlidingStep step = slide(displacement, record.slip_velocity, record.stiffness.tangential_stiffness,
                                   record.stiffness.tangential_damping, limit);
    if (record.update_history) store(step.displacement, history + slot_);
    return step.force;
  }

 private:
  int slot_;
};

}  // namespace pyjkr

#endif
