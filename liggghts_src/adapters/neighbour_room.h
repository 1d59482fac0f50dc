// How far beyond contact LIGGGHTS must look: necks and contacts that have just broken have to be seen, or refused.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_NEIGHBOUR_ROOM_H
#define PYJKR_ADAPTERS_NEIGHBOUR_ROOM_H

#include <algorithm>
#include <sstream>
#include <string>

#include "instructions.h"
#include "liggghts_headers.h"
#include "material_table.h"

namespace pyjkr {

// Room beyond contact in which a contact that broke within the last step is still seen, as a part of the radius:
// the largest way of one step at 20 steps a collision and an overlap of R/2 (Hertz: 2.94 delta_max/20), rounded up.
constexpr double kEventBand = 0.08;

class NeighbourRoom {
 public:
  // `wall`: null for pairs, which are found by the flag of their contact as far as the neighbour skin reaches.
  NeighbourRoom(const Simulator& simulator, const MaterialTable& materials, LAMMPS_NS::FixWallGran* wall)
      : simulator_(simulator), materials_(materials), wall_(wall) {}

  // Ask the neighbour search for the room that necks and broken contacts need, or say what to change.
  void claim(bool has_neck, bool event_correction, double smallest_radius, double largest_radius, const std::string& caller) {
    double band = wall_ && event_correction ? kEventBand : 0.0;
    if (has_neck && smallest_radius > 0.0) {
      double longest = 0.0, longest_of_largest = 0.0;
      for (int i = 1; i <= materials_.types(); ++i)
        for (int j = 1; j <= materials_.types(); ++j) {
          longest = std::max(longest, neck_length(i, j, smallest_radius));
          longest_of_largest = std::max(longest_of_largest, neck_length(i, j, largest_radius));
        }
      if (longest >= smallest_radius)
        simulator_.error->all(FLERR, (caller + ": the neck of the smallest sphere (radius " + text(smallest_radius) + ") would be " +
                           text(longest) + " long, longer than the sphere. Raise youngsModulus or lower surfaceEnergy").c_str());
      if (wall_ && !wall_->is_mesh_wall() && simulator_.neighbor->skin < longest_of_largest)
        simulator_.error->all(FLERR, (caller + ": the neighbour skin (" + text(simulator_.neighbor->skin) + ") is smaller than the longest neck at a "
                           "primitive wall (" + text(longest_of_largest) + "): contacts would be lost. Set: neighbor " +
                           text(1.1 * longest_of_largest) + " bin, or more").c_str());
      band += 1.05 * longest / smallest_radius;
    }
    if (band > 0.0) simulator_.neighbor->register_contact_dist_factor(1.0 + band);
  }

  // Spheres smaller than any known before the run may come in later: their necks must still fit the band.
  PYJKR_RARE void check(double radius, double radius_sum, const PairProperties& pair, const std::string& caller) const {
    const double neck = -rupture_overlap(pair);
    const double room = (simulator_.neighbor->contactDistanceFactor - 1.0) * radius_sum;
    if (neck > room)
      simulator_.error->one(FLERR, (caller + ": a sphere of radius " + text(radius) + " is smaller than any known before the run; its neck (" +
                         text(neck) + ") does not fit the contact distance (" + text(room) +
                         "). Name its insertion fix, or create it, before the run command").c_str());
  }

 private:
  const Simulator& simulator_;
  const MaterialTable& materials_;
  LAMMPS_NS::FixWallGran* wall_;

  double neck_length(int type_i, int type_j, double radius) const {
    return -rupture_overlap(pair_properties(materials_(type_i, type_j), radius, 0.0));
  }

  static std::string text(double value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
  }
};

}  // namespace pyjkr

#endif
