// Real-space sum: search cells of half the cutoff, candidates gathered once per cell of targets,
// then per target a compaction to the true neighbors and a branch-free polynomial kernel.
#include "biem_ewald_real_space.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {
constexpr int kReach = 2;     // search cells per cutoff, along each axis
constexpr int kVector = 8;    // the close list is padded to whole vectors of doubles
constexpr int kMaxCells = 1 << 21;
}    // namespace

void RealSpaceSum::sort_points(PointsView points, std::vector<int> &start,
                               std::vector<int> &order) const
{
  const int n = static_cast<int>(points.cols());
  std::vector<int> cell(n);
  start.assign(n_cells_[0] * n_cells_[1] * n_cells_[2] + 1, 0);
  order.resize(n);
  for (int i = 0; i < n; i++) {
    int index[3];
    for (int a = 0; a < 3; a++)
      index[a] =
          std::clamp(static_cast<int>((points(a, i) - lower_[a]) / cell_size_), 0, n_cells_[a] - 1);
    cell[i] = (index[0] * n_cells_[1] + index[1]) * n_cells_[2] + index[2];
    start[cell[i] + 1]++;
  }
  for (size_t c = 1; c < start.size(); c++)
    start[c] += start[c - 1];
  std::vector<int> next(start.begin(), start.end() - 1);
  for (int i = 0; i < n; i++)
    order[next[cell[i]]++] = i;
}

void RealSpaceSum::set_points(PointsView targets, PointsView sources)
{
  targets_ = targets;
  n_sources_ = static_cast<int>(sources.cols());
  if (targets.cols() == 0 || n_sources_ == 0) return;
  lower_ = targets.rowwise().minCoeff().cwiseMin(sources.rowwise().minCoeff());
  const Vec3 upper = targets.rowwise().maxCoeff().cwiseMax(sources.rowwise().maxCoeff());
  const Vec3 size = upper - lower_;
  cell_size_ = kernel_.cutoff / kReach * (1.0 + 1e-12);
  auto count = [&](int a) {
    return std::floor(size[a] / cell_size_) + 1.0;
  };
  while (count(0) * count(1) * count(2) > kMaxCells)
    cell_size_ *= 1.25;
  for (int a = 0; a < 3; a++)
    n_cells_[a] = static_cast<int>(count(a));
  sort_points(targets, target_start_, target_order_);
  sort_points(sources, source_start_, source_order_);
  for (int a = 0; a < 3; a++) {
    sorted_[a].resize(n_sources_);
    sorted_[a + 3].resize(n_sources_);
    for (int s = 0; s < n_sources_; s++)
      sorted_[a][s] = sources(a, source_order_[s]);
  }
}

void RealSpaceSum::gather_sources(int cell)
{
  const int c2 = cell % n_cells_[2], c1 = cell / n_cells_[2] % n_cells_[1];
  const int c0 = cell / (n_cells_[2] * n_cells_[1]);
  for (auto &g : gathered_)
    g.clear();
  for (int i = std::max(0, c0 - kReach); i <= std::min(n_cells_[0] - 1, c0 + kReach); i++)
    for (int j = std::max(0, c1 - kReach); j <= std::min(n_cells_[1] - 1, c1 + kReach); j++) {
      // search cells along the last axis are contiguous in the sorted order
      const int row = (i * n_cells_[1] + j) * n_cells_[2];
      const int begin = source_start_[row + std::max(0, c2 - kReach)];
      const int end = source_start_[row + std::min(n_cells_[2] - 1, c2 + kReach) + 1];
      for (int a = 0; a < 6; a++)
        gathered_[a].insert(gathered_[a].end(), sorted_[a].begin() + begin,
                            sorted_[a].begin() + end);
    }
  const size_t n = gathered_[0].size() + kVector;
  distance2_.resize(n);
  for (auto &c : close_)
    c.resize(n);
}

int RealSpaceSum::find_close(const Vec3 &target)
{
  const int n = static_cast<int>(gathered_[0].size());
  const double cutoff2 = kernel_.cutoff * kernel_.cutoff;
  const double x = target[0], y = target[1], z = target[2];
  const double *gx = gathered_[0].data(), *gy = gathered_[1].data(), *gz = gathered_[2].data();
  const double *gf[3] = {gathered_[3].data(), gathered_[4].data(), gathered_[5].data()};
  double *d2 = distance2_.data();
#pragma omp simd
  for (int j = 0; j < n; j++) {
    const double dx = x - gx[j], dy = y - gy[j], dz = z - gz[j];
    d2[j] = dx * dx + dy * dy + dz * dz;
  }
  double *c[6];
  for (int a = 0; a < 6; a++)
    c[a] = close_[a].data();
  int m = 0;
  for (int j = 0; j < n; j++) {
    c[0][m] = x - gx[j];
    c[1][m] = y - gy[j];
    c[2][m] = z - gz[j];
    for (int a = 0; a < 3; a++)
      c[a + 3][m] = gf[a][j];
    m += d2[j] < cutoff2;
  }
  n_pairs_ += m;
  for (; m % kVector != 0; m++) {    // harmless fill: at the cutoff, without force
    c[0][m] = kernel_.cutoff;
    for (int a = 1; a < 6; a++)
      c[a][m] = 0.0;
  }
  return m;
}

Vec3 RealSpaceSum::sum_close(int n) const
{
  const double *iso = kernel_.isotropic.data(), *dyad = kernel_.dyadic.data();
  const int n_iso = static_cast<int>(kernel_.isotropic.size());
  const int n_dyad = static_cast<int>(kernel_.dyadic.size());
  const double scale = 2.0 / (kernel_.cutoff * kernel_.cutoff);
  double ux = 0.0, uy = 0.0, uz = 0.0;
  for (int block = 0; block < n; block += kVector) {
    const double *dx = &close_[0][block], *dy = &close_[1][block], *dz = &close_[2][block];
    const double *fx = &close_[3][block], *fy = &close_[4][block], *fz = &close_[5][block];
    double v[kVector], inverse[kVector], alpha[kVector], beta[kVector];
#pragma omp simd
    for (int l = 0; l < kVector; l++) {
      const double r2 = dx[l] * dx[l] + dy[l] * dy[l] + dz[l] * dz[l];
      inverse[l] = r2 > 0.0 ? 1.0 / std::sqrt(r2) : 0.0;
      v[l] = r2 * scale - 1.0;
      alpha[l] = iso[n_iso - 1];
      beta[l] = dyad[n_dyad - 1];
    }
    for (int k = n_iso - 2; k >= 0; k--)
#pragma omp simd
      for (int l = 0; l < kVector; l++)
        alpha[l] = alpha[l] * v[l] + iso[k];
    for (int k = n_dyad - 2; k >= 0; k--)
#pragma omp simd
      for (int l = 0; l < kVector; l++)
        beta[l] = beta[l] * v[l] + dyad[k];
#pragma omp simd reduction(+ : ux, uy, uz)
    for (int l = 0; l < kVector; l++) {    // (1/r - A) f + (1/r^3 - B) r (r.f)
      const double a = inverse[l] - alpha[l];
      const double b = (inverse[l] * inverse[l] * inverse[l] - beta[l]) *
                       (dx[l] * fx[l] + dy[l] * fy[l] + dz[l] * fz[l]);
      ux += a * fx[l] + b * dx[l];
      uy += a * fy[l] + b * dy[l];
      uz += a * fz[l] + b * dz[l];
    }
  }
  return Vec3(ux, uy, uz);
}

void RealSpaceSum::add_single_layer(PointsView strengths, PointsRef velocities)
{
  n_pairs_ = 0;
  if (targets_.cols() == 0 || n_sources_ == 0) return;
  for (int a = 0; a < 3; a++)
    for (int s = 0; s < n_sources_; s++)
      sorted_[a + 3][s] = strengths(a, source_order_[s]);
  const int n_cells = n_cells_[0] * n_cells_[1] * n_cells_[2];
  for (int cell = 0; cell < n_cells; cell++) {
    if (target_start_[cell] == target_start_[cell + 1]) continue;
    gather_sources(cell);
    if (gathered_[0].empty()) continue;
    for (int t = target_start_[cell]; t < target_start_[cell + 1]; t++) {
      const int target = target_order_[t];
      velocities.col(target) += sum_close(find_close(targets_.col(target)));
    }
  }
}

}    // namespace biem
