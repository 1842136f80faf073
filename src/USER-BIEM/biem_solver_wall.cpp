// Block-circulant inverse: a discrete Fourier transform over the shifts turns the response of the
// unit cell's nodes into one block per wave vector, which is inverted by itself.
#include "biem_solver_wall.h"
#include "biem_error.h"
#include <complex>
#include <cstdio>
#include <fftw3.h>

namespace biem {

namespace {

using Complex = std::complex<double>;

constexpr double kMemoryLimit = 2e9;          // bytes per rank while the blocks are inverted
constexpr double kLargestCondition = 1e11;    // double precision leaves no margin above

fftw_complex *to_fftw(Eigen::MatrixXcd &values)
{
  return reinterpret_cast<fftw_complex *>(values.data());
}

Points gather(PointsView values, const std::vector<int> &order)
{
  Points gathered(3, order.size());
  for (size_t i = 0; i < order.size(); i++)
    gathered.col(i) = values.col(order[i]);
  return gathered;
}

template <class Matrix> double compute_norm(const Matrix &matrix)
{
  return matrix.cwiseAbs().colwise().sum().maxCoeff();
}

// block := (P block P)^+ with P = 1 - N N^*, by the inverse of P block P + scale N N^*.
// scaling: sqrt(area) of the rows and columns. Returns the norms of the scaled block and of its
// inverse.
template <class Scalar>
std::array<double, 2> invert_block(double *data, const Eigen::VectorXd &scaling,
                                   const Eigen::Matrix<Scalar, -1, -1> &null)
{
  using Matrix = Eigen::Matrix<Scalar, -1, -1>;
  const Eigen::Index n = scaling.size();
  Eigen::Map<Matrix> block(reinterpret_cast<Scalar *>(data), n, n);
  block = scaling.asDiagonal() * block * scaling.cwiseInverse().asDiagonal();
  const double scale = block.diagonal().cwiseAbs().mean();
  if (null.cols() > 0) {
    block.noalias() -= null * (null.adjoint() * block).eval();
    block.noalias() -= (block * null).eval() * null.adjoint();
    block.noalias() += (scale * null) * null.adjoint();
  }
  const double norm = compute_norm(block);
  Eigen::PartialPivLU<Eigen::Ref<Matrix>> factors(block);
  const Matrix inverse = factors.inverse();
  const double inverse_norm = compute_norm(inverse);
  block = inverse;
  if (null.cols() > 0) block.noalias() -= (null / scale) * null.adjoint();
  block = scaling.cwiseInverse().asDiagonal() * block * scaling.asDiagonal();
  return {norm, inverse_norm};
}

}    // namespace

// Real values of all nodes by shift, as many columns at a time as the unit cell has unknowns.
// Estimated plans: measured ones may differ between ranks, and so would the last digits.
struct WallInverse::Transforms {
  fftw_plan forward = nullptr, backward = nullptr;
  std::array<int, 3> n;    // shifts, slowest first
  size_t n_waves;

  Transforms(const std::array<int, 3> &shifts, Eigen::Index n_block) :
      n(shifts), n_waves(static_cast<size_t>(n[0]) * n[1] * (n[2] / 2 + 1))
  {
    const int many = static_cast<int>(n_block);
    Eigen::MatrixXd real(n_block, n[0] * n[1] * n[2]);
    Eigen::MatrixXcd waves(n_block, n_waves);
    constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_UNALIGNED;
    forward = fftw_plan_many_dft_r2c(3, n.data(), many, real.data(), nullptr, many, 1,
                                     to_fftw(waves), nullptr, many, 1, kFlags);
    backward = fftw_plan_many_dft_c2r(3, n.data(), many, to_fftw(waves), nullptr, many, 1,
                                      real.data(), nullptr, many, 1, kFlags);
    if (!forward || !backward)
      throw Error("walls: FFTW could not plan a transform of " + std::to_string(n[0]) + " x " +
                  std::to_string(n[1]) + " x " + std::to_string(n[2]) + " shifts");
  }
  ~Transforms()
  {
    fftw_destroy_plan(forward);
    fftw_destroy_plan(backward);
  }
  Transforms(const Transforms &) = delete;
  Transforms &operator=(const Transforms &) = delete;

  Eigen::MatrixXcd transform(Points by_shift) const
  {
    Eigen::MatrixXcd waves(by_shift.size() / (n[0] * n[1] * n[2]), n_waves);
    fftw_execute_dft_r2c(forward, by_shift.data(), to_fftw(waves));
    return waves;
  }
};

WallInverse::WallInverse(const WallMesh &mesh, const WallResponse &response) :
    translations_(check_wall_mesh(mesh)), n_block_(3 * translations_.n_unit_nodes()),
    areas_(compute_nodal_areas(mesh))
{
  set_waves();
  check_size();
  set_null_vectors(mesh);
  blocks_.resize(first_.back());
  compute_blocks(response);
  invert_blocks();
}

WallInverse::~WallInverse() = default;

void WallInverse::set_waves()
{
  std::array<int, 3> n;
  for (int k = 0; k < 3; k++)
    n[k] = translations_.counts()[translations_.axes()[k]];
  transforms_ = std::make_unique<Transforms>(n, n_block_);
  const auto is_own_negative = [&n](int i, int k) {
    return 2 * i == n[k] || i == 0;
  };
  const size_t n_real = static_cast<size_t>(n_block_) * n_block_;
  first_.push_back(0);
  for (int i = 0; i < n[0]; i++)
    for (int j = 0; j < n[1]; j++)
      for (int k = 0; k <= n[2] / 2; k++) {
        is_real_.push_back(is_own_negative(i, 0) && is_own_negative(j, 1) && is_own_negative(k, 2));
        first_.push_back(first_.back() + (is_real_.back() ? n_real : 2 * n_real));
      }
}

void WallInverse::check_size() const
{
  size_t largest = 0;
  for (size_t w = 0; w + 1 < first_.size(); w++)
    largest = std::max(largest, first_[w + 1] - first_[w]);
  const double bytes = 8.0 * (static_cast<double>(first_.back()) + static_cast<double>(largest));
  if (bytes <= kMemoryLimit) return;
  char sizes[80];
  std::snprintf(sizes, sizeof sizes, "%.1f GB on every rank (limit %.1f GB)", bytes * 1e-9,
                kMemoryLimit * 1e-9);
  throw Error("walls: the inverse for " + std::to_string(areas_.size()) + " nodes (" + describe() +
              ") needs " + sizes + ": use fewer nodes, or a mesh that repeats itself along the " +
              "box (a lattice of equal triangles on a plane, equal rings of a tube)");
}

void WallInverse::set_null_vectors(const WallMesh &mesh)
{
  const Eigen::VectorXd roots = areas_.cwiseSqrt();
  null_vectors_ = compute_closed_sheets(mesh);
  Eigen::MatrixXd scaled(3 * areas_.size(), null_vectors_.size());
  for (size_t s = 0; s < null_vectors_.size(); s++) {
    null_vectors_[s] = null_vectors_[s] * areas_.cwiseInverse().asDiagonal();
    Eigen::Map<Points>(scaled.col(s).data(), 3, roots.size()) =
        null_vectors_[s] * roots.asDiagonal();
  }
  if (scaled.cols() == 0) {
    null_basis_ = scaled;
    return;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(scaled);
  null_basis_ = factors.householderQ() * Eigen::MatrixXd::Identity(scaled.rows(), factors.rank());
}

void WallInverse::compute_blocks(const WallResponse &response)
{
  Points density = Points::Zero(3, areas_.size());
  for (Eigen::Index column = 0; column < n_block_; column++) {
    double &unit = density(column % 3, translations_.order()[column / 3]);
    unit = 1.0;
    const Points velocities = response(density);
    unit = 0.0;
    if (velocities.cols() != areas_.size())
      throw Error("walls: the response has " + std::to_string(velocities.cols()) +
                  " velocities, not one for each of " + std::to_string(areas_.size()) + " nodes");
    store_response(velocities, column);
  }
}

// The unit density is at shift 0, so that the transform of its response is a column of the blocks.
void WallInverse::store_response(const Points &velocities, Eigen::Index column)
{
  const Eigen::MatrixXcd waves = transforms_->transform(gather(velocities, translations_.order()));
  for (size_t w = 0; w < is_real_.size(); w++)
    if (is_real_[w])
      Eigen::Map<Eigen::VectorXd>(block(w) + column * n_block_, n_block_) = waves.col(w).real();
    else
      Eigen::Map<Eigen::VectorXcd>(reinterpret_cast<Complex *>(block(w)) + column * n_block_,
                                   n_block_) = waves.col(w);
}

void WallInverse::invert_blocks()
{
  std::vector<Eigen::MatrixXcd> null_waves;
  const double unitary = 1.0 / std::sqrt(translations_.n_shifts());
  for (Eigen::Index s = 0; s < null_basis_.cols(); s++) {
    const Eigen::Map<const Points> vector(null_basis_.col(s).data(), 3, areas_.size());
    null_waves.push_back(unitary * transforms_->transform(gather(vector, translations_.order())));
  }
  Eigen::VectorXd scaling(n_block_);
  for (Eigen::Index i = 0; i < n_block_; i++)
    scaling[i] = std::sqrt(areas_[translations_.order()[i / 3]]);
  double norm = 0.0, inverse_norm = 0.0;
  for (size_t w = 0; w < is_real_.size(); w++) {
    // The closed sheets' span is invariant under the shifts, so that N N^* is a projection in each
    // block; it is zero unless the wave vector is, or shifts exchange sheets.
    Eigen::MatrixXcd null(n_block_, null_waves.size());
    for (size_t s = 0; s < null_waves.size(); s++)
      null.col(s) = null_waves[s].col(w);
    if (null.norm() < 1e-6) null.resize(n_block_, 0);
    const auto norms = is_real_[w] ? invert_block<double>(block(w), scaling, null.real())
                                   : invert_block<Complex>(block(w), scaling, null);
    if (!(norms[0] * norms[1] <= kLargestCondition))
      throw Error("walls: the equations for the force on the walls are singular: do two walls "
                  "touch or overlap without common nodes? Move them apart or merge their nodes");
    norm = std::max(norm, norms[0]);
    inverse_norm = std::max(inverse_norm, norms[1]);
  }
  condition_ = norm * inverse_norm;
}

Points WallInverse::apply(PointsView velocities) const
{
  if (velocities.cols() != areas_.size())
    throw Error("walls: " + std::to_string(velocities.cols()) + " velocities for " +
                std::to_string(areas_.size()) + " nodes");
  Eigen::MatrixXcd waves = transforms_->transform(gather(velocities, translations_.order()));
  Eigen::VectorXcd product(n_block_);
  for (size_t w = 0; w < is_real_.size(); w++) {
    if (is_real_[w]) {
      const Eigen::Map<const Eigen::MatrixXd> inverse(block(w), n_block_, n_block_);
      product.real().noalias() = inverse * waves.col(w).real();
      product.imag().setZero();    // as is that of the transform
    } else {
      const Eigen::Map<const Eigen::MatrixXcd> inverse(reinterpret_cast<const Complex *>(block(w)),
                                                       n_block_, n_block_);
      product.noalias() = inverse * waves.col(w);
    }
    waves.col(w) = product;
  }
  Points by_shift(3, areas_.size()), densities(3, areas_.size());
  fftw_execute_dft_c2r(transforms_->backward, to_fftw(waves), by_shift.data());
  for (Eigen::Index i = 0; i < areas_.size(); i++)
    densities.col(translations_.order()[i]) = by_shift.col(i) / translations_.n_shifts();
  return densities;
}

Points WallInverse::remove_null_part(PointsView values) const
{
  const Eigen::VectorXd roots = areas_.cwiseSqrt();
  Points scaled = values * roots.asDiagonal();
  Eigen::Map<Eigen::VectorXd> vector(scaled.data(), scaled.size());
  vector -= null_basis_ * (null_basis_.transpose() * vector).eval();
  return scaled * roots.cwiseInverse().asDiagonal();
}

std::string WallInverse::describe() const
{
  const char *names[3] = {"x", "y", "z"};
  const std::array<int, 3> &counts = translations_.counts();
  std::string shifts, axes;
  int n_axes = 0;
  for (int k = 0; k < 3; k++) {
    if (counts[k] == 1) continue;
    shifts += (n_axes ? " x " : "") + std::to_string(counts[k]);
    axes += std::string(n_axes ? ", " : "") + names[k];
    n_axes++;
  }
  if (n_axes == 0) return "dense, " + std::to_string(areas_.size()) + " nodes";
  const int n_unit = translations_.n_unit_nodes();
  if (n_axes == 2 && n_unit == 1) return "lattice sheet " + shifts + ": 2D FFT";
  return shifts + " shifts along " + axes + ", " + std::to_string(n_unit) +
         (n_unit == 1 ? " node each" : " nodes each");
}

}    // namespace biem
