// What fix biem says at setup: the scene, the units, the chosen parameters and expected errors.
#ifndef BIEM_LAMMPS_REPORT_H
#define BIEM_LAMMPS_REPORT_H

#include "biem_ewald_parameters.h"
#include "biem_lammps_topology.h"
#include <string>

namespace LAMMPS_NS {

class LAMMPS;

// coupled: null where there is no coupled system. cutoffs: of the communication and of the near
// list, length.
std::string describe_setup(LAMMPS *lmp, const MeshSurvey &survey,
                           const biem::EwaldParameters &forces,
                           const biem::EwaldParameters *coupled, const double cutoffs[2]);

}    // namespace LAMMPS_NS

#endif
