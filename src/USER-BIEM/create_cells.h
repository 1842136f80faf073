// create_cells: command that fills the box with closed surface meshes (see doc/create_cells.md).
// Knows parsing, checking and reporting; meshes and packing are the core's.
#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(create_cells,CreateCells);
// clang-format on
#else

#ifndef LMP_CREATE_CELLS_H
#define LMP_CREATE_CELLS_H

#include "command.h"

namespace LAMMPS_NS {

class CreateCells : public Command {
 public:
  CreateCells(class LAMMPS *lmp) : Command(lmp) {}
  void command(int narg, char **arg) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
