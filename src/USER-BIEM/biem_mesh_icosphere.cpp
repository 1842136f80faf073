// Subdivides the faces of an icosahedron and projects the lattice points onto the unit sphere.
// Does not know any other shape, nor what the mesh is used for.
#include "biem_mesh_icosphere.h"

#include "biem_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace biem {
namespace {

Points make_icosahedron_corners()
{
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  Points corners(3, 12);
  int n = 0;
  for (int axis = 0; axis < 3; axis++)
    for (double s : {-1.0, 1.0})
      for (double t : {-golden, golden}) {
        Vec3 corner = Vec3::Zero();
        corner[(axis + 1) % 3] = s;
        corner[(axis + 2) % 3] = t;
        corners.col(n++) = corner.normalized();
      }
  return corners;
}

// The 20 triples of mutually adjacent corners, counter-clockwise from outside.
std::vector<Triangle> make_icosahedron_faces(const Points &corners)
{
  // the cosine between adjacent corners is 1/sqrt(5), between the next ones -1/sqrt(5)
  auto is_adjacent = [&](int i, int j) { return corners.col(i).dot(corners.col(j)) > 0.2; };
  std::vector<Triangle> faces;
  for (int i = 0; i < 12; i++)
    for (int j = i + 1; j < 12; j++)
      for (int k = j + 1; k < 12; k++) {
        if (!is_adjacent(i, j) || !is_adjacent(j, k) || !is_adjacent(i, k)) continue;
        const Vec3 a = corners.col(i), b = corners.col(j), c = corners.col(k);
        if (a.dot(b.cross(c)) > 0.0)
          faces.push_back({i, j, k});
        else
          faces.push_back({i, k, j});
      }
  return faces;
}

// Nodes are found again from the neighboring face by their corners and lattice weights.
class NodeBuilder {
 public:
  NodeBuilder(const Points &corners, int frequency) : corners_(corners), frequency_(frequency)
  {
    for (int i = 0; i < 12; i++) find_or_add({i, 0, 0}, {frequency, 0, 0});
  }

  int find_or_add(const Triangle &face, const std::array<int, 3> &weights)
  {
    Key key;
    for (int i = 0; i < 3; i++)
      if (weights[i] > 0) key.push_back({face[i], weights[i]});
    std::sort(key.begin(), key.end());
    const auto inserted = index_.insert({key, static_cast<int>(nodes_.size())});
    if (inserted.second) nodes_.push_back(project(key));
    return inserted.first->second;
  }

  Points make_points() const
  {
    Points points(3, nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); i++) points.col(i) = nodes_[i];
    return points;
  }

 private:
  using Key = std::vector<std::pair<int, int>>;    // (corner, weight), sorted by corner

  // The weights sin(b theta) divide the arcs between corners evenly (spherical interpolation),
  // which makes the triangles more alike than central projection of the flat lattice does.
  Vec3 project(const Key &key) const
  {
    const double arc = std::acos(1.0 / std::sqrt(5.0));
    Vec3 point = Vec3::Zero();
    for (const auto &part : key)
      point += std::sin(arc * part.second / frequency_) * corners_.col(part.first);
    return point.normalized();
  }

  const Points &corners_;
  int frequency_;
  std::map<Key, int> index_;
  std::vector<Vec3> nodes_;
};

}    // namespace

SurfaceMesh make_icosphere(int frequency)
{
  if (frequency < 1)
    throw Error("Icosphere: frequency is " + std::to_string(frequency) + " but must be 1 or more");
  const Points corners = make_icosahedron_corners();
  const int f = frequency;
  NodeBuilder builder(corners, f);
  SurfaceMesh mesh;
  mesh.triangles.reserve(20 * f * f);
  for (const Triangle &face : make_icosahedron_faces(corners)) {
    auto node = [&](int i, int j) { return builder.find_or_add(face, {f - i - j, i, j}); };
    for (int i = 0; i < f; i++)
      for (int j = 0; j < f - i; j++) {
        mesh.triangles.push_back({node(i, j), node(i + 1, j), node(i, j + 1)});
        if (i + j + 1 < f)
          mesh.triangles.push_back({node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      }
  }
  mesh.nodes = builder.make_points();
  return mesh;
}

int compute_icosphere_frequency(int n_nodes)
{
  const int lower = std::max(1, static_cast<int>(std::sqrt(std::max(0.0, (n_nodes - 2) / 10.0))));
  for (int f : {lower, lower + 1})
    if (10 * f * f + 2 == n_nodes) return f;
  auto count = [](int f) { return std::to_string(10 * f * f + 2); };
  throw Error("Icosphere: " + std::to_string(n_nodes) +
              " nodes are not possible; a mesh has 10 f^2 + 2 nodes with a whole number f >= 1, "
              "the nearest counts are " + count(lower) + " and " + count(lower + 1));
}

}    // namespace biem
