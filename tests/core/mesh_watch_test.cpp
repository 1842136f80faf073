// Measures of the watchdog: known strains and folds, collapsed triangles, what is not a number.
#include "biem_mesh_icosphere.h"
#include "biem_mesh_topology.h"
#include "biem_mesh_watch.h"

#include <gtest/gtest.h>

#include <limits>

namespace biem {
namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();

TriangleMeasure measure(const Mat3 &corners)
{
  return measure_triangle(corners.col(0).data(), corners.col(1).data(), corners.col(2).data());
}

Mat3 make_triangle()
{
  Mat3 corners;    // in columns
  corners << 0.3, 1.1, 0.2, -0.4, 0.1, 0.9, 2.0, 2.3, 1.7;
  return corners;
}

double fold(const Mat3 &abc, const Vec3 &d)
{
  const double *a = abc.col(0).data(), *b = abc.col(1).data(), *c = abc.col(2).data();
  const double cosine = compute_fold_cosine(a, b, c, d.data());
  for (double limit : {-0.99, -0.9, -0.5, -1e-3})
    if (std::abs(cosine - limit) > 1e-9)
      EXPECT_EQ(is_folded(a, b, c, d.data(), limit), cosine < limit) << cosine << " " << limit;
  return cosine;
}

// d on the other side of the edge b-c, in a plane turned from that of (a, b, c) about the edge.
Vec3 turn(const Mat3 &abc, double angle)
{
  const Vec3 b = abc.col(1), axis = (abc.col(2) - b).normalized();
  const Vec3 arm = abc.col(2) - abc.col(0);    // of the parallelogram a, b, d, c
  return b + Eigen::AngleAxisd(angle, axis) * arm;
}

TEST(MeshWatch, StretchAlongAnEdge)
{
  Mat3 reference, now;
  reference << 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
  const Mat3 rotation = Eigen::AngleAxisd(1.1, Vec3(1.0, 2.0, 3.0).normalized()).matrix();
  for (double stretch : {0.2, 0.8, 1.0, 3.0}) {
    now = rotation * Vec3(stretch, 1.0, 1.0).asDiagonal() * reference;
    now.colwise() += Vec3(5.0, -1.0, 2.0);
    const TriangleStrain strain = compute_strain(measure(reference), measure(now));
    EXPECT_NEAR(strain.longest_edge, std::max(1.0, stretch * stretch), 1e-12);
    EXPECT_NEAR(strain.shortest_edge, std::min(1.0, stretch * stretch), 1e-12);
    EXPECT_NEAR(strain.area, stretch * stretch, 1e-12);
    const double largest = std::pow(std::max(stretch, 1.0 / stretch), 2);
    EXPECT_NEAR(strain.compute_edge_stretch(), largest, 1e-11);
    EXPECT_NEAR(strain.compute_area_stretch(), largest, 1e-11);
  }
}

TEST(MeshWatch, ShearKeepsTheArea)
{
  Mat3 shear = Mat3::Identity(), reference;
  reference << 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
  shear(0, 1) = 1.5;
  const TriangleStrain strain =
      compute_strain(measure(reference), measure(Mat3(shear * reference)));
  EXPECT_NEAR(strain.compute_area_stretch(), 1.0, 1e-12);
  EXPECT_NEAR(strain.longest_edge, 1.0 + 1.5 * 1.5, 1e-12);
  EXPECT_NEAR(strain.shortest_edge, (0.5 * 0.5 + 1.0) / 5.0, 1e-12);
}

TEST(MeshWatch, FoldAngleIsTheAngleOfTheNormals)
{
  const Mat3 abc = make_triangle();
  for (double degrees : {0.0, 10.0, 89.0, 91.0, 150.0, 160.0, 179.0})
    for (double sign : {-1.0, 1.0})
      EXPECT_NEAR(fold(abc, turn(abc, sign * degrees * M_PI / 180.0)),
                  std::cos(degrees * M_PI / 180.0), 1e-12);
}

TEST(MeshWatch, FoldDoesNotDependOnTheOrderOfTheHinge)
{
  const Mat3 abc = make_triangle();
  const Vec3 d = turn(abc, 2.9);
  Mat3 turned;
  turned << d, abc.col(2), abc.col(1);
  EXPECT_NEAR(fold(turned, abc.col(0)), fold(abc, d), 1e-14);
  turned << abc.col(0), abc.col(2), abc.col(1);
  EXPECT_NEAR(fold(turned, d), fold(abc, d), 1e-14);
}

// A node pushed through the opposite edge: its triangle is inverted, in the surface's own plane.
TEST(MeshWatch, OneInvertedTriangleOfASphere)
{
  for (int frequency : {2, 4, 8}) {
    SurfaceMesh mesh = make_icosphere(frequency);
    const auto smallest = [&] {
      double cosine = 1.0;
      for (const Hinge &h : make_hinges(mesh.triangles))
        cosine = std::min(cosine, compute_fold_cosine(mesh.nodes.col(h.a).data(),
                                                      mesh.nodes.col(h.b).data(),
                                                      mesh.nodes.col(h.c).data(),
                                                      mesh.nodes.col(h.d).data()));
      return cosine;
    };
    EXPECT_GT(smallest(), frequency == 2 ? 0.7 : 0.9);
    const Triangle t = mesh.triangles[5];
    const Vec3 middle = 0.5 * (mesh.nodes.col(t[1]) + mesh.nodes.col(t[2]));
    mesh.nodes.col(t[0]) += 1.4 * (middle - mesh.nodes.col(t[0]));
    if (frequency > 2) EXPECT_LT(smallest(), WatchLimits().fold_cosine);
  }
}

TEST(MeshWatch, CollapsedTriangles)
{
  EXPECT_FALSE(measure(make_triangle()).is_collapsed());
  Mat3 corners;
  corners << 0.0, 1.0, 0.5, 0.0, 0.0, std::sqrt(0.75), 0.0, 0.0, 0.0;
  EXPECT_NEAR(measure(corners).compute_quality(), 1.0, 1e-12);
  for (double scale : {1e-6, 1.0, 1e6}) {
    corners(1, 2) = 1e-2;
    EXPECT_FALSE(measure(Mat3(scale * corners)).is_collapsed());
    corners(1, 2) = 1e-4;
    EXPECT_TRUE(measure(Mat3(scale * corners)).is_collapsed());
  }
  EXPECT_TRUE(measure(Mat3::Zero()).is_collapsed());
}

TEST(MeshWatch, NotANumberIsCollapsedAndNotFolded)
{
  for (double bad : {nan_value, std::numeric_limits<double>::infinity()})
    for (int k = 0; k < 3; k++) {
      Mat3 corners = make_triangle();
      corners(k, k) = bad;
      EXPECT_TRUE(measure(corners).is_collapsed());
      EXPECT_FALSE(is_folded(corners.col(0).data(), corners.col(1).data(), corners.col(2).data(),
                             Vec3(0.0, 0.0, 0.0).data(), -0.9));
    }
}

}    // namespace
}    // namespace biem
