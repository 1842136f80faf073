// Distributed periodic images: see the header. The ghosts of a rank are ordered by owning rank, so
// that a message is a contiguous range of the values.
#include "biem_periodic_ghosts.h"
#include "biem_error.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace biem {

namespace {

constexpr int kTag = 7301;

void check_ghosts(const Mat3 &cell, double reach)
{
  if (!(std::fabs(cell.determinant()) > 0.0))
    throw Error("periodic ghosts: the volume of the cell is " + std::to_string(cell.determinant()) +
                "; give three independent lattice vectors as the columns of the cell");
  if (!(reach >= 0.0) || !std::isfinite(reach))
    throw Error("periodic ghosts: the reach is " + std::to_string(reach) +
                "; give a finite length >= 0");
}

// Lattice shifts that let the box source, moved, touch the box target.
std::vector<Vec3> list_shifts(const Mat3 &cell, const Eigen::AlignedBox3d &source,
                              const Eigen::AlignedBox3d &target)
{
  const Mat3 inverse = cell.inverse();
  const Vec3 center = inverse * (target.center() - source.center());
  const Vec3 half = 0.5 * inverse.cwiseAbs() * (target.sizes() + source.sizes());
  const double rounding = 1e-9;    // may list a shift too many, never one too few
  const Vec3 low = (center - half).array() - rounding, high = (center + half).array() + rounding;
  std::vector<Vec3> shifts;
  for (double i = std::ceil(low[0]); i <= high[0]; i++)
    for (double j = std::ceil(low[1]); j <= high[1]; j++)
      for (double k = std::ceil(low[2]); k <= high[2]; k++) {
        const Vec3 shift = cell * Vec3(i, j, k);
        const Eigen::AlignedBox3d moved(source.min() + shift, source.max() + shift);
        if (moved.intersects(target)) shifts.push_back(shift);
      }
  return shifts;
}

}    // namespace

PeriodicGhosts::PeriodicGhosts(MPI_Comm comm, PointsView owned, const Mat3 &cell, double reach) :
    comm_(comm), n_owned_(static_cast<int>(owned.cols()))
{
  check_ghosts(cell, reach);
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &n_ranks_);
  std::vector<double> images;
  list_sent(owned, cell, gather_boxes(owned), reach, images);
  list_received();
  const int n_ghosts = receives_.empty() ? 0 : receives_.back().first + receives_.back().n;
  nodes_.resize(3, n_owned_ + n_ghosts);
  nodes_.leftCols(n_owned_) = owned;
  exchange(sends_, images.data(), receives_, nodes_.data() + 3 * static_cast<size_t>(n_owned_), 3);
}

std::vector<PeriodicGhosts::Box> PeriodicGhosts::gather_boxes(PointsView owned) const
{
  Box box;    // empty: min > max
  if (n_owned_ > 0) box = Box(owned.rowwise().minCoeff(), owned.rowwise().maxCoeff());
  // A rank that threw alone would leave the others waiting: it tells them by its box.
  if (!owned.allFinite()) box.min().setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<double> corners(6 * n_ranks_);
  Eigen::Matrix<double, 3, 2> mine;
  mine << box.min(), box.max();
  MPI_Allgather(mine.data(), 6, MPI_DOUBLE, corners.data(), 6, MPI_DOUBLE, comm_);
  std::vector<Box> boxes;
  for (int p = 0; p < n_ranks_; p++) {
    const Eigen::Map<const Vec3> low(&corners[6 * p]), high(&corners[6 * p + 3]);
    if (low.hasNaN())
      throw Error("periodic ghosts: a node of rank " + std::to_string(p) +
                  " has a position that is not finite; the time step is likely too long");
    boxes.emplace_back(low, high);
  }
  return boxes;
}

void PeriodicGhosts::list_sent(PointsView owned, const Mat3 &cell, const std::vector<Box> &boxes,
                               double reach, std::vector<double> &images)
{
  for (int p = 0; p < n_ranks_; p++) {
    if (boxes[rank_].isEmpty() || boxes[p].isEmpty()) continue;
    const Box target(boxes[p].min().array() - reach, boxes[p].max().array() + reach);
    const int first = static_cast<int>(sent_.size());
    for (const Vec3 &shift : list_shifts(cell, boxes[rank_], target)) {
      if (p == rank_ && shift.isZero(0.0)) continue;
      for (int n = 0; n < n_owned_; n++) {
        const Vec3 image = owned.col(n) + shift;
        if (!target.contains(image)) continue;
        images.insert(images.end(), image.data(), image.data() + 3);
        sent_.push_back(n);
      }
    }
    const int n_images = static_cast<int>(sent_.size()) - first;
    if (n_images > 0) sends_.push_back({p, first, n_images});
  }
}

void PeriodicGhosts::list_received()
{
  std::vector<int> n_sent(n_ranks_, 0), n_received(n_ranks_);
  for (const Block &block : sends_)
    n_sent[block.rank] = block.n;
  MPI_Alltoall(n_sent.data(), 1, MPI_INT, n_received.data(), 1, MPI_INT, comm_);
  int first = 0;
  for (int p = 0; p < n_ranks_; p++) {
    if (n_received[p] > 0) receives_.push_back({p, first, n_received[p]});
    first += n_received[p];
  }
}

void PeriodicGhosts::exchange(const std::vector<Block> &out, const double *source,
                              const std::vector<Block> &in, double *destination, int n_columns)
{
  const size_t width = n_columns;
  requests_.clear();
  double *own = nullptr;    // what stays on this rank
  for (const Block &block : in)
    if (block.rank == rank_)
      own = destination + block.first * width;
    else
      MPI_Irecv(destination + block.first * width, block.n * n_columns, MPI_DOUBLE, block.rank,
                kTag, comm_, &requests_.emplace_back());
  for (const Block &block : out)
    if (block.rank == rank_)
      std::copy_n(source + block.first * width, block.n * width, own);
    else
      MPI_Isend(source + block.first * width, block.n * n_columns, MPI_DOUBLE, block.rank, kTag,
                comm_, &requests_.emplace_back());
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
}

void PeriodicGhosts::forward(double *values, int n_columns)
{
  const size_t width = n_columns;
  buffer_.resize(sent_.size() * width);
  for (size_t i = 0; i < sent_.size(); i++)
    std::copy_n(values + sent_[i] * width, width, &buffer_[i * width]);
  exchange(sends_, buffer_.data(), receives_, values + n_owned_ * width, n_columns);
}

void PeriodicGhosts::reverse_add(double *values, int n_columns)
{
  const size_t width = n_columns;
  buffer_.resize(sent_.size() * width);
  exchange(receives_, values + n_owned_ * width, sends_, buffer_.data(), n_columns);
  for (size_t i = 0; i < sent_.size(); i++)
    for (size_t c = 0; c < width; c++)
      values[sent_[i] * width + c] += buffer_[i * width + c];
}

void PeriodicGhosts::sum(double *values, int n)
{
  MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, comm_);
}

std::vector<int> assign_to_ranks(PointsView points, const Mat3 &cell, int n_ranks)
{
  check_ghosts(cell, 0.0);
  if (n_ranks < 1)
    throw Error("assign_to_ranks: the number of ranks is " + std::to_string(n_ranks) +
                "; give at least 1");
  Vec3 area;    // of the faces of the cell
  for (int a = 0; a < 3; a++)
    area[a] = cell.col((a + 1) % 3).cross(cell.col((a + 2) % 3)).norm();
  Vec3 bricks = Vec3::Ones();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= n_ranks; i++)
    for (int j = 1; n_ranks % i == 0 && j <= n_ranks / i; j++) {
      if (n_ranks / i % j != 0) continue;
      const Vec3 candidate(i, j, n_ranks / i / j);
      const double surface = candidate.dot(area);    // of all cuts
      if (surface >= least) continue;
      least = surface;
      bricks = candidate;
    }
  const Mat3 inverse = cell.inverse();
  std::vector<int> ranks(points.cols());
  for (Eigen::Index n = 0; n < points.cols(); n++) {
    const Vec3 s = inverse * points.col(n);
    const Vec3 inside = s.array() - s.array().floor();    // may round to 1
    const Vec3 brick = (inside.array() * bricks.array()).floor().min(bricks.array() - 1.0);
    ranks[n] = static_cast<int>((brick[0] * bricks[1] + brick[1]) * bricks[2] + brick[2]);
  }
  return ranks;
}

}    // namespace biem
