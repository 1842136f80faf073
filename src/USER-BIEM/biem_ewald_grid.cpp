// Grid and transforms: see the header.
#include "biem_ewald_grid.h"
#include "biem_error.h"
#include <algorithm>
#include <cmath>
#include <complex>
#include <fftw3-mpi.h>

namespace biem {

// FFTW's arrays: planes x rows x padded columns, in place, one per component; modes transposed to
// rows x planes x columns.
struct EwaldGrid::Plans {
  fftw_plan forward = nullptr, backward = nullptr;
  std::array<double *, 4> memory{};       // with the margins
  ptrdiff_t size = 0;                     // doubles per component, without the margins
  ptrdiff_t first_row = 0, n_rows = 0;    // slab along axis 1, Fourier side

  ~Plans()
  {
    if (forward) fftw_destroy_plan(forward);
    if (backward) fftw_destroy_plan(backward);
    for (double *m : memory)
      if (m) fftw_free(m);
  }
};

EwaldGrid::EwaldGrid(MPI_Comm comm, const EwaldParameters &parameters) :
    parameters_(parameters), factors_(*make_split(parameters), parameters.band_limit),
    plans_(std::make_unique<Plans>())
{
  fftw_mpi_init();    // may be called any number of times
  const ptrdiff_t n[3] = {parameters.grid[0], parameters.grid[1], parameters.grid[2]};
  const ptrdiff_t complex_n[3] = {n[0], n[1], n[2] / 2 + 1};
  Plans &p = *plans_;
  ptrdiff_t n_planes, first_plane;
  const ptrdiff_t local = fftw_mpi_local_size_3d_transposed(
      n[0], n[1], complex_n[2], comm, &n_planes, &first_plane, &p.n_rows, &p.first_row);
  p.size = 2 * std::max<ptrdiff_t>(local, 1);
  slab_.grid = parameters.grid;
  slab_.first_plane = static_cast<int>(first_plane);
  slab_.n_planes = static_cast<int>(n_planes);
  slab_.padded = 2 * complex_n[2];
  allocate(3);
  auto *modes = reinterpret_cast<fftw_complex *>(slab_.component[0]);
  p.forward = fftw_mpi_plan_dft_r2c_3d(n[0], n[1], n[2], slab_.component[0], modes, comm,
                                       FFTW_MEASURE | FFTW_MPI_TRANSPOSED_OUT);
  p.backward = fftw_mpi_plan_dft_c2r_3d(n[0], n[1], n[2], modes, slab_.component[0], comm,
                                        FFTW_MEASURE | FFTW_MPI_TRANSPOSED_IN);
  if (!p.forward || !p.backward)
    throw Error("FFTW could not plan a " + std::to_string(n[0]) + " x " + std::to_string(n[1]) +
                " x " + std::to_string(n[2]) + " grid on this number of ranks");
  layout_ = make_slab_layout(comm, parameters.grid[0], slab_.first_plane, slab_.n_planes);
  const std::unique_ptr<EwaldWindow> window = make_window(parameters);
  for (int a = 0; a < 3; a++)
    influence_[a] = compute_influence_factors(*window, parameters.grid[a]);
}

EwaldGrid::~EwaldGrid() = default;

void EwaldGrid::allocate(int n_components)
{
  for (int c = 0; c < n_components; c++) {
    if (plans_->memory[c]) continue;
    const ptrdiff_t size = plans_->size + 2 * kGridMargin;
    plans_->memory[c] = fftw_alloc_real(size);
    if (!plans_->memory[c])
      throw Error("no memory for " + std::to_string(size) +
                  " grid values of the periodic sum: "
                  "use more ranks or a larger tolerance");
    std::fill_n(plans_->memory[c], size, 0.0);
    slab_.component[c] = plans_->memory[c] + kGridMargin;
  }
}

void EwaldGrid::clear(Layers layers)
{
  const int n = has_double(layers) ? 4 : 3;
  allocate(n);
  for (int c = 0; c < n; c++)
    std::fill_n(slab_.component[c], plans_->size, 0.0);
}

void EwaldGrid::forward(Layers layers)
{
  for (int c = 0; c < (has_double(layers) ? 4 : 3); c++)
    fftw_mpi_execute_dft_r2c(plans_->forward, slab_.component[c],
                             reinterpret_cast<fftw_complex *>(slab_.component[c]));
}

void EwaldGrid::backward()
{
  for (int c = 0; c < 3; c++)
    fftw_mpi_execute_dft_c2r(plans_->backward, reinterpret_cast<fftw_complex *>(slab_.component[c]),
                             slab_.component[c]);
}

// One row of modes along the third reciprocal vector: zero beyond the band limit, inside
//   u = (8 pi gamma / V k^2) influence [(I - kk/k^2) F + i k tr D].
template <Layers layers>
void EwaldGrid::multiply_row(int n0, int n1, ptrdiff_t row, const Mat3 &cell)
{
  const auto [m0, m1, m2] = parameters_.grid;
  const int half = m2 / 2 + 1;
  const Mat3 reciprocal = 2.0 * M_PI * cell.inverse().transpose();    // columns b_0, b_1, b_2
  auto signed_mode = [](int n, int m) {
    return n <= m / 2 ? n : n - m;
  };
  const Vec3 base =
      signed_mode(n0, m0) * reciprocal.col(0) + signed_mode(n1, m1) * reciprocal.col(1);
  const Vec3 step = reciprocal.col(2);
  const double limit2 = parameters_.band_limit * parameters_.band_limit;
  // |base + n step|^2 <= limit^2 for n between the roots of a quadratic.
  const double center = -base.dot(step) / step.squaredNorm();
  const double reach2 = (limit2 - base.squaredNorm()) / step.squaredNorm() + center * center;
  int begin = half, end = half;
  const bool is_nyquist = 2 * n0 == m0 || 2 * n1 == m1;
  if (reach2 >= 0.0 && !is_nyquist) {
    const double reach = std::sqrt(reach2);
    begin = std::clamp(static_cast<int>(std::ceil(center - reach)), 0, half);
    end = std::clamp(static_cast<int>(std::floor(center + reach)) + 1, begin, (m2 + 1) / 2);
    if (end < begin) end = begin;
  }
  std::complex<double> *mode[4];
  for (int c = 0; c < (has_double(layers) ? 4 : 3); c++) {
    mode[c] = reinterpret_cast<std::complex<double> *>(slab_.component[c]) + row * half;
    if (c == 3) continue;
    std::fill_n(mode[c], begin, 0.0);
    std::fill(mode[c] + end, mode[c] + half, 0.0);
  }
  const double scale =
      8.0 * M_PI / std::fabs(cell.determinant()) * influence_[0][n0] * influence_[1][n1];
  for (int n2 = begin; n2 < end; n2++) {
    const Vec3 k = base + n2 * step;
    const double k2 = k.squaredNorm();
    if (k2 == 0.0) {
      mode[0][n2] = mode[1][n2] = mode[2][n2] = 0.0;
      continue;
    }
    const double inverse_k2 = 1.0 / k2;
    const double g = scale * influence_[2][n2] * factors_.value(k2) * inverse_k2;
    const std::complex<double> fx = mode[0][n2], fy = mode[1][n2], fz = mode[2][n2];
    std::complex<double> along = -(k[0] * fx + k[1] * fy + k[2] * fz) * inverse_k2;
    if (has_double(layers)) {
      const std::complex<double> trace = mode[3][n2];
      along += std::complex<double>(-trace.imag(), trace.real());
    }
    mode[0][n2] = g * (fx + k[0] * along);
    mode[1][n2] = g * (fy + k[1] * along);
    mode[2][n2] = g * (fz + k[2] * along);
  }
}

void EwaldGrid::apply_kernel(Layers layers, const Mat3 &cell)
{
  const int m0 = parameters_.grid[0];
  for (ptrdiff_t row = 0; row < plans_->n_rows; row++)
    for (int n0 = 0; n0 < m0; n0++) {
      const int n1 = static_cast<int>(plans_->first_row + row);
      if (has_double(layers))
        multiply_row<Layers::Double>(n0, n1, row * m0 + n0, cell);
      else
        multiply_row<Layers::Single>(n0, n1, row * m0 + n0, cell);
    }
}

}    // namespace biem
