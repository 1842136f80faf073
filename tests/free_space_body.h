// One rigid body alone in free space, solved densely: oracle of the completed double-layer method.
// Shared by the tests of the core and of the physics.
#ifndef BIEM_TEST_FREE_SPACE_BODY_H
#define BIEM_TEST_FREE_SPACE_BODY_H

#include "biem_body_load.h"
#include "biem_kernel_stokeslet.h"
#include "biem_kernel_stresslet.h"
#include "biem_mesh_shape.h"
#include "biem_operator_body.h"
#include <cmath>

namespace free_space {

using namespace biem;

const Points kNone(3, 0);

inline Eigen::VectorXd flatten(PointsView field)
{
  return field.reshaped();
}

// Single and double layer of densities f and q (or kNone) at the nodes: far rule and near
// corrections, summed directly as LayerOperator does with its periodic sums.
inline Points compute_layers(const SurfaceMesh &mesh, const Points &f, const Points &q)
{
  const Eigen::Index n = mesh.nodes.cols();
  FlatElements elements;
  elements.set_geometry(mesh.nodes, mesh.triangles);
  const Eigen::Index n_points = n + elements.n_elements();
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  elements.add_nodal_areas(areas);
  Points points(3, n_points), normals = Points::Zero(3, n_points);
  Points forces = Points::Zero(3, n_points), strengths = Points::Zero(3, n_points);
  points.leftCols(n) = mesh.nodes;
  elements.compute_interior_points(points.rightCols(n_points - n));
  elements.add_nodal_normals(normals.leftCols(n));
  elements.compute_interior_normals(normals.rightCols(n_points - n));
  if (f.cols()) {
    forces.leftCols(n) = f * (elements.nodal_fraction() * areas).asDiagonal();
    elements.compute_interior_strengths(f, forces.rightCols(n_points - n));
  }
  if (q.cols()) {
    strengths.leftCols(n) = q;
    elements.compute_interior_means(q, strengths.rightCols(n_points - n));
  }
  Points velocity = Points::Zero(3, n);
  for (Eigen::Index i = 0; i < n; i++)
    for (Eigen::Index s = 0; s < n_points; s++) {
      const Vec3 r = mesh.nodes.col(i) - points.col(s);
      velocity.col(i) += compute_stokeslet(r, forces.col(s)) +
                         compute_stresslet(r, strengths.col(s), normals.col(s));
    }
  elements.prepare_near(f, q);
  add_near_corrections(elements, find_near_candidates(elements, mesh.nodes), mesh.nodes, velocity);
  return velocity;
}

// The completed operator of a body, factored.
class Body {
 public:
  explicit Body(const SurfaceMesh &mesh) : mesh_(mesh), operator_(mesh.nodes, mesh.triangles)
  {
    Eigen::MatrixXd matrix = operator_.compute_double_layer();
    BodyOperator::subtract_singularity(operator_.compute_row_sums(), matrix);
    operator_.complete(matrix);
    factors_.compute(matrix);
  }

  const SurfaceGeometry &surface() const { return operator_.modes().surface(0); }

  // The density of the body in the flow u = gradient x, or driven by a force and a torque about its
  // centroid in a fluid at rest.
  Points solve_in_flow(const Mat3 &gradient) const { return solve(gradient * mesh_.nodes); }
  Points solve_driven(const Vec3 &force, const Vec3 &torque, double viscosity) const
  {
    const BodyLoad load(mesh_.nodes, mesh_.triangles);
    const BodyLoad::Coefficients coefficients = load.solve(force, torque);
    Points density(3, mesh_.nodes.cols());
    for (Eigen::Index i = 0; i < density.cols(); i++)
      density.col(i) = load.compute_density(coefficients, i);
    return solve(compute_layers(mesh_, density, kNone) / (8.0 * M_PI * viscosity));
  }

  SurfaceMotion compute_motion(const Points &density) const
  {
    return operator_.compute_motion(density);
  }

  // mu int (psi n + n psi) dA without its trace.
  Mat3 compute_stresslet_moment(const Points &density, double viscosity) const
  {
    Points gradient = Points::Zero(3, mesh_.nodes.cols());    // int n dA of the hat functions
    FlatElements elements;
    elements.set_geometry(mesh_.nodes, mesh_.triangles);
    elements.add_volume_gradient(gradient);
    const Mat3 moment = density * gradient.transpose(), sum = moment + moment.transpose();
    return viscosity * (sum - sum.trace() / 3.0 * Mat3::Identity());
  }

 private:
  Points solve(const Points &velocity) const
  {
    return factors_.solve(flatten(velocity)).reshaped(3, velocity.cols());
  }

  SurfaceMesh mesh_;
  BodyOperator operator_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}    // namespace free_space

#endif
