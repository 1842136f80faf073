// Reference of the benchmarks: see the header.
#include "bench_reference.h"
#include "biem_oracle_periodic.h"
#include <algorithm>
#include <cmath>
#include <limits>

using namespace biem;

namespace biem_bench {

namespace {

constexpr int kBlock = 4096;    // sources

// Balances the two parts of the direct sum for few targets and many sources.
double choose_splitting(const Mat3 &cell, int n_targets)
{
  const double s = std::clamp(std::pow(300.0 * n_targets, 1.0 / 6.0), 2.0, 8.0);
  return s / std::cbrt(std::fabs(cell.determinant()));
}

}    // namespace

Reference::Reference(MPI_Comm comm, const PointSet &set, const std::vector<int> &owned,
                     int n_targets) :
    comm_(comm),
    set_(set), owned_(owned)
{
  const auto n = static_cast<long>(set.points.cols());
  n_targets = static_cast<int>(std::min<long>(n_targets, n));
  positions_.resize(3, n_targets);
  for (int t = 0; t < n_targets; t++) {
    const int point = static_cast<int>(t * n / n_targets);
    const auto place = std::lower_bound(owned.begin(), owned.end(), point);
    targets_.push_back(point);
    columns_.push_back(
        place != owned.end() && *place == point ? static_cast<int>(place - owned.begin()) : -1);
    positions_.col(t) = set.points.col(point);
  }
}

const Points &Reference::get(Layers layer)
{
  Points &result = layer == Layers::Single ? single_ : double_;
  if (result.cols() > 0) return result;
  result = Points::Zero(3, positions_.cols());
  const double splitting = choose_splitting(set_.cell, static_cast<int>(positions_.cols()));
  for (size_t first = 0; first < owned_.size(); first += kBlock) {
    const std::vector<int> block(owned_.begin() + first,
                                 owned_.begin() + std::min(first + kBlock, owned_.size()));
    const Points sources = set_.unwrapped(Eigen::all, block);
    if (layer == Layers::Single)
      result += compute_oracle_single_layer(set_.cell, positions_, sources,
                                            set_.forces(Eigen::all, block), splitting);
    else
      result += compute_oracle_double_layer(set_.cell, positions_, sources,
                                            set_.densities(Eigen::all, block),
                                            set_.normals(Eigen::all, block), splitting);
  }
  MPI_Allreduce(MPI_IN_PLACE, result.data(), static_cast<int>(result.size()), MPI_DOUBLE, MPI_SUM,
                comm_);
  return result;
}

double Reference::compute_error(Layers layers, PointsView velocities)
{
  if (targets_.empty()) return std::numeric_limits<double>::quiet_NaN();
  Points exact = Points::Zero(3, positions_.cols());
  if (has_single(layers)) exact += get(Layers::Single);
  if (has_double(layers)) exact += get(Layers::Double);
  double square = 0.0;
  for (size_t t = 0; t < targets_.size(); t++)
    if (columns_[t] >= 0) square += (velocities.col(columns_[t]) - exact.col(t)).squaredNorm();
  MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_SUM, comm_);
  return std::sqrt(square) / exact.norm();
}

}    // namespace biem_bench
