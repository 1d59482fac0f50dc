// What one contact's laws need to know of its two partners: mixed radii, masses, moduli, surface energies.
// Haervig 2017 eqs 2, 7, 12, 15; Chen 2019 eqs 11, 12 for the original values. A wall is the limit of an infinite
// second sphere: R = r, m = m_i, I = I_i.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_PAIR_PROPERTIES_H
#define PYJKR_KERNELS_PAIR_PROPERTIES_H

#include <cmath>

namespace pyjkr {

constexpr double kPi = 3.14159265358979323846;

// Constants of a pair of materials. "original" values belong to the real material where stiffness is reduced.
struct PairMaterial {
  double effective_modulus = 0.0;         // E [Pa] of the normal law, eq. 2
  double effective_shear_modulus = 0.0;   // G [Pa], eq. 15
  double damping_ratio = 0.0;             // |beta|, eq. 12
  double surface_energy = 0.0;            // gamma [J/m2] of the normal law
  double surface_energy_original = 0.0;   // gamma [J/m2] of sliding, rolling and twisting
  double friction_coefficient = 0.0;      // mu
  double adhesion_hysteresis = -1.0;      // Delta gamma / gamma, negative: not given
  double critical_rolling_angle = -1.0;   // theta_crit [rad], negative: not given
  // The two length scales go with cbrt(R^2); what is left of them is a constant of the material.
  double zero_overlap_scale = 0.0;        // cbrt(4 pi gamma / E): a_1 = scale * cbrt(R^2)
  double equilibrium_scale = 0.0;         // cbrt(9 pi gamma / E): a_0 = scale * cbrt(R^2), eq. 7
  double equilibrium_scale_original = 0.0;
};

inline void set_length_scales(PairMaterial& material, double effective_modulus_original) {
  material.zero_overlap_scale = std::cbrt(4.0 * kPi * material.surface_energy / material.effective_modulus);
  material.equilibrium_scale = std::cbrt(9.0 * kPi * material.surface_energy / material.effective_modulus);
  material.equilibrium_scale_original =
      std::cbrt(9.0 * kPi * material.surface_energy_original / effective_modulus_original);
}

// Geometry and inertia of one contact.
struct PairProperties {
  const PairMaterial* material = nullptr;
  double effective_radius = 0.0;   // R [m]
  double radius_power = 0.0;       // cbrt(R^2)
  double effective_mass = 0.0;     // m [kg]
};

inline PairProperties pair_properties(const PairMaterial& material, double effective_radius, double effective_mass) {
  const double root = std::cbrt(effective_radius);
  return {&material, effective_radius, root * root, effective_mass};
}

// F_C = 3 pi R gamma [N], positive; of the normal law and of the real surfaces.
inline double pull_off_force(const PairProperties& pair) {
  return 3.0 * kPi * pair.effective_radius * pair.material->surface_energy;
}
inline double pull_off_force_original(const PairProperties& pair) {
  return 3.0 * kPi * pair.effective_radius * pair.material->surface_energy_original;
}

// a_0 [m], Haervig 2017 eq. 7.
inline double equilibrium_contact_radius(const PairProperties& pair) {
  return pair.material->equilibrium_scale * pair.radius_power;
}
inline double equilibrium_contact_radius_original(const PairProperties& pair) {
  return pair.material->equilibrium_scale_original * pair.radius_power;
}

}  // namespace pyjkr

#endif
