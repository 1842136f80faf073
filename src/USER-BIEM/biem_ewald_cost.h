// What one periodic sum costs: the model that chooses among parameters of equal error. Knows no
// points, only their number and density.
#ifndef BIEM_EWALD_COST_H
#define BIEM_EWALD_COST_H

#include "biem_ewald_parameters.h"

namespace biem {

// Predicted nanoseconds of one geometry and one sum on one core of an AVX-512 processor; on others
// and in parallel only the ratios of different parameters matter.
double predict_ewald_cost(const EwaldScene &scene, const EwaldParameters &parameters);

// Length of each lattice vector in the worst tilt.
Vec3 worst_lengths(const EwaldScene &scene);

}    // namespace biem

#endif
