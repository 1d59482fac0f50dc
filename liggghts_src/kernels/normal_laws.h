// The two normal models: how long a contact lives, how it is damped, how stiff it is along the surface.
// jkr/simplified: Haervig 2017 eqs 11 (2 sqrt(5/6), not 2 (5/6): only then is e returned), 13, 14.
// jkr: Chen 2019 eqs 1a-1c with alpha = sqrt(5) |beta| for the effective mass; the neck holds down to -delta_C.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_NORMAL_LAWS_H
#define PYJKR_KERNELS_NORMAL_LAWS_H

#include "jkr_normal.h"

namespace pyjkr {

constexpr double kTwiceRootFiveSixths = 1.82574185835055371152;
constexpr double kRootFive = 2.23606797749978969641;

struct SimplifiedJkr {
  static constexpr bool has_neck = false;

  static double breaking_overlap(const PairProperties&) { return 0.0; }
  static double breaking_force(const PairProperties& pair) { return force_at_zero_overlap(pair); }

  // eta_N = 2 sqrt(5/6) |beta| sqrt(S_n m), S_n = 2 E sqrt(R delta) [kg/s]
  static double damping(double overlap, const NormalState&, const PairProperties& pair) {
    const PairMaterial& material = *pair.material;
    const double stiffness = 2.0 * material.effective_modulus * std::sqrt(pair.effective_radius * overlap);
    return kTwiceRootFiveSixths * material.damping_ratio * std::sqrt(stiffness * pair.effective_mass);
  }

  // k_T = 8 G sqrt(R delta) [N/m]
  static double tangential_stiffness(double overlap, const NormalState&, const PairProperties& pair) {
    return 8.0 * pair.material->effective_shear_modulus * std::sqrt(pair.effective_radius * overlap);
  }
};

struct FullJkr {
  static constexpr bool has_neck = true;

  static double breaking_overlap(const PairProperties& pair) { return rupture_overlap(pair); }
  static double breaking_force(const PairProperties& pair) { return force_at_rupture(pair); }

  // eta_N = sqrt(5) |beta| sqrt(m (4/3) E a) [kg/s], in the neck too
  static double damping(double, const NormalState& state, const PairProperties& pair) {
    const PairMaterial& material = *pair.material;
    const double stiffness = 4.0 / 3.0 * material.effective_modulus * state.contact_radius;
    return kRootFive * material.damping_ratio * std::sqrt(stiffness * pair.effective_mass);
  }

  // k_T = 8 G a [N/m]
  static double tangential_stiffness(double, const NormalState& state, const PairProperties& pair) {
    return 8.0 * pair.material->effective_shear_modulus * state.contact_radius;
  }
};

// eta_T = 2 sqrt(5/6) |beta| sqrt(k_T m) [kg/s], Haervig 2017 eq. 16.
inline double tangential_damping(double tangential_stiffness, const PairProperties& pair) {
  return kTwiceRootFiveSixths * pair.material->damping_ratio *
         std::sqrt(tangential_stiffness * pair.effective_mass);
}

}  // namespace pyjkr

#endif
