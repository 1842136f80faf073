// Periodic sums: see the header.
#include "biem_ewald_sum.h"
#include "biem_cpu_clock.h"
#include <cmath>

namespace biem {

namespace {

// Polynomials of the real-space kernel are this much more accurate than the sum itself.
constexpr double kKernelMargin = 0.02;

RealSpaceKernel make_kernel(const EwaldParameters &p)
{
  return make_real_space_kernel(*make_split(p), p.cutoff, p.band_limit,
                                kKernelMargin * p.tolerance);
}

}    // namespace

PeriodicSum::PeriodicSum(MPI_Comm comm, const EwaldParameters &parameters) :
    comm_(comm), parameters_(parameters), real_space_(make_kernel(parameters)),
    fourier_(comm, parameters)
{
}

void PeriodicSum::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  volume_ = std::fabs(cell.determinant());
  fourier_.set_cell(cell, origin);
}

void PeriodicSum::set_points(const PeriodicPoints &points)
{
  CpuClock clock;
  owned_ = points.targets.leftCols(points.n_owned);
  normals_ = points.normals;
  unwrapped_ = points.unwrapped.cols() > 0 ? points.unwrapped : points.sources;
  real_space_.set_points(points.targets, points.sources, points.normals);
  profile_.search += clock.restart();
  fourier_.set_points(owned_, points.sources, points.normals);
}

void PeriodicSum::add_layers(Layers layers, PointsView forces, PointsView densities,
                             NodeExchange &exchange, PointsRef velocities)
{
  CpuClock clock;
  real_space_.add_layers(layers, forces, densities, velocities);
  profile_.real_space += clock.restart();
  profile_.n_pairs = real_space_.n_pairs();
  exchange.reverse_add(velocities.data(), 3);
  profile_.ghosts += clock.restart();
  fourier_.add_layers(layers, forces, densities, velocities.leftCols(owned_.cols()));
  if (has_double(layers)) add_mean(densities, velocities.leftCols(owned_.cols()));
}

void PeriodicSum::add_mean(PointsView densities, PointsRef velocities) const
{
  double moments[4] = {};    // sum (q.n) y, sum q.n
  for (Eigen::Index s = 0; s < densities.cols(); s++) {
    const double flux = densities.col(s).dot(normals_.col(s));
    for (int a = 0; a < 3; a++)
      moments[a] += flux * unwrapped_(a, s);
    moments[3] += flux;
  }
  MPI_Allreduce(MPI_IN_PLACE, moments, 4, MPI_DOUBLE, MPI_SUM, comm_);
  const Vec3 moment(moments[0], moments[1], moments[2]);
  velocities += 8.0 * M_PI / volume_ * (moment.replicate(1, owned_.cols()) - moments[3] * owned_);
}

PeriodicSumProfile PeriodicSum::profile() const
{
  PeriodicSumProfile result = profile_;
  result.fourier = fourier_.profile();
  return result;
}

}    // namespace biem
