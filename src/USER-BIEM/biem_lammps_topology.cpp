// Distributed survey of the meshes: see the header.
#include "biem_lammps_topology.h"
#include "atom.h"
#include "biem_lammps_atom_directory.h"
#include "biem_lammps_compat.h"
#include "biem_types.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "pointers.h"
#include "update.h"
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace LAMMPS_NS {

int NodeGroups::find_surface(int mask) const
{
  if (!(mask & fix_bit) || is_tracer(mask) || is_probe(mask)) return -1;
  int rest = -1;
  for (size_t g = 0; g < surfaces.size(); g++) {
    if (surfaces[g].name.empty())
      rest = static_cast<int>(g);
    else if (mask & surfaces[g].bit)
      return static_cast<int>(g);
  }
  return rest;
}

int NodeGroups::count_groups(int mask) const
{
  int n = is_tracer(mask) + is_probe(mask);
  for (const SurfaceGroup &g : surfaces)
    n += !g.name.empty() && (mask & fix_bit) && (mask & g.bit);
  return n;
}

biem::SurfaceKind NodeGroups::kind(int mask) const
{
  const int g = find_surface(mask);
  return g < 0 ? biem::SurfaceKind::None : surfaces[g].kind;
}

namespace {

struct DirectedEdge {
  int64_t low, high, molecule;
  int direction;    // +1: low -> high in a triangle's order, -1: high -> low
};

class Surveyor : protected Pointers {
 public:
  Surveyor(LAMMPS *lmp, const NodeGroups &groups) : Pointers(lmp), groups_(groups) {}

  MeshSurvey run()
  {
    register_atoms();
    check_groups();
    const std::vector<AtomRecord> corners = look_up_corners();
    measure(corners);
    check_closed(corners);
    check_vertices();
    check_volumes();
    return survey_;
  }

 private:
  // The smallest value over all ranks; kNoTag where no rank has one.
  int64_t smallest(int64_t value) const
  {
    int64_t result;
    MPI_Allreduce(&value, &result, 1, MPI_INT64_T, MPI_MIN, world);
    return result;
  }

  void register_atoms()
  {
    int64_t lost = kNoTag;
    for (int i = 0; i < atom->nlocal; i++)
      if (!std::isfinite(atom->x[i][0] + atom->x[i][1] + atom->x[i][2]))
        lost = std::min(lost, static_cast<int64_t>(atom->tag[i]));
    fail_if(smallest(lost), "atom",
            "has a position that is not a number at step " + std::to_string(update->ntimestep) +
                ": check the data file and the commands that move atoms");
    directory_ = std::make_unique<AtomDirectory>(lmp);
  }

  void check_groups()
  {
    int64_t none = kNoTag, both = kNoTag, molecule = kNoTag;
    for (const auto &entry : directory_->records()) {
      const AtomRecord &r = entry.second;
      const bool is_node = groups_.find_surface(r.mask) >= 0;
      const bool is_point = groups_.is_tracer(r.mask) || groups_.is_probe(r.mask);
      if (!is_node && !is_point) none = std::min(none, r.tag);
      if (groups_.count_groups(r.mask) > 1) both = std::min(both, r.tag);
      if (is_node && r.molecule <= 0) molecule = std::min(molecule, r.tag);
      if (is_node)
        survey_.n_molecules = std::max(survey_.n_molecules, static_cast<int>(r.molecule));
    }
    fail_if(smallest(none), "atom",
            "is in none of the groups of fix biem (cells, rigid, wall, tracers, probes), or not in "
            "the group of the fix itself: every atom must be in exactly one of these groups");
    fail_if(smallest(both), "atom",
            "is in two of the groups of fix biem (cells, rigid, wall, tracers, probes): the groups "
            "must not overlap");
    fail_if(smallest(molecule), "atom",
            "is a mesh node without a molecule id: number the surfaces "
            "1, 2, ... with the molecule id");
    int largest;
    MPI_Allreduce(&survey_.n_molecules, &largest, 1, MPI_INT, MPI_MAX, world);
    survey_.n_molecules = largest;
    survey_.volumes.assign(largest, 0.0);
    find_groups();
  }

  // All nodes of one molecule are in one group.
  void find_groups()
  {
    const size_t n = survey_.n_molecules;
    std::vector<int> range(2 * n, -1), all(2 * n);    // largest group, largest -group, by molecule
    for (size_t m = 0; m < n; m++)
      range[2 * m + 1] = INT_MIN;
    for (const auto &entry : directory_->records()) {
      const int g = groups_.find_surface(entry.second.mask);
      if (g < 0) continue;
      int *r = &range[2 * (entry.second.molecule - 1)];
      r[0] = std::max(r[0], g);
      r[1] = std::max(r[1], -g);
    }
    MPI_Allreduce(range.data(), all.data(), static_cast<int>(2 * n), MPI_INT, MPI_MAX, world);
    survey_.group.resize(n);
    for (size_t m = 0; m < n; m++) {
      survey_.group[m] = all[2 * m];
      if (all[2 * m] >= 0 && all[2 * m] != -all[2 * m + 1])
        error->all(FLERR, "Fix biem: the nodes of molecule " + std::to_string(m + 1) +
                              " are in different groups of fix biem: all nodes of one surface must "
                              "be in the same one");
    }
  }

  biem::SurfaceKind kind_of(int64_t molecule) const
  {
    const int g = molecule >= 1 && molecule <= survey_.n_molecules ? survey_.group[molecule - 1]
                                                                   : -1;
    return g < 0 ? biem::SurfaceKind::None : groups_.surfaces[g].kind;
  }

  void fail_if(int64_t who, const std::string &kind, const std::string &what)
  {
    if (who != kNoTag)
      error->all(FLERR, "Fix biem: " + kind + " " + std::to_string(who) + " " + what);
  }

  std::vector<AtomRecord> look_up_corners()
  {
    int64_t missing;
    const std::vector<AtomRecord> corners = directory_->look_up_corners(missing);
    fail_if(smallest(missing), "atom", "is named by an angle but does not exist: was it deleted?");
    return corners;
  }

  void measure(const std::vector<AtomRecord> &corners)
  {
    int64_t mixed = kNoTag, tracer = kNoTag;
    double longest[2] = {0.0, 0.0};
    const size_t n_molecules = survey_.n_molecules;
    std::vector<double> volumes(2 * n_molecules, 0.0);    // volumes, then areas
    for (size_t t = 0; t < corners.size(); t += 3) {
      biem::Vec3 x[3];
      for (int v = 0; v < 3; v++) {
        const AtomRecord &r = corners[t + v];
        x[v] = biem::Vec3(r.x[0], r.x[1], r.x[2]);
        if (groups_.find_surface(r.mask) < 0) tracer = std::min(tracer, r.tag);
        if (r.molecule != corners[t].molecule) mixed = std::min(mixed, r.tag);
      }
      const int64_t molecule = corners[t].molecule;
      const bool is_wall = kind_of(molecule) == biem::SurfaceKind::Wall;
      for (int v = 1; is_wall && v < 3; v++) {    // walls cross the box: the closest images
        biem::Vec3 d = x[v] - x[0];
        BiemCompat::minimum_image(domain, d.data());
        x[v] = x[0] + d;
      }
      double sum = 0.0;
      for (int v = 0; v < 3; v++) {
        const double edge = (x[(v + 1) % 3] - x[v]).norm();
        longest[0] = std::max(longest[0], edge);
        sum += edge;
      }
      longest[1] = std::max(longest[1], sum / 3.0);
      if (molecule >= 1 && molecule <= survey_.n_molecules)
        volumes[n_molecules + molecule - 1] += 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
      if (molecule >= 1 && molecule <= survey_.n_molecules && !is_wall)
        volumes[molecule - 1] += x[0].dot(x[1].cross(x[2])) / 6.0;
    }
    fail_if(smallest(tracer), "atom",
            "is a vertex of a triangle (angle) but not in the cells, rigid particles or walls of "
            "fix biem: put all nodes of a surface into one of these groups");
    fail_if(smallest(mixed), "atom",
            "has another molecule id than a neighbor in its triangle: all "
            "nodes of one surface must have the same molecule id");
    double all[2];
    MPI_Allreduce(longest, all, 2, MPI_DOUBLE, MPI_MAX, world);
    survey_.longest_edge = all[0];
    survey_.longest_mean_edge = all[1];
    std::vector<double> sums(2 * n_molecules);
    MPI_Allreduce(volumes.data(), sums.data(), static_cast<int>(2 * n_molecules), MPI_DOUBLE,
                  MPI_SUM, world);
    survey_.volumes.assign(sums.begin(), sums.begin() + n_molecules);
    survey_.areas.assign(sums.begin() + n_molecules, sums.end());
    bigint n = static_cast<bigint>(corners.size() / 3);
    MPI_Allreduce(&n, &survey_.n_triangles, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  }

  // Closed and oriented: every edge once in each direction.
  void check_closed(const std::vector<AtomRecord> &corners)
  {
    std::vector<std::vector<DirectedEdge>> outgoing(comm->nprocs);
    for (size_t t = 0; t < corners.size(); t += 3)
      for (int v = 0; v < 3; v++) {
        const int64_t a = corners[t + v].tag, b = corners[t + (v + 1) % 3].tag;
        const DirectedEdge edge{std::min(a, b), std::max(a, b), corners[t].molecule,
                                a < b ? 1 : -1};
        outgoing[directory_->home(edge.low)].push_back(edge);
      }
    std::vector<int> counts;
    std::map<std::pair<int64_t, int64_t>, std::vector<DirectedEdge>> edges;
    for (const DirectedEdge &edge : exchange_records(world, outgoing, counts))
      edges[{edge.low, edge.high}].push_back(edge);
    int64_t open = kNoTag, crowded = kNoTag, turned = kNoTag;
    for (const auto &entry : edges) {
      const std::vector<DirectedEdge> &e = entry.second;
      if (kind_of(e[0].molecule) == biem::SurfaceKind::Wall) continue;    // may be open, or cross
      if (e.size() == 1) open = std::min(open, e[0].molecule);
      if (e.size() > 2) crowded = std::min(crowded, e[0].molecule);
      if (e.size() == 2 && e[0].direction == e[1].direction)
        turned = std::min(turned, e[0].molecule);
    }
    const int64_t hole = smallest(open);
    fail_if(hole, "the surface of molecule",
            "is open: one of its edges belongs to a single triangle, but a " +
                describe(kind_of(hole)) + " must be closed; check the angles of the data file");
    fail_if(smallest(crowded), "the surface of molecule",
            "has an edge with more than two triangles: check the angles of the data file, and that "
            "no triangle is listed twice");
    fail_if(smallest(turned), "the surface of molecule",
            "is not consistently oriented: two neighboring triangles run through their common edge "
            "in the same direction; list the nodes of each angle counter-clockwise from outside");
  }

  void check_vertices()
  {
    int64_t loose = kNoTag, point = kNoTag;
    long counts[4] = {}, all[4];
    std::vector<int> nodes(survey_.n_molecules, 0);
    for (const auto &entry : directory_->records()) {
      const AtomRecord &r = entry.second;
      const int g = groups_.find_surface(r.mask);
      if (g >= 0 && !r.is_vertex) loose = std::min(loose, r.tag);
      if (g < 0 && r.is_vertex) point = std::min(point, r.tag);
      if (g < 0) continue;
      nodes[r.molecule - 1]++;
      const SurfaceGroup &group = groups_.surfaces[g];
      counts[group.kind == biem::SurfaceKind::Rigid  ? 2
             : group.kind == biem::SurfaceKind::Wall ? 3
             : group.viscosity_ratio == 1.0          ? 0
                                                     : 1]++;
    }
    fail_if(smallest(loose), "atom",
            "is on a cell, rigid particle or wall of fix biem but in no triangle (angle): give it "
            "to a group and name that group with the keyword 'tracers' or 'probes', or delete it");
    fail_if(smallest(point), "atom", "is a tracer or probe of fix biem but a vertex of a triangle");
    MPI_Allreduce(counts, all, 4, MPI_LONG, MPI_SUM, world);
    survey_.nodes.resize(nodes.size());
    MPI_Allreduce(nodes.data(), survey_.nodes.data(), survey_.n_molecules, MPI_INT, MPI_SUM, world);
    survey_.blocks = {all[0], all[1], all[2], all[3]};
    survey_.n_nodes = all[0] + all[1] + all[2] + all[3];
  }

  void check_volumes()
  {
    for (int c = 0; c < survey_.n_molecules; c++) {
      survey_.n_surfaces += survey_.group[c] >= 0;
      if (survey_.volumes[c] < 0.0)
        error->all(FLERR, "Fix biem: the surface of molecule " + std::to_string(c + 1) +
                              " is turned inside out (volume " +
                              std::to_string(survey_.volumes[c]) +
                              "): list the nodes of each angle counter-clockwise from outside");
    }
  }

  NodeGroups groups_;
  std::unique_ptr<AtomDirectory> directory_;
  MeshSurvey survey_;
};

}    // namespace

std::string describe(biem::SurfaceKind kind)
{
  if (kind == biem::SurfaceKind::Rigid) return "rigid particle";
  return kind == biem::SurfaceKind::Wall ? "wall" : "cell";
}

MeshSurvey survey_meshes(LAMMPS *lmp, const NodeGroups &groups)
{
  return Surveyor(lmp, groups).run();
}

}    // namespace LAMMPS_NS
