// Eq. 5 of Zhao et al. 2012 as dense matrices: layers from the direct periodic sums and closed
// forms next to the elements, projections from a dense mass matrix, solved by Eigen. The oracle of
// the coupled system; shares with it the elements and nothing of its operators, modes or solver.
#ifndef BIEM_TESTS_COUPLED_ORACLE_H
#define BIEM_TESTS_COUPLED_ORACLE_H

#include "biem_operator_row_sums.h"
#include "biem_oracle_periodic.h"
#include "coupled_scene.h"

namespace biem {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Velocities (x0 y0 z0 x1 ...) at all nodes of a scene from densities at its nodes, without the
// factors 1/(8 pi mu) and 1/(8 pi). The ranks share the columns.
class DenseLayers {
 public:
  MatrixXd single_layer, double_layer;
  VectorXd areas;
  Points gradient;    // dV/dx

  DenseLayers(MPI_Comm comm, const CoupledScene &scene) :
      scene_(scene), ghosts_(scene.nodes, scene.cell, 3.0 * kLongestEdge)
  {
    set_elements();
    const Eigen::Index n = scene.nodes.cols();
    single_layer = double_layer = MatrixXd::Zero(3 * n, 3 * n);
    int rank, n_ranks, n_columns = 0;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &n_ranks);
    for (Eigen::Index j = 0; j < 3 * n; j++) {
      const int s = scene.surface_of_node[j / 3];
      if (s < 0 || n_columns++ % n_ranks != rank) continue;
      Points unit = Points::Zero(3, ghosts_.nodes().cols());
      unit(j % 3, j / 3) = 1.0;
      ghosts_.forward(unit.data(), 3);
      single_layer.col(j) = compute_single(unit);
      if (scene.scene.surfaces[s].is_closed()) double_layer.col(j) = compute_double(unit);
    }
    for (MatrixXd *matrix : {&single_layer, &double_layer})
      MPI_Allreduce(MPI_IN_PLACE, matrix->data(), static_cast<int>(matrix->size()), MPI_DOUBLE,
                    MPI_SUM, comm);
  }

 private:
  void set_elements()
  {
    const Points &nodes = ghosts_.nodes();
    const Eigen::Index n = scene_.nodes.cols();
    std::vector<double> ids(nodes.cols());
    for (Eigen::Index i = 0; i < n; i++)
      ids[i] = static_cast<double>(i);
    ghosts_.forward(ids.data(), 1);
    std::multimap<int, int> copies;
    for (size_t i = 0; i < ids.size(); i++)
      copies.emplace(static_cast<int>(ids[i]), static_cast<int>(i));
    std::vector<Triangle> triangles;
    for (const Triangle &t : scene_.triangles)
      triangles.push_back(find_corners(t, t[1], copies, nodes));
    elements_.set_geometry(nodes, triangles);
    candidates_ = find_near_candidates(elements_, nodes);
    const Eigen::Index n_elements = elements_.n_elements();
    VectorXd nodal_areas = VectorXd::Zero(nodes.cols());
    Points nodal_gradient = Points::Zero(3, nodes.cols()), nodal_normals = nodal_gradient;
    elements_.add_nodal_areas(nodal_areas);
    elements_.add_volume_gradient(nodal_gradient);
    elements_.add_nodal_normals(nodal_normals);
    ghosts_.reverse_add(nodal_areas.data(), 1);
    ghosts_.reverse_add(nodal_gradient.data(), 3);
    ghosts_.reverse_add(nodal_normals.data(), 3);
    areas = nodal_areas.head(n);
    gradient = nodal_gradient.leftCols(n);
    points_.resize(3, n + n_elements);
    normals_.resize(3, n + n_elements);
    points_.leftCols(n) = scene_.nodes;
    normals_.leftCols(n) = nodal_normals.leftCols(n);
    elements_.compute_interior_points(points_.rightCols(n_elements));
    elements_.compute_interior_normals(normals_.rightCols(n_elements));
  }

  VectorXd compute_single(const Points &density)
  {
    const Eigen::Index n = scene_.nodes.cols();
    Points strengths(3, points_.cols());
    strengths.leftCols(n) = density.leftCols(n) * (elements_.nodal_fraction() * areas).asDiagonal();
    elements_.compute_interior_strengths(density, strengths.rightCols(points_.cols() - n));
    const std::vector<int> active = list_active(strengths);
    const Points far = compute_oracle_single_layer(
        scene_.cell, scene_.nodes, points_(Eigen::all, active), strengths(Eigen::all, active));
    return add_near(density, Points(3, 0), far);
  }

  VectorXd compute_double(const Points &density)
  {
    const Eigen::Index n = scene_.nodes.cols();
    Points strengths(3, points_.cols());
    strengths.leftCols(n) = density.leftCols(n);
    elements_.compute_interior_means(density, strengths.rightCols(points_.cols() - n));
    const std::vector<int> active = list_active(strengths);
    const Points far =
        compute_oracle_double_layer(scene_.cell, scene_.nodes, points_(Eigen::all, active),
                                    strengths(Eigen::all, active), normals_(Eigen::all, active));
    return add_near(Points(3, 0), density, far);
  }

  static std::vector<int> list_active(const Points &strengths)
  {
    std::vector<int> active;
    for (int i = 0; i < strengths.cols(); i++)
      if (!strengths.col(i).isZero(0.0)) active.push_back(i);
    return active;
  }

  VectorXd add_near(const Points &single, const Points &dual, const Points &far)
  {
    Points velocity = Points::Zero(3, ghosts_.nodes().cols());
    elements_.prepare_near(single, dual);
    add_near_corrections(elements_, candidates_, ghosts_.nodes(), velocity);
    ghosts_.reverse_add(velocity.data(), 3);
    const Points sum = velocity.leftCols(far.cols()) + far;
    return sum.reshaped();
  }

  const CoupledScene &scene_;
  PeriodicGhosts ghosts_;
  FlatElements elements_;
  NearCandidates candidates_;
  Points points_, normals_;    // of the far rule, closed surfaces in one piece
};

// The equations as Zhao et al. write them, with row sums of all closed surfaces together, or as the
// package solves them: the flux deflated, and row sums of each surface alone in free space.
enum class Form { Original, Deflated };

struct DenseSolution {
  Points velocity;    // at all nodes
  Points unknowns;
  Vec3 wall_force = Vec3::Zero();
};

// scene: selected from the one of the layers. density: force per area at all its nodes.
class DenseSuspension {
 public:
  DenseSuspension(const DenseLayers &layers, const CoupledScene &scene, Form form) :
      scene_(scene), form_(form), n_(3 * scene.nodes.cols()), map_(list_rows(scene)),
      areas_(layers.areas(scene.numbers)), gradient_(layers.gradient(Eigen::all, scene.numbers)),
      single_(layers.single_layer(map_, map_)), double_(layers.double_layer(map_, map_)),
      rigid_(MatrixXd::Zero(n_, n_)), flux_(rigid_), factors_(VectorXd::Zero(n_))
  {
    for (int s = 0; s < n_surfaces(); s++) {
      if (!surface(s).is_unknown()) continue;
      const std::vector<int> rows = list_rows(s);
      unknowns_.insert(unknowns_.end(), rows.begin(), rows.end());
      if (surface(s).is_closed()) set_projections(s, rows);
    }
    subtract_row_sums();
  }

  DenseSolution solve(const Points &density, double viscosity, const BackgroundFlow &flow) const
  {
    const double scale = 1.0 / (8.0 * M_PI);
    VectorXd known = scale / viscosity * single_ * VectorXd(density.reshaped());
    MatrixXd rest = MatrixXd::Identity(n_, n_) - rigid_;
    if (form_ == Form::Deflated) rest -= flux_;
    MatrixXd v = scale * double_ * factors_.asDiagonal() * rest;
    MatrixXd left = MatrixXd::Zero(n_, n_);
    VectorXd wall_velocity = VectorXd::Zero(n_);
    for (Eigen::Index i = 0; i < n_; i++) {
      const int s = scene_.surface_of_node[i / 3];
      known[i] += flow.velocity(scene_.nodes.col(i / 3))[i % 3];
      if (s < 0) continue;
      if (surface(s).kind == SurfaceKind::Wall) {
        v.col(i) = scale / viscosity * single_.col(i);
        wall_velocity[i] = surface(s).velocity[i % 3];
        continue;
      }
      if (surface(s).kind == SurfaceKind::Rigid) left.row(i) = rigid_.row(i);
      if (surface(s).kind == SurfaceKind::Cell) left(i, i) = 1.0;
      const double weight = surface(s).kind == SurfaceKind::Rigid ? 1.0 : factors_[i];
      if (form_ == Form::Deflated) left.row(i) += weight * flux_.row(i);
    }
    VectorXd x = VectorXd::Zero(n_);
    x(unknowns_) =
        solve_bordered((left - v)(unknowns_, unknowns_), (known - wall_velocity)(unknowns_));
    return finish(x, known + v * x, wall_velocity);
  }

 private:
  int n_surfaces() const { return static_cast<int>(scene_.parts.size()); }
  const Surface &surface(int s) const { return scene_.scene.surfaces[s]; }

  static std::vector<int> list_rows(const CoupledScene &scene)
  {
    std::vector<int> rows;
    for (int i : scene.numbers)
      rows.insert(rows.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    return rows;
  }
  std::vector<int> list_rows(int s) const
  {
    std::vector<int> rows;
    for (int i : scene_.list_nodes(s))
      rows.insert(rows.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    return rows;
  }

  // Rigid motions orthogonal in the consistent mass matrix; the flux along g/A.
  void set_projections(int s, const std::vector<int> &rows)
  {
    const SurfaceMesh &mesh = scene_.parts[s];
    const auto n = static_cast<Eigen::Index>(rows.size());
    MatrixXd mass = MatrixXd::Zero(n, n), modes(n, 6);
    for (const Triangle &t : mesh.triangles) {
      const Vec3 a = mesh.nodes.col(t[0]), b = mesh.nodes.col(t[1]), c = mesh.nodes.col(t[2]);
      const double share = 0.5 * (b - a).cross(c - a).norm() / 12.0;
      for (int p : t)
        for (int q : t)
          mass.block<3, 3>(3 * p, 3 * q) += (p == q ? 2.0 : 1.0) * share * Mat3::Identity();
    }
    const Vec3 center = mesh.nodes.rowwise().mean();
    for (Eigen::Index i = 0; i < n / 3; i++)
      for (int k = 0; k < 3; k++) {
        modes.block<3, 1>(3 * i, k) = Vec3::Unit(k);
        modes.block<3, 1>(3 * i, 3 + k) = Vec3(Vec3::Unit(k)).cross(mesh.nodes.col(i) - center);
      }
    const MatrixXd weighted = modes.transpose() * mass;
    rigid_(rows, rows) = modes * (weighted * modes).inverse() * weighted;
    const VectorXd g = VectorXd(gradient_.reshaped())(rows);
    VectorXd normal = g;
    for (Eigen::Index k = 0; k < n; k++)
      normal[k] /= areas_[rows[k] / 3];
    flux_(rows, rows) = normal * g.transpose() / g.dot(normal);
    for (int i : rows)
      factors_[i] = surface(s).double_layer_factor();
  }

  void subtract_row_sums()
  {
    for (int s = 0; s < n_surfaces(); s++) {
      if (!surface(s).is_unknown() || !surface(s).is_closed()) continue;
      const std::vector<int> nodes = scene_.list_nodes(s);
      const std::vector<Mat3> free =
          compute_free_row_sums(scene_.parts[s].nodes, scene_.parts[s].triangles);
      for (size_t k = 0; k < nodes.size(); k++) {
        const int i = 3 * nodes[k];
        Mat3 sum = Mat3::Zero();
        for (Eigen::Index j = 0; j < n_; j += 3)
          if (factors_[j] != 0.0) sum += double_.block<3, 3>(i, j);
        double_.block<3, 3>(i, i) -= form_ == Form::Deflated ? free[k] : sum;
      }
    }
  }

  // Pressure jumps of the walls are kept out of the solution and of the equations, in the product
  // with the nodal areas.
  VectorXd solve_bordered(const MatrixXd &matrix, const VectorXd &right_hand_side) const
  {
    std::vector<VectorXd> nulls;
    for (int s = 0; s < n_surfaces(); s++) {
      if (surface(s).kind != SurfaceKind::Wall) continue;
      VectorXd null = VectorXd::Zero(n_);
      for (int i : scene_.list_nodes(s))
        null.segment<3>(3 * i) = gradient_.col(i) / areas_[i];
      nulls.push_back(null(unknowns_));
    }
    const auto n = right_hand_side.size(), n_nulls = static_cast<Eigen::Index>(nulls.size());
    MatrixXd bordered = MatrixXd::Zero(n + n_nulls, n + n_nulls);
    bordered.topLeftCorner(n, n) = matrix;
    for (Eigen::Index k = 0; k < n_nulls; k++) {
      bordered.col(n + k).head(n) = nulls[k];
      for (Eigen::Index i = 0; i < n; i++)
        bordered(n + k, i) = areas_[unknowns_[i] / 3] * nulls[k][i];
    }
    VectorXd extended = VectorXd::Zero(n + n_nulls);
    extended.head(n) = right_hand_side;
    return bordered.partialPivLu().solve(extended).head(n);
  }

  DenseSolution finish(const VectorXd &x, const VectorXd &v, const VectorXd &wall_velocity) const
  {
    DenseSolution solution;
    VectorXd velocity = v;
    const VectorXd rigid = rigid_ * x;
    for (int i : unknowns_) {
      const SurfaceKind kind = surface(scene_.surface_of_node[i / 3]).kind;
      velocity[i] = kind == SurfaceKind::Cell    ? x[i]
                    : kind == SurfaceKind::Rigid ? rigid[i]
                                                 : wall_velocity[i];
      if (kind == SurfaceKind::Wall) solution.wall_force[i % 3] += areas_[i / 3] * x[i];
    }
    solution.velocity = velocity.reshaped(3, n_ / 3);
    solution.unknowns = x.reshaped(3, n_ / 3);
    return solution;
  }

  const CoupledScene &scene_;
  Form form_;
  Eigen::Index n_;
  std::vector<int> map_, unknowns_;    // rows of the layers; rows with unknowns
  VectorXd areas_;
  Points gradient_;
  MatrixXd single_, double_, rigid_, flux_;
  VectorXd factors_;
};

// One Richardson step from F / A towards M f = F, of the nodes of one cell.
inline Points improve_density(const SurfaceMesh &mesh, const Points &forces, const Points &density,
                              const VectorXd &areas)
{
  Points rest = forces;
  for (const Triangle &t : mesh.triangles) {
    const Mat3 x = mesh.nodes(Eigen::all, t), f = density(Eigen::all, t);
    const double area = 0.5 * (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
    for (int v = 0; v < 3; v++)
      rest.col(t[v]) -= area / 12.0 * (f.col(v) + f.rowwise().sum());
  }
  return density + rest * areas.cwiseInverse().asDiagonal();
}

// The force densities of nodal forces: over the nodal area on cells, of a driven body on particles.
inline Points make_densities(const CoupledScene &scene, const DenseLayers &layers,
                             const Points &forces, Traction traction = Traction::Lumped)
{
  Points density = Points::Zero(3, scene.nodes.cols());
  for (int s = 0; s < static_cast<int>(scene.parts.size()); s++) {
    const std::vector<int> nodes = scene.list_nodes(s);
    const SurfaceMesh &mesh = scene.parts[s];
    const Points &x = mesh.nodes;
    VectorXd areas(x.cols());
    for (size_t k = 0; k < nodes.size(); k++)
      areas[k] = layers.areas[scene.numbers[nodes[k]]];
    if (scene.scene.surfaces[s].kind == SurfaceKind::Cell) {
      const Points given = forces(Eigen::all, nodes);
      const Points lumped = given * areas.cwiseInverse().asDiagonal();
      density(Eigen::all, nodes) =
          traction == Traction::Lumped ? lumped : improve_density(mesh, given, lumped, areas);
    }
    if (scene.scene.surfaces[s].kind != SurfaceKind::Rigid) continue;
    const BodyLoad load(x, mesh.triangles);    // as it lies in space
    const Vec3 center = x * areas / areas.sum();
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (size_t k = 0; k < nodes.size(); k++) {
      force += forces.col(nodes[k]);
      torque += (x.col(k) - center).cross(Vec3(forces.col(nodes[k])));
    }
    const BodyLoad::Coefficients coefficients = load.solve(force, torque);
    for (size_t k = 0; k < nodes.size(); k++)
      density.col(nodes[k]) = load.compute_density(coefficients, k);
  }
  return density;
}

}    // namespace biem

#endif
