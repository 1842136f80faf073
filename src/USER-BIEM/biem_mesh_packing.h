// Places equal axisymmetric bodies in a periodic cell at random, without overlap and with a gap.
// Knows meshes and obstacles; nothing of LAMMPS, ranks or mechanics.
#ifndef BIEM_MESH_PACKING_H
#define BIEM_MESH_PACKING_H

#include "biem_mesh_shape.h"

#include <cstdint>
#include <vector>

namespace biem {

// x = center + rotation * x_body
struct RigidPlacement {
  Vec3 center;      // length
  Mat3 rotation;    // its third column is the symmetry axis
};

enum class PackingRotation { free, fixed };

struct PackingRequest {
  const Shape *shape;
  int n_nodes;           // of the mesh whose gaps are to be kept
  int n_bodies;
  double minimum_gap;    // from every node of a surface to every triangle of the others, length
  std::uint64_t seed;
  Mat3 lattice;          // lattice vectors in columns, length
  PackingRotation rotation;
  Mat3 orientation;      // of every body where the rotation is fixed
};

// What is in the cell already and does not move; nodes in any periodic images.
struct PackingObstacles {
  Points nodes;                       // 3 x n; those without a triangle are points
  std::vector<Triangle> triangles;    // counter-clockwise from outside
};

// Bodies grow from small random seeds to full size while overlaps are pushed apart (in the manner
// of Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990), without dynamics). The same request
// gives the same placements. Error, with the number that found a place, if it does not succeed.
std::vector<RigidPlacement> make_random_packing(const PackingRequest &request,
                                                const PackingObstacles &obstacles);

// Error unless one body placed there keeps the gap to the obstacles and to its own images.
void check_placement(const PackingRequest &request, const RigidPlacement &placement,
                     const PackingObstacles &obstacles);

// The rotation that takes the z axis to the given axis (any length) after a turn by roll (rad)
// about z; without roll it is the shortest rotation.
Mat3 compute_rotation_to_axis(const Vec3 &axis, double roll);

}    // namespace biem

#endif
