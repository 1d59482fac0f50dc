// The contact model that LIGGGHTS' pair and wall loops call: geometry -> record -> normal, sliding, rolling -> sums.
// Takes the place of LIGGGHTS::ContactModels::ContactModel for the jkr styles; stock tangential and rolling models
// plug in beside ours. Spheres only. A wall has no spin of its own.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_CONTACT_MODEL_H
#define PYJKR_ADAPTERS_CONTACT_MODEL_H

#include <cmath>
#include <string>

#include "contact_batch.h"
#include "instructions.h"
#include "material_table.h"
#include "mesh_edges.h"
#include "neighbour_room.h"
#include "normal_model_jkr.h"
#include "radius_range.h"
#include "rolling_model_krijt.h"
#include "tangential_model_jkr.h"

namespace pyjkr {

namespace lcm = LIGGGHTS::ContactModels;

// Marks a slot that a model of LIGGGHTS fills.
template <class Model, bool Off>
struct Stock : Model {
  static constexpr bool is_jkr = false;
  static constexpr bool is_krijt = false;
  static constexpr bool is_off = Off;
  using Model::Model;
};

template <class Style>
class ContactModel : public lcm::ContactModelBase {
  using Law = typename Style::Law;
  using Tangential = typename Style::Tangential;
  using Rolling = typename Style::Rolling;
  using Data = lcm::SurfacesIntersectData;
  using Forces = lcm::ForceData;

 public:
  ContactModel(LAMMPS_NS::LAMMPS* lmp, LIGGGHTS::IContactHistorySetup* setup, bool is_wall, const int64_t)
      : ContactModelBase(lmp, is_wall),
        simulator_(lmp),
        wall_(dynamic_cast<LAMMPS_NS::FixWallGran*>(setup)),
        surface_(lmp, setup, this),
        materials_(lmp),
        normal_(lmp),
        tangential_(lmp, setup, this),
        rolling_(lmp, setup, this) {}

  int64_t hashcode() { return Style::hash(); }
  double stressStrainExponent() { return 1.5; }
  void tally_pp(double, int, int, int) override {}
  void tally_pw(double, int, int, int) override {}
  bool checkSurfaceIntersect(Data& sidata) { return surface_.checkSurfaceIntersect(sidata); }
  void endSurfacesIntersect(Data& sidata, LAMMPS_NS::TriMesh* mesh, Forces& i, Forces&) {
    surface_.endSurfacesIntersect(sidata, mesh, i.delta_F);
  }
  void beginPass(Data&, Forces&, Forces&) {}
  void endPass(Data&, Forces&, Forces&) {}

  void registerSettings(Settings& settings) {
    settings.registerOnOff("computeElasticPotential", elastic_potential_, false);
    settings.registerOnOff("computeDissipatedEnergy", dissipated_energy_, false);
    normal_.registerSettings(settings);
    if constexpr (!Tangential::is_jkr) tangential_.registerSettings(settings);
    rolling_.registerSettings(settings);
  }

  void postSettings(LIGGGHTS::IContactHistorySetup* setup) {
    if (elastic_potential_ || dissipated_energy_)
      simulator_.error->all(FLERR, (name() + ": " + (elastic_potential_ ? "computeElasticPotential" : "computeDissipatedEnergy") +
                         " is not available with the jkr models. Remove the keyword").c_str());
    normal_.postSettings(setup);
    if constexpr (Tangential::is_jkr)
      tangential_.postSettings(setup, normal_.event_correction());
    else
      tangential_.postSettings(setup, this);
    if constexpr (Rolling::is_krijt)
      rolling_.postSettings(setup);
    else
      rolling_.postSettings(setup, this);
  }

  void connectToProperties(PropertyRegistry& registry) {
    if (simulator_.force->cg_active()) simulator_.error->all(FLERR, (name() + ": coarse-graining is not available with the jkr models").c_str());
    RequiredProperties required;
    required.friction = Tangential::is_jkr;
    if constexpr (Rolling::is_krijt) {
      required.friction = required.friction || rolling_.needs_friction();
      required.rolling = true;
    }
    materials_.read(registry, name(), required);
    if constexpr (!Tangential::is_jkr) tangential_.connectToProperties(registry);
    if constexpr (!Rolling::is_krijt) rolling_.connectToProperties(registry);
    const RadiusRange radii = radius_range(simulator_);
    room_.claim(Law::has_neck, normal_.event_correction(), radii.smallest, radii.largest, name());
  }

  // Overlapping surfaces.
  void surfacesIntersect(Data& sidata, Forces& i, Forces& j) {
    if (sidata.mesh && !takes_its_place(sidata)) return;
    const PairProperties pair = pair_of(sidata);
    contact(sidata, pair, normal_state(sidata.radsum - sidata.r, pair), i, j);
  }

  // The same of a contact that the pair loop has gathered and solved with others.
  void solved_contact(Data& sidata, const ContactBatch& batch, int place, Forces& i, Forces& j) {
    const PairProperties pair{&materials_(sidata.itype, sidata.jtype), batch.effective_radius[place], batch.inverse_radius_root[place],
                              sidata.meff};
    contact(sidata, pair, normal_state_of_root(batch.overlap[place], batch.reduced_overlap[place], batch.root[place], pair), i, j);
  }

  // What the batch needs to know of a pair before it is solved.
  void describe(ContactBatch& batch, int place, int type_i, int type_j, double radius_i, double radius_j) {
    const double radius = radius_i * radius_j / batch.radius_sum[place];
    const PairProperties pair{&materials_(type_i, type_j), radius, inverse_root_of(radius), 0.0};
    batch.effective_radius[place] = radius;
    batch.inverse_radius_root[place] = pair.inverse_radius_root;
    batch.overlap_scale[place] = reduced_overlap_per_overlap(pair);
  }

  // Surfaces apart but near: a neck, a contact that has just broken, or nothing.
  PYJKR_RARE void surfacesClose(Data& sidata, Forces& i, Forces& j) {
    if (sidata.mesh && !takes_its_place(sidata)) return;
    double* const history = sidata.contact_history;
    const bool update_history = sidata.computeflag && sidata.shearupdate;
    if (Law::has_neck) {
      // a contact that only the set-up has seen, which writes no history, is told by its path
      if (!normal_.has_contact(history) && !(update_history && was_touching(sidata))) return release(sidata);
    } else if (!update_history || !normal_.carries_contact(history) || !was_touching(sidata)) {
      return release(sidata);
    }
    const PairProperties pair = pair_of(sidata);
    const double overlap = sidata.radsum - sidata.r;
    if (Law::has_neck && overlap > Law::breaking_overlap(pair)) {
      contact(sidata, pair, normal_state(overlap, pair), i, j);
      sidata.has_force_update = true;
      return;
    }
    if (!update_history) return;
    if (normal_.event_correction()) {
      const Vec3 en = load(sidata.en);
      ContactRecord record;
      approach(sidata, en, record);
      record.pair = pair;
      const double normal_force = normal_.settle(overlap, previous_overlap(sidata, overlap, sidata.vn), sidata.vn, record);
      add_loads(normal_force * en, sidata, en, record, i, j);
      sidata.has_force_update = true;
    }
    release(sidata);
  }

  bool contact_match(const std::string kind, const std::string model) {
    if (kind == "normal") return model == Style::normal_name;
    if (kind == "tangential") return model == Style::tangential_name;
    if (kind == "rolling_friction") return model == Style::rolling_name;
    if (kind == "cohesion") return model == "off";
    if (kind == "surface") return model == "default";
    return false;
  }

 private:
  Simulator simulator_;
  LAMMPS_NS::FixWallGran* wall_;
  lcm::SurfaceModel<lcm::SURFACE_DEFAULT> surface_;
  MaterialTable materials_;
  NeighbourRoom room_{simulator_, materials_, wall_};
  NormalModelJkr<Law> normal_;
  Tangential tangential_;
  Rolling rolling_;
  MeshEdges mesh_edges_{simulator_};
  bool elastic_potential_ = false;
  bool dissipated_energy_ = false;
  double last_radius_ = 0.0;
  double last_inverse_root_ = 0.0;

  static std::string name() { return std::string("model ") + Style::normal_name; }

  PairProperties pair_of(const Data& sidata) {
    const double radius = sidata.is_wall ? sidata.radi : sidata.radi * sidata.radj / sidata.radsum;
    return {&materials_(sidata.itype, sidata.jtype), radius, inverse_root_of(radius), sidata.meff};
  }

  // Radii repeat from contact to contact in all but continuous size distributions: the cube root is kept.
  double inverse_root_of(double radius) {
    if (radius != last_radius_) {
      last_radius_ = radius;
      last_inverse_root_ = 1.0 / std::cbrt(radius);
    }
    return last_inverse_root_;
  }

  // A contact with one triangle of a mesh: false where a neighbouring triangle has it. One that was on another triangle a
  // step ago goes on with its history.
  PYJKR_RARE bool takes_its_place(Data& sidata) {
    const bool shadowed = mesh_edges_.is_beside_a_nearer_face(sidata);
    double* const history = sidata.contact_history;
    const int values = wall_->dnum();
    if (values == 0 || !(sidata.computeflag && sidata.shearupdate)) return !shadowed;
    const double reach = -Law::breaking_overlap(pair_of_wall(sidata));
    const bool live = MeshEdges::is_live(history, values);
    if (shadowed) {
      // the nearer triangle takes the history over when its turn comes; if it has its own already, this one is old
      if (live && mesh_edges_.is_held_elsewhere(sidata, values, reach)) release(sidata);
      return false;
    }
    if (!live && was_near(sidata, reach))
      if (double* const other = mesh_edges_.left_elsewhere(sidata, values, reach))
        for (int k = 0; k < values; ++k) {
          history[k] = other[k];
          other[k] = 0.0;
        }
    return true;
  }

  // Before LIGGGHTS has filled in the rest: geometry of a wall contact, without masses.
  PairProperties pair_of_wall(const Data& sidata) const {
    return pair_properties(materials_(sidata.itype, sidata.jtype), sidata.radi, sidata.meff);
  }

  // Within the reach of a contact one step ago.
  bool was_near(const Data& sidata, double reach) const {
    return sidata.deltan + separation_speed(sidata) * simulator_.update->dt > -reach;
  }

  // Both slots are ours or empty: nobody reads what LIGGGHTS' surface model leaves in the data.
  static constexpr bool kOwnSlots = (Tangential::is_jkr || Tangential::is_off) && (Rolling::is_krijt || Rolling::is_off);

  // One function for the compiler: vectors stay in registers between the laws.
  __attribute__((flatten)) void contact(Data& sidata, const PairProperties& pair, const NormalState& state, Forces& i, Forces& j) {
    ContactRecord record;
    record.pair = pair;
    record.normal = state;
    record.update_history = sidata.computeflag && sidata.shearupdate;
    const Vec3 en = load(sidata.en);
    // contact lists (compute pair/gran/local) are told all that the surface model knows
    if (!kOwnSlots || !record.update_history) surface_.surfacesIntersect(sidata, i, j);
    approach(sidata, en, record);
    if (Law::has_neck && record.update_history && !normal_.has_contact(sidata.contact_history)) room_.check(sidata.radi, sidata.radsum, record.pair, name());

    const double normal_force = normal_.touch(
        sidata, [this](const Data& data) { return previous_overlap(data, data.deltan, data.vn); }, record);
    int flags = lcm::CONTACT_NORMAL_MODEL;
    if constexpr (Tangential::is_jkr) flags |= lcm::CONTACT_TANGENTIAL_MODEL;
    if constexpr (Rolling::is_krijt) flags |= lcm::CONTACT_ROLLING_MODEL;
    if (sidata.contact_flags) *sidata.contact_flags |= flags;
    add_loads(normal_force * en, sidata, en, record, i, j);
    if constexpr (!kOwnSlots) stock_slots(sidata, normal_force, record, i, j);
  }

  // Normal force, sliding and rolling of our own slots: forces and moments on both partners.
  void add_loads(Vec3 force, Data& sidata, const Vec3& en, ContactRecord& record, Forces& i, Forces& j) {
    Vec3 moment_i{0.0, 0.0, 0.0}, moment_j{0.0, 0.0, 0.0};
    if constexpr (Tangential::is_jkr || Rolling::is_krijt) follow(sidata, en, record);
    if constexpr (Tangential::is_jkr) {
      const Vec3 sliding = tangential_.force(record, sidata.contact_history);
      force = force + sliding;
      const Vec3 arm = cross(sliding, en);
      moment_i = sidata.cri * arm;
      moment_j = sidata.crj * arm;
    }
    if constexpr (Rolling::is_krijt) {
      const Vec3 rolling = rolling_.moment(record, sidata.contact_history);
      moment_i = moment_i + rolling;
      moment_j = moment_j - rolling;
    }
    add_force(force, sidata, i, j);
    accumulate(moment_i, i.delta_torque);
    if (!sidata.is_wall) accumulate(moment_j, j.delta_torque);
  }

  // Tangential and rolling models of LIGGGHTS beside a jkr normal force. They know no neck.
  PYJKR_RARE void stock_slots(Data& sidata, double normal_force, const ContactRecord& record, Forces& i, Forces& j) {
    sidata.kn = sidata.deltan > 0.0 ? record.normal.elastic_force / sidata.deltan : 0.0;
    sidata.kt = record.stiffness.tangential_stiffness;
    sidata.gammat = record.stiffness.tangential_damping;
    sidata.Fn = normal_force;  // what their limits are taken from
    const bool neck = sidata.deltan < 0.0;
    if (neck && !sidata.contact_history) return;
    if constexpr (!Tangential::is_jkr) {
      if (neck)
        tangential_.surfacesClose(sidata, i, j);
      else
        tangential_.surfacesIntersect(sidata, i, j);
    }
    if constexpr (!Rolling::is_krijt) {
      if (neck)
        rolling_.surfacesClose(sidata, i, j);
      else
        rolling_.surfacesIntersect(sidata, i, j);
    }
  }

  // Overlap, lever arms to the middle of the overlap and speed of separation, as LIGGGHTS' surface model defines them.
  static void approach(Data& sidata, const Vec3& en, ContactRecord& record) {
    const Vec3 velocity = load(sidata.v_i) - load(sidata.v_j);
    sidata.deltan = sidata.radsum - sidata.r;
    sidata.cri = sidata.radi - 0.5 * sidata.deltan;
    sidata.crj = sidata.is_wall ? 0.0 : sidata.radj - 0.5 * sidata.deltan;
    sidata.vn = dot(velocity, en);
    record.center_velocity = velocity - sidata.vn * en;
  }

  // Motion of the contact that sliding, rolling and twisting need. A wall does not turn and has no curvature.
  void follow(const Data& sidata, const Vec3& en, ContactRecord& record) const {
    const Vec3 spin_i = load(sidata.omega_i);
    const Vec3 spin_j = sidata.is_wall ? Vec3{0.0, 0.0, 0.0} : load(sidata.omega_j);
    const double dt = simulator_.update->dt;
    record.pull_off_force_original = pull_off_force_original(record.pair);
    record.normal_i_to_j = -en;
    // r_i omega_i + r_j omega_j by sum and difference: the same to the last bit where i and j change places, with fused
    // multiply-add too
    const Vec3 spin_sum = spin_i + spin_j;
    record.relative_spin = spin_i - spin_j;
    const Vec3 surface = 0.5 * (sidata.cri + sidata.crj) * spin_sum + 0.5 * (sidata.cri - sidata.crj) * record.relative_spin;
    record.slip_velocity = record.center_velocity + cross(en, surface);
    record.size_asymmetry = sidata.is_wall ? 1.0 : (sidata.radj - sidata.radi) / sidata.radsum;
    const double turn_rate = sidata.is_wall ? 0.0 : dt * sidata.rinv;
    record.turn = turn_of(en, turn_rate * record.center_velocity, 0.5 * dt * dot(spin_sum, en));
    if constexpr (Rolling::is_krijt) {
      if (rolling_.needs_inertia()) record.reduced_inertia = reduced_inertia(sidata);
    }
  }

  static double reduced_inertia(const Data& sidata) {
    const double inertia_i = 0.4 * sidata.mi * sidata.radi * sidata.radi;
    const double inertia_j = 0.4 * sidata.mj * sidata.radj * sidata.radj;
    // a wall, or a frozen partner, does not turn: the effective mass is then the mass of the other
    if (sidata.is_wall || sidata.meff == sidata.mi) return inertia_i;
    if (sidata.meff == sidata.mj) return inertia_j;
    return inertia_i * inertia_j / (inertia_i + inertia_j);
  }

  static void add_force(const Vec3& force, const Data& sidata, Forces& i, Forces& j) {
    accumulate(force, i.delta_F);
    if (!sidata.is_wall) accumulate(-force, j.delta_F);
  }

  static double separation_speed(const Data& sidata) {
    return dot(load(sidata.v_i) - load(sidata.v_j), load(sidata.en));
  }

  // Overlap one step ago. Velocity Verlet moves x by exactly v dt with the half-step v handed over; walls: as if flat.
  double previous_overlap(const Data& sidata, double overlap, double vn) const {
    if (sidata.is_wall) return overlap + vn * simulator_.update->dt;
    return sidata.radsum - norm(load(sidata.delta) - simulator_.update->dt * (load(sidata.v_i) - load(sidata.v_j)));
  }

  bool was_touching(const Data& sidata) const {
    if (sidata.is_wall) return sidata.deltan + separation_speed(sidata) * simulator_.update->dt > 0.0;
    const Vec3 before = load(sidata.delta) - simulator_.update->dt * (load(sidata.v_i) - load(sidata.v_j));
    return dot(before, before) < sidata.radsum * sidata.radsum;
  }

  // No contact: nothing is remembered.
  PYJKR_RARE void release(Data& sidata) {
    if (sidata.contact_flags)
      *sidata.contact_flags &= ~(lcm::CONTACT_NORMAL_MODEL | lcm::CONTACT_TANGENTIAL_MODEL | lcm::CONTACT_ROLLING_MODEL);
    if (!sidata.contact_history || !(sidata.computeflag && sidata.shearupdate)) return;
    normal_.forget(sidata.contact_history);
    Forces none;
    if constexpr (Tangential::is_jkr)
      tangential_.forget(sidata.contact_history);
    else
      tangential_.surfacesClose(sidata, none, none);
    if constexpr (Rolling::is_krijt)
      rolling_.forget(sidata.contact_history);
    else
      rolling_.surfacesClose(sidata, none, none);
  }
};

}  // namespace pyjkr

#endif
