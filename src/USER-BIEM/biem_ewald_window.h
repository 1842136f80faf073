// Windows that carry point values to a grid and back, as piecewise polynomials, and what follows
// from a window alone: the optimal influence factors and the aliasing error. Knows no points,
// kernels or ranks.
#ifndef BIEM_EWALD_WINDOW_H
#define BIEM_EWALD_WINDOW_H

#include "biem_simd.h"
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace biem {

constexpr int kMinWindowOrder = 3, kMaxWindowOrder = 16;

// The first grid point under a window around the grid coordinate s. Points of a lattice may lie on
// the tie between two; they stay on one side of it, whatever rounding does on different ranks.
inline double find_first_point(double s, int order)
{
  constexpr double kTie = 1e-9;    // more than rounding, in grid spacings
  return std::floor(s - 0.5 * order + kTie) + 1.0;
}

class EwaldWindow {
 public:
  virtual ~EwaldWindow() = default;

  int order() const { return order_; }      // support in grid points
  int padded() const { return padded_; }    // order in whole packs
  // weights[0 ... padded): values at the grid points first, first+1, ... around the grid coordinate
  // s (in units of the spacing), zero beyond order. Returns first (may be negative; wrap it).
  int compute_weights(double s, double *weights) const;
  // The same with the derivatives of the weights with respect to s.
  int compute_weights_and_slopes(double s, double *weights, double *slopes) const;
  // Fourier transform at frequency f in cycles per spacing, 1 at f = 0.
  virtual double transform(double frequency) const = 0;

 protected:
  explicit EwaldWindow(int order);    // throws Error when the order is out of range
  // Interpolates value(t), supported on |t| <= order/2, piece by piece: by a polynomial of the
  // lowest degree >= min_degree that is as accurate as tolerance.
  void tabulate(const std::function<double(double)> &value, int min_degree, double tolerance);

 private:
  int locate(double s, double &x) const;

  int order_, padded_, degree_ = 0;
  std::vector<double> coefficients_, slope_coefficients_;    // (degree + 1) x padded
};

// Cardinal B-spline: Essmann et al., J. Chem. Phys. 103, 8577 (1995), Eq. 4.1.
class BsplineWindow : public EwaldWindow {
 public:
  explicit BsplineWindow(int order);
  double transform(double frequency) const override;
};

// Kaiser-Bessel window I0(beta sqrt(1 - (2 t/order)^2)); beta follows from the oversampling: grid
// points per shortest wavelength over 2.
class KaiserBesselWindow : public EwaldWindow {
 public:
  KaiserBesselWindow(int order, double oversampling);
  double transform(double frequency) const override;

 private:
  double beta_;
};

// factor(n) = W(n)^2 / (sum_m W(n + m grid)^2)^2 for n = 0 ... grid-1: the optimal influence
// function of a band-limited kernel (Hockney & Eastwood, Computer Simulation Using Particles, 1988,
// ch. 8).
std::vector<double> compute_influence_factors(const EwaldWindow &window, int grid);

// Relative squared aliasing error of one mode in one dimension, 1 - W^4 / (sum_m W_m^2)^2, as a
// table over the grid frequency |n|/grid in [0, 1/2].
class AliasingTable {
 public:
  explicit AliasingTable(const EwaldWindow &window);
  double error(double frequency) const;

 private:
  static constexpr int kIntervals = 100;
  std::array<double, kIntervals + 1> errors_;
};

}    // namespace biem

#endif
