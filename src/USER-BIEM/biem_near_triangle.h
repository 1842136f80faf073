// Closed-form integrals of the free-space Stokeslet and stresslet times a linear density over one
// flat triangle, at a pack of targets anywhere, on the triangle, its edges and vertices included.
// Knows nothing of meshes, periodicity or which pairs are near.
#ifndef BIEM_NEAR_TRIANGLE_H
#define BIEM_NEAR_TRIANGLE_H

#include "biem_simd.h"
#include "biem_types.h"

namespace biem {

// Points or vectors, one per lane.
struct PointPack {
  Pack x, y, z;
};

// Symmetric 3 x 3 matrices, one per lane.
struct TensorPack {
  Pack xx, xy, xz, yy, yz, zz;
};

// Geometry of a flat triangle in its own plane, computed once per configuration.
// Edge k runs from vertex k to vertex k+1; lengths in the user's units.
struct TriangleFrame {
  Vec3 origin, axis1, axis2, normal;    // vertex 0 and a right-handed orthonormal frame
  double vertex[3][2];                  // in-plane coordinates of the vertices
  double tangent[3][2];                 // unit tangents of the edges
  double outward[3][2];                 // in-plane outward normals of the edges
  double hat_gradient[3][2];            // gradients of the three linear hat functions
  double twice_area;
  double smallest_height;    // targets closer to the plane count as in it
};

// A linear density f in the triangle's frame: value at vertex 0, gradient B_ij = df_i/dx_j.
struct LinearDensity {
  double at_origin[3];
  double gradient[3][2];
  double divergence;    // B_11 + B_22
  // The in-plane part of B in the axes of each edge, n outward, t along it.
  double nn[3], nt[3], tt[3], shear[3];    // shear: nt + tn
};

TriangleFrame make_triangle_frame(const Vec3 &a, const Vec3 &b, const Vec3 &c);

// density: 3 x 3, column v = value at vertex v, in global axes.
LinearDensity make_linear_density(const TriangleFrame &frame, const Mat3 &density);

// Returns, in global axes, with r = target - y and n the triangle's normal,
//   int (I/r + rr/r^3) f(y) dA  [f] * length   of the single-layer density f   (Single, Both)
// + int -6 r (r.q)(r.n)/r^5 dA  [q]            of the double-layer density q   (Double, Both)
// The density that is not asked for may be null. In the triangle's plane the double layer is its
// principal value, 0. Only the layers asked for are paid for.
template <Layers layers>
PointPack integrate_near_triangle(const TriangleFrame &frame, const LinearDensity *single_layer,
                                  const LinearDensity *double_layer, const PointPack &targets);

// int -6 r r (r.n)/r^5 dA: the double layer of a uniform density, before the product with it.
TensorPack integrate_near_triangle_tensor(const TriangleFrame &frame, const PointPack &targets);

}    // namespace biem

#endif
