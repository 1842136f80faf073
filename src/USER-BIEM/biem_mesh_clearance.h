// Whether a new surface of any shape keeps off what is in the periodic box already. The errors
// say what is in the way. Knows meshes and points; not how they came there.
#ifndef BIEM_MESH_CLEARANCE_H
#define BIEM_MESH_CLEARANCE_H

#include "biem_mesh_packing.h"

namespace biem {

// Error if an existing node lies on the wall, an edge of one goes through a triangle of the other,
// or the wall is inside an existing body. lattice: vectors in columns.
void check_wall_clearance(const Mat3 &lattice, const SurfaceMesh &wall,
                          const PackingObstacles &existing);

// Error unless the closed body keeps the gap (length) to its own periodic images and to all that
// exists: from nodes to triangles, as random packings do. The body is in one piece.
void check_body_clearance(const Mat3 &lattice, const SurfaceMesh &body, double gap,
                          const PackingObstacles &existing);

}    // namespace biem

#endif
