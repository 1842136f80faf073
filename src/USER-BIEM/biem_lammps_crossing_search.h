// Pairs of surfaces that cross, of all ranks: each rank looks into its share of a grid of bins, and
// only triangles in bins with more than one surface are sent. Needs no ghost atoms; knows
// triangles, not atoms.
#ifndef BIEM_LAMMPS_CROSSING_SEARCH_H
#define BIEM_LAMMPS_CROSSING_SEARCH_H

#include "biem_mesh_crossings.h"
#include <mpi.h>

namespace LAMMPS_NS {

// triangles: of this rank. width: of a bin, about a mean edge, the same on all ranks. The pairs are
// ascending and the same on all ranks. Collective.
std::vector<biem::Crossing> find_all_crossings(MPI_Comm world, const biem::MeshLattice &lattice,
                                               double width,
                                               const std::vector<biem::SurfaceTriangle> &triangles);

}    // namespace LAMMPS_NS

#endif
