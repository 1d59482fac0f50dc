// How displacements stored in a contact follow it: they turn with the contact normal and with the mean spin about it.
// Wang 2015's frame: minimal rotation from the old normal to the new, then half the sum of the spins about it.
// Assumes small rotations a step; the first keeps the length to third order, the second exactly.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_HISTORY_H
#define PYJKR_KERNELS_HISTORY_H

#include "vec3.h"

namespace pyjkr {

struct Turn {
  Vec3 normal;          // unit normal now
  Vec3 normal_change;   // normal now minus normal one step ago, tangential part
  double spin_angle;    // angle of the mean spin about the normal in this step [rad]
};

// s' = s - (n.s) (n_old + n) / (1 + n_old.n), with n_old = n - dn; then a Cayley rotation about n.
// On a curved wall or at an edge dn is not known (0): projection, and the length is restored.
inline Vec3 turned(const Vec3& stored, const Turn& turn) {
  const double out_of_plane = dot(stored, turn.normal);
  Vec3 s = stored - out_of_plane * (turn.normal - 0.5 * turn.normal_change);
  if (out_of_plane != 0.0 && dot(turn.normal_change, turn.normal_change) == 0.0) {
    const double left = norm(s);
    if (left > 0.0) s = (norm(stored) / left) * s;
  }
  const double half = 0.5 * turn.spin_angle;
  const double scale = 2.0 * half / (1.0 + half * half);
  return s + scale * (cross(turn.normal, s) - half * s);
}

}  // namespace pyjkr

#endif
