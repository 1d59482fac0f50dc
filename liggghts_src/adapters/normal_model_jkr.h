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

  // This contact was there a step ago, and is corrected for where it ends. Of two triangles that meet under a sphere
  // only one carries its contact.
  bool carries_contact(const double* history) const { return speed_slot_ >= 0 && history[speed_slot_] != 0.0; }

  void forget(double* history) const {
    if (!history) return;
    if (contact_slot_ >= 0) history[contact_slot_] = 0.0;
    if (speed_slot_ >= 0) history[speed_slot_] = 0.0;
  }

  // Force on i along e (from j to i) of a contact that exists at the end of this step, its pair and normal state given in
  // the record. Fills the rest of it.
  // `previous` gives the overlap one step ago; asked for only where the contact may be new.
  template <class PreviousOverlap>
  double touch(SurfacesIntersectData& sidata, const PreviousOverlap& previous, ContactRecord& record) const {
    double* const history = sidata.contact_history;
    const PairProperties& pair = record.pair;
    const double dt = update->dt;
    record.stiffness = Law::stiffness(sidata.deltan, record.normal, pair);
    if (!tangential_damping_) record.stiffness.tangential_damping = 0.0;
    record.time_in_contact = record.time_step = dt;
    record.weight = 1.0;

    // At setup and for compute pair/gran/local LIGGGHTS hands over full-step velocities: nothing to correct.
    if (!record.update_history) return record.normal.elastic_force - record.stiffness.damping * sidata.vn;
    const bool known = has_contact(history);
    if (contact_slot_ >= 0) history[contact_slot_] = 1.0;
    if (!event_correction_) return record.normal.elastic_force - record.stiffness.damping * sidata.vn;

    // a contact that was there a step ago carries a speed; one that LIGGGHTS has only seen at setup is told by its path
    const bool maybe_new = !known && sidata.vn < 0.0 && history[speed_slot_] == 0.0;
    record.is_new = history[speed_slot_] == 0.0;
    const double before = maybe_new ? previous(sidata) : 1.0;
    double force;
    if (maybe_new && before <= 0.0) {
      const NormalStep step{sidata.deltan, before, sidata.vn, dt};
      const double theta = fraction_after_make(step);
      record.time_in_contact = theta * dt;
      force = force_of_make<Law>(step, theta, record.normal, pair);
      record.weight = weight_of_make<Law>(theta);
      if (tangential_damping_) record.stiffness.tangential_damping = tangential_damping_of_make<Law>(step, theta, record.stiffness, pair);
    } else {
      const double carried = history[speed_slot_] != 0.0 ? history[speed_slot_] : sidata.vn;
      force = damped_force(record.normal.elastic_force, record.stiffness.damping, sidata.vn, carried, dt, pair.effective_mass);
    }
    history[speed_slot_] = sidata.vn + dt / pair.effective_mass * force;
    return force;
  }

  // Force on i along e that settles the account of a contact that broke within this step. Fills the record with the
  // contact as it was when it broke.
  double settle(double overlap, double previous_overlap, double separation_speed, ContactRecord& record) const {
    const NormalStep step{overlap, previous_overlap, separation_speed, update->dt};
    record.update_history = false;
    record.normal = state_at_break<Law>(record.pair);
    record.stiffness = Law::stiffness(Law::breaking_overlap(record.pair), record.normal, record.pair);
    if (!tangential_damping_) record.stiffness.tangential_damping = 0.0;
    record.weight = weight_of_break<Law>(step, record.pair);
    return force_of_break<Law>(step, record.pair);
  }

 private:
  bool tangential_damping_ = true;
  bool event_correction_ = true;
  int contact_slot_ = -1;
  int speed_slot_ = -1;
};

}  // namespace pyjkr

#endif
