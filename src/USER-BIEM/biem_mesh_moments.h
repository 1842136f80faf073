// Exact volume and surface moments of a closed polyhedron of flat triangles, and the cell shape
// (centroid, axes, inclination, deformation) that follows. Knows neither meshes nor LAMMPS.
#ifndef BIEM_MESH_MOMENTS_H
#define BIEM_MESH_MOMENTS_H

#include "biem_types.h"

namespace biem {

// Sums over triangles, about an origin near the cell (far from it digits cancel). Sums of sums are
// sums: partial results of several processes may be added value by value (n_values doubles).
// Tensors are stored as xx yy zz xy xz yz.
struct MeshMoments {
  static constexpr int n_values = 20;
  double volume = 0.0;                // length^3
  double area = 0.0;                  // length^2
  double volume_first[3] = {};        // integral of x dV, length^4
  double volume_second[6] = {};       // integral of x x dV, length^5
  double area_first[3] = {};          // integral of x dA, length^3
  double area_second[6] = {};         // integral of x x dA, length^4
};
static_assert(sizeof(MeshMoments) == MeshMoments::n_values * sizeof(double), "plain doubles");

// Adds one triangle, counter-clockwise seen from outside; returns its area, length^2.
double add_triangle_moments(const Vec3 &x0, const Vec3 &x1, const Vec3 &x2, MeshMoments &moments);

// Angles in degrees. The shear plane is x-z, the flow is along x.
struct CellShape {
  Vec3 centroid;                  // of the volume, relative to the origin of the moments
  Vec3 semi_axes;                 // of the ellipsoid of equal solid inertia, longest first
  Vec3 axis;                      // unit; smallest eigenvalue of the surface moment of inertia
  double inclination_in_plane;    // of the surface's longest direction in the shear plane, (-90,90]
  double inclination;             // between axis and flow direction, [0, 90]
  double ellipsoid_angle;         // of the long axis of the ellipsoid's shear-plane cut, (-90, 90]
  double deformation;             // (L1-L2)/(L1+L2) of that cut (Taylor parameter D12)
};

// Error if the volume is not positive (triangles clockwise from outside, or an open mesh).
CellShape compute_cell_shape(const MeshMoments &moments);

}    // namespace biem

#endif
