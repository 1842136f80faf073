// Inverse of one body's operator: see the header.
#include "biem_solver_body.h"
#include "biem_error.h"

namespace biem {

BodyInverse::BodyInverse(PointsView nodes, const std::vector<Triangle> &triangles) :
    operator_(nodes, triangles), row_sums_(operator_.compute_row_sums())
{
  if (3 * n_nodes() > kMostDenseUnknowns) return;
  Eigen::MatrixXd matrix = operator_.compute_double_layer();
  BodyOperator::subtract_singularity(row_sums_, matrix);
  operator_.complete(matrix);
  // Well conditioned: single precision keeps six digits, far more than a preconditioner needs.
  const Eigen::PartialPivLU<Eigen::MatrixXf> factors(matrix.cast<float>());
  inverse_ = factors.inverse();
  if (!inverse_.allFinite())
    throw Error("rigid body of " + std::to_string(n_nodes()) +
                " nodes: its double-layer operator is singular; check that its triangles form one "
                "closed surface");
}

Points BodyInverse::apply(PointsView velocity) const
{
  return apply(Mat3::Identity(), velocity);
}

Points BodyInverse::apply(const Mat3 &rotation, PointsView velocity) const
{
  if (velocity.cols() != n_nodes())
    throw Error("inverse of a rigid body of " + std::to_string(n_nodes()) + " nodes: got " +
                std::to_string(velocity.cols()) + " velocities; give one for each node");
  Points in_body = rotation.transpose() * velocity;
  if (is_dense()) {
    const Eigen::VectorXf right_hand_side = in_body.reshaped().cast<float>();
    Eigen::VectorXf solution = inverse_ * right_hand_side;
    in_body.reshaped() = solution.cast<double>();
  } else {
    const SurfaceMotion motion = operator_.compute_motion(in_body);
    const SurfaceModes &modes = operator_.modes();
    for (Eigen::Index i = 0; i < n_nodes(); i++)
      in_body.col(i) =
          apply_spectral_inverse(1.0, 2.0, in_body.col(i), modes.compute_rigid(motion, i),
                                 modes.compute_normal(motion, i));
  }
  return rotation * in_body;
}

}    // namespace biem
