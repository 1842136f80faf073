// The grid of the particle mesh on FFTW-MPI slabs: memory, transforms, and the multiplication of
// the Fourier modes by the periodic Stokes kernel. Three fields, a force density; with a double
// layer a fourth, the scalar tr D. Knows no points. doc/theory, label spme.
#ifndef BIEM_EWALD_GRID_H
#define BIEM_EWALD_GRID_H

#include "biem_ewald_parameters.h"
#include "biem_ewald_slab.h"
#include "biem_ewald_spread.h"
#include <memory>
#include <mpi.h>

namespace biem {

class EwaldGrid {
 public:
  // Collective over comm. Plans the transforms: takes up to seconds for large grids.
  EwaldGrid(MPI_Comm comm, const EwaldParameters &parameters);
  ~EwaldGrid();
  EwaldGrid(const EwaldGrid &) = delete;
  EwaldGrid &operator=(const EwaldGrid &) = delete;

  const GridSlab &slab() const { return slab_; }
  const SlabLayout &layout() const { return layout_; }

  void clear(Layers layers);
  // In place: fields -> modes of the velocity; cell: columns = lattice vectors. Collective.
  void forward(Layers layers);
  void apply_kernel(Layers layers, const Mat3 &cell);
  void backward();

 private:
  struct Plans;
  template <Layers layers> void multiply_row(int n0, int n1, ptrdiff_t row, const Mat3 &cell);
  void allocate(int n_components);

  EwaldParameters parameters_;
  FourierFactorTable factors_;
  std::array<std::vector<double>, 3> influence_;    // per axis and mode
  std::unique_ptr<Plans> plans_;
  GridSlab slab_;
  SlabLayout layout_;
};

}    // namespace biem

#endif
