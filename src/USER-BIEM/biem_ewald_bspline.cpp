// Cardinal B-splines: see the header. Essmann et al., J. Chem. Phys. 103, 8577 (1995), Eq. 4.1.
#include "biem_ewald_bspline.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

// (W(f), sum of squares over the aliases m != 0), W(f) = sinc(pi f)^order at unit spacing.
void compute_window_sums(int order, double frequency, double &square, double &aliases)
{
  constexpr int kAliases = 30;    // sinc^(2 order) has decayed below 1e-16 for order >= 4
  auto power = [order](double f) {
    const double s = f == 0.0 ? 1.0 : std::sin(M_PI * f) / (M_PI * f);
    return std::pow(s * s, order);
  };
  square = power(frequency);
  aliases = 0.0;
  for (int m = kAliases; m >= 1; m--)
    aliases += power(frequency + m) + power(frequency - m);
}

}    // namespace

int compute_bspline_weights(int order, double s, double *w)
{
  // Centred: grid point m gets M_order(s - m + order/2), M supported on (0, order).
  const double left = s - 0.5 * order;
  const double floor_left = std::floor(left);
  const double u = left - floor_left;    // in [0, 1)
  double value[kMaxBsplineOrder];        // value[i] = M_n(u + i), raised from n = 2 to order
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

std::vector<double> compute_influence_factors(int order, int grid)
{
  std::vector<double> factors(grid);
  for (int n = 0; n < grid; n++) {
    const int signed_n = n <= grid / 2 ? n : n - grid;
    double square, aliases;
    compute_window_sums(order, static_cast<double>(signed_n) / grid, square, aliases);
    factors[n] = square / ((square + aliases) * (square + aliases));
  }
  return factors;
}

AliasingTable::AliasingTable(int order)
{
  for (int i = 0; i <= kIntervals; i++) {
    double square, aliases;
    compute_window_sums(order, 0.5 * i / kIntervals, square, aliases);
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
