// The headers of LIGGGHTS in the one order that compiles on Debian.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_LIGGGHTS_HEADERS_H
#define PYJKR_ADAPTERS_LIGGGHTS_HEADERS_H

#include <mpi.h>

#include "fix_insert_stream.h"  // pair_gran_base.h needs its base class but does not include it
#include "atom.h"
#include "comm.h"
#include "contact_models.h"
#include "error.h"
#include "fix_property_global.h"
#include "fix_wall_gran_base.h"
#include "force.h"
#include "global_properties.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_gran_base.h"
#include "update.h"

namespace pyjkr {

// LIGGGHTS' own pointers, for classes whose base keeps them private.
struct Simulator : LAMMPS_NS::Pointers {
  using Pointers::atom;
  using Pointers::comm;
  using Pointers::error;
  using Pointers::force;
  using Pointers::lmp;
  using Pointers::modify;
  using Pointers::neighbor;
  using Pointers::Pointers;
  using Pointers::update;
  using Pointers::world;
};

}  // namespace pyjkr

#endif
