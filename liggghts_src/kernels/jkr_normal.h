// Adhesive normal contact of Johnson, Kendall and Roberts: contact radius, elastic force, rupture.
// Haervig 2017 eqs 8-10, Chen 2019 eqs 1a and 6. Small strains, short-range adhesion (Tabor number above 3 to 5).
// With a = a_1 u^2 and a_1^3 = 4 pi gamma R^2 / E the law is free of parameters: u^4 - u = delta R / a_1^2.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_JKR_NORMAL_H
#define PYJKR_KERNELS_JKR_NORMAL_H

#include "pair_properties.h"

namespace pyjkr {

// The point where a stretched neck snaps: du/dD diverges, u_c = 4^(-1/3), D_c = u_c^4 - u_c.
constexpr double kRuptureRoot = 0.62996052494743658238;
constexpr double kRuptureOverlap = -0.47247039371057743679;

struct NormalState {
  double contact_radius;   // a [m]
  double root;             // u = sqrt(a/a_1); 0 without adhesion
  double elastic_force;    // [N], repulsive positive, without damping
};

// Largest real root of u^4 - u = D.
//
// Written for w = u - u_c and t^2 = D - D_c, where the quartic has a double root: t^2 = w^2 (w^2 + 4 u_c w + 6 u_c^2).
// No term of it cancels, so w keeps its relative accuracy down to the rupture. The start, w = t v P(v) with
// v = (t + 1.2)^(-1/2), is off by 9e-7 at most (own fit, checked by the tests); one Halley step leaves round-off.
inline double contact_radius_root(double reduced_overlap) {
  const double square = reduced_overlap - kRuptureOverlap;
  const double t = std::sqrt(square);
  // square root and division side by side, and the polynomial in pairs: less to wait for
  const double v = std::sqrt(t + 1.2) * (1.0 / (t + 1.2));
  const double v2 = v * v;
  const double start = (0.9999991103220877 - 0.6298469944123006 * v) +
                       v2 * ((0.5976449543859754 - 0.48756964688412713 * v) +
                             v2 * ((0.35296495840789877 - 0.17388251108722425 * v) + v2 * 0.03954899984964313));
  double w = t * v * start;
  const double u = w + kRuptureRoot;
  constexpr double c2 = 6.0 * kRuptureRoot * kRuptureRoot;
  const double residual = w * w * (w * (w + 4.0 * kRuptureRoot) + c2) - square;
  const double slope = w * (w * (4.0 * w + 12.0 * kRuptureRoot) + 2.0 * c2);
  const double curvature = 12.0 * u * u;
  w -= 2.0 * residual * slope / (2.0 * slope * slope - residual * curvature);
  return square > 0.0 ? w + kRuptureRoot : kRuptureRoot;  // at or past the rupture by round-off of the overlap
}

// Overlap at which a stretched neck snaps under prescribed separation [m], negative. Chen 2019 eq. 6:
// -delta_C = -a_0^2 / (2 6^(1/3) R).
inline double rupture_overlap(const PairProperties& pair) {
  const double a1 = contact_radius_at_zero_overlap(pair);
  return kRuptureOverlap * a1 * a1 / pair.effective_radius;
}

// Above this reduced overlap adhesion changes the force by D^(-3/4) = 1e-18 of itself: Hertz to round-off.
constexpr double kNoAdhesionLeft = 1e24;

// Contact radius and elastic force at an overlap whose root is known; without adhesion the root is not looked at.
inline NormalState normal_state_of_root(double overlap, double reduced_overlap, double root, const PairProperties& pair) {
  const PairMaterial& material = *pair.material;
  const double radius = pair.effective_radius;
  // without surface energy the reduced overlap is infinite, or not a number at zero overlap
  if (!(reduced_overlap <= kNoAdhesionLeft)) {
    const double a = std::sqrt(radius * overlap);
    return {a, 0.0, 4.0 / 3.0 * material.effective_modulus * a * overlap};
  }
  const double cube = root * root * root;
  // eqs 8 and 9 together: F = 4 E a^3/(3 R) - 4 sqrt(pi gamma E a^3)
  const double force = 8.0 * kPi * material.surface_energy * radius * cube * (2.0 / 3.0 * cube - 1.0);
  return {contact_radius_at_zero_overlap(pair) * root * root, root, force};
}

// Contact radius and elastic force at an overlap, valid from the rupture overlap upwards.
inline NormalState normal_state(double overlap, const PairProperties& pair) {
  const double reduced_overlap = overlap * reduced_overlap_per_overlap(pair);
  return normal_state_of_root(overlap, reduced_overlap, contact_radius_root(reduced_overlap), pair);
}

// (a/a_0)^(3/2) of the normal law; a_0^3 = (9/4) a_1^3.
inline double contact_radius_ratio_power(const NormalState& state) {
  return 2.0 / 3.0 * state.root * state.root * state.root;
}

// Force with which a contact ends [N]: -(8/9) F_C at delta = 0 (simplified), -(5/9) F_C at the snap (full).
inline double force_at_zero_overlap(const PairProperties& pair) { return -8.0 / 9.0 * pull_off_force(pair); }
inline double force_at_rupture(const PairProperties& pair) { return -5.0 / 9.0 * pull_off_force(pair); }

}  // namespace pyjkr

#endif
