// Polynomial form of the real-space kernel, and the Gaussian split: see the header.
#include "biem_ewald_split.h"
#include "biem_error.h"
#include "biem_ewald_polynomial.h"
#include <algorithm>
#include <cmath>
#include <string>

namespace biem {

namespace {

const double kSqrtPi = std::sqrt(M_PI);
constexpr int kMaxDegree = 60;

// Chebyshev interpolation of f(v) on [-1, 1], truncated where the tail drops below tolerance, as
// monomials. The remainders behave like exp(-s v): their monomial form does not cancel.
std::vector<double> fit_polynomial(const std::function<double(double)> &f, double tolerance)
{
  const int n = 2 * kMaxDegree;
  const std::vector<double> chebyshev = interpolate_chebyshev(f, n);
  int degree = n - 1;
  double tail = 0.0;
  while (degree > 1 && tail + std::fabs(chebyshev[degree]) < tolerance)
    tail += std::fabs(chebyshev[degree--]);
  if (degree > kMaxDegree)
    throw Error("real-space kernel needs a polynomial of degree " + std::to_string(degree) +
                " (at most " + std::to_string(kMaxDegree) +
                "): the product of splitting parameter and cutoff is too large");
  return to_monomials(chebyshev, degree);
}

}    // namespace

double GaussianSplit::fourier_factor(double k2) const
{
  const double q = k2 / (4.0 * xi_ * xi_);
  return (1.0 + q) * std::exp(-q);
}

double GaussianSplit::isotropic_remainder(double r) const
{
  const double x = xi_ * r;
  if (x < 1e-4) return 2.0 * xi_ / kSqrtPi * (2.0 - 4.0 / 3.0 * x * x);
  return std::erf(x) / r + 2.0 * xi_ / kSqrtPi * std::exp(-x * x);
}

double GaussianSplit::dyadic_remainder(double r) const
{
  const double x = xi_ * r, x2 = x * x;
  const double scale = 2.0 * xi_ * xi_ * xi_ / kSqrtPi;
  if (x < 0.3) {    // (erf(x)/x - 2/sqrt(pi) exp(-x^2))/x^2 as a series: the closed form cancels
    double term = 1.0, sum = 0.0;
    for (int n = 0; n < 14; n++) {
      sum += term * 2.0 / (2.0 * n + 3.0);
      term *= -x2 / (n + 1.0);
    }
    return scale * sum;
  }
  return (std::erf(x) / r - 2.0 * xi_ / kSqrtPi * std::exp(-x2)) / (r * r);
}

double GaussianSplit::truncated_self(double k_max) const
{
  const double x = k_max / (2.0 * xi_);
  return 8.0 * xi_ / (3.0 * M_PI) * (x * std::exp(-x * x) + 1.5 * kSqrtPi * std::erfc(x));
}

FourierFactorTable::FourierFactorTable(const EwaldSplit &split, double band_limit) :
    intervals_per_k_(kIntervals / band_limit), values_(kIntervals + 4)
{
  for (int i = 0; i < kIntervals + 4; i++)
    values_[i] = split.fourier_factor(std::pow((i - 1) / intervals_per_k_, 2));
}

double FourierFactorTable::value(double k2) const
{
  const double position = std::sqrt(k2) * intervals_per_k_;
  const int i = std::min(static_cast<int>(position), kIntervals);
  const double x = position - i;
  const double *v = &values_[i];    // values at i - 1, i, i + 1, i + 2: Lagrange's cubic
  return -x * (x - 1.0) * (x - 2.0) / 6.0 * v[0] + (x * x - 1.0) * (x - 2.0) / 2.0 * v[1] -
         x * (x + 1.0) * (x - 2.0) / 2.0 * v[2] + x * (x * x - 1.0) / 6.0 * v[3];
}

RealSpaceKernel make_real_space_kernel(const EwaldSplit &split, double cutoff, double tolerance)
{
  RealSpaceKernel kernel;
  kernel.cutoff = cutoff;
  auto radius = [cutoff](double v) {
    return cutoff * std::sqrt(0.5 * (v + 1.0));
  };
  kernel.isotropic = fit_polynomial([&](double v) { return split.isotropic_remainder(radius(v)); },
                                    tolerance / cutoff);
  kernel.dyadic = fit_polynomial([&](double v) { return split.dyadic_remainder(radius(v)); },
                                 tolerance / (cutoff * cutoff * cutoff));
  return kernel;
}

}    // namespace biem
