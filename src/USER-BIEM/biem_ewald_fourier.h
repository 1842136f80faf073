// Fourier part of the periodic single and double layer sums on a particle mesh, on slabs of a grid:
// 3 forward (4 with a double layer) and 3 backward real transforms. The grid is fixed for the worst
// tilt; a new cell only changes the wave vectors. Without the k = 0 terms.
// Knows no surfaces and no real-space part. doc/theory, label spme.
#ifndef BIEM_EWALD_FOURIER_H
#define BIEM_EWALD_FOURIER_H

#include "biem_ewald_grid.h"
#include "biem_ewald_slab.h"

namespace biem {

constexpr int kNLayers = 3;    // sources are kept by the layers they carry

// CPU seconds of this rank since construction.
struct FourierProfile {
  double windows = 0.0, spread = 0.0, transform = 0.0, kernel = 0.0, interpolate = 0.0;
  double exchange = 0.0;    // points and values to and from the slabs

  double total() const { return windows + spread + transform + kernel + interpolate + exchange; }
};

class FourierSum {
 public:
  FourierSum(MPI_Comm comm, const EwaldParameters &parameters);    // collective

  // cell: columns = lattice vectors, upper triangular; origin: its corner. The tilts are first
  // reduced to [-1/2, 1/2) of the lattice vector, so that a flip of the box changes nothing.
  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // This rank's targets, and its sources that carry the given layers; anywhere in space (3 x n):
  // routed, windows computed. normals of the sources times their areas, not read for single layers.
  // Sources that carry other layers stay. Collective.
  void set_targets(PointsView targets);
  void set_sources(Layers carried, PointsView sources, PointsView normals);
  // One sum: its layers, then the strengths of all sources by what they carry, then
  // velocities (3 x n_targets) += Fourier part. layers of a spread are carried by its sources and
  // are in the sum; forces of the single and densities of the double layer: 3 x n_sources each, not
  // read when layers does not ask for them. All collective.
  void begin(Layers layers);
  void spread(Layers carried, Layers layers, PointsView forces, PointsView densities);
  void add_velocities(PointsRef velocities);

  FourierProfile profile() const;

 private:
  struct Sources {
    SlabRouter router;
    PointWindows windows;
    Points normals;    // routed
  };

  const Points &to_fractional(PointsView points);

  MPI_Comm comm_;
  EwaldParameters parameters_;
  std::unique_ptr<EwaldWindow> window_;
  EwaldGrid grid_;
  std::vector<int> plane_owner_;
  Mat3 cell_ = Mat3::Identity(), inverse_cell_ = Mat3::Identity();
  Vec3 origin_ = Vec3::Zero();
  std::array<Sources, kNLayers> sources_;    // by the layers they carry
  SlabRouter target_router_;
  PointWindows target_windows_;
  Layers layers_ = Layers::Single;    // of the present sum
  // Kept from call to call: fresh memory costs as much as the work on it.
  Points fractional_, routed_forces_, routed_densities_, values_;
  FourierProfile profile_;
};

}    // namespace biem

#endif
