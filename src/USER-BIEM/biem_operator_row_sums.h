// Row sums of the double layer over one closed surface: what it makes of a uniform density at its
// own nodes. In free space, because the periodic images and the k = 0 term of a uniform density
// on a closed surface add up to nothing. A pure function; no ranks, no cell.
// doc/theory, label double-layer.
#ifndef BIEM_OPERATOR_ROW_SUMS_H
#define BIEM_OPERATOR_ROW_SUMS_H

#include "biem_types.h"

namespace biem {

// The double layer of (e_1, e_2, e_3) in columns, at each target in their order, by the rules of
// LayerOperator: far rule, closed form near an element. Turns with the surface: R M R^T in a frame
// turned by R. nodes: 3 x n, in one piece; triangles: one closed surface; targets: some of the
// nodes. Throws Error on collapsed elements.
std::vector<Mat3> compute_free_row_sums(PointsView nodes, const std::vector<Triangle> &triangles,
                                        const std::vector<int> &targets);
// At all nodes.
std::vector<Mat3> compute_free_row_sums(PointsView nodes, const std::vector<Triangle> &triangles);

}    // namespace biem

#endif
