// Polynomial form of the real-space kernels, and the Gaussian split: see the header.
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
// Derivatives are larger numbers in units of the cutoff and need less absolute accuracy.
constexpr double kDerivativeMargin = 3.0;

// A Chebyshev series, truncated where its tail drops below tolerance, as monomials. The remainders
// behave like exp(-s v): their monomial form does not cancel.
std::vector<double> truncate(const std::vector<double> &chebyshev, double tolerance)
{
  int degree = static_cast<int>(chebyshev.size()) - 1;
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

double GaussianSplit::mollified_slope(double r) const
{
  const double x = xi_ * r;
  return x < 1e-5 ? 2.0 * xi_ / kSqrtPi * (1.0 - x * x / 3.0) : std::erf(x) / r;
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

RealSpaceKernel make_real_space_kernel(const EwaldSplit &split, double cutoff, double band_limit,
                                       double tolerance)
{
  constexpr int kPoints = 2 * kMaxDegree;
  std::vector<double> slope = interpolate_chebyshev(
      [&](double v) { return split.mollified_slope(cutoff * std::sqrt(0.5 * (v + 1.0))); },
      kPoints);
  for (double &c : slope)    // derivatives would amplify what is only rounding noise
    if (std::fabs(c) < 2e-15 * std::fabs(slope[0])) c = 0.0;
  const double per_square = 2.0 / (cutoff * cutoff);    // dv/d(r^2)
  auto differentiate = [per_square](const std::vector<double> &series) {
    std::vector<double> result = differentiate_chebyshev(series);
    for (double &c : result)
      c *= per_square;
    return result;
  };
  const std::vector<double> slope1 = differentiate(slope), slope2 = differentiate(slope1);
  double scale = tolerance / cutoff;
  RealSpaceKernel kernel;
  kernel.cutoff = cutoff;
  kernel.coincident = split.truncated_self(band_limit);
  kernel.slope = truncate(slope, scale);
  kernel.slope1 = truncate(slope1, scale *= kDerivativeMargin / (cutoff * cutoff));
  kernel.slope2 = truncate(slope2, scale *= kDerivativeMargin / (cutoff * cutoff));
  return kernel;
}

}    // namespace biem
