// Convolution on the grid: see the header.
#include "biem_ewald_grid.h"
#include "biem_cpu_clock.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

constexpr int kChunk = 64;    // columns transformed, multiplied and transformed back in the cache

int count_fields(Layers layers)
{
  return has_double(layers) ? 4 : 3;
}

}    // namespace

// What the kernel needs of the cell.
struct EwaldGrid::Wave {
  Mat3 reciprocal;    // columns b_0, b_1, b_2
  double scale;       // 8 pi / V

  explicit Wave(const Mat3 &cell) :
      reciprocal(2.0 * M_PI * cell.inverse().transpose()),
      scale(8.0 * M_PI / std::fabs(cell.determinant()))
  {
  }
};

EwaldGrid::EwaldGrid(MPI_Comm comm, const EwaldParameters &parameters) :
    parameters_(parameters), factors_(*make_split(parameters), parameters.band_limit),
    transform_(comm, parameters.grid, parameters.modes)
{
  const std::unique_ptr<EwaldWindow> window = make_window(parameters);
  for (int a = 0; a < 3; a++)
    influence_[a] = compute_influence_factors(*window, parameters.grid[a]);
}

GridSlab EwaldGrid::slab(Layers layers)
{
  const int n_fields = count_fields(layers);
  GridSlab slab;
  slab.grid = parameters_.grid;
  slab.n_fields = n_fields;
  slab.first_plane = transform_.planes().begin;
  slab.n_planes = transform_.planes().size();
  slab.values = transform_.values(n_fields);
  slab.plane_size = transform_.plane_size(n_fields);
  return slab;
}

void EwaldGrid::clear(Layers layers)
{
  const GridSlab fields = slab(layers);
  std::fill_n(fields.values, fields.n_planes * fields.plane_size, 0.0);
}

// Modes n0 of one column: zero beyond the band limit, inside
//   u = (8 pi gamma / V k^2) influence [(I - kk/k^2) F + i k tr D].
template <Layers layers> void EwaldGrid::multiply_column(int i, const Wave &wave)
{
  const int m0 = parameters_.grid[0];
  const auto [n1, n2] = transform_.column_modes(i);
  SlabTransform::Complex *field[4];
  for (int f = 0; f < count_fields(layers); f++)
    field[f] = transform_.column(i) + static_cast<std::ptrdiff_t>(f) * m0;
  const Vec3 base = n1 * wave.reciprocal.col(1) + n2 * wave.reciprocal.col(2);
  const Vec3 step = wave.reciprocal.col(0);
  // |base + n step|^2 <= limit^2 for n between the roots of a quadratic.
  const double limit2 = parameters_.band_limit * parameters_.band_limit;
  const double center = -base.dot(step) / step.squaredNorm();
  const double reach2 = (limit2 - base.squaredNorm()) / step.squaredNorm() + center * center;
  int low = 0, high = -1;
  if (reach2 >= 0.0) {
    const int most = parameters_.modes[0];
    low = std::max(-most, static_cast<int>(std::ceil(center - std::sqrt(reach2))));
    high = std::min(most, static_cast<int>(std::floor(center + std::sqrt(reach2))));
  }
  const double scale =
      wave.scale * influence_[1][n1 < 0 ? n1 + parameters_.grid[1] : n1] * influence_[2][n2];
  auto multiply = [&](int begin, int end, int shift) {    // n0 + shift: signed mode
    for (int n0 = begin; n0 < end; n0++) {
      const Vec3 k = base + (n0 + shift) * step;
      const double k2 = std::max(k.squaredNorm(), 1e-300);
      const double inverse_k2 = 1.0 / k2;
      const double g = scale * influence_[0][n0] * factors_.value(k2) * inverse_k2;
      const SlabTransform::Complex fx = field[0][n0], fy = field[1][n0], fz = field[2][n0];
      SlabTransform::Complex along = -(k[0] * fx + k[1] * fy + k[2] * fz) * inverse_k2;
      if (has_double(layers)) {
        const SlabTransform::Complex trace = field[3][n0];
        along += SlabTransform::Complex(-trace.imag(), trace.real());
      }
      field[0][n0] = g * (fx + k[0] * along);
      field[1][n0] = g * (fy + k[1] * along);
      field[2][n0] = g * (fz + k[2] * along);
    }
  };
  auto clear = [&](int begin, int end) {
    for (int f = 0; f < 3; f++)
      std::fill(field[f] + begin, field[f] + std::max(begin, end), 0.0);
  };
  // Stored order: 0 ... high, zeros, then the negative modes.
  const int first = std::max(0, low), end = std::max(first, high + 1);
  const int first_negative = low < 0 && high >= low ? m0 + low : m0;
  const int end_negative = low < 0 ? std::max(first_negative, m0 + std::min(high, -1) + 1) : m0;
  clear(0, first);
  multiply(first, end, 0);
  clear(end, first_negative);
  multiply(first_negative, end_negative, -m0);
  clear(end_negative, m0);
  if (n1 == 0 && n2 == 0) field[0][0] = field[1][0] = field[2][0] = 0.0;    // k = 0
}

void EwaldGrid::convolve(Layers layers, const Mat3 &cell)
{
  CpuClock clock;
  const Wave wave(cell);
  const int n_fields = count_fields(layers);
  transform_.forward(n_fields);
  for (int begin = 0; begin < transform_.n_columns(); begin += kChunk) {
    const int end = std::min(transform_.n_columns(), begin + kChunk);
    transform_.forward_columns(begin, end, n_fields);
    profile_.transform += clock.restart();
    for (int i = begin; i < end; i++)
      has_double(layers) ? multiply_column<Layers::Double>(i, wave)
                         : multiply_column<Layers::Single>(i, wave);
    profile_.kernel += clock.restart();
    transform_.backward_columns(begin, end);
  }
  transform_.backward();
  profile_.transform += clock.restart();
}

}    // namespace biem
