// What pair_style biem/contact knows of the surfaces before a run: which are closed bodies and
// which walls, how long their edges may become, the area of each node. Knows no contacts.
#ifndef BIEM_LAMMPS_CONTACT_SURFACES_H
#define BIEM_LAMMPS_CONTACT_SURFACES_H

#include "lmptype.h"
#include "pointers.h"
#include <vector>

namespace LAMMPS_NS {

struct AtomRecord;

class ContactSurfaces : protected Pointers {
 public:
  explicit ContactSurfaces(LAMMPS *lmp) : Pointers(lmp) {}

  // Before a run; needs no ghost atoms. Surfaces in the group with the bit are walls whatever their
  // shape (0: no such group). Collective.
  void survey(int wall_bit);
  // With the first forces of a run; needs ghost atoms and LAMMPS' list of angles. Collective.
  void measure_areas();

  // A closed body: its nodes act. Walls, which have two sides, are acted upon only.
  bool is_body(tagint molecule) const { return kind(molecule) == Kind::Body; }
  bool is_wall(tagint molecule) const { return kind(molecule) == Kind::Wall; }
  bool has_walls() const { return has_walls_; }
  tagint n_molecules() const { return static_cast<tagint>(kinds_.size()) - 1; }
  // The length that edges of triangles with a middle atom of this type may reach in a run.
  double edge_limit(int type) const { return edge_limits_[type]; }
  // One third of the reference areas of the triangles around a node; without a reference shape, of
  // their areas in the first run.
  double area(tagint node) const { return areas_[node]; }

 private:
  enum class Kind : char { None, Body, Wall };
  Kind kind(tagint molecule) const
  {
    return molecule < 1 || molecule > n_molecules() ? Kind::None : kinds_[molecule];
  }
  void classify(const std::vector<AtomRecord> &corners, int wall_bit);
  void measure_edges(const std::vector<AtomRecord> &corners);

  std::vector<Kind> kinds_;            // by molecule id
  std::vector<double> edge_limits_;    // by atom type, length
  std::vector<double> areas_;          // by atom id
  bool has_walls_ = false;
};

}    // namespace LAMMPS_NS

#endif
