// Do surfaces cross, or does one lie in another, before a run? Distributed over the ranks; needs no
// ghost atoms. Knows kinds of surfaces and where they are; not their physics.
#ifndef BIEM_LAMMPS_OVERLAP_CHECK_H
#define BIEM_LAMMPS_OVERLAP_CHECK_H

#include "biem_lammps_topology.h"
#include "biem_mesh_crossings.h"

namespace LAMMPS_NS {

// The first run with the surfaces, or one after other runs or a restart.
enum class RunStart { First, Continued };

// Stops through error->all() with the molecules, what they are and where, if two surfaces cross or
// touch, or one with unknowns lies in a cell or particle, or it in one. Two cells of viscosity
// ratio 1 that earlier runs have made cross cause a warning only: their equations still hold.
// After the survey and the check of its edges. Collective.
void check_overlaps(LAMMPS *lmp, const NodeGroups &groups, const MeshSurvey &survey,
                    RunStart start);

// Triangles of this rank, from the angles of its atoms, corners in one piece. Collective.
std::vector<biem::SurfaceTriangle> collect_triangles(LAMMPS *lmp, const NodeGroups &groups);

}    // namespace LAMMPS_NS

#endif
