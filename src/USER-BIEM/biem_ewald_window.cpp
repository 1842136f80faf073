// Windows: see the header.
#include "biem_ewald_window.h"
#include "biem_error.h"
#include "biem_ewald_polynomial.h"
#include <algorithm>
#include <cmath>
#include <string>

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

EwaldWindow::EwaldWindow(int order) : order_(order), padded_(round_up_to_packs(order))
{
  if (order < kMinWindowOrder || order > kMaxWindowOrder)
    throw Error("window order " + std::to_string(order) + " is out of range (" +
                std::to_string(kMinWindowOrder) + " to " + std::to_string(kMaxWindowOrder) + ")");
}

void EwaldWindow::tabulate(const std::function<double(double)> &value, int min_degree,
                           double tolerance)
{
  constexpr int kMaxDegree = 20;
  double error = 2.0 * tolerance;
  for (degree_ = min_degree - 1; degree_ < kMaxDegree && error > tolerance;) {
    const int n = ++degree_ + 1;
    coefficients_.assign(n * padded_, 0.0);
    slope_coefficients_.assign(n * padded_, 0.0);
    error = 0.0;
    for (int j = 0; j < order_; j++) {    // x = 2 u - 1 on the piece t = j - order/2 + u
      const std::vector<double> chebyshev = interpolate_chebyshev(
          [&](double x) { return value(0.5 * (x + 1.0) + j - 0.5 * order_); }, n);
      const std::vector<double> monomials = to_monomials(chebyshev, degree_);
      for (int k = 0; k < n; k++)
        coefficients_[k * padded_ + j] = monomials[k];
      for (int k = 1; k < n; k++)    // t falls as s grows: dx/ds = -2
        slope_coefficients_[(k - 1) * padded_ + j] = -2.0 * k * monomials[k];
      error = std::max(error, std::fabs(chebyshev[n - 1]) + std::fabs(chebyshev[n - 2]));
    }
  }
}

int EwaldWindow::locate(double s, double &x) const
{
  const double left = s - 0.5 * order_;
  const double first = find_first_point(s, order_);
  x = 2.0 * (first - left) - 1.0;
  return static_cast<int>(first);
}

namespace {

// Polynomials of all pieces at x, rows of padded coefficients from the constant up.
BIEM_INLINE void evaluate_pieces(const std::vector<double> &coefficients, int degree, int padded,
                                 double x, double *value)
{
  for (int j = 0; j < padded; j += kLanes) {
    const double *c = &coefficients[degree * padded + j];
    Pack v = load(c);
    for (int k = degree - 1; k >= 0; k--)
      v = v * x + load(c -= padded);
    store(value + j, v);
  }
}

}    // namespace

int EwaldWindow::compute_weights(double s, double *weights) const
{
  double x;
  const int first = locate(s, x);
  evaluate_pieces(coefficients_, degree_, padded_, x, weights);
  return first;
}

int EwaldWindow::compute_weights_and_slopes(double s, double *weights, double *slopes) const
{
  double x;
  const int first = locate(s, x);
  evaluate_pieces(coefficients_, degree_, padded_, x, weights);
  evaluate_pieces(slope_coefficients_, degree_ - 1, padded_, x, slopes);
  return first;
}

BsplineWindow::BsplineWindow(int order) : EwaldWindow(order)
{
  // M_order(t + order/2) by the recursion of Cox and de Boor; polynomials of degree order - 1.
  auto value = [order](double t) {
    const double left = t + 0.5 * order, u = left - std::floor(left);
    const int piece = static_cast<int>(std::floor(left));
    if (piece < 0 || piece >= order) return 0.0;
    double v[kMaxWindowOrder] = {u, 1.0 - u};    // v[i] = M_n(u + i), raised from n = 2
    for (int n = 3; n <= order; n++) {
      const double scale = 1.0 / (n - 1);
      v[n - 1] = scale * (1.0 - u) * v[n - 2];
      for (int i = n - 2; i >= 1; i--)
        v[i] = scale * ((u + i) * v[i] + (n - u - i) * v[i - 1]);
      v[0] *= scale * u;
    }
    return v[piece];
  };
  tabulate(value, order - 1, 1.0);
}

double BsplineWindow::transform(double f) const
{
  if (f == 0.0) return 1.0;
  return std::pow(std::sin(M_PI * f) / (M_PI * f), order());
}

KaiserBesselWindow::KaiserBesselWindow(int order, double oversampling) :
    EwaldWindow(order), beta_(0.98 * M_PI * 0.5 * order * (2.0 - 1.0 / oversampling))
{
  const double norm = 1.0 / (order * std::sinh(beta_) / beta_);
  auto value = [&](double t) {
    return norm * bessel_i0(beta_ * std::sqrt(std::max(0.0, 1.0 - std::pow(2.0 * t / order, 2))));
  };
  // A tenth as wrong as the window itself is.
  tabulate(value, 4, std::max(0.1 * std::exp(-beta_), 1e-15) * norm * bessel_i0(beta_));
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
