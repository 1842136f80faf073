// Real-space part of the periodic Stokeslet sum over the points of one rank: each source against
// every target within the cutoff, in plain distances (periodic images come in as targets of their
// own). Knows no lattice, no ranks, no surfaces.
#ifndef BIEM_EWALD_REAL_SPACE_H
#define BIEM_EWALD_REAL_SPACE_H

#include "biem_ewald_split.h"
#include "biem_types.h"

namespace biem {

class RealSpaceSum {
 public:
  explicit RealSpaceSum(RealSpaceKernel kernel) : kernel_(std::move(kernel)) {}

  // targets: 3 x n_t, sources: 3 x n_s. Sorts both into search cells.
  void set_points(PointsView targets, PointsView sources);

  // velocities (3 x n_t) += sum over sources within the cutoff; strengths: 3 x n_s. Coincident
  // points get the smooth remainder only, that is the self term.
  void add_single_layer(PointsView strengths, PointsRef velocities);

  long n_pairs() const { return n_pairs_; }    // of the last sum

 private:
  void sort_points(PointsView points, std::vector<int> &start, std::vector<int> &order) const;
  void gather_sources(int cell);
  int find_close(const Vec3 &target);    // padded number of gathered sources within the cutoff
  Vec3 sum_close(int n) const;

  RealSpaceKernel kernel_;
  Points targets_;
  int n_sources_ = 0;
  Vec3 lower_ = Vec3::Zero();
  double cell_size_ = 1.0;
  std::array<int, 3> n_cells_{};
  std::vector<int> target_start_, target_order_, source_start_, source_order_;
  std::array<std::vector<double>, 6> sorted_;      // sources in cell order: x y z, strength
  std::array<std::vector<double>, 6> gathered_;    // candidates around one search cell
  std::array<std::vector<double>, 6> close_;    // those within the cutoff: displacement, strength
  std::vector<double> distance2_;
  long n_pairs_ = 0;
};

}    // namespace biem

#endif
