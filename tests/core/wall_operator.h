// Walls for tests, and the single layer of all walls on any number of ranks. Every rank makes the
// same walls and keeps its part.
#ifndef WALL_OPERATOR_H
#define WALL_OPERATOR_H

#include "biem_element_flat.h"
#include "biem_mesh_sheets.h"
#include "biem_mesh_wall.h"
#include "biem_operator_layers.h"
#include "biem_periodic_ghosts.h"
#include <algorithm>
#include <cmath>
#include <map>

using namespace biem;

inline WallMesh make_box(double x, double y, double z)
{
  WallMesh mesh;
  mesh.nodes.resize(3, 0);
  mesh.cell = Vec3(x, y, z).asDiagonal();
  return mesh;
}

inline WallBox get_wall_box(const WallMesh &mesh)
{
  return {mesh.cell, Vec3::Zero()};
}

// Beside the walls that are present, without common nodes.
inline void add_wall(WallMesh &mesh, const SurfaceMesh &wall)
{
  const int n = static_cast<int>(mesh.nodes.cols());
  mesh.nodes.conservativeResize(3, n + wall.nodes.cols());
  mesh.nodes.rightCols(wall.nodes.cols()) = wall.nodes;
  for (const Triangle &t : wall.triangles)
    mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
}

inline WallMesh make_plane(const Vec3 &lengths, double height, double edge)
{
  WallMesh mesh = make_box(lengths[0], lengths[1], lengths[2]);
  add_wall(mesh, make_plane_wall(get_wall_box(mesh), Axis::Z, height, edge));
  return mesh;
}

inline WallMesh make_duct(const Vec3 &lengths, double edge)
{
  WallMesh mesh = make_box(lengths[0], lengths[1], lengths[2]);
  add_wall(mesh, make_duct_wall(get_wall_box(mesh), {Axis::X, 0.3, 0.2}, edge));
  return mesh;
}

inline WallMesh make_tube(double length, double radius, double edge)
{
  WallMesh mesh = make_box(length, length, length);
  add_wall(mesh,
           make_tube_wall(get_wall_box(mesh), {Axis::X, 0.5 * length, 0.5 * length, radius}, edge));
  return mesh;
}

// int (I/r + rr/r^3) f dA over the walls and their images, at all nodes; some may
// be on no wall.
class WallOperator {
 public:
  WallOperator(MPI_Comm comm, const WallMesh &mesh, double tolerance) :
      mesh_(mesh), owned_(list_owned(comm)), parameters_(choose(tolerance)),
      ghosts_(comm, wrap(mesh.nodes)(Eigen::all, owned_), mesh.cell,
              parameters_.cutoff + find_longest_edge()),
      operator_(comm, parameters_)
  {
    list_triangles();
    elements_.set_geometry(ghosts_.nodes(), triangles_);
    candidates_ = find_near_candidates(elements_, ghosts_.nodes());
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(ghosts_.nodes().cols());
    elements_.add_nodal_areas(areas);
    ghosts_.reverse_add(areas.data(), 1);
    const Eigen::VectorXd owned_areas = areas.head(owned_.size());
    const Points no_shift(3, 0);
    operator_.set_cell(mesh.cell, Vec3::Zero());
    operator_.set_geometry({ghosts_.nodes(), ghosts_.n_owned(), elements_, candidates_, owned_areas,
                            triangles_, no_shift},
                           Layers::Single, ghosts_);
  }

  Points apply(const Points &density)
  {
    Points part = Points::Zero(3, ghosts_.nodes().cols());
    for (size_t i = 0; i < owned_.size(); i++)
      part.col(i) = density.col(owned_[i]);
    ghosts_.forward(part.data(), 3);
    const Points velocities = operator_.apply(Layers::Single, part, Points(3, 0), ghosts_);
    Points all = Points::Zero(3, mesh_.nodes.cols());
    for (size_t i = 0; i < owned_.size(); i++)
      all.col(owned_[i]) = velocities.col(i);
    ghosts_.sum(all.data(), static_cast<int>(all.size()));
    return all;
  }

  const EwaldParameters &parameters() const { return parameters_; }

 private:
  Points wrap(const Points &points) const
  {
    Points s = mesh_.cell.inverse() * points;
    s.array() -= s.array().floor();
    return mesh_.cell * s;
  }

  std::vector<int> list_owned(MPI_Comm comm) const
  {
    int rank, n_ranks;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &n_ranks);
    const std::vector<int> ranks = assign_to_ranks(mesh_.nodes, mesh_.cell, n_ranks);
    std::vector<int> owned;
    for (size_t i = 0; i < ranks.size(); i++)
      if (ranks[i] == rank) owned.push_back(static_cast<int>(i));
    return owned;
  }

  EwaldParameters choose(double tolerance) const
  {
    EwaldScene scene;
    scene.cell = mesh_.cell;
    scene.n_sources = static_cast<double>(mesh_.nodes.cols() + mesh_.triangles.size());
    scene.n_targets = static_cast<double>(mesh_.nodes.cols());
    scene.tolerance = tolerance;
    return choose_ewald_parameters(scene);
  }

  Vec3 wrap_difference(const Vec3 &difference) const
  {
    Vec3 s = mesh_.cell.inverse() * difference;
    s.array() -= s.array().round();
    return mesh_.cell * s;
  }

  double find_longest_edge() const
  {
    double longest = 0.0;
    for (const Triangle &t : mesh_.triangles)
      for (int k = 0; k < 3; k++)
        longest = std::max(
            longest,
            wrap_difference(mesh_.nodes.col(t[k]) - mesh_.nodes.col(t[(k + 1) % 3])).norm());
    return longest;
  }

  // A triangle is on the rank that owns its second node; its corners are the closest images.
  void list_triangles()
  {
    const Points &nodes = ghosts_.nodes();
    std::vector<double> ids(nodes.cols());
    std::copy(owned_.begin(), owned_.end(), ids.begin());
    ghosts_.forward(ids.data(), 1);
    std::multimap<int, int> copies;
    std::map<int, int> local;
    for (size_t i = 0; i < ids.size(); i++)
      copies.emplace(static_cast<int>(ids[i]), static_cast<int>(i));
    for (size_t i = 0; i < owned_.size(); i++)
      local[owned_[i]] = static_cast<int>(i);
    for (const Triangle &t : mesh_.triangles) {
      if (!local.count(t[1])) continue;
      const int middle = local[t[1]];
      Triangle corners{middle, middle, middle};
      for (int v : {0, 2}) {
        double least = INFINITY;
        for (auto [i, end] = copies.equal_range(t[v]); i != end; ++i) {
          const double distance = (nodes.col(i->second) - nodes.col(middle)).norm();
          if (distance >= least) continue;
          least = distance;
          corners[v] = i->second;
        }
      }
      triangles_.push_back(corners);
    }
  }

  const WallMesh &mesh_;
  std::vector<int> owned_;
  EwaldParameters parameters_;
  PeriodicGhosts ghosts_;
  LayerOperator operator_;
  FlatElements elements_;
  NearCandidates candidates_;
  std::vector<Triangle> triangles_;
};

#endif
