// The two normal models: how long a contact lives, how it is damped, how stiff it is along the surface.
// jkr/simplified: Haervig 2017 eqs 11 (2 sqrt(5/6), not 2 (5/6): only then is e returned), 13, 14.
// jkr: Chen 2019 eqs 1a-1c with alpha = sqrt(5) |beta| for the effective mass; the neck holds down to -delta_C.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_NORMAL_LAWS_H
#define PYJKR_KERNELS_NORMAL_LAWS_H

#include "jkr_normal.h"

namespace pyjkr {

// Both laws damp and resist sliding through one length l: eta_N ~ sqrt(l m), k_T = 8 G l, eta_T ~ sqrt(k_T m).
struct ContactStiffness {
  double tangential_stiffness;   // k_T [N/m]
  double damping;                // eta_N [kg/s]
  double tangential_damping;     // eta_T = 2 sqrt(5/6) |beta| sqrt(k_T m) [kg/s], Haervig 2017 eq. 16
};

inline ContactStiffness stiffness_of_length(double length, double normal_damping_scale, const PairProperties& pair) {
  const double root = std::sqrt(length * pair.effective_mass);
  return {8.0 * pair.material->effective_shear_modulus * length, normal_damping_scale * root,
          pair.material->tangential_damping_scale * root};
}

struct SimplifiedJkr {
  static constexpr bool has_neck = false;

  static double breaking_overlap(const PairProperties&) { return 0.0; }
  static double breaking_force(const PairProperties& pair) { return force_at_zero_overlap(pair); }

  // l = sqrt(R delta): eta_N = 2 sqrt(5/6) |beta| sqrt(S_n m) with S_n = 2 E l; k_T = 8 G l
  static ContactStiffness stiffness(double overlap, const NormalState&, const PairProperties& pair) {
    return stiffness_of_length(std::sqrt(pair.effective_radius * overlap),
                               pair.material->normal_damping_scale_simplified, pair);
  }
};

struct FullJkr {
  static constexpr bool has_neck = true;

  static double breaking_overlap(const PairProperties& pair) { return rupture_overlap(pair); }
  static double breaking_force(const PairProperties& pair) { return force_at_rupture(pair); }

  // l = a, in the neck too: eta_N = sqrt(5) |beta| sqrt(m (4/3) E a); k_T = 8 G a
  static ContactStiffness stiffness(double, const NormalState& state, const PairProperties& pair) {
    return stiffness_of_length(state.contact_radius, pair.material->normal_damping_scale_full, pair);
  }
};

}  // namespace pyjkr

#endif
