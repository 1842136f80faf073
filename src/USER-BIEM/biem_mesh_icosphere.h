// Geodesic icosphere: the parent triangulation of every closed surface.
// Knows the unit sphere only; shapes are made from it in biem_mesh_shape.
#ifndef BIEM_MESH_ICOSPHERE_H
#define BIEM_MESH_ICOSPHERE_H

#include "biem_types.h"

#include <vector>

namespace biem {

struct SurfaceMesh {
  Points nodes;                       // 3 x n_nodes, length
  std::vector<Triangle> triangles;    // counter-clockwise seen from outside
};

// 10 f^2 + 2 nodes at radius 1; f = frequency >= 1 edges between neighboring 5-valent nodes.
// Symmetric under reflection in each coordinate plane; the 12 icosahedron corners come first.
SurfaceMesh make_icosphere(int frequency);

// The f with n_nodes = 10 f^2 + 2; any other count is an Error that names the nearest allowed ones.
int compute_icosphere_frequency(int n_nodes);

}    // namespace biem

#endif
