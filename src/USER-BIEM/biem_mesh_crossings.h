// Whether surfaces go through each other or lie in each other, in a periodic cell. Works on any
// share of the triangles: those of one bin are enough to find what crosses there. Knows meshes; not
// what the surfaces are, nor how the ranks share them.
#ifndef BIEM_MESH_CROSSINGS_H
#define BIEM_MESH_CROSSINGS_H

#include "biem_mesh_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace biem {

// One triangle, its corners in one piece; a plain record that can be sent to other ranks.
struct SurfaceTriangle {
  std::int64_t bin;      // set by what sorts the triangles into bins
  int surface;           // number of its surface
  int is_sheet;          // of a wall: sheets may meet each other and their own images
  double corners[9];     // length; those of a closed surface are all in one piece

  Vec3 corner(int k) const { return Vec3(corners + 3 * k); }
};

// A periodic grid of bins; width: about the size of a triangle, length.
class CrossingBins {
 public:
  CrossingBins(const MeshLattice &lattice, double width);
  std::int64_t n_bins() const { return static_cast<std::int64_t>(n_[0]) * n_[1] * n_[2]; }

  // Calls visit(bin) once for every bin that the box around the triangle touches.
  template <class Visitor> void for_each_bin(const SurfaceTriangle &t, Visitor visit) const
  {
    int low[3], high[3];
    for (int a = 0; a < 3; a++) find_range(t, a, low[a], high[a]);
    for (std::int64_t i = low[0]; i <= high[0]; i++)
      for (std::int64_t j = low[1]; j <= high[1]; j++)
        for (std::int64_t k = low[2]; k <= high[2]; k++)
          visit(((k % n_[2]) * n_[1] + j % n_[1]) * n_[0] + i % n_[0]);
  }

 private:
  void find_range(const SurfaceTriangle &t, int axis, int &low, int &high) const;

  MeshLattice lattice_;
  std::array<int, 3> n_;
};

struct Crossing {
  int first, second;    // numbers of the surfaces, first <= second; equal: with its own image
  Vec3 where;           // center of a triangle that is crossed, length
};

// Of all pairs of surfaces that cross in the bins of these triangles the one with the smallest
// numbers. Sorts the triangles by bin.
std::optional<Crossing> find_crossing(const MeshLattice &lattice,
                                      std::vector<SurfaceTriangle> &triangles);

// Signed solid angle at which the point sees the triangle: over a closed surface they add up to
// 4 pi for a point inside, 0 outside.
double compute_solid_angle(const SurfaceTriangle &triangle, const Vec3 &point);

}    // namespace biem

#endif
