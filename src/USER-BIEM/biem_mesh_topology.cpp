// Edge bookkeeping of triangulated surfaces; even assignment of triangles and hinges to nodes.
// Knows nothing of LAMMPS beyond "the second node stores"; no geometry except the enclosed volume.
#include "biem_mesh_topology.h"

#include "biem_error.h"
#include "biem_mesh_shape.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace biem {
namespace {

// How often an edge, written with the smaller node first, is run through in each direction.
struct EdgeUse {
  int n_forward = 0, n_backward = 0;
};

std::string describe_edge(const std::pair<int, int> &edge)
{
  return "edge between nodes " + std::to_string(edge.first) + " and " +
      std::to_string(edge.second) + " (counted from 0)";
}

std::string describe_triangle(const Triangle &t)
{
  return "triangle of nodes " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " +
      std::to_string(t[2]) + " (counted from 0)";
}

void check_indices(const std::vector<Triangle> &triangles, int n_nodes)
{
  std::vector<char> is_used(std::max(n_nodes, 0), 0);
  for (const Triangle &t : triangles) {
    for (int node : t) {
      if (node < 0 || node >= n_nodes)
        throw Error("Surface mesh: " + describe_triangle(t) + " uses a node that is not one of " +
                    std::to_string(n_nodes) + " nodes");
      is_used[node] = 1;
    }
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      throw Error("Surface mesh: " + describe_triangle(t) + " has a node twice");
  }
  const auto unused = std::find(is_used.begin(), is_used.end(), 0);
  if (unused != is_used.end())
    throw Error("Surface mesh: node " + std::to_string(unused - is_used.begin()) +
                " (counted from 0) belongs to no triangle");
}

void check_edge(const std::pair<int, int> &edge, const EdgeUse &use)
{
  const int n = use.n_forward + use.n_backward;
  if (n == 1)
    throw Error("Surface mesh: open at the " + describe_edge(edge) +
                ", which has one triangle instead of two; is a triangle (angle) missing?");
  if (n > 2)
    throw Error("Surface mesh: " + describe_edge(edge) + " has " + std::to_string(n) +
                " triangles instead of two; is a triangle (angle) there twice?");
  if (use.n_forward != 1)
    throw Error("Surface mesh: the two triangles at the " + describe_edge(edge) +
                " are oriented against each other; list the nodes of every triangle "
                "counter-clockwise seen from outside");
}

// Connected sets of nodes.
class Pieces {
 public:
  Pieces(const std::vector<Triangle> &triangles, int n_nodes) : parent_(n_nodes), n_(n_nodes)
  {
    for (int i = 0; i < n_nodes; i++) parent_[i] = i;
    for (const Triangle &t : triangles)
      for (int k : {1, 2}) {
        const int one = find_root(t[0]), other = find_root(t[k]);
        if (one == other) continue;
        parent_[one] = other;
        n_--;
      }
  }

  int find_root(int i)
  {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  int count() const { return n_; }

 private:
  std::vector<int> parent_;
  int n_;
};

std::map<std::pair<int, int>, EdgeUse> count_edge_uses(const std::vector<Triangle> &triangles)
{
  std::map<std::pair<int, int>, EdgeUse> edges;
  for (const Triangle &t : triangles)
    for (int k = 0; k < 3; k++) {
      const int from = t[k], to = t[(k + 1) % 3];
      EdgeUse &use = edges[{std::min(from, to), std::max(from, to)}];
      (from < to ? use.n_forward : use.n_backward)++;
    }
  return edges;
}

// Gives each item to one of its candidate nodes, as evenly as possible: the smallest capacity per
// node for which every item finds a place, by augmenting paths (Kuhn's bipartite matching).
class EvenAssignment {
 public:
  EvenAssignment(std::vector<std::vector<int>> candidates, int n_nodes) :
      candidates_(std::move(candidates)), node_of_item_(candidates_.size(), -1),
      items_of_node_(n_nodes)
  {
    const int n_items = static_cast<int>(candidates_.size());
    capacity_ = (n_items + n_nodes - 1) / n_nodes;
    for (int item = 0; item < n_items; item++)
      while (!place(item)) capacity_++;
  }

  int node_of(int item) const { return node_of_item_[item]; }
  int capacity() const { return capacity_; }

 private:
  bool place(int first)
  {
    std::vector<int> queue = {first};
    std::map<int, int> reached_from;    // node -> the item from which it was reached
    for (std::size_t head = 0; head < queue.size(); head++)
      for (int node : candidates_[queue[head]]) {
        if (!reached_from.insert({node, queue[head]}).second) continue;
        if (static_cast<int>(items_of_node_[node].size()) < capacity_) {
          shift(node, reached_from);
          return true;
        }
        for (int item : items_of_node_[node]) queue.push_back(item);
      }
    return false;
  }

  // Moves the items along the path that ends at the free node.
  void shift(int node, const std::map<int, int> &reached_from)
  {
    while (node >= 0) {
      const int item = reached_from.at(node);
      const int left = node_of_item_[item];
      if (left >= 0) {
        auto &items = items_of_node_[left];
        items.erase(std::find(items.begin(), items.end(), item));
      }
      node_of_item_[item] = node;
      items_of_node_[node].push_back(item);
      node = left;
    }
  }

  std::vector<std::vector<int>> candidates_;
  std::vector<int> node_of_item_;
  std::vector<std::vector<int>> items_of_node_;
  int capacity_;
};

}    // namespace

std::vector<Hinge> make_hinges(const std::vector<Triangle> &triangles)
{
  std::map<std::pair<int, int>, int> hinge_of_reversed_edge;
  std::vector<Hinge> hinges;
  hinges.reserve(triangles.size() * 3 / 2);
  for (const Triangle &t : triangles)
    for (int k = 0; k < 3; k++) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const auto partner = hinge_of_reversed_edge.find({b, c});
      if (partner != hinge_of_reversed_edge.end()) {
        hinges[partner->second].d = a;
        continue;
      }
      hinge_of_reversed_edge[{c, b}] = static_cast<int>(hinges.size());
      hinges.push_back({a, b, c, -1});
    }
  return hinges;
}

void check_closed_oriented(const std::vector<Triangle> &triangles, int n_nodes)
{
  if (triangles.empty()) throw Error("Surface mesh: there are no triangles (angles)");
  check_indices(triangles, n_nodes);
  const auto edges = count_edge_uses(triangles);
  for (const auto &entry : edges) check_edge(entry.first, entry.second);

  const int n_pieces = Pieces(triangles, n_nodes).count();
  if (n_pieces != 1)
    throw Error("Surface mesh: it falls into " + std::to_string(n_pieces) +
                " separate surfaces; give each its own molecule id");
  const int characteristic =
      n_nodes - static_cast<int>(edges.size()) + static_cast<int>(triangles.size());
  if (characteristic != 2)
    throw Error("Surface mesh: its Euler characteristic is " + std::to_string(characteristic) +
                " instead of 2; it has a handle or touches itself at a node");
}

void check_closed_oriented(const PointsView &nodes, const std::vector<Triangle> &triangles)
{
  check_closed_oriented(triangles, static_cast<int>(nodes.cols()));
  const double volume = compute_enclosed_volume(nodes, triangles);
  if (!(volume > 0.0))
    throw Error("Surface mesh: the enclosed volume is " + std::to_string(volume) +
                " but must be positive; are the triangles clockwise instead of counter-clockwise "
                "seen from outside, or the cell not unwrapped across the periodic boundary?");
}

std::vector<char> find_closed_bodies(const std::vector<Triangle> &triangles, int n_nodes)
{
  Pieces pieces(triangles, n_nodes);
  std::vector<int> characteristic(n_nodes, 0);    // Euler's, of the piece with that root
  std::vector<char> is_closed(n_nodes, 1), is_used(n_nodes, 0);
  for (const Triangle &t : triangles) {
    characteristic[pieces.find_root(t[0])]++;
    for (int node : t) is_used[node] = 1;
  }
  for (int i = 0; i < n_nodes; i++)
    if (is_used[i]) characteristic[pieces.find_root(i)]++;
  for (const auto &edge : count_edge_uses(triangles)) {
    const int root = pieces.find_root(edge.first.first);
    characteristic[root]--;
    if (edge.second.n_forward + edge.second.n_backward != 2) is_closed[root] = 0;
  }
  std::vector<char> is_body;
  for (const Triangle &t : triangles) {
    const int root = pieces.find_root(t[0]);
    is_body.push_back(is_closed[root] && characteristic[root] == 2);
  }
  return is_body;
}

MiddleNodeLoad balance_middle_nodes(std::vector<Triangle> &triangles, std::vector<Hinge> &hinges,
                                    int n_nodes)
{
  std::vector<std::vector<int>> corners, edge_ends;
  for (const Triangle &t : triangles) corners.push_back({t[1], t[0], t[2]});
  for (const Hinge &h : hinges) edge_ends.push_back({h.b, h.c});
  const EvenAssignment triangle_nodes(std::move(corners), n_nodes);
  const EvenAssignment hinge_nodes(std::move(edge_ends), n_nodes);

  for (std::size_t i = 0; i < triangles.size(); i++) {
    Triangle &t = triangles[i];
    while (t[1] != triangle_nodes.node_of(static_cast<int>(i)))
      std::rotate(t.begin(), t.begin() + 1, t.end());
  }
  for (std::size_t i = 0; i < hinges.size(); i++) {
    Hinge &h = hinges[i];
    if (h.b != hinge_nodes.node_of(static_cast<int>(i))) h = {h.d, h.c, h.b, h.a};
  }
  return {triangle_nodes.capacity(), hinge_nodes.capacity()};
}

}    // namespace biem
