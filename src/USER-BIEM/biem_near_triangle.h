// Closed-form integral of the free-space Stokeslet times a linear density over one flat triangle,
// for any target, on the triangle, on its edges and vertices included.
// Knows nothing of meshes, periodicity or which pairs are near.
#ifndef BIEM_NEAR_TRIANGLE_H
#define BIEM_NEAR_TRIANGLE_H

#include "biem_types.h"

namespace biem {

// Geometry of a flat triangle in its own plane, computed once per configuration.
// Edge k runs from vertex k to vertex k+1; lengths in the user's units.
struct TriangleFrame {
  Vec3 origin, axis1, axis2, normal;    // vertex 0 and a right-handed orthonormal frame
  double vertex[3][2];                  // in-plane coordinates of the vertices
  double tangent[3][2];                 // unit tangents of the edges
  double outward[3][2];                 // in-plane outward normals of the edges
  double hat_gradient[3][2];            // gradients of the three linear hat functions
  double twice_area;
};

// A linear density in the triangle's frame: value at vertex 0 and in-plane gradient.
struct LinearDensity {
  double at_origin[3];
  double gradient[3][2];
};

TriangleFrame make_triangle_frame(const Vec3 &a, const Vec3 &b, const Vec3 &c);

// density: 3 x 3, column v = value at vertex v, in global axes.
LinearDensity make_linear_density(const TriangleFrame &frame, const Mat3 &density);

// Returns int S(target - y) f(y) dA(y), global axes; [density] * length.
Vec3 compute_single_layer(const TriangleFrame &frame, const LinearDensity &density,
                          const Vec3 &target);

}    // namespace biem

#endif
