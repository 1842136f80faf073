// Kinematics of one flat membrane triangle, for any in-plane law W(I1, I2) per reference area.
// Knows no law: a law is a class with compute_density(I1, I2), e.g. biem_membrane_skalak.h.
#ifndef BIEM_MEMBRANE_TRIANGLE_H
#define BIEM_MEMBRANE_TRIANGLE_H

#include "biem_types.h"

namespace biem {

using TriangleNodes = std::array<Vec3, 3>;    // positions, length

// Gram matrix of the edges 1-0 and 2-0, length^2.
inline Eigen::Matrix2d compute_metric(const TriangleNodes &nodes)
{
  const Vec3 edge1 = nodes[1] - nodes[0], edge2 = nodes[2] - nodes[0];
  Eigen::Matrix2d metric;
  metric << edge1.squaredNorm(), edge1.dot(edge2), edge1.dot(edge2), edge2.squaredNorm();
  return metric;
}

inline double compute_area(const TriangleNodes &nodes)
{
  return 0.5 * (nodes[1] - nodes[0]).cross(nodes[2] - nodes[0]).norm();
}

// True if the nodes are on one line (to 1e-10 of the edges) or not finite.
inline bool is_degenerate(const TriangleNodes &nodes)
{
  const double size = compute_metric(nodes).trace();
  return !(compute_area(nodes) > 1e-10 * size);    // written so that NaN is degenerate, too
}

// What the unstressed triangle contributes. The metric replaces the 2 x 2 shape matrix: it needs
// no in-plane axes, so an energy cannot depend on how they were chosen.
struct ReferenceTriangle {
  Eigen::Matrix2d metric;            // length^2
  Eigen::Matrix2d inverse_metric;    // 1/length^2
  double area;                       // length^2
};

// Not finite for a degenerate triangle; the caller checks, since it can name the triangle.
inline ReferenceTriangle compute_reference_triangle(const TriangleNodes &reference)
{
  const Eigen::Matrix2d metric = compute_metric(reference);
  return {metric, metric.inverse(), compute_area(reference)};
}

// Strain energy density at the invariants I1 = l1^2 + l2^2 - 2, I2 = l1^2 l2^2 - 1.
struct EnergyDensity {
  double value, dI1, dI2;    // energy/length^2; derivatives with respect to I1 and I2
};

struct TriangleResponse {
  double energy;
  std::array<Vec3, 3> force;    // on the nodes, -d(energy)/d(node)
};

// Virtual work of a linear displacement field (Zhao et al. 2012, Eq. 9): the invariants are
// functions of the two edge vectors only, I1 = tr(G^-1 g) - 2 and I2 = det g / det G - 1. They are
// computed from the change g - G, so that small strains keep their digits.
template <class Law>
TriangleResponse compute_triangle_response(const Law &law, const ReferenceTriangle &reference,
                                           const TriangleNodes &nodes)
{
  const Vec3 edge1 = nodes[1] - nodes[0], edge2 = nodes[2] - nodes[0];
  const Eigen::Matrix2d metric = compute_metric(nodes);
  const Eigen::Matrix2d &inverse = reference.inverse_metric;
  const double inverse_determinant = inverse.determinant();
  const Eigen::Matrix2d change = metric - reference.metric;
  const double i1 = inverse.cwiseProduct(change).sum();
  const double i2 = i1 + change.determinant() * inverse_determinant;
  const EnergyDensity density = law.compute_density(i1, i2);

  const double a = 2.0 * reference.area * density.dI1;
  const double b = 2.0 * reference.area * density.dI2 * inverse_determinant;
  TriangleResponse response;
  response.energy = reference.area * density.value;
  response.force[1] = -(a * inverse(0, 0) + b * metric(1, 1)) * edge1 -
      (a * inverse(0, 1) - b * metric(0, 1)) * edge2;
  response.force[2] = -(a * inverse(0, 1) - b * metric(0, 1)) * edge1 -
      (a * inverse(1, 1) + b * metric(0, 0)) * edge2;
  response.force[0] = -(response.force[1] + response.force[2]);
  return response;
}

}    // namespace biem

#endif
