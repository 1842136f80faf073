// Atoms by home rank: see the header.
#include "biem_lammps_atom_directory.h"
#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "lammps.h"
#include <algorithm>

namespace LAMMPS_NS {

AtomDirectory::AtomDirectory(LAMMPS *lmp) : lmp_(lmp), n_ranks_(lmp->comm->nprocs)
{
  const Atom *atom = lmp->atom;
  std::vector<std::vector<AtomRecord>> outgoing(n_ranks_);
  for (int i = 0; i < atom->nlocal; i++) {
    AtomRecord record{atom->tag[i], atom->molecule[i], atom->mask[i], 0, {0.0, 0.0, 0.0}};
    lmp->domain->unmap(atom->x[i], atom->image[i], record.x);
    outgoing[home(record.tag)].push_back(record);
  }
  std::vector<int> counts;
  for (const AtomRecord &record : exchange_records(lmp->world, outgoing, counts))
    records_[record.tag] = record;
}

std::vector<AtomRecord> AtomDirectory::look_up_corners(int64_t &missing)
{
  const Atom *atom = lmp_->atom;
  std::vector<std::vector<int64_t>> queries(n_ranks_);
  std::vector<int64_t> tags;
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; a < atom->num_angle[i]; a++)
      for (int64_t tag : {static_cast<int64_t>(atom->angle_atom1[i][a]),
                          static_cast<int64_t>(atom->angle_atom2[i][a]),
                          static_cast<int64_t>(atom->angle_atom3[i][a])}) {
        tags.push_back(tag);
        queries[home(tag)].push_back(tag);
      }
  std::vector<int> counts;
  const std::vector<int64_t> asked = exchange_records(lmp_->world, queries, counts);
  std::vector<std::vector<AtomRecord>> answers(n_ranks_);
  missing = kNoTag;
  size_t next = 0;
  for (int r = 0; r < n_ranks_; r++)
    for (int k = 0; k < counts[r]; k++, next++) {
      auto found = records_.find(asked[next]);
      if (found == records_.end()) {
        missing = std::min(missing, asked[next]);
        answers[r].push_back(AtomRecord{asked[next], 0, 0, 0, {0.0, 0.0, 0.0}});
      } else {
        found->second.is_vertex = 1;
        answers[r].push_back(found->second);
      }
    }
  const std::vector<AtomRecord> answered = exchange_records(lmp_->world, answers, counts);
  std::vector<size_t> position(n_ranks_, 0);
  for (int r = 1; r < n_ranks_; r++)
    position[r] = position[r - 1] + counts[r - 1];
  std::vector<AtomRecord> corners;
  for (int64_t tag : tags)
    corners.push_back(answered[position[home(tag)]++]);
  return corners;
}

}    // namespace LAMMPS_NS
