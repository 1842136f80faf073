// Connectivity of surface meshes: hinges, the checks with their messages, even middle nodes.
#include "biem_error.h"
#include "biem_mesh_icosphere.h"
#include "biem_mesh_shape.h"
#include "biem_mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace biem {
namespace {

std::string message_of(const std::vector<Triangle> &triangles, int n_nodes)
{
  try {
    check_closed_oriented(triangles, n_nodes);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

// The three nodes up to rotation: begins with the smallest.
Triangle normalize(Triangle t)
{
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

std::multiset<Triangle> normalize(const std::vector<Triangle> &triangles)
{
  std::multiset<Triangle> set;
  for (const Triangle &t : triangles) set.insert(normalize(t));
  return set;
}

TEST(MeshTopology, HingesAreTheEdgesWithTheirTwoTriangles)
{
  for (int f : {1, 2, 3, 8}) {
    const SurfaceMesh mesh = make_icosphere(f);
    const auto hinges = make_hinges(mesh.triangles);
    ASSERT_EQ(static_cast<int>(hinges.size()), 30 * f * f);
    const auto all = normalize(mesh.triangles);
    std::set<std::pair<int, int>> edges;
    for (const Hinge &h : hinges) {
      EXPECT_EQ(all.count(normalize(Triangle{h.a, h.b, h.c})), 1u);
      EXPECT_EQ(all.count(normalize(Triangle{h.d, h.c, h.b})), 1u);
      edges.insert({std::min(h.b, h.c), std::max(h.b, h.c)});
    }
    EXPECT_EQ(edges.size(), hinges.size());
  }
}

TEST(MeshTopology, BalancedMeshIsTheSameSurfaceWithTwoTrianglesAndThreeHingesPerNode)
{
  for (int f : {1, 2, 5, 8, 16}) {
    const SurfaceMesh mesh = make_icosphere(f);
    const int n_nodes = 10 * f * f + 2;
    auto triangles = mesh.triangles;
    auto hinges = make_hinges(triangles);
    const MiddleNodeLoad load = balance_middle_nodes(triangles, hinges, n_nodes);
    std::vector<int> n_triangles(n_nodes, 0), n_hinges(n_nodes, 0);
    for (const Triangle &t : triangles) n_triangles[t[1]]++;
    for (const Hinge &h : hinges) n_hinges[h.b]++;
    EXPECT_EQ(load.max_triangles, *std::max_element(n_triangles.begin(), n_triangles.end()));
    EXPECT_EQ(load.max_hinges, *std::max_element(n_hinges.begin(), n_hinges.end()));
    EXPECT_LE(load.max_triangles, 2);
    EXPECT_LE(load.max_hinges, 3);

    EXPECT_EQ(normalize(triangles), normalize(mesh.triangles));
    const auto all = normalize(triangles);
    for (const Hinge &h : hinges) {
      EXPECT_EQ(all.count(normalize(Triangle{h.a, h.b, h.c})), 1u);
      EXPECT_EQ(all.count(normalize(Triangle{h.d, h.c, h.b})), 1u);
    }
  }
}

TEST(MeshTopology, IcospheresPassTheCheck)
{
  for (int f : {1, 2, 7}) {
    const SurfaceMesh mesh = make_icosphere(f);
    EXPECT_NO_THROW(check_closed_oriented(mesh.nodes, mesh.triangles));
  }
}

TEST(MeshTopology, MissingTriangleIsAnOpenEdge)
{
  auto triangles = make_icosphere(2).triangles;
  triangles.pop_back();
  EXPECT_TRUE(contains(message_of(triangles, 42), "open at the edge between nodes"));
}

TEST(MeshTopology, DoubledTriangleIsAnEdgeWithThree)
{
  auto triangles = make_icosphere(2).triangles;
  triangles.push_back(triangles[5]);
  EXPECT_TRUE(contains(message_of(triangles, 42), "has 3 triangles instead of two"));
}

TEST(MeshTopology, ReversedTriangleIsNamed)
{
  auto triangles = make_icosphere(2).triangles;
  std::swap(triangles[7][0], triangles[7][1]);
  const std::string message = message_of(triangles, 42);
  EXPECT_TRUE(contains(message, "oriented against each other"));
}

TEST(MeshTopology, InsideOutSurfaceHasNegativeVolume)
{
  const SurfaceMesh mesh = make_icosphere(2);
  auto triangles = mesh.triangles;
  for (Triangle &t : triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(message_of(triangles, 42), "");
  EXPECT_THROW(check_closed_oriented(mesh.nodes, triangles), Error);
}

TEST(MeshTopology, BadNodesAreNamed)
{
  const auto triangles = make_icosphere(1).triangles;
  EXPECT_TRUE(contains(message_of(triangles, 13), "node 12 (counted from 0) belongs to no"));
  EXPECT_TRUE(contains(message_of(triangles, 11), "not one of 11 nodes"));
  EXPECT_TRUE(contains(message_of({}, 0), "no triangles"));
  auto degenerate = triangles;
  degenerate[0][1] = degenerate[0][0];
  EXPECT_TRUE(contains(message_of(degenerate, 12), "has a node twice"));
}

TEST(MeshTopology, TwoSurfacesInOneListAreRefused)
{
  auto triangles = make_icosphere(1).triangles;
  const auto first = triangles;
  for (Triangle t : first) triangles.push_back({t[0] + 12, t[1] + 12, t[2] + 12});
  EXPECT_TRUE(contains(message_of(triangles, 24), "falls into 2 separate surfaces"));
}

TEST(MeshTopology, SurfacesTouchingAtANodeAreRefused)
{
  auto triangles = make_icosphere(1).triangles;
  const auto first = triangles;
  auto move = [](int i) { return i == 0 ? 0 : i + 11; };
  for (const Triangle &t : first) triangles.push_back({move(t[0]), move(t[1]), move(t[2])});
  EXPECT_TRUE(contains(message_of(triangles, 23), "Euler characteristic is 3"));
}

}    // namespace
}    // namespace biem
