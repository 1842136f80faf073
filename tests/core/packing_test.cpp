// Random packing: the gap between flat meshes, measured by brute force, periodic images, obstacles,
// reproducibility, isotropy, and the messages when there is no room.
#include "biem_error.h"
#include "biem_mesh_packing.h"
#include "biem_mesh_signed_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace biem {
namespace {

// Distance from a point to a triangle: the foot of the perpendicular where it falls inside, else
// the nearest point of the three edges. Written for clarity, independently of the library.
double compute_triangle_distance(const Vec3 &p, const Vec3 *corner)
{
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  double distance = 1e300;
  bool is_above = true;
  for (int k = 0; k < 3; k++) {
    const Vec3 a = corner[k], edge = corner[(k + 1) % 3] - a;
    if (normal.dot(edge.cross(p - a)) < 0.0) is_above = false;
    const double t = std::min(1.0, std::max(0.0, (p - a).dot(edge) / edge.squaredNorm()));
    distance = std::min(distance, (p - a - t * edge).norm());
  }
  return is_above ? std::abs(normal.dot(p - corner[0])) : distance;
}

// Solid angle of a closed surface / 4 pi (van Oosterom & Strackee 1983): 1 inside, 0 outside.
double compute_winding(const Vec3 &p, const Points &nodes, const std::vector<Triangle> &triangles)
{
  double sum = 0.0;
  for (const Triangle &t : triangles) {
    const Vec3 a = nodes.col(t[0]) - p, b = nodes.col(t[1]) - p, c = nodes.col(t[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::acos(-1.0));
}

// The smallest distance of nodes of one surface from triangles of another; -1 if a node is inside.
double compute_gap(const Points &nodes, const Points &other, const std::vector<Triangle> &triangles)
{
  const Vec3 center = other.rowwise().mean();
  const double radius = (other.colwise() - center).colwise().norm().maxCoeff();
  double gap = 1e300;
  for (int i = 0; i < nodes.cols(); i++) {
    const Vec3 p = nodes.col(i);
    if ((p - center).norm() - radius > 0.5) continue;
    if (compute_winding(p, other, triangles) > 0.5) return -1.0;
    for (const Triangle &t : triangles) {
      const Vec3 corner[3] = {other.col(t[0]), other.col(t[1]), other.col(t[2])};
      gap = std::min(gap, compute_triangle_distance(p, corner));
    }
  }
  return gap;
}

Points place(const SurfaceMesh &mesh, const RigidPlacement &placement)
{
  return (placement.rotation * mesh.nodes).colwise() + placement.center;
}

// Over all pairs and their images in the 27 cells around, the images of a body itself included.
double compute_smallest_gap(const PackingRequest &request, const std::vector<RigidPlacement> &all)
{
  const SurfaceMesh mesh = make_mesh(*request.shape, request.n_nodes);
  const double radius = mesh.nodes.colwise().norm().maxCoeff();
  double gap = 1e300;
  for (std::size_t i = 0; i < all.size(); i++)
    for (std::size_t j = 0; j < all.size(); j++) {
      const Vec3 s = request.lattice.inverse() * (all[i].center - all[j].center);
      const Vec3 home(std::round(s[0]), std::round(s[1]), std::round(s[2]));
      for (int image = 0; image < 27; image++) {
        const Vec3 n = home + Vec3(image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1);
        RigidPlacement other = all[j];
        other.center += request.lattice * n;
        const double distance = (other.center - all[i].center).norm();
        if (distance > 2.0 * radius + 0.5 || (i == j && distance < 1e-9)) continue;
        gap = std::min(gap, compute_gap(place(mesh, all[i]), place(mesh, other), mesh.triangles));
      }
    }
  return gap;
}

PackingRequest make_request(const Shape &shape, int n_bodies, double fraction, double tilt = 0.0)
{
  PackingRequest request;
  request.shape = &shape;
  request.n_nodes = 162;
  request.n_bodies = n_bodies;
  request.minimum_gap = 0.05;
  request.seed = 4711;
  request.lattice = Mat3::Identity() * std::cbrt(n_bodies * shape.compute_volume() / fraction);
  request.lattice(0, 2) = tilt * request.lattice(0, 0);
  request.rotation = PackingRotation::free;
  request.orientation = Mat3::Identity();
  return request;
}

TEST(SignedDistanceTable, AgreesWithASphere)
{
  const auto sphere = make_sphere(0.7);
  const SignedDistanceTable table(*sphere, 1.01, 0.4);
  for (const Vec3 &p : {Vec3(0.3, 0.5, 0.6), Vec3(-0.2, 0.1, -0.8), Vec3(0.9, 0.0, 0.1)}) {
    const SignedDistance distance = table.evaluate(p);
    EXPECT_NEAR(distance.value, p.norm() - 0.707, table.accuracy());
    EXPECT_LT((distance.normal - p.normalized()).norm(), 0.01);
  }
  EXPECT_EQ(table.evaluate(Vec3(5.0, 0.0, 0.0)).value, 0.4);
}

TEST(SignedDistanceTable, VanishesOnTheShapesAndHasUnitSlope)
{
  for (const auto &shape : {make_red_cell(), make_spheroid(0.993, 0.248),
                            make_rounded_disc(0.993, 0.248)}) {
    const SignedDistanceTable table(*shape, 1.0, 0.2);
    for (int i = 1; i < 60; i++) {
      const MeridianPoint p = shape->compute_meridian_point(std::acos(-1.0) * i / 60);
      const Vec3 point(0.6 * p.rho, -0.8 * p.rho, p.z);
      const SignedDistance there = table.evaluate(point);
      EXPECT_NEAR(there.value, 0.0, table.accuracy()) << shape->describe();
      const Vec3 outside = point + 0.05 * there.normal.normalized();
      EXPECT_NEAR(table.evaluate(outside).value, 0.05, 2e-3) << shape->describe();
    }
  }
}

TEST(RandomPacking, RedCellsAtHematocrit03KeepTheGap)
{
  const auto cell = make_red_cell();
  for (double tilt : {0.0, 0.5}) {
    const PackingRequest request = make_request(*cell, 20, 0.3, tilt);
    const auto bodies = make_random_packing(request, {});
    ASSERT_EQ(bodies.size(), 20u);
    EXPECT_GE(compute_smallest_gap(request, bodies), request.minimum_gap);
  }
}

TEST(RandomPacking, RedCellsAtHematocrit045KeepTheGap)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 54, 0.45);
  request.minimum_gap = 0.02;
  const auto bodies = make_random_packing(request, {});
  ASSERT_EQ(bodies.size(), 54u);
  EXPECT_GE(compute_smallest_gap(request, bodies), request.minimum_gap);
}

TEST(RandomPacking, PlateletsAndSpheresKeepTheGap)
{
  for (const auto &shape : {make_sphere(0.4), make_spheroid(0.993, 0.248),
                            make_rounded_disc(0.993, 0.248)}) {
    PackingRequest request = make_request(*shape, 20, 0.2, -0.5);
    request.minimum_gap = 0.01;
    EXPECT_GE(compute_smallest_gap(request, make_random_packing(request, {})), 0.01)
        << shape->describe();
  }
}

// A box not much larger than the cell: its own images are its neighbors.
TEST(RandomPacking, KeepsTheGapToItsOwnImages)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 1, 0.25);
  request.lattice = Vec3(1.6, 3.2, 3.2).asDiagonal();
  EXPECT_GE(compute_smallest_gap(request, make_random_packing(request, {})), 0.05);
}

TEST(RandomPacking, SeedDecides)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 8, 0.2);
  const auto one = make_random_packing(request, {}), same = make_random_packing(request, {});
  request.seed++;
  const auto other = make_random_packing(request, {});
  for (int i = 0; i < 8; i++) {
    EXPECT_EQ((one[i].center - same[i].center).norm(), 0.0);
    EXPECT_EQ((one[i].rotation - same[i].rotation).norm(), 0.0);
    EXPECT_GT((one[i].center - other[i].center).norm(), 1e-3);
  }
}

TEST(RandomPacking, FixedOrientationIsKept)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 12, 0.25);
  request.rotation = PackingRotation::fixed;
  request.orientation = compute_rotation_to_axis(Vec3(1.0, 2.0, -1.0), 0.3);
  const auto bodies = make_random_packing(request, {});
  for (const RigidPlacement &body : bodies)
    EXPECT_EQ((body.rotation - request.orientation).norm(), 0.0);
  EXPECT_GE(compute_smallest_gap(request, bodies), request.minimum_gap);
}

// Dilute bodies must have no preferred direction and no preferred place: <a a> = I/3 and, by
// octants of the box, equal numbers; 5 standard deviations of 400 independent bodies.
TEST(RandomPacking, DilutePackingIsIsotropicAndUniform)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 400, 0.05);
  Mat3 second_moment = Mat3::Zero();
  Vec3 upper_half = Vec3::Zero();
  for (const RigidPlacement &body : make_random_packing(request, {})) {
    const Vec3 axis = body.rotation.col(2);
    second_moment += axis * axis.transpose() / 400.0;
    const Vec3 s = request.lattice.inverse() * body.center;
    for (int k = 0; k < 3; k++) upper_half[k] += s[k] - std::floor(s[k]) > 0.5 ? 1.0 : 0.0;
  }
  EXPECT_LT((second_moment - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(), 5.0 * 0.3 / 20.0);
  EXPECT_LT((upper_half - Vec3::Constant(200.0)).cwiseAbs().maxCoeff(), 5.0 * 10.0);
}

// Obstacles: a first packing, deformed (stretched) so that no shape but the mesh describes it.
TEST(RandomPacking, RespectsObstacles)
{
  const auto cell = make_red_cell();
  const auto platelet = make_rounded_disc(0.993, 0.248);
  const PackingRequest cells = make_request(*cell, 8, 0.25, 0.3);
  const SurfaceMesh mesh = make_mesh(*cell, 162);
  PackingObstacles obstacles;
  std::vector<Points> surfaces;
  for (const RigidPlacement &body : make_random_packing(cells, {})) {
    Points nodes = place(mesh, body);
    nodes.row(0) = (nodes.row(0).array() - body.center[0]) * 1.01 + body.center[0];
    surfaces.push_back(nodes);
    const int first = static_cast<int>(obstacles.nodes.cols());
    obstacles.nodes.conservativeResize(3, first + nodes.cols());
    obstacles.nodes.rightCols(nodes.cols()) = nodes;
    for (const Triangle &t : mesh.triangles)
      obstacles.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  // nodes may come wrapped into the box, each by itself
  for (int i = 0; i < obstacles.nodes.cols(); i++) {
    const Vec3 s = cells.lattice.inverse() * obstacles.nodes.col(i);
    const Vec3 cell_of_node(std::floor(s[0]), std::floor(s[1]), std::floor(s[2]));
    obstacles.nodes.col(i) -= cells.lattice * cell_of_node;
  }

  PackingRequest request = make_request(*platelet, 30, 0.25);
  request.lattice = cells.lattice;
  request.minimum_gap = 0.03;
  const auto bodies = make_random_packing(request, obstacles);
  EXPECT_GE(compute_smallest_gap(request, bodies), 0.03);
  const SurfaceMesh small = make_mesh(*platelet, 162);
  double gap = 1e300;
  for (const RigidPlacement &body : bodies)
    for (const Points &surface : surfaces)
      for (int image = 0; image < 125; image++) {
        const Vec3 n(image % 5 - 2, image / 5 % 5 - 2, image / 25 - 2);
        RigidPlacement moved = body;
        moved.center += cells.lattice * n;
        if ((moved.center - surface.rowwise().mean()).norm() > 2.5) continue;
        const Points nodes = place(small, moved);
        gap = std::min(gap, compute_gap(nodes, surface, mesh.triangles));
        gap = std::min(gap, compute_gap(surface, nodes, small.triangles));
      }
  EXPECT_GE(gap, 0.03);
  EXPECT_LT(gap, 0.3);
}

TEST(RandomPacking, PointsAreObstaclesToo)
{
  const auto cell = make_red_cell();
  PackingRequest request = make_request(*cell, 4, 0.1);
  PackingObstacles obstacles;
  obstacles.nodes = Points::Random(3, 60) * request.lattice(0, 0);
  const auto bodies = make_random_packing(request, obstacles);
  const SurfaceMesh mesh = make_mesh(*cell, 162);
  for (const RigidPlacement &body : bodies)
    for (int k = 0; k < obstacles.nodes.cols(); k++)
      for (int image = 0; image < 125; image++) {
        const Vec3 n(image % 5 - 2, image / 5 % 5 - 2, image / 25 - 2);
        Points point = obstacles.nodes.col(k) + request.lattice * n;
        if ((Vec3(point) - body.center).norm() > 2.0) continue;
        EXPECT_GE(compute_gap(point, place(mesh, body), mesh.triangles), 0.05);
      }
}

std::string message_of(const PackingRequest &request, const PackingObstacles &obstacles)
{
  try {
    make_random_packing(request, obstacles);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

TEST(RandomPacking, NoRoomSaysHowManyWerePlaced)
{
  const auto cell = make_red_cell();
  const std::string dense = message_of(make_request(*cell, 6, 0.7), {});
  EXPECT_NE(dense.find("cannot place 6 bodies"), std::string::npos) << dense;
  EXPECT_NE(dense.find("keep the gap (volume fraction"), std::string::npos) << dense;
  const std::string denser = message_of(make_request(*cell, 6, 0.8), {});
  EXPECT_NE(denser.find("cannot fit"), std::string::npos) << denser;
  EXPECT_NE(message_of(make_request(*cell, 0, 0.1), {}).find("number of bodies is 0"),
            std::string::npos);
  PackingRequest request = make_request(*cell, 2, 0.1);
  request.minimum_gap = -0.1;
  EXPECT_NE(message_of(request, {}).find("minimum gap is -0.1"), std::string::npos);
}

TEST(CheckPlacement, RefusesOverlapWithObstaclesAndOwnImages)
{
  const auto sphere = make_sphere(1.0);
  const SurfaceMesh mesh = make_mesh(*sphere, 162);
  PackingRequest request = make_request(*sphere, 1, 0.1);
  request.lattice = Mat3::Identity() * 8.0;
  const PackingObstacles obstacles = {mesh.nodes, mesh.triangles};
  auto place_at = [&](double x) {
    check_placement(request, {Vec3(x, 0.0, 0.0), Mat3::Identity()}, obstacles);
  };
  EXPECT_NO_THROW(place_at(2.1));
  EXPECT_NO_THROW(place_at(-10.1));
  EXPECT_THROW(place_at(2.04), Error);
  EXPECT_THROW(place_at(8.0), Error);
  EXPECT_THROW(place_at(6.0), Error);
  request.lattice = Mat3::Identity() * 2.03;
  EXPECT_THROW(check_placement(request, {Vec3::Zero(), Mat3::Identity()}, {}), Error);
  request.lattice = Mat3::Identity() * 2.1;
  EXPECT_NO_THROW(check_placement(request, {Vec3::Zero(), Mat3::Identity()}, {}));
}

// A small body wholly inside a large one touches none of its triangles.
TEST(CheckPlacement, RefusesToBeSwallowed)
{
  const auto large = make_sphere(3.0), small = make_sphere(0.3);
  const SurfaceMesh mesh = make_mesh(*large, 162);
  PackingRequest request = make_request(*small, 1, 0.1);
  request.lattice = Mat3::Identity() * 10.0;
  EXPECT_THROW(check_placement(request, {Vec3(0.2, 0.1, 0.0), Mat3::Identity()},
                               {mesh.nodes, mesh.triangles}),
               Error);
}

TEST(RotationToAxis, TakesZToTheAxis)
{
  for (const Vec3 &axis : {Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.0, 2.0), Vec3(0.0, 0.0, -1.0),
                           Vec3(-0.3, 0.4, 0.2)}) {
    const Mat3 rotation = compute_rotation_to_axis(axis, 0.7);
    EXPECT_LT((rotation.col(2) - axis.normalized()).norm(), 1e-14);
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-14);
    EXPECT_LT((rotation * rotation.transpose() - Mat3::Identity()).norm(), 1e-14);
  }
}

}    // namespace
}    // namespace biem
