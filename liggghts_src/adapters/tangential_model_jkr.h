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

  void postSettings(LIGGGHTS::IContactHistorySetup* history, bool event_correction) {
    if (!event_correction) return;
    carried_slot_ = history->add_history_value("carried_slip_x", "1");
    history->add_history_value("carried_slip_y", "1");
    history->add_history_value("carried_slip_z", "1");
  }

  void forget(double* history) const {
    store({0.0, 0.0, 0.0}, history + slot_);
    if (carried_slot_ >= 0) store({0.0, 0.0, 0.0}, history + carried_slot_);
  }

  // Force on i; the surface model's lever arms turn it into moments.
  Vec3 force(const ContactRecord& record, double* history) const {
    Vec3 displacement = load(history + slot_);
    if (record.update_history)
      displacement = turned(displacement, record.turn) + record.time_in_contact * record.slip_velocity;
    const double limit = sliding_limit(record.normal.elastic_force, record.pull_off_force_original,
                                       record.pair.material->friction_coefficient);
    if (!record.update_history || carried_slot_ < 0) {
      const SlidingStep step = slide(displacement, record.slip_velocity, record.stiffness.tangential_stiffness,
                                     record.stiffness.tangential_damping, limit);
      if (record.update_history) store(step.displacement, history + slot_);
      return record.weight * step.force;
    }
    const double step_per_mass = 3.5 * (record.time_step / record.pair.effective_mass);
    const Vec3 carried = record.is_new ? record.slip_velocity : turned(load(history + carried_slot_), record.turn);
    const SlipAtEnd slip = slip_at_end(record.slip_velocity, carried, record.stiffness.tangential_damping, step_per_mass);
    const SlidingStep step = slide(displacement, slip, record.stiffness.tangential_stiffness, record.stiffness.tangential_damping, limit);
    const Vec3 force = record.weight * step.force;
    store(step.displacement, history + slot_);
    store(record.slip_velocity + step_per_mass * force, history + carried_slot_);
    return force;
  }

 private:
  int slot_;
  int carried_slot_ = -1;
};

}  // namespace pyjkr

#endif
