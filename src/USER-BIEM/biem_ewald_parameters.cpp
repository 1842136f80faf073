// Error and cost model of the SPME sum: see the header and doc/theory, label ewald-errors.
#include "biem_ewald_parameters.h"
#include "biem_error.h"
#include "biem_ewald_bspline.h"
#include "biem_ewald_split.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace biem {

namespace {

constexpr double kMostGridPoints = 2e9;         // what a large cluster can still hold
constexpr double kTightestTolerance = 1e-10;    // double precision leaves no margin below
constexpr double kShare = 0.42;    // of the tolerance for each of three independent error sources

// Nanoseconds on one AVX-512 core (bench/ewald); only their ratios matter. Fixed numbers, not a
// measurement at setup, so that a scene has the same parameters on every machine.
constexpr double kPairCost = 8.0;
constexpr double kGridVisitCost = 0.55;    // per window point, source or target, three components
constexpr double kGridPointCost = 25.0;    // FFTs and scaling of a 32^3 grid, three components

double volume(const EwaldScene &s)
{
  return std::fabs(s.cell.determinant());
}

// Length of each lattice vector in the worst tilt.
Vec3 worst_lengths(const EwaldScene &s)
{
  Vec3 c = s.cell.col(2);
  c[0] = std::max(std::fabs(c[0]), s.max_tilt);
  return Vec3(s.cell.col(0).norm(), s.cell.col(1).norm(), c.norm());
}

// Mean square velocity of randomly placed random forces of unit total square, on the whole sum:
// (1/V^2) sum_k (2/3)(8 pi/k^2)^2, lattice sum of 1/n^4 = 16.5323 for the cube of equal volume.
double reference_square(const EwaldScene &s)
{
  const double length = std::cbrt(volume(s));
  return 2.0 / 3.0 * std::pow(8.0 * M_PI, 2) * 16.5323 /
         (std::pow(2.0 * M_PI, 4) * length * length);
}

double real_error(const EwaldScene &s, double xi, double cutoff)
{
  return std::sqrt(4.0 * cutoff / volume(s) / reference_square(s)) *
         std::exp(-std::pow(xi * cutoff, 2));
}

double truncation_error(const EwaldScene &s, double xi, double x)    // x = band limit / 2 xi
{
  return std::sqrt(8.0 * x / (3.0 * volume(s) * xi) / reference_square(s)) * (1.0 + 1.0 / (x * x)) *
         std::exp(-x * x);
}

// Aliasing of a grid with spacing h along each axis: the mode sum as an isotropic integral.
double aliasing_error(const EwaldScene &s, double xi, double band_limit, const AliasingTable &table,
                      double h)
{
  constexpr int kRadial = 48, kPolar = 12;
  const GaussianSplit split(xi);
  double sum = 0.0;
  for (int i = 0; i < kRadial; i++) {
    const double k = band_limit * (i + 0.5) / kRadial;
    const double modes = std::pow(8.0 * M_PI * split.fourier_factor(k * k) / (k * k), 2) * k * k;
    double polar = 0.0;
    for (int j = 0; j < kPolar; j++)
      polar += table.error(k * (j + 0.5) / kPolar * h / (2.0 * M_PI)) / kPolar;
    sum += modes * 3.0 * polar;    // three axes
  }
  const double integral = sum * band_limit / kRadial * 4.0 * M_PI / std::pow(2.0 * M_PI, 3);
  return std::sqrt(2.0 / 3.0 * integral / volume(s) / reference_square(s));
}

// Root of a decreasing function, by bisection in [low, high].
template <class Function> double find_root(Function f, double target, double low, double high)
{
  for (int i = 0; i < 40; i++) {
    const double middle = 0.5 * (low + high);
    (f(middle) > target ? low : high) = middle;
  }
  return high;
}

// Pairs within the cutoff per target: the target's own body plus the average density of the rest.
double expected_neighbors(const EwaldScene &s, double cutoff)
{
  double own = 0.0;
  if (s.body_radius > 0.0)
    own = s.body_sources * std::min(1.0, std::pow(0.5 * cutoff / s.body_radius, 2));
  return own + s.n_sources * 4.0 / 3.0 * M_PI * std::pow(cutoff, 3) / volume(s);
}

double cost(const EwaldScene &s, const EwaldParameters &p)
{
  const double points = static_cast<double>(p.grid[0]) * p.grid[1] * p.grid[2];
  return kPairCost * s.n_targets * expected_neighbors(s, p.cutoff) +
         kGridVisitCost * std::pow(p.order, 3) * (s.n_sources + s.n_targets) +
         kGridPointCost * points * std::log2(points) / 15.0;
}

EwaldParameters make_candidate(const EwaldScene &s, double cutoff, int order,
                               const AliasingTable &table)
{
  EwaldParameters p;
  const double share = kShare * s.tolerance;
  p.order = order;
  p.cutoff = cutoff;
  p.tolerance = s.tolerance;
  p.splitting = find_root([&](double xi) { return real_error(s, xi, cutoff); }, share, 0.5 / cutoff,
                          12.0 / cutoff);
  const double xi = p.splitting;
  p.band_limit =
      2.0 * xi * find_root([&](double x) { return truncation_error(s, xi, x); }, share, 0.8, 12.0);
  const double finest = 0.05 * M_PI / p.band_limit, coarsest = M_PI / p.band_limit;
  // Aliasing falls with 1/h; the root is found in 1/h so that the function decreases.
  const double inverse =
      find_root([&](double q) { return aliasing_error(s, xi, p.band_limit, table, 1.0 / q); },
                share, 1.0 / coarsest, 1.0 / finest);
  const Vec3 lengths = worst_lengths(s);
  for (int a = 0; a < 3; a++)
    p.grid[a] = next_fft_size(std::max(order, static_cast<int>(std::ceil(lengths[a] * inverse))));
  return p;
}

}    // namespace

int next_fft_size(int n)
{
  for (;; n++) {
    int rest = n;
    for (int prime : {2, 3, 5, 7})
      while (rest % prime == 0)
        rest /= prime;
    if (rest == 1) return n;
  }
}

double compute_expected_error(const EwaldScene &s, const EwaldParameters &p)
{
  const Vec3 lengths = worst_lengths(s);
  double square = std::pow(real_error(s, p.splitting, p.cutoff), 2) +
                  std::pow(truncation_error(s, p.splitting, p.band_limit / (2.0 * p.splitting)), 2);
  const AliasingTable table(p.order);
  for (int a = 0; a < 3; a++) {
    const double alias =
        aliasing_error(s, p.splitting, p.band_limit, table, lengths[a] / p.grid[a]);
    square += alias * alias / 3.0;
  }
  return std::sqrt(square);
}

EwaldParameters choose_ewald_parameters(const EwaldScene &s)
{
  if (!(s.tolerance >= kTightestTolerance && s.tolerance <= 0.1)) {
    std::ostringstream message;
    message << "accuracy " << s.tolerance << " is out of range: the periodic sum can be computed to"
            << " relative tolerances between " << kTightestTolerance << " and 0.1";
    throw Error(message.str());
  }
  const double length = std::cbrt(volume(s));
  const double low = s.min_cutoff > 0.0 ? s.min_cutoff : 0.05 * length;
  const double high = s.max_cutoff > 0.0 ? s.max_cutoff : 0.6 * length;
  constexpr int kCutoffs = 40;
  EwaldParameters best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (int order : {4, 6, 8, 10}) {
    const AliasingTable table(order);
    for (int i = 0; i <= kCutoffs; i++) {
      const double cutoff = low * std::pow(high / low, static_cast<double>(i) / kCutoffs);
      const EwaldParameters candidate = make_candidate(s, cutoff, order, table);
      const auto [m0, m1, m2] = candidate.grid;
      if (static_cast<double>(m0) * m1 * m2 > kMostGridPoints) continue;
      const double candidate_cost = cost(s, candidate);
      if (candidate_cost < best_cost) {
        best_cost = candidate_cost;
        best = candidate;
      }
    }
  }
  if (best.order == 0) {
    std::ostringstream message;
    message << "accuracy " << s.tolerance << " cannot be met with a cutoff between " << low
            << " and " << high << " in this cell: the grid would be too large; allow a larger"
            << " cutoff or a larger tolerance";
    throw Error(message.str());
  }
  best.expected_error = compute_expected_error(s, best);
  return best;
}

}    // namespace biem
