// One rank's share of a suspension of red cells, as LAMMPS would deal it: nodes by place, triangles
// and hinges with their second node, ghosts around them, candidates of the near rule.
// Knows no velocities and no times.
#ifndef BIEM_BENCH_SUSPENSION_SHARE_H
#define BIEM_BENCH_SUSPENSION_SHARE_H

#include "biem_membrane_bend.h"
#include "biem_membrane_skalak.h"
#include "biem_periodic_ghosts.h"
#include "biem_suspension.h"

namespace biem_bench {

// Equal red cells on a lattice, each rotated and deformed; the same on every rank.
struct RedCells {
  biem::Mat3 box;
  int n_cells = 0, nodes_per_cell = 0;
  double longest_edge = 0.0;
  biem::Points unwrapped, reference;        // 3 x n
  biem::Points smooth_density;              // 3 x n, force per area
  std::vector<biem::Triangle> triangles;    // of all cells
  std::vector<biem::Hinge> hinges;

  int n_nodes() const { return n_cells * nodes_per_cell; }
};

// n^3 cells at the given hematocrit, equivalent radius 1.
RedCells make_red_cells(int n, int nodes_per_cell, double hematocrit);

class SuspensionShare {
 public:
  // reach: of the ghosts around the owned nodes. Collective.
  SuspensionShare(MPI_Comm comm, const RedCells &cells, double reach);

  biem::Configuration configuration() const;
  // Skalak and bending forces on all nodes, 3 x n_all; ghosts not yet added to their owners.
  biem::Points compute_membrane_forces() const;

  biem::PeriodicGhosts &ghosts() { return ghosts_; }
  const std::vector<int> &owned() const { return owned_; }    // indices of the owned nodes

 private:
  void list_elements(const RedCells &cells);
  void list_candidates();

  std::vector<int> owned_;
  biem::PeriodicGhosts ghosts_;
  std::vector<biem::Triangle> triangles_;
  std::vector<biem::ReferenceTriangle> references_;
  std::vector<biem::Hinge> hinges_;
  std::vector<int> surface_of_triangle_, surface_of_node_, no_index_;
  biem::Points unwrapped_;
  std::vector<biem::Mat3> orientations_;    // none: no rigid particles
  biem::Points triangle_shift_;
  biem::NearCandidates candidates_;
  biem::SkalakLaw skalak_;
  biem::HingeLaw bend_;
};

}    // namespace biem_bench

#endif
