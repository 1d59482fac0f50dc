// Normal force of a jkr model in one step, with the bookkeeping of a time integrator around the law:
// the previous overlap, the speed at the full step, the steps in which a contact is made or broken.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_NORMAL_MODEL_JKR_H
#define PYJKR_ADAPTERS_NORMAL_MODEL_JKR_H

#include "../kernels/event_correction.h"
#include "contact_record.h"
#include "liggghts_headers.h"

namespace pyjkr {

using LIGGGHTS::ContactModels::SurfacesIntersectData;

template <class Law>
class NormalModelJkr : protected LAMMPS_NS::Pointers {
 public:
  NormalModelJkr(LAMMPS_NS::LAMMPS* lmp) : Pointers(lmp) {}

  void registerSettings(Settings& settings) {
    settings.registerOnOff("tangential_damping", tangential_damping_, true);
    settings.registerOnOff("eventCorrection", event_correction_, true);
  }

  void postSettings(LIGGGHTS::IContactHistorySetup* history) {
    if (Law::has_neck) contact_slot_ = history->add_history_value("jkr_contact", "0");
    // half-step separation speed and own impulse of the step before, see damped_force(); 0: no step before
    if (event_correction_) speed_slot_ = history->add_history_value("jkr_carried_speed", "0");
  }

  bool event_correction() const { return event_correction_; }

  // A neck is alive in this contact's history.
  bool has_contact(const double* history) const { return contact_slot_ >= 0 && history && history[contact_slot_] != 0.0; }

  void forget(double* history) const {
    if (!history) return;
    if (contact_slot_ >= 0) history[contact_slot_] = 0.0;
    if (speed_slot_ >= 0) history[speed_slot_] = 0.0;
  }

  // Force on i along e (from j to i) of a contact that exists at the end of this step. Fills the record.
  double touch(SurfacesIntersectData& sidata, double previous_overlap, ContactRecord& record) const {
    double* const history = sidata.contact_history;
    const PairProperties& pair = record.pair;
    const double dt = update->dt;
    record.normal = normal_state(sidata.deltan, pair);
    record.tangential_stiffness = Law::tangential_stiffness(sidata.deltan, record.normal, pair);
    record.tangential_damping = tangential_damping_ ? tangential_damping(record.tangential_stiffness, pair) : 0.0;
    record.time_in_contact = dt;

    const double damping = Law::damping(sidata.deltan, record.normal, pair);
    // At setup and for compute pair/gran/local LIGGGHTS hands over full-step velocities: nothing to correct.
    if (!record.update_history || !event_correction_) {
      if (record.update_history && contact_slot_ >= 0) history[contact_slot_] = 1.0;
      return record.normal.elastic_force - damping * sidata.vn;
    }
    const bool made_now = previous_overlap <= 0.0 && !has_contact(history);
    if (contact_slot_ >= 0) history[contact_slot_] = 1.0;
    double force;
    if (made_now) {
      const NormalStep step{sidata.deltan, previous_overlap, sidata.vn, dt};
      const double theta = fraction_after_make(step);
      record.time_in_contact = theta * dt;
      force = force_of_make<Law>(step, theta, record.normal, pair);
    } else {
      const double carried = history[speed_slot_] != 0.0 ? history[speed_slot_] : sidata.vn;
      force = damped_force(record.normal.elastic_force, damping, sidata.vn, carried, dt, pair.effective_mass);
    }
    history[speed_slot_] = sidata.vn + dt * force / pair.effective_mass;
    return force;
  }

  // Force on i along e that settles the account of a contact that broke within this step.
  double settle(double overlap, double previous_overlap, double separation_speed, const PairProperties& pair) const {
    return force_of_break<Law>({overlap, previous_overlap, separation_speed, update->dt}, pair);
  }

 private:
  bool tangential_damping_ = true;
  bool event_correction_ = true;
  int contact_slot_ = -1;
  int speed_slot_ = -1;
};

}  // namespace pyjkr

#endif
