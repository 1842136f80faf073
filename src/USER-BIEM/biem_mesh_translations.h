// The translations of the periodic cell that map a mesh onto itself, nodes and triangles: n_a
// shifts by 1/n_a of each lattice vector. Knows no operator.
#ifndef BIEM_MESH_TRANSLATIONS_H
#define BIEM_MESH_TRANSLATIONS_H

#include "biem_mesh_sheets.h"

namespace biem {

class MeshTranslations {
 public:
  // Finds the largest n_a. Positions match within 1e-5 of the mean edge. Throws Error if two nodes
  // coincide.
  explicit MeshTranslations(const WallMesh &mesh);

  // Number of shifts along each lattice vector, and of all their combinations.
  const std::array<int, 3> &counts() const { return counts_; }
  int n_shifts() const { return counts_[0] * counts_[1] * counts_[2]; }
  int n_unit_nodes() const { return static_cast<int>(order_.size()) / n_shifts(); }
  // Lattice vectors by increasing count: a combination of shifts has the index
  // (i[axes[0]] counts[axes[1]] + i[axes[1]]) counts[axes[2]] + i[axes[2]].
  const std::array<int, 3> &axes() const { return axes_; }
  // order()[shift * n_unit_nodes() + j]: the node on which the shift puts node order()[j].
  const std::vector<int> &order() const { return order_; }

 private:
  void set_order(const std::array<std::vector<int>, 3> &images);

  std::array<int, 3> counts_{1, 1, 1}, axes_{0, 1, 2};
  std::vector<int> order_;
};

}    // namespace biem

#endif
