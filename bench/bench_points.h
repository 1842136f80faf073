// Points and strengths on which the periodic sums are measured: uniform, on red cells, all in one
// corner. The same numbers on every number of ranks. Knows no sums and no ranks.
#ifndef BIEM_BENCH_POINTS_H
#define BIEM_BENCH_POINTS_H

#include "biem_types.h"
#include <string>

namespace biem_bench {

// Sources are targets, too.
struct PointSet {
  biem::Mat3 cell;
  biem::Points points;                             // 3 x n, inside the cell
  biem::Points unwrapped;                          // 3 x n: every closed surface in one piece
  biem::Points forces, densities, normals;         // 3 x n each
  double body_sources = 0.0, body_radius = 0.0;    // of one red cell, as in biem::EwaldScene
};

// Lattice vectors in the columns, of the order of 1: cubic, orthogonal, sheared or triclinic.
biem::Mat3 make_cell(const std::string &name);

// kind: random, corner (all within 0.15 of the lattice vectors), cells-random (far-rule points of
// red cells, random strengths) or cells-smooth (the same with a smooth density). n is approximate
// for the two kinds on red cells. The double layer is scaled so that both layers matter.
PointSet make_points(const std::string &kind, const std::string &cell, int n);

}    // namespace biem_bench

#endif
