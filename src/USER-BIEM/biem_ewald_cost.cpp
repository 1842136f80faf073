// Cost model: see the header. The constants were measured with bench/ewald (breakdown by phase).
#include "biem_ewald_cost.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

struct LayerCost {
  double pair, spread, spread_row;    // per pair; per source; per source and window row
};

LayerCost get_layer_cost(Layers layers)
{
  if (layers == Layers::Single) return {3.5, 40.0, 2.5};
  if (layers == Layers::Double) return {4.6, 90.0, 6.5};
  return {5.6, 90.0, 6.5};
}

constexpr double kTarget = 140.0;        // real space: per target
constexpr double kSearchCell = 250.0;    // real space: per search cell of targets
constexpr double kWindow = 35.0;         // windows of a point
constexpr double kInterpolate = 40.0, kInterpolateRow = 2.1;
constexpr double kGridPoint = 25.0;          // transforms, clearing and kernel, large grids
constexpr double kCachedGridPoints = 6e5;    // smaller grids are faster,
constexpr double kCacheGain = 0.25;          // by this power of their size

// Pairs within the cutoff per target: the target's own body plus the average density of the rest.
double expected_neighbors(const EwaldScene &s, double cutoff)
{
  double own = 0.0;
  if (s.body_radius > 0.0)
    own = s.body_sources * std::min(1.0, std::pow(0.5 * cutoff / s.body_radius, 2));
  return own +
         s.n_sources * 4.0 / 3.0 * M_PI * std::pow(cutoff, 3) / std::fabs(s.cell.determinant());
}

// Measured for 19 to 450 pairs per target, within 15 %.
double real_space_cost(const EwaldScene &s, double cutoff, double pair_cost)
{
  const double pairs = expected_neighbors(s, cutoff);
  const double sources_in_cell = pairs / (4.0 / 3.0 * M_PI);    // search cells of edge r_c
  const double targets_in_cell =
      std::max(1.0, sources_in_cell * s.n_targets / std::max(s.n_sources, 1.0));
  return s.n_targets * (kTarget + kSearchCell / targets_in_cell + pair_cost * pairs);
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
  const double cached = std::pow(std::min(1.0, points / kCachedGridPoints), kCacheGain);
  return real_space_cost(s, p.cutoff, layer.pair) + kWindow * (s.n_sources + s.n_targets) +
         (layer.spread + layer.spread_row * rows) * s.n_sources +
         (kInterpolate + kInterpolateRow * rows) * s.n_targets +
         kGridPoint * cached * (has_double(s.layers) ? 7.0 / 6.0 : 1.0) * points;
}

}    // namespace biem
