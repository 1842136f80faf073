// Single-rank periodic images: see the header.
#include "biem_periodic_ghosts.h"
#include <cmath>

namespace biem {

PeriodicGhosts::PeriodicGhosts(PointsView owned, const Mat3 &cell, double reach) :
    n_owned_(static_cast<int>(owned.cols()))
{
  const Vec3 low = owned.rowwise().minCoeff().array() - reach;
  const Vec3 high = owned.rowwise().maxCoeff().array() + reach;
  int count[3];
  for (int a = 0; a < 3; a++) {    // images along a: extent over the distance of lattice planes
    const Vec3 normal = cell.col((a + 1) % 3).cross(cell.col((a + 2) % 3)).normalized();
    const double spacing = std::fabs(normal.dot(cell.col(a)));
    count[a] = static_cast<int>(std::ceil((high - low).norm() / spacing));
  }
  std::vector<Vec3> images;
  for (int i = -count[0]; i <= count[0]; i++)
    for (int j = -count[1]; j <= count[1]; j++)
      for (int k = -count[2]; k <= count[2]; k++) {
        if (i == 0 && j == 0 && k == 0) continue;
        const Vec3 shift = cell * Vec3(i, j, k);
        for (int n = 0; n < n_owned_; n++) {
          const Vec3 x = owned.col(n) + shift;
          if ((x.array() < low.array()).any() || (x.array() > high.array()).any()) continue;
          images.push_back(x);
          owner_.push_back(n);
        }
      }
  nodes_.resize(3, n_owned_ + images.size());
  nodes_.leftCols(n_owned_) = owned;
  for (size_t g = 0; g < images.size(); g++)
    nodes_.col(n_owned_ + g) = images[g];
}

void PeriodicGhosts::forward(double *values, int n)
{
  for (size_t g = 0; g < owner_.size(); g++)
    for (int c = 0; c < n; c++)
      values[(n_owned_ + g) * n + c] = values[owner_[g] * n + c];
}

void PeriodicGhosts::reverse_add(double *values, int n)
{
  for (size_t g = 0; g < owner_.size(); g++)
    for (int c = 0; c < n; c++)
      values[owner_[g] * n + c] += values[(n_owned_ + g) * n + c];
}

}    // namespace biem
