// Moments of polyhedra with known values, and the cell shape that follows from them.
#include "biem_error.h"
#include "biem_mesh_moments.h"
#include "biem_mesh_shape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace biem;

MeshMoments compute_moments(const Points &nodes, const std::vector<Triangle> &triangles)
{
  MeshMoments moments;
  for (const Triangle &t : triangles)
    add_triangle_moments(nodes.col(t[0]), nodes.col(t[1]), nodes.col(t[2]), moments);
  return moments;
}

// Rectangular block with edges 2a, 2b, 2c about the origin.
SurfaceMesh make_block(double a, double b, double c)
{
  SurfaceMesh mesh;
  mesh.nodes.resize(3, 8);
  for (int i = 0; i < 8; i++)
    mesh.nodes.col(i) << (i & 1 ? a : -a), (i & 2 ? b : -b), (i & 4 ? c : -c);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// An affine image of an icosphere: icosahedral symmetry makes the ratios of its axes exact.
SurfaceMesh make_ellipsoid(double a, double b, double c)
{
  SurfaceMesh mesh = make_icosphere(6);
  mesh.nodes = Vec3(a, b, c).asDiagonal() * mesh.nodes;
  return mesh;
}

// Turns x toward z by the angle, in degrees.
Mat3 make_tilt(double angle)
{
  return Eigen::AngleAxisd(-angle * M_PI / 180.0, Vec3::UnitY()).toRotationMatrix();
}

TEST(Moments, BlockHasItsKnownIntegrals)
{
  const double a = 0.5, b = 0.8, c = 1.1;
  const SurfaceMesh block = make_block(a, b, c);
  const MeshMoments m = compute_moments(block.nodes, block.triangles);
  const double volume = 8.0 * a * b * c, area = 8.0 * (a * b + b * c + c * a);
  EXPECT_NEAR(m.volume, volume, 1e-14);
  EXPECT_NEAR(m.area, area, 1e-14);
  const double size[3] = {a, b, c};
  for (int i = 0; i < 3; i++) {
    const double own = size[i], other1 = size[(i + 1) % 3], other2 = size[(i + 2) % 3];
    EXPECT_NEAR(m.volume_first[i], 0.0, 1e-14);
    EXPECT_NEAR(m.area_first[i], 0.0, 1e-14);
    EXPECT_NEAR(m.volume_second[i], volume * own * own / 3.0, 1e-14);
    // two faces at x = +-own, four faces that extend along x
    EXPECT_NEAR(m.area_second[i],
                8.0 * other1 * other2 * own * own + 8.0 * own * (other1 + other2) * own * own / 3.0,
                1e-13);
    EXPECT_NEAR(m.volume_second[3 + i], 0.0, 1e-14);
    EXPECT_NEAR(m.area_second[3 + i], 0.0, 1e-14);
  }
}

TEST(Moments, BlockShapeIsThatOfTheEquivalentEllipsoid)
{
  const double a = 1.1, b = 0.8, c = 0.5, angle = 33.0;
  SurfaceMesh block = make_block(a, b, c);
  block.nodes = (make_tilt(angle) * block.nodes).colwise() + Vec3(3.0, -2.0, 1.0);
  const CellShape shape = compute_cell_shape(compute_moments(block.nodes, block.triangles));
  EXPECT_LT((shape.centroid - Vec3(3.0, -2.0, 1.0)).norm(), 1e-13);
  EXPECT_LT((shape.semi_axes - std::sqrt(5.0 / 3.0) * Vec3(a, b, c)).norm(), 1e-12);
  EXPECT_NEAR(shape.deformation, (a - c) / (a + c), 1e-12);
  EXPECT_NEAR(shape.inclination_in_plane, angle, 1e-10);
  EXPECT_NEAR(shape.ellipsoid_angle, angle, 1e-10);
  EXPECT_NEAR(shape.inclination, angle, 1e-10);
}

// Long axis, short axis in the shear plane and vorticity axis of a capsule at Ca = 0.15, C = 1 in
// the literature's convention, with the deformation and angle that belong to them.
TEST(Moments, CapsuleAxesGiveItsDeformationAndAngle)
{
  SurfaceMesh capsule = make_ellipsoid(1.2312, 1.0671, 0.76116);
  capsule.nodes = make_tilt(0.180823 * 180.0) * capsule.nodes;
  const CellShape shape = compute_cell_shape(compute_moments(capsule.nodes, capsule.triangles));
  EXPECT_NEAR(shape.deformation, 0.235923, 2e-5);
  EXPECT_NEAR(shape.ellipsoid_angle, 0.180823 * 180.0, 1e-9);
  EXPECT_NEAR(shape.semi_axes[0] / shape.semi_axes[2], 1.2312 / 0.76116, 1e-12);
  EXPECT_NEAR(shape.semi_axes[0], 1.2312, 0.01);
}

TEST(Moments, NegativeAngleAndWrapAtNinetyDegrees)
{
  for (const double angle : {-89.0, -45.0, -1.0, 0.0, 60.0, 89.0}) {
    SurfaceMesh cell = make_ellipsoid(1.5, 1.2, 0.5);
    cell.nodes = make_tilt(angle) * cell.nodes;
    const CellShape shape = compute_cell_shape(compute_moments(cell.nodes, cell.triangles));
    EXPECT_NEAR(shape.inclination_in_plane, angle, 1e-9);
    EXPECT_NEAR(shape.inclination, std::fabs(angle), 1e-6);
  }
}

// The longest axis along the vorticity direction: the 3D angle is 90, the in-plane one is not.
TEST(Moments, VorticityAxisIsSeenInThreeDimensionsOnly)
{
  SurfaceMesh cell = make_ellipsoid(1.2, 1.3, 0.5);
  cell.nodes = make_tilt(20.0) * cell.nodes;
  const CellShape shape = compute_cell_shape(compute_moments(cell.nodes, cell.triangles));
  EXPECT_NEAR(shape.inclination, 90.0, 1e-5);
  EXPECT_NEAR(std::fabs(shape.axis.y()), 1.0, 1e-12);
  EXPECT_NEAR(shape.inclination_in_plane, 20.0, 1e-9);
  EXPECT_NEAR(shape.deformation, 0.7 / 1.7, 1e-12);
  EXPECT_NEAR(shape.semi_axes[0] / shape.semi_axes[1], 1.3 / 1.2, 1e-12);
}

TEST(Moments, PartialSumsAddUp)
{
  const SurfaceMesh cell = make_ellipsoid(1.2, 1.3, 0.5);
  const size_t half = cell.triangles.size() / 3;
  const std::vector<Triangle> first(cell.triangles.begin(), cell.triangles.begin() + half);
  const std::vector<Triangle> rest(cell.triangles.begin() + half, cell.triangles.end());
  const MeshMoments whole = compute_moments(cell.nodes, cell.triangles);
  const MeshMoments part1 = compute_moments(cell.nodes, first);
  const MeshMoments part2 = compute_moments(cell.nodes, rest);
  const double *w = &whole.volume, *p1 = &part1.volume, *p2 = &part2.volume;
  for (int i = 0; i < MeshMoments::n_values; i++) EXPECT_NEAR(w[i], p1[i] + p2[i], 1e-13);
}

TEST(Moments, RedCellHasTheVolumeAndAreaOfTheDiscocyte)
{
  const SurfaceMesh cell = make_mesh(*make_red_cell(), 2562);
  const CellShape shape = compute_cell_shape(compute_moments(cell.nodes, cell.triangles));
  const MeshMoments moments = compute_moments(cell.nodes, cell.triangles);
  EXPECT_NEAR(moments.volume, 4.0 * M_PI / 3.0, 1e-12);
  EXPECT_NEAR(moments.area, 16.845, 0.003 * 16.845);
  EXPECT_NEAR(shape.semi_axes[0], shape.semi_axes[1], 5e-3);
}

TEST(Moments, InsideOutSurfaceIsRefused)
{
  SurfaceMesh block = make_block(1.0, 1.0, 1.0);
  for (Triangle &t : block.triangles) std::swap(t[0], t[1]);
  EXPECT_THROW(compute_cell_shape(compute_moments(block.nodes, block.triangles)), Error);
}

}    // namespace
