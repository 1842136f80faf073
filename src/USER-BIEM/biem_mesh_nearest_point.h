// The point of a triangle that is nearest to a given point. Knows one triangle, not its surface.
#ifndef BIEM_MESH_NEAREST_POINT_H
#define BIEM_MESH_NEAREST_POINT_H

#include "biem_types.h"

namespace biem {

// Barycentric weights of the point of the triangle (a, b, c) that is nearest to p. Weights that are
// not exactly 0 name the feature that holds it: three the face, two an edge, one a corner.
Vec3 compute_nearest_weights(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c);

}    // namespace biem

#endif
