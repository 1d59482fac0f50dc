// Contact that begins and ends inside a time step: weights that give the exact impulse of the step.
// Velocity Verlet sums forces by the trapezium rule; for a force that goes as t^p from an event on, the generalised
// Euler-Maclaurin formula says what the sample next to the event must weigh: -zeta(-p, 1 + theta) / theta^p, theta =
// the part of the step spent in contact (p = 0: 1/2 + theta). Damping at the full-step speed.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_EVENT_CORRECTION_H
#define PYJKR_KERNELS_EVENT_CORRECTION_H

#include "normal_laws.h"

namespace pyjkr {

// -zeta(-1/4, 1 + theta) on [0, 1], fit good to 3e-7.
inline double quarter_power_weight(double theta) {
  return 0.3204509825948532 +
         theta * (0.8603462846879552 +
                  theta * (0.1835679756666232 +
                           theta * (-0.06635010910709965 +
                                    theta * (0.03295421629726681 +
                                             theta * (-0.013196925382710835 + theta * 0.002679058251086233)))));
}

// -zeta(-1/2, 1 + theta) on [0, 1], fit good to 3e-7.
inline double square_root_weight(double theta) {
  return 0.20788595472859478 +
         theta * (0.7302011104943315 +
                  theta * (0.32616599106944294 +
                           theta * (-0.08140738427864914 +
                                    theta * (0.03603518484863556 +
                                             theta * (-0.013708746541600966 + theta * 0.0027143266988299618)))));
}

// One step of one contact. Speeds are those of separation, (v_i - v_j) . e with e from j to i, at the half step.
struct NormalStep {
  double overlap;            // at the end of the step
  double previous_overlap;   // at its beginning
  double separation_speed;   // half step
  double time_step;
};

// Damped force with the damping taken at the full-step speed.
//
// v_full = v_half + (dt/2) a, and a = a_previous + (F - F_previous)/m: the contact's own force is known to change, all
// others are taken to stay. In a collision of two that is exact, in a contact at rest under load it is unbiased.
// `carried_speed` is v_half + dt F/m of the step before; pass v_half where there was none.
inline double damped_force(double elastic_force, double damping, double separation_speed, double carried_speed,
                           double time_step, double effective_mass) {
  const double speed = 1.5 * separation_speed - 0.5 * carried_speed;
  return (elastic_force - damping * speed) / (1.0 + 0.5 * damping * (time_step / effective_mass));
}

// Part of a step that a contact existed when it was made in it: free flight before, so the path is straight.
inline double fraction_after_make(const NormalStep& step) {
  const double closed = step.overlap - step.previous_overlap;
  if (!(closed > 0.0)) return 1.0;
  const double theta = step.overlap / closed;
  return theta < 0.0 ? 0.0 : theta > 1.0 ? 1.0 : theta;
}

// Part of a step before a contact broke at `breaking_overlap`. Under the breaking force the path is a parabola:
// x(tau) = (s - A/2) tau + (A/2) tau^2 with s the separation of the step and A = F dt^2/m; solved for x = what was left.
inline double fraction_before_break(const NormalStep& step, double breaking_overlap, double breaking_force,
                                    double effective_mass) {
  const double left = step.previous_overlap - breaking_overlap;
  const double separated = step.previous_overlap - step.overlap;
  if (!(separated > 0.0) || !(left > 0.0)) return 0.0;
  const double bend = breaking_force * step.time_step * step.time_step / effective_mass;
  const double start = separated - 0.5 * bend;
  const double discriminant = start * start + 2.0 * bend * left;
  const double theta = discriminant > 0.0 ? 2.0 * left / (start + std::sqrt(discriminant)) : left / separated;
  return theta < 0.0 ? 0.0 : theta > 1.0 ? 1.0 : theta;
}

// dF/d(delta) at delta = 0 [N/m]: u = 1 there.
inline double slope_at_zero_overlap(const PairProperties& pair) {
  if (pair.material->surface_energy == 0.0) return 0.0;
  const double a1 = contact_radius_at_zero_overlap(pair);
  const double ratio = pair.effective_radius / a1;
  return 8.0 / 3.0 * kPi * pair.material->surface_energy * ratio * ratio;
}

// Normal force of the step in which a contact was made, weighted by the part of the step it existed.
template <class Law>
inline double force_of_make(const NormalStep& step, double theta, const NormalState& state,
                            const PairProperties& pair) {
  const double dt = step.time_step, mass = pair.effective_mass;
  const double closed = step.overlap - step.previous_overlap;
  const double weight = 0.5 + theta;
  double damping;
  if (Law::has_neck) {
    damping = weight * Law::stiffness(step.overlap, state, pair).damping;
  } else {
    // eta goes as delta^(1/4) and so as t^(1/4): its value after a whole step in contact, times the weight of p = 1/4
    damping = Law::stiffness(closed, state, pair).damping * quarter_power_weight(theta);
  }
  double elastic = weight * state.elastic_force;
  // the part of the force that grows as t: weight -zeta(-1, 1 + theta) = (theta^2 + theta + 1/6)/2 in place of the above
  elastic += 0.5 * slope_at_zero_overlap(pair) * closed * (1.0 / 6.0 - theta * theta);
  // The sphere has also missed the way F0 theta^2 dt^2/(2 m) that the force took it within the step. Its speed is
  // lowered to where kinetic and potential energy are right together: v'^2 = v^2 - (theta F0 dt/m)^2.
  const double kick = std::fabs(force_at_zero_overlap(pair)) * dt / mass;
  if (kick > 0.0 && theta > 0.0) {
    const double speed = -step.separation_speed + weight * kick;
    const double missed = theta * kick;
    elastic += mass / dt * missed * missed / (speed + std::sqrt(speed * speed - missed * missed));
  }
  // no step before this one to extrapolate from: the approach was free, so the force of the contact is all there is
  return damped_force(elastic, damping, step.separation_speed, step.separation_speed, dt, mass);
}

// Weight of the sliding and rolling loads in the step in which a contact was made: they begin at once where a contact has
// a size from the start (p = 0), and grow from nothing otherwise.
template <class Law>
inline double weight_of_make(double theta) {
  return Law::has_neck ? 0.5 + theta : 1.0;
}

// eta_T of that step: as eta_N, it goes as t^(1/4) where the overlap does (p = 1/4).
template <class Law>
inline double tangential_damping_of_make(const NormalStep& step, double theta, const ContactStiffness& stiffness,
                                         const PairProperties& pair) {
  if (Law::has_neck) return stiffness.tangential_damping;
  const double whole_step = Law::stiffness(step.overlap - step.previous_overlap, NormalState{}, pair).tangential_damping;
  return whole_step * quarter_power_weight(theta);
}

// What the step of the break leaves of the loads that the contact had when it broke.
template <class Law>
inline double weight_of_break(const NormalStep& step, const PairProperties& pair) {
  if (!Law::has_neck) return 0.0;
  return fraction_before_break(step, Law::breaking_overlap(pair), Law::breaking_force(pair), pair.effective_mass) - 0.5;
}

// The contact at the moment it breaks.
template <class Law>
inline NormalState state_at_break(const PairProperties& pair) {
  const double a1 = contact_radius_at_zero_overlap(pair);
  if (!Law::has_neck) return {a1, 1.0, Law::breaking_force(pair)};
  return {a1 * kRuptureRoot * kRuptureRoot, kRuptureRoot, Law::breaking_force(pair)};
}

// Force that carries the impulse left over by the step in which a contact broke.
template <class Law>
inline double force_of_break(const NormalStep& step, const PairProperties& pair) {
  const double end = Law::breaking_overlap(pair);
  const double force = Law::breaking_force(pair);
  const double theta = fraction_before_break(step, end, force, pair.effective_mass);
  const double separated = step.previous_overlap - step.overlap;
  const double speed = step.separation_speed;
  double left_over = (theta - 0.5) * force;  // p = 0
  if (!Law::has_neck) {
    const double whole_step = Law::stiffness(separated, NormalState{}, pair).damping;
    left_over -= (quarter_power_weight(theta) - std::sqrt(std::sqrt(theta))) * whole_step * speed;
    left_over += 0.5 * slope_at_zero_overlap(pair) * separated * (theta * theta - theta + 1.0 / 6.0);  // p = 1
  } else if (pair.material->surface_energy > 0.0) {
    // next to the snap u - u_c = t / (sqrt(6) u_c) with t^2 = (delta + delta_C) R / a_1^2: a square root in time
    const double a1 = contact_radius_at_zero_overlap(pair);
    const double root_step = std::sqrt(separated * pair.effective_radius) / (a1 * 2.44948974278317809820 * kRuptureRoot);
    const double force_slope = -16.0 * kPi * pair.material->surface_energy * pair.effective_radius * kRuptureRoot * kRuptureRoot;
    const NormalState snap{a1 * kRuptureRoot * kRuptureRoot, kRuptureRoot, force};
    const double damping = Law::stiffness(end, snap, pair).damping;
    const double square_root_part = square_root_weight(theta) - std::sqrt(theta);
    left_over += square_root_part * root_step * force_slope;
    left_over -= ((theta - 0.5) + square_root_part * root_step / kRuptureRoot) * damping * speed;
  }
  return left_over;
}

}  // namespace pyjkr

#endif
