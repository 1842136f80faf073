// How the periodic sums are split into a real-space and a Fourier part: the contract.
// Stokeslet and stresslet follow from one radial function, the mollified biharmonic kernel.
// Formulas only; knows no points, grids or ranks. doc/theory, label ewald-split.
#ifndef BIEM_EWALD_SPLIT_H
#define BIEM_EWALD_SPLIT_H

#include <vector>

namespace biem {

class EwaldSplit {
 public:
  virtual ~EwaldSplit() = default;

  // gamma(k^2), multiplies 8 pi/k^2 (I - kk/k^2); also beyond the band limit, for error estimates.
  virtual double fourier_factor(double k2) const = 0;
  // P(r) = B'(r)/r of the mollified biharmonic B (B = r without mollifier) [1/length].
  virtual double mollified_slope(double r) const = 0;
  // What the band limit k <= k_max takes away from the Stokeslet at r = 0 [1/length].
  virtual double truncated_self(double k_max) const = 0;
};

// Real-space part = free kernel minus a smooth remainder, for r <= cutoff. With P' = dP/d(r^2):
//   Stokeslet: (1/r - 2 P - 2 r^2 P') I + (1/r^3 + 2 P') rr
//   stresslet: (-6/r^5 + 8 P'') rrr - (6 P' + 4 r^2 P'') (r_i d_jk + r_j d_ik + r_k d_ij)
// P, P', P'' are polynomials in v = 2 (r/cutoff)^2 - 1, coefficients of v^0, v^1, ...: one square
// root per pair, no erfc.
struct RealSpaceKernel {
  double cutoff;
  double coincident;    // takes the place of 1/r at r = 0: truncated_self of the Fourier part
  std::vector<double> slope, slope1, slope2;    // P, P', P'' [1/length, /length^2 each]
};

// Polynomials to an accuracy of about tolerance / cutoff.
RealSpaceKernel make_real_space_kernel(const EwaldSplit &split, double cutoff, double band_limit,
                                       double tolerance);

// fourier_factor() on k <= band_limit as a table in k, cubic interpolation, error below 1e-9.
class FourierFactorTable {
 public:
  FourierFactorTable(const EwaldSplit &split, double band_limit);
  double value(double k2) const;

 private:
  static constexpr int kIntervals = 2000;
  double intervals_per_k_;
  std::vector<double> values_;    // one point before 0, two after the band limit
};

// Gaussian split of Hasimoto, J. Fluid Mech. 5, 317 (1959); xi [1/length].
class GaussianSplit : public EwaldSplit {
 public:
  explicit GaussianSplit(double xi) : xi_(xi) {}

  double fourier_factor(double k2) const override;
  double mollified_slope(double r) const override;
  double truncated_self(double k_max) const override;

 private:
  double xi_;
};

}    // namespace biem

#endif
