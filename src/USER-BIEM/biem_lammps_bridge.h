// Between LAMMPS' atoms and the core's arrays: communication, the box, the triangles of this rank
// and their near candidates. The only file besides biem_lammps_compat.h that knows both sides'
// data.
#ifndef BIEM_LAMMPS_BRIDGE_H
#define BIEM_LAMMPS_BRIDGE_H

#include "biem_error.h"
#include "biem_lammps_topology.h"
#include "biem_node_exchange.h"
#include "biem_suspension.h"
#include "error.h"
#include "lammps.h"
#include "pointers.h"
#include <functional>
#include <string>

namespace LAMMPS_NS {

class Fix;
class NeighList;

// NodeExchange on LAMMPS' forward and reverse communication of one fix, whose pack and unpack
// functions hand over to the four below.
class LammpsExchange : public biem::NodeExchange, protected Pointers {
 public:
  LammpsExchange(LAMMPS *lmp, Fix *fix) : Pointers(lmp), fix_(fix) {}
  ~LammpsExchange() noexcept override {}    // newer ~Pointers() may throw, ~NodeExchange() may not

  void forward(double *values, int n_columns) override;
  void reverse_add(double *values, int n_columns) override;
  void sum(double *values, int n) override;

  int pack_forward(int n, const int *list, double *buffer) const;
  void unpack_forward(int n, int first, const double *buffer);
  int pack_reverse(int n, int first, double *buffer) const;
  void unpack_reverse(int n, const int *list, const double *buffer);

 private:
  Fix *fix_;
  double *values_ = nullptr;
  int n_columns_ = 0;
};

// Lattice vectors in columns, corner of the box.
biem::Mat3 get_cell(LAMMPS *lmp);
biem::Vec3 get_origin(LAMMPS *lmp);

// Number of an atom within its rigid shape or within all walls; -1 for all others.
using NodeIndex = std::function<int(tagint)>;

// This rank's share of the surfaces, kept between reneighborings.
class LammpsConfiguration : protected Pointers {
 public:
  // list_cutoff: of the full neighbor list, without skin. version: of the last configuration.
  LammpsConfiguration(LAMMPS *lmp, const NodeGroups &groups, NodeIndex index, double list_cutoff,
                      long version) :
      Pointers(lmp),
      groups_(groups), index_(std::move(index)), list_cutoff_(list_cutoff), version_(version)
  {
  }

  // After every reneighboring: triangles, numbers of surfaces, near candidates.
  void refresh(NeighList *list);
  // Of the last refresh(): the largest reach that a triangle needs and the list does not have, 0 if
  // there is none.
  double lost_reach() const { return lost_reach_; }
  int lost_molecule() const { return lost_molecule_; }
  // Before every evaluation: unwrapped positions. orientations: by surface.
  biem::Configuration get(std::vector<biem::Mat3> orientations);
  int find_surface(int node) const { return surface_of_node_[node]; }    // of an owned node
  long version() const { return version_; }

 private:
  void add_candidates(const biem::Triangle &triangle, NeighList *list);

  NodeGroups groups_;
  NodeIndex index_;
  double list_cutoff_;
  long version_;
  double lost_reach_ = 0.0;
  int lost_molecule_ = 0;
  std::vector<biem::Triangle> triangles_;
  std::vector<int> surface_of_triangle_, surface_of_node_, index_of_node_;
  biem::Points triangle_shift_, unwrapped_;
  biem::NearCandidates candidates_;
  std::vector<biem::Mat3> orientations_;
};

// Runs function(); a core error becomes a LAMMPS error that starts with who.
template <class Function>
auto guarded(LAMMPS *lmp, const std::string &who, Function function) -> decltype(function())
{
  try {
    return function();
  } catch (const biem::NotConverged &) {
    throw;    // on all ranks alike: the caller can go back to the last step
  } catch (const biem::Error &e) {
    lmp->error->one(FLERR, who + ": " + e.what());
  }
  throw biem::Error("unreachable: LAMMPS' error handler returned");
}

}    // namespace LAMMPS_NS

#endif
