// One rank's part of a periodic mesh that every rank knows as a whole: its nodes, its triangles,
// and values gathered from all ranks. Knows nothing of surfaces and operators.
#ifndef BIEM_TESTS_DISTRIBUTED_MESH_H
#define BIEM_TESTS_DISTRIBUTED_MESH_H

#include "biem_periodic_ghosts.h"
#include <algorithm>
#include <cmath>
#include <map>

namespace biem {

// Every point for itself inside the cell.
inline Points wrap_points(const Points &points, const Mat3 &cell)
{
  Points s = cell.inverse() * points;
  s.array() -= s.array().floor();
  return cell * s;
}

// Numbers of the nodes on this rank, ascending.
inline std::vector<int> list_owned(MPI_Comm comm, const Points &nodes, const Mat3 &cell)
{
  int rank, n_ranks;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  const std::vector<int> ranks = assign_to_ranks(nodes, cell, n_ranks);
  std::vector<int> owned;
  for (size_t i = 0; i < ranks.size(); i++)
    if (ranks[i] == rank) owned.push_back(static_cast<int>(i));
  return owned;
}

// The corners of triangle t next to its second one, which is node middle; copies: by number, the
// columns of nodes that are the node or an image of it.
inline Triangle find_corners(const Triangle &t, int middle, const std::multimap<int, int> &copies,
                             PointsView nodes)
{
  Triangle corners{middle, middle, middle};
  for (int v : {0, 2}) {
    double least = INFINITY;
    for (auto [i, end] = copies.equal_range(t[v]); i != end; ++i) {
      const double distance = (nodes.col(i->second) - nodes.col(middle)).norm();
      if (distance >= least) continue;
      least = distance;
      corners[v] = i->second;
    }
  }
  return corners;
}

struct LocalTriangles {
  std::vector<Triangle> triangles;    // of owned and ghost nodes
  std::vector<int> numbers;           // in the whole mesh
  Points shift;                       // (3, n_triangles), to the place in the whole mesh
};

// A triangle is on the rank that owns its second node; its corners are the closest images.
// nodes, triangles: of the whole mesh.
inline LocalTriangles list_local_triangles(const std::vector<int> &owned, PeriodicGhosts &ghosts,
                                           const Points &nodes,
                                           const std::vector<Triangle> &triangles)
{
  const Points &images = ghosts.nodes();
  std::vector<double> ids(images.cols());
  std::copy(owned.begin(), owned.end(), ids.begin());
  ghosts.forward(ids.data(), 1);
  std::multimap<int, int> copies;
  for (size_t i = 0; i < ids.size(); i++)
    copies.emplace(static_cast<int>(ids[i]), static_cast<int>(i));
  LocalTriangles local;
  local.shift.resize(3, static_cast<Eigen::Index>(triangles.size()));
  Eigen::Index n = 0;
  for (size_t e = 0; e < triangles.size(); e++) {
    const Triangle &t = triangles[e];
    const auto found = std::lower_bound(owned.begin(), owned.end(), t[1]);
    if (found == owned.end() || *found != t[1]) continue;
    const auto middle = static_cast<int>(found - owned.begin());
    local.triangles.push_back(find_corners(t, middle, copies, images));
    local.numbers.push_back(static_cast<int>(e));
    local.shift.col(n++) = nodes.col(t[1]) - images.col(middle);
  }
  local.shift.conservativeResize(3, n);
  return local;
}

// Values (3, n_nodes) of all nodes on every rank, from those of each rank's own nodes.
inline Points gather_nodes(const Points &part, const std::vector<int> &owned, Eigen::Index n_nodes,
                           PeriodicGhosts &ghosts)
{
  Points values = Points::Zero(3, n_nodes);
  for (size_t i = 0; i < owned.size(); i++)
    values.col(owned[i]) = part.col(i);
  ghosts.sum(values.data(), static_cast<int>(values.size()));
  return values;
}

}    // namespace biem

#endif
