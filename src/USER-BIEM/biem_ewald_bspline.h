// Cardinal B-splines as SPME windows, and their optimal influence factors in one dimension.
#ifndef BIEM_EWALD_BSPLINE_H
#define BIEM_EWALD_BSPLINE_H

#include <array>
#include <vector>

namespace biem {

constexpr int kMaxBsplineOrder = 12;

// weights[0..order): values at the grid points first, first+1, ... around grid coordinate s
// (in units of the grid spacing). Returns first (may be negative; wrap it).
int compute_bspline_weights(int order, double s, double *weights);

// Per mode n = 0..grid-1: window(n)^2 / sum over aliases of window^2, squared denominators combined
// as in the optimal influence function of Hockney & Eastwood for a band-limited kernel:
// factor(n) = W(n)^2 / (sum_m W(n + m grid)^2)^2.
std::vector<double> compute_influence_factors(int order, int grid);

// Relative squared aliasing error of one mode in one dimension, 1 - W^4 / (sum_m W_m^2)^2, as a
// table over the grid frequency |n|/grid in [0, 1/2].
class AliasingTable {
 public:
  explicit AliasingTable(int order);
  double error(double frequency) const;

 private:
  static constexpr int kIntervals = 400;
  std::array<double, kIntervals + 1> errors_;
};

}    // namespace biem

#endif
