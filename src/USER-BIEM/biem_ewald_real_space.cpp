// Real-space sum: candidates are gathered once per search cell of targets, picked per target by a
// test in single precision, and summed by a branch-free polynomial kernel in packs of doubles.
#include "biem_ewald_real_space.h"
#include "biem_bin_sort.h"
#include "biem_prefetch.h"
#include "biem_simd_gather.h"
#include "biem_simd_math.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

constexpr int kMaxCells = 1 << 21;
constexpr double kFewTargets = 6.0;      // per search cell: below, coarser cells are faster
constexpr double kCoincident = 1e-9;     // of the cutoff
constexpr double kFloatMargin = 4e-6;    // of the cutoff: rounding of the test in single precision

BIEM_INLINE Pack evaluate_polynomial(const std::vector<double> &c, Pack v)
{
  int k = static_cast<int>(c.size()) - 1;
  Pack value = broadcast(c[k]);
  while (--k >= 0)
    value = value * v + c[k];
  return value;
}

}    // namespace

void RealSpaceSum::sort_points(PointsView points, std::vector<int> &start, std::vector<int> &order)
{
  cell_of_point_.resize(points.cols());
  const double inverse = 1.0 / cell_size_;
  for (Eigen::Index i = 0; i < points.cols(); i++) {
    int index = 0;
    for (int a = 0; a < 3; a++)
      index =
          index * n_cells_[a] +
          std::clamp(static_cast<int>((points(a, i) - lower_[a]) * inverse), 0, n_cells_[a] - 1);
    cell_of_point_[i] = index;
  }
  sort_into_bins(cell_of_point_, n_cells_[0] * n_cells_[1] * n_cells_[2], start, order);
}

void RealSpaceSum::set_search_cells(const Vec3 &size)
{
  cell_size_ = kernel_.cutoff / reach_ * (1.0 + 1e-12);
  auto count = [&](int a) {
    return std::floor(size[a] / cell_size_) + 1.0;
  };
  while (count(0) * count(1) * count(2) > kMaxCells)
    cell_size_ *= 1.25;
  for (int a = 0; a < 3; a++)
    n_cells_[a] = static_cast<int>(count(a));
}

void RealSpaceSum::set_points(PointsView targets, PointsView sources, PointsView normals)
{
  targets_.resize(3, targets.cols());
  n_sources_ = static_cast<int>(sources.cols());
  if (targets.cols() == 0 || n_sources_ == 0) return;
  lower_ = targets.rowwise().minCoeff().cwiseMin(sources.rowwise().minCoeff());
  const Vec3 size = targets.rowwise().maxCoeff().cwiseMax(sources.rowwise().maxCoeff()) - lower_;
  for (reach_ = 2; reach_ >= 1; reach_--) {
    set_search_cells(size);
    sort_points(targets, target_start_, target_order_);
    int n_occupied = 0;
    for (size_t c = 1; c < target_start_.size(); c++)
      n_occupied += target_start_[c] > target_start_[c - 1];
    if (reach_ == 1 || targets.cols() >= kFewTargets * n_occupied) break;
  }
  for (Eigen::Index t = 0; t < targets.cols(); t++)
    targets_.col(t) = targets.col(target_order_[t]);
  sort_points(sources, source_start_, source_order_);
  normals_ = normals;
  for (int a = 0; a < 3; a++) {
    sorted_[a].resize(n_sources_ + kLanes);
    for (int s = 0; s < n_sources_; s++)
      sorted_[a][s] = sources(a, source_order_[s]);
  }
}

template <Layers layers> constexpr int RealSpaceSum::record_size()
{
  return layers == Layers::Single ? kForceRecord : kFullRecord;
}

void RealSpaceSum::fill_records(Layers layers, PointsView forces, PointsView densities)
{
  const int size = has_double(layers) ? kFullRecord : kForceRecord;
  records_.assign(static_cast<size_t>(size) * (n_sources_ + 1), 0.0);
  for (int s = 0; s < n_sources_; s++) {
    double *record = &records_[static_cast<size_t>(size) * s];
    const int source = source_order_[s];
    if (has_single(layers)) fetch_ahead(forces.data(), source_order_, s);
    if (has_double(layers)) fetch_ahead(densities.data(), source_order_, s);
    for (int a = 0; a < 3; a++) {
      record[kX + a] = sorted_[a][s];
      if (has_single(layers)) record[kForce + a] = forces(a, source);
      if (!has_double(layers)) continue;
      record[kDensity + a] = densities(a, source);
      record[kNormal + a] = normals_(a, source);
      record[kDensityDotNormal] += densities(a, source) * normals_(a, source);
    }
  }
}

Vec3 RealSpaceSum::get_center(int cell) const
{
  const int c2 = cell % n_cells_[2], c1 = cell / n_cells_[2] % n_cells_[1];
  return lower_ + cell_size_ * Vec3(cell / (n_cells_[2] * n_cells_[1]) + 0.5, c1 + 0.5, c2 + 0.5);
}

// Sources within the cutoff of the box of one search cell. Runs of cells along the third axis are
// contiguous.
int RealSpaceSum::gather_sources(int cell)
{
  const int c2 = cell % n_cells_[2], c1 = cell / n_cells_[2] % n_cells_[1];
  const int c0 = cell / (n_cells_[2] * n_cells_[1]);
  const Vec3 center = get_center(cell);
  const double half = 0.5 * cell_size_ * (1.0 + 1e-9);
  const Pack cutoff2 = broadcast(kernel_.cutoff * kernel_.cutoff);
  const int k_begin = std::max(0, c2 - reach_), k_end = std::min(n_cells_[2], c2 + reach_ + 1);
  int n = 0;
  for (int i = std::max(0, c0 - reach_); i <= std::min(n_cells_[0] - 1, c0 + reach_); i++)
    for (int j = std::max(0, c1 - reach_); j <= std::min(n_cells_[1] - 1, c1 + reach_); j++) {
      const int row = (i * n_cells_[1] + j) * n_cells_[2];
      const int begin = source_start_[row + k_begin], end = source_start_[row + k_end];
      const size_t needed = n + end - begin + 2 * kFloatLanes;
      if (close_.size() < needed) {
        for (std::vector<float> &g : gathered_)
          g.resize(2 * needed);
        gathered_index_.resize(2 * needed);
        close_.resize(2 * needed);
      }
      for (int s = begin; s < end; s += kLanes) {
        Pack x[3], outside2 = {};
        for (int a = 0; a < 3; a++) {
          x[a] = load(&sorted_[a][s]) - center[a];
          const Pack outside = absolute(x[a]) - half;
          const Pack beyond = select(less(outside, Pack{}), Pack{}, outside);
          outside2 += beyond * beyond;
        }
        const Mask wanted = first_lanes(end - s) & less(outside2, cutoff2);
        if (!any(wanted)) continue;
        for (int a = 0; a < 3; a++)
          compress_store(&gathered_[a][n], wanted, x[a]);
        n += compress_store_counted(&gathered_index_[n], wanted, s);
      }
    }
  for (int s = n; s < n + kFloatLanes; s++)    // a fill that is never close
    gathered_[0][s] = 1e9f * static_cast<float>(kernel_.cutoff);
  return n;
}

// Returns the number of sources near the target (relative to the cell's center), in close_, which
// is filled up to whole packs with the dummy.
int RealSpaceSum::find_close(int n_gathered, const Vec3 &target)
{
  const FloatPack limit2 =
      static_cast<float>(std::pow(kernel_.cutoff * (1.0 + kFloatMargin), 2)) - FloatPack{};
  const float x = static_cast<float>(target[0]), y = static_cast<float>(target[1]),
              z = static_cast<float>(target[2]);
  int n = 0;
  for (int s = 0; s < n_gathered; s += kFloatLanes) {
    const FloatPack dx = load(&gathered_[0][s]) - x, dy = load(&gathered_[1][s]) - y,
                    dz = load(&gathered_[2][s]) - z;
    n += pick_less(dx * dx + dy * dy + dz * dz, limit2, &gathered_index_[s], &close_[n]);
  }
  for (int s = n; s < round_up_to_packs(n); s++)
    close_[s] = n_sources_;
  return n;
}

template <Layers layers> Vec3 RealSpaceSum::sum_close(int n_close, const Vec3 &target) const
{
  const double to_v = 2.0 / (kernel_.cutoff * kernel_.cutoff);
  const Pack cutoff2 = broadcast(kernel_.cutoff * kernel_.cutoff);
  const Pack smallest2 = kCoincident * kCoincident * cutoff2;
  Pack u[3] = {};
  for (int s = 0; s < n_close; s += kLanes) {
    Pack channel[record_size<layers>()];
    load_records(records_.data(), &close_[s], channel);
    Pack r[3];
    for (int a = 0; a < 3; a++)
      r[a] = target[a] - channel[kX + a];
    const Pack r2_any = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const Mask is_inside = less(r2_any, cutoff2), is_coincident = less(r2_any, smallest2);
    const Pack r2 = select(is_inside, r2_any, cutoff2);    // keeps the polynomials finite
    const Pack inverse = inverse_square_root(select(is_coincident, cutoff2, r2));
    const Pack free = select(is_coincident, broadcast(kernel_.coincident), inverse);
    const Pack free3 = select(is_coincident, Pack{}, inverse * inverse * inverse);
    const Pack v = r2 * to_v - 1.0;
    const Pack slope1 = evaluate_polynomial(kernel_.slope1, v);
    if (has_single(layers)) {
      const Pack *f = channel + kForce;
      const Pack slope = evaluate_polynomial(kernel_.slope, v);
      const Pack isotropic = select(is_inside, free - 2.0 * (slope + r2 * slope1), Pack{});
      const Pack dyadic = select(is_inside, free3 + 2.0 * slope1, Pack{}) *
                          (r[0] * f[0] + r[1] * f[1] + r[2] * f[2]);
      for (int a = 0; a < 3; a++)
        u[a] += isotropic * f[a] + dyadic * r[a];
    }
    if (has_double(layers)) {
      const Pack *q = channel + kDensity, *n = channel + kNormal;
      const Pack slope2 = evaluate_polynomial(kernel_.slope2, v);
      const Pack rq = r[0] * q[0] + r[1] * q[1] + r[2] * q[2];
      const Pack rn = r[0] * n[0] + r[1] * n[1] + r[2] * n[2];
      const Pack shared = select(is_inside, -6.0 * slope1 - 4.0 * r2 * slope2, Pack{});
      const Pack triple = select(is_inside, 8.0 * slope2 - 6.0 * free3 * inverse * inverse, Pack{});
      const Pack along = triple * rq * rn + shared * channel[kDensityDotNormal];
      const Pack on_q = shared * rn, on_n = shared * rq;
      for (int a = 0; a < 3; a++)
        u[a] += along * r[a] + on_q * q[a] + on_n * n[a];
    }
  }
  return Vec3(sum(u[0]), sum(u[1]), sum(u[2]));
}

template <Layers layers> void RealSpaceSum::add_all(PointsRef velocities)
{
  const int n_cells = n_cells_[0] * n_cells_[1] * n_cells_[2];
  for (int cell = 0; cell < n_cells; cell++) {
    if (target_start_[cell] == target_start_[cell + 1]) continue;
    const int n_gathered = gather_sources(cell);
    if (n_gathered == 0) continue;
    const Vec3 center = get_center(cell);
    for (int t = target_start_[cell]; t < target_start_[cell + 1]; t++) {
      const Vec3 target = targets_.col(t);
      fetch_ahead(velocities.data(), target_order_, t);
      const int n = find_close(n_gathered, target - center);
      velocities.col(target_order_[t]) += sum_close<layers>(n, target);
      n_pairs_ += n;
    }
  }
}

void RealSpaceSum::add_layers(Layers layers, PointsView forces, PointsView densities,
                              PointsRef velocities)
{
  n_pairs_ = 0;
  if (targets_.cols() == 0 || n_sources_ == 0) return;
  fill_records(layers, forces, densities);
  switch (layers) {
    case Layers::Single:
      return add_all<Layers::Single>(velocities);
    case Layers::Double:
      return add_all<Layers::Double>(velocities);
    case Layers::Both:
      return add_all<Layers::Both>(velocities);
  }
}

}    // namespace biem
