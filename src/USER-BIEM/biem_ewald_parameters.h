// From a relative tolerance to every parameter of the SPME sum: cutoff, splitting, grid, order.
// Error model and cost model; knows no points and no ranks, so that every rank count and every
// restart of a scene gets the same parameters. doc/theory, label ewald-errors.
#ifndef BIEM_EWALD_PARAMETERS_H
#define BIEM_EWALD_PARAMETERS_H

#include "biem_types.h"

namespace biem {

// What the choice depends on.
struct EwaldScene {
  Mat3 cell;                 // columns: lattice vectors, at rest
  double max_tilt = 0.0;     // |xz| that the cell may reach while it shears [length]
  double n_sources = 0.0;    // in the whole cell
  double n_targets = 0.0;
  double body_sources = 0.0;    // sources of one closed surface (0: points are spread evenly)
  double body_radius = 0.0;     // its equivalent radius [length]
  double tolerance = 1e-3;      // relative to the rms velocity of randomly placed, random forces
  double min_cutoff = 0.0;      // override: cutoff in [min, max], 0 = free
  double max_cutoff = 0.0;
};

struct EwaldParameters {
  double cutoff = 0.0;            // real-space cutoff [length]
  double splitting = 0.0;         // Gaussian splitting xi [1/length]
  double band_limit = 0.0;        // largest |k| kept [1/length]
  int order = 0;                  // B-spline order
  std::array<int, 3> grid{};      // points along each lattice vector
  double tolerance = 0.0;         // requested
  double expected_error = 0.0;    // predicted, same norm
};

// Throws Error when the tolerance cannot be met (says what can).
EwaldParameters choose_ewald_parameters(const EwaldScene &scene);

// Predicted relative rms error of given parameters: real space, truncated Fourier series, aliasing.
double compute_expected_error(const EwaldScene &scene, const EwaldParameters &parameters);

// Smallest integer >= n without prime factors above 7.
int next_fft_size(int n);

}    // namespace biem

#endif
