// Arguments of create_cells -> settings. Parses and refuses; keeps no state, creates nothing.
#ifndef BIEM_LAMMPS_CELL_SETTINGS_H
#define BIEM_LAMMPS_CELL_SETTINGS_H

#include "biem_lammps_command_arguments.h"
#include "biem_mesh_shape.h"
#include <cstdint>
#include <memory>
#include <string>

namespace LAMMPS_NS {

class LAMMPS;

struct CellSettings {
  enum class Placement { None, Single, Random, Hematocrit };
  enum class Orientation { Default, Random, Axis };

  std::unique_ptr<biem::Shape> shape;    // none: a mesh from a file
  std::string mesh_file;
  double mesh_scale = 1.0;     // of the lengths in the file
  double mesh_radius = 0.0;    // of the sphere of equal volume; 0: not given
  int n_nodes = 0;
  Placement placement = Placement::None;
  biem::Vec3 center = biem::Vec3::Zero();    // single
  int n_cells = 1;                           // random; single: 1
  double hematocrit = 0.0;
  std::uint64_t seed = 0;
  Orientation orientation = Orientation::Default;
  biem::Vec3 axis = biem::Vec3::UnitZ();
  double roll = 0.0;    // rad, about the axis
  double gap = -1.0;    // length; negative: not given
  SurfaceLabels labels;
  int dihedral_type = 1;
};

// Stops through error->all() with what is wrong and what is allowed.
CellSettings parse_create_cells(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS

#endif
