// Walls for tests, and the single layer of all walls on any number of ranks. Every rank makes the
// same walls and keeps its part.
#ifndef WALL_OPERATOR_H
#define WALL_OPERATOR_H

#include "biem_element_flat.h"
#include "biem_mesh_sheets.h"
#include "biem_mesh_wall.h"
#include "biem_operator_layers.h"
#include "distributed_mesh.h"
#include <algorithm>
#include <cmath>

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
      mesh_(mesh), owned_(list_owned(comm, mesh.nodes, mesh.cell)), parameters_(choose(tolerance)),
      ghosts_(comm, wrap_points(mesh.nodes, mesh.cell)(Eigen::all, owned_), mesh.cell,
              parameters_.cutoff + find_longest_edge()),
      operator_(comm, parameters_)
  {
    triangles_ = list_local_triangles(owned_, ghosts_, mesh.nodes, mesh.triangles).triangles;
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
    return gather_nodes(velocities, owned_, mesh_.nodes.cols(), ghosts_);
  }

  const EwaldParameters &parameters() const { return parameters_; }

 private:
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
