// The styles of the package, one line each: kind, name in the input script, base class, class.
// Used by the program (biem_main.cpp) and by the plugin (biemplugin.cpp).
// A LAMMPS that is built with the package finds the styles in their headers, without this list.
#ifndef BIEM_LAMMPS_STYLES_H
#define BIEM_LAMMPS_STYLES_H

#include "angle_biem_skalak.h"
#include "compute_biem_cell.h"
#include "create_cells.h"
#include "create_wall.h"
#include "dihedral_biem_bend.h"
#include "fix_biem.h"
#include "pair_biem_contact.h"

#define BIEM_STYLES(STYLE)                                 \
  STYLE(angle, "biem/skalak", Angle, AngleBiemSkalak)      \
  STYLE(dihedral, "biem/bend", Dihedral, DihedralBiemBend) \
  STYLE(pair, "biem/contact", Pair, PairBiemContact)       \
  STYLE(compute, "biem/cell", Compute, ComputeBiemCell)    \
  STYLE(fix, "biem", Fix, FixBiem)                         \
  STYLE(command, "create_cells", Command, CreateCells)     \
  STYLE(command, "create_wall", Command, CreateWall)

namespace LAMMPS_NS {

class LAMMPS;

// Creator functions in the two forms that LAMMPS' maps and its plugin interface take.
template <class Base, class Style> Base *create_style(LAMMPS *lmp)
{
  return new Style(lmp);
}

template <class Base, class Style>
Base *create_style_with_arguments(LAMMPS *lmp, int narg, char **arg)
{
  return new Style(lmp, narg, arg);
}

}    // namespace LAMMPS_NS

#endif
