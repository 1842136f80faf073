// Measured error of a distributed periodic sum: its velocities at some of the points against the
// direct Ewald sum. The reference is computed once for each layer and set of points.
#ifndef BIEM_BENCH_REFERENCE_H
#define BIEM_BENCH_REFERENCE_H

#include "bench_points.h"
#include <mpi.h>

namespace biem_bench {

class Reference {
 public:
  // n_targets of the points, evenly chosen; owned: indices of this rank's points, ascending.
  Reference(MPI_Comm comm, const PointSet &set, const std::vector<int> &owned, int n_targets);

  // velocities: 3 x n_owned of this rank. Root mean square error over the root mean square
  // velocity at the targets; collective. No targets: not a number.
  double compute_error(biem::Layers layers, biem::PointsView velocities);

 private:
  // Sums over the sources of this rank in blocks that fit in the cache, then over the ranks.
  const biem::Points &get(biem::Layers layer);

  MPI_Comm comm_;
  const PointSet &set_;
  std::vector<int> owned_;
  std::vector<int> targets_;    // points
  std::vector<int> columns_;    // of the targets in the owned points; -1: other rank
  biem::Points positions_;
  biem::Points single_, double_;    // 3 x n_targets; empty: not yet computed
};

}    // namespace biem_bench

#endif
