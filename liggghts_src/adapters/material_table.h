// Properties of the deck -> PairMaterial for every pair of atom types, checked once before a run.
// The only place that reads `fix property/global`; every message names the property and the type pair.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_MATERIAL_TABLE_H
#define PYJKR_ADAPTERS_MATERIAL_TABLE_H

#include <string>
#include <vector>

#include "../kernels/pair_properties.h"
#include "liggghts_headers.h"

namespace pyjkr {

struct RequiredProperties {
  bool friction = false;
  bool rolling = false;
};

class MaterialTable : protected LAMMPS_NS::Pointers {
 public:
  enum class Kind { per_type, per_pair };

  explicit MaterialTable(LAMMPS_NS::LAMMPS* lmp) : Pointers(lmp) {}

  // Read and check all properties; `caller` is the style as the user typed it.
  void read(PropertyRegistry& registry, const std::string& caller, const RequiredProperties& required);

  const PairMaterial& operator()(int type_i, int type_j) const { return pairs_[type_i * stride_ + type_j]; }
  int types() const { return stride_ - 1; }

 private:
  std::vector<PairMaterial> pairs_;
  int stride_ = 0;
  std::string caller_;

  LAMMPS_NS::FixPropertyGlobal* find(const char* name, Kind kind) const;
  LAMMPS_NS::FixPropertyGlobal* require(const char* name, Kind kind, const char* meaning) const;
  double per_type(LAMMPS_NS::FixPropertyGlobal* fix, const char* name, int type, bool zero_allowed) const;
  double per_pair(LAMMPS_NS::FixPropertyGlobal* fix, const char* name, int type_i, int type_j) const;
  [[noreturn]] void refuse(const std::string& message) const;
};

}  // namespace pyjkr

#endif
