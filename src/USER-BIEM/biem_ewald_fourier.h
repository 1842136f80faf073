// Fourier part of the periodic Stokeslet sum on a particle mesh, on FFTW-MPI slabs.
// The grid is fixed for the worst tilt; a new cell only changes the wave vectors.
// Knows no surfaces and no real-space part. doc/theory, label spme.
#ifndef BIEM_EWALD_FOURIER_H
#define BIEM_EWALD_FOURIER_H

#include "biem_ewald_parameters.h"
#include "biem_ewald_slab.h"
#include "biem_types.h"
#include <memory>
#include <mpi.h>

namespace biem {

class FourierSum {
 public:
  // Collective over comm. Plans three interleaved real-to-complex transforms.
  FourierSum(MPI_Comm comm, const EwaldParameters &parameters);
  ~FourierSum();
  FourierSum(const FourierSum &) = delete;
  FourierSum &operator=(const FourierSum &) = delete;

  // cell: columns = lattice vectors, upper triangular; origin: its corner. The tilts are first
  // reduced to [-1/2, 1/2) of the lattice vector, so that a flip of the box changes nothing.
  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // This rank's sources and targets anywhere in space (3 x n): routed, windows computed.
  // Collective.
  void set_points(PointsView sources, PointsView targets);
  // velocities (3 x n_targets) += Fourier part for strengths (3 x n_sources). Collective.
  void add_single_layer(PointsView strengths, PointsRef velocities);

 private:
  struct Windows;
  struct Plans;
  void compute_windows(const Points &fractional, Windows &windows) const;
  Points to_fractional(PointsView points) const;
  void spread(const Windows &windows, const Points &strengths);
  void interpolate(const Windows &windows, Points &values) const;
  void apply_kernel();
  double &grid_at(int plane, int row);

  MPI_Comm comm_;
  EwaldParameters parameters_;
  std::unique_ptr<EwaldWindow> window_;
  FourierFactorTable factors_;
  std::unique_ptr<Plans> plans_;
  SlabLayout layout_;
  Mat3 cell_ = Mat3::Identity(), inverse_cell_ = Mat3::Identity();
  Vec3 origin_ = Vec3::Zero();
  std::array<std::vector<double>, 3> influence_;    // per axis and mode
  SlabRouter source_router_, target_router_;
  std::unique_ptr<Windows> source_windows_, target_windows_;
};

}    // namespace biem

#endif
