// Pruned slab transforms on serial FFTW plans and one all-to-all exchange each way: see the header.
#include "biem_ewald_transform.h"
#include "biem_error.h"
#include <algorithm>
#include <cstring>
#include <fftw3.h>
#include <string>

namespace biem {

namespace {

// Plans found by timing differ from run to run, and with them the last digits of all results.
// Measured cost of not timing them: 2 to 5 % of a sum.
constexpr unsigned kPlanning = FFTW_ESTIMATE;

using Complex = SlabTransform::Complex;

// Planes start on cache lines, 9 lines apart modulo the page: a stride of whole pages would map
// all planes to the same few lines of the first-level cache.
constexpr std::ptrdiff_t kPage = 512, kOffset = 72;    // doubles
constexpr std::ptrdiff_t kTile = 32;                   // columns per tile of a transposition

template <class T> struct FftwArray {
  T *data = nullptr;
  size_t size = 0;

  ~FftwArray() { fftw_free(data); }
  void resize(size_t n)
  {
    if (n <= size) return;
    fftw_free(data);
    data = static_cast<T *>(fftw_malloc(n * sizeof(T)));
    if (!data)
      throw Error("no memory for " + std::to_string(n * sizeof(T)) +
                  " bytes of the grid of the periodic sum: use more ranks or a larger accuracy");
    std::memset(static_cast<void *>(data), 0, n * sizeof(T));
    size = n;
  }
};

fftw_complex *to_fftw(Complex *p)
{
  return reinterpret_cast<fftw_complex *>(p);
}

}    // namespace

RankRange get_rank_range(int n, int rank, int n_ranks)
{
  return {static_cast<int>(static_cast<long>(n) * rank / n_ranks),
          static_cast<int>(static_cast<long>(n) * (rank + 1) / n_ranks)};
}

// One plan per stage and number of fields; they run on any plane or column.
struct SlabTransform::Plans {
  FftwArray<double> values;
  FftwArray<Complex> rows;       // one plane at a time: fields x rows x (M_2/2 + 1)
  FftwArray<Complex> kept;       // planes x fields x kept (n1, n2)
  FftwArray<Complex> columns;    // columns x fields x M_0
  FftwArray<Complex> send, receive;
  std::array<fftw_plan, kMaxFields + 1> rows_forward{}, planes_forward{}, columns_forward{};
  fftw_plan rows_backward = nullptr, planes_backward = nullptr, columns_backward = nullptr;

  ~Plans()
  {
    for (const auto &stage : {rows_forward, planes_forward, columns_forward})
      for (fftw_plan p : stage)
        fftw_destroy_plan(p);
    for (fftw_plan p : {rows_backward, planes_backward, columns_backward})
      fftw_destroy_plan(p);
  }

  void make(const std::array<int, 3> &grid, int n_kept, int n_fields);
};

void SlabTransform::Plans::make(const std::array<int, 3> &m, int n_kept, int n_fields)
{
  if (rows_forward[n_fields]) return;
  const int half = m[2] / 2 + 1;
  const fftw_iodim z_real{m[2], n_fields, 1}, z_complex{m[2], 1, n_fields};
  const fftw_iodim rows_real[2] = {{m[1], n_fields * m[2], half}, {n_fields, 1, m[1] * half}};
  const fftw_iodim rows_complex[2] = {{m[1], half, n_fields * m[2]}, {n_fields, m[1] * half, 1}};
  const fftw_iodim y{m[1], half, half}, x{m[0], 1, 1};
  const fftw_iodim many_y[2] = {{n_kept, 1, 1}, {n_fields, m[1] * half, m[1] * half}};
  const fftw_iodim many_x{n_fields, m[0], m[0]};
  fftw_complex *plane = to_fftw(rows.data), *column = to_fftw(columns.data);
  double *real = values.data + kMargin;
  rows_forward[n_fields] = fftw_plan_guru_dft_r2c(1, &z_real, 2, rows_real, real, plane, kPlanning);
  planes_forward[n_fields] =
      fftw_plan_guru_dft(1, &y, 2, many_y, plane, plane, FFTW_FORWARD, kPlanning);
  columns_forward[n_fields] =
      fftw_plan_guru_dft(1, &x, 1, &many_x, column, column, FFTW_FORWARD, kPlanning);
  bool is_planned = rows_forward[n_fields] && planes_forward[n_fields] && columns_forward[n_fields];
  if (n_fields == kBackwardFields) {
    rows_backward = fftw_plan_guru_dft_c2r(1, &z_complex, 2, rows_complex, plane, real, kPlanning);
    planes_backward = fftw_plan_guru_dft(1, &y, 2, many_y, plane, plane, FFTW_BACKWARD, kPlanning);
    columns_backward =
        fftw_plan_guru_dft(1, &x, 1, &many_x, column, column, FFTW_BACKWARD, kPlanning);
    is_planned = is_planned && rows_backward && planes_backward && columns_backward;
  }
  if (!is_planned)
    throw Error("FFTW could not plan a " + std::to_string(m[0]) + " x " + std::to_string(m[1]) +
                " x " + std::to_string(m[2]) + " grid");
}

SlabTransform::SlabTransform(MPI_Comm comm, const std::array<int, 3> &grid,
                             const std::array<int, 3> &modes) :
    comm_(comm),
    grid_(grid), modes_(modes), n_all_columns_((2 * modes[1] + 1) * (modes[2] + 1)),
    plans_(std::make_unique<Plans>())
{
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  planes_ = get_rank_range(grid[0], rank_, n_ranks_);
  columns_ = get_rank_range(n_all_columns_, rank_, n_ranks_);
  values(kBackwardFields);
}

SlabTransform::~SlabTransform() = default;

std::ptrdiff_t SlabTransform::plane_size(int n_fields) const
{
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(grid_[1]) * grid_[2] * n_fields;
  return (size - kOffset + kPage - 1) / kPage * kPage + kOffset;
}

double *SlabTransform::values(int n_fields)
{
  Plans &p = *plans_;
  const size_t n_planes = std::max(1, planes_.size());
  p.values.resize(n_planes * plane_size(n_fields) + 2 * kMargin);
  p.rows.resize(static_cast<size_t>(n_fields) * grid_[1] * (grid_[2] / 2 + 1));
  p.kept.resize(n_planes * n_fields * n_all_columns_);
  p.columns.resize(static_cast<size_t>(std::max(1, columns_.size())) * n_fields * grid_[0]);
  if (!p.rows_forward[n_fields]) {    // planning overwrites the arrays
    p.make(grid_, modes_[2] + 1, n_fields);
    std::fill_n(p.values.data, p.values.size, 0.0);
  }
  return p.values.data + kMargin;
}

std::array<int, 2> SlabTransform::column_modes(int i) const
{
  const int column = columns_.begin + i, n2 = column % (modes_[2] + 1);
  const int n1 = column / (modes_[2] + 1);    // 0 ... modes, then -modes ... -1
  return {n1 <= modes_[1] ? n1 : n1 - (2 * modes_[1] + 1), n2};
}

SlabTransform::Complex *SlabTransform::column(int i)
{
  return plans_->columns.data + i * column_stride_;
}

void SlabTransform::forward_columns(int begin, int end, int n_fields)
{
  for (int i = begin; i < end; i++)
    fftw_execute_dft(plans_->columns_forward[n_fields], to_fftw(column(i)), to_fftw(column(i)));
}

void SlabTransform::backward_columns(int begin, int end)
{
  for (int i = begin; i < end; i++)
    fftw_execute_dft(plans_->columns_backward, to_fftw(column(i)), to_fftw(column(i)));
}

void SlabTransform::forward(int n_fields)
{
  Plans &p = *plans_;
  column_stride_ = static_cast<std::ptrdiff_t>(n_fields) * grid_[0];
  const std::ptrdiff_t half = grid_[2] / 2 + 1;
  const int n_kept = modes_[2] + 1;
  Complex *kept = p.kept.data;
  for (int plane = 0; plane < planes_.size(); plane++) {
    fftw_execute_dft_r2c(p.rows_forward[n_fields],
                         p.values.data + kMargin + plane * plane_size(n_fields),
                         to_fftw(p.rows.data));
    fftw_execute_dft(p.planes_forward[n_fields], to_fftw(p.rows.data), to_fftw(p.rows.data));
    for (int f = 0; f < n_fields; f++)
      for (int n1 = -modes_[1]; n1 <= modes_[1]; n1++) {
        const int row = n1 < 0 ? n1 + grid_[1] : n1, slot = n1 < 0 ? n1 + 2 * modes_[1] + 1 : n1;
        std::copy_n(p.rows.data + (static_cast<std::ptrdiff_t>(f) * grid_[1] + row) * half, n_kept,
                    kept + slot * n_kept);
        if (n1 == modes_[1]) kept += n_all_columns_;
      }
  }
  if (n_ranks_ == 1) {
    columns_from_block(p.kept.data, planes_, n_fields);
    return;
  }
  // Planes to their columns' owners: one block per rank.
  p.send.resize(static_cast<size_t>(planes_.size()) * n_fields * n_all_columns_);
  p.receive.resize(static_cast<size_t>(grid_[0]) * n_fields * columns_.size());
  Complex *out = p.send.data;
  for (int r = 0; r < n_ranks_; r++) {
    const RankRange columns = get_rank_range(n_all_columns_, r, n_ranks_);
    for (int i = 0; i < planes_.size() * n_fields; i++, out += columns.size())
      std::copy_n(p.kept.data + static_cast<std::ptrdiff_t>(i) * n_all_columns_ + columns.begin,
                  columns.size(), out);
  }
  exchange(n_fields, p.send.data, p.receive.data, Direction::ToColumns);
  const Complex *block = p.receive.data;
  for (int r = 0; r < n_ranks_; r++) {
    const RankRange planes = get_rank_range(grid_[0], r, n_ranks_);
    columns_from_block(block, planes, n_fields);
    block += static_cast<std::ptrdiff_t>(planes.size()) * n_fields * columns_.size();
  }
}

void SlabTransform::backward()
{
  constexpr int n_fields = kBackwardFields;
  Plans &p = *plans_;
  if (n_ranks_ == 1) {
    block_from_columns(p.kept.data, planes_, n_fields);
  } else {
    Complex *block = p.receive.data;
    for (int r = 0; r < n_ranks_; r++) {
      const RankRange planes = get_rank_range(grid_[0], r, n_ranks_);
      block_from_columns(block, planes, n_fields);
      block += static_cast<std::ptrdiff_t>(planes.size()) * n_fields * columns_.size();
    }
    exchange(n_fields, p.receive.data, p.send.data, Direction::ToPlanes);
    const Complex *in = p.send.data;
    for (int r = 0; r < n_ranks_; r++) {
      const RankRange columns = get_rank_range(n_all_columns_, r, n_ranks_);
      for (int i = 0; i < planes_.size() * n_fields; i++, in += columns.size())
        std::copy_n(in, columns.size(),
                    p.kept.data + static_cast<std::ptrdiff_t>(i) * n_all_columns_ + columns.begin);
    }
  }
  const std::ptrdiff_t half = grid_[2] / 2 + 1;
  const int n_kept = modes_[2] + 1;
  const Complex *kept = p.kept.data;
  for (int plane = 0; plane < planes_.size(); plane++) {
    std::fill_n(p.rows.data, n_fields * grid_[1] * half, Complex());
    for (int f = 0; f < n_fields; f++, kept += n_all_columns_)
      for (int n1 = -modes_[1]; n1 <= modes_[1]; n1++) {
        const int row = n1 < 0 ? n1 + grid_[1] : n1, slot = n1 < 0 ? n1 + 2 * modes_[1] + 1 : n1;
        std::copy_n(kept + slot * n_kept, n_kept,
                    p.rows.data + (static_cast<std::ptrdiff_t>(f) * grid_[1] + row) * half);
      }
    fftw_execute_dft(p.planes_backward, to_fftw(p.rows.data), to_fftw(p.rows.data));
    fftw_execute_dft_c2r(p.rows_backward, to_fftw(p.rows.data),
                         p.values.data + kMargin + plane * plane_size(n_fields));
  }
}

void SlabTransform::columns_from_block(const Complex *block, RankRange planes, int n_fields)
{
  const std::ptrdiff_t n = columns_.size();
  for (int f = 0; f < n_fields; f++)
    for (std::ptrdiff_t first = 0; first < n; first += kTile) {
      const std::ptrdiff_t end = std::min(n, first + kTile);
      for (int plane = planes.begin; plane < planes.end; plane++) {
        const Complex *in =
            block + (static_cast<std::ptrdiff_t>(plane - planes.begin) * n_fields + f) * n;
        Complex *out = plans_->columns.data + static_cast<std::ptrdiff_t>(f) * grid_[0] + plane;
        for (std::ptrdiff_t c = first; c < end; c++)
          out[c * column_stride_] = in[c];
      }
    }
}

void SlabTransform::block_from_columns(Complex *block, RankRange planes, int n_fields)
{
  const std::ptrdiff_t n = columns_.size();
  for (int f = 0; f < n_fields; f++)
    for (std::ptrdiff_t first = 0; first < n; first += kTile) {
      const std::ptrdiff_t end = std::min(n, first + kTile);
      for (int plane = planes.begin; plane < planes.end; plane++) {
        Complex *out =
            block + (static_cast<std::ptrdiff_t>(plane - planes.begin) * n_fields + f) * n;
        const Complex *in =
            plans_->columns.data + static_cast<std::ptrdiff_t>(f) * grid_[0] + plane;
        for (std::ptrdiff_t c = first; c < end; c++)
          out[c] = in[c * column_stride_];
      }
    }
}

void SlabTransform::exchange(int n_fields, const Complex *send, Complex *receive,
                             Direction direction)
{
  // In doubles: blocks of my planes for other ranks' columns, and of their planes for my columns.
  std::array<std::vector<int>, 2> counts, offsets;
  for (int r = 0; r < n_ranks_; r++) {
    const int of_planes = planes_.size() * get_rank_range(n_all_columns_, r, n_ranks_).size();
    const int of_columns = get_rank_range(grid_[0], r, n_ranks_).size() * columns_.size();
    const int both[2] = {2 * n_fields * of_planes, 2 * n_fields * of_columns};
    for (int side = 0; side < 2; side++) {
      offsets[side].push_back(r == 0 ? 0 : offsets[side].back() + counts[side].back());
      counts[side].push_back(both[side]);
    }
  }
  const int from = direction == Direction::ToColumns ? 0 : 1, to = 1 - from;
  MPI_Alltoallv(send, counts[from].data(), offsets[from].data(), MPI_DOUBLE, receive,
                counts[to].data(), offsets[to].data(), MPI_DOUBLE, comm_);
}

}    // namespace biem
