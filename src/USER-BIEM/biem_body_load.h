// The force density by which a rigid body of given shape passes a force and a torque on to the
// fluid, in its body frame: w (a + b x), with w the distance of the tangent plane from the centroid
// of the volume, which is the exact traction of a translating ellipsoid. Knows no flow.
// doc/theory, label rigid-particles.
#ifndef BIEM_BODY_LOAD_H
#define BIEM_BODY_LOAD_H

#include "biem_types.h"

namespace biem {

class BodyLoad {
 public:
  // nodes: 3 x n of one closed surface in one piece. Where w is not positive everywhere, w = 1.
  BodyLoad(PointsView nodes, const std::vector<Triangle> &triangles);

  struct Coefficients {
    Vec3 a, b;
  };
  // torque: about the centroid of the surface.
  Coefficients solve(const Vec3 &force, const Vec3 &torque) const;
  // Force per area at a node.
  Vec3 compute_density(const Coefficients &c, Eigen::Index node) const
  {
    return weights_[node] * (c.a + c.b.cross(relative_.col(node)));
  }

 private:
  Points relative_;    // to the centroid of the surface
  Eigen::VectorXd weights_;
  Eigen::Matrix<double, 6, 6> inverse_;    // (a, b) from (force, torque)
};

}    // namespace biem

#endif
