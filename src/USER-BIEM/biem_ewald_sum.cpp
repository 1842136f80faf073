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

std::optional<Layers> find_common(Layers a, Layers b)
{
  const bool is_single = has_single(a) && has_single(b), is_double = has_double(a) && has_double(b);
  if (is_single && is_double) return Layers::Both;
  if (is_single) return Layers::Single;
  if (is_double) return Layers::Double;
  return std::nullopt;
}

void gather(PointsView all, const std::vector<int> &index, Points &part)
{
  part.resize(3, static_cast<Eigen::Index>(index.size()));
  for (size_t i = 0; i < index.size(); i++)
    part.col(i) = all.col(index[i]);
}

void scatter_add(PointsView part, const std::vector<int> &index, PointsRef all)
{
  for (Eigen::Index i = 0; i < part.cols(); i++)
    all.col(index[i]) += part.col(i);
}

}    // namespace

PeriodicSum::PeriodicSum(MPI_Comm comm, const EwaldParameters &parameters) :
    comm_(comm), parameters_(parameters), fourier_(comm, parameters)
{
  const RealSpaceKernel kernel = make_kernel(parameters);
  for (Layers carried : {Layers::Single, Layers::Double, Layers::Both})
    groups_.emplace_back(carried, kernel);
}

void PeriodicSum::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  volume_ = std::fabs(cell.determinant());
  fourier_.set_cell(cell, origin);
}

void PeriodicSum::set_points(const PeriodicPoints &points, Layers layers)
{
  CpuClock clock;
  set_targets(points);
  list_groups(points, layers);
  profile_.search += clock.restart();
  fourier_.set_targets(targets_.leftCols(n_owned_targets_));
  for (Group &group : groups_)
    if (group.is_present) set_sources(points, group);
}

void PeriodicSum::set_targets(const PeriodicPoints &points)
{
  has_mask_ = points.is_target != nullptr;
  if (!has_mask_) {
    targets_ = points.targets.leftCols(points.n_owned);
    n_owned_targets_ = points.n_owned;
    return;
  }
  target_index_.clear();
  for (int i = 0; i < points.targets.cols(); i++) {
    if (i == points.n_owned) n_owned_targets_ = static_cast<Eigen::Index>(target_index_.size());
    if ((*points.is_target)[i]) target_index_.push_back(i);
  }
  if (points.targets.cols() == points.n_owned)
    n_owned_targets_ = static_cast<Eigen::Index>(target_index_.size());
  gather(points.targets, target_index_, targets_);
}

void PeriodicSum::list_groups(const PeriodicPoints &points, Layers layers)
{
  for (Group &group : groups_) {
    group.is_whole = group.is_present = !points.source_layers && group.carried == layers;
    group.index.clear();
  }
  if (!points.source_layers) return;
  for (size_t s = 0; s < points.source_layers->size(); s++)
    if (const auto carried = find_common((*points.source_layers)[s], layers))
      groups_[static_cast<int>(*carried)].index.push_back(static_cast<int>(s));
  int is_present[kNLayers];
  for (int g = 0; g < kNLayers; g++)
    is_present[g] = !groups_[g].index.empty();
  MPI_Allreduce(MPI_IN_PLACE, is_present, kNLayers, MPI_INT, MPI_MAX, comm_);
  for (int g = 0; g < kNLayers; g++)
    groups_[g].is_present = is_present[g] != 0;
}

void PeriodicSum::set_sources(const PeriodicPoints &points, Group &group)
{
  CpuClock clock;
  const PointsView all_unwrapped = points.unwrapped.cols() > 0 ? points.unwrapped : points.sources;
  Points part;
  if (!group.is_whole) gather(points.sources, group.index, part);
  const PointsView sources = group.is_whole ? points.sources : PointsView(part);
  if (!has_double(group.carried)) {
    group.normals.resize(3, 0);
  } else if (group.is_whole) {
    group.normals = points.normals;
    group.unwrapped = all_unwrapped;
  } else {
    gather(points.normals, group.index, group.normals);
    gather(all_unwrapped, group.index, group.unwrapped);
  }
  group.real_space.set_points(has_mask_ ? PointsView(targets_) : points.targets, sources,
                              group.normals);
  profile_.search += clock.restart();
  fourier_.set_sources(group.carried, sources, group.normals);
}

void PeriodicSum::add_layers(Layers layers, PointsView forces, PointsView densities,
                             NodeExchange &exchange, PointsRef velocities)
{
  CpuClock clock;
  profile_.n_pairs = 0;
  if (has_mask_) velocities_.setZero(3, targets_.cols());
  PointsRef near = has_mask_ ? PointsRef(velocities_) : velocities;
  for (Group &group : groups_)
    if (const auto common = group.find_common(layers)) {
      if (!group.is_whole && has_single(*common)) gather(forces, group.index, group.forces);
      if (!group.is_whole && has_double(*common)) gather(densities, group.index, group.densities);
      group.real_space.add_layers(*common, group.is_whole ? forces : PointsView(group.forces),
                                  group.is_whole ? densities : PointsView(group.densities), near);
      profile_.n_pairs += group.real_space.n_pairs();
    }
  if (has_mask_) scatter_add(velocities_, target_index_, velocities);
  profile_.real_space += clock.restart();
  exchange.reverse_add(velocities.data(), 3);
  profile_.ghosts += clock.restart();
  if (has_mask_) velocities_.setZero(3, n_owned_targets_);
  add_smooth(layers, forces, densities,
             has_mask_ ? PointsRef(velocities_) : velocities.leftCols(n_owned_targets_));
  if (has_mask_) scatter_add(velocities_, target_index_, velocities);
}

void PeriodicSum::add_smooth(Layers layers, PointsView forces, PointsView densities,
                             PointsRef velocities)
{
  double moments[4] = {};    // sum (q.n) y, sum q.n
  fourier_.begin(layers);
  for (const Group &group : groups_)
    if (const auto common = group.find_common(layers)) {
      const PointsView q = group.is_whole ? densities : PointsView(group.densities);
      const PointsView f = group.is_whole ? forces : PointsView(group.forces);
      fourier_.spread(group.carried, *common, f, q);
      if (has_double(*common)) group.add_moments(q, moments);
    }
  fourier_.add_velocities(velocities);
  if (!has_double(layers)) return;
  MPI_Allreduce(MPI_IN_PLACE, moments, 4, MPI_DOUBLE, MPI_SUM, comm_);
  const Vec3 moment(moments[0], moments[1], moments[2]);
  velocities += 8.0 * M_PI / volume_ *
                (moment.replicate(1, n_owned_targets_) -
                 moments[3] * targets_.leftCols(n_owned_targets_));
}

std::optional<Layers> PeriodicSum::Group::find_common(Layers layers) const
{
  return is_present ? biem::find_common(carried, layers) : std::nullopt;
}

void PeriodicSum::Group::add_moments(PointsView q, double *moments) const
{
  for (Eigen::Index s = 0; s < q.cols(); s++) {
    const double flux = q.col(s).dot(normals.col(s));
    for (int a = 0; a < 3; a++)
      moments[a] += flux * unwrapped(a, s);
    moments[3] += flux;
  }
}

PeriodicSumProfile PeriodicSum::profile() const
{
  PeriodicSumProfile result = profile_;
  result.fourier = fourier_.profile();
  return result;
}

}    // namespace biem
