// liggghts-jkr: the command line of liggghts with the jkr styles registered. Linked to the unmodified libliggghts.
// SPDX-License-Identifier: GPL-2.0-or-later

#include <mpi.h>

#include "input.h"
#include "lammps.h"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    LAMMPS_NS::LAMMPS simulator(argc, argv, MPI_COMM_WORLD);
    simulator.input->file();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
  return 0;
}
