// Slow, direct Ewald sum of the periodic Stokeslet to rounding error: the oracle of every fast
// path. Written from the formulas with erfc and explicit lattice sums; shares no code with the fast
// sums.
#ifndef BIEM_ORACLE_PERIODIC_H
#define BIEM_ORACLE_PERIODIC_H

#include "biem_types.h"

namespace biem {

// Velocities times 8 pi mu at targets (3 x n_t) due to forces (3 x n_s) at sources (3 x n_s) in the
// periodic cell with lattice vectors in its columns; zero mean over the cell. Coincident points
// give the periodic remainder without the point's own singular part. splitting: any value > 0
// gives the same sum; 0 chooses one. Source: Hasimoto, J. Fluid Mech. 5, 317 (1959).
Points compute_oracle_single_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView forces, double splitting = 0.0);

}    // namespace biem

#endif
