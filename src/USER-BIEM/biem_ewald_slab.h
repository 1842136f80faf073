// Routes points to the ranks that own the grid planes under their windows, and values there and
// back. Each rank sends only its own points; nothing is gathered. Knows no kernels.
#ifndef BIEM_EWALD_SLAB_H
#define BIEM_EWALD_SLAB_H

#include "biem_types.h"
#include <mpi.h>

namespace biem {

// Rank that owns each plane of the first grid dimension.
std::vector<int> find_plane_owners(MPI_Comm comm, int n_planes);

class SlabRouter {
 public:
  // fractional: 3 x n in [0,1), this rank's points; order: window width in planes. Collective.
  void set_points(MPI_Comm comm, const std::vector<int> &plane_owner, PointsView fractional,
                  int order);

  int n_ranks() const { return n_ranks_; }
  // Points that touch this rank's planes, 3 x n_routed.
  const Points &points() const { return routed_; }
  // values: 3 x n of the owners -> 3 x n_routed, in buffer; on one rank values itself. Collective.
  PointsView send(PointsView values, Points &buffer);
  // Adds 3 x n_routed partial results to the owners' 3 x n. On several ranks only; collective.
  void return_add(const Points &routed, PointsRef values);

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  int n_ranks_ = 1;
  std::vector<int> send_index_;    // point of each sent copy, grouped by rank
  std::vector<int> send_counts_, send_offsets_, receive_counts_, receive_offsets_;    // in doubles
  std::vector<std::vector<int>> destinations_;    // per rank; kept to keep its memory
  Points routed_, out_;
};

}    // namespace biem

#endif
