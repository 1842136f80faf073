// One closed surface as dense matrices: see the header.
#include "biem_operator_body.h"
#include <cmath>

namespace biem {

namespace {

constexpr int kModes = 7;    // three translations, three rotations, the flux

// All nodes are here: nothing to exchange.
class Alone : public NodeExchange {
 public:
  void forward(double *, int) override {}
  void reverse_add(double *, int) override {}
  void sum(double *, int) override {}
};

}    // namespace

BodyOperator::BodyOperator(PointsView nodes, const std::vector<Triangle> &triangles) :
    nodes_(nodes), triangles_(triangles)
{
  const Eigen::Index n = nodes.cols();
  elements_.set_geometry(nodes_, triangles_);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  Points gradient = Points::Zero(3, n);
  elements_.add_nodal_areas(areas);
  elements_.add_volume_gradient(gradient);
  Alone alone;
  modes_.set_geometry(std::vector<int>(n, 0), 1, nodes_, areas, gradient, elements_, n, alone);
}

SurfaceMotion BodyOperator::compute_motion(PointsView field) const
{
  Alone alone;
  return modes_.compute_motions(field, alone)[0];
}

// One source point of the far rule with its normal times area; its density is the mean of those of
// the columns. Three columns per node, so that the targets are contiguous.
void BodyOperator::add_point(const Vec3 &source, const Vec3 &normal, const int *columns,
                             int n_columns, Eigen::MatrixXd &matrix) const
{
  const Eigen::Index n = n_nodes(), rows = matrix.rows();
  for (Eigen::Index i = 0; i < n; i++) {
    const Vec3 r = nodes_.col(i) - source;
    const double r2 = r.squaredNorm();
    if (r2 == 0.0) continue;    // the node itself: its own term drops out with the row sums
    const double factor = -6.0 * r.dot(normal) / (n_columns * r2 * r2 * std::sqrt(r2));
    const Mat3 block = (factor * r) * r.transpose();
    for (int v = 0; v < n_columns; v++) {
      double *first = matrix.data() + 3 * columns[v] * rows + 3 * i;
      for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
          first[c * rows + k] += block(k, c);
    }
  }
}

BodyOperator::FarPoints BodyOperator::compute_far_points() const
{
  const Eigen::Index n = n_nodes(), n_elements = elements_.n_elements();
  FarPoints far;
  far.points = Points(3, n + n_elements);
  far.normals = Points::Zero(3, n + n_elements);
  far.points.leftCols(n) = nodes_;
  elements_.add_nodal_normals(far.normals.leftCols(n));
  elements_.compute_interior_points(far.points.rightCols(n_elements));
  elements_.compute_interior_normals(far.normals.rightCols(n_elements));
  return far;
}

void BodyOperator::add_far_rule(Eigen::MatrixXd &matrix) const
{
  const FarPoints far = compute_far_points();
  const int n = static_cast<int>(n_nodes()), n_elements = elements_.n_elements();
  for (int j = 0; j < n; j++)
    add_point(far.points.col(j), far.normals.col(j), &j, 1, matrix);
  for (int e = 0; e < n_elements; e++)
    add_point(far.points.col(n + e), far.normals.col(n + e), triangles_[e].data(), 3, matrix);
}

// Every element by itself with the nine unit densities at its corners.
void BodyOperator::add_near_rule(Eigen::MatrixXd &matrix) const
{
  const NearCandidates near = find_near_candidates(elements_, nodes_);
  FlatElements element;
  std::vector<int> targets;
  for (int e = 0; e < elements_.n_elements(); e++) {
    const int n = near.start[e + 1] - near.start[e], *node = near.node.data() + near.start[e];
    Points points(3, 3 + n), density = Points::Zero(3, 3 + n);
    for (int v = 0; v < 3; v++)
      points.col(v) = nodes_.col(triangles_[e][v]);
    targets.resize(n);
    for (int k = 0; k < n; k++) {
      points.col(3 + k) = nodes_.col(node[k]);
      targets[k] = 3 + k;
    }
    element.set_geometry(points, {{0, 1, 2}});
    for (int v = 0; v < 3; v++)
      for (int c = 0; c < 3; c++) {
        density(c, v) = 1.0;
        element.prepare_near(Points(3, 0), density);
        Points velocity = Points::Zero(3, 3 + n);
        element.add_near_corrections(0, targets.data(), n, points, velocity);
        for (int k = 0; k < n; k++)
          matrix.col(3 * triangles_[e][v] + c).segment<3>(3 * node[k]) += velocity.col(3 + k);
        density(c, v) = 0.0;
      }
  }
}

Eigen::MatrixXd BodyOperator::compute_double_layer() const
{
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * n_nodes(), 3 * n_nodes());
  add_far_rule(matrix);
  add_near_rule(matrix);
  return matrix;
}

RowSums BodyOperator::compute_row_sums() const
{
  const Eigen::Index n = n_nodes();
  const FarPoints far = compute_far_points();
  RowSums sums(n, Mat3::Zero());
  for (Eigen::Index i = 0; i < n; i++)
    for (Eigen::Index s = 0; s < far.points.cols(); s++) {
      const Vec3 r = nodes_.col(i) - far.points.col(s);
      const double r2 = r.squaredNorm();
      if (r2 == 0.0) continue;
      const double factor = -6.0 * r.dot(far.normals.col(s)) / (r2 * r2 * std::sqrt(r2));
      sums[i] += (factor * r) * r.transpose();
    }
  FlatElements elements = elements_;
  const NearCandidates near = find_near_candidates(elements, nodes_);
  for (int c = 0; c < 3; c++) {
    const Points uniform = Vec3::Unit(c).replicate(1, n);
    elements.prepare_near(Points(3, 0), uniform);
    Points velocity = Points::Zero(3, n);
    add_near_corrections(elements, near, nodes_, velocity);
    for (Eigen::Index i = 0; i < n; i++)
      sums[i].col(c) += velocity.col(i);
  }
  return sums;
}

void BodyOperator::subtract_singularity(const RowSums &row_sums, Eigen::MatrixXd &matrix)
{
  for (size_t i = 0; i < row_sums.size(); i++)
    matrix.block<3, 3>(3 * i, 3 * i) -= row_sums[i];
}

void BodyOperator::complete(Eigen::MatrixXd &matrix) const
{
  const Eigen::Index n = n_nodes();
  // The modes, and their amplitudes in a field, as matrices.
  Eigen::MatrixXd modes(3 * n, kModes), amplitudes(kModes, 3 * n);
  for (int m = 0; m < kModes; m++) {
    SurfaceMotion motion;
    if (m < 3)
      motion.velocity[m] = 1.0;
    else if (m < 6)
      motion.rotation[m - 3] = 1.0;
    else
      motion.flux = 1.0;
    for (Eigen::Index i = 0; i < n; i++)
      modes.col(m).segment<3>(3 * i) =
          modes_.compute_rigid(motion, i) + modes_.compute_normal(motion, i);
  }
  Points unit = Points::Zero(3, n);
  for (Eigen::Index j = 0; j < 3 * n; j++) {
    unit.data()[j] = 1.0;
    const SurfaceMotion motion = compute_motion(unit);
    amplitudes.col(j).head<3>() = motion.velocity;
    amplitudes.col(j).segment<3>(3) = motion.rotation;
    amplitudes(6, j) = motion.flux;
    unit.data()[j] = 0.0;
  }
  matrix *= -1.0 / (8.0 * M_PI);
  modes -= matrix * modes;
  matrix.noalias() += modes * amplitudes;
}

}    // namespace biem
