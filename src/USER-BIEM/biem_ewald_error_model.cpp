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

// A positive function of the bandwidth, smooth in its logarithm, computed once at whole numbers.
class BandwidthTable {
 public:
  template <class Function> explicit BandwidthTable(const Function &f)
  {
    for (int i = 0; i < kSize; i++)
      log_value_[i] = std::log(f(kFirst + i));
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

// sqrt(int gamma(t)^2 t^-2 dt) beyond the band limit, t = k over bandwidth / cutoff.
double compute_force_tail(double bandwidth)
{
  constexpr int kPoints = 60;
  constexpr double kEnd = 3.0;
  const double begin = 1.0 + kBandMargin / bandwidth;
  const PswfSplit split(bandwidth, 1.0);
  auto node = [begin](int j) {    // dense at the band limit, where gamma is largest
    return begin + (kEnd - begin) * std::pow(static_cast<double>(j) / kPoints, 3);
  };
  double sum = 0.0;
  for (int j = 0; j < kPoints; j++) {
    const double t = 0.5 * (node(j) + node(j + 1));
    const double gamma = split.fourier_factor(std::pow(t * bandwidth, 2));
    sum += gamma * gamma / (t * t) * (node(j + 1) - node(j));
  }
  return std::sqrt(sum);
}

// j_n(x)/x^n of the spherical Bessel functions, n = 2, 3.
std::array<double, 2> compute_bessel_ratios(double x)
{
  const double x2 = x * x;
  if (x < 2.0) {
    double term = 1.0, second = 0.0, third = 0.0;    // sum (-x^2/2)^m / (m! (2n + 2m + 1)!!)
    double odd2 = 15.0, odd3 = 105.0;
    for (int m = 0; m < 14; m++) {
      second += term / odd2;
      third += term / odd3;
      term *= -0.5 * x2 / (m + 1.0);
      odd2 *= 2.0 * m + 7.0;
      odd3 *= 2.0 * m + 9.0;
    }
    return {second, third};
  }
  const double s = std::sin(x) / x, c = std::cos(x);
  const double j1 = (s - c) / x, j2 = 3.0 * j1 / x - s, j3 = 5.0 * j2 / x - j1;
  return {j2 / x2, j3 / (x2 * x)};
}

// sqrt(int 4 pi r^2 <|E q n|^2> dr) outside the cutoff (= 1), E the difference of the band-limited
// stresslet and the free one. Here the spectrum alone does not tell the error: the modes beyond the
// band limit are mostly those of a jump that the real-space kernel has at the cutoff. Inside the
// error is smaller. P = (4/pi) int gamma j_1(kr)/(kr) dk; T from P', P'' as in RealSpaceKernel.
double compute_stresslet_tail(double bandwidth)
{
  constexpr int kRadii = 80, kModes = 160;
  constexpr double kEnd = 5.0;
  const PswfSplit split(bandwidth, 1.0);
  const double step = (bandwidth + kBandMargin) / kModes;
  std::array<double, kModes> gamma;
  for (int i = 0; i < kModes; i++)
    gamma[i] = split.fourier_factor(std::pow((i + 0.5) * step, 2));
  auto node = [](int j) {    // dense at the cutoff, where the error is largest
    return 1.0 + (kEnd - 1.0) * std::pow(static_cast<double>(j) / kRadii, 2);
  };
  double sum = 0.0;
  for (int j = 0; j < kRadii; j++) {
    const double r = 0.5 * (node(j) + node(j + 1)), r2 = r * r;
    double slope1 = 0.5 / (r2 * r), slope2 = -0.75 / (r2 * r2 * r);    // minus those of 1/r
    for (int i = 0; i < kModes; i++) {
      const double k = (i + 0.5) * step, k2 = k * k;
      const std::array<double, 2> ratio = compute_bessel_ratios(k * r);
      slope1 -= 2.0 / M_PI * gamma[i] * k2 * ratio[0] * step;
      slope2 += 1.0 / M_PI * gamma[i] * k2 * k2 * ratio[1] * step;
    }
    const double triple = 8.0 * slope2 * r2 * r, shared = -(6.0 * slope1 + 4.0 * r2 * slope2) * r;
    const double square = (std::pow(triple + 3.0 * shared, 2) + 6.0 * shared * shared) / 9.0;
    sum += 4.0 * M_PI * r2 * square * (node(j + 1) - node(j));
  }
  return std::sqrt(sum);
}

}    // namespace

BandSpectrum::BandSpectrum(const EwaldSplit &split, double band_limit) : band_limit(band_limit)
{
  for (int i = 0; i < kRadial; i++)
    factor2[i] = std::pow(split.fourier_factor(std::pow(wave_number(i), 2)), 2);
}

// Forces: the lattice sum of 1/n^4 is 16.5323 for the cube of equal volume. Stresslets: the mean
// of |T q n|^2 is 4/r^4; pairs closer than 0.4 of the mean distance are rare and left out.
EwaldErrorModel::EwaldErrorModel(Layers layer, double cell_volume, double n_sources) :
    layer_(layer), volume_(cell_volume)
{
  if (layer == Layers::Double)
    reference_ =
        16.0 * M_PI / (cell_volume * 0.4 * std::cbrt(cell_volume / std::max(n_sources, 1.0)));
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
  if (layer_ == Layers::Double) {
    static const BandwidthTable stresslets(compute_stresslet_tail);
    return stresslets.value(bandwidth) / std::sqrt(volume_ * cutoff * reference_);
  }
  static const BandwidthTable forces(compute_force_tail);
  const double unit = bandwidth / cutoff;    // k of t = 1
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
