// Surfaces that cross: near misses and near hits, any periodic image, any width of the bins.
#include "biem_mesh_crossings.h"
#include "biem_mesh_icosphere.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace biem {
namespace {

using Triangles = std::vector<SurfaceTriangle>;

const double length = 6.0;

MeshLattice make_lattice(double tilt = 0.0)
{
  Mat3 vectors = length * Mat3::Identity();
  vectors(0, 2) = tilt;
  return MeshLattice(vectors);
}

void add_surface(const SurfaceMesh &mesh, const Vec3 &move, int surface, bool is_sheet,
                 Triangles &triangles)
{
  for (const Triangle &t : mesh.triangles) {
    SurfaceTriangle record{};
    record.surface = surface;
    record.is_sheet = is_sheet;
    for (int k = 0; k < 3; k++) {
      const Vec3 x = mesh.nodes.col(t[k]) + move;
      std::copy_n(x.data(), 3, record.corners + 3 * k);
    }
    triangles.push_back(record);
  }
}

void add_ball(const Vec3 &center, int surface, Triangles &triangles, double radius = 1.0,
              int frequency = 4)
{
  SurfaceMesh mesh = make_icosphere(frequency);
  mesh.nodes *= radius;
  add_surface(mesh, center, surface, false, triangles);
}

std::vector<Crossing> find_all(const MeshLattice &lattice, const Triangles &triangles,
                               double width = 0.3)
{
  const CrossingBins bins(lattice, width);
  Triangles sorted;
  for (SurfaceTriangle t : triangles)
    bins.for_each_bin(t, [&](std::int64_t bin, std::uint64_t occupant) {
      EXPECT_LT(bin, bins.n_bins());
      t.bin = bin;
      t.occupant = occupant;
      sorted.push_back(t);
    });
  BinOccupants occupants;
  for (const SurfaceTriangle &t : sorted) occupants.add(t.bin, t.occupant);
  Triangles shared;
  for (const SurfaceTriangle &t : sorted)
    if (occupants.find(t.bin) == kSeveral) shared.push_back(t);
  return find_crossings(lattice, shared);
}

std::optional<Crossing> find(const MeshLattice &lattice, const Triangles &triangles,
                             double width = 0.3)
{
  const std::vector<Crossing> all = find_all(lattice, triangles, width);
  return all.empty() ? std::nullopt : std::optional(all[0]);
}

TEST(MeshCrossings, GapsAndOverlapsOfAThousandth)
{
  for (double gap : {1e-3, 1e-10, -1e-3}) {
    const MeshLattice lattice = make_lattice();
    Triangles triangles;
    add_ball(Vec3(1.0, 2.0, 5.9), 3, triangles);
    const double height = 2.0 * make_icosphere(4).nodes.row(2).maxCoeff();
    add_ball(Vec3(1.001, 2.0, 5.9 + height + gap - length), 7, triangles);
    const auto found = find(lattice, triangles);
    ASSERT_EQ(found.has_value(), gap < 0.0) << gap;
    if (!found) continue;
    EXPECT_EQ(found->first, 3);
    EXPECT_EQ(found->second, 7);
    const Vec3 where(found->where);
    EXPECT_LT(lattice.wrap_difference(where - Vec3(1.0, 2.0, 0.9)).norm(), 0.4);
  }
}

TEST(MeshCrossings, BinsOfAnyWidthFindTheSame)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-length, 2.0 * length);
  int n_crossing = 0;
  for (int k = 0; k < 60; k++) {
    const MeshLattice lattice = make_lattice(k % 3 - 1.0);
    Triangles triangles;
    for (int s = 0; s < 5; s++)
      add_ball(Vec3(uniform(random), uniform(random), uniform(random)), s, triangles,
               0.5 + 0.1 * s, s == 0 ? 1 : 3);
    const std::vector<Crossing> expected = find_all(lattice, triangles, 100.0);
    n_crossing += !expected.empty();
    for (double width : {0.15, 0.4, 2.5}) {
      const std::vector<Crossing> found = find_all(lattice, triangles, width);
      ASSERT_EQ(found.size(), expected.size());
      for (size_t c = 0; c < found.size(); c++) {
        EXPECT_EQ(found[c].first, expected[c].first);
        EXPECT_EQ(found[c].second, expected[c].second);
      }
    }
  }
  EXPECT_GT(n_crossing, 10);
  EXPECT_LT(n_crossing, 50);
}

TEST(MeshCrossings, OneExactlyOnTopOfTheOther)
{
  Triangles triangles;
  add_ball(Vec3(1.0, 2.0, 3.0), 0, triangles);
  add_ball(Vec3(1.0, 2.0, 3.0), 1, triangles);
  EXPECT_TRUE(find(make_lattice(), triangles));
}

TEST(MeshCrossings, OwnImages)
{
  for (double half : {2.99, 3.01}) {
    SurfaceMesh mesh = make_icosphere(8);
    mesh.nodes.row(0) *= half / mesh.nodes.row(0).maxCoeff();
    Triangles triangles;
    add_surface(mesh, Vec3(3.0, 3.0, 3.0), 4, false, triangles);
    const auto found = find(make_lattice(), triangles);
    ASSERT_EQ(found.has_value(), half > 3.0);
    if (found) {
      EXPECT_EQ(found->first, 4);
      EXPECT_EQ(found->second, 4);
    }
  }
}

TEST(MeshCrossings, AllPairsOnceAndAscending)
{
  for (double width : {0.2, 1.0, 9.0}) {
    Triangles triangles;
    const double x[] = {4.0, 1.0, 5.5, 2.5};    // 1 and 3, 3 and 0, 0 and 2, 2 and the image of 1
    for (int s = 0; s < 4; s++) add_ball(Vec3(x[s], 3.0, 3.0), s, triangles);
    const std::vector<Crossing> found = find_all(make_lattice(), triangles, width);
    ASSERT_EQ(found.size(), 4u);
    const int pairs[4][2] = {{0, 2}, {0, 3}, {1, 2}, {1, 3}};
    for (int k = 0; k < 4; k++) {
      EXPECT_EQ(found[k].first, pairs[k][0]);
      EXPECT_EQ(found[k].second, pairs[k][1]);
    }
  }
}

TEST(MeshCrossings, OneSurfaceAcrossTheBoundaryIsAloneInItsBins)
{
  Triangles triangles;
  add_ball(Vec3(5.9, 6.1, -0.2), 2, triangles);
  const CrossingBins bins(make_lattice(1.0), 0.2);
  BinOccupants occupants;
  for (const SurfaceTriangle &t : triangles)
    bins.for_each_bin(t, [&](std::int64_t bin, std::uint64_t occupant) {
      occupants.add(bin, occupant);
    });
  int n_bins = 0;
  occupants.for_each([&](std::int64_t, std::uint64_t occupant) {
    n_bins++;
    EXPECT_NE(occupant, kSeveral);
  });
  EXPECT_GT(n_bins, 100);
}

TEST(MeshCrossings, SheetsMayMeetEachOtherButNothingElse)
{
  Triangles triangles;
  add_surface(make_icosphere(3), Vec3(1.0, 1.0, 1.0), 0, true, triangles);
  add_surface(make_icosphere(3), Vec3(1.5, 1.0, 1.0), 1, true, triangles);
  EXPECT_FALSE(find(make_lattice(), triangles));
  add_ball(Vec3(2.0, 1.0, 1.0), 2, triangles);
  EXPECT_TRUE(find(make_lattice(), triangles));
}

TEST(MeshCrossings, SolidAngleTellsInsideFromOutside)
{
  Triangles triangles;
  add_ball(Vec3(1.0, 2.0, 3.0), 0, triangles);
  auto sum = [&](const Vec3 &point) {
    double angle = 0.0;
    for (const SurfaceTriangle &t : triangles) angle += compute_solid_angle(t, point);
    return angle;
  };
  EXPECT_NEAR(sum(Vec3(1.1, 2.2, 3.5)), 4.0 * M_PI, 1e-12);
  EXPECT_NEAR(sum(Vec3(1.0, 2.9, 3.0)), 4.0 * M_PI, 1e-12);
  EXPECT_NEAR(sum(Vec3(1.0, 3.1, 3.0)), 0.0, 1e-12);
}

}    // namespace
}    // namespace biem
