// C wrappers of the kernels, so that tests can call each from Python (ctypes) without a simulator.
// Arrays are contiguous doubles; vectors are xyz triples.
// SPDX-License-Identifier: GPL-2.0-or-later

#include "kernels/event_correction.h"
#include "kernels/jkr_tangential.h"
#include "kernels/krijt_rolling.h"
#include "kernels/twisting.h"

using namespace pyjkr;

namespace {

struct Contact {
  PairMaterial material;
  PairProperties pair;
  Contact(double radius, double mass, double modulus, double shear, double energy, double damping_ratio) {
    material.effective_modulus = modulus;
    material.effective_shear_modulus = shear;
    material.surface_energy = material.surface_energy_original = energy;
    material.damping_ratio = damping_ratio;
    set_constants(material, modulus);
    pair = pair_properties(material, radius, mass);
  }
};

}  // namespace

extern "C" {

// overlap[n] -> contact radius, elastic force, normal damping, tangential stiffness of the simplified (full = 0) or full law
void pyjkr_normal(int n, const double* overlap, int full, double radius, double mass, double modulus, double shear,
                  double energy, double damping_ratio, double* contact_radius, double* force, double* damping,
                  double* tangential_stiffness) {
  const Contact contact(radius, mass, modulus, shear, energy, damping_ratio);
  for (int k = 0; k < n; ++k) {
    const NormalState state = normal_state(overlap[k], contact.pair);
    contact_radius[k] = state.contact_radius;
    force[k] = state.elastic_force;
    const ContactStiffness stiffness = full ? FullJkr::stiffness(overlap[k], state, contact.pair)
                                            : SimplifiedJkr::stiffness(overlap[k], state, contact.pair);
    damping[k] = stiffness.damping;
    tangential_stiffness[k] = stiffness.tangential_stiffness;
  }
}

double pyjkr_contact_radius_root(double reduced_overlap) { return contact_radius_root(reduced_overlap); }

double pyjkr_rupture_overlap(double radius, double modulus, double energy) {
  const Contact contact(radius, 1.0, modulus, 1.0, energy, 0.0);
  return rupture_overlap(contact.pair);
}

double pyjkr_quarter_power_weight(double theta) { return quarter_power_weight(theta); }
double pyjkr_square_root_weight(double theta) { return square_root_weight(theta); }

double pyjkr_fraction_before_break(double overlap, double previous_overlap, double time_step, double breaking_overlap,
                                   double breaking_force, double mass) {
  return fraction_before_break({overlap, previous_overlap, 0.0, time_step}, breaking_overlap, breaking_force, mass);
}

void pyjkr_turned(const double* stored, const double* normal, const double* normal_change, double spin_angle, double* result) {
  store(turned(load(stored), turn_of(load(normal), load(normal_change), spin_angle)), result);
}

double pyjkr_sliding_limit(double elastic_force, double pull_off, double friction) {
  return sliding_limit(elastic_force, pull_off, friction);
}

void pyjkr_slide(const double* displacement, const double* slip, double stiffness, double damping, double limit,
                 double* new_displacement, double* force) {
  const SlidingStep step = slide(load(displacement), load(slip), stiffness, damping, limit);
  store(step.displacement, new_displacement);
  store(step.force, force);
}

void pyjkr_rolling_velocity(const double* relative_spin, const double* normal_i_to_j, const double* slip, double radius,
                            double size_asymmetry, double* velocity) {
  store(rolling_velocity(load(relative_spin), load(normal_i_to_j), load(slip), radius, size_asymmetry), velocity);
}

void pyjkr_rolling(const double* displacement, const double* velocity, const double* normal_i_to_j, double stiffness,
                   double damping, double critical, double* new_displacement, double* moment) {
  const Vec3 limited = limited_rolling_displacement(load(displacement), critical);
  store(limited, new_displacement);
  store(rolling_moment(limited, load(velocity), load(normal_i_to_j), stiffness, damping), moment);
}

void pyjkr_twist(double angle, double spin, double stiffness, double damping, double limit, double* new_angle, double* moment) {
  const TwistingStep step = twist(angle, spin, stiffness, damping, limit);
  *new_angle = step.angle;
  *moment = step.moment;
}

}  // extern "C"
