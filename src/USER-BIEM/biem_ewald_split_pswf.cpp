// PSWF split: see the header. psi is expanded in even Legendre polynomials, whose coefficients are
// an eigenvector of a tridiagonal matrix (Xiao, Rokhlin & Yarvin, Inverse Problems 17, 805 (2001)).
#include "biem_ewald_split_pswf.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

constexpr int kQuadraturePoints = 96;    // exact to rounding for c t up to 120

// Sum of Legendre series by Clenshaw's recurrence.
double evaluate_legendre(const std::vector<double> &c, double t)
{
  double b1 = 0.0, b2 = 0.0;
  for (int n = static_cast<int>(c.size()) - 1; n >= 1; n--) {
    const double b = c[n] + (2.0 * n + 1.0) / (n + 1.0) * t * b1 - (n + 1.0) / (n + 2.0) * b2;
    b2 = b1;
    b1 = b;
  }
  return c[0] + t * b1 - 0.5 * b2;
}

// Gauss-Legendre nodes and weights on [0, 1]: eigenvalues of the Jacobi matrix (Golub & Welsch,
// Math. Comput. 23, 221 (1969)).
Eigen::MatrixX2d make_gauss_legendre(int n)
{
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n), off(n - 1);
  for (int i = 1; i < n; i++)
    off[i - 1] = i / std::sqrt(4.0 * i * i - 1.0);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off);
  Eigen::MatrixX2d rule(n, 2);
  rule.col(0) = 0.5 * (solver.eigenvalues().array() + 1.0);
  rule.col(1) = solver.eigenvectors().row(0).transpose().array().square();
  return rule;
}

// P_n' = (2n - 1) P_{n-1} + (2n - 5) P_{n-3} + ...
std::vector<double> differentiate_legendre(const std::vector<double> &c)
{
  std::vector<double> result(c.size(), 0.0);
  for (int n = static_cast<int>(c.size()) - 1; n >= 1; n--)
    for (int m = n - 1; m >= 0; m -= 2)
      result[m] += (2.0 * m + 1.0) * c[n];
  return result;
}

std::vector<double> expand_wave_function(double c)
{
  const int n = 40 + static_cast<int>(c);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; i++) {
    const double k = 2.0 * i;
    matrix(i, i) = k * (k + 1) + (2 * k * (k + 1) - 1) / ((2 * k + 3) * (2 * k - 1)) * c * c;
    if (i + 1 < n)
      matrix(i, i + 1) = matrix(i + 1, i) =
          (k + 2) * (k + 1) / ((2 * k + 3) * std::sqrt((2 * k + 1) * (2 * k + 5))) * c * c;
  }
  const Eigen::VectorXd lowest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvectors().col(0);
  std::vector<double> result(2 * n, 0.0);
  for (int i = 0; i < n; i++)
    result[2 * i] = lowest[i] * std::sqrt(2.0 * i + 0.5);
  return result;
}

}    // namespace

PswfSplit::PswfSplit(double bandwidth, double cutoff) :
    bandwidth_(bandwidth), cutoff_(cutoff), wave_(expand_wave_function(bandwidth)),
    derivative_(differentiate_legendre(wave_)), at_zero_(evaluate_legendre(wave_, 0.0)),
    total_(2.0 * wave_[0])
{
  static const Eigen::MatrixX2d rule = make_gauss_legendre(kQuadraturePoints);
  nodes_ = rule.col(0);
  weights_ = rule.col(1);
  weighted_wave_ = weights_;
  for (Eigen::Index i = 0; i < nodes_.size(); i++)
    weighted_wave_[i] *= evaluate_legendre(wave_, nodes_[i]);
}

// psi is its own finite Fourier transform, int_{-1}^{1} psi(x) cos(c t x) dx = lambda psi(t): so it
// goes on beyond t = 1, where its Legendre series does not.
double PswfSplit::continue_wave(double t, double &derivative) const
{
  const Eigen::ArrayXd phase = bandwidth_ * t * nodes_.array();
  const double scale = at_zero_ / weighted_wave_.sum();
  derivative = -scale * bandwidth_ * (weighted_wave_.array() * nodes_.array() * phase.sin()).sum();
  return scale * (weighted_wave_.array() * phase.cos()).sum();
}

double PswfSplit::fourier_factor(double k2) const
{
  const double t = std::sqrt(k2) * cutoff_ / bandwidth_;
  double value, slope;
  if (t <= 1.0) {
    value = evaluate_legendre(wave_, t);
    slope = evaluate_legendre(derivative_, t);
  } else {
    value = continue_wave(t, slope);
  }
  return (value - 0.5 * t * slope) / at_zero_;
}

// The whole integral (8/3 pi) int gamma dk over all k is the Stokeslet's remainder 2 P at r = 0.
double PswfSplit::truncated_self(double k_max) const
{
  double kept = 0.0;
  for (Eigen::Index i = 0; i < nodes_.size(); i++)
    kept += weights_[i] * k_max * fourier_factor(std::pow(nodes_[i] * k_max, 2));
  return 2.0 * mollified_slope(0.0) - 8.0 / (3.0 * M_PI) * kept;
}

// B'(r)/r = (2/total) (1/r) int_0^{r/cutoff} psi, as the mean of psi: without cancellation at 0.
double PswfSplit::mollified_slope(double r) const
{
  double mean = 0.0;
  for (Eigen::Index i = 0; i < nodes_.size(); i++)
    mean += weights_[i] * evaluate_legendre(wave_, nodes_[i] * r / cutoff_);
  return 2.0 * mean / (total_ * cutoff_);
}

}    // namespace biem
