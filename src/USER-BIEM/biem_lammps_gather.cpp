// Gathering of whole surfaces: see the header.
#include "biem_lammps_gather.h"
#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "pointers.h"
#include <algorithm>

namespace LAMMPS_NS {

namespace {

struct NodeRecord {
  int64_t molecule, tag;
  double x[3], reference[3];
};

struct TriangleRecord {
  int64_t molecule, tags[3];
};

class Gatherer : protected Pointers {
 public:
  explicit Gatherer(LAMMPS *lmp) : Pointers(lmp) {}

  std::map<int, GatheredSurface> run(const NodeGroups &groups, biem::SurfaceKind kind)
  {
    std::vector<NodeRecord> nodes;
    std::vector<TriangleRecord> triangles;
    double **reference = find_reference();
    for (int i = 0; i < atom->nlocal; i++) {
      if (groups.kind(atom->mask[i]) != kind) continue;
      NodeRecord r{atom->molecule[i], atom->tag[i], {}, {}};
      domain->unmap(atom->x[i], atom->image[i], r.x);
      if (reference) std::copy_n(reference[i], 3, r.reference);
      nodes.push_back(r);
      for (int a = 0; a < atom->num_angle[i]; a++)
        triangles.push_back(
            {atom->molecule[i],
             {atom->angle_atom1[i][a], atom->angle_atom2[i][a], atom->angle_atom3[i][a]}});
    }
    // In the order of the ids on any number of ranks.
    nodes = share(nodes);
    std::sort(nodes.begin(), nodes.end(),
              [](const NodeRecord &a, const NodeRecord &b) { return a.tag < b.tag; });
    triangles = share(triangles);
    std::sort(triangles.begin(), triangles.end(),
              [](const TriangleRecord &a, const TriangleRecord &b) {
                return std::lexicographical_compare(a.tags, a.tags + 3, b.tags, b.tags + 3);
              });
    return sort_by_molecule(nodes, triangles);
  }

 private:
  double **find_reference() const
  {
    int is_double, n_columns;
    const int index = atom->find_custom("biem_reference", is_double, n_columns);
    return index >= 0 && is_double && n_columns == 3 ? atom->darray[index] : nullptr;
  }

  template <class T> std::vector<T> share(const std::vector<T> &mine) const
  {
    const int n_bytes = static_cast<int>(mine.size() * sizeof(T));
    std::vector<int> counts(comm->nprocs), offsets(comm->nprocs, 0);
    MPI_Allgather(&n_bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
    for (int r = 1; r < comm->nprocs; r++)
      offsets[r] = offsets[r - 1] + counts[r - 1];
    std::vector<T> all((offsets.back() + counts.back()) / sizeof(T));
    MPI_Allgatherv(mine.data(), n_bytes, MPI_BYTE, all.data(), counts.data(), offsets.data(),
                   MPI_BYTE, world);
    return all;
  }

  static std::map<int, GatheredSurface>
  sort_by_molecule(const std::vector<NodeRecord> &nodes,
                   const std::vector<TriangleRecord> &triangles)
  {
    std::map<int, GatheredSurface> surfaces;
    std::map<int64_t, int> index;
    for (const NodeRecord &r : nodes) {
      GatheredSurface &s = surfaces[static_cast<int>(r.molecule)];
      index[r.tag] = static_cast<int>(s.tags.size());
      s.tags.push_back(static_cast<tagint>(r.tag));
    }
    for (auto &entry : surfaces) {
      entry.second.positions.resize(3, static_cast<Eigen::Index>(entry.second.tags.size()));
      entry.second.references = entry.second.positions;
    }
    for (const NodeRecord &r : nodes) {
      GatheredSurface &s = surfaces[static_cast<int>(r.molecule)];
      s.positions.col(index[r.tag]) = biem::Vec3(r.x);
      s.references.col(index[r.tag]) = biem::Vec3(r.reference);
    }
    for (const TriangleRecord &t : triangles)
      surfaces[static_cast<int>(t.molecule)].triangles.push_back(
          {index[t.tags[0]], index[t.tags[1]], index[t.tags[2]]});
    return surfaces;
  }
};

}    // namespace

std::map<int, GatheredSurface> gather_surfaces(LAMMPS *lmp, const NodeGroups &groups,
                                               biem::SurfaceKind kind)
{
  return Gatherer(lmp).run(groups, kind);
}

}    // namespace LAMMPS_NS
