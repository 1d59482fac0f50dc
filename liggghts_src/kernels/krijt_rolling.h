// Rolling resistance of an adhesive contact: the contact area lags behind the rolling sphere.
// Haervig 2017 eqs 18-22 (Dominik & Tielens 1997, Krijt 2014) with the misprint and sign of eq. 20 mended; Chen 2019
// eqs 1d, 11. F_C and xi_crit of the real surfaces, (a/a_0) of the normal law.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_KRIJT_ROLLING_H
#define PYJKR_KERNELS_KRIJT_ROLLING_H

#include "history.h"
#include "pair_properties.h"

namespace pyjkr {

// v_L = -R (omega_i - omega_j) x n + 1/2 (r_j - r_i)/(r_j + r_i) v_S, n from i to j; wall: size_asymmetry = 1.
inline Vec3 rolling_velocity(const Vec3& relative_spin, const Vec3& normal_i_to_j, const Vec3& slip_velocity,
                             double effective_radius, double size_asymmetry) {
  return effective_radius * cross(normal_i_to_j, relative_spin) + 0.5 * size_asymmetry * slip_velocity;
}

// k_r = 4 F_C (a/a_0)^(3/2) [N]
inline double rolling_stiffness(double pull_off_force_of_surfaces, double contact_radius_ratio_power) {
  return 4.0 * pull_off_force_of_surfaces * contact_radius_ratio_power;
}

// xi_crit [m]: a_0/12 Delta gamma/gamma (eq. 18), or theta_crit R (Chen 2019 eq. 3c).
inline double critical_rolling_displacement(const PairProperties& pair) {
  const PairMaterial& material = *pair.material;
  if (material.critical_rolling_angle >= 0.0) return material.critical_rolling_angle * pair.effective_radius;
  return equilibrium_contact_radius_original(pair) / 12.0 * material.adhesion_hysteresis;
}

// Dashpot eta_R = 2 x sqrt(k_r I_r / R) [kg m/s]; `fraction` x of the critical damping of the rolling mode.
inline double rolling_damping(double fraction, double stiffness, double reduced_inertia, double effective_radius) {
  return 2.0 * fraction * std::sqrt(stiffness * reduced_inertia / effective_radius);
}

// |xi| <= xi_crit, eq. 22.
inline Vec3 limited_rolling_displacement(const Vec3& displacement, double critical) {
  const double square = dot(displacement, displacement);
  if (square <= critical * critical) return displacement;
  return (critical / std::sqrt(square)) * displacement;
}

// Moment on i; j feels the opposite. It turns i against the rolling that made xi: M_i = n x (k_r xi + eta_R v_L).
inline Vec3 rolling_moment(const Vec3& displacement, const Vec3& velocity, const Vec3& normal_i_to_j, double stiffness,
                           double damping) {
  return cross(normal_i_to_j, stiffness * displacement + damping * velocity);
}

}  // namespace pyjkr

#endif
