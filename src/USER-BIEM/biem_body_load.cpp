// Force density of a driven rigid body: see the header.
#include "biem_body_load.h"
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_rigid_motion.h"

namespace biem {

namespace {

Mat3 make_cross_product(const Vec3 &x)
{
  Mat3 m;
  m << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return m;
}

}    // namespace

BodyLoad::BodyLoad(PointsView nodes, const std::vector<Triangle> &triangles)
{
  FlatElements elements;
  elements.set_geometry(nodes, triangles);
  const Eigen::Index n = nodes.cols();
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  Points gradient = Points::Zero(3, n), mass_relative = Points::Zero(3, n);
  elements.add_nodal_areas(areas);
  elements.add_volume_gradient(gradient);
  relative_ = nodes.colwise() - Vec3(nodes * areas / areas.sum());
  elements.add_mass_product(relative_, mass_relative);

  const Points to_volume = nodes.colwise() - compute_volume_centroid(nodes, triangles);
  weights_ = to_volume.cwiseProduct(gradient).colwise().sum().transpose().cwiseQuotient(areas);
  if (!(weights_.minCoeff() > 0.0)) weights_.setOnes();

  // Force and torque of linear densities, the torque with the consistent mass matrix.
  Eigen::Matrix<double, 6, 6> loads = Eigen::Matrix<double, 6, 6>::Zero();
  for (Eigen::Index i = 0; i < n; i++) {
    const Mat3 arm = make_cross_product(mass_relative.col(i));
    const Mat3 turn = -make_cross_product(relative_.col(i));    // b to b x
    loads.topLeftCorner<3, 3>() += weights_[i] * areas[i] * Mat3::Identity();
    loads.topRightCorner<3, 3>() += weights_[i] * areas[i] * turn;
    loads.bottomLeftCorner<3, 3>() += weights_[i] * arm;
    loads.bottomRightCorner<3, 3>() += weights_[i] * arm * turn;
  }
  inverse_ = loads.inverse();
  if (!inverse_.allFinite())
    throw Error("rigid body of " + std::to_string(n) +
                " nodes: it has no extension, no torque can act on it; check its nodes");
}

BodyLoad::Coefficients BodyLoad::solve(const Vec3 &force, const Vec3 &torque) const
{
  Eigen::Matrix<double, 6, 1> load;
  load << force, torque;
  const Eigen::Matrix<double, 6, 1> solution = inverse_ * load;
  return {solution.head<3>(), solution.tail<3>()};
}

}    // namespace biem
