// Finds where nodes come near other surfaces, on atoms and triangles as LAMMPS distributes them: a
// triangle is known on one rank only, and the node there may be a ghost. Each rank looks among its
// own triangles, the finds go to the owners of the nodes, and the nearest ones come back. Knows no
// forces.
#ifndef BIEM_LAMMPS_CONTACTS_H
#define BIEM_LAMMPS_CONTACTS_H

#include "biem_contact_slots.h"
#include "biem_lammps_contact_surfaces.h"
#include "pointers.h"
#include <vector>

namespace LAMMPS_NS {

class NeighList;
class Pair;

// A node and a point of another surface, on the rank that has the triangle.
struct NodeContact {
  int node;                // local index, may be a ghost
  const int *triangle;     // three local indices, may be ghosts
  biem::Vec3 weights;      // of the corners
  biem::Vec3 direction;    // along which the distance grows, unit vector
  double distance;         // signed, length
};

class LammpsContacts : protected Pointers {
 public:
  // range: larger distances are no contacts, length; communication is through the pair style.
  LammpsContacts(LAMMPS *lmp, Pair *pair, double range) :
      Pointers(lmp), surfaces(lmp), pair_(pair), range_(range)
  {
  }

  ContactSurfaces surfaces;

  // After each build of the neighbor list, which must be full. stiffness: by atom types of node and
  // triangle; pairs of types without one are left out.
  void sort_neighbors(const NeighList *list, double *const *stiffness);

  // Of each node and each other surface within range the nearest point, if its triangle is on this
  // rank. The same on any number of ranks, but for rounding. Collective.
  const std::vector<NodeContact> &find_contacts();
  // Whether any rank has found one.
  bool has_any() const { return has_any_; }

  // Most values for an atom in one message.
  static constexpr int kMessageSize = 3 + 12 * biem::ContactSlots::kCapacity;
  int pack_forward(int n, const int *list, double *buffer) const;
  void unpack_forward(int n, int first, const double *buffer);
  int pack_reverse(int n, int first, double *buffer) const;
  void unpack_reverse(int n, const int *list, const double *buffer);

 private:
  struct Find {
    int node;
    const int *triangle;
    biem::Vec3 weights;
    biem::Contact contact;
  };

  void refuse_long_edge(const int *triangle, double length);
  void find_of_triangle(const int *triangle, const int *first, const int *last);
  void merge(int atom_index, const biem::Contact &contact);
  void decide_sides_at_walls();
  biem::Points compute_centers();
  bool is_behind_wall(const biem::Contact &contact, const biem::Vec3 &normal,
                      const biem::Vec3 &arm) const;
  void keep_winners();

  enum class Message { Contacts, Normals };

  Pair *pair_;
  double range_;
  bool has_any_ = false;
  // Nodes that may touch the triangles of a local atom: those from begin_[i] to begin_[i + 1].
  std::vector<int> begin_, nodes_;
  std::vector<Find> finds_;
  std::vector<int> slot_of_atom_;    // local and ghost; -1: no contact
  std::vector<biem::ContactSlots> slots_;
  std::vector<double> normals_;      // local and ghost, 3 values each, length^2
  Message message_ = Message::Contacts;
  std::vector<NodeContact> contacts_;
};

}    // namespace LAMMPS_NS

#endif
