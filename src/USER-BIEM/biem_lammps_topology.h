// Survey of the meshes before a run, on atoms as LAMMPS distributes them: is every surface closed
// and oriented, how long are its edges, what is its volume. Works without ghost atoms and without
// gathering. Does not know whether surfaces overlap.
#ifndef BIEM_LAMMPS_TOPOLOGY_H
#define BIEM_LAMMPS_TOPOLOGY_H

#include "biem_scene.h"
#include "lmptype.h"
#include <string>
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

// One group of surfaces that fix biem was given; what all its surfaces have in common.
struct SurfaceGroup {
  biem::SurfaceKind kind = biem::SurfaceKind::Cell;
  std::string name;                // of the group; empty: all atoms that are in no other one
  double viscosity_ratio = 1.0;    // cells
  biem::Vec3 force = biem::Vec3::Zero(), torque = biem::Vec3::Zero();    // on each rigid particle
  biem::Vec3 velocity = biem::Vec3::Zero();                              // of walls
  int bit = 0;
};

// Which atoms are nodes of which surfaces and which are only points in the flow, by group bits.
struct NodeGroups {
  int fix_bit = 0;                        // atoms outside the group of the fix do not move
  int tracers_bit = 0, probes_bit = 0;    // 0: none
  std::vector<SurfaceGroup> surfaces;

  bool is_tracer(int mask) const { return (mask & fix_bit) && (mask & tracers_bit); }
  bool is_probe(int mask) const { return (mask & fix_bit) && (mask & probes_bit); }
  // Index into surfaces, or -1.
  int find_surface(int mask) const;
  // In how many of the named groups an atom is.
  int count_groups(int mask) const;
  biem::SurfaceKind kind(int mask) const;
};

struct MeshSurvey {
  int n_molecules = 0;    // largest molecule id of a surface: size of the lists below
  int n_surfaces = 0;     // how many there are: molecule ids may have gaps
  bigint n_nodes = 0;     // atoms on surfaces
  bigint n_triangles = 0;
  double longest_edge = 0.0;
  double longest_mean_edge = 0.0;    // largest mean edge of one triangle
  std::vector<double> volumes;       // by molecule id - 1; positive, 0 for walls
  std::vector<double> areas;         // by molecule id - 1
  std::vector<int> nodes;            // by molecule id - 1
  std::vector<int> group;            // index into NodeGroups::surfaces, by molecule id - 1; or -1
  biem::BlockSizes blocks;
};

// Kinds of surfaces in messages.
std::string describe(biem::SurfaceKind kind);

// All nodes must be vertices of triangles (angles), tracers and probes of none; cells and rigid
// particles must be closed.
// Stops through error->all() naming molecule or atom. Collective.
MeshSurvey survey_meshes(LAMMPS *lmp, const NodeGroups &groups);

}    // namespace LAMMPS_NS

#endif
