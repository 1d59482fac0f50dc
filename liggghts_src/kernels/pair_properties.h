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
  // What can be said of a contact before its radii, overlap and masses are known: see set_constants().
  double zero_overlap_scale = 0.0;             // cbrt(4 pi gamma / E): a_1 = scale R^(2/3)
  double inverse_zero_overlap_scale_sq = 0.0;  // its inverse square; infinite without adhesion
  double equilibrium_scale_original = 0.0;     // cbrt(9 pi gamma / E) of the real material: a_0 = scale R^(2/3), eq. 7
  double original_contact_radius_ratio = 1.0;  // a_0 of the real material over a_0 of the normal law
  double normal_damping_scale_simplified = 0.0;  // 2 sqrt(5/6) |beta| sqrt(2 E)
  double normal_damping_scale_full = 0.0;        // sqrt(5) |beta| sqrt(4 E / 3)
  double tangential_damping_scale = 0.0;         // 2 sqrt(5/6) |beta| sqrt(8 G)
};

constexpr double kTwiceRootFiveSixths = 1.82574185835055371152;
constexpr double kRootFive = 2.23606797749978969641;

inline void set_constants(PairMaterial& material, double effective_modulus_original) {
  const double modulus = material.effective_modulus, energy = material.surface_energy;
  material.zero_overlap_scale = std::cbrt(4.0 * kPi * energy / modulus);
  material.inverse_zero_overlap_scale_sq = 1.0 / (material.zero_overlap_scale * material.zero_overlap_scale);
  material.equilibrium_scale_original =
      std::cbrt(9.0 * kPi * material.surface_energy_original / effective_modulus_original);
  material.original_contact_radius_ratio =
      energy > 0.0 ? material.equilibrium_scale_original / std::cbrt(9.0 * kPi * energy / modulus) : 1.0;
  const double tsuji = kTwiceRootFiveSixths * material.damping_ratio;
  material.normal_damping_scale_simplified = tsuji * std::sqrt(2.0 * modulus);
  material.normal_damping_scale_full = kRootFive * material.damping_ratio * std::sqrt(4.0 / 3.0 * modulus);
  material.tangential_damping_scale = tsuji * std::sqrt(8.0 * material.effective_shear_modulus);
}

// Geometry and inertia of one contact.
struct PairProperties {
  const PairMaterial* material;
  double effective_radius;       // R [m]
  double inverse_radius_root;    // R^(-1/3)
  double effective_mass;         // m [kg]
};

inline PairProperties pair_properties(const PairMaterial& material, double effective_radius, double effective_mass) {
  return {&material, effective_radius, 1.0 / std::cbrt(effective_radius), effective_mass};
}

// a_1 = (4 pi gamma R^2/E)^(1/3) [m], the contact radius at zero overlap.
inline double contact_radius_at_zero_overlap(const PairProperties& pair) {
  return pair.material->zero_overlap_scale * pair.effective_radius * pair.inverse_radius_root;
}

// delta R/a_1^2 per overlap [1/m]: R a_1^-2 = scale^-2 R^(-1/3), no division a contact.
inline double reduced_overlap_per_overlap(const PairProperties& pair) {
  return pair.material->inverse_zero_overlap_scale_sq * pair.inverse_radius_root;
}

// F_C = 3 pi R gamma [N], positive; of the normal law and of the real surfaces.
inline double pull_off_force(const PairProperties& pair) {
  return 3.0 * kPi * pair.effective_radius * pair.material->surface_energy;
}
inline double pull_off_force_original(const PairProperties& pair) {
  return 3.0 * kPi * pair.effective_radius * pair.material->surface_energy_original;
}

// a_0 [m] of the real surfaces, Haervig 2017 eq. 7.
inline double equilibrium_contact_radius_original(const PairProperties& pair) {
  return pair.material->equilibrium_scale_original * pair.effective_radius * pair.inverse_radius_root;
}

}  // namespace pyjkr

#endif
