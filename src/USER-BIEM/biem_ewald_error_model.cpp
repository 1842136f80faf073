// Error model: see the header. All are of the form (1/V^2) sum over the missing or wrong modes of
// (2/3)(8 pi gamma/k^2)^2, the sum taken as an isotropic integral.
#include "biem_ewald_error_model.h"
#include "biem_ewald_split_pswf.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

// int over all directions of (2/3)(8 pi/k^2)^2 k^2 dk / (2 pi)^3 is this times dk/k^2.
const double kModes = 2.0 / 3.0 * std::pow(8.0 * M_PI, 2) * 4.0 * M_PI / std::pow(2.0 * M_PI, 3);

// sqrt(int_1^inf gamma(t)^2 t^-2 dt) for bandwidths kFirst, kFirst + kStep, ...
class PswfTail {
 public:
  static constexpr double kFirst = 3.0, kStep = 0.5;
  static constexpr int kSize = 70;

  PswfTail()
  {
    constexpr int kPoints = 240;
    constexpr double kEnd =
        13.0;    // gamma oscillates with constant amplitude: the rest is below 8 %
    for (int i = 0; i < kSize; i++) {
      const PswfSplit split(kFirst + kStep * i, 1.0);
      const double limit = kFirst + kStep * i, step = (kEnd - 1.0) / kPoints;
      double sum = 0.0;
      for (int j = 0; j < kPoints; j++) {
        const double t = 1.0 + (j + 0.5) * step;
        sum += std::pow(split.fourier_factor(std::pow(t * limit, 2)) / t, 2) * step;
      }
      log_value_[i] = 0.5 * std::log(sum);
    }
  }

  double value(double bandwidth) const
  {
    const double position = std::clamp((bandwidth - kFirst) / kStep, 0.0, kSize - 1.001);
    const int i = static_cast<int>(position);
    return std::exp(log_value_[i] + (position - i) * (log_value_[i + 1] - log_value_[i]));
  }

 private:
  std::array<double, kSize> log_value_;
};

}    // namespace

// The lattice sum of 1/n^4 is 16.5323 for the cube of equal volume.
EwaldErrorModel::EwaldErrorModel(double cell_volume) :
    volume_(cell_volume), reference_(2.0 / 3.0 * std::pow(8.0 * M_PI, 2) * 16.5323 /
                                     (std::pow(2.0 * M_PI, 4) * std::pow(cell_volume, 2.0 / 3.0)))
{
}

double EwaldErrorModel::gaussian_real(double xi, double cutoff) const
{
  return std::sqrt(4.0 * cutoff / volume_ / reference_) * std::exp(-std::pow(xi * cutoff, 2));
}

double EwaldErrorModel::gaussian_truncation(double xi, double x) const
{
  return std::sqrt(8.0 * x / (3.0 * volume_ * xi) / reference_) * (1.0 + 1.0 / (x * x)) *
         std::exp(-x * x);
}

double EwaldErrorModel::pswf_truncation(double bandwidth, double band_limit) const
{
  static const PswfTail tail;
  return std::sqrt(kModes / (volume_ * band_limit * reference_)) * tail.value(bandwidth);
}

double EwaldErrorModel::aliasing(const EwaldSplit &split, double band_limit,
                                 const AliasingTable &table, double h) const
{
  constexpr int kRadial = 48, kPolar = 12;
  double sum = 0.0;
  for (int i = 0; i < kRadial; i++) {
    const double k = band_limit * (i + 0.5) / kRadial;
    double polar = 0.0;
    for (int j = 0; j < kPolar; j++)
      polar += table.error(k * (j + 0.5) / kPolar * h / (2.0 * M_PI)) / kPolar;
    sum += std::pow(split.fourier_factor(k * k) / k, 2) * 3.0 * polar;    // three axes
  }
  return std::sqrt(kModes * sum * band_limit / kRadial / (volume_ * reference_));
}

}    // namespace biem
