// What the core needs of the program that distributes the nodes: every rank holds its owned nodes
// first, then ghosts (copies and periodic images of owned nodes, in plain coordinates).
// Knows no LAMMPS; the bridge implements it on LAMMPS' communication, tests on PeriodicGhosts.
#ifndef BIEM_NODE_EXCHANGE_H
#define BIEM_NODE_EXCHANGE_H

namespace biem {

class NodeExchange {
 public:
  virtual ~NodeExchange() = default;
  // values[node][n_columns], owned and ghosts. forward: owned -> their ghosts.
  virtual void forward(double *values, int n_columns) = 0;
  // reverse_add: each ghost's value is added to its owner's.
  virtual void reverse_add(double *values, int n_columns) = 0;
  // Sum of values[n] over all ranks, in place.
  virtual void sum(double *values, int n) = 0;
};

}    // namespace biem

#endif
