// Distance from a point of the half plane (rho, z) to the meridian curve, tabulated.
// Does not know the bodies' positions.
#include "biem_mesh_signed_distance.h"

#include <algorithm>
#include <cmath>

namespace biem {

SignedDistanceTable::SignedDistanceTable(const Shape &shape, double scale, double reach) :
    reach_(reach)
{
  const int n_segments = 500;
  const double quarter = std::acos(0.0);
  double height = 0.0;
  bounding_radius_ = 0.0;
  for (int i = 0; i <= n_segments; i++) {
    MeridianPoint point = shape.compute_meridian_point(quarter * i / n_segments);
    point.rho *= scale;
    point.z *= scale;
    bounding_radius_ = std::max(bounding_radius_, std::hypot(point.rho, point.z));
    height = std::max(height, point.z);
    meridian_.push_back(point);
  }
  meridian_.front().rho = meridian_.back().z = 0.0;

  spacing_ = bounding_radius_ / 100.0;
  n_rho_ = static_cast<int>((bounding_radius_ + reach) / spacing_) + 2;
  n_z_ = static_cast<int>((height + reach) / spacing_) + 2;
  value_.resize(static_cast<std::size_t>(n_rho_) * n_z_);
  for (int j = 0; j < n_z_; j++)
    for (int i = 0; i < n_rho_; i++)
      value_[j * n_rho_ + i] = compute_exact(i * spacing_, j * spacing_);
}

// The sign comes from the crossings of a ray towards larger rho with the meridian.
double SignedDistanceTable::compute_exact(double rho, double z) const
{
  double squared = 1e300;
  bool is_inside = false;
  for (std::size_t i = 0; i + 1 < meridian_.size(); i++) {
    const MeridianPoint &p = meridian_[i], &q = meridian_[i + 1];
    const double d_rho = q.rho - p.rho, d_z = q.z - p.z;
    double t = ((rho - p.rho) * d_rho + (z - p.z) * d_z) / (d_rho * d_rho + d_z * d_z);
    t = std::min(1.0, std::max(0.0, t));
    const double r = p.rho + t * d_rho - rho, h = p.z + t * d_z - z;
    squared = std::min(squared, r * r + h * h);
    if ((p.z > z) != (q.z > z) && p.rho + (z - p.z) / d_z * d_rho > rho) is_inside = !is_inside;
  }
  return is_inside ? -std::sqrt(squared) : std::sqrt(squared);
}

SignedDistance SignedDistanceTable::evaluate(const Vec3 &point) const
{
  const double rho = std::hypot(point[0], point[1]), z = std::abs(point[2]);
  const double x = rho / spacing_, y = z / spacing_;
  if (x >= n_rho_ - 1 || y >= n_z_ - 1) return {reach_, point / std::hypot(rho, z)};
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  const double *low = &value_[j * n_rho_ + i], *high = low + n_rho_;
  const double value = (1.0 - v) * ((1.0 - u) * low[0] + u * low[1]) +
      v * ((1.0 - u) * high[0] + u * high[1]);
  const double along_rho = ((1.0 - v) * (low[1] - low[0]) + v * (high[1] - high[0])) / spacing_;
  const double along_z = ((1.0 - u) * (high[0] - low[0]) + u * (high[1] - low[1])) / spacing_;
  const double inverse = rho > 0.0 ? 1.0 / rho : 0.0;
  const Vec3 normal(along_rho * point[0] * inverse, along_rho * point[1] * inverse,
                    point[2] < 0.0 ? -along_z : along_z);
  return {std::min(value, reach_), normal};
}

}    // namespace biem
