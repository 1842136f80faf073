// Small periodic scenes of cells, rigid particles, walls and free points, and a Suspension on one
// rank's part of them, for the tests of the coupled system. Every rank makes the same scene and
// keeps its part; what goes in and comes out is that of all nodes.
#ifndef BIEM_TESTS_COUPLED_SCENE_H
#define BIEM_TESTS_COUPLED_SCENE_H

#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include "biem_mesh_wall.h"
#include "biem_suspension.h"
#include "distributed_mesh.h"
#include <algorithm>
#include <cmath>

namespace biem {

// Surfaces in the order in which they were added, closed ones in one piece; then free points.
struct CoupledScene {
  Mat3 cell;
  Scene scene;
  std::vector<SurfaceMesh> parts;    // by surface, in place
  std::vector<Mat3> orientations;
  Points nodes;
  std::vector<Triangle> triangles;    // the largest number second: some nodes are second in none
  std::vector<int> surface_of_node, index_of_node, surface_of_triangle;
  std::vector<int> numbers;    // of the nodes, in the scene from which this one was selected

  explicit CoupledScene(const Mat3 &lattice) : cell(lattice) { scene.walls.cell = lattice; }

  void add_cell(double ratio, const SurfaceMesh &mesh)
  {
    Surface surface{SurfaceKind::Cell, ratio};
    if (surface.is_unknown()) {
      surface.shape = static_cast<int>(scene.connectivities.size());
      scene.connectivities.push_back(mesh.triangles);
    }
    add_part(surface, mesh, surface.is_unknown() ? 0 : -1);
  }

  void add_body(const SurfaceMesh &shape, const Mat3 &rotation, const Vec3 &center)
  {
    Surface surface{SurfaceKind::Rigid};
    surface.shape = static_cast<int>(scene.shapes.size());
    scene.shapes.push_back(shape);
    add_part(surface, {(rotation * shape.nodes).colwise() + center, shape.triangles}, 0);
    orientations.back() = rotation;
  }

  void add_wall(const Vec3 &velocity, const SurfaceMesh &mesh)
  {
    WallMesh &walls = scene.walls;
    const auto first = static_cast<int>(walls.nodes.cols());
    walls.nodes.conservativeResize(3, first + mesh.nodes.cols());
    walls.nodes.rightCols(mesh.nodes.cols()) = mesh.nodes;
    for (const Triangle &t : mesh.triangles)
      walls.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    Surface surface{SurfaceKind::Wall};
    surface.velocity = velocity;
    add_part(surface, mesh, first);
  }

  void add_points(const Points &points)
  {
    add_nodes(points);
    surface_of_node.resize(nodes.cols(), -1);
    index_of_node.resize(nodes.cols(), -1);
  }

  // Some of the surfaces, in this order, and all free points.
  CoupledScene select(const std::vector<int> &surfaces) const
  {
    CoupledScene part(cell);
    for (int s : surfaces) {
      const Surface &surface = scene.surfaces[s];
      if (surface.kind == SurfaceKind::Cell)
        part.add_cell(surface.viscosity_ratio, parts[s]);
      else if (surface.kind == SurfaceKind::Wall)
        part.add_wall(surface.velocity, parts[s]);
      else {
        const SurfaceMesh &shape = scene.shapes[surface.shape];
        const Vec3 center = parts[s].nodes.col(0) - orientations[s] * shape.nodes.col(0);
        part.add_body(shape, orientations[s], center);
      }
      list_nodes(s, part.numbers);
    }
    std::vector<int> points;
    list_nodes(-1, points);
    part.add_points(nodes(Eigen::all, points));
    part.numbers.insert(part.numbers.end(), points.begin(), points.end());
    return part;
  }

  void list_nodes(int surface, std::vector<int> &list) const
  {
    for (int i = 0; i < nodes.cols(); i++)
      if (surface_of_node[i] == surface) list.push_back(i);
  }
  std::vector<int> list_nodes(int surface) const
  {
    std::vector<int> list;
    list_nodes(surface, list);
    return list;
  }

  void shift_surface(int s, const Vec3 &shift)
  {
    parts[s].nodes.colwise() += shift;
    for (int i : list_nodes(s))
      nodes.col(i) += shift;
  }

  // Every node for itself inside the cell.
  Points wrapped() const { return wrap_points(nodes, cell); }

  // Does not depend on what is in the cell.
  EwaldParameters choose(double tolerance) const
  {
    EwaldScene points;
    points.cell = cell;
    points.n_sources = points.n_targets = 600.0;
    points.tolerance = tolerance;
    points.layers = Layers::Both;
    return choose_ewald_parameters(points);
  }

 private:
  void add_nodes(const Points &points)
  {
    nodes.conservativeResize(3, nodes.cols() + points.cols());
    nodes.rightCols(points.cols()) = points;
  }

  // first_index: of its nodes; -1: they have none.
  void add_part(const Surface &surface, const SurfaceMesh &mesh, int first_index)
  {
    const auto first = static_cast<int>(nodes.cols()), s = static_cast<int>(parts.size());
    for (Triangle t : mesh.triangles) {
      while (t[1] < t[0] || t[1] < t[2])
        std::rotate(t.begin(), t.begin() + 1, t.end());
      triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
      surface_of_triangle.push_back(s);
    }
    for (int i = 0; i < mesh.nodes.cols(); i++) {
      surface_of_node.push_back(s);
      index_of_node.push_back(first_index < 0 ? -1 : first_index + i);
    }
    scene.surfaces.push_back(surface);
    parts.push_back(mesh);
    orientations.push_back(Mat3::Identity());
    add_nodes(mesh.nodes);
  }
};

// For the test scenes, whose edges are shorter than 1.
constexpr double kLongestEdge = 1.0;

class DistributedSuspension {
 public:
  DistributedSuspension(MPI_Comm comm, const CoupledScene &scene, double tolerance,
                        const SuspensionSettings &settings) :
      scene_(scene),
      owned_(list_owned(comm, scene.nodes, scene.cell)), parameters_(scene.choose(tolerance)),
      ghosts_(comm, scene.wrapped()(Eigen::all, owned_), scene.cell,
              parameters_.cutoff + 2.0 * kLongestEdge),
      suspension_(comm, {parameters_, parameters_}, settings, scene.scene)
  {
    const LocalTriangles local =
        list_local_triangles(owned_, ghosts_, scene.nodes, scene.triangles);
    triangles_ = local.triangles;
    shift_ = local.shift;
    for (int e : local.numbers)
      surface_of_triangle_.push_back(scene.surface_of_triangle[e]);
    FlatElements elements;
    elements.set_geometry(ghosts_.nodes(), triangles_);
    candidates_ = find_near_candidates(elements, ghosts_.nodes());
    for (int i : owned_) {
      surface_of_node_.push_back(scene.surface_of_node[i]);
      index_of_node_.push_back(scene.index_of_node[i]);
    }
    unwrapped_ = scene.nodes(Eigen::all, owned_);
    suspension_.set_cell(scene.cell, Vec3::Zero());
  }

  Configuration configuration() const
  {
    return {ghosts_.nodes(),  ghosts_.n_owned(),   triangles_, surface_of_triangle_,
            surface_of_node_, index_of_node_,      shift_,     unwrapped_,
            candidates_,      scene_.orientations, 0};
  }
  PeriodicGhosts &ghosts() { return ghosts_; }
  HeldCells &held() { return cells_; }

  Evaluation evaluate(const Points &forces, const Conditions &conditions,
                      const CoupledFields &guess = {})
  {
    CoupledFields start = guess;
    if (guess.nodes.cols() > 0) start.nodes = distribute(guess.nodes);
    Evaluation e = suspension_.evaluate(configuration(), distribute(forces), conditions, start,
                                        cells_, ghosts_);
    e.velocity = gather(e.velocity);
    e.traction = gather(e.traction);
    if (scene_.scene.has_unknowns()) e.solution.nodes = gather(e.solution.nodes);
    e.areas = gather(e.areas.transpose().replicate(3, 1)).row(0).transpose();
    return e;
  }

  Points distribute(const Points &values) const { return values(Eigen::all, owned_); }
  Points gather(const Points &part)
  {
    return gather_nodes(part, owned_, scene_.nodes.cols(), ghosts_);
  }

 private:
  const CoupledScene scene_;
  std::vector<int> owned_;
  EwaldParameters parameters_;
  PeriodicGhosts ghosts_;
  Suspension suspension_;
  NearCandidates candidates_;
  std::vector<Triangle> triangles_;
  std::vector<int> surface_of_triangle_, surface_of_node_, index_of_node_;
  Points shift_, unwrapped_;
  HeldCells cells_;
};

// Surfaces of the scenes below, of 42 nodes each, the wall of 36.
enum { kContrast, kRigid, kFree, kWall };

inline Mat3 make_rotation(double angle, const Vec3 &axis)
{
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

inline SurfaceMesh make_stretched_sphere(double radius, const Vec3 &center, int n_nodes = 42)
{
  SurfaceMesh mesh = make_mesh(*make_sphere(radius), n_nodes);
  const Mat3 stretch = Vec3(1.15, 0.95, 0.92).asDiagonal();
  mesh.nodes = (make_rotation(0.7, Vec3(1.0, 2.0, -1.0)) * stretch * mesh.nodes).colwise() + center;
  return mesh;
}

// A cell of another viscosity ratio across two faces of the box, a tilted spheroid, a cell of ratio
// 1, two free points; with a wall if the box is not tilted.
inline CoupledScene make_coupled_scene(const Mat3 &cell, double ratio, int n_nodes = 42,
                                       double wall_edge = 0.9)
{
  CoupledScene scene(cell);
  scene.add_cell(ratio, make_stretched_sphere(1.0, Vec3(4.7, 3.9, 3.9), n_nodes));
  scene.add_body(make_mesh(*make_spheroid(2.0, 1.2), n_nodes),
                 make_rotation(0.6, Vec3(1.0, 0.4, 0.2)), Vec3(1.2, 1.2, 1.8));
  scene.add_cell(1.0, make_stretched_sphere(0.8, Vec3(3.7, 1.3, 1.7), n_nodes));
  if (cell.isDiagonal())
    scene.add_wall(Vec3(0.3, -0.2, 0.0),
                   make_plane_wall({cell, Vec3::Zero()}, Axis::Z, 0.3, wall_edge));
  Points points(3, 2);
  points << Vec3(2.4, 3.0, 3.0), Vec3(0.3, 4.9, 0.9);
  scene.add_points(points);
  return scene;
}

inline Mat3 make_box()
{
  return Vec3(5.2, 5.0, 5.1).asDiagonal();
}

inline Mat3 make_tilted_box()
{
  Mat3 cell = make_box();
  cell(0, 2) = 1.3;
  return cell;
}

// Forces on cells and particles, with net force and torque on each.
inline Points make_forces(const CoupledScene &scene)
{
  Points forces = Points::Zero(3, scene.nodes.cols());
  for (Eigen::Index i = 0; i < forces.cols(); i++) {
    const int s = scene.surface_of_node[i];
    if (s < 0 || !scene.scene.surfaces[s].is_closed()) continue;
    const Vec3 x = scene.nodes.col(i) - scene.parts[s].nodes.rowwise().mean();
    forces.col(i) = 0.1 * Vec3(std::sin(2.0 * x[1]) - 0.3, x[0] * x[2] + 0.2, 0.5 - x[2]);
  }
  return forces;
}

inline double compute_difference(const Points &a, const Points &b)
{
  return (a - b).norm() / b.norm();
}

inline bool is_first_rank()
{
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank == 0;
}

inline SuspensionSettings make_settings(double tolerance, Drive drive = Drive::MeanVelocity)
{
  SuspensionSettings settings;
  settings.viscosity = 1.7;
  settings.drive = drive;
  settings.control = {tolerance, 100, 50, FinalResidual::Computed};
  return settings;
}

}    // namespace biem

#endif
