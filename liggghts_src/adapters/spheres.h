// Positions, velocities and forces of all spheres, as the pair loop reads and fetches them.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_SPHERES_H
#define PYJKR_ADAPTERS_SPHERES_H

#include <cstddef>

#include "liggghts_headers.h"

namespace pyjkr {

// Neighbours of the next sphere that are asked for ahead.
constexpr int kAhead = 8;

// LIGGGHTS keeps every array in one block behind its table of rows, so
// the table need not be read. What the next contacts need is asked for early: waiting for memory is what a contact costs.
class Spheres {
 public:
  const double* const radius;
  const int* const type;
  const int local;

  explicit Spheres(const LAMMPS_NS::Atom& atom)
      : radius(atom.radius), type(atom.type), local(atom.nlocal), x_(block(atom.x)), v_(block(atom.v)), omega_(block(atom.omega)),
        f_(block(atom.f)), torque_(block(atom.torque)) {}

  double* x(int i) const { return x_ + 3 * static_cast<size_t>(i); }
  double* v(int i) const { return v_ + 3 * static_cast<size_t>(i); }
  double* omega(int i) const { return omega_ + 3 * static_cast<size_t>(i); }
  double* f(int i) const { return f_ + 3 * static_cast<size_t>(i); }
  double* torque(int i) const { return torque_ + 3 * static_cast<size_t>(i); }

  void fetch_places(const int* neighbours, int count) const {
    for (int k = 0; k < count && k < kAhead; ++k) __builtin_prefetch(x(neighbours[k] & NEIGHMASK));
  }

  void fetch_motion(int i) const {
    __builtin_prefetch(v(i));
    __builtin_prefetch(omega(i));
    __builtin_prefetch(f(i), 1);
    __builtin_prefetch(torque(i), 1);
  }

 private:
  double* const x_;
  double* const v_;
  double* const omega_;
  double* const f_;
  double* const torque_;

  static double* block(double** rows) { return rows ? rows[0] : nullptr; }
};

}  // namespace pyjkr

#endif
