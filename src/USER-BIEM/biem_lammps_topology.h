// Survey of the meshes before a run, on atoms as LAMMPS distributes them: is every surface closed
// and oriented, how long are its edges, what is its volume. Works without ghost atoms and without
// gathering: each atom has a home rank (tag modulo ranks) where its record can be looked up.
#ifndef BIEM_LAMMPS_TOPOLOGY_H
#define BIEM_LAMMPS_TOPOLOGY_H

#include "lmptype.h"
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

// Which atoms are mesh nodes and which are tracers, by group bits.
struct NodeGroups {
  enum class Cells { Named, Rest };    // named by 'cells', or all atoms of the fix but tracers
  Cells cells = Cells::Rest;
  int fix_bit = 0, cells_bit = 0, tracers_bit = 0;

  // Atoms outside the group of the fix are neither: it would not move them.
  bool is_tracer(int mask) const { return (mask & fix_bit) && (mask & tracers_bit); }
  bool is_cell(int mask) const
  {
    return (mask & fix_bit) && (mask & cells_bit) && !is_tracer(mask);
  }
};

struct MeshSurvey {
  int n_cells = 0;       // largest molecule id of a surface
  int n_surfaces = 0;     // how many there are: molecule ids may have gaps
  bigint n_nodes = 0;    // atoms on surfaces
  bigint n_triangles = 0;
  double longest_edge = 0.0;
  double longest_mean_edge = 0.0;    // largest mean edge of one triangle
  std::vector<double> volumes;       // by molecule id - 1, positive
};

// All cell atoms must be vertices of triangles (angles), tracers of none.
// Stops through error->all() naming molecule or atom. Collective.
MeshSurvey survey_meshes(LAMMPS *lmp, const NodeGroups &groups);

}    // namespace LAMMPS_NS

#endif
