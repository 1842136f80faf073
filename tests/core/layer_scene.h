// Scenes of spheres in a periodic cell, and the layer operator on one rank's part of them, for the
// tests of the operator. Every rank makes the same scene and keeps its part.
#ifndef BIEM_TESTS_LAYER_SCENE_H
#define BIEM_TESTS_LAYER_SCENE_H

#include "biem_element_flat.h"
#include "biem_mesh_icosphere.h"
#include "biem_operator_layers.h"
#include "distributed_mesh.h"
#include <algorithm>
#include <cmath>

namespace biem {

const Points kNone(3, 0);

// Surfaces of equally many nodes, in one piece, then points on no surface.
struct LayerScene {
  Mat3 cell;
  Points nodes;
  std::vector<Triangle> triangles;
  int n_surface_nodes = 0, nodes_per_surface = 0;

  // Unit sphere, scaled to the volume of a smooth one, its first node on top. The largest index
  // comes second, so that some nodes are second in no triangle.
  void add_sphere(int n_nodes, const Vec3 &center)
  {
    const SurfaceMesh mesh = make_icosphere(compute_icosphere_frequency(n_nodes));
    double volume = 0.0;
    for (Triangle t : mesh.triangles) {
      volume += mesh.nodes.col(t[0]).dot(mesh.nodes.col(t[1]).cross(mesh.nodes.col(t[2]))) / 6.0;
      while (t[1] < t[0] || t[1] < t[2])
        std::rotate(t.begin(), t.begin() + 1, t.end());
      triangles.push_back({t[0] + n_surface_nodes, t[1] + n_surface_nodes, t[2] + n_surface_nodes});
    }
    const Vec3 first = mesh.nodes.col(0);
    const Mat3 rotation = Eigen::Quaterniond::FromTwoVectors(first, Vec3::UnitZ()).matrix();
    const Points scaled = std::cbrt(4.0 * M_PI / 3.0 / volume) * rotation * mesh.nodes;
    add_points(scaled.colwise() + center);
    n_surface_nodes += n_nodes;
    nodes_per_surface = n_nodes;
  }

  void add_points(const Points &points)
  {
    const Eigen::Index n = nodes.cols();
    nodes.conservativeResize(3, n + points.cols());
    nodes.rightCols(points.cols()) = points;
  }

  // Every node for itself inside the cell.
  Points wrapped() const { return wrap_points(nodes, cell); }

  EwaldParameters choose(double tolerance) const
  {
    EwaldScene scene;
    scene.cell = cell;
    scene.n_sources = static_cast<double>(n_surface_nodes + triangles.size());
    scene.n_targets = static_cast<double>(nodes.cols());
    scene.body_sources = scene.n_sources;
    scene.body_radius = 1.0;
    scene.tolerance = tolerance;
    scene.layers = Layers::Both;
    return choose_ewald_parameters(scene);
  }
};

// Two spheres in a tilted cell: the first one with its centre at a corner of the cell, the second
// one with a single node above the top. And points inside of each, outside, and close to the first.
inline LayerScene make_two_spheres(int n_nodes)
{
  LayerScene scene;
  scene.cell << 4.0, 0.3, 1.1, 0.0, 4.4, -0.5, 0.0, 0.0, 4.2;
  const double above_top = 0.005;
  Vec3 second(3.2, 1.7, 4.2 + above_top);
  scene.add_sphere(n_nodes, Vec3::Zero());
  second[2] -= scene.nodes(2, 0);    // the first node is on top of its sphere
  scene.add_sphere(n_nodes, second);
  const Vec3 direction = Vec3(0.3, -0.5, 0.81).normalized();
  Points points(3, 6);
  points << Vec3(0.3, -0.4, 0.2), Vec3(0.9 * direction), Vec3(second + 0.5 * direction),
      Vec3(1.1 * direction), Vec3(2.0, 0.1, 0.2), Vec3(-0.1, 2.2, 0.3);
  scene.add_points(points);
  return scene;
}
constexpr double kInside[6] = {1, 1, 1, 0, 0, 0};    // points of make_two_spheres

// Three spheres, the last one close to both others, and a point inside of each.
inline LayerScene make_three_spheres(int n_nodes)
{
  LayerScene scene;
  scene.cell << 5.0, 0.3, 1.1, 0.0, 4.8, -0.5, 0.0, 0.0, 4.4;
  Points centers(3, 3);
  centers << Vec3(0.1, 0.0, 4.3), Vec3(2.6, 2.3, 4.4), Vec3(0.3, 2.06, 4.5);
  for (int s = 0; s < 3; s++)
    scene.add_sphere(n_nodes, centers.col(s));
  scene.add_points(centers);
  return scene;
}

// What an operator is restricted to; empty: nothing.
struct Selection {
  std::vector<int> sources;         // surfaces
  std::vector<Layers> carried;      // by each surface
  std::vector<char> targets = {};    // by node of the scene
};

// The operator on one rank's part of a scene; densities and results are those of all nodes.
class Distributed {
 public:
  Distributed(MPI_Comm comm, const LayerScene &scene, double tolerance,
              Layers layers = Layers::Both, const Selection &selection = {}) :
      scene_(scene), owned_(list_owned(comm, scene.nodes, scene.cell)),
      parameters_(scene.choose(tolerance)),
      ghosts_(comm, scene.wrapped()(Eigen::all, owned_), scene.cell, parameters_.cutoff + 1.0),
      operator_(comm, parameters_)
  {
    const LocalTriangles local =
        list_local_triangles(owned_, ghosts_, scene.nodes, scene.triangles);
    triangles_ = local.triangles;
    shift_ = local.shift;
    for (int e : local.numbers)
      surfaces_.push_back(scene.triangles[e][1] / scene.nodes_per_surface);
    select(selection);
    elements_.set_geometry(ghosts_.nodes(), triangles_);
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(ghosts_.nodes().cols());
    elements_.add_nodal_areas(areas);
    ghosts_.reverse_add(areas.data(), 1);
    const Eigen::VectorXd owned_areas = areas.head(owned_.size());
    operator_.set_cell(scene.cell, Vec3::Zero());
    operator_.set_geometry({ghosts_.nodes(), ghosts_.n_owned(), elements_, candidates_, owned_areas,
                            triangles_, shift_, selection.targets.empty() ? nullptr : &is_target_,
                            selection.carried.empty() ? nullptr : &carried_},
                           layers, ghosts_);
  }

  Points apply(Layers layers, const Points &single, const Points &dual)
  {
    return gather(operator_.apply(layers, distribute(single), distribute(dual), ghosts_));
  }

  OperatorProfile profile() const { return operator_.profile(); }

  // All surfaces of a scene are closed.
  RowSums compute_row_sums()
  {
    Eigen::VectorXd is_closed = Eigen::VectorXd::Zero(ghosts_.nodes().cols());
    for (size_t i = 0; i < owned_.size(); i++)
      is_closed[i] = owned_[i] < scene_.n_surface_nodes ? 1.0 : 0.0;
    ghosts_.forward(is_closed.data(), 1);
    return operator_.compute_row_sums(is_closed, ghosts_);
  }

  Points apply_subtracted(const Points &dual)
  {
    const Points density = distribute(dual);
    Points velocity = operator_.apply(Layers::Double, kNone, density, ghosts_);
    subtract_singularity(compute_row_sums(), density, velocity);
    return gather(velocity);
  }

 private:
  void select(const Selection &selection)
  {
    Eigen::VectorXd marks = Eigen::VectorXd::Zero(ghosts_.nodes().cols());
    for (size_t i = 0; i < owned_.size(); i++)
      marks[i] = selection.targets.empty() || selection.targets[owned_[i]] ? 1.0 : 0.0;
    ghosts_.forward(marks.data(), 1);
    is_target_.assign(marks.begin(), marks.end());
    std::vector<int> sources;
    for (size_t e = 0; e < surfaces_.size(); e++)
      if (selection.sources.empty() || std::count(selection.sources.begin(),
                                                  selection.sources.end(), surfaces_[e]) > 0)
        sources.push_back(static_cast<int>(e));
    FlatElements all;
    all.set_geometry(ghosts_.nodes(), triangles_);
    candidates_ =
        select_candidates(find_near_candidates(all, ghosts_.nodes()), sources, &is_target_);
    std::vector<Triangle> triangles;
    for (int e : sources) {
      triangles.push_back(triangles_[e]);
      if (!selection.carried.empty()) carried_.push_back(selection.carried[surfaces_[e]]);
    }
    triangles_ = triangles;
    shift_ = Points(shift_(Eigen::all, sources));
  }

  Points distribute(const Points &values)
  {
    if (values.cols() == 0) return values;
    Points part = Points::Zero(3, ghosts_.nodes().cols());
    for (size_t i = 0; i < owned_.size(); i++)
      part.col(i) = values.col(owned_[i]);
    ghosts_.forward(part.data(), 3);
    return part;
  }

  Points gather(const Points &part)
  {
    return gather_nodes(part, owned_, scene_.nodes.cols(), ghosts_);
  }

  const LayerScene &scene_;
  std::vector<int> owned_;
  EwaldParameters parameters_;
  PeriodicGhosts ghosts_;
  LayerOperator operator_;
  FlatElements elements_;
  NearCandidates candidates_;
  std::vector<Triangle> triangles_;
  Points shift_;
  std::vector<int> surfaces_;    // of all triangles, before the selection
  std::vector<char> is_target_;
  std::vector<Layers> carried_;
};

inline Points make_uniform(const LayerScene &scene, const Vec3 &value)
{
  Points density = Points::Zero(3, scene.nodes.cols());
  density.leftCols(scene.n_surface_nodes).colwise() = value;
  return density;
}

inline Points make_smooth(const LayerScene &scene, double phase)
{
  Points density = Points::Zero(3, scene.nodes.cols());
  for (int i = 0; i < scene.n_surface_nodes; i++) {
    const Vec3 x = scene.nodes.col(i);
    density.col(i) = Vec3(std::sin(x[2] + phase), x[0] * x[1] - phase, std::cos(x[0] + 2 * x[1]));
  }
  return density;
}

inline double compute_largest(const Points &points)
{
  return points.cwiseAbs().maxCoeff();
}

}    // namespace biem

#endif
