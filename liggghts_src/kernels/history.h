// How displacements stored in a contact follow it: they turn with the contact normal and with the mean spin about it.
// The frame of contract and oracle: minimal rotation from the old normal to the new, then half the sum of the spins about it.
// Assumes small rotations a step; the first keeps the length to third order, the second exactly.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_HISTORY_H
#define PYJKR_KERNELS_HISTORY_H

#include "vec3.h"

namespace pyjkr {

// One step's turn of a contact, ready for every vector that the contact stores.
struct Turn {
  Vec3 normal;           // unit normal now
  Vec3 middle;           // (n_old + n) / (1 + n_old.n), with n_old = n - dn
  bool restore_length;   // dn is not known: a curved wall, an edge
  double sine_part;      // Cayley rotation about n by the spin angle: s + sine_part (n x s) - cosine_part s
  double cosine_part;
};

// normal_change: normal now minus normal one step ago, tangential part; 0 where it is not known.
// spin_angle: angle of the mean spin about the normal in this step [rad].
inline Turn turn_of(const Vec3& normal, const Vec3& normal_change, double spin_angle) {
  const double half = 0.5 * spin_angle;
  const double sine_part = 2.0 * half / (1.0 + half * half);
  return {normal, normal - 0.5 * normal_change, dot(normal_change, normal_change) == 0.0, sine_part, half * sine_part};
}

// s' = s - (n.s) (n_old + n) / (1 + n_old.n), then the spin. Where dn is not known: projection, and the length restored.
inline Vec3 turned(const Vec3& stored, const Turn& turn) {
  const double out_of_plane = dot(stored, turn.normal);
  Vec3 s = stored - out_of_plane * turn.middle;
  if (turn.restore_length && out_of_plane != 0.0) {
    const double left = norm(s);
    if (left > 0.0) s = (norm(stored) / left) * s;
  }
  return (1.0 - turn.cosine_part) * s + turn.sine_part * cross(turn.normal, s);
}

}  // namespace pyjkr

#endif
