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

// Ewald parameters as numbers for a restart file, and back.
constexpr int kEwaldStateSize = 14;
std::vector<double> to_state(const biem::EwaldParameters &parameters);
biem::EwaldParameters to_ewald_parameters(const double *state);

// This rank's share of the surfaces, kept between reneighborings.
class LammpsScene : protected Pointers {
 public:
  // list_cutoff: of the full neighbor list, without skin.
  LammpsScene(LAMMPS *lmp, const NodeGroups &groups, double list_cutoff) :
      Pointers(lmp), groups_(groups), list_cutoff_(list_cutoff)
  {
  }

  // After every reneighboring: triangles, cell indices, near candidates.
  void refresh(NeighList *list);
  // Before every evaluation: shifts of the triangles to their cell's image.
  biem::Configuration get_configuration();

 private:
  void add_candidates(const biem::Triangle &triangle, NeighList *list);

  NodeGroups groups_;
  double list_cutoff_;
  std::vector<biem::Triangle> triangles_;
  std::vector<int> cell_of_triangle_, cell_of_node_;
  biem::Points triangle_shift_;
  biem::NearCandidates candidates_;
};

// Runs function(); a core error becomes a LAMMPS error that starts with who.
template <class Function>
auto guarded(LAMMPS *lmp, const std::string &who, Function function) -> decltype(function())
{
  try {
    return function();
  } catch (const biem::Error &e) {
    lmp->error->one(FLERR, who + ": " + e.what());
  }
  throw biem::Error("unreachable: LAMMPS' error handler returned");
}

}    // namespace LAMMPS_NS

#endif
