// Periodic images of the nodes of a single rank, for the core's own tests and benchmarks (under
// LAMMPS the ghosts come from its domain decomposition). Plain and slow; knows no ranks.
#ifndef BIEM_PERIODIC_GHOSTS_H
#define BIEM_PERIODIC_GHOSTS_H

#include "biem_node_exchange.h"
#include "biem_types.h"

namespace biem {

class PeriodicGhosts : public NodeExchange {
 public:
  // owned: 3 x n anywhere; cell: lattice vectors in columns; ghosts: every image within reach of
  // the bounding box of the owned nodes.
  PeriodicGhosts(PointsView owned, const Mat3 &cell, double reach);

  const Points &nodes() const { return nodes_; }    // owned first, then ghosts
  int n_owned() const { return n_owned_; }

  void forward(double *values, int n_columns) override;
  void reverse_add(double *values, int n_columns) override;
  void sum(double *, int) override {}    // one rank: nothing to add

 private:
  int n_owned_;
  Points nodes_;
  std::vector<int> owner_;    // of each ghost
};

}    // namespace biem

#endif
