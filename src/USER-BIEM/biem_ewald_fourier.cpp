// Particle-mesh sum on slabs: spread, transform, project and scale, transform back, interpolate.
#include "biem_ewald_fourier.h"
#include "biem_error.h"
#include <cmath>
#include <complex>
#include <cstring>
#include <fftw3-mpi.h>

namespace biem {

// Window weights of all points that touch this rank's planes, order values per axis and point.
struct FourierSum::Windows {
  std::vector<int> first;         // 3 per point, wrapped into the grid
  std::vector<double> weights;    // 3 * order per point
};

// FFTW's arrays: planes x rows x (padded columns) x 3 components, in place.
struct FourierSum::Plans {
  fftw_plan forward = nullptr, backward = nullptr;
  double *grid = nullptr;
  ptrdiff_t first_plane = 0, n_planes = 0;    // slab along axis 0, real side
  ptrdiff_t first_row = 0, n_rows = 0;        // slab along axis 1, transposed Fourier side
  ptrdiff_t padded = 0;                       // doubles per grid row and component
  ptrdiff_t size = 0;                         // doubles allocated

  ~Plans()
  {
    if (forward) fftw_destroy_plan(forward);
    if (backward) fftw_destroy_plan(backward);
    if (grid) fftw_free(grid);
  }
};

FourierSum::FourierSum(MPI_Comm comm, const EwaldParameters &parameters) :
    comm_(comm), parameters_(parameters), window_(make_window(parameters)),
    factors_(*make_split(parameters), parameters.band_limit), plans_(std::make_unique<Plans>()),
    source_windows_(std::make_unique<Windows>()), target_windows_(std::make_unique<Windows>())
{
  fftw_mpi_init();    // may be called any number of times
  const ptrdiff_t n[3] = {parameters.grid[0], parameters.grid[1], parameters.grid[2]};
  const ptrdiff_t complex_n[3] = {n[0], n[1], n[2] / 2 + 1};
  Plans &p = *plans_;
  const ptrdiff_t local = fftw_mpi_local_size_many_transposed(
      3, complex_n, 3, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK, comm, &p.n_planes,
      &p.first_plane, &p.n_rows, &p.first_row);
  p.padded = 2 * complex_n[2];
  p.size = 2 * local;
  p.grid = fftw_alloc_real(p.size > 0 ? p.size : 1);
  // FFTW_ESTIMATE: measured plans differ from run to run and with them the last digits.
  auto *complex_grid = reinterpret_cast<fftw_complex *>(p.grid);
  p.forward =
      fftw_mpi_plan_many_dft_r2c(3, n, 3, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK, p.grid,
                                 complex_grid, comm, FFTW_ESTIMATE | FFTW_MPI_TRANSPOSED_OUT);
  p.backward = fftw_mpi_plan_many_dft_c2r(3, n, 3, FFTW_MPI_DEFAULT_BLOCK, FFTW_MPI_DEFAULT_BLOCK,
                                          complex_grid, p.grid, comm,
                                          FFTW_ESTIMATE | FFTW_MPI_TRANSPOSED_IN);
  if (!p.forward || !p.backward)
    throw Error("FFTW could not plan a " + std::to_string(n[0]) + " x " + std::to_string(n[1]) +
                " x " + std::to_string(n[2]) + " grid on this number of ranks");
  layout_ = make_slab_layout(comm, parameters.grid[0], static_cast<int>(p.first_plane),
                             static_cast<int>(p.n_planes));
  for (int a = 0; a < 3; a++)
    influence_[a] = compute_influence_factors(*window_, parameters.grid[a]);
}

FourierSum::~FourierSum() = default;

void FourierSum::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  // The small bias takes +1/2 and -1/2, with their rounding errors, to the same side.
  auto reduce = [](double tilt, double length) {
    return std::floor(tilt / length + 0.5 + 1e-9);
  };
  cell_ = cell;
  cell_.col(2) -= reduce(cell_(1, 2), cell_(1, 1)) * cell_.col(1);
  cell_.col(2) -= reduce(cell_(0, 2), cell_(0, 0)) * cell_.col(0);
  cell_.col(1) -= reduce(cell_(0, 1), cell_(0, 0)) * cell_.col(0);
  origin_ = origin;
  inverse_cell_ = cell_.inverse();
}

Points FourierSum::to_fractional(PointsView points) const
{
  Points s = inverse_cell_ * (points.colwise() - origin_);
  for (Eigen::Index i = 0; i < s.size(); i++) {
    double &value = s.data()[i];
    value -= std::floor(value);
    if (value >= 1.0) value = 0.0;    // a tiny negative number rounds to 1
  }
  return s;
}

void FourierSum::compute_windows(const Points &fractional, Windows &windows) const
{
  const int order = parameters_.order;
  const Eigen::Index n = fractional.cols();
  windows.first.resize(3 * n);
  windows.weights.resize(3 * order * n);
  for (Eigen::Index i = 0; i < n; i++)
    for (int a = 0; a < 3; a++) {
      const int grid = parameters_.grid[a];
      const int first =
          window_->compute_weights(fractional(a, i) * grid, &windows.weights[(3 * i + a) * order]);
      windows.first[3 * i + a] = first < 0 ? first + grid : first;
    }
}

void FourierSum::set_points(PointsView sources, PointsView targets)
{
  source_router_.set_points(comm_, layout_, to_fractional(sources), parameters_.order);
  target_router_.set_points(comm_, layout_, to_fractional(targets), parameters_.order);
  compute_windows(source_router_.points(), *source_windows_);
  compute_windows(target_router_.points(), *target_windows_);
}

double &FourierSum::grid_at(int plane, int row)
{
  return plans_
      ->grid[(static_cast<ptrdiff_t>(plane) * parameters_.grid[1] + row) * plans_->padded * 3];
}

void FourierSum::spread(const Windows &w, const Points &strengths)
{
  const int order = parameters_.order;
  const auto [m0, m1, m2] = parameters_.grid;
  std::memset(plans_->grid, 0, plans_->size * sizeof(double));
  std::array<double, 3 * kMaxWindowOrder> column;    // weight of axis 2 times the force
  for (Eigen::Index i = 0; i < strengths.cols(); i++) {
    const int *first = &w.first[3 * i];
    const double *w0 = &w.weights[3 * order * i], *w1 = w0 + order, *w2 = w1 + order;
    for (int k = 0; k < order; k++)
      for (int c = 0; c < 3; c++)
        column[3 * k + c] = w2[k] * strengths(c, i);
    // the run along axis 2 may wrap: split it once
    const int head = 3 * std::min(order, m2 - first[2]);
    for (int a = 0; a < order; a++) {
      const int plane = (first[0] + a) % m0 - layout_.first;
      if (plane < 0 || plane >= layout_.count) continue;
      for (int b = 0; b < order; b++) {
        const double weight = w0[a] * w1[b];
        double *row = &grid_at(plane, (first[1] + b) % m1);
        double *run = row + 3 * first[2];
        for (int k = 0; k < head; k++)
          run[k] += weight * column[k];
        for (int k = head; k < 3 * order; k++)
          row[k - head] += weight * column[k];
      }
    }
  }
}

void FourierSum::interpolate(const Windows &w, Points &values) const
{
  const int order = parameters_.order;
  const auto [m0, m1, m2] = parameters_.grid;
  auto *self = const_cast<FourierSum *>(this);    // grid_at is shared with spread
  std::array<double, 3 * kMaxWindowOrder> column;
  for (Eigen::Index i = 0; i < values.cols(); i++) {
    const int *first = &w.first[3 * i];
    const double *w0 = &w.weights[3 * order * i], *w1 = w0 + order, *w2 = w1 + order;
    const int head = 3 * std::min(order, m2 - first[2]);
    column.fill(0.0);
    for (int a = 0; a < order; a++) {
      const int plane = (first[0] + a) % m0 - layout_.first;
      if (plane < 0 || plane >= layout_.count) continue;
      for (int b = 0; b < order; b++) {
        const double weight = w0[a] * w1[b];
        const double *row = &self->grid_at(plane, (first[1] + b) % m1);
        const double *run = row + 3 * first[2];
        for (int k = 0; k < head; k++)
          column[k] += weight * run[k];
        for (int k = head; k < 3 * order; k++)
          column[k] += weight * row[k - head];
      }
    }
    values.col(i).setZero();
    for (int k = 0; k < order; k++)
      for (int c = 0; c < 3; c++)
        values(c, i) += w2[k] * column[3 * k + c];
  }
}

void FourierSum::apply_kernel()
{
  const auto [m0, m1, m2] = parameters_.grid;
  const int half = m2 / 2 + 1;
  const Mat3 reciprocal = 2.0 * M_PI * inverse_cell_.transpose();    // columns b_0, b_1, b_2
  const double limit2 = parameters_.band_limit * parameters_.band_limit;
  const double scale = 8.0 * M_PI / std::fabs(cell_.determinant());
  auto *grid = reinterpret_cast<std::complex<double> *>(plans_->grid);
  auto signed_mode = [](int n, int m) {
    return n <= m / 2 ? n : n - m;
  };
  for (ptrdiff_t row = 0; row < plans_->n_rows; row++) {
    const int n1 = static_cast<int>(plans_->first_row + row);
    for (int n0 = 0; n0 < m0; n0++) {
      const Vec3 base =
          signed_mode(n0, m0) * reciprocal.col(0) + signed_mode(n1, m1) * reciprocal.col(1);
      const double factor = scale * influence_[0][n0] * influence_[1][n1];
      std::complex<double> *mode = grid + (row * m0 + n0) * half * 3;
      for (int n2 = 0; n2 < half; n2++, mode += 3) {
        const Vec3 k = base + n2 * reciprocal.col(2);
        const double k2 = k.squaredNorm();
        if (k2 == 0.0 || k2 > limit2) {
          mode[0] = mode[1] = mode[2] = 0.0;
          continue;
        }
        const double g = factor * influence_[2][n2] * factors_.value(k2) / k2;
        const std::complex<double> along = (k[0] * mode[0] + k[1] * mode[1] + k[2] * mode[2]) / k2;
        for (int c = 0; c < 3; c++)
          mode[c] = g * (mode[c] - k[c] * along);
      }
    }
  }
}

void FourierSum::add_single_layer(PointsView strengths, PointsRef velocities)
{
  Points routed;
  source_router_.send(strengths, routed);
  spread(*source_windows_, routed);
  auto *complex_grid = reinterpret_cast<fftw_complex *>(plans_->grid);
  fftw_mpi_execute_dft_r2c(plans_->forward, plans_->grid, complex_grid);
  apply_kernel();
  fftw_mpi_execute_dft_c2r(plans_->backward, complex_grid, plans_->grid);
  Points values(3, target_router_.points().cols());
  interpolate(*target_windows_, values);
  target_router_.return_add(values, velocities);
}

}    // namespace biem
