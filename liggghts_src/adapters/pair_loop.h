// The loop over neighbour pairs behind `pair_style gran` for the jkr models, in place of LIGGGHTS' generic one.
// A pair that does not touch and did not touch costs its distance and a flag: contacts that end and necks are found by
// the flag they left, not by a wider search. Sums in the order of the neighbour lists. Spheres only.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_PAIR_LOOP_H
#define PYJKR_ADAPTERS_PAIR_LOOP_H

#include <cmath>
#include <vector>

#include "../kernels/vec3.h"
#include "instructions.h"
#include "liggghts_headers.h"
#include "spheres.h"

namespace pyjkr {

template <class Model>
class PairLoop : public LIGGGHTS::PairStyles::IGranularPairStyle {
  using Data = LIGGGHTS::ContactModels::SurfacesIntersectData;
  using Forces = LIGGGHTS::ContactModels::ForceData;
  using PairGran = LAMMPS_NS::PairGran;

 public:
  PairLoop(LAMMPS_NS::LAMMPS* lmp, PairGran* parent, int64_t hash) : simulator_(lmp), model_(lmp, parent, false, hash) {}

  void settings(int count, char** words, LIGGGHTS::IContactHistorySetup* setup) override {
    Settings settings(simulator_.lmp);
    model_.registerSettings(settings);
    const bool understood = settings.parseArguments(count, words);
    model_.postSettings(setup);
    if (!understood) simulator_.error->all(FLERR, settings.error_message.c_str());
  }

  void init_granular() override { model_.connectToProperties(simulator_.force->registry); }

  void write_restart_settings(FILE* file) override {
    const int64_t hash = model_.hashcode();
    fwrite(&hash, sizeof hash, 1, file);
  }

  // The deck names the style anew after read_restart; here it is only checked to be the same. Old files carry the hash
  // once, newer ones twice.
  void read_restart_settings(FILE* file, int64_t expected) override {
    if (simulator_.comm->me != 0) return;
    int64_t stored = -1;
    const bool complete = fread(&stored, sizeof stored, 1, file) == 1;
    if (!complete || (expected != -1 ? expected : stored) != model_.hashcode())
      simulator_.error->one(FLERR, "the restart file was written with another combination of contact models than this pair_style");
  }

  int get_history_offset(const std::string name) override { return model_.get_history_offset(name); }
  double stressStrainExponent() override { return model_.stressStrainExponent(); }
  int64_t hashcode() override { return model_.hashcode(); }
  bool contact_match(const std::string kind, const std::string name) override { return model_.contact_match(kind, name); }

  void compute_force(PairGran* pair, int eflag, int vflag, int addflag) override {
    if (instructions_ == Instructions::avx2)
      loop_with_avx2(pair, eflag, vflag, addflag);
    else
      loop(pair, eflag, vflag, addflag);
  }

 private:
  Simulator simulator_;
  Model model_;
  ContactBatch batch_;
  const Instructions instructions_ = instructions_of_this_machine();

  PYJKR_WITH_AVX2 void loop_with_avx2(PairGran* pair, int eflag, int vflag, int addflag) { loop(pair, eflag, vflag, addflag); }

  void loop(PairGran* pair, int eflag, int vflag, int addflag) {
    if (eflag || vflag)
      pair->ev_setup(eflag, vflag);
    else
      pair->evflag = pair->vflag_fdotr = 0;

    const LAMMPS_NS::NeighList& list = *pair->list;
    const Spheres all(*simulator_.atom);
    const LAMMPS_NS::NeighList* const kept = pair->listgranhistory;
    const int history_values = pair->dnum();
    const bool watched = is_watched(pair, addflag);
    const std::vector<LAMMPS_NS::FixInsertStreamPredefined*> streams = streams_with_history();

    ContactBatch& batch = batch_;
    batch.count = 0;
    for (int slot = 0; slot < list.inum; ++slot) {
      const int i = list.ilist[slot];
      const int* const neighbours = list.firstneigh[i];
      const int count = list.numneigh[i];
      if (slot + 1 < list.inum) all.fetch_places(list.firstneigh[list.ilist[slot + 1]], list.numneigh[list.ilist[slot + 1]]);
      const Vec3 position = load(all.x(i));
      const double radius = all.radius[i];
      int* const flags = kept ? kept->firstneigh[i] : nullptr;
      double* const histories = kept ? kept->firstdouble[i] : nullptr;
      for (int k = 0; k < count; ++k) {
        const int j = neighbours[k] & NEIGHMASK;
        double* const history = histories ? histories + static_cast<size_t>(history_values) * k : nullptr;
        for (auto* stream : streams) stream->copy_history(i, j, history);
        const Vec3 apart = position - load(all.x(j));
        const double square = dot(apart, apart);
        const double sum = radius + all.radius[j];
        const bool touching = square < sum * sum;
        const int place = batch.count;
        batch.i[place] = i;
        batch.j[place] = j;
        batch.flags[place] = flags ? flags + k : nullptr;
        batch.history[place] = history;
        batch.touching[place] = touching;
        batch.apart[0][place] = apart.x;
        batch.apart[1][place] = apart.y;
        batch.apart[2][place] = apart.z;
        batch.square[place] = square;
        batch.radius_sum[place] = sum;
        // written anyway and kept if wanted: which pairs touch is not to be guessed
        batch.count += touching | (flags && flags[k]);
        if (batch.count == ContactBatch::kSize) evaluate(batch, all, pair, addflag, watched);
      }
    }
    evaluate(batch, all, pair, addflag, watched);

    if (pair->cpl() && addflag) pair->cpl_pair_finalize();
    if (pair->storeContactForces()) pair->fix_contact_forces()->do_forward_comm();
    if (pair->storeContactForcesStress()) pair->fix_contact_forces_stress()->do_forward_comm();
  }

  // The law of all contacts of a batch, in the order in which they were gathered.
  void evaluate(ContactBatch& batch, const Spheres& all, PairGran* pair, int addflag, bool watched) {
    for (int place = 0; place < batch.count; ++place) {
      const int i = batch.i[place], j = batch.j[place];
      all.fetch_motion(i);
      all.fetch_motion(j);
      model_.describe(batch, place, all.type[i], all.type[j], all.radius[i], all.radius[j]);
    }
    batch.solve();

    Data data;
    data.is_wall = false;
    data.computeflag = pair->computeflag();
    data.shearupdate = pair->shearupdate();
    for (int place = 0; place < batch.count; ++place) {
      const int i = batch.i[place], j = batch.j[place];
      const bool touching = batch.touching[place];
      data.i = i;
      data.j = j;
      data.radi = all.radius[i];
      data.radj = all.radius[j];
      data.radsum = batch.radius_sum[place];
      data.rsq = batch.square[place];
      data.r = batch.distance[place];
      data.rinv = batch.inverse_distance[place];
      for (int axis = 0; axis < 3; ++axis) {
        data.delta[axis] = batch.apart[axis][place];
        data.en[axis] = batch.normal[axis][place];
      }
      data.itype = all.type[i];
      data.jtype = all.type[j];
      data.v_i = all.v(i);
      data.v_j = all.v(j);
      data.omega_i = all.omega(i);
      data.omega_j = all.omega(j);
      data.contact_flags = batch.flags[place];
      data.contact_history = batch.history[place];
      set_masses(data, pair);

      Forces on_i, on_j;
      data.has_force_update = touching;
      if (touching)
        model_.solved_contact(data, batch, place, on_i, on_j);
      else
        model_.surfacesClose(data, on_i, on_j);
      if (!data.has_force_update) continue;

      if (data.computeflag) {
        const double share_i = pair->relax(i);
        accumulate(share_i * load(on_i.delta_F), all.f(i));
        accumulate(share_i * load(on_i.delta_torque), all.torque(i));
        if (simulator_.force->newton_pair || j < all.local) {
          const double share_j = pair->relax(j);
          accumulate(share_j * load(on_j.delta_F), all.f(j));
          accumulate(share_j * load(on_j.delta_torque), all.torque(j));
        }
      }
      if (watched) tell(pair, addflag, data, on_i, on_j);
    }
    batch.count = 0;
  }

  // Effective mass; of a member of a rigid body its body's; with a frozen partner that of the other.
  void set_masses(Data& data, PairGran* pair) const {
    const LAMMPS_NS::Atom& atom = *simulator_.atom;
    const int i = data.i, j = data.j;
    data.mi = atom.rmass ? atom.rmass[i] : atom.mass[data.itype];
    data.mj = atom.rmass ? atom.rmass[j] : atom.mass[data.jtype];
    if (pair->fr_pair()) {
      const double* const body = pair->mr_pair();
      if (body[i] > 0.0) data.mi = body[i];
      if (body[j] > 0.0) data.mj = body[j];
    }
    data.meff = data.mi * data.mj / (data.mi + data.mj);
    if (atom.mask[i] & pair->freeze_group_bit()) data.meff = data.mj;
    if (atom.mask[j] & pair->freeze_group_bit()) data.meff = data.mi;
  }

  bool is_watched(PairGran* pair, int addflag) const {
    return (pair->cpl() && addflag) || pair->evflag || pair->storeContactForces() || pair->storeContactForcesStress() ||
           pair->store_sum_normal_force();
  }

  // Contact lists, virial, stored contact forces and their sum: what computes and fixes have asked to be told.
  PYJKR_RARE void tell(PairGran* pair, int addflag, Data& data, Forces& on_i, Forces& on_j) const {
    const LAMMPS_NS::Atom& atom = *simulator_.atom;
    const int i = data.i, j = data.j, newton = simulator_.force->newton_pair;
    if (data.computeflag && pair->store_sum_normal_force()) {
      const double normal = dot(load(on_i.delta_F), load(data.en));
      *pair->get_sum_normal_force_ptr(i) += normal;
      if (newton || j < atom.nlocal) *pair->get_sum_normal_force_ptr(j) += normal;
    }
    if (pair->cpl() && addflag) pair->cpl_add_pair(data, on_i);
    if (pair->evflag)
      pair->ev_tally_xyz(i, j, atom.nlocal, newton, 0.0, 0.0, on_i.delta_F[0], on_i.delta_F[1], on_i.delta_F[2], data.delta[0],
                         data.delta[1], data.delta[2]);
    if (pair->storeContactForces() && simulator_.update->ntimestep % pair->storeContactForcesEvery() == 0) {
      double of_i[6], of_j[6];
      for (int k = 0; k < 3; ++k) {
        of_i[k] = on_i.delta_F[k];
        of_i[k + 3] = on_i.delta_torque[k];
        of_j[k] = on_j.delta_F[k];
        of_j[k + 3] = on_j.delta_torque[k];
      }
      keep(pair->fix_contact_forces(), i, atom.tag[j], of_i);
      keep(pair->fix_contact_forces(), j, atom.tag[i], of_j);
    }
    if (pair->storeContactForcesStress()) {
      double of_i[4] = {on_i.delta_F[0], on_i.delta_F[1], on_i.delta_F[2], static_cast<double>(j)};
      double of_j[4] = {on_j.delta_F[0], on_j.delta_F[1], on_j.delta_F[2], static_cast<double>(i)};
      keep(pair->fix_contact_forces_stress(), i, atom.tag[j], of_i);
      keep(pair->fix_contact_forces_stress(), j, atom.tag[i], of_j);
    }
  }

  static void keep(LAMMPS_NS::FixContactPropertyAtom* fix, int of, int partner, double* values) {
    if (fix->has_partner(of, partner) == -1) fix->add_partner(of, partner, values);
  }

  // Spheres that fix insert/stream/predefined has just put in bring the history of their contacts along.
  PYJKR_RARE std::vector<LAMMPS_NS::FixInsertStreamPredefined*> streams_with_history() const {
    std::vector<LAMMPS_NS::FixInsertStreamPredefined*> streams;
    const char* const style = "insert/stream/predefined";
    for (int k = 0; k < simulator_.modify->n_fixes_style(style); ++k) {
      auto* const stream = static_cast<LAMMPS_NS::FixInsertStreamPredefined*>(simulator_.modify->find_fix_style(style, k));
      if (stream->has_inserted()) streams.push_back(stream);
    }
    return streams;
  }
};

}  // namespace pyjkr

#endif
