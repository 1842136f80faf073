// Arguments of create_cells -> settings. Parses and refuses; keeps no state, creates nothing.
#ifndef BIEM_LAMMPS_CELL_SETTINGS_H
#define BIEM_LAMMPS_CELL_SETTINGS_H

#include "biem_mesh_shape.h"
#include "lmptype.h"
#include <cstdint>
#include <memory>
#include <string>

namespace LAMMPS_NS {

class LAMMPS;

struct CellSettings {
  enum class Placement { None, Single, Random, Hematocrit };
  enum class Orientation { Default, Random, Axis };

  std::unique_ptr<biem::Shape> shape;
  int n_nodes = 0;
  Placement placement = Placement::None;
  biem::Vec3 center = biem::Vec3::Zero();    // single
  int n_cells = 1;                           // random; single: 1
  double hematocrit = 0.0;
  std::uint64_t seed = 0;
  Orientation orientation = Orientation::Default;
  biem::Vec3 axis = biem::Vec3::UnitZ();
  double roll = 0.0;              // rad, about the axis
  double gap = -1.0;              // length; negative: not given
  int type = 1, angle_type = 1, dihedral_type = 1;
  tagint first_molecule = 0;      // 0: the next free one
  std::string group;              // empty: none besides all
};

// Stops through error->all() with what is wrong and what is allowed.
CellSettings parse_create_cells(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS

#endif
