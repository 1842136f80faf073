// One closed rigid surface alone in free space, as dense matrices: its subtracted double layer D0
// on itself, and the completed operator whose solution is a rigid particle's density,
//   A psi = Pi psi + alpha g/A - D0[psi - Pi psi - alpha g/A]/(8 pi),
// Pi psi the rigid part and alpha g/A the flux part of SurfaceModes. Same elements, far and near
// rules as LayerOperator. Knows no other surfaces, no periodicity and no time.
// Zhao et al. 2012, Sec. II; doc/theory, label rigid-particles.
#ifndef BIEM_OPERATOR_BODY_H
#define BIEM_OPERATOR_BODY_H

#include "biem_element_flat.h"
#include "biem_operator_layers.h"
#include "biem_surface_modes.h"

namespace biem {

class BodyOperator {
 public:
  // nodes: 3 x n of one closed surface in one piece. Throws Error on a degenerate surface.
  BodyOperator(PointsView nodes, const std::vector<Triangle> &triangles);

  Eigen::Index n_nodes() const { return nodes_.cols(); }
  const SurfaceModes &modes() const { return modes_; }    // of the one surface, number 0
  SurfaceMotion compute_motion(PointsView field) const;

  // The double layer of uniform densities at each node, without any matrix.
  RowSums compute_row_sums() const;
  // 3n x 3n, of x0 y0 z0 x1 ...: the principal value of the faceted surface.
  Eigen::MatrixXd compute_double_layer() const;
  // The double layer becomes D0.
  static void subtract_singularity(const RowSums &row_sums, Eigen::MatrixXd &matrix);
  // D0 becomes A.
  void complete(Eigen::MatrixXd &matrix) const;

 private:
  struct FarPoints {
    Points points, normals;    // nodes, then interior points; normals times area
  };
  FarPoints compute_far_points() const;
  void add_far_rule(Eigen::MatrixXd &matrix) const;
  void add_near_rule(Eigen::MatrixXd &matrix) const;
  void add_point(const Vec3 &source, const Vec3 &normal, const int *columns, int n_columns,
                 Eigen::MatrixXd &matrix) const;

  Points nodes_;
  std::vector<Triangle> triangles_;
  FlatElements elements_;
  SurfaceModes modes_;
};

}    // namespace biem

#endif
