// Properties of the deck -> PairMaterial. See material_table.h.
// SPDX-License-Identifier: GPL-2.0-or-later

#include "material_table.h"

#include <cmath>
#include <sstream>

namespace pyjkr {

namespace {

std::string pair_name(int type_i, int type_j) {
  std::ostringstream text;
  text << "type pair (" << type_i << "," << type_j << ")";
  return text.str();
}

const char* kind_name(MaterialTable::Kind kind) {
  return kind == MaterialTable::Kind::per_pair ? "peratomtypepair" : "peratomtype";
}

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// Effective modulus of two partners, Haervig 2017 eq. 2.
double mixed_modulus(double modulus_i, double poisson_i, double modulus_j, double poisson_j) {
  return 1.0 / ((1.0 - poisson_i * poisson_i) / modulus_i + (1.0 - poisson_j * poisson_j) / modulus_j);
}

}  // namespace

void MaterialTable::refuse(const std::string& message) const {
  error->all(FLERR, (caller_ + ": " + message).c_str());
  throw 0;  // not reached: error->all ends the run
}

LAMMPS_NS::FixPropertyGlobal* MaterialTable::find(const char* name, Kind kind) const {
  const int n = types();
  const int columns = kind == Kind::per_pair ? n : 0;
  return static_cast<LAMMPS_NS::FixPropertyGlobal*>(
      modify->find_fix_property(name, "property/global", kind_name(kind), n, columns, caller_.c_str(), false));
}

LAMMPS_NS::FixPropertyGlobal* MaterialTable::require(const char* name, Kind kind, const char* meaning) const {
  LAMMPS_NS::FixPropertyGlobal* fix = find(name, kind);
  if (!fix) {
    for (const char* other : {"scalar", "vector", "peratomtype", "matrix", "peratomtypepair"}) {
      const int rows = other[0] == 's' ? 0 : 1;
      const int columns = other[0] == 'm' || std::string(other) == "peratomtypepair" ? 1 : 0;
      if (modify->find_fix_property(name, "property/global", other, rows, columns, caller_.c_str(), false))
        refuse(std::string("property ") + name + " (" + meaning + ") is given as " + other + "; it must be " + kind_name(kind));
    }
    const std::string values = kind == Kind::per_pair ? number(atom->ntypes) + " <one value for each pair of atom types>"
                                                : std::string("<one value for each atom type>");
    refuse(std::string("property ") + name + " (" + meaning + ") is missing for " + pair_name(1, types()) +
           " and all others. Add: fix ID all property/global " + name + " " + kind_name(kind) + " " + values);
  }
  return fix;
}

double MaterialTable::per_type(LAMMPS_NS::FixPropertyGlobal* fix, const char* name, int type, bool zero_allowed) const {
  const double value = fix->compute_vector(type - 1);
  if (!std::isfinite(value) || value < 0.0 || (value == 0.0 && !zero_allowed))
    refuse(std::string("property ") + name + " = " + number(value) + " of " + pair_name(type, type) + " must be a number " +
           (zero_allowed ? ">= 0" : "> 0"));
  return value;
}

double MaterialTable::per_pair(LAMMPS_NS::FixPropertyGlobal* fix, const char* name, int type_i, int type_j) const {
  const double value = fix->compute_array(type_i - 1, type_j - 1);
  if (!std::isfinite(value) || value < 0.0)
    refuse(std::string("property ") + name + " = " + number(value) + " of " + pair_name(type_i, type_j) +
           " must be a number >= 0");
  return value;
}

void MaterialTable::read(PropertyRegistry& registry, const std::string& caller, const RequiredProperties& required) {
  caller_ = caller;
  const int n = registry.max_type();
  stride_ = n + 1;
  pairs_.assign(static_cast<size_t>(stride_) * stride_, PairMaterial());

  auto* modulus = require("youngsModulus", Kind::per_type, "Young's modulus, pressure units");
  auto* poisson = require("poissonsRatio", Kind::per_type, "Poisson's ratio");
  auto* restitution = require("coefficientRestitution", Kind::per_pair, "coefficient of restitution");
  auto* energy = require("surfaceEnergy", Kind::per_pair, "surface energy of one surface, J/m2; 0 for no adhesion");
  auto* energy_original = find("surfaceEnergyOriginal", Kind::per_pair);
  auto* modulus_original = find("youngsModulusOriginal", Kind::per_type);
  auto* friction = required.friction ? require("coefficientFriction", Kind::per_pair, "sliding friction coefficient") : nullptr;
  auto* hysteresis = required.rolling ? find("adhesionHysteresis", Kind::per_pair) : nullptr;
  auto* angle = required.rolling ? find("criticalRollingAngle", Kind::per_pair) : nullptr;
  if (required.rolling && !hysteresis && !angle)
    refuse("rolling_friction krijt needs property adhesionHysteresis (Delta gamma/gamma) or criticalRollingAngle (rad) for " +
           pair_name(1, n) + " and all others, and has neither. Add: fix ID all property/global adhesionHysteresis "
           "peratomtypepair " + number(atom->ntypes) + " <one value for each pair of atom types>");
  if (hysteresis && angle)
    refuse("both adhesionHysteresis and criticalRollingAngle are given for " + pair_name(1, n) +
           " and all others; they set the same critical rolling displacement. Keep exactly one");

  // ours have looked for what LIGGGHTS does not check; its own limits and mixing rules come next
  for (int i = 1; i <= n; ++i) {
    per_type(modulus, "youngsModulus", i, false);
    per_type(poisson, "poissonsRatio", i, true);
    if (modulus_original) per_type(modulus_original, "youngsModulusOriginal", i, false);
    for (int j = 1; j <= n; ++j) per_pair(restitution, "coefficientRestitution", i, j);
  }
  registry.registerProperty("Yeff", &MODEL_PARAMS::createYeff, true);
  registry.registerProperty("Geff", &MODEL_PARAMS::createGeff, true);
  registry.registerProperty("betaeff", &MODEL_PARAMS::createBetaEff, true);
  const double* const* effective_modulus = registry.getMatrixProperty("Yeff", caller_.c_str())->data;
  const double* const* effective_shear_modulus = registry.getMatrixProperty("Geff", caller_.c_str())->data;
  const double* const* beta = registry.getMatrixProperty("betaeff", caller_.c_str())->data;

  const double pressure_to_force = 1.0 / force->nktv2p;
  for (int i = 1; i <= n; ++i) {
    for (int j = 1; j <= n; ++j) {
      PairMaterial& pair = pairs_[i * stride_ + j];
      pair.effective_modulus = effective_modulus[i][j] * pressure_to_force;
      pair.effective_shear_modulus = effective_shear_modulus[i][j] * pressure_to_force;
      pair.damping_ratio = std::fabs(beta[i][j]);
      pair.surface_energy = per_pair(energy, "surfaceEnergy", i, j);
      pair.surface_energy_original =
          energy_original ? per_pair(energy_original, "surfaceEnergyOriginal", i, j) : pair.surface_energy;
      if ((pair.surface_energy == 0.0) != (pair.surface_energy_original == 0.0))
        refuse("property surfaceEnergyOriginal = " + number(pair.surface_energy_original) + " of " + pair_name(i, j) +
               " contradicts surfaceEnergy = " + number(pair.surface_energy) + ": both or neither must be 0");
      if (friction) pair.friction_coefficient = per_pair(friction, "coefficientFriction", i, j);
      if (hysteresis) pair.adhesion_hysteresis = per_pair(hysteresis, "adhesionHysteresis", i, j);
      if (angle) pair.critical_rolling_angle = per_pair(angle, "criticalRollingAngle", i, j);
      double original = pair.effective_modulus;
      if (modulus_original)
        original = pressure_to_force * mixed_modulus(modulus_original->compute_vector(i - 1), poisson->compute_vector(i - 1),
                                                     modulus_original->compute_vector(j - 1), poisson->compute_vector(j - 1));
      set_constants(pair, original);
    }
  }
}

}  // namespace pyjkr
