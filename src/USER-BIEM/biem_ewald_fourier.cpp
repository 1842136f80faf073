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

void FourierSum::set_points(PointsView targets, PointsView sources, PointsView normals)
{
  CpuClock clock;
  source_router_.set_points(comm_, plane_owner_, to_fractional(sources), parameters_.order);
  target_router_.set_points(comm_, plane_owner_, to_fractional(targets), parameters_.order);
  int has_normals = normals.cols() > 0;
  MPI_Allreduce(MPI_IN_PLACE, &has_normals, 1, MPI_INT, MPI_MAX, comm_);
  if (has_normals) normals_ = Points(source_router_.send(normals, routed_densities_));
  profile_.exchange += clock.restart();
  source_windows_.set_points(*window_, parameters_.grid, source_router_.points(),
                             has_normals ? WindowContent::ValuesAndSlopes : WindowContent::Values);
  target_windows_.set_points(*window_, parameters_.grid, target_router_.points(),
                             WindowContent::Values);
  profile_.windows += clock.restart();
}

void FourierSum::spread(Layers layers, PointsView forces, PointsView densities)
{
  CpuClock clock;
  const Points none(3, 0);
  const PointsView routed_forces = has_single(layers) ? source_router_.send(forces, routed_forces_)
                                                      : PointsView(none);
  const PointsView routed_densities =
      has_double(layers) ? source_router_.send(densities, routed_densities_) : PointsView(none);
  profile_.exchange += clock.restart();
  const GridSlab slab = grid_.clear(layers);
  if (has_double(layers)) {
    Mat3 to_grid = inverse_cell_;
    for (int a = 0; a < 3; a++)
      to_grid.row(a) *= parameters_.grid[a];
    source_windows_.spread_layers(slab, routed_forces, routed_densities, normals_, to_grid);
  } else {
    source_windows_.spread_forces(slab, routed_forces);
  }
  profile_.spread += clock.restart();
}

void FourierSum::add_layers(Layers layers, PointsView forces, PointsView densities,
                            PointsRef velocities)
{
  spread(layers, forces, densities);
  grid_.convolve(layers, cell_);
  CpuClock clock;
  if (target_router_.n_ranks() == 1) {
    target_windows_.interpolate(grid_.slab(3), velocities);
    profile_.interpolate += clock.restart();
    return;
  }
  values_.setZero(3, target_router_.points().cols());
  target_windows_.interpolate(grid_.slab(3), values_);
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
