// Windows that carry point values to a grid and back: the contract, and what follows from it alone,
// the optimal influence factors and the aliasing error. Knows no points, kernels or ranks.
#ifndef BIEM_EWALD_WINDOW_H
#define BIEM_EWALD_WINDOW_H

#include <array>
#include <memory>
#include <vector>

namespace biem {

constexpr int kMaxWindowOrder = 16;

class EwaldWindow {
 public:
  explicit EwaldWindow(int order) : order_(order) {}
  virtual ~EwaldWindow() = default;

  int order() const { return order_; }    // support in grid points
  // weights[0..order): values at the grid points first, first+1, ... around the grid coordinate s
  // (in units of the spacing). Returns first (may be negative; wrap it).
  virtual int compute_weights(double s, double *weights) const = 0;
  // Fourier transform at frequency f in cycles per spacing, 1 at f = 0.
  virtual double transform(double frequency) const = 0;

 private:
  int order_;
};

// Cardinal B-spline: Essmann et al., J. Chem. Phys. 103, 8577 (1995), Eq. 4.1.
class BsplineWindow : public EwaldWindow {
 public:
  explicit BsplineWindow(int order) : EwaldWindow(order) {}
  int compute_weights(double s, double *weights) const override;
  double transform(double frequency) const override;
};

// Kaiser-Bessel window I0(beta sqrt(1 - (2 t/order)^2)) as piecewise polynomials; beta follows from
// the oversampling: grid points per shortest wavelength over 2.
class KaiserBesselWindow : public EwaldWindow {
 public:
  KaiserBesselWindow(int order, double oversampling);
  int compute_weights(double s, double *weights) const override;
  double transform(double frequency) const override;

 private:
  double compute_value(double t) const;

  static constexpr int kLanes = 8;    // coefficient rows are padded to whole vectors
  double beta_, norm_ = 1.0;
  int padded_, degree_ = 0;
  std::vector<double> coefficients_;    // (degree + 1) x padded
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
