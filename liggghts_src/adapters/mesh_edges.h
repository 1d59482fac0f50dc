// One contact for one place of a mesh, at edges and corners too.
// LIGGGHTS hands over a contact for every triangle whose nearest point touches: beside a convex edge the face of one
// triangle and the edge of the next, which doubles an adhesive force in one step. A contact on an edge or a corner counts
// only where no triangle that shares the edge is nearer; a contact that so moves from one triangle to another takes
// its history along. Concave edges keep their two contacts: there both faces are nearest.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_MESH_EDGES_H
#define PYJKR_ADAPTERS_MESH_EDGES_H

#include <algorithm>

#include "fix_contact_history_mesh.h"
#include "fix_mesh_surface.h"
#include "liggghts_headers.h"

namespace pyjkr {

class MeshEdges {
  using Data = LIGGGHTS::ContactModels::SurfacesIntersectData;

 public:
  explicit MeshEdges(Simulator& simulator) : simulator_(simulator) {}

  // Whether the contact of triangle sidata.j is the same as that of a nearer neighbour.
  bool is_beside_a_nearer_face(const Data& sidata) const {
    return shadowed(sidata, sidata.j);
  }

  // What the particle remembers of this contact on another triangle, which it has left within the last step; null where
  // there is none. `values` is the length of a history, `reach` the gap that a contact may span.
  double* left_elsewhere(const Data& sidata, int values, double reach) const {
    return search(sidata, values, [&](int triangle) {
      return nearest(sidata, triangle, true).gap > reach || shadowed(sidata, triangle);
    });
  }

  // Whether another triangle holds a contact of the particle and its history.
  bool is_held_elsewhere(const Data& sidata, int values, double reach) const {
    return search(sidata, values, [&](int triangle) {
      return nearest(sidata, triangle, true).gap <= reach && !shadowed(sidata, triangle);
    });
  }

  // A contact writes its history in its first step; one of zeros is none.
  static bool is_live(const double* history, int values) {
    return std::any_of(history, history + values, [](double value) { return value != 0.0; });
  }

 private:
  Simulator& simulator_;

  struct Nearest {
    double gap;     // distance of the surfaces, negative where they overlap
    bool on_face;   // else on an edge or a corner
  };

  // skip_inactive: edges and corners that LIGGGHTS gives to another triangle are out of reach.
  Nearest nearest(const Data& sidata, int triangle, bool skip_inactive) const {
    double to_contact[3], barycentric[3];
    int where = 0;
    const double gap = sidata.mesh->resolveTriSphereContactBary(sidata.i, triangle, sidata.radi, simulator_.atom->x[sidata.i],
                                                                to_contact, barycentric, where, skip_inactive);
    return {gap, where == kFace};
  }

  bool shadowed(const Data& sidata, int triangle) const {
    const Nearest own = nearest(sidata, triangle, true);
    if (own.on_face) return false;
    // two triangles find the same edge at distances that differ by their rounding
    const double same = 1e-12 * sidata.radi;
    for (int k = 0; k < sidata.mesh->nNeighs(triangle); ++k) {
      const int neighbour = sidata.mesh->map(sidata.mesh->neighFaces(triangle, k), 0);
      if (neighbour < 0) continue;
      const Nearest other = nearest(sidata, neighbour, false);
      if (other.gap < own.gap - (other.on_face ? 0.0 : same)) return true;
    }
    return false;
  }

  // History of another contact of the particle on a triangle for which `wanted` holds.
  template <class Wanted>
  double* search(const Data& sidata, int values, const Wanted& wanted) const {
    LAMMPS_NS::FixContactHistoryMesh& contacts = *sidata.fix_mesh->contactHistory();
    const int own = sidata.mesh->id(sidata.j);
    for (int k = 0; k < contacts.nneighs(sidata.i); ++k) {
      const int id = contacts.partner(sidata.i, k);
      if (id < 0 || id == own) continue;
      const int triangle = sidata.mesh->map(id, 0);
      double* const history = contacts.contacthistory(sidata.i, k);
      if (triangle >= 0 && is_live(history, values) && wanted(triangle)) return history;
    }
    return nullptr;
  }

  static constexpr int kFace = 7;  // LIGGGHTS: all three barycentric coordinates are positive
};

}  // namespace pyjkr

#endif
