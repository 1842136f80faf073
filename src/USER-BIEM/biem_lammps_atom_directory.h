// Records of atoms that every rank can look up: each atom has a home rank (tag modulo ranks). Works
// without ghost atoms and without gathering. Knows atoms and angles, not what they are for.
#ifndef BIEM_LAMMPS_ATOM_DIRECTORY_H
#define BIEM_LAMMPS_ATOM_DIRECTORY_H

#include "lmptype.h"
#include <climits>
#include <cstdint>
#include <mpi.h>
#include <unordered_map>
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

// What the home rank of an atom knows.
struct AtomRecord {
  int64_t tag, molecule;
  int mask, is_vertex;    // is_vertex: of a triangle that look_up_corners() has asked for
  double x[3];            // unwrapped
};

constexpr int64_t kNoTag = INT64_MAX;    // in minima over tags

// outgoing[rank] -> what the other ranks sent here, grouped by sender; counts per sender.
template <class T>
std::vector<T> exchange_records(MPI_Comm world, const std::vector<std::vector<T>> &outgoing,
                                std::vector<int> &counts)
{
  const int n_ranks = static_cast<int>(outgoing.size());
  std::vector<int> send_bytes(n_ranks), send_offset(n_ranks, 0), bytes(n_ranks), offset(n_ranks, 0);
  std::vector<T> sent;
  for (int r = 0; r < n_ranks; r++) {
    send_bytes[r] = static_cast<int>(outgoing[r].size() * sizeof(T));
    sent.insert(sent.end(), outgoing[r].begin(), outgoing[r].end());
  }
  MPI_Alltoall(send_bytes.data(), 1, MPI_INT, bytes.data(), 1, MPI_INT, world);
  for (int r = 1; r < n_ranks; r++) {
    send_offset[r] = send_offset[r - 1] + send_bytes[r - 1];
    offset[r] = offset[r - 1] + bytes[r - 1];
  }
  std::vector<T> received((offset.back() + bytes.back()) / sizeof(T));
  MPI_Alltoallv(sent.data(), send_bytes.data(), send_offset.data(), MPI_BYTE, received.data(),
                bytes.data(), offset.data(), MPI_BYTE, world);
  counts.resize(n_ranks);
  for (int r = 0; r < n_ranks; r++)
    counts[r] = bytes[r] / static_cast<int>(sizeof(T));
  return received;
}

class AtomDirectory {
 public:
  explicit AtomDirectory(LAMMPS *lmp);    // collective, as are the functions below

  int home(int64_t tag) const { return static_cast<int>(tag % n_ranks_); }
  // Of the atoms whose home is this rank, by tag.
  const std::unordered_map<int64_t, AtomRecord> &records() const { return records_; }
  // Three records for each angle stored on this rank, in the angle's order. missing: the smallest
  // tag that an angle names but no atom has, of those asked of this rank; or kNoTag.
  std::vector<AtomRecord> look_up_corners(int64_t &missing);

 private:
  LAMMPS *lmp_;
  int n_ranks_;
  std::unordered_map<int64_t, AtomRecord> records_;
};

}    // namespace LAMMPS_NS

#endif
