// Arguments of create_wall -> settings. Parses and refuses; keeps no state, creates nothing.
#ifndef BIEM_LAMMPS_WALL_SETTINGS_H
#define BIEM_LAMMPS_WALL_SETTINGS_H

#include "biem_lammps_command_arguments.h"
#include "biem_mesh_wall.h"
#include <string>

namespace LAMMPS_NS {

class LAMMPS;

struct WallSettings {
  enum class Shape { Plane, Duct, Tube, Mesh };

  Shape shape = Shape::Plane;
  biem::Axis axis = biem::Axis::X;    // normal of the plane; along the duct or tube
  double first = 0.0;                 // coordinate of the plane; across the axis, cyclic order
  double second = 0.0;                // duct, tube
  double radius = 0.0;                // tube
  double edge = 0.0;                  // largest lattice spacing, length; not mesh
  std::string file;                   // mesh
  double scale = 1.0;
  biem::Vec3 shift = biem::Vec3::Zero();
  SurfaceLabels labels;
};

// Stops through error->all() with what is wrong and what is allowed.
WallSettings parse_create_wall(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS

#endif
