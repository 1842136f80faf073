// The force density of a driven rigid body: its total force and torque, and its form on spheres.
#include "biem_body_load.h"
#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include <gtest/gtest.h>

using namespace biem;

namespace {

struct Total {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();    // about the centroid of the surface
};

// By the integrals of products of linear functions.
Total compute_total(const SurfaceMesh &mesh, const BodyLoad &load, const Vec3 &force,
                    const Vec3 &torque)
{
  const BodyLoad::Coefficients c = load.solve(force, torque);
  FlatElements elements;
  elements.set_geometry(mesh.nodes, mesh.triangles);
  const Eigen::Index n = mesh.nodes.cols();
  Points density(3, n), product = Points::Zero(3, n);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; i++)
    density.col(i) = load.compute_density(c, i);
  elements.add_nodal_areas(areas);
  elements.add_mass_product(density, product);
  const Vec3 centroid = mesh.nodes * areas / areas.sum();
  Total total;
  for (Eigen::Index i = 0; i < n; i++) {
    total.force += product.col(i);
    total.torque += Vec3(mesh.nodes.col(i) - centroid).cross(Vec3(product.col(i)));
  }
  return total;
}

// A spheroid with a dent on one side, so that nothing is symmetric, away from the origin.
SurfaceMesh make_lopsided()
{
  SurfaceMesh mesh = make_mesh(*make_spheroid(2.0, 1.2), 162);
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); i++)
    mesh.nodes.col(i) *= 1.0 + 0.2 * mesh.nodes(0, i) + 0.1 * mesh.nodes(2, i);
  mesh.nodes.colwise() += Vec3(0.4, -3.0, 1.0);
  return mesh;
}

}    // namespace

TEST(BodyLoad, HasTheForceAndTheTorqueThatAreGiven)
{
  const Vec3 force(0.3, -1.2, 0.7), torque(-0.5, 0.4, 1.1);
  for (const SurfaceMesh &mesh :
       {make_mesh(*make_sphere(1.3), 162), make_lopsided(), make_mesh(*make_red_cell(), 162)}) {
    const Total total = compute_total(mesh, BodyLoad(mesh.nodes, mesh.triangles), force, torque);
    EXPECT_LT((total.force - force).norm(), 1e-12);
    EXPECT_LT((total.torque - torque).norm(), 1e-12);
  }
}

TEST(BodyLoad, IsUniformAndRotationalOnASphere)
{
  const SurfaceMesh mesh = make_mesh(*make_sphere(1.3), 642);
  const BodyLoad load(mesh.nodes, mesh.triangles);
  const Vec3 force(0.3, -1.2, 0.7), torque(-0.5, 0.4, 1.1);
  const double area = 4.0 * M_PI * 1.3 * 1.3;
  const BodyLoad::Coefficients pulled = load.solve(force, Vec3::Zero());
  const BodyLoad::Coefficients turned = load.solve(Vec3::Zero(), torque);
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); i++) {
    EXPECT_LT((load.compute_density(pulled, i) * area - force).norm(), 0.02 * force.norm());
    const Vec3 exact = 1.5 / (area * 1.3 * 1.3) * torque.cross(Vec3(mesh.nodes.col(i)));
    EXPECT_LT((load.compute_density(turned, i) - exact).norm(), 0.02 * torque.norm() / area);
  }
}

// On a red cell the tangent planes at the dimples pass close to the center, but not beyond it; a
// bowl has planes that do, and then the density is not weighted.
TEST(BodyLoad, IsNotWeightedWhereTangentPlanesPassTheCenter)
{
  SurfaceMesh bowl = make_mesh(*make_sphere(1.0), 642);
  for (Eigen::Index i = 0; i < bowl.nodes.cols(); i++)
    if (bowl.nodes(2, i) > 0.0) bowl.nodes(2, i) *= -0.8;
  const BodyLoad load(bowl.nodes, bowl.triangles);
  const BodyLoad::Coefficients c = load.solve(Vec3::UnitX(), Vec3::Zero());
  EXPECT_LT((load.compute_density({Vec3::UnitX(), Vec3::Zero()}, 0) - Vec3::UnitX()).norm(), 1e-15);
  EXPECT_GT(c.a[0], 0.0);
}
