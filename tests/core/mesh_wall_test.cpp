// Wall meshes: areas and closure known exactly, invariance under lattice steps, normals, and the
// messages for walls that do not fit the box.
#include "biem_mesh_lattice.h"
#include "biem_mesh_wall.h"
#include "error_messages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

namespace biem {
namespace {

const double pi = 3.14159265358979323846;

WallBox make_box() { return {Vec3(8.0, 6.0, 5.0).asDiagonal(), Vec3(-3.0, -2.0, 1.0)}; }

// Area vectors of the triangles with their centers.
struct Facet {
  Vec3 center, area;
};

std::vector<Facet> make_facets(const WallBox &box, const SurfaceMesh &mesh)
{
  const MeshLattice lattice(box.lattice);
  std::vector<Facet> facets;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.nodes.col(t[0]);
    const Vec3 ab = lattice.wrap_difference(mesh.nodes.col(t[1]) - a);
    const Vec3 ac = lattice.wrap_difference(mesh.nodes.col(t[2]) - a);
    facets.push_back({a + (ab + ac) / 3.0, 0.5 * ab.cross(ac)});
  }
  return facets;
}

void expect_inside_box(const WallBox &box, const SurfaceMesh &mesh)
{
  for (int i = 0; i < mesh.nodes.cols(); i++)
    for (int k = 0; k < 3; k++) {
      EXPECT_GE(mesh.nodes(k, i), box.origin[k]);
      EXPECT_LT(mesh.nodes(k, i), box.origin[k] + box.lattice(k, k));
    }
}

std::map<std::pair<int, int>, int> count_edges(const SurfaceMesh &mesh)
{
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle &t : mesh.triangles)
    for (int k = 0; k < 3; k++)
      edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}]++;
  return edges;
}

// The node where another one goes by a shift; -1: there is none.
int find_node(const WallBox &box, const SurfaceMesh &mesh, const Vec3 &place)
{
  const MeshLattice lattice(box.lattice);
  for (int i = 0; i < mesh.nodes.cols(); i++)
    if (lattice.wrap_difference(mesh.nodes.col(i) - place).norm() < 1e-9) return i;
  return -1;
}

Triangle normalize(Triangle t)
{
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

// The shift takes nodes to nodes and triangles to triangles.
void expect_invariant(const WallBox &box, const SurfaceMesh &mesh, const Vec3 &shift)
{
  std::vector<int> image;
  for (int i = 0; i < mesh.nodes.cols(); i++) {
    image.push_back(find_node(box, mesh, mesh.nodes.col(i) + shift));
    ASSERT_GE(image.back(), 0) << "node " << i;
  }
  std::set<Triangle> all;
  for (const Triangle &t : mesh.triangles) all.insert(normalize(t));
  EXPECT_EQ(all.size(), mesh.triangles.size());
  for (const Triangle &t : mesh.triangles)
    EXPECT_EQ(all.count(normalize({image[t[0]], image[t[1]], image[t[2]]})), 1u);
}

TEST(MeshWall, PlaneCoversTheBoxOnceWithNormalsAlongTheAxis)
{
  const WallBox box = make_box();
  const int n_of_length[3] = {14, 10, 9};    // ceil(L / 0.6); 6 / 0.6 is 10
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const double place = box.origin[c] + 1.7;
    const SurfaceMesh mesh = make_plane_wall(box, static_cast<Axis>(c), place, 0.6);
    ASSERT_EQ(mesh.nodes.cols(), n_of_length[a] * n_of_length[b]);
    ASSERT_EQ(static_cast<int>(mesh.triangles.size()), 2 * mesh.nodes.cols());
    expect_inside_box(box, mesh);
    EXPECT_DOUBLE_EQ((mesh.nodes.row(c).array() - place).abs().maxCoeff(), 0.0);
    const double each = 0.5 * box.lattice(a, a) * box.lattice(b, b) / mesh.nodes.cols();
    for (const Facet &facet : make_facets(box, mesh))
      EXPECT_LT((facet.area - each * Vec3::Unit(c)).norm(), 1e-13);
    const auto edges = count_edges(mesh);
    EXPECT_EQ(static_cast<int>(edges.size()), 3 * mesh.nodes.cols());
    for (const auto &edge : edges) EXPECT_EQ(edge.second, 2);
    expect_invariant(box, mesh, Vec3::Unit(a) * box.lattice(a, a) / n_of_length[a]);
    expect_invariant(box, mesh, Vec3::Unit(b) * box.lattice(b, b) / n_of_length[b]);
    // node i + n_a j: one step along a is one index on
    EXPECT_NEAR(mesh.nodes(a, 1) - mesh.nodes(a, 0), box.lattice(a, a) / n_of_length[a], 1e-13);
  }
}

TEST(MeshWall, SecondNodesOfALatticeAreSpreadEvenly)
{
  const SurfaceMesh mesh = make_plane_wall(make_box(), Axis::Z, 2.0, 0.5);
  std::vector<int> n_second(mesh.nodes.cols(), 0);
  for (const Triangle &t : mesh.triangles) n_second[t[1]]++;
  EXPECT_EQ(*std::max_element(n_second.begin(), n_second.end()), 2);
}

TEST(MeshWall, UpperFaceOfTheBoxIsTheLowerOne)
{
  const WallBox box = make_box();
  const SurfaceMesh low = make_plane_wall(box, Axis::Z, 1.0, 0.9);
  const SurfaceMesh high = make_plane_wall(box, Axis::Z, 6.0, 0.9);
  EXPECT_TRUE(low.nodes == high.nodes);
}

TEST(MeshWall, DuctSharesTheCrossingLine)
{
  const WallBox box = make_box();
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const WallDuct duct = {static_cast<Axis>(a), box.origin[b] + 2.0, box.origin[c] + 4.9};
    const SurfaceMesh mesh = make_duct_wall(box, duct, 0.7);
    const int n_a = static_cast<int>(std::ceil(box.lattice(a, a) / 0.7));
    const int n_b = static_cast<int>(std::ceil(box.lattice(b, b) / 0.7));
    const int n_c = static_cast<int>(std::ceil(box.lattice(c, c) / 0.7));
    ASSERT_EQ(mesh.nodes.cols(), n_a * (n_b + n_c - 1));
    ASSERT_EQ(static_cast<int>(mesh.triangles.size()), 2 * n_a * (n_b + n_c));
    expect_inside_box(box, mesh);
    for (int i = 0; i < mesh.nodes.cols(); i++)
      EXPECT_EQ(find_node(box, mesh, mesh.nodes.col(i)), i) << "a node is there twice";
    Vec3 total = Vec3::Zero();
    for (const Facet &facet : make_facets(box, mesh)) {
      total += facet.area;
      const int across = std::abs(facet.area[b]) > std::abs(facet.area[c]) ? b : c;
      EXPECT_NEAR(facet.area[across] / facet.area.norm(), 1.0, 1e-13);
      EXPECT_NEAR(facet.center[across], across == b ? duct.first : duct.second, 1e-13);
    }
    EXPECT_NEAR(total[b], box.lattice(a, a) * box.lattice(c, c), 1e-11);
    EXPECT_NEAR(total[c], box.lattice(a, a) * box.lattice(b, b), 1e-11);
    int n_crossing = 0;
    for (const auto &edge : count_edges(mesh)) {
      if (edge.second == 4) n_crossing++;
      else EXPECT_EQ(edge.second, 2);
    }
    EXPECT_EQ(n_crossing, n_a);
    expect_invariant(box, mesh, Vec3::Unit(a) * box.lattice(a, a) / n_a);
  }
}

TEST(MeshWall, TubeHasTheExactCrossSectionAndOutwardNormals)
{
  const WallBox box = make_box();
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    // the axis lies near a corner of the box, so that the tube crosses its faces
    const WallTube tube = {static_cast<Axis>(a), box.origin[b] + 0.1, box.origin[c] + 0.2, 1.9};
    const SurfaceMesh mesh = make_tube_wall(box, tube, 0.4);
    const int n_a = static_cast<int>(std::ceil(box.lattice(a, a) / 0.4 - 1e-9));
    const int n_around = 30;    // ceil(2 pi 1.9 / 0.4) = ceil(29.85)
    ASSERT_EQ(mesh.nodes.cols(), n_a * n_around);
    expect_inside_box(box, mesh);
    for (const auto &edge : count_edges(mesh)) EXPECT_EQ(edge.second, 2);
    // volume by the divergence theorem in the cross-section, 1/2 of the integral of x.n
    const MeshLattice lattice(box.lattice);
    double volume = 0.0;
    for (const Facet &facet : make_facets(box, mesh)) {
      Vec3 axis_point = facet.center;
      axis_point[b] = tube.first;
      axis_point[c] = tube.second;
      const Vec3 arm = lattice.wrap_difference(facet.center - axis_point);
      EXPECT_GT(arm.dot(facet.area), 0.0);
      EXPECT_NEAR(facet.area[a], 0.0, 1e-13);
      volume += 0.5 * arm.dot(facet.area);
    }
    EXPECT_NEAR(volume / (pi * 1.9 * 1.9 * box.lattice(a, a)), 1.0, 1e-12);
    expect_invariant(box, mesh, Vec3::Unit(a) * box.lattice(a, a) / n_a);
  }
}

TEST(MeshWall, MeasuresUseShortestImages)
{
  const WallBox box = make_box();
  const SurfaceMesh plane = make_plane_wall(box, Axis::X, -1.0, 1.0);
  const WallMeasures measures = compute_wall_measures(box.lattice, plane);
  EXPECT_NEAR(measures.area, 30.0, 1e-12);
  EXPECT_NEAR(measures.shortest_edge, 1.0, 1e-12);
  EXPECT_NEAR(measures.longest_edge, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(measures.n_open_edges, 0);
  SurfaceMesh torn = plane;
  torn.triangles.pop_back();
  EXPECT_EQ(compute_wall_measures(box.lattice, torn).n_open_edges, 3);
}

// A sheet as a file has it: both ends of the period are there, with nodes of their own.
SurfaceMesh make_patch(const Vec3 &first, const Vec3 &second, int n)
{
  SurfaceMesh mesh;
  mesh.nodes.resize(3, (n + 1) * (n + 1));
  for (int j = 0; j <= n; j++)
    for (int i = 0; i <= n; i++) mesh.nodes.col(i + (n + 1) * j) = first * i / n + second * j / n;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      const int k = i + (n + 1) * j;
      mesh.triangles.push_back({k, k + 1, k + n + 2});
      mesh.triangles.push_back({k, k + n + 2, k + n + 1});
    }
  return mesh;
}

TEST(MeshWall, NodesThatCoincideInTheBoxAreJoined)
{
  Mat3 tilted = make_box().lattice;
  tilted(0, 2) = 1.5;
  for (const Mat3 &lattice : {make_box().lattice, tilted}) {
    for (int k = 0; k < 3; k++) {
      const Vec3 a = lattice.col(k), b = lattice.col((k + 1) % 3);
      const SurfaceMesh patch = make_patch(a, b, 6);
      const SurfaceMesh mesh = join_periodic_nodes(lattice, patch);
      EXPECT_EQ(mesh.nodes.cols(), 36);
      EXPECT_EQ(mesh.triangles.size(), patch.triangles.size());
      EXPECT_GT(compute_wall_measures(lattice, patch).n_open_edges, 0);
      const WallMeasures measures = compute_wall_measures(lattice, mesh);
      EXPECT_EQ(measures.n_open_edges, 0);
      EXPECT_NEAR(measures.area, a.cross(b).norm(), 1e-11);
      const SurfaceMesh half = join_periodic_nodes(lattice, make_patch(0.5 * a, 0.5 * b, 6));
      EXPECT_EQ(half.nodes.cols(), 49);
    }
  }
  const Mat3 lattice = make_box().lattice;
  EXPECT_TRUE(contains(message_of([&] {
    join_periodic_nodes(lattice, make_patch(lattice.col(0), 0.4 * lattice.col(1), 1));
  }), "periodic images of each other"));
}

TEST(MeshWall, WrongInputIsRefused)
{
  const WallBox box = make_box();
  WallBox tilted = box;
  tilted.lattice(0, 1) = 0.5;
  auto expect = [](const std::string &part, const std::function<void()> &function) {
    EXPECT_TRUE(contains(message_of(function), part)) << part << ": " << message_of(function);
  };
  expect("the box is tilted", [&] { make_plane_wall(tilted, Axis::Z, 2.0, 0.5); });
  expect("z = 6.5 lies outside the box, which goes from 1 to 6",
         [&] { make_plane_wall(box, Axis::Z, 6.5, 0.5); });
  expect("must be less than 3, half the length of the box along y",
         [&] { make_plane_wall(box, Axis::Z, 2.0, 3.0); });
  expect("the edge is -1", [&] { make_plane_wall(box, Axis::Z, 2.0, -1.0); });
  expect("asks for 8e+06 nodes", [&] { make_plane_wall(box, Axis::Z, 2.0, 1e-6); });
  expect("y = 4.5 lies outside", [&] { make_duct_wall(box, {Axis::X, 4.5, 2.0}, 0.5); });
  expect("z = 0 lies outside", [&] { make_duct_wall(box, {Axis::X, 0.0, 0.0}, 0.5); });
  expect("half the length of the box along z",
         [&] { make_duct_wall(box, {Axis::X, 0.0, 2.0}, 2.6); });
  expect("the radius is 0", [&] { make_tube_wall(box, {Axis::X, 0.0, 2.0, 0.0}, 0.5); });
  expect("exceeds the radius", [&] { make_tube_wall(box, {Axis::X, 0.0, 2.0, 0.3}, 0.5); });
  expect("must not touch its own", [&] { make_tube_wall(box, {Axis::X, 0.0, 2.0, 2.5}, 0.5); });
  expect("x = 7 lies outside", [&] { make_tube_wall(box, {Axis::Z, 7.0, 2.0, 1.0}, 0.5); });
}

}    // namespace
}    // namespace biem
