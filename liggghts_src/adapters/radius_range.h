// Smallest and largest sphere of a simulation, those that fixes will insert included.
// LIGGGHTS' own PropertyRegistry::min_radius() stops with an error below 1e-6 length units: no use for fine powders.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_RADIUS_RANGE_H
#define PYJKR_ADAPTERS_RADIUS_RANGE_H

#include <algorithm>
#include <limits>

#include "fix.h"
#include "liggghts_headers.h"

namespace pyjkr {

struct RadiusRange {
  double smallest;   // 0 where no sphere is known yet
  double largest;
};

// Collective over all ranks.
inline RadiusRange radius_range(Simulator& simulator) {
  constexpr double none = std::numeric_limits<double>::infinity();
  // one reduction for both ends: the smallest of r and the smallest of -r
  double local[2] = {none, 0.0};
  const auto include = [&local](double radius) {
    if (!(radius > 0.0)) return;
    local[0] = std::min(local[0], radius);
    local[1] = std::min(local[1], -radius);
  };
  for (int i = 0; i < simulator.atom->nlocal; ++i) include(simulator.atom->radius[i]);
  for (int k = 0; k < simulator.modify->nfix; ++k) {
    LAMMPS_NS::Fix* fix = simulator.modify->fix[k];
    if (!fix->use_rad_for_cut_neigh_and_ghost()) continue;
    for (int type = 1; type <= simulator.atom->ntypes; ++type) {
      // an insertion fix without a template of this type answers with a smallest radius of 1000 and a largest of 0
      const double smallest = fix->min_rad(type), largest = fix->max_rad(type);
      if (!(smallest <= largest)) continue;
      include(smallest);
      include(largest);
    }
  }
  double global[2];
  MPI_Allreduce(local, global, 2, MPI_DOUBLE, MPI_MIN, simulator.world);
  return {global[0] == none ? 0.0 : global[0], -global[1]};
}

}  // namespace pyjkr

#endif
