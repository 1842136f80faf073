// Lattice nodes and their triangles on sheets and cylinders; periodic joining and measuring.
// Does not know what the walls are for.
#include "biem_mesh_wall.h"

#include "biem_error.h"
#include "biem_mesh_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace biem {
namespace {

const double pi = 3.14159265358979323846;
const char *const axis_names[3] = {"x", "y", "z"};

std::string format(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

int index_of(Axis axis) { return static_cast<int>(axis); }

// Adds the triangles of a lattice that is periodic in both directions; node(i, j) is an index.
// Normals along (direction of i) x (direction of j). Each node is the second one of two triangles.
template <class NodeOf>
void add_lattice_triangles(int n_i, int n_j, NodeOf node, std::vector<Triangle> &triangles)
{
  for (int j = 0; j < n_j; j++)
    for (int i = 0; i < n_i; i++) {
      const int i_next = (i + 1) % n_i, j_next = (j + 1) % n_j;
      triangles.push_back({node(i, j), node(i_next, j), node(i_next, j_next)});
      triangles.push_back({node(i, j), node(i_next, j_next), node(i, j_next)});
    }
}

// The box as walls see it: lengths, checked arguments, coordinates inside.
class WallFrame {
 public:
  WallFrame(const std::string &name, const WallBox &box, double edge) :
      name_(name), origin_(box.origin), lengths_(box.lattice.diagonal()), edge_(edge)
  {
    const Mat3 off = box.lattice - Mat3(lengths_.asDiagonal());
    if (off.cwiseAbs().maxCoeff() > 0.0)
      throw Error(describe() + "the box is tilted, but sheets, ducts and tubes need an orthogonal "
                  "one: use a block instead of a prism as the region of the box");
    if (!(lengths_.minCoeff() > 0.0))
      throw Error(describe() + "the box has the lengths " + format(lengths_[0]) + " " +
                  format(lengths_[1]) + " " + format(lengths_[2]) + ", which must be positive");
    if (!(edge > 0.0) || !std::isfinite(edge))
      throw Error(describe() + "the edge is " + format(edge) + " but must be a positive length");
  }

  std::string describe() const { return "Wall " + name_ + ": "; }
  double length(int k) const { return lengths_[k]; }

  // Number of lattice steps along a side of the box.
  int count_steps(int k) const
  {
    if (!(edge_ < 0.5 * lengths_[k]))
      throw Error(describe() + "the edge " + format(edge_) + " must be less than " +
                  format(0.5 * lengths_[k]) + ", half the length of the box along " +
                  axis_names[k] + ": use a shorter edge");
    return count_steps_of(lengths_[k]);
  }

  int count_steps_of(double length) const
  {
    const double n = std::ceil(length / edge_ * (1.0 - 1e-9));    // 10.0000000001 steps are 10
    if (n > 30000.0)
      throw Error(describe() + "the edge " + format(edge_) + " asks for " + format(n) +
                  " nodes along a length of " + format(length) + ": use a longer edge");
    return static_cast<int>(n);
  }

  // The upper face of the box is the lower one.
  double place(int k, double coordinate) const
  {
    const double low = origin_[k], high = origin_[k] + lengths_[k];
    if (!(coordinate >= low && coordinate <= high))
      throw Error(describe() + axis_names[k] + " = " + format(coordinate) +
                  " lies outside the box, which goes from " + format(low) + " to " +
                  format(high) + ": give a place inside, in the units of the box");
    return wrap(k, coordinate);
  }

  double wrap(int k, double coordinate) const
  {
    const double low = origin_[k], length = lengths_[k];
    double x = coordinate;
    if (x >= low + length || x < low) x -= length * std::floor((x - low) / length);
    return x < low || x >= low + length ? low : x;
  }

  // Step i of n from the first coordinate on.
  double step(int k, double first, int i, int n) const
  {
    return wrap(k, first + lengths_[k] * i / n);
  }
  double low(int k) const { return origin_[k]; }

 private:
  std::string name_;
  Vec3 origin_, lengths_;
  double edge_;
};

double compute_shortest_edge(const SurfaceMesh &mesh)
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const Triangle &t : mesh.triangles)
    for (int k = 0; k < 3; k++)
      shortest = std::min(shortest, (mesh.nodes.col(t[k]) - mesh.nodes.col(t[(k + 1) % 3])).norm());
  return shortest;
}

// Nodes that differ by more than 1e-6 of the spacing from all periodic images of all others.
class PeriodicNodes {
 public:
  PeriodicNodes(const Mat3 &lattice, double spacing) : lattice_(lattice), spacing_(spacing)
  {
    for (int k = 0; k < 3; k++)
      n_bins_[k] = static_cast<int>(
          std::min(1e6, std::max(1.0, std::floor(lattice_.heights()[k] / spacing))));
  }

  // The index of the node, which is that of an earlier one where they coincide.
  int add(const Vec3 &node)
  {
    const std::array<int, 3> home = find_bin(node);
    for (int i = -1; i <= 1; i++)
      for (int j = -1; j <= 1; j++)
        for (int k = -1; k <= 1; k++) {
          const auto bin = bins_.find({wrap(home[0] + i, 0), wrap(home[1] + j, 1),
                                       wrap(home[2] + k, 2)});
          if (bin == bins_.end()) continue;
          for (int other : bin->second)
            if (lattice_.wrap_difference(node - nodes_[other]).norm() < 1e-6 * spacing_)
              return other;
        }
    const int index = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    bins_[home].push_back(index);
    return index;
  }

  Points get_nodes() const
  {
    Points points(3, nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); i++) points.col(i) = nodes_[i];
    return points;
  }

 private:
  std::array<int, 3> find_bin(const Vec3 &point) const
  {
    const Vec3 s = lattice_.compute_fractional(point);
    std::array<int, 3> bin;
    for (int k = 0; k < 3; k++)
      bin[k] = std::min(static_cast<int>((s[k] - std::floor(s[k])) * n_bins_[k]), n_bins_[k] - 1);
    return bin;
  }
  int wrap(int bin, int k) const { return (bin + n_bins_[k]) % n_bins_[k]; }

  MeshLattice lattice_;
  double spacing_;
  std::array<int, 3> n_bins_;
  std::vector<Vec3> nodes_;
  std::map<std::array<int, 3>, std::vector<int>> bins_;
};

// Number, by smaller and larger node, of triangles at each edge.
std::map<std::pair<int, int>, int> count_edges(const std::vector<Triangle> &triangles)
{
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle &t : triangles)
    for (int k = 0; k < 3; k++) edges[std::minmax(t[k], t[(k + 1) % 3])]++;
  return edges;
}

}    // namespace

SurfaceMesh make_plane_wall(const WallBox &box, Axis normal, double coordinate, double edge)
{
  const WallFrame frame("plane", box, edge);
  const int c = index_of(normal), a = (c + 1) % 3, b = (c + 2) % 3;
  const double height = frame.place(c, coordinate);
  const int n_a = frame.count_steps(a), n_b = frame.count_steps(b);
  SurfaceMesh mesh;
  mesh.nodes.resize(3, static_cast<Eigen::Index>(n_a) * n_b);
  for (int j = 0; j < n_b; j++)
    for (int i = 0; i < n_a; i++) {
      auto node = mesh.nodes.col(i + n_a * j);
      node[a] = frame.step(a, frame.low(a), i, n_a);
      node[b] = frame.step(b, frame.low(b), j, n_b);
      node[c] = height;
    }
  add_lattice_triangles(n_a, n_b, [&](int i, int j) { return i + n_a * j; }, mesh.triangles);
  return mesh;
}

SurfaceMesh make_duct_wall(const WallBox &box, const WallDuct &duct, double edge)
{
  const WallFrame frame("duct", box, edge);
  const int a = index_of(duct.axis), b = (a + 1) % 3, c = (a + 2) % 3;
  const double first = frame.place(b, duct.first), second = frame.place(c, duct.second);
  const int n_a = frame.count_steps(a), n_b = frame.count_steps(b), n_c = frame.count_steps(c);
  SurfaceMesh mesh;
  mesh.nodes.resize(3, static_cast<Eigen::Index>(n_a) * (n_b + n_c - 1));
  for (int line = 0; line < n_b + n_c - 1; line++)
    for (int i = 0; i < n_a; i++) {
      auto node = mesh.nodes.col(i + n_a * line);
      node[a] = frame.step(a, frame.low(a), i, n_a);
      node[b] = line < n_c ? first : frame.step(b, first, line - n_c + 1, n_b);
      node[c] = line < n_c ? frame.step(c, second, line, n_c) : second;
    }
  add_lattice_triangles(n_c, n_a, [&](int k, int i) { return i + n_a * k; }, mesh.triangles);
  add_lattice_triangles(n_a, n_b, [&](int i, int j) {
    return i + n_a * (j == 0 ? 0 : n_c + j - 1);
  }, mesh.triangles);
  return mesh;
}

SurfaceMesh make_tube_wall(const WallBox &box, const WallTube &tube, double edge)
{
  const WallFrame frame("tube", box, edge);
  const int a = index_of(tube.axis), b = (a + 1) % 3, c = (a + 2) % 3;
  if (!(tube.radius > 0.0) || !std::isfinite(tube.radius))
    throw Error(frame.describe() + "the radius is " + format(tube.radius) +
                " but must be a positive length");
  if (!(edge <= tube.radius))
    throw Error(frame.describe() + "the edge " + format(edge) + " exceeds the radius " +
                format(tube.radius) + ": use a shorter edge");
  const double first = frame.place(b, tube.first), second = frame.place(c, tube.second);
  const int n_a = frame.count_steps(a), n_around = frame.count_steps_of(2.0 * pi * tube.radius);
  const double angle = 2.0 * pi / n_around;
  const double outer = tube.radius * std::sqrt(angle / std::sin(angle));
  const double room = std::min(frame.length(b), frame.length(c));
  if (!(2.0 * outer < room))
    throw Error(frame.describe() + "the diameter " + format(2.0 * outer) + " of the mesh must be " +
                "less than " + format(room) + ", the shorter side of the box across the axis: "
                "a tube must not touch its own periodic images");
  SurfaceMesh mesh;
  mesh.nodes.resize(3, static_cast<Eigen::Index>(n_a) * n_around);
  for (int j = 0; j < n_around; j++)
    for (int i = 0; i < n_a; i++) {
      auto node = mesh.nodes.col(i + n_a * j);
      node[a] = frame.step(a, frame.low(a), i, n_a);
      node[b] = frame.wrap(b, first + outer * std::cos(j * angle));
      node[c] = frame.wrap(c, second + outer * std::sin(j * angle));
    }
  add_lattice_triangles(n_around, n_a, [&](int j, int i) { return i + n_a * j; }, mesh.triangles);
  return mesh;
}

SurfaceMesh join_periodic_nodes(const Mat3 &lattice, const SurfaceMesh &mesh)
{
  PeriodicNodes joined(lattice, compute_shortest_edge(mesh));
  SurfaceMesh result;
  std::vector<int> number;
  for (int i = 0; i < mesh.nodes.cols(); i++) number.push_back(joined.add(mesh.nodes.col(i)));
  result.nodes = joined.get_nodes();
  for (const Triangle &t : mesh.triangles) {
    const Triangle u = {number[t[0]], number[t[1]], number[t[2]]};
    if (u[0] == u[1] || u[1] == u[2] || u[2] == u[0])
      throw Error("Wall mesh: a triangle has two corners that are periodic images of each other; "
                  "the mesh is too coarse for the box, or its scale does not fit the box");
    result.triangles.push_back(u);
  }
  return result;
}

WallMeasures compute_wall_measures(const Mat3 &lattice, const SurfaceMesh &mesh)
{
  const MeshLattice cell(lattice);
  WallMeasures measures = {std::numeric_limits<double>::infinity(), 0.0, 0.0, 0};
  for (const Triangle &t : mesh.triangles) {
    Vec3 sides[3];
    for (int k = 0; k < 3; k++) {
      sides[k] = cell.wrap_difference(mesh.nodes.col(t[(k + 1) % 3]) - mesh.nodes.col(t[k]));
      measures.shortest_edge = std::min(measures.shortest_edge, sides[k].norm());
      measures.longest_edge = std::max(measures.longest_edge, sides[k].norm());
    }
    measures.area += 0.5 * sides[0].cross(sides[1]).norm();
  }
  for (const auto &edge : count_edges(mesh.triangles))
    if (edge.second == 1) measures.n_open_edges++;
  return measures;
}

}    // namespace biem
