// From points to a grid and back with precomputed windows: the inner loops of the particle mesh, in
// packs of doubles. Knows one rank's slab of the grid; no kernels, no communication.
// doc/theory, label spme.
#ifndef BIEM_EWALD_SPREAD_H
#define BIEM_EWALD_SPREAD_H

#include "biem_ewald_window.h"
#include "biem_types.h"

namespace biem {

// One rank's planes of the grid, all fields interleaved: field f at (plane, row, z) is
// values[(plane - first_plane) * plane_size + (row * grid[2] + z) * n_fields + f]. Up to
// SlabTransform::kMargin doubles before and after may be touched (by adding zero).
struct GridSlab {
  std::array<int, 3> grid{};    // points along each lattice vector
  int n_fields = 3;
  int first_plane = 0, n_planes = 0;    // of axis 0
  double *values = nullptr;
  std::ptrdiff_t plane_size = 0;
};

enum class WindowContent { Values, ValuesAndSlopes };

// Windows of points at fractional coordinates in [0, 1)^3, in the order of their blocks of the
// grid, so that neighbors in this list touch the same memory.
class PointWindows {
 public:
  // planes outside the slab are left out of every sum.
  void set_points(const EwaldWindow &window, const std::array<int, 3> &grid, PointsView fractional,
                  WindowContent content);

  int size() const { return static_cast<int>(order_.size()); }

  // Adds f times the window to the first three fields: f is 3 x n.
  void spread_forces(const GridSlab &slab, PointsView forces) const;
  // Adds the sources of a double layer: -2 D grad to the first three of four fields, tr D to the
  // fourth, with D = sym(q n), and forces as above (3 x n, or 3 x 0: none). to_grid: row a = M_a
  // times row a of the inverse cell, from a displacement to grid coordinates.
  void spread_layers(const GridSlab &slab, PointsView forces, PointsView densities,
                     PointsView normals, const Mat3 &to_grid) const;
  // values (3 x n) += window-weighted sums of the three fields.
  void interpolate(const GridSlab &slab, PointsRef values) const;

 private:
  template <int order> struct Loops;

  int window_order_ = 0, padded_ = 0;
  std::vector<int> order_;                  // point of each entry below
  std::vector<int> first_;                  // 3 per point, wrapped into the grid
  std::vector<double> weights_, slopes_;    // 3 x padded per point
};

}    // namespace biem

#endif
