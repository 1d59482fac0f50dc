// The loop over neighbour pairs behind `pair_style gran` for the jkr models, in place of LIGGGHTS' generic one.
// A pair that does not touch and did not touch costs its distance and a flag: contacts that end and necks are found by
// the flag they left, not by a wider search. Sums in the order of the neighbour lists. Spheres only.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_PAIR_LOOP_H
#define PYJKR_ADAPTERS_PAIR_LOOP_H

#include <cmath>
#include <vector>

#include "../kernels/vec3.h"
#include "liggghts_headers.h"

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
    if (eflag || vflag)
      pair->ev_setup(eflag, vflag);
    else
      pair->evflag = pair->vflag_fdotr = 0;

    LAMMPS_NS::Atom& atom = *simulator_.atom;
    const LAMMPS_NS::NeighList& list = *pair->list;
    const LAMMPS_NS::NeighList* const kept = pair->listgranhistory;
    const int history_values = pair->dnum();
    const bool watched = is_watched(pair, addflag);
    const std::vector<LAMMPS_NS::FixInsertStreamPredefined*> streams = streams_with_history();

    Data data;
    data.is_wall = false;
    data.computeflag = pair->computeflag();
    data.shearupdate = pair->shearupdate();
    for (int slot = 0; slot < list.inum; ++slot) {
      const int i = list.ilist[slot];
      const Vec3 position = load(atom.x[i]);
      const double radius = atom.radius[i];
      int* const flags = kept ? kept->firstneigh[i] : nullptr;
      double* const histories = kept ? kept->firstdouble[i] : nullptr;
      data.i = i;
      data.radi = radius;
      data.itype = atom.type[i];
      data.v_i = atom.v[i];
      data.omega_i = atom.omega[i];
      Vec3 force{0.0, 0.0, 0.0}, torque{0.0, 0.0, 0.0};
      for (int k = 0; k < list.numneigh[i]; ++k) {
        const int j = list.firstneigh[i][k] & NEIGHMASK;
        double* const history = histories ? histories + static_cast<size_t>(history_values) * k : nullptr;
        for (auto* stream : streams) stream->copy_history(i, j, history);
        const Vec3 apart = position - load(atom.x[j]);
        const double square = dot(apart, apart);
        const double sum = radius + atom.radius[j];
        const bool touching = square < sum * sum;
        if (!touching && !(flags && flags[k])) continue;

        data.j = j;
        data.radj = atom.radius[j];
        data.radsum = sum;
        data.rsq = square;
        store(apart, data.delta);
        data.jtype = atom.type[j];
        data.v_j = atom.v[j];
        data.omega_j = atom.omega[j];
        data.contact_flags = flags ? flags + k : nullptr;
        data.contact_history = history;
        set_masses(data, pair);
        data.r = std::sqrt(square);
        data.rinv = 1.0 / data.r;
        store(data.rinv * apart, data.en);

        Forces on_i, on_j;
        data.has_force_update = touching;
        if (touching)
          model_.surfacesIntersect(data, on_i, on_j);
        else
          model_.surfacesClose(data, on_i, on_j);
        if (!data.has_force_update) continue;

        if (data.computeflag) {
          force = force + load(on_i.delta_F);
          torque = torque + load(on_i.delta_torque);
          if (simulator_.force->newton_pair || j < atom.nlocal) {
            const double share = pair->relax(j);
            accumulate(share * load(on_j.delta_F), atom.f[j]);
            accumulate(share * load(on_j.delta_torque), atom.torque[j]);
          }
        }
        if (watched) tell(pair, addflag, data, on_i, on_j);
      }
      const double share = pair->relax(i);
      accumulate(share * force, atom.f[i]);
      accumulate(share * torque, atom.torque[i]);
    }

    if (pair->cpl() && addflag) pair->cpl_pair_finalize();
    if (pair->storeContactForces()) pair->fix_contact_forces()->do_forward_comm();
    if (pair->storeContactForcesStress()) pair->fix_contact_forces_stress()->do_forward_comm();
  }

 private:
  Simulator simulator_;
  Model model_;

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
  void tell(PairGran* pair, int addflag, Data& data, Forces& on_i, Forces& on_j) const {
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
  std::vector<LAMMPS_NS::FixInsertStreamPredefined*> streams_with_history() const {
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
