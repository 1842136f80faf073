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
#include <vector>

namespace biem {

// One triangle, its corners in one piece; a plain record that can be sent to other ranks.
struct SurfaceTriangle {
  std::int64_t bin;          // set, with the occupant, by what sorts the triangles into bins
  std::uint64_t occupant;    // two triangles of one occupant of a bin do not cross
  int surface;               // number of its surface
  int is_sheet;              // of a wall: sheets may meet each other and their own images
  double corners[9];         // length; those of a closed surface are all in one piece

  Vec3 corner(int k) const { return Vec3(corners + 3 * k); }
};

// Who is in a bin: one periodic image of a surface, or any of the sheets.
constexpr std::uint64_t kSheets = ~std::uint64_t(0);
constexpr std::uint64_t kSeveral = kSheets - 1;    // more than one, or perhaps

// A periodic grid of bins; width: about the size of a triangle, length.
class CrossingBins {
 public:
  CrossingBins(const MeshLattice &lattice, double width);
  std::int64_t n_bins() const { return static_cast<std::int64_t>(n_[0]) * n_[1] * n_[2]; }

  // Calls visit(bin, occupant) once for every bin that the box around the triangle touches.
  template <class Visitor> void for_each_bin(const SurfaceTriangle &t, Visitor visit) const
  {
    const Box box = find_box(t);
    for (std::int64_t i = box.low[0]; i <= box.high[0]; i++)
      for (std::int64_t j = box.low[1]; j <= box.high[1]; j++)
        for (std::int64_t k = box.low[2]; k <= box.high[2]; k++)
          visit(((k % n_[2]) * n_[1] + j % n_[1]) * n_[0] + i % n_[0],
                find_occupant(t, box, i >= n_[0], j >= n_[1], k >= n_[2]));
  }

 private:
  struct Box {
    int low[3], high[3];          // bins; from n_ on they are in the next image of the cell
    std::int64_t image[3];        // of the cell, in which the bins below n_ are
    bool is_around = false;       // touches all bins along an axis
  };
  Box find_box(const SurfaceTriangle &t) const;
  static std::uint64_t find_occupant(const SurfaceTriangle &t, const Box &box, bool next_x,
                                     bool next_y, bool next_z);

  MeshLattice lattice_;
  std::array<int, 3> n_;
};

// The occupant of each bin, kSeveral where there are more: only there can anything cross. A hash
// table, for the few of very many bins that are not empty.
class BinOccupants {
 public:
  BinOccupants() : slots_(1024) {}
  void add(std::int64_t bin, std::uint64_t occupant);
  std::uint64_t find(std::int64_t bin) const { return slots_[find_slot(bin)].occupant; }

  template <class Visitor> void for_each(Visitor visit) const    // visit(bin, occupant)
  {
    for (const Slot &slot : slots_)
      if (slot.bin >= 0) visit(slot.bin, slot.occupant);
  }

 private:
  struct Slot {
    std::int64_t bin = -1;
    std::uint64_t occupant = 0;    // of no bin: nobody
  };
  std::size_t find_slot(std::int64_t bin) const;
  void grow();

  std::vector<Slot> slots_;    // a power of two
  std::size_t n_bins_ = 0;
};

struct Crossing {
  int first, second;    // numbers of the surfaces, first <= second; equal: with its own image
  double where[3];      // center of a triangle that is crossed, length
};

// All pairs of surfaces that cross in the bins of these triangles, each once, ascending.
std::vector<Crossing> find_crossings(const MeshLattice &lattice,
                                     const std::vector<SurfaceTriangle> &triangles);

// Signed solid angle at which the point sees the triangle: over a closed surface they add up to
// 4 pi for a point inside, 0 outside.
double compute_solid_angle(const SurfaceTriangle &triangle, const Vec3 &point);

}    // namespace biem

#endif
