// Direct Ewald sums of the periodic Stokeslet and stresslet to rounding error: the oracle of every
// fast path. Written from the formulas with erfc and explicit lattice sums; shares no code with the
// fast sums and knows neither grids, neighbor lists nor ranks.
#ifndef BIEM_ORACLE_PERIODIC_H
#define BIEM_ORACLE_PERIODIC_H

#include "biem_types.h"

namespace biem {

// Velocities times 8 pi mu at targets (3 x n_t) due to forces (3 x n_s) at sources (3 x n_s) in the
// periodic cell with lattice vectors in its columns; zero mean over the cell. Coincident points
// give the periodic remainder without the point's own singular part. splitting (1/length): any
// value > 0 gives the same sum; 0 chooses one. Source: Hasimoto, J. Fluid Mech. 5, 317 (1959).
Points compute_oracle_single_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView forces, double splitting = 0.0);

// Velocities times 8 pi, w_i = sum T_ijk q_j n_k with T_ijk = -6 r_i r_j r_k / r^5 and
// r = target - source, due to densities q (3 x n_s) and normals n (3 x n_s, each times its area).
// The mean is the term of zero wave vector, (8 pi / V) [sum (q.n) y - x sum (q.n)], with targets x
// and sources y as given: keep the points of a closed surface together, unwrapped. Coincident
// points: the singular part of the point itself is left out; its smooth remainder is odd in r, so
// a point gives nothing at its own place beyond its other images.
Points compute_oracle_double_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView densities, PointsView normals,
                                   double splitting = 0.0);

}    // namespace biem

#endif
