// Is the rest of the input script compatible with fix biem? Newton flag, boundaries, neighbor
// settings, other fixes. Stops through error->all(); changes neigh_modify where it must.
#ifndef BIEM_LAMMPS_SCRIPT_CHECK_H
#define BIEM_LAMMPS_SCRIPT_CHECK_H

namespace LAMMPS_NS {

class Fix;
class LAMMPS;

void check_script(LAMMPS *lmp, const Fix *fix);

}    // namespace LAMMPS_NS

#endif
