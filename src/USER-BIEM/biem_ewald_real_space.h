// Real-space part of the periodic single and double layer sums over the points of one rank: each
// source against every target within the cutoff, in plain distances (periodic images come in as
// targets of their own). Knows no lattice, no ranks, no surfaces.
#ifndef BIEM_EWALD_REAL_SPACE_H
#define BIEM_EWALD_REAL_SPACE_H

#include "biem_ewald_split.h"
#include "biem_types.h"

namespace biem {

class RealSpaceSum {
 public:
  explicit RealSpaceSum(RealSpaceKernel kernel) : kernel_(std::move(kernel)) {}

  // targets: 3 x n_t, sources: 3 x n_s, normals of the sources times area: 3 x n_s, or 3 x 0 when
  // no double layer will be asked for. Sorts all into search cells.
  void set_points(PointsView targets, PointsView sources, PointsView normals);

  // velocities (3 x n_t) += sum over sources within the cutoff; forces and densities: 3 x n_s, not
  // read when layers does not ask for them. Points closer than 1e-9 cutoffs count as coincident and
  // get the smooth remainder only, that is the self term.
  void add_layers(Layers layers, PointsView forces, PointsView densities, PointsRef velocities);

  long n_pairs() const { return n_pairs_; }    // of the last sum

 private:
  // A source: position, force, density, normal, density . normal, in the order of search cells.
  enum Channel { kX, kForce = 3, kDensity = 6, kNormal = 9, kDensityDotNormal = 12 };
  static constexpr int kFullRecord = 16, kForceRecord = 8;    // doubles: whole cache lines
  template <Layers layers> static constexpr int record_size();

  void set_search_cells(const Vec3 &size);
  void sort_points(PointsView points, std::vector<int> &start, std::vector<int> &order);
  void fill_records(Layers layers, PointsView forces, PointsView densities);
  template <Layers layers> void add_all(PointsRef velocities);
  int gather_sources(int cell);
  int find_close(int n_gathered, const Vec3 &target);
  template <Layers layers> Vec3 sum_close(int n_close, const Vec3 &target) const;
  Vec3 get_center(int cell) const;

  RealSpaceKernel kernel_;
  Points targets_, normals_;    // targets in the order of search cells
  int n_sources_ = 0;
  Vec3 lower_ = Vec3::Zero();
  double cell_size_ = 1.0;
  int reach_ = 1;    // search cells per cutoff, along each axis
  std::array<int, 3> n_cells_{};
  std::vector<int> target_start_, target_order_, source_start_, source_order_;
  std::array<std::vector<double>, 3> sorted_;     // source positions in the order of search cells
  std::vector<int> cell_of_point_;                // scratch of sort_points
  std::vector<double> records_;                   // all sources and one dummy
  std::array<std::vector<float>, 3> gathered_;    // candidates relative to a search cell's center
  std::vector<int> gathered_index_, close_;       // records of the candidates; of the close ones
  long n_pairs_ = 0;
};

}    // namespace biem

#endif
