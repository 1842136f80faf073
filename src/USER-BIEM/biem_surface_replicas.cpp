// Replicas of shared surfaces: see the header.
#include "biem_surface_replicas.h"
#include <algorithm>
#include <numeric>

namespace biem {

namespace {

// Alltoallv of records of n_columns numbers each; counts in records.
template <class T>
std::vector<T> exchange(MPI_Comm comm, MPI_Datatype type, const std::vector<T> &out,
                        std::vector<int> send_counts, std::vector<int> receive_counts,
                        int n_columns)
{
  const size_t n_ranks = send_counts.size();
  std::vector<int> send_starts(n_ranks, 0), receive_starts(n_ranks, 0);
  for (size_t r = 0; r < n_ranks; r++) {
    send_counts[r] *= n_columns;
    receive_counts[r] *= n_columns;
  }
  std::partial_sum(send_counts.begin(), send_counts.end() - 1, send_starts.begin() + 1);
  std::partial_sum(receive_counts.begin(), receive_counts.end() - 1, receive_starts.begin() + 1);
  std::vector<T> in(receive_starts.back() + receive_counts.back());
  MPI_Alltoallv(out.data(), send_counts.data(), send_starts.data(), type, in.data(),
                receive_counts.data(), receive_starts.data(), type, comm);
  return in;
}

}    // namespace

// For each surface of this rank, in the order of sizes_: the other ranks that have a part of it.
std::vector<std::vector<int>> SurfaceReplicas::find_sharing_ranks() const
{
  std::vector<int> mine;
  for (const auto &entry : sizes_)
    mine.push_back(entry.first);
  int n_ranks, rank, n_mine = static_cast<int>(mine.size());
  MPI_Comm_size(comm_, &n_ranks);
  MPI_Comm_rank(comm_, &rank);
  std::vector<int> counts(n_ranks), starts(n_ranks, 0);
  MPI_Allgather(&n_mine, 1, MPI_INT, counts.data(), 1, MPI_INT, comm_);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<int> all(starts.back() + counts.back());
  MPI_Allgatherv(mine.data(), n_mine, MPI_INT, all.data(), counts.data(), starts.data(), MPI_INT,
                 comm_);
  std::vector<std::vector<int>> ranks(mine.size());
  for (int r = 0; r < n_ranks; r++)
    for (int k = starts[r]; r != rank && k < starts[r] + counts[r]; k++) {
      const auto found = std::lower_bound(mine.begin(), mine.end(), all[k]);
      if (found != mine.end() && *found == all[k]) ranks[found - mine.begin()].push_back(r);
    }
  return ranks;
}

void SurfaceReplicas::set_nodes(const std::vector<int> &surface_of_node,
                                const std::vector<int> &index_of_node)
{
  nodes_.clear();
  places_.clear();
  sizes_.clear();
  for (size_t i = 0; i < surface_of_node.size(); i++) {
    if (surface_of_node[i] < 0) continue;
    nodes_.push_back(static_cast<int>(i));
    places_.push_back({surface_of_node[i], index_of_node[i]});
    int &size = sizes_[surface_of_node[i]];
    size = std::max(size, index_of_node[i] + 1);
  }
  const std::vector<std::vector<int>> sharing = find_sharing_ranks();
  int n_ranks;
  MPI_Comm_size(comm_, &n_ranks);
  std::vector<std::vector<int>> outgoing(n_ranks);
  for (size_t k = 0; k < nodes_.size(); k++) {
    const auto s = std::distance(sizes_.begin(), sizes_.find(places_[k].surface));
    for (int r : sharing[s])
      outgoing[r].push_back(static_cast<int>(k));
  }
  sent_.clear();
  send_counts_.clear();
  std::vector<int> out;
  for (const std::vector<int> &list : outgoing) {
    send_counts_.push_back(static_cast<int>(list.size()));
    sent_.insert(sent_.end(), list.begin(), list.end());
  }
  for (int k : sent_)
    out.insert(out.end(), {places_[k].surface, places_[k].index});
  receive_counts_.resize(n_ranks);
  MPI_Alltoall(send_counts_.data(), 1, MPI_INT, receive_counts_.data(), 1, MPI_INT, comm_);
  const std::vector<int> in = exchange(comm_, MPI_INT, out, send_counts_, receive_counts_, 2);
  received_.clear();
  for (size_t k = 0; k < in.size(); k += 2) {
    received_.push_back({in[k], in[k + 1]});
    int &size = sizes_[in[k]];
    size = std::max(size, in[k + 1] + 1);
  }
}

std::map<int, Points> SurfaceReplicas::gather(PointsView values) const
{
  std::map<int, Points> surfaces;
  for (const auto &entry : sizes_)
    surfaces[entry.first] = Points::Zero(3, entry.second);
  for (size_t k = 0; k < nodes_.size(); k++)
    surfaces[places_[k].surface].col(places_[k].index) = values.col(nodes_[k]);
  std::vector<double> out;
  out.reserve(3 * sent_.size());
  for (int k : sent_)
    for (int a = 0; a < 3; a++)
      out.push_back(values(a, nodes_[k]));
  const std::vector<double> in = exchange(comm_, MPI_DOUBLE, out, send_counts_, receive_counts_, 3);
  for (size_t k = 0; k < received_.size(); k++)
    surfaces[received_[k].surface].col(received_[k].index) = Vec3(&in[3 * k]);
  return surfaces;
}

}    // namespace biem
