// Windows: see the header.
#include "biem_ewald_window.h"
#include "biem_ewald_polynomial.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

// W(f)^2 and the sum of squares over its aliases f + m, m != 0.
void compute_window_sums(const EwaldWindow &window, double f, double &square, double &aliases)
{
  constexpr int kAliases = 20;
  auto power = [&](double frequency) {
    return std::pow(window.transform(frequency), 2);
  };
  square = power(f);
  aliases = 0.0;
  for (int m = kAliases; m >= 1; m--)
    aliases += power(f + m) + power(f - m);
}

// Power series of the modified Bessel function I0 in x^2/4, all terms positive.
double bessel_i0(double x)
{
  const double q = 0.25 * x * x;
  double term = 1.0, sum = 1.0;
  for (int n = 1; term > 1e-17 * sum; n++)
    sum += term *= q / (static_cast<double>(n) * n);
  return sum;
}

}    // namespace

int BsplineWindow::compute_weights(double s, double *w) const
{
  // Centred: grid point m gets M_order(s - m + order/2), M supported on (0, order).
  const int order = this->order();
  const double left = s - 0.5 * order;
  const double floor_left = std::floor(left);
  const double u = left - floor_left;    // in [0, 1)
  double value[kMaxWindowOrder];         // value[i] = M_n(u + i), raised from n = 2 to order
  value[0] = u;
  value[1] = 1.0 - u;
  for (int n = 3; n <= order; n++) {
    const double scale = 1.0 / (n - 1);
    value[n - 1] = scale * (1.0 - u) * value[n - 2];
    for (int i = n - 2; i >= 1; i--)
      value[i] = scale * ((u + i) * value[i] + (n - u - i) * value[i - 1]);
    value[0] *= scale * u;
  }
  for (int j = 0; j < order; j++)
    w[j] = value[order - 1 - j];
  return static_cast<int>(floor_left) + 1;
}

double BsplineWindow::transform(double f) const
{
  if (f == 0.0) return 1.0;
  return std::pow(std::sin(M_PI * f) / (M_PI * f), order());
}

KaiserBesselWindow::KaiserBesselWindow(int order, double oversampling) :
    EwaldWindow(order), beta_(0.98 * M_PI * 0.5 * order * (2.0 - 1.0 / oversampling)),
    padded_((order + kLanes - 1) / kLanes * kLanes)
{
  norm_ = 1.0 / (order * std::sinh(beta_) / beta_);
  // One polynomial in x = 2 u - 1 per grid point, a tenth as wrong as the window itself is.
  constexpr int kMaxDegree = 20;
  const double tolerance = std::max(0.1 * std::exp(-beta_), 1e-15) * norm_ * bessel_i0(beta_);
  double error = 2.0 * tolerance;
  for (degree_ = 3; degree_ < kMaxDegree && error > tolerance;) {
    const int n = ++degree_ + 1;
    coefficients_.assign(n * padded_, 0.0);
    error = 0.0;
    for (int j = 0; j < order; j++) {
      const std::vector<double> chebyshev = interpolate_chebyshev(
          [&](double x) { return compute_value(0.5 * (x + 1.0) + j - 0.5 * order); }, n);
      const std::vector<double> monomials = to_monomials(chebyshev, degree_);
      for (int k = 0; k < n; k++)
        coefficients_[k * padded_ + j] = monomials[k];
      error = std::max(error, std::fabs(chebyshev[n - 1]) + std::fabs(chebyshev[n - 2]));
    }
  }
}

double KaiserBesselWindow::compute_value(double t) const
{
  const double q = 1.0 - std::pow(2.0 * t / order(), 2);
  return q > 0.0 ? norm_ * bessel_i0(beta_ * std::sqrt(q)) : (q == 0.0 ? norm_ : 0.0);
}

int KaiserBesselWindow::compute_weights(double s, double *w) const
{
  const double left = s - 0.5 * order();
  const double first = std::floor(left) + 1.0;
  const double x = 2.0 * (first - left) - 1.0;
  double value[kMaxWindowOrder];
  const double *c = &coefficients_[degree_ * padded_];
  for (int j = 0; j < padded_; j++)
    value[j] = c[j];
  for (int k = degree_ - 1; k >= 0; k--) {
    c -= padded_;
#pragma omp simd
    for (int j = 0; j < padded_; j++)
      value[j] = value[j] * x + c[j];
  }
  for (int j = 0; j < order(); j++)
    w[j] = value[j];
  return static_cast<int>(first);
}

double KaiserBesselWindow::transform(double f) const
{
  const double omega = M_PI * f * order(), difference = beta_ * beta_ - omega * omega;
  const double root = std::sqrt(std::fabs(difference));
  const double value = root == 0.0        ? 1.0
                       : difference > 0.0 ? std::sinh(root) / root
                                          : std::sin(root) / root;
  return value * beta_ / std::sinh(beta_);
}

std::vector<double> compute_influence_factors(const EwaldWindow &window, int grid)
{
  std::vector<double> factors(grid);
  for (int n = 0; n < grid; n++) {
    const int signed_n = n <= grid / 2 ? n : n - grid;
    double square, aliases;
    compute_window_sums(window, static_cast<double>(signed_n) / grid, square, aliases);
    factors[n] = square / ((square + aliases) * (square + aliases));
  }
  return factors;
}

AliasingTable::AliasingTable(const EwaldWindow &window)
{
  for (int i = 0; i <= kIntervals; i++) {
    double square, aliases;
    compute_window_sums(window, 0.5 * i / kIntervals, square, aliases);
    const double ratio = aliases / square;
    errors_[i] = ratio * (2.0 + ratio) / ((1.0 + ratio) * (1.0 + ratio));
  }
}

double AliasingTable::error(double frequency) const
{
  const double position = std::min(2.0 * std::fabs(frequency), 1.0) * kIntervals;
  const int i = std::min(static_cast<int>(position), kIntervals - 1);
  return errors_[i] + (position - i) * (errors_[i + 1] - errors_[i]);
}

}    // namespace biem
