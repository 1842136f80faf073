// Inner loops of the particle mesh: see the header. Rows run along the third lattice vector; a
// window that wraps around there is done in two runs with the weights beyond the edge set to zero,
// so that one loop without branches serves all.
#include "biem_ewald_spread.h"
#include "biem_bin_sort.h"
#include "biem_prefetch.h"
#include "biem_simd_row.h"
#include <algorithm>
#include <utility>

namespace biem {

namespace {

constexpr int kBlock = 8;    // grid points per edge of the blocks that points are sorted into

}    // namespace

void PointWindows::set_points(const EwaldWindow &window, const std::array<int, 3> &grid,
                              PointsView fractional, WindowContent content)
{
  const int n = static_cast<int>(fractional.cols());
  std::array<int, 3> blocks;
  for (int a = 0; a < 3; a++)
    blocks[a] = (grid[a] + kBlock - 1) / kBlock;
  std::vector<int> block(n), start;
  for (int i = 0; i < n; i++) {
    block[i] = 0;
    for (int a = 0; a < 3; a++)
      block[i] = block[i] * blocks[a] +
                 std::min(static_cast<int>(fractional(a, i) * grid[a]) / kBlock, blocks[a] - 1);
  }
  sort_into_bins(block, blocks[0] * blocks[1] * blocks[2], start, order_);

  window_order_ = window.order();
  padded_ = window.padded();
  first_.resize(3 * n);
  weights_.resize(3 * static_cast<size_t>(padded_) * n);
  slopes_.resize(content == WindowContent::ValuesAndSlopes ? weights_.size() : 0);
  for (int i = 0; i < n; i++) {
    fetch_ahead(fractional.data(), order_, i);
    for (int a = 0; a < 3; a++) {
      const double s = fractional(a, order_[i]) * grid[a];
      const size_t offset = (3 * static_cast<size_t>(i) + a) * padded_;
      const int first = slopes_.empty() ? window.compute_weights(s, &weights_[offset])
                                        : window.compute_weights_and_slopes(s, &weights_[offset],
                                                                            &slopes_[offset]);
      first_[3 * i + a] = first < 0 ? first + grid[a] : first;
    }
  }
}

// The loops for one order of the window, so that the compiler unrolls them.
template <int order> struct PointWindows::Loops {
  using ForceRow = SimdRow<3 * order>;    // of interleaved fields
  using LayerRow = SimdRow<4 * order>;    // the fourth one of the double layer

  // What one entry touches.
  struct Entry {
    const double *weights[3];
    std::ptrdiff_t row[order];    // offset of each row in its plane
    double *plane[order];         // null: of another rank
    int first;                    // along the row
    int n_fields, size;

    Entry(const PointWindows &w, const GridSlab &slab, int i) :
        first(w.first_[3 * i + 2]), n_fields(slab.n_fields), size(slab.grid[2])
    {
      for (int a = 0; a < 3; a++)
        weights[a] = &w.weights_[(3 * static_cast<size_t>(i) + a) * w.padded_];
      for (int b = 0; b < order; b++) {
        const int x = w.first_[3 * i] + b, y = w.first_[3 * i + 1] + b;
        const int plane_index = (x < slab.grid[0] ? x : x % slab.grid[0]) - slab.first_plane;
        plane[b] = plane_index >= 0 && plane_index < slab.n_planes
                       ? slab.values + plane_index * slab.plane_size
                       : nullptr;
        row[b] = static_cast<std::ptrdiff_t>(y < slab.grid[1] ? y : y % slab.grid[1]) *
                 slab.grid[2] * n_fields;
      }
    }

    // Calls run(offset in the row, weights, slopes) for each part of the window along the row: one,
    // or several when it wraps around the edge. slopes may be null.
    template <class Run> BIEM_INLINE void split_row(const double *slopes, const Run &run) const
    {
      if (first + order <= size) {
        run(first * n_fields, weights[2], slopes);
        return;
      }
      for (int start = first; start > -order; start -= size) {
        double part[order], part_slopes[order];
        for (int k = 0; k < order; k++) {
          const bool is_inside = start + k >= 0 && start + k < size;
          part[k] = is_inside ? weights[2][k] : 0.0;
          part_slopes[k] = is_inside && slopes ? slopes[k] : 0.0;
        }
        run(start * n_fields, part, part_slopes);
      }
    }
  };

  // Values of a field vector times window weights along the row, interleaved.
  template <int n> static BIEM_INLINE SimdRow<n * order> make_row(const double *w, const double *f)
  {
    double values[SimdRow<n * order>::kSize] = {};
    for (int k = 0; k < order; k++)
      for (int c = 0; c < n; c++)
        values[n * k + c] = w[k] * f[c];
    return SimdRow<n * order>::load_from(values);
  }

  template <int n_fields>
  static void spread_forces(const PointWindows &w, const GridSlab &slab, PointsView forces)
  {
    using Row = SimdRow<n_fields * order>;
    for (int i = 0; i < w.size(); i++) {
      fetch_ahead(forces.data(), w.order_, i);
      const Entry entry(w, slab, i);
      double f[n_fields] = {};
      for (int a = 0; a < 3; a++)
        f[a] = forces(a, w.order_[i]);
      entry.split_row(nullptr, [&](std::ptrdiff_t start, const double *part, const double *) {
        const Row source = make_row<n_fields>(part, f);
        for (int a = 0; a < order; a++) {
          if (!entry.plane[a]) continue;
          for (int b = 0; b < order; b++) {
            double *p = entry.plane[a] + entry.row[b] + start;
            Row sum = Row::load_from(p);
            sum.add(entry.weights[0][a] * entry.weights[1][b], source);
            sum.store_to(p);
          }
        }
      });
    }
  }

  // g = -2 D to_grid^T: column a belongs to the derivative along axis a.
  static BIEM_INLINE void spread_one(const Entry &entry, const double *slopes, int padded,
                                     const Vec3 &f, const Mat3 &g, double trace)
  {
    const double *d0 = slopes, *d1 = d0 + padded, *d2 = d1 + padded;
    const double *w0 = entry.weights[0], *w1 = entry.weights[1];
    entry.split_row(d2, [&](std::ptrdiff_t start, const double *part, const double *part_slopes) {
      for (int a = 0; a < order; a++) {
        if (!entry.plane[a]) continue;
        Eigen::Vector4d value, along1, along2;    // times w1, slope of w1, slope of w2
        value << w0[a] * f + d0[a] * g.col(0), w0[a] * trace;
        along1 << w0[a] * g.col(1), 0.0;
        along2 << w0[a] * g.col(2), 0.0;
        LayerRow plain = make_row<4>(part, value.data());
        plain.add(1.0, make_row<4>(part_slopes, along2.data()));
        const LayerRow sloped = make_row<4>(part, along1.data());
        for (int b = 0; b < order; b++) {
          double *p = entry.plane[a] + entry.row[b] + start;
          LayerRow sum = LayerRow::load_from(p);
          sum.add(w1[b], plain);
          sum.add(d1[b], sloped);
          sum.store_to(p);
        }
      }
    });
  }

  static void spread_layers(const PointWindows &w, const GridSlab &slab, const PointsView *source,
                            const Mat3 &to_grid)
  {
    const PointsView &forces = source[0], &densities = source[1], &normals = source[2];
    const Mat3 to_grid_transposed = to_grid.transpose();
    for (int i = 0; i < w.size(); i++) {
      fetch_ahead(densities.data(), w.order_, i);
      const int point = w.order_[i];
      const Vec3 q = densities.col(point), n = normals.col(point);
      const Vec3 f = forces.cols() > 0 ? Vec3(forces.col(point)) : Vec3(Vec3::Zero());
      const Mat3 g = -(q * n.transpose() + n * q.transpose()) * to_grid_transposed;
      spread_one(Entry(w, slab, i), &w.slopes_[3 * static_cast<size_t>(w.padded_) * i], w.padded_,
                 f, g, q.dot(n));
    }
  }

  static void interpolate(const PointWindows &w, const GridSlab &slab, PointsRef values)
  {
    for (int i = 0; i < w.size(); i++) {
      fetch_ahead(values.data(), w.order_, i);
      const Entry entry(w, slab, i);
      Vec3 u = Vec3::Zero();
      entry.split_row(nullptr, [&](std::ptrdiff_t start, const double *part, const double *) {
        ForceRow sum = {};
        for (int a = 0; a < order; a++) {
          if (!entry.plane[a]) continue;
          for (int b = 0; b < order; b++)
            sum.add(entry.weights[0][a] * entry.weights[1][b],
                    ForceRow::load_from(entry.plane[a] + entry.row[b] + start));
        }
        double column[ForceRow::kSize];
        sum.store_to(column);
        for (int k = 0; k < order; k++)
          for (int c = 0; c < 3; c++)
            u[c] += part[k] * column[3 * k + c];
      });
      values.col(w.order_[i]) += u;
    }
  }
};

namespace {

// Calls action.template operator()<order>() for the run-time order.
template <class Action, int... orders>
void dispatch(int order, const Action &action, std::integer_sequence<int, orders...>)
{
  ((order == orders + kMinWindowOrder
        ? action(std::integral_constant<int, orders + kMinWindowOrder>())
        : void()),
   ...);
}

constexpr std::make_integer_sequence<int, kMaxWindowOrder - kMinWindowOrder + 1> kOrders{};

}    // namespace

void PointWindows::spread_forces(const GridSlab &slab, PointsView forces) const
{
  dispatch(
      window_order_,
      [&](auto order) {
        using OfOrder = Loops<decltype(order)::value>;
        if (slab.n_fields == 4)
          OfOrder::template spread_forces<4>(*this, slab, forces);
        else
          OfOrder::template spread_forces<3>(*this, slab, forces);
      },
      kOrders);
}

void PointWindows::spread_layers(const GridSlab &slab, PointsView forces, PointsView densities,
                                 PointsView normals, const Mat3 &to_grid) const
{
  const PointsView sources[3] = {forces, densities, normals};
  dispatch(
      window_order_,
      [&](auto order) {
        Loops<decltype(order)::value>::spread_layers(*this, slab, sources, to_grid);
      },
      kOrders);
}

void PointWindows::interpolate(const GridSlab &slab, PointsRef values) const
{
  dispatch(
      window_order_,
      [&](auto order) { Loops<decltype(order)::value>::interpolate(*this, slab, values); },
      kOrders);
}

}    // namespace biem
