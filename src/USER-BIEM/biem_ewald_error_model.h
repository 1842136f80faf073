// Predicted rms errors of the parts of a periodic Stokes sum over randomly placed points, relative
// to the rms velocity of the same sum. Formulas only. doc/theory, label ewald-errors.
#ifndef BIEM_EWALD_ERROR_MODEL_H
#define BIEM_EWALD_ERROR_MODEL_H

#include "biem_ewald_split.h"
#include "biem_ewald_window.h"
#include "biem_types.h"

namespace biem {

// gamma^2 at equally spaced k in the band, for many estimates with one split.
class BandSpectrum {
 public:
  static constexpr int kRadial = 40;

  BandSpectrum(const EwaldSplit &split, double band_limit);
  double wave_number(int i) const { return band_limit * (i + 0.5) / kRadial; }

  const double band_limit;
  std::array<double, kRadial> factor2;
};

class EwaldErrorModel {
 public:
  // layer: Single or Double; cell_volume [length^3].
  EwaldErrorModel(Layers layer, double cell_volume, double n_sources);

  // Gaussian split: real space cut at cutoff, Fourier series cut at |k| = 2 xi x.
  double gaussian_real(double xi, double cutoff) const;
  double gaussian_truncation(double xi, double x) const;
  // PSWF split of the given bandwidth with the band limit (bandwidth + kBandMargin)/cutoff.
  double pswf_truncation(double bandwidth, double cutoff) const;
  // Grid of spacing h along three axes [length].
  double aliasing(const BandSpectrum &spectrum, const AliasingTable &table, double h) const;

 private:
  Layers layer_;
  double volume_, reference_;    // reference: mean square velocity for unit total square strength
};

// Modes kept beyond the bandwidth of a PSWF split, where gamma is not yet negligible: the smallest
// band limit for a given error has 0.2 to 0.6 for errors from 1e-8 to 1e-2.
constexpr double kBandMargin = 0.35;

}    // namespace biem

#endif
