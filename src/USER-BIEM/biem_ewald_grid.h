// The convolution of the particle mesh: fields on the grid -> Fourier modes -> times the periodic
// Stokes kernel -> velocities on the grid. Three fields, a force density; with a double layer a
// fourth, the scalar tr D. Knows no points. doc/theory, label spme.
#ifndef BIEM_EWALD_GRID_H
#define BIEM_EWALD_GRID_H

#include "biem_ewald_parameters.h"
#include "biem_ewald_spread.h"
#include "biem_ewald_transform.h"

namespace biem {

// CPU seconds since construction.
struct EwaldGridProfile {
  double transform = 0.0, kernel = 0.0;
};

class EwaldGrid {
 public:
  EwaldGrid(MPI_Comm comm, const EwaldParameters &parameters);    // collective

  // This rank's planes for the fields of the layers as they are before the convolution; after it,
  // the velocities are those of a single layer.
  GridSlab slab(Layers layers);
  void clear(Layers layers);
  // Fields -> velocities; cell: columns = lattice vectors. Collective.
  void convolve(Layers layers, const Mat3 &cell);

  RankRange planes() const { return transform_.planes(); }
  const EwaldGridProfile &profile() const { return profile_; }

 private:
  struct Wave;
  template <Layers layers> void multiply_column(int i, const Wave &wave);

  EwaldParameters parameters_;
  FourierFactorTable factors_;
  std::array<std::vector<double>, 3> influence_;    // per axis and mode
  SlabTransform transform_;
  EwaldGridProfile profile_;
};

}    // namespace biem

#endif
