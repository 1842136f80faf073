// The styles of the package, one line each: kind, name in the input script, base class, class.
// Used by the program (biem_main.cpp) and by the plugin (biemplugin.cpp).
// A LAMMPS that is built with the package finds the styles in their headers, without this list.
#ifndef BIEM_LAMMPS_STYLES_H
#define BIEM_LAMMPS_STYLES_H

#if __has_include("angle_biem_skalak.h")
#include "angle_biem_skalak.h"
#define BIEM_T1(S) S(angle, "biem/skalak", Angle, AngleBiemSkalak)
#else
#define BIEM_T1(S)
#endif
#if __has_include("dihedral_biem_bend.h")
#include "dihedral_biem_bend.h"
#define BIEM_T2(S) S(dihedral, "biem/bend", Dihedral, DihedralBiemBend)
#else
#define BIEM_T2(S)
#endif
#if __has_include("compute_biem_cell.h")
#include "compute_biem_cell.h"
#define BIEM_T3(S) S(compute, "biem/cell", Compute, ComputeBiemCell)
#else
#define BIEM_T3(S)
#endif
#if __has_include("fix_biem.h")
#include "fix_biem.h"
#define BIEM_T4(S) S(fix, "biem", Fix, FixBiem)
#else
#define BIEM_T4(S)
#endif
#if __has_include("create_cells.h")
#include "create_cells.h"
#define BIEM_T5(S) S(command, "create_cells", Command, CreateCells)
#else
#define BIEM_T5(S)
#endif
#define BIEM_STYLES(S) BIEM_T1(S) BIEM_T2(S) BIEM_T3(S) BIEM_T4(S) BIEM_T5(S)

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
