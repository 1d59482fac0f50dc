// rolling_friction krijt: keeps the rolling displacement and the twisting angle of a contact and applies the laws of
// kernels/krijt_rolling.h and kernels/twisting.h. No moment where the surface energy is 0.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_ROLLING_MODEL_KRIJT_H
#define PYJKR_ADAPTERS_ROLLING_MODEL_KRIJT_H

#include "../kernels/jkr_tangential.h"
#include "../kernels/krijt_rolling.h"
#include "../kernels/twisting.h"
#include "contact_record.h"
#include "liggghts_headers.h"

namespace pyjkr {

class RollingModelKrijt {
 public:
  static constexpr bool is_krijt = true;
  static constexpr bool is_off = false;

  RollingModelKrijt(LAMMPS_NS::LAMMPS* lmp, LIGGGHTS::IContactHistorySetup* history, LIGGGHTS::ContactModels::ContactModelBase*)
      : lmp_(lmp) {
    // neither changes where i and j change places: spin difference and normal change sign together
    slot_ = history->add_history_value("rolling_displacement_x", "0");
    history->add_history_value("rolling_displacement_y", "0");
    history->add_history_value("rolling_displacement_z", "0");
  }

  void registerSettings(Settings& settings) {
    settings.registerOnOff("twisting", twisting_, false);
    settings.registerDoubleSetting("rollingDamping", rolling_damping_, 0.0);
  }

  void postSettings(LIGGGHTS::IContactHistorySetup* history) {
    if (!(rolling_damping_ >= 0.0 && rolling_damping_ < 1e300))
      lmp_->error->all(FLERR, "rolling_friction krijt: rollingDamping must be a number >= 0 (fraction of critical damping)");
    if (twisting_) angle_slot_ = history->add_history_value("twisting_angle", "0");
  }

  bool needs_friction() const { return twisting_; }
  bool needs_inertia() const { return rolling_damping_ != 0.0; }

  void forget(double* history) const {
    history[slot_] = history[slot_ + 1] = history[slot_ + 2] = 0.0;
    if (twisting_) history[angle_slot_] = 0.0;
  }

  // Moment on i; j feels the opposite.
  Vec3 moment(const ContactRecord& record, double* history) const {
    if (record.pull_off_force_original == 0.0) return {0.0, 0.0, 0.0};
    Vec3 moment = rolling(record, history);
    if (twisting_) moment = moment + twisting(record, history);
    return moment;
  }

 private:
  Vec3 rolling(const ContactRecord& record, double* history) const {
    const Vec3 velocity = rolling_velocity(record.relative_spin, record.normal_i_to_j, record.slip_velocity,
                                           record.pair.effective_radius, record.size_asymmetry);
    Vec3 displacement = load(history + slot_);
    if (record.update_history) {
      displacement = turned(displacement, record.turn) + record.time_in_contact * velocity;
      displacement = limited_rolling_displacement(displacement, critical_rolling_displacement(record.pair));
      store(displacement, history + slot_);
    }
    const double stiffness =
        rolling_stiffness(record.pull_off_force_original, contact_radius_ratio_power(record.normal));
    const double damping = rolling_damping_ == 0.0 ? 0.0
                                                   : rolling_damping(rolling_damping_, stiffness, record.reduced_inertia,
                                                                     record.pair.effective_radius);
    // weighted here, not after: a product that both partners add or subtract would be rounded differently for either
    // where multiply and add are fused
    return rolling_moment(displacement, velocity, record.normal_i_to_j, record.weight * stiffness, record.weight * damping);
  }

  Vec3 twisting(const ContactRecord& record, double* history) const {
    const double spin = dot(record.relative_spin, record.normal_i_to_j);
    double angle = history[angle_slot_];
    if (record.update_history) angle += record.time_in_contact * spin;
    const double a = record.normal.contact_radius;
    const PairMaterial& material = *record.pair.material;
    const double original = a * material.original_contact_radius_ratio;
    const double limit = twisting_limit(original, sliding_limit(record.normal.elastic_force, record.pull_off_force_original,
                                                                material.friction_coefficient));
    const TwistingStep step = twist(angle, spin, 0.5 * record.stiffness.tangential_stiffness * a * a,
                                    0.5 * record.stiffness.tangential_damping * a * a, limit);
    if (record.update_history) history[angle_slot_] = step.angle;
    return (record.weight * step.moment) * record.normal_i_to_j;
  }

  LAMMPS_NS::LAMMPS* lmp_;
  int slot_;
  int angle_slot_ = -1;
  bool twisting_ = false;
  double rolling_damping_ = 0.0;
};

}  // namespace pyjkr

#endif
