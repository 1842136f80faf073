// Error model: see the header. All are of the form (1/V^2) sum over the missing or wrong modes of
// the mean square amplitude of a random source, the sum taken as an isotropic integral.
#include "biem_ewald_error_model.h"
#include "biem_ewald_split_pswf.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

// Mean square amplitudes of one mode: (2/3)(8 pi gamma/k^2)^2 for a random force, (7/9)(8 pi
// gamma/k)^2 for a random stresslet q n. Times k^2 dk over all directions / (2 pi)^3:
const double kShell = std::pow(8.0 * M_PI, 2) * 4.0 * M_PI / std::pow(2.0 * M_PI, 3);
constexpr double kForce = 2.0 / 3.0, kStresslet = 7.0 / 9.0;

// log of sqrt(int gamma(t)^2 w(t) dt) beyond the band limit, over the bandwidth; w = t^-2 for
// forces, 1 for stresslets (up to t = kEnd: there the missing modes are those of the jump of the
// real-space kernel at the cutoff).
class PswfTail {
 public:
  explicit PswfTail(Layers layer)
  {
    constexpr int kPoints = 60;
    constexpr double kEnd = 3.0;
    for (int i = 0; i < kSize; i++) {
      const double bandwidth = kFirst + i, begin = 1.0 + kBandMargin / bandwidth;
      const PswfSplit split(bandwidth, 1.0);
      auto node = [begin](int j) {    // dense at the band limit, where gamma is largest
        return begin + (kEnd - begin) * std::pow(static_cast<double>(j) / kPoints, 3);
      };
      double sum = 0.0;
      for (int j = 0; j < kPoints; j++) {
        const double t = 0.5 * (node(j) + node(j + 1));
        const double gamma = split.fourier_factor(std::pow(t * bandwidth, 2));
        sum += gamma * gamma / (layer == Layers::Double ? 1.0 : t * t) * (node(j + 1) - node(j));
      }
      log_value_[i] = 0.5 * std::log(sum);
    }
  }

  double value(double bandwidth) const
  {
    const double position = std::clamp(bandwidth - kFirst, 0.0, kSize - 1.001);
    const int i = static_cast<int>(position);
    return std::exp(log_value_[i] + (position - i) * (log_value_[i + 1] - log_value_[i]));
  }

 private:
  static constexpr double kFirst = 3.0;
  static constexpr int kSize = 36;
  std::array<double, kSize> log_value_;
};

}    // namespace

BandSpectrum::BandSpectrum(const EwaldSplit &split, double band_limit) : band_limit(band_limit)
{
  for (int i = 0; i < kRadial; i++)
    factor2[i] = std::pow(split.fourier_factor(std::pow(wave_number(i), 2)), 2);
}

// Forces: the lattice sum of 1/n^4 is 16.5323 for the cube of equal volume. Stresslets: the mean
// of |T q n|^2 is 4/r^4; pairs closer than a quarter of the mean distance are rare and left out.
EwaldErrorModel::EwaldErrorModel(Layers layer, double cell_volume, double n_sources) :
    layer_(layer), volume_(cell_volume)
{
  if (layer == Layers::Double)
    reference_ =
        16.0 * M_PI / (cell_volume * 0.25 * std::cbrt(cell_volume / std::max(n_sources, 1.0)));
  else
    reference_ = kForce * std::pow(8.0 * M_PI, 2) * 16.5323 /
                 (std::pow(2.0 * M_PI, 4) * std::pow(cell_volume, 2.0 / 3.0));
}

double EwaldErrorModel::gaussian_real(double xi, double cutoff) const
{
  const double scale = layer_ == Layers::Double
                           ? 112.0 * std::pow(xi, 4) * std::pow(cutoff, 3) / (9.0 * volume_)
                           : 4.0 * cutoff / volume_;
  return std::sqrt(scale / reference_) * std::exp(-std::pow(xi * cutoff, 2));
}

double EwaldErrorModel::gaussian_truncation(double xi, double x) const
{
  const double scale = layer_ == Layers::Double ? 112.0 / 9.0 * xi * x * x * x / volume_
                                                : 8.0 / 3.0 * x / (xi * volume_);
  return std::sqrt(scale / reference_) * (1.0 + 1.0 / (x * x)) * std::exp(-x * x);
}

double EwaldErrorModel::pswf_truncation(double bandwidth, double cutoff) const
{
  static const PswfTail forces(Layers::Single), stresslets(Layers::Double);
  const double unit = bandwidth / cutoff;    // k of t = 1
  if (layer_ == Layers::Double)
    return std::sqrt(kStresslet * kShell * unit / (volume_ * reference_)) *
           stresslets.value(bandwidth);
  return std::sqrt(kForce * kShell / (volume_ * unit * reference_)) * forces.value(bandwidth);
}

// Half of a mode's aliasing error comes from the spreading, half from the interpolation. The window
// of a stresslet is differentiated: its aliases are larger by (k_alias/k)^2, the nearest one having
// |k_a| = 2 pi/h - k_a.
double EwaldErrorModel::aliasing(const BandSpectrum &spectrum, const AliasingTable &table,
                                 double h) const
{
  constexpr int kPolar = 12;
  double total = 0.0;
  for (int i = 0; i < BandSpectrum::kRadial; i++) {
    const double k = spectrum.wave_number(i), k2 = k * k;
    double polar = 0.0;
    for (int j = 0; j < kPolar; j++) {
      const double along = k * (j + 0.5) / kPolar, alias = 2.0 * M_PI / h - along;
      const double error = table.error(along * h / (2.0 * M_PI));
      const double growth = (k2 - along * along + alias * alias) / k2;
      polar += layer_ == Layers::Double ? 0.5 * error * (1.0 + growth) : error;
    }
    const double weight = layer_ == Layers::Double ? kStresslet : kForce / k2;
    total += weight * spectrum.factor2[i] * 3.0 * polar / kPolar;    // three axes
  }
  const double step = spectrum.band_limit / BandSpectrum::kRadial;
  return std::sqrt(kShell * total * step / (volume_ * reference_));
}

}    // namespace biem
