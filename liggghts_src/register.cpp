// Names, ids and the table of style combinations: the only file that knows them.
// Runs before LIGGGHTS starts: registers with the factories that libliggghts exports. Every other combination that
// names one of our styles is registered too, as an error that lists what exists.
// SPDX-License-Identifier: GPL-2.0-or-later

#include <string>
#include <type_traits>
#include <vector>

#include "adapters/contact_model.h"
#include "adapters/pair_loop.h"

namespace pyjkr {
namespace {

// Ids are six bits wide; stock ones are below 13.
constexpr int kSimplifiedId = 60;
constexpr int kFullId = 61;
constexpr int kTangentialId = 60;
constexpr int kRollingId = 60;

struct Simplified {
  using Law = SimplifiedJkr;
  static constexpr int id = kSimplifiedId;
  static constexpr const char* name = "jkr/simplified";
};
struct Full {
  using Law = FullJkr;
  static constexpr int id = kFullId;
  static constexpr const char* name = "jkr";
};

template <class ModelType, int Id, const char* const& Name>
struct Slot {
  using Model = ModelType;
  static constexpr int id = Id;
  static constexpr const char* name = Name;
};
constexpr const char* kOff = "off";
constexpr const char* kNoHistory = "no_history";
constexpr const char* kHistory = "history";
constexpr const char* kJkr = "jkr";
constexpr const char* kEpsd2 = "epsd2";
constexpr const char* kKrijt = "krijt";

using TangentialOff = Slot<Stock<lcm::TangentialModel<lcm::TANGENTIAL_OFF>, true>, lcm::TANGENTIAL_OFF, kOff>;
using TangentialNoHistory = Slot<Stock<lcm::TangentialModel<lcm::TANGENTIAL_NO_HISTORY>, false>, lcm::TANGENTIAL_NO_HISTORY, kNoHistory>;
using TangentialHistory = Slot<Stock<lcm::TangentialModel<lcm::TANGENTIAL_HISTORY>, false>, lcm::TANGENTIAL_HISTORY, kHistory>;
using TangentialJkr = Slot<TangentialModelJkr, kTangentialId, kJkr>;
using RollingOff = Slot<Stock<lcm::RollingModel<lcm::ROLLING_OFF>, true>, lcm::ROLLING_OFF, kOff>;
using RollingEpsd2 = Slot<Stock<lcm::RollingModel<lcm::ROLLING_EPSD2>, false>, lcm::ROLLING_EPSD2, kEpsd2>;
using RollingKrijt = Slot<RollingModelKrijt, kRollingId, kKrijt>;

template <class NormalSlot, class TangentialSlot, class RollingSlot>
struct Style {
  using Law = typename NormalSlot::Law;
  using Tangential = typename TangentialSlot::Model;
  using Rolling = typename RollingSlot::Model;
  static constexpr const char* normal_name = NormalSlot::name;
  static constexpr const char* tangential_name = TangentialSlot::name;
  static constexpr const char* rolling_name = RollingSlot::name;
  static int64_t hash() {
    return LIGGGHTS::Utils::generate_gran_hashcode(NormalSlot::id, TangentialSlot::id, lcm::COHESION_OFF, RollingSlot::id,
                                                   lcm::SURFACE_DEFAULT);
  }
};

// ---- the table ----
template <class... Types>
struct List {};
using Normals = List<Simplified, Full>;
using Tangentials = List<TangentialOff, TangentialNoHistory, TangentialHistory, TangentialJkr>;
using Rollings = List<RollingOff, RollingEpsd2, RollingKrijt>;
const char kCombinations[] =
    "The combinations that exist: model jkr/simplified|jkr [tangential off|no_history|history|jkr] "
    "[rolling_friction off|epsd2|krijt]";

using PairFactory = LIGGGHTS::PairStyles::Factory;
using WallFactory = LIGGGHTS::Walls::Factory;

template <class Interface, class Implementation, class Parent>
Interface* create(LAMMPS_NS::LAMMPS* lmp, Parent* parent, int64_t hash) {
  return new Implementation(lmp, parent, hash);
}

// Where the user's words led to a combination that does not exist.
template <class Interface, class Parent>
Interface* refuse(LAMMPS_NS::LAMMPS* lmp, Parent*, int64_t) {
  const std::string message =
      std::string("this combination of contact models does not exist with the jkr styles. ") + kCombinations +
      ", without cohesion and with the default surface";
  lmp->error->all(FLERR, message.c_str());
  return nullptr;
}

std::vector<int64_t>& registered() {
  static std::vector<int64_t> hashes;
  return hashes;
}

template <class S>
void add() {
  using Model = ContactModel<S>;
  using IPair = LIGGGHTS::PairStyles::IGranularPairStyle;
  using IWall = LIGGGHTS::Walls::IGranularWall;
  PairFactory::instance().addStyle("gran", S::hash(), &create<IPair, PairLoop<Model>, LAMMPS_NS::PairGran>);
  WallFactory::instance().addStyle("gran", S::hash(), &create<IWall, LIGGGHTS::Walls::Granular<Model>, LAMMPS_NS::FixWallGran>);
  registered().push_back(S::hash());
}

template <class N, class T, class... R>
void add_rollings(List<R...>) { (add<Style<N, T, R>>(), ...); }
template <class N, class... T>
void add_tangentials(List<T...>) { (add_rollings<N, T>(Rollings()), ...); }
template <class... N>
void add_all(List<N...>) { (add_tangentials<N>(Tangentials()), ...); }

std::vector<int> stock_ids(const char* kind) {
  std::vector<int> ids;
  const std::string k = kind;
  if (k == "normal") {
    ids.push_back(lcm::NORMAL_OFF);
#define NORMAL_MODEL(identifier, name, id) ids.push_back(id);
#include "style_normal_model.h"
#undef NORMAL_MODEL
  } else if (k == "tangential") {
    ids.push_back(lcm::TANGENTIAL_OFF);
#define TANGENTIAL_MODEL(identifier, name, id) ids.push_back(id);
#include "style_tangential_model.h"
#undef TANGENTIAL_MODEL
  } else if (k == "cohesion") {
    ids.push_back(lcm::COHESION_OFF);
#define COHESION_MODEL(identifier, name, id) ids.push_back(id);
#include "style_cohesion_model.h"
#undef COHESION_MODEL
  } else if (k == "rolling") {
    ids.push_back(lcm::ROLLING_OFF);
#define ROLLING_MODEL(identifier, name, id) ids.push_back(id);
#include "style_rolling_model.h"
#undef ROLLING_MODEL
  } else {
#define SURFACE_MODEL(identifier, name, id) ids.push_back(id);
#include "style_surface_model.h"
#undef SURFACE_MODEL
  }
  return ids;
}

void add_refusals() {
  std::vector<int> normals = stock_ids("normal"), tangentials = stock_ids("tangential"), rollings = stock_ids("rolling");
  normals.insert(normals.end(), {kSimplifiedId, kFullId});
  tangentials.push_back(kTangentialId);
  rollings.push_back(kRollingId);
  for (int n : normals)
    for (int t : tangentials)
      for (int r : rollings) {
        if (n < kSimplifiedId && t != kTangentialId && r != kRollingId) continue;  // stock throughout
        for (int c : stock_ids("cohesion"))
          for (int s : stock_ids("surface")) {
            const int64_t hash = LIGGGHTS::Utils::generate_gran_hashcode(n, t, c, r, s);
            bool exists = false;
            for (int64_t ours : registered()) exists = exists || ours == hash;
            if (exists) continue;
            PairFactory::instance().addStyle("gran", hash, &refuse<LIGGGHTS::PairStyles::IGranularPairStyle, LAMMPS_NS::PairGran>);
            WallFactory::instance().addStyle("gran", hash, &refuse<LIGGGHTS::Walls::IGranularWall, LAMMPS_NS::FixWallGran>);
          }
      }
}

struct Registration {
  Registration() {
    lcm::Factory& models = lcm::Factory::instance();
    models.addNormalModel(Simplified::name, Simplified::id);
    models.addNormalModel(Full::name, Full::id);
    models.addTangentialModel(kJkr, kTangentialId);
    models.addRollingModel(kKrijt, kRollingId);
    add_all(Normals());
    add_refusals();
  }
} registration;

}  // namespace
}  // namespace pyjkr
