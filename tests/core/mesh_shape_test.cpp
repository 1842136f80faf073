// Icosphere and shapes: counts, orientation, symmetry, exact volume, known areas, triangle quality.
#include "biem_error.h"
#include "biem_mesh_icosphere.h"
#include "biem_mesh_shape.h"
#include "biem_mesh_topology.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

namespace biem {
namespace {

const double pi = 3.14159265358979323846;

double compute_area(const SurfaceMesh &mesh)
{
  double area = 0.0;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.nodes.col(t[0]), b = mesh.nodes.col(t[1]), c = mesh.nodes.col(t[2]);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

TEST(Icosphere, CountsRadiusAndOrientation)
{
  for (int f : {1, 2, 3, 4, 8, 10}) {
    const SurfaceMesh mesh = make_icosphere(f);
    ASSERT_EQ(mesh.nodes.cols(), 10 * f * f + 2);
    ASSERT_EQ(static_cast<int>(mesh.triangles.size()), 20 * f * f);
    EXPECT_LT((mesh.nodes.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
    for (const Triangle &t : mesh.triangles) {
      const Vec3 a = mesh.nodes.col(t[0]), b = mesh.nodes.col(t[1]), c = mesh.nodes.col(t[2]);
      EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0.0);
    }
    EXPECT_EQ(compute_icosphere_frequency(10 * f * f + 2), f);
  }
}

TEST(Icosphere, ImpossibleCountNamesTheNeighbors)
{
  for (int n : {643, 600}) {
    try {
      compute_icosphere_frequency(n);
      FAIL() << n << " nodes were accepted";
    } catch (const Error &error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(std::to_string(n)), std::string::npos) << text;
      EXPECT_NE(text.find("642"), std::string::npos) << text;
    }
  }
  for (int n : {-5, 0, 2, 11, 13}) EXPECT_THROW(compute_icosphere_frequency(n), Error);
  EXPECT_THROW(make_icosphere(0), Error);
}

// The mesh is a copy of its own mirror image in each coordinate plane, so that a body is not
// driven to one side by its triangulation.
TEST(Icosphere, IsSymmetricUnderReflections)
{
  const SurfaceMesh mesh = make_icosphere(5);
  for (int axis = 0; axis < 3; axis++)
    for (int i = 0; i < mesh.nodes.cols(); i++) {
      Vec3 mirrored = mesh.nodes.col(i);
      mirrored[axis] = -mirrored[axis];
      EXPECT_LT((mesh.nodes.colwise() - mirrored).colwise().norm().minCoeff(), 1e-14);
    }
}

struct ShapeCase {
  std::unique_ptr<Shape> shape;
  double volume, area;               // exact
  double edge_ratio, angle_degree;   // worst allowed triangle at 642 nodes
};

std::vector<ShapeCase> make_shape_cases()
{
  // oblate spheroid: A = 2 pi a^2 (1 + (1 - e^2)/e atanh e)
  const double a = 0.4965, c = 0.124, e = std::sqrt(1.0 - c * c / (a * a));
  const double spheroid_area = 2.0 * pi * a * a * (1.0 + (1.0 - e * e) / e * std::atanh(e));
  const double flat = a - c;
  const double disc_area = 2.0 * pi * flat * flat + 2.0 * pi * (pi * c * flat + 2.0 * c * c);
  const double disc_volume = 2.0 * pi * flat * flat * c + pi * c * c * pi * flat +
      4.0 / 3.0 * pi * c * c * c;
  std::vector<ShapeCase> cases;
  cases.push_back({make_red_cell(), 4.0 / 3.0 * pi, 16.845, 2.3, 31.0});
  cases.push_back({make_red_cell(2.0), 32.0 / 3.0 * pi, 4.0 * 16.845, 2.3, 31.0});
  cases.push_back({make_sphere(0.401), 4.0 / 3.0 * pi * std::pow(0.401, 3),
                   4.0 * pi * 0.401 * 0.401, 1.2, 53.0});
  cases.push_back({make_spheroid(2.0 * a, 2.0 * c), 4.0 / 3.0 * pi * a * a * c, spheroid_area,
                   1.8, 36.0});
  cases.push_back({make_rounded_disc(2.0 * a, 2.0 * c), disc_volume, disc_area, 1.7, 40.0});
  return cases;
}

TEST(Shape, EnclosedVolumeOfTheMeshIsExact)
{
  for (const ShapeCase &c : make_shape_cases())
    for (int n_nodes : {42, 162, 642, 1002}) {
      const SurfaceMesh mesh = make_mesh(*c.shape, n_nodes);
      ASSERT_EQ(mesh.nodes.cols(), n_nodes);
      EXPECT_NO_THROW(check_closed_oriented(mesh.nodes, mesh.triangles)) << c.shape->describe();
      EXPECT_NEAR(compute_enclosed_volume(mesh.nodes, mesh.triangles) / c.volume, 1.0, 1e-12)
          << c.shape->describe();
      EXPECT_LT(mesh.nodes.rowwise().mean().norm(), 1e-12);
    }
}

// The area is not adjusted, so it tells whether the shape itself is right; second order in the
// mesh size, i.e. a quarter of the error at four times the nodes.
TEST(Shape, AreaConvergesToTheExactOneAtSecondOrder)
{
  for (const ShapeCase &c : make_shape_cases()) {
    const double coarse = compute_area(make_mesh(*c.shape, 642)) / c.area - 1.0;
    const double fine = compute_area(make_mesh(*c.shape, 2562)) / c.area - 1.0;
    EXPECT_LT(std::abs(coarse), 4e-3) << c.shape->describe();
    EXPECT_LT(std::abs(fine), 0.3 * std::abs(coarse) + 5e-5) << c.shape->describe();
  }
}

TEST(Shape, MeshNodesLieOnTheScaledMeridian)
{
  for (const ShapeCase &c : make_shape_cases()) {
    const SurfaceMesh sphere = make_icosphere(4);
    const SurfaceMesh mesh = make_mesh(*c.shape, 162);
    const double scale = compute_volume_scale(*c.shape, 162);
    EXPECT_GT(scale, 1.0);
    for (int i = 0; i < 162; i++) {
      const MeridianPoint p = c.shape->compute_meridian_point(std::acos(sphere.nodes(2, i)));
      EXPECT_NEAR(std::hypot(mesh.nodes(0, i), mesh.nodes(1, i)), scale * p.rho, 1e-7);
      EXPECT_NEAR(mesh.nodes(2, i), scale * p.z, 1e-7);
    }
  }
}

TEST(Shape, TrianglesAreWellShaped)
{
  for (const ShapeCase &c : make_shape_cases()) {
    const MeshQuality quality = compute_mesh_quality(make_mesh(*c.shape, 642));
    const double edge_ratio = quality.longest_edge / quality.shortest_edge;
    const double angle = quality.smallest_angle * 180.0 / pi;
    EXPECT_LT(edge_ratio, c.edge_ratio) << c.shape->describe();
    EXPECT_GT(angle, c.angle_degree) << c.shape->describe();
    RecordProperty("edge_ratio " + c.shape->describe(), std::to_string(edge_ratio));
    RecordProperty("smallest_angle " + c.shape->describe(), std::to_string(angle));
  }
}

TEST(Shape, RedCellHasItsDimple)
{
  const auto cell = make_red_cell();
  const MeridianPoint pole = cell->compute_meridian_point(0.0);
  const MeridianPoint equator = cell->compute_meridian_point(0.5 * pi);
  // minimum thickness 0.81 um and diameter 7.82 um with a = 2.82 um
  EXPECT_NEAR(2.0 * pole.z * 2.82, 0.81, 0.005);
  EXPECT_NEAR(2.0 * equator.rho * 2.82, 7.82, 0.005);
  double largest = 0.0;
  for (int i = 0; i <= 100; i++)
    largest = std::max(largest, cell->compute_meridian_point(0.005 * pi * i).z);
  EXPECT_GT(largest, 2.0 * pole.z);
}

TEST(Shape, ImpossibleSizesAreRefused)
{
  EXPECT_THROW(make_red_cell(0.0), Error);
  EXPECT_THROW(make_sphere(-1.0), Error);
  EXPECT_THROW(make_sphere(std::nan("")), Error);
  EXPECT_THROW(make_spheroid(1.0, 1.1), Error);
  EXPECT_THROW(make_spheroid(1.0, 0.0), Error);
  EXPECT_THROW(make_rounded_disc(-1.0, 0.2), Error);
  EXPECT_THROW(make_mesh(*make_sphere(1.0), 100), Error);
}

}    // namespace
}    // namespace biem
