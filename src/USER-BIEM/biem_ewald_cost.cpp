// Cost model: see the header. The constants were measured with bench/ewald (breakdown by phase).
#include "biem_ewald_cost.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

struct LayerCost {
  double pair, spread;    // per pair; per window row and source
};

LayerCost get_layer_cost(Layers layers)
{
  if (layers == Layers::Single) return {2.9, 5.6};
  if (layers == Layers::Double) return {5.0, 11.0};
  return {6.0, 11.5};
}

constexpr double kTarget = 30.0;       // real space: per target
constexpr double kCandidate = 0.28;    // distance test
constexpr double kGather = 1.1;        // candidate gathered for a search cell
constexpr double kFewTargets = 6.0;    // per search cell, as in RealSpaceSum
constexpr double kWindow = 50.0;       // windows of a point
constexpr double kInterpolateRow = 4.6;
constexpr double kGridPoint = 19.0;          // FFTs, clearing and kernel at 1e6 grid points
constexpr double kGridPointGrowth = 0.22;    // of a power of the number of grid points

// Pairs within the cutoff per target: the target's own body plus the average density of the rest.
double expected_neighbors(const EwaldScene &s, double cutoff)
{
  double own = 0.0;
  if (s.body_radius > 0.0)
    own = s.body_sources * std::min(1.0, std::pow(0.5 * cutoff / s.body_radius, 2));
  return own +
         s.n_sources * 4.0 / 3.0 * M_PI * std::pow(cutoff, 3) / std::fabs(s.cell.determinant());
}

// Search cells of edge r_c or r_c/2: candidates after pruning to the reach of the search cell, and
// before, in units of the pairs in the cutoff sphere.
double real_space_cost(const EwaldScene &s, double cutoff, double pair_cost)
{
  const double pairs = expected_neighbors(s, cutoff), sphere = 4.0 / 3.0 * M_PI;
  const double targets_per_sphere = pairs * s.n_targets / std::max(s.n_sources, 1.0);
  const bool is_fine = targets_per_sphere / sphere / 8.0 >= kFewTargets;
  const double candidates = pairs / sphere * (is_fine ? 10.5 : 20.6);
  const double gathered = pairs / sphere * (is_fine ? 15.6 : 27.0);
  const double targets = std::max(1.0, targets_per_sphere / sphere / (is_fine ? 8.0 : 1.0));
  return s.n_targets *
         (kTarget + kCandidate * candidates + kGather * gathered / targets + pair_cost * pairs);
}

}    // namespace

Vec3 worst_lengths(const EwaldScene &s)
{
  Vec3 c = s.cell.col(2);
  c[0] = std::max(std::fabs(c[0]), s.max_tilt);
  return Vec3(s.cell.col(0).norm(), s.cell.col(1).norm(), c.norm());
}

double predict_ewald_cost(const EwaldScene &s, const EwaldParameters &p)
{
  const LayerCost layer = get_layer_cost(s.layers);
  const double points = static_cast<double>(p.grid[0]) * p.grid[1] * p.grid[2];
  const double rows = static_cast<double>(p.order) * p.order;
  return real_space_cost(s, p.cutoff, layer.pair) + kWindow * (s.n_sources + s.n_targets) +
         rows * (layer.spread * s.n_sources + kInterpolateRow * s.n_targets) +
         kGridPoint * (has_double(s.layers) ? 7.0 / 6.0 : 1.0) * points *
             std::pow(points / 1e6, kGridPointGrowth);
}

}    // namespace biem
