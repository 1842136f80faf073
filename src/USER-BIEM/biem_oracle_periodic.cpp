// Direct Ewald sum: see the header. O(n_t n_s) per lattice vector and O((n_t + n_s) n_k).
#include "biem_oracle_periodic.h"
#include <cmath>
#include <complex>

namespace biem {

namespace {

constexpr double kDecay = 6.1;    // exp(-kDecay^2) = 7e-17

Eigen::Vector3i count_vectors(const Mat3 &lattice, double radius)
{
  Eigen::Vector3i count;    // |n_a| <= radius / distance of the lattice planes
  const Mat3 dual = lattice.inverse();
  for (int a = 0; a < 3; a++)
    count[a] = static_cast<int>(std::ceil(radius * dual.row(a).norm()));
  return count;
}

void add_real_part(const Mat3 &cell, PointsView targets, PointsView sources, PointsView forces,
                   double xi, Points &u)
{
  const double cutoff = kDecay / xi;
  const Mat3 inverse = cell.inverse();
  const Eigen::Vector3i count = count_vectors(cell, cutoff) + Eigen::Vector3i::Ones();
  for (Eigen::Index t = 0; t < targets.cols(); t++)
    for (Eigen::Index s = 0; s < sources.cols(); s++) {
      Vec3 r0 = targets.col(t) - sources.col(s);
      const Vec3 fractional = inverse * r0;
      for (int a = 0; a < 3; a++)
        r0 -= std::round(fractional[a]) * cell.col(a);
      for (int i = -count[0]; i <= count[0]; i++)
        for (int j = -count[1]; j <= count[1]; j++)
          for (int k = -count[2]; k <= count[2]; k++) {
            const Vec3 r = r0 + cell * Vec3(i, j, k);
            const double d = r.norm();
            if (d > cutoff) continue;
            if (d < 1e-13 * cell.norm()) {
              u.col(t) -= 4.0 * xi / std::sqrt(M_PI) * forces.col(s);
              continue;
            }
            const double e = std::erfc(xi * d) / d;
            const double g = 2.0 * xi / std::sqrt(M_PI) * std::exp(-xi * xi * d * d);
            u.col(t) += (e - g) * forces.col(s) + (e + g) / (d * d) * r.dot(forces.col(s)) * r;
          }
    }
}

void add_fourier_part(const Mat3 &cell, PointsView targets, PointsView sources, PointsView forces,
                      double xi, Points &u)
{
  const double limit = 2.0 * kDecay * xi;
  const Mat3 reciprocal = 2.0 * M_PI * cell.inverse().transpose();
  const Eigen::Vector3i count = count_vectors(reciprocal, limit);
  const double volume = std::fabs(cell.determinant());
  for (int i = -count[0]; i <= count[0]; i++)
    for (int j = -count[1]; j <= count[1]; j++)
      for (int l = -count[2]; l <= count[2]; l++) {
        const Vec3 k = reciprocal * Vec3(i, j, l);
        const double k2 = k.squaredNorm();
        if (k2 == 0.0 || k2 > limit * limit) continue;
        Eigen::Vector3cd amplitude = Eigen::Vector3cd::Zero();
        for (Eigen::Index s = 0; s < sources.cols(); s++)
          amplitude += std::polar(1.0, -k.dot(sources.col(s))) * forces.col(s);
        amplitude -= k * (k.transpose() * amplitude)(0, 0) / k2;
        const double q = k2 / (4.0 * xi * xi);
        amplitude *= 8.0 * M_PI / (k2 * volume) * (1.0 + q) * std::exp(-q);
        for (Eigen::Index t = 0; t < targets.cols(); t++)
          u.col(t) += (std::polar(1.0, k.dot(targets.col(t))) * amplitude).real();
      }
}

}    // namespace

Points compute_oracle_single_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView forces, double splitting)
{
  const double xi = splitting > 0.0 ? splitting
                                    : std::sqrt(M_PI) / std::cbrt(std::fabs(cell.determinant()));
  Points u = Points::Zero(3, targets.cols());
  add_real_part(cell, targets, sources, forces, xi, u);
  add_fourier_part(cell, targets, sources, forces, xi, u);
  return u;
}

}    // namespace biem
