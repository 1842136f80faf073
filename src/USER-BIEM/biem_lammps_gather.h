// Copies of whole surfaces on every rank: rigid particles and walls, which are small and whose
// shapes do not change. Knows atoms and angles, nothing of what the surfaces are for.
#ifndef BIEM_LAMMPS_GATHER_H
#define BIEM_LAMMPS_GATHER_H

#include "biem_lammps_topology.h"
#include <map>

namespace LAMMPS_NS {

struct GatheredSurface {
  std::vector<tagint> tags;    // ascending; node i of the surface is atom tags[i]
  biem::Points positions;      // 3 x n, unwrapped
  biem::Points references;     // 3 x n: d2_biem_reference; zero where there is none
  std::vector<biem::Triangle> triangles;
};

// By molecule id: the surfaces of one kind, the same on all ranks. Collective.
std::map<int, GatheredSurface> gather_surfaces(LAMMPS *lmp, const NodeGroups &groups,
                                               biem::SurfaceKind kind);

}    // namespace LAMMPS_NS

#endif
