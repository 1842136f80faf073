// Walls among bodies: what is a closed body, what is in the way of a new surface, and packings
// beside walls, which have two sides.
#include "biem_mesh_clearance.h"
#include "biem_mesh_lattice.h"
#include "biem_mesh_obstacles.h"
#include "biem_mesh_topology.h"
#include "biem_mesh_wall.h"
#include "error_messages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace biem {
namespace {

const double length = 8.0;

WallBox make_box() { return {length * Mat3::Identity(), Vec3::Zero()}; }

SurfaceMesh make_ball(const Vec3 &center, double radius)
{
  SurfaceMesh mesh = make_mesh(*make_sphere(radius), 162);
  mesh.nodes.colwise() += center;
  return mesh;
}

PackingObstacles to_obstacles(const SurfaceMesh &mesh) { return {mesh.nodes, mesh.triangles}; }

std::string wall_message(const SurfaceMesh &wall, const PackingObstacles &existing)
{
  return message_of([&] { check_wall_clearance(make_box().lattice, wall, existing); });
}

std::string body_message(const SurfaceMesh &body, double gap, const PackingObstacles &existing)
{
  return message_of([&] { check_body_clearance(make_box().lattice, body, gap, existing); });
}

int count(const std::vector<char> &flags)
{
  return static_cast<int>(std::count(flags.begin(), flags.end(), 1));
}

TEST(MeshClearance, OnlySpheresAreClosedBodies)
{
  const WallBox box = make_box();
  const SurfaceMesh ball = make_icosphere(2);
  const SurfaceMesh plane = make_plane_wall(box, Axis::Z, 1.0, 1.0);
  const SurfaceMesh duct = make_duct_wall(box, {Axis::X, 1.0, 2.0}, 1.0);
  const SurfaceMesh tube = make_tube_wall(box, {Axis::X, 1.0, 2.0, 2.0}, 1.0);
  for (const SurfaceMesh &wall : {plane, duct, tube}) {
    const int n_nodes = static_cast<int>(wall.nodes.cols());
    EXPECT_EQ(count(find_closed_bodies(wall.triangles, n_nodes)), 0);
    // the ball is recognised beside the wall
    std::vector<Triangle> both = wall.triangles;
    for (const Triangle &t : ball.triangles)
      both.push_back({t[0] + n_nodes, t[1] + n_nodes, t[2] + n_nodes});
    const auto flags = find_closed_bodies(both, n_nodes + static_cast<int>(ball.nodes.cols()));
    EXPECT_EQ(count(flags), static_cast<int>(ball.triangles.size()));
    EXPECT_EQ(flags.back(), 1);
  }
  std::vector<Triangle> torn = ball.triangles;
  torn.pop_back();
  EXPECT_EQ(count(find_closed_bodies(torn, static_cast<int>(ball.nodes.cols()))), 0);
}

TEST(MeshClearance, ASheetHasTwoSidesAndNoInside)
{
  const SurfaceMesh wall = make_plane_wall(make_box(), Axis::Z, 1.0, 1.0);
  const MeshObstacles sheet(MeshLattice(make_box().lattice), wall.nodes, wall.triangles, 1.0);
  const Vec3 above(2.3, 3.1, 1.4), below(2.3, 3.1, 0.7), up(0.1, 0.2, 0.7);
  EXPECT_NEAR(sheet.evaluate(above, Vec3::Zero(), 1.0).value, 0.4, 1e-13);
  EXPECT_NEAR(sheet.evaluate(below, Vec3::Zero(), 1.0).value, 0.3, 1e-13);
  EXPECT_LT((sheet.evaluate(below, Vec3::Zero(), 1.0).normal + Vec3::UnitZ()).norm(), 1e-13);
  EXPECT_FALSE(sheet.is_inside(below));
  // a body whose center is below and whose point is above must go down
  const SignedDistance crossed = sheet.evaluate(above, up, 1.0);
  EXPECT_NEAR(crossed.value, -0.4, 1e-13);
  EXPECT_LT((crossed.normal + Vec3::UnitZ()).norm(), 1e-13);
  EXPECT_TRUE(sheet.intersects(above, up));
  EXPECT_FALSE(sheet.intersects(above, -up));
  // through the periodic boundary
  EXPECT_TRUE(sheet.intersects(Vec3(7.9, 0.1, 9.2), Vec3(0.0, 0.0, 0.5)));
}

TEST(MeshClearance, WallsKeepOffWhatIsThere)
{
  const WallBox box = make_box();
  const SurfaceMesh wall = make_plane_wall(box, Axis::Z, 4.0, 1.3);
  auto message = [&](const SurfaceMesh &mesh) { return wall_message(wall, to_obstacles(mesh)); };
  EXPECT_EQ(message(make_ball(Vec3(4, 4, 5.2), 1.0)), "");
  EXPECT_EQ(message(make_ball(Vec3(4, 4, 2.8), 1.0)), "");
  EXPECT_TRUE(contains(message(make_ball(Vec3(4, 4, 4.7), 1.0)), "it crosses a surface"));
  // a ball smaller than the mesh of the wall, between its nodes
  EXPECT_TRUE(contains(message(make_ball(Vec3(4.6, 4.3, 4.05), 0.2)), "it crosses a surface"));
  EXPECT_TRUE(contains(message(make_ball(Vec3(0, 0, 4.1), 1.5)), "it crosses a surface"));
  const SurfaceMesh plate = make_ball(Vec3(4, 4, 4), 0.5);
  EXPECT_TRUE(contains(wall_message(plate, to_obstacles(make_ball(Vec3(4, 4, 4), 1.5))),
                       "inside a closed surface"));
  EXPECT_EQ(wall_message(make_ball(Vec3(4, 4, 4), 1.5), to_obstacles(plate)), "");
  PackingObstacles points;
  points.nodes = Vec3(1.234, 2.5, 4.1);
  EXPECT_EQ(wall_message(wall, points), "");
  points.nodes(2, 0) = 4.0;
  EXPECT_TRUE(contains(wall_message(wall, points), "an existing atom lies on it"));
  // two sheets that cross without common nodes, and with nodes that coincide
  EXPECT_TRUE(contains(message(make_plane_wall(box, Axis::X, 4.1, 1.2)), "must be one duct"));
  EXPECT_TRUE(contains(message(make_plane_wall(box, Axis::X, 0.0, 1.0)), "share the nodes"));
  EXPECT_EQ(message(make_plane_wall(box, Axis::Z, 4.1, 1.3)), "");
}

TEST(MeshClearance, BodiesKeepTheGap)
{
  const SurfaceMesh body = make_ball(Vec3(4, 4, 4), 1.0);
  auto message = [&](const SurfaceMesh &mesh, double gap) {
    return body_message(body, gap, to_obstacles(mesh));
  };
  for (double gap : {0.0, 0.1, 0.3}) {
    const double near = 2.02 + gap, far = 2.05 + gap;    // the meshes stand out by 1.2 %
    EXPECT_EQ(message(make_ball(Vec3(4 + far, 4, 4), 1.0), gap), "");
    if (gap > 0.0)
      EXPECT_TRUE(contains(message(make_ball(Vec3(4 + near - 0.03, 4, 4), 1.0), gap), "does not"));
    const double z = 4.0 - 1.0 - gap;
    EXPECT_EQ(message(make_plane_wall(make_box(), Axis::Z, z - 0.03, 0.5), gap), "");
    EXPECT_NE(message(make_plane_wall(make_box(), Axis::Z, z + 0.03, 0.5), gap), "");
    EXPECT_NE(message(make_plane_wall(make_box(), Axis::Z, 4.1, 3.9), gap), "");
  }
  EXPECT_NE(message(make_ball(Vec3(4, 4, 4), 3.0), 0.1), "");
  EXPECT_NE(message(make_ball(Vec3(4, 4, 4), 0.3), 0.1), "");
  EXPECT_TRUE(contains(body_message(make_ball(Vec3(0, 0, 0), 4.1), 0.0, PackingObstacles()),
                       "to its own periodic image"));
  EXPECT_EQ(body_message(make_ball(Vec3(0, 0, 0), 3.9), 0.0, PackingObstacles()), "");
}

TEST(MeshClearance, RandomPackingFillsBothSidesOfASheetWithoutCrossingIt)
{
  const double z = 3.0, gap = 0.05;
  const SurfaceMesh wall = make_plane_wall(make_box(), Axis::Z, z, 0.8);
  const auto shape = make_red_cell();
  const PackingRequest request = {shape.get(), 162, 22, gap, 3, make_box().lattice,
                                  PackingRotation::free, Mat3::Identity()};
  const auto bodies = make_random_packing(request, to_obstacles(wall));
  const SurfaceMesh mesh = make_mesh(*shape, 162);
  double lowest = length, highest = 0.0;    // heights over the sheet; the next one is at 8
  for (const RigidPlacement &body : bodies) {
    double base = body.center[2] - z;
    base -= length * std::floor(base / length);
    const Eigen::RowVectorXd heights = (body.rotation * mesh.nodes).row(2).array() + base;
    lowest = std::min(lowest, heights.minCoeff());
    highest = std::max(highest, heights.maxCoeff());
  }
  EXPECT_GT(lowest, gap);
  EXPECT_LT(highest, length - gap);
  EXPECT_LT(lowest, 0.8);    // cells are near on both sides
  EXPECT_GT(highest, length - 0.8);
}

TEST(MeshClearance, AVesselWithNormalsIntoTheFluidIsFilledOnTheInside)
{
  SurfaceMesh vessel = make_ball(Vec3(4, 4, 4), 3.5);
  for (Triangle &t : vessel.triangles) std::swap(t[1], t[2]);
  const auto shape = make_red_cell();
  const PackingRequest request = {shape.get(), 42, 6, 0.05, 5, make_box().lattice,
                                  PackingRotation::free, Mat3::Identity()};
  const SurfaceMesh mesh = make_mesh(*shape, 42);
  for (const RigidPlacement &body : make_random_packing(request, to_obstacles(vessel))) {
    const Vec3 shift = body.center - length * Vec3(std::floor(body.center[0] / length),
                                                   std::floor(body.center[1] / length),
                                                   std::floor(body.center[2] / length));
    const Points nodes = (body.rotation * mesh.nodes).colwise() + (shift - Vec3(4, 4, 4));
    EXPECT_LT(nodes.colwise().norm().maxCoeff(), 3.5);
  }
}

TEST(MeshClearance, ABodyOfRevolutionIsNotPlacedAcrossAWall)
{
  const SurfaceMesh wall = make_plane_wall(make_box(), Axis::Z, 4.0, 3.0);    // coarse
  const auto shape = make_red_cell();
  PackingRequest request = {shape.get(), 162, 1, 0.0, 1, make_box().lattice,
                            PackingRotation::fixed, Mat3::Identity()};
  auto message = [&](double z) {
    return message_of([&] {
      check_placement(request, {Vec3(4.7, 4.4, z), Mat3::Identity()}, to_obstacles(wall));
    });
  };
  EXPECT_EQ(message(4.6), "");
  EXPECT_EQ(message(3.4), "");
  for (double z : {4.0, 4.1, 3.8, 4.2}) EXPECT_TRUE(contains(message(z), "does not keep")) << z;
}

}    // namespace
}    // namespace biem
