// Gaussian (Hasimoto) split of the periodic Stokeslet sum: S = real(r) + Fourier(k).
// Formulas only; knows no points, grids or ranks. doc/theory, label ewald-split.
#ifndef BIEM_EWALD_SPLIT_H
#define BIEM_EWALD_SPLIT_H

#include <vector>

namespace biem {

// Real-space part as free Stokeslet minus a smooth remainder A(r) I + B(r) rr with A, B polynomials
// in v = 2 (r/cutoff)^2 - 1, valid for r <= cutoff: one square root per pair, no erfc.
struct RealSpaceKernel {
  double cutoff;
  std::vector<double> isotropic;    // A: coefficients of v^0, v^1, ... [1/length]
  std::vector<double> dyadic;       // B: the same [1/length^3]
};

class GaussianSplit {
 public:
  explicit GaussianSplit(double xi) : xi_(xi) {}    // xi [1/length]

  // Fourier factor gamma(k^2), multiplies 8 pi/k^2 (I - kk/k^2).
  double fourier_factor(double k2) const;
  // Smooth remainder A(r), B(r) of the real-space part (see RealSpaceKernel), exact.
  double isotropic_remainder(double r) const;
  double dyadic_remainder(double r) const;
  // What a band limit k <= k_max takes away from A(0): add strength * this at coincident points.
  double truncated_self(double k_max) const;

  // Polynomials to absolute accuracy tolerance / cutoff.
  RealSpaceKernel make_real_space_kernel(double cutoff, double tolerance) const;

 private:
  double xi_;
};

}    // namespace biem

#endif
