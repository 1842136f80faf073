// How the periodic Stokeslet sum is split into a real-space and a Fourier part: the contract.
// S = real(r) + Fourier(k). Formulas only; knows no points, grids or ranks.
// doc/theory, label ewald-split.
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

class EwaldSplit {
 public:
  virtual ~EwaldSplit() = default;

  // gamma(k^2), multiplies 8 pi/k^2 (I - kk/k^2); also beyond the band limit, for error estimates.
  virtual double fourier_factor(double k2) const = 0;
  // Smooth remainder A(r), B(r) of the real-space part, exact.
  virtual double isotropic_remainder(double r) const = 0;
  virtual double dyadic_remainder(double r) const = 0;
  // What the band limit k <= k_max takes away from A(0): add strength * this at coincident points.
  virtual double truncated_self(double k_max) const = 0;
};

// Polynomials to absolute accuracy tolerance / cutoff.
RealSpaceKernel make_real_space_kernel(const EwaldSplit &split, double cutoff, double tolerance);

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
  double isotropic_remainder(double r) const override;
  double dyadic_remainder(double r) const override;
  double truncated_self(double k_max) const override;

 private:
  double xi_;
};

}    // namespace biem

#endif
