// One rank's share of a configuration: where the nodes of all surfaces are, which surface each
// belongs to, and which triangles they form. Made by the bridge, or by tests.
#ifndef BIEM_CONFIGURATION_H
#define BIEM_CONFIGURATION_H

#include "biem_near_correction.h"

namespace biem {

struct Configuration {
  PointsView nodes;    // 3 x n_all, owned first, then ghosts
  int n_owned;
  // Each triangle is on exactly one rank; corners index into nodes.
  const std::vector<Triangle> &triangles;
  const std::vector<int> &surface_of_triangle;
  const std::vector<int> &surface_of_node;    // owned nodes; -1: on no surface
  // Owned nodes: number within its shape (rigid), within its cell (cell with unknowns) or within
  // all walls (wall); not read elsewhere.
  const std::vector<int> &index_of_node;
  PointsView triangle_shift;    // 3 x n: from the triangle's image to its surface's
  PointsView unwrapped;         // 3 x n_owned, every closed surface in one piece
  const NearCandidates &candidates;
  const std::vector<Mat3> &orientations;    // by surface: body frame to space; read for rigid ones
  // Grows whenever anything but positions and orientations has changed.
  long version;
};

}    // namespace biem

#endif
