// Particle-mesh sum on slabs: spread, transform, project and scale, transform back, interpolate.
#include "biem_ewald_fourier.h"
#include "biem_cpu_clock.h"
#include <cmath>

namespace biem {

FourierSum::FourierSum(MPI_Comm comm, const EwaldParameters &parameters) :
    comm_(comm), parameters_(parameters), window_(make_window(parameters)), grid_(comm, parameters),
    plane_owner_(find_plane_owners(comm, parameters.grid[0]))
{
}

void FourierSum::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  // The small bias takes +1/2 and -1/2, with their rounding errors, to the same side.
  auto reduce = [](double tilt, double length) {
    return std::floor(tilt / length + 0.5 + 1e-9);
  };
  cell_ = cell;
  cell_.col(2) -= reduce(cell_(1, 2), cell_(1, 1)) * cell_.col(1);
  cell_.col(2) -= reduce(cell_(0, 2), cell_(0, 0)) * cell_.col(0);
  cell_.col(1) -= reduce(cell_(0, 1), cell_(0, 0)) * cell_.col(0);
  origin_ = origin;
  inverse_cell_ = cell_.inverse();
}

const Points &FourierSum::to_fractional(PointsView points)
{
  fractional_.resize(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); i++) {
    fractional_.col(i) = inverse_cell_ * (points.col(i) - origin_);
    for (int a = 0; a < 3; a++) {
      double &value = fractional_(a, i);
      value -= std::floor(value);
      if (value >= 1.0) value = 0.0;    // a tiny negative number rounds to 1
    }
  }
  return fractional_;
}

void FourierSum::set_targets(PointsView targets)
{
  CpuClock clock;
  target_router_.set_points(comm_, plane_owner_, to_fractional(targets), parameters_.order);
  profile_.exchange += clock.restart();
  target_windows_.set_points(*window_, parameters_.grid, target_router_.points(),
                             WindowContent::Values);
  profile_.windows += clock.restart();
}

void FourierSum::set_sources(Layers carried, PointsView points, PointsView normals)
{
  CpuClock clock;
  Sources &sources = sources_[static_cast<int>(carried)];
  sources.router.set_points(comm_, plane_owner_, to_fractional(points), parameters_.order);
  if (has_double(carried)) sources.normals = sources.router.send(normals, routed_densities_);
  profile_.exchange += clock.restart();
  sources.windows.set_points(*window_, parameters_.grid, sources.router.points(),
                             has_double(carried) ? WindowContent::ValuesAndSlopes
                                                 : WindowContent::Values);
  profile_.windows += clock.restart();
}

void FourierSum::begin(Layers layers)
{
  CpuClock clock;
  layers_ = layers;
  grid_.clear(layers);
  profile_.spread += clock.restart();
}

void FourierSum::spread(Layers carried, Layers layers, PointsView forces, PointsView densities)
{
  CpuClock clock;
  Sources &sources = sources_[static_cast<int>(carried)];
  const Points none(3, 0);
  const PointsView routed_forces = has_single(layers) ? sources.router.send(forces, routed_forces_)
                                                      : PointsView(none);
  const PointsView routed_densities =
      has_double(layers) ? sources.router.send(densities, routed_densities_) : PointsView(none);
  profile_.exchange += clock.restart();
  const GridSlab slab = grid_.slab(layers_);
  if (has_double(layers)) {
    Mat3 to_grid = inverse_cell_;
    for (int a = 0; a < 3; a++)
      to_grid.row(a) *= parameters_.grid[a];
    sources.windows.spread_layers(slab, routed_forces, routed_densities, sources.normals, to_grid);
  } else {
    sources.windows.spread_forces(slab, routed_forces);
  }
  profile_.spread += clock.restart();
}

void FourierSum::add_velocities(PointsRef velocities)
{
  grid_.convolve(layers_, cell_);
  CpuClock clock;
  const GridSlab slab = grid_.slab(Layers::Single);
  if (target_router_.n_ranks() == 1) {
    target_windows_.interpolate(slab, velocities);
    profile_.interpolate += clock.restart();
    return;
  }
  values_.setZero(3, target_router_.points().cols());
  target_windows_.interpolate(slab, values_);
  profile_.interpolate += clock.restart();
  target_router_.return_add(values_, velocities);
  profile_.exchange += clock.restart();
}

FourierProfile FourierSum::profile() const
{
  FourierProfile result = profile_;
  result.transform = grid_.profile().transform;
  result.kernel = grid_.profile().kernel;
  return result;
}

}    // namespace biem
