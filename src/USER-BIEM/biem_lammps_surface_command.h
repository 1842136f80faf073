// What the commands that create surfaces share: checks of the system, molecule IDs, and work that
// rank 0 does for all. Knows no shapes and does not store atoms.
#ifndef BIEM_LAMMPS_SURFACE_COMMAND_H
#define BIEM_LAMMPS_SURFACE_COMMAND_H

#include "biem_mesh_icosphere.h"
#include "lmptype.h"
#include "pointers.h"
#include <functional>
#include <string>

namespace LAMMPS_NS {

class SurfaceCommand : protected Pointers {
 public:
  // name: of the command, with which messages begin
  SurfaceCommand(LAMMPS *lmp, const std::string &name) : Pointers(lmp), name_(name) {}

  [[noreturn]] void fail(const std::string &what);

  // A periodic box, an atom style with molecules, angles and dihedrals, a map, newton on.
  void check_system();
  // Error unless 1 <= type <= the number there is; dihedral_type 0: none is needed.
  void check_types(int type, int angle_type, int dihedral_type);
  // LAMMPS finds the image of a neighbor node by the shortest distance.
  void check_edges(double longest_edge);
  // wanted = 0: the next free one. Error if one of the n_surfaces IDs is taken. Collective.
  tagint compute_first_molecule(tagint wanted, int n_surfaces);

  // Rank 0 runs the function; its core error stops all ranks. Collective.
  void run_on_first(const std::function<void()> &function);
  // Reads the file on rank 0, for all. Collective.
  biem::SurfaceMesh read_mesh(const std::string &path);

 private:
  std::string name_;
};

}    // namespace LAMMPS_NS

#endif
