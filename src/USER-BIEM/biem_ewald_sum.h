// Periodic Stokes sums over points: single layer, double layer or both, to a requested tolerance.
// Geometry is set once, then any number of right-hand sides is summed. Distributed: each rank
// brings its targets, their periodic images within the cutoff (ghosts), and its sources.
// Knows no surfaces. doc/theory, label ewald-split.
//
//   u(x) = sum_s S(x - y) f + sum_s T(x - y) : q n,  S = I/r + rr/r^3, T_ijk = -6 r_i r_j r_k/r^5
#ifndef BIEM_EWALD_SUM_H
#define BIEM_EWALD_SUM_H

#include "biem_ewald_fourier.h"
#include "biem_ewald_parameters.h"
#include "biem_ewald_real_space.h"
#include "biem_node_exchange.h"
#include <mpi.h>
#include <optional>

namespace biem {

struct PeriodicPoints {
  PointsView targets;    // 3 x n_all: owned first, then ghosts
  int n_owned;
  PointsView sources;      // 3 x n_s
  PointsView normals;      // 3 x n_s, times area; 3 x 0: no double layer will be asked for
  PointsView unwrapped;    // 3 x n_s or 3 x 0: sources with every closed surface in one piece
  // n_all, ghosts as their owners: the others are not paid for; null: all. Like the next one, given
  // on all ranks or on none.
  const std::vector<char> *is_target = nullptr;
  const std::vector<Layers> *source_layers = nullptr;    // n_s; null: all that is asked for
};

// CPU seconds of this rank since construction.
struct PeriodicSumProfile {
  double search = 0.0;    // sorting points into search cells
  double real_space = 0.0;
  double ghosts = 0.0;    // velocities of ghosts to their owners
  FourierProfile fourier;
  long n_pairs = 0;    // real-space pairs of the last sum
};

class PeriodicSum {
 public:
  // Collective; plans the transforms.
  PeriodicSum(MPI_Comm comm, const EwaldParameters &parameters);

  // cell: columns = lattice vectors, upper triangular; origin: its corner.
  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // layers: all that will be asked for, the same on every rank. Collective; the views are not kept.
  void set_points(const PeriodicPoints &points, Layers layers);
  // velocities (3 x n_all) += the sum at the targets; what stands in the ghosts' columns is first
  // added to their owners, the owned columns hold the result. forces (single layer) and densities
  // (double layer): 3 x n_s each, not read when layers does not ask for them, nor at sources that
  // do not carry them. Coincident points give the periodic remainder without the singular part. The
  // mean over the cell is zero for the single layer; the k = 0 term of the double layer is
  // (8 pi/V) [sum (q.n) y - x sum (q.n)]. Collective.
  void add_layers(Layers layers, PointsView forces, PointsView densities, NodeExchange &exchange,
                  PointsRef velocities);

  const EwaldParameters &parameters() const { return parameters_; }
  PeriodicSumProfile profile() const;

 private:
  // Sources that carry the same layers.
  struct Group {
    Group(Layers layers, const RealSpaceKernel &kernel) : carried(layers), real_space(kernel) {}
    std::optional<Layers> find_common(Layers layers) const;    // what it carries of them, if any
    void add_moments(PointsView q, double *moments) const;     // sum (q.n) y, sum q.n

    Layers carried;
    RealSpaceSum real_space;
    bool is_present = false, is_whole = false;    // on any rank; all sources of every rank
    std::vector<int> index;                       // of the sources, if not whole
    Points normals, unwrapped;
    Points forces, densities;    // of the present sum, if not whole
  };

  void set_targets(const PeriodicPoints &points);
  void list_groups(const PeriodicPoints &points, Layers layers);
  void set_sources(const PeriodicPoints &points, Group &group);
  // velocities (3 x owned targets) += Fourier part and k = 0 term; strengths of groups gathered.
  void add_smooth(Layers layers, PointsView forces, PointsView densities, PointsRef velocities);

  MPI_Comm comm_;
  EwaldParameters parameters_;
  std::vector<Group> groups_;    // by the layers they carry
  FourierSum fourier_;
  double volume_ = 1.0;
  bool has_mask_ = false;
  std::vector<int> target_index_;    // of the targets if there is a mask: owned, then ghosts
  Eigen::Index n_owned_targets_ = 0;
  Points targets_;       // owned; with a mask ghosts, too
  Points velocities_;    // of the targets if there is a mask
  PeriodicSumProfile profile_;
};

}    // namespace biem

#endif
