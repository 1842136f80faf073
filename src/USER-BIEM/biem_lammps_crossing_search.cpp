// Distributed search for crossing surfaces: see the header.
#include "biem_lammps_crossing_search.h"
#include "biem_lammps_atom_directory.h"
#include <map>

namespace LAMMPS_NS {

namespace {

struct BinEntry {
  int64_t bin;
  uint64_t occupant;
};

class CrossingSearch {
 public:
  CrossingSearch(MPI_Comm world, const std::vector<biem::SurfaceTriangle> &triangles) :
      world_(world), triangles_(triangles)
  {
    MPI_Comm_size(world, &n_ranks_);
  }

  // Those that are in one bin with another surface, once for each such bin; of the bins of this
  // rank.
  std::vector<biem::SurfaceTriangle> collect(const biem::CrossingBins &bins)
  {
    std::vector<BinEntry> entries;
    std::vector<int> n_entries;    // by triangle
    entries.reserve(4 * triangles_.size());
    n_entries.reserve(triangles_.size());
    for (const biem::SurfaceTriangle &t : triangles_) {
      const size_t before = entries.size();
      bins.for_each_bin(t, [&](int64_t bin, uint64_t occupant) {
        entries.push_back({bin, occupant});
      });
      n_entries.push_back(static_cast<int>(entries.size() - before));
    }
    biem::BinOccupants occupants;
    for (const BinEntry &entry : entries)
      occupants.add(entry.bin, entry.occupant);
    if (n_ranks_ > 1) share(occupants);
    std::vector<std::vector<biem::SurfaceTriangle>> outgoing(n_ranks_);
    size_t next = 0;
    for (size_t t = 0; t < triangles_.size(); t++)
      for (int k = 0; k < n_entries[t]; k++) {
        const BinEntry &entry = entries[next++];
        if (occupants.find(entry.bin) != biem::kSeveral) continue;
        std::vector<biem::SurfaceTriangle> &list = outgoing[home(entry.bin)];
        list.push_back(triangles_[t]);
        list.back().bin = entry.bin;
        list.back().occupant = entry.occupant;
      }
    std::vector<int> counts;
    return exchange_records(world_, outgoing, counts);
  }

  // The same lists of pairs on all ranks.
  std::vector<biem::Crossing> merge(const std::vector<biem::Crossing> &mine) const
  {
    int n = static_cast<int>(mine.size()), n_all;
    MPI_Allreduce(&n, &n_all, 1, MPI_INT, MPI_SUM, world_);
    if (n_all == 0) return {};
    std::vector<int> counts;
    const std::vector<std::vector<biem::Crossing>> outgoing(n_ranks_, mine);
    std::map<std::pair<int, int>, biem::Crossing> pairs;
    for (const biem::Crossing &c : exchange_records(world_, outgoing, counts))
      pairs.insert({{c.first, c.second}, c});
    std::vector<biem::Crossing> result;
    for (const auto &entry : pairs)
      result.push_back(entry.second);
    return result;
  }

 private:
  int home(int64_t bin) const { return static_cast<int>(bin % n_ranks_); }

  // Marks the bins that another rank has another surface in.
  void share(biem::BinOccupants &occupants) const
  {
    std::vector<std::vector<BinEntry>> asked(n_ranks_);
    occupants.for_each([&](int64_t bin, uint64_t occupant) {
      asked[home(bin)].push_back({bin, occupant});
    });
    std::vector<int> counts;
    std::vector<BinEntry> entries = exchange_records(world_, asked, counts);
    biem::BinOccupants all;
    for (const BinEntry &entry : entries)
      all.add(entry.bin, entry.occupant);
    std::vector<std::vector<BinEntry>> answers(n_ranks_);
    size_t next = 0;
    for (int r = 0; r < n_ranks_; r++)
      for (int k = 0; k < counts[r]; k++, next++)
        if (all.find(entries[next].bin) == biem::kSeveral)
          answers[r].push_back({entries[next].bin, biem::kSeveral});
    for (const BinEntry &entry : exchange_records(world_, answers, counts))
      occupants.add(entry.bin, entry.occupant);
  }

  MPI_Comm world_;
  int n_ranks_;
  const std::vector<biem::SurfaceTriangle> &triangles_;
};

}    // namespace

std::vector<biem::Crossing> find_all_crossings(MPI_Comm world, const biem::MeshLattice &lattice,
                                               double width,
                                               const std::vector<biem::SurfaceTriangle> &triangles)
{
  CrossingSearch search(world, triangles);
  const std::vector<biem::SurfaceTriangle> shared =
      search.collect(biem::CrossingBins(lattice, width));
  return search.merge(biem::find_crossings(lattice, shared));
}

}    // namespace LAMMPS_NS
