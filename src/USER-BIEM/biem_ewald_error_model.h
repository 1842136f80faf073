// Predicted rms errors of the parts of the periodic Stokeslet sum, relative to the rms velocity of
// randomly placed random forces in the same cell. Formulas only. doc/theory, label ewald-errors.
#ifndef BIEM_EWALD_ERROR_MODEL_H
#define BIEM_EWALD_ERROR_MODEL_H

#include "biem_ewald_split.h"
#include "biem_ewald_window.h"

namespace biem {

class EwaldErrorModel {
 public:
  explicit EwaldErrorModel(double cell_volume);    // [length^3]

  // Gaussian split: real space cut at cutoff, Fourier series cut at |k| = 2 xi x.
  double gaussian_real(double xi, double cutoff) const;
  double gaussian_truncation(double xi, double x) const;
  // PSWF split of bandwidth c = cutoff * band_limit: the only error besides the grid's.
  double pswf_truncation(double bandwidth, double band_limit) const;
  // Grid of spacing h along three axes [length], modes up to band_limit.
  double aliasing(const EwaldSplit &split, double band_limit, const AliasingTable &table,
                  double h) const;

 private:
  double volume_, reference_;    // reference: mean square velocity for unit total square force
};

}    // namespace biem

#endif
