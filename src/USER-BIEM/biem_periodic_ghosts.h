// Periodic images of distributed nodes and the exchange between nodes and images, for the core's
// own tests, benchmarks and programs without LAMMPS (under LAMMPS the ghosts come from its domain
// decomposition). Knows points, the cell and MPI; no mesh and no physics.
#ifndef BIEM_PERIODIC_GHOSTS_H
#define BIEM_PERIODIC_GHOSTS_H

#include "biem_node_exchange.h"
#include "biem_types.h"
#include <mpi.h>

namespace biem {

class PeriodicGhosts : public NodeExchange {
 public:
  // Collective. owned: 3 x n of this rank, anywhere, n may be 0; cell: lattice vectors in columns;
  // reach: length. Ghosts are all images of all ranks' nodes, except the rank's own nodes as they
  // are, within reach of the bounding box of the rank's owned nodes (a box along x, y, z). A rank
  // without nodes has no ghosts. Keep the nodes of a rank together: the box should be small.
  PeriodicGhosts(MPI_Comm comm, PointsView owned, const Mat3 &cell, double reach);
  // One rank alone.
  PeriodicGhosts(PointsView owned, const Mat3 &cell, double reach) :
      PeriodicGhosts(MPI_COMM_SELF, owned, cell, reach)
  {
  }

  const Points &nodes() const { return nodes_; }    // owned first, then ghosts
  int n_owned() const { return n_owned_; }

  // All three are collective; see NodeExchange.
  void forward(double *values, int n_columns) override;
  void reverse_add(double *values, int n_columns) override;
  void sum(double *values, int n) override;

 private:
  using Box = Eigen::AlignedBox3d;
  // Ghosts or sent nodes of one rank: a range of the ghosts or of sent_.
  struct Block {
    int rank, first, n;
  };

  std::vector<Box> gather_boxes(PointsView owned) const;
  // images: positions x0 y0 z0 x1 ... of the nodes in sent_, moved to their receivers.
  void list_sent(PointsView owned, const Mat3 &cell, const std::vector<Box> &boxes, double reach,
                 std::vector<double> &images);
  void list_received();
  // Blocks of source to the ranks' blocks of destination; sent images and ghosts, either way.
  void exchange(const std::vector<Block> &out, const double *source, const std::vector<Block> &in,
                double *destination, int n_columns);

  MPI_Comm comm_;
  int rank_ = 0, n_ranks_ = 1;
  int n_owned_;
  Points nodes_;
  std::vector<int> sent_;          // owned node behind each image, by receiving rank
  std::vector<Block> sends_;       // ranges of sent_, own rank included
  std::vector<Block> receives_;    // ranges of the ghosts, own rank included
  std::vector<double> buffer_;     // values of sent_
  std::vector<MPI_Request> requests_;
};

// Rank of each point (3 x n, anywhere) when the cell is cut into n_ranks equal bricks along its
// lattice vectors, with the least surface. Points are taken at their image inside the cell: wrap
// them before they become the owned nodes of a rank, or the box of the rank is as wide as the cell.
std::vector<int> assign_to_ranks(PointsView points, const Mat3 &cell, int n_ranks);

}    // namespace biem

#endif
