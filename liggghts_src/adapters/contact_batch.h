// Contacts gathered from the neighbour lists, and what can be computed of many at once: distance, normal, JKR root.
// One contact alone waits for a chain of square roots and divisions; side by side they overlap and fill vector registers.
// Loops run over all places, used or not: no remainder, so no result depends on where in a batch a contact stands.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_CONTACT_BATCH_H
#define PYJKR_ADAPTERS_CONTACT_BATCH_H

#include <cmath>

#include "../kernels/jkr_normal.h"

namespace pyjkr {

struct ContactBatch {
  static constexpr int kSize = 64;

  int count = 0;
  int i[kSize], j[kSize];
  int* flags[kSize];
  double* history[kSize];
  bool touching[kSize];
  double apart[3][kSize];          // x_i - x_j [m]
  double square[kSize];            // its square
  double radius_sum[kSize];
  double effective_radius[kSize];
  double inverse_radius_root[kSize];
  double overlap_scale[kSize];     // reduced overlap per overlap [1/m]
  // computed:
  double distance[kSize], inverse_distance[kSize];
  double normal[3][kSize];         // from j to i
  double overlap[kSize];
  double reduced_overlap[kSize];
  double root[kSize];

  ContactBatch() {
    for (int k = 0; k < kSize; ++k) {
      apart[0][k] = square[k] = radius_sum[k] = overlap_scale[k] = 1.0;
      apart[1][k] = apart[2][k] = 0.0;
    }
  }

  void solve() {
    for (int k = 0; k < kSize; ++k) {
      distance[k] = std::sqrt(square[k]);
      inverse_distance[k] = 1.0 / distance[k];
      overlap[k] = radius_sum[k] - distance[k];
      reduced_overlap[k] = overlap[k] * overlap_scale[k];
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < kSize; ++k) normal[axis][k] = inverse_distance[k] * apart[axis][k];
    for (int k = 0; k < kSize; ++k) root[k] = contact_radius_root(reduced_overlap[k]);
  }
};

}  // namespace pyjkr

#endif
