// From a relative tolerance to every parameter of the periodic sum: cutoff, split, grid, window.
// Knows no points and no ranks, so that every rank count and every restart of a scene gets the same
// parameters. doc/theory, label ewald-errors.
#ifndef BIEM_EWALD_PARAMETERS_H
#define BIEM_EWALD_PARAMETERS_H

#include "biem_ewald_split.h"
#include "biem_ewald_window.h"
#include "biem_types.h"
#include <string>

namespace biem {

// Spme: Gaussian split, B-splines, as in the paper. Pswf: split by the prolate spheroidal wave
// function, Kaiser-Bessel window: smaller grid and cheaper real space for the same error.
enum class EwaldMethod { Spme, Pswf };
EwaldMethod parse_ewald_method(const std::string &name);
std::string describe(EwaldMethod method);

// What the choice depends on. A zero leaves a parameter free; anything else fixes it.
struct EwaldScene {
  Mat3 cell;                 // columns: lattice vectors, at rest
  double max_tilt = 0.0;     // |xz| that the cell may reach while it shears [length]
  double n_sources = 0.0;    // in the whole cell
  double n_targets = 0.0;
  double body_sources = 0.0;    // sources of one closed surface (0: points are spread evenly)
  double body_radius = 0.0;     // its equivalent radius [length]
  double tolerance = 1e-3;      // relative rms error of the sum
  double error_factor = 1.0;    // measured over predicted error of this scene, if it was measured
  Layers layers = Layers::Single;    // sums that keep the tolerance
  EwaldMethod method = EwaldMethod::Pswf;
  double cutoff = 0.0;       // real-space cutoff [length]
  int order = 0;             // support of the window, grid points
  double splitting = 0.0;    // of EwaldParameters
  std::array<int, 3> grid{};
};

constexpr double kTightestTolerance = 1e-10;    // double precision leaves no margin below

struct EwaldParameters {
  EwaldMethod method = EwaldMethod::Pswf;
  double cutoff = 0.0;            // real-space cutoff [length]
  double splitting = 0.0;         // Gaussian: xi [1/length]; PSWF: bandwidth / cutoff [1/length]
  double band_limit = 0.0;        // largest |k| kept [1/length]
  int order = 0;                  // support of the window, grid points
  double oversampling = 0.0;      // of the Kaiser-Bessel window
  std::array<int, 3> grid{};      // points along each lattice vector
  std::array<int, 3> modes{};     // largest |n_a| within the band limit, in the worst tilt
  double tolerance = 0.0;         // requested
  double expected_error = 0.0;    // predicted, same norm
};

// Throws Error when the tolerance cannot be met (says what can).
EwaldParameters choose_ewald_parameters(const EwaldScene &scene);
// The n cheapest choices by the cost model, cheapest first, each with another cutoff or order: to
// be timed on the machine at hand.
std::vector<EwaldParameters> rank_ewald_parameters(const EwaldScene &scene, int n);

// Predicted relative rms error of given parameters: real space, truncated Fourier series, aliasing;
// the largest over the scene's layers.
double compute_expected_error(const EwaldScene &scene, const EwaldParameters &parameters);

std::unique_ptr<EwaldSplit> make_split(const EwaldParameters &parameters);
std::unique_ptr<EwaldWindow> make_window(const EwaldParameters &parameters);

// Smallest integer >= n without prime factors above 7, above 32 a multiple of 4.
int next_fft_size(int n);

}    // namespace biem

#endif
