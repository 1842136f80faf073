// Signed distance to an axisymmetric body in its own frame, from a table over (rho, |z|).
// Knows one body; where it lies and what comes near it is the packing's business.
#ifndef BIEM_MESH_SIGNED_DISTANCE_H
#define BIEM_MESH_SIGNED_DISTANCE_H

#include "biem_mesh_shape.h"

#include <vector>

namespace biem {

struct SignedDistance {
  double value;    // length, negative inside
  Vec3 normal;     // gradient of the distance, unit length up to interpolation
};

class SignedDistanceTable {
 public:
  // The body is the shape times scale; larger distances than reach are given as reach.
  SignedDistanceTable(const Shape &shape, double scale, double reach);

  // point: in the frame of the body (symmetry axis z, center at the origin), length
  SignedDistance evaluate(const Vec3 &point) const;

  double bounding_radius() const { return bounding_radius_; }
  // Bound of the interpolation error of a value near the surface, length.
  double accuracy() const { return 2e-4 * bounding_radius_; }

 private:
  double compute_exact(double rho, double z) const;

  std::vector<MeridianPoint> meridian_;    // upper half, from the axis to the equator
  double reach_, bounding_radius_, spacing_;
  int n_rho_, n_z_;
  std::vector<double> value_;    // n_z x n_rho, rho fastest
};

}    // namespace biem

#endif
