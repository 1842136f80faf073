// Inner loops of the particle mesh: see the header. Rows run along the third lattice vector; a
// window that wraps around there is done in two runs with the weights beyond the edge set to zero,
// so that one loop without branches serves all.
#include "biem_ewald_spread.h"
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
  std::vector<int> block(n), start(blocks[0] * blocks[1] * blocks[2] + 1, 0);
  for (int i = 0; i < n; i++) {
    int index = 0;
    for (int a = 0; a < 3; a++)
      index = index * blocks[a] +
              std::min(static_cast<int>(fractional(a, i) * grid[a]) / kBlock, blocks[a] - 1);
    block[i] = index;
    start[index + 1]++;
  }
  for (size_t b = 1; b < start.size(); b++)
    start[b] += start[b - 1];
  order_.resize(n);
  for (int i = 0; i < n; i++)
    order_[start[block[i]]++] = i;

  window_order_ = window.order();
  padded_ = window.padded();
  first_.resize(3 * n);
  weights_.resize(3 * static_cast<size_t>(padded_) * n);
  slopes_.resize(content == WindowContent::ValuesAndSlopes ? weights_.size() : 0);
  for (int i = 0; i < n; i++)
    for (int a = 0; a < 3; a++) {
      const double s = fractional(a, order_[i]) * grid[a];
      const size_t offset = (3 * static_cast<size_t>(i) + a) * padded_;
      const int first = slopes_.empty() ? window.compute_weights(s, &weights_[offset])
                                        : window.compute_weights_and_slopes(s, &weights_[offset],
                                                                            &slopes_[offset]);
      first_[3 * i + a] = first < 0 ? first + grid[a] : first;
    }
}

// The loops for one order of the window, so that the compiler unrolls them.
template <int order> struct PointWindows::Loops {
  using Row = SimdRow<order>;

  // What one entry touches: rows[a * order + b], null in planes of other ranks.
  struct Rows {
    const double *weights;    // 3 x padded
    std::ptrdiff_t offset[order * order];
    bool has[order];

    Rows(const PointWindows &w, const GridSlab &slab, int i) :
        weights(&w.weights_[3 * static_cast<size_t>(w.padded_) * i])
    {
      const int *first = &w.first_[3 * i];
      std::ptrdiff_t row[order];
      for (int b = 0; b < order; b++) {
        const int y = first[1] + b;
        row[b] = (y < slab.grid[1] ? y : y % slab.grid[1]) * slab.padded;
      }
      for (int a = 0; a < order; a++) {
        const int x = first[0] + a;
        const int plane = (x < slab.grid[0] ? x : x % slab.grid[0]) - slab.first_plane;
        has[a] = plane >= 0 && plane < slab.n_planes;
        for (int b = 0; b < order; b++)
          offset[a * order + b] =
              static_cast<std::ptrdiff_t>(plane) * slab.grid[1] * slab.padded + row[b];
      }
    }
  };

  // Calls run(start in the row, weights, slopes) for each part of the window along the row: one, or
  // several when it wraps around the edge.
  template <class Run>
  static BIEM_INLINE void split_row(const double *w, const double *d, int first, int size,
                                    const Run &run)
  {
    if (first + order <= size) {
      run(first, w, d);
      return;
    }
    for (int start = first; start > -order; start -= size) {
      double part[Row::kSize], part_d[Row::kSize];
      for (int k = 0; k < Row::kSize; k++) {
        const bool is_inside = start + k >= 0 && start + k < size;
        part[k] = is_inside ? w[k] : 0.0;
        part_d[k] = is_inside && d ? d[k] : 0.0;
      }
      run(start, part, part_d);
    }
  }

  static void spread_forces(const PointWindows &w, const GridSlab &slab, PointsView forces)
  {
    for (int i = 0; i < w.size(); i++) {
      const Rows rows(w, slab, i);
      const double *w0 = rows.weights, *w1 = w0 + w.padded_, *w2 = w1 + w.padded_;
      const Vec3 f = forces.col(w.order_[i]);
      split_row(w2, nullptr, w.first_[3 * i + 2], slab.grid[2],
                [&](int start, const double *part, const double *) {
                  const Row window = Row::load_from(part);
                  for (int a = 0; a < order; a++) {
                    if (!rows.has[a]) continue;
                    for (int b = 0; b < order; b++) {
                      const double weight = w0[a] * w1[b];
                      const std::ptrdiff_t at = rows.offset[a * order + b] + start;
                      for (int c = 0; c < 3; c++)
                        add_to(slab.component[c] + at, weight * f[c], window);
                    }
                  }
                });
    }
  }

  static BIEM_INLINE void add_to(double *p, double factor, const Row &row)
  {
    Row sum = Row::load_from(p);
    sum.add(factor, row);
    sum.store_to(p);
  }

  // g = -2 D to_grid^T: column a belongs to the derivative along axis a.
  static BIEM_INLINE void spread_one(const Rows &rows, const GridSlab &slab, const double *d,
                                     int padded, int first, const Vec3 &f, const Mat3 &g,
                                     double trace)
  {
    const double *w0 = rows.weights, *w1 = w0 + padded, *w2 = w1 + padded;
    const double *d0 = d, *d1 = d0 + padded, *d2 = d1 + padded;
    split_row(w2, d2, first, slab.grid[2], [&](int start, const double *w, const double *slope) {
      const Row window = Row::load_from(w), slopes = Row::load_from(slope);
      for (int a = 0; a < order; a++) {
        if (!rows.has[a]) continue;
        const Vec3 f_a = w0[a] * f + d0[a] * g.col(0), g1_a = w0[a] * g.col(1),
                   g2_a = w0[a] * g.col(2);
        for (int b = 0; b < order; b++) {
          const std::ptrdiff_t at = rows.offset[a * order + b] + start;
          for (int c = 0; c < 3; c++) {
            double *p = slab.component[c] + at;
            Row sum = Row::load_from(p);
            sum.add(w1[b] * f_a[c] + d1[b] * g1_a[c], window);
            sum.add(w1[b] * g2_a[c], slopes);
            sum.store_to(p);
          }
          add_to(slab.component[3] + at, trace * w0[a] * w1[b], window);
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
      const int point = w.order_[i];
      const Vec3 q = densities.col(point), n = normals.col(point);
      const Vec3 f = forces.cols() > 0 ? Vec3(forces.col(point)) : Vec3(Vec3::Zero());
      const Mat3 g = -(q * n.transpose() + n * q.transpose()) * to_grid_transposed;
      spread_one(Rows(w, slab, i), slab, &w.slopes_[3 * static_cast<size_t>(w.padded_) * i],
                 w.padded_, w.first_[3 * i + 2], f, g, q.dot(n));
    }
  }

  static void interpolate(const PointWindows &w, const GridSlab &slab, PointsRef values)
  {
    for (int i = 0; i < w.size(); i++) {
      const Rows rows(w, slab, i);
      const double *w0 = rows.weights, *w1 = w0 + w.padded_, *w2 = w1 + w.padded_;
      Vec3 u = Vec3::Zero();
      split_row(w2, nullptr, w.first_[3 * i + 2], slab.grid[2],
                [&](int start, const double *part, const double *) {
                  Row column[3] = {};
                  for (int a = 0; a < order; a++) {
                    if (!rows.has[a]) continue;
                    for (int b = 0; b < order; b++) {
                      const double weight = w0[a] * w1[b];
                      const std::ptrdiff_t at = rows.offset[a * order + b] + start;
                      for (int c = 0; c < 3; c++)
                        column[c].add(weight, Row::load_from(slab.component[c] + at));
                    }
                  }
                  const Row window = Row::load_from(part);
                  for (int c = 0; c < 3; c++)
                    u[c] += column[c].dot(window);
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
      [&](auto order) { Loops<decltype(order)::value>::spread_forces(*this, slab, forces); },
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
