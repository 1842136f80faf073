// create_wall: command that puts fixed surfaces into the box (see doc/create_wall.md).
// Knows parsing, checking and reporting; meshes are the core's.
#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(create_wall,CreateWall);
// clang-format on
#else

#ifndef LMP_CREATE_WALL_H
#define LMP_CREATE_WALL_H

#include "command.h"

namespace LAMMPS_NS {

class CreateWall : public Command {
 public:
  CreateWall(class LAMMPS *lmp) : Command(lmp) {}
  void command(int narg, char **arg) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
