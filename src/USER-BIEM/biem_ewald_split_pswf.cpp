// PSWF split: see the header. psi is expanded in even Legendre polynomials, whose coefficients are
// an eigenvector of a tridiagonal matrix (Xiao, Rokhlin & Yarvin, Inverse Problems 17, 805 (2001)).
#include "biem_ewald_split_pswf.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

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

// int P_n = (P_{n+1} - P_{n-1})/(2n + 1), plus the constant that makes it vanish at 0.
std::vector<double> integrate_legendre(const std::vector<double> &c)
{
  std::vector<double> result(c.size() + 1, 0.0);
  for (size_t n = 0; n < c.size(); n++) {
    result[n + 1] += c[n] / (2.0 * n + 1.0);
    if (n > 0) result[n - 1] -= c[n] / (2.0 * n + 1.0);
  }
  result[0] -= evaluate_legendre(result, 0.0);
  return result;
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
    derivative_(differentiate_legendre(wave_)), integral_(integrate_legendre(wave_)),
    at_zero_(evaluate_legendre(wave_, 0.0)), total_(2.0 * evaluate_legendre(integral_, 1.0))
{
}

// psi is its own finite Fourier transform, int_{-1}^{1} psi(x) cos(c t x) dx = lambda psi(t): so it
// goes on beyond t = 1, where its Legendre series does not.
double PswfSplit::continue_wave(double t, double &derivative) const
{
  constexpr int kPoints = 400;    // midpoint rule on a function that is flat at both ends
  double value = 0.0, slope = 0.0, zero = 0.0;
  for (int i = 0; i < kPoints; i++) {
    const double x = (i + 0.5) / kPoints, psi = evaluate_legendre(wave_, x);
    zero += psi;
    value += psi * std::cos(bandwidth_ * t * x);
    slope -= psi * bandwidth_ * x * std::sin(bandwidth_ * t * x);
  }
  derivative = slope / zero * at_zero_;
  return value / zero * at_zero_;
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

// The mollified biharmonic B(r) has B' = (2/total) int_0^{r/cutoff} psi; the Stokeslet's smooth
// part is (B'' + B'/r) I + (B'/r - B'') rr/r^2.
double PswfSplit::isotropic_remainder(double r) const
{
  const double t = r / cutoff_;
  const double second = 2.0 * evaluate_legendre(wave_, t) / (total_ * cutoff_);
  const double first_over_r = t < 1e-6 ? 2.0 * at_zero_ / (total_ * cutoff_)
                                       : 2.0 * evaluate_legendre(integral_, t) / (total_ * r);
  return second + first_over_r;
}

double PswfSplit::dyadic_remainder(double r) const
{
  // The difference loses (c t)^-2 of its digits: below kSmall the function is constant to 1e-5.
  constexpr double kSmall = 1e-3;
  const double t = std::max(r / cutoff_, kSmall);
  return 2.0 * (evaluate_legendre(integral_, t) / t - evaluate_legendre(wave_, t)) /
         (total_ * t * t * cutoff_ * cutoff_ * cutoff_);
}

}    // namespace biem
