// Real-to-complex transforms of interleaved fields on slabs of a periodic grid, pruned to the modes
// that are kept, so that later stages and messages shrink with them. Each rank holds planes of the
// first axis on the real side and columns along it (all n0 of some (n1, n2)) on the Fourier side.
// Knows no kernels and no points. doc/theory, label spme.
#ifndef BIEM_EWALD_TRANSFORM_H
#define BIEM_EWALD_TRANSFORM_H

#include <array>
#include <complex>
#include <memory>
#include <mpi.h>
#include <vector>

namespace biem {

// A range of equal parts of n things, one part per rank.
struct RankRange {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};
RankRange get_rank_range(int n, int rank, int n_ranks);

class SlabTransform {
 public:
  static constexpr int kMaxFields = 4, kBackwardFields = 3;
  using Complex = std::complex<double>;

  // modes: largest |n_a| kept, below half of the grid. Plans (well below a second). Collective.
  SlabTransform(MPI_Comm comm, const std::array<int, 3> &grid, const std::array<int, 3> &modes);
  ~SlabTransform();
  SlabTransform(const SlabTransform &) = delete;
  SlabTransform &operator=(const SlabTransform &) = delete;

  // Planes: with n interleaved fields, field f at (plane, row, z) is
  // [plane * plane_size(n) + (row * M_2 + z) * n + f]. kMargin doubles before and after may be
  // read and written.
  static constexpr int kMargin = 80;
  double *values(int n_fields);    // allocates
  std::ptrdiff_t plane_size(int n_fields) const;
  RankRange planes() const { return planes_; }

  // Values of n_fields -> columns. Collective.
  void forward(int n_fields);
  // Columns of kBackwardFields fields -> values. Collective.
  void backward();

  // Columns of this rank: after forward(), mode n0 (0 ... M_0 - 1) of field f is
  // column(i)[f * M_0 + n0].
  int n_columns() const { return columns_.size(); }
  std::array<int, 2> column_modes(int i) const;    // signed n1, n2 >= 0
  Complex *column(int i);
  // Transforms of columns [begin, end) along the first axis, in place.
  void forward_columns(int begin, int end, int n_fields);
  void backward_columns(int begin, int end);

 private:
  struct Plans;
  // Blocks hold the kept modes of some planes: planes x fields x columns.
  void columns_from_block(const Complex *block, RankRange planes, int n_fields);
  void block_from_columns(Complex *block, RankRange planes, int n_fields);
  enum class Direction { ToColumns, ToPlanes };
  void exchange(int n_fields, const Complex *send, Complex *receive, Direction direction);

  MPI_Comm comm_;
  int rank_ = 0, n_ranks_ = 1;
  std::array<int, 3> grid_, modes_;
  RankRange planes_, columns_;
  int n_all_columns_;
  std::ptrdiff_t column_stride_ = 0;    // complex numbers per column
  std::unique_ptr<Plans> plans_;
};

}    // namespace biem

#endif
