// Slab routing: see the header.
#include "biem_ewald_slab.h"
#include "biem_ewald_transform.h"
#include "biem_ewald_window.h"
#include <algorithm>
#include <cmath>

namespace biem {

std::vector<int> find_plane_owners(MPI_Comm comm, int n_planes)
{
  int n_ranks;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<int> owner(n_planes);
  for (int r = 0; r < n_ranks; r++) {
    const RankRange planes = get_rank_range(n_planes, r, n_ranks);
    std::fill(owner.begin() + planes.begin, owner.begin() + planes.end, r);
  }
  return owner;
}

void SlabRouter::set_points(MPI_Comm comm, const std::vector<int> &owner, PointsView fractional,
                            int order)
{
  comm_ = comm;
  MPI_Comm_size(comm, &n_ranks_);
  const int n_ranks = n_ranks_;
  if (n_ranks == 1) {    // the points stay where they are
    routed_ = fractional;
    return;
  }
  const int n_planes = static_cast<int>(owner.size());
  destinations_.resize(n_ranks);
  for (std::vector<int> &d : destinations_)
    d.clear();
  for (int i = 0; i < fractional.cols(); i++) {
    const int first = static_cast<int>(find_first_point(fractional(0, i) * n_planes, order));
    const int low = (first + n_planes) % n_planes, high = (first + order - 1) % n_planes;
    if (owner[low] == owner[high] && low <= high) {
      destinations_[owner[low]].push_back(i);
      continue;
    }
    std::array<int, kMaxWindowOrder> seen{};
    int n_seen = 0;
    for (int j = 0; j < order; j++) {
      const int rank = owner[((first + j) % n_planes + n_planes) % n_planes];
      if (std::find(seen.begin(), seen.begin() + n_seen, rank) != seen.begin() + n_seen) continue;
      seen[n_seen++] = rank;
      destinations_[rank].push_back(i);
    }
  }
  send_index_.clear();
  send_counts_.assign(n_ranks, 0);
  send_offsets_.assign(n_ranks, 0);
  receive_counts_.assign(n_ranks, 0);
  receive_offsets_.assign(n_ranks, 0);
  for (int r = 0; r < n_ranks; r++) {
    send_offsets_[r] = 3 * static_cast<int>(send_index_.size());
    send_counts_[r] = 3 * static_cast<int>(destinations_[r].size());
    send_index_.insert(send_index_.end(), destinations_[r].begin(), destinations_[r].end());
  }
  MPI_Alltoall(send_counts_.data(), 1, MPI_INT, receive_counts_.data(), 1, MPI_INT, comm);
  int total = 0;
  for (int r = 0; r < n_ranks; r++) {
    receive_offsets_[r] = total;
    total += receive_counts_[r];
  }
  routed_.resize(3, total / 3);
  send(fractional, routed_);
}

PointsView SlabRouter::send(PointsView values, Points &buffer)
{
  if (n_ranks_ == 1) return values;
  out_.resize(3, send_index_.size());
  for (size_t i = 0; i < send_index_.size(); i++)
    out_.col(i) = values.col(send_index_[i]);
  buffer.resize(3, routed_.cols());
  MPI_Alltoallv(out_.data(), send_counts_.data(), send_offsets_.data(), MPI_DOUBLE, buffer.data(),
                receive_counts_.data(), receive_offsets_.data(), MPI_DOUBLE, comm_);
  return buffer;
}

void SlabRouter::return_add(const Points &routed, PointsRef values)
{
  out_.resize(3, send_index_.size());
  MPI_Alltoallv(routed.data(), receive_counts_.data(), receive_offsets_.data(), MPI_DOUBLE,
                out_.data(), send_counts_.data(), send_offsets_.data(), MPI_DOUBLE, comm_);
  for (size_t i = 0; i < send_index_.size(); i++)
    values.col(send_index_[i]) += out_.col(i);
}

}    // namespace biem
