// Inverse of the completed double-layer operator of one rigid body alone in free space, in its body
// frame: the preconditioner of a rigid particle. And the same for a cell of another inside
// viscosity, from the spectrum alone. Knows no other surfaces, no periodicity and no time.
#ifndef BIEM_SOLVER_BODY_H
#define BIEM_SOLVER_BODY_H

#include "biem_operator_body.h"

namespace biem {

// Unknowns of the largest body that gets a dense inverse (19 MB).
constexpr Eigen::Index kMostDenseUnknowns = 2200;

// Made once per shape: bodies of equal shape share it. Beyond kMostDenseUnknowns the inverse is
// that of the operator's spectrum: 1 on the rigid and the flux part, 1/2 on the rest, where the
// eigenvalues cluster (sphere: 0.2 to 0.6; an oblate spheroid of aspect ratio 1/4: 0.015 to 0.9).
class BodyInverse {
 public:
  // nodes: 3 x n in the body frame.
  BodyInverse(PointsView nodes, const std::vector<Triangle> &triangles);

  Eigen::Index n_nodes() const { return operator_.n_nodes(); }
  bool is_dense() const { return inverse_.size() > 0; }
  // Of the body's double layer on itself, one per node; body frame, constant in time.
  const RowSums &row_sums() const { return row_sums_; }

  // 3 x n from 3 x n: the density psi whose A psi is the velocity, to single precision if dense.
  // In the body frame, and in the lab frame of a body with this rotation from body to lab frame.
  Points apply(PointsView velocity) const;
  Points apply(const Mat3 &rotation, PointsView velocity) const;

 private:
  BodyOperator operator_;
  RowSums row_sums_;
  Eigen::MatrixXf inverse_;    // single precision: reading it is what takes the time
};

// Approximate inverse of a surface's own operator at a node: rigid part times 1, flux part times
// flux_factor, rest times rest_factor. value includes the parts rigid and normal.
inline Vec3 apply_spectral_inverse(double flux_factor, double rest_factor, const Vec3 &value,
                                   const Vec3 &rigid, const Vec3 &normal)
{
  return rigid + flux_factor * normal + rest_factor * (value - rigid - normal);
}

// The cell of viscosity ratio lambda, u + (lambda - 1) (u_flux - D0[u~]/(8 pi)): its eigenvalues
// are 1 on rigid motions, lambda on the flux, and cluster at (1 + lambda)/2.
inline Vec3 precondition_contrast(double viscosity_ratio, const Vec3 &value, const Vec3 &rigid,
                                  const Vec3 &normal)
{
  return apply_spectral_inverse(1.0 / viscosity_ratio, 2.0 / (1.0 + viscosity_ratio), value, rigid,
                                normal);
}

}    // namespace biem

#endif
