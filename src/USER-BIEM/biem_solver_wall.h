// Inverse of the walls' single layer, computed once for walls at rest in a cell that keeps its
// shape: densities from velocities. Uses the translations that map the walls onto themselves, so
// that lattice walls cost Fourier transforms and small blocks only. Knows no kernel, no other
// surfaces and no ranks: a callable gives the velocities. doc/theory, label walls.
#ifndef BIEM_SOLVER_WALL_H
#define BIEM_SOLVER_WALL_H

#include "biem_mesh_sheets.h"
#include "biem_mesh_translations.h"
#include <functional>
#include <memory>
#include <string>

namespace biem {

// Velocities (3 x n) at all wall nodes that densities (3 x n, force per area) there cause; the same
// on every rank. May be collective.
using WallResponse = std::function<Points(const Points &densities)>;

// A uniform pressure jump across a closed sheet moves no fluid, and a flux through it cannot be
// driven. So for A the response, N the null vectors, orthonormal in the product with the nodal
// areas: apply() gives the f without part along N for which A f - v is along N.
class WallInverse {
 public:
  // Calls response 3 times the nodes of the translations' unit cell. Everything is replicated:
  // collective if response is, same errors on every rank.
  WallInverse(const WallMesh &mesh, const WallResponse &response);
  ~WallInverse();

  // 3 x n velocities to 3 x n densities. Local.
  Points apply(PointsView velocities) const;

  // Pressure jumps of 1, as densities: at a node the mean of the closed sheet's normal over the
  // nodal area. Not orthonormal where sheets cross.
  const std::vector<Points> &null_vectors() const { return null_vectors_; }
  const Eigen::VectorXd &areas() const { return areas_; }
  // Velocities or densities without their part along the null vectors: v - N N^T a v.
  Points remove_null_part(PointsView values) const;

  // Estimate in the 1-norm, the largest block's, in unknowns scaled by sqrt(area).
  double condition() const { return condition_; }
  // For instance "lattice sheet 64 x 36: 2D FFT" or "64 shifts along x, 45 nodes each".
  std::string describe() const;

 private:
  struct Transforms;

  double *block(size_t wave) { return blocks_.data() + first_[wave]; }
  const double *block(size_t wave) const { return blocks_.data() + first_[wave]; }
  void set_waves();
  void check_size() const;
  void set_null_vectors(const WallMesh &mesh);
  void compute_blocks(const WallResponse &response);
  void store_response(const Points &velocities, Eigen::Index column);
  void invert_blocks();

  MeshTranslations translations_;
  Eigen::Index n_block_;    // unknowns of the unit cell
  Eigen::VectorXd areas_;
  std::vector<Points> null_vectors_;
  Eigen::MatrixXd null_basis_;    // 3n x n_null, orthonormal, times sqrt(area)
  std::unique_ptr<Transforms> transforms_;
  // Per wave vector of the half-complex transform: a block of n_block^2 numbers, real where the
  // wave vector is its own negative, complex elsewhere.
  std::vector<double> blocks_;
  std::vector<size_t> first_;
  std::vector<char> is_real_;
  double condition_ = 1.0;
};

}    // namespace biem

#endif
