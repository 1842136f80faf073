// Arguments of fix biem -> settings. Parses and refuses; keeps no state, computes nothing.
#ifndef BIEM_LAMMPS_SETTINGS_H
#define BIEM_LAMMPS_SETTINGS_H

#include "biem_ewald_tuning.h"
#include "biem_lammps_topology.h"
#include "biem_mesh_watch.h"
#include "biem_stepper.h"
#include "biem_suspension.h"
#include "lmptype.h"
#include <string>

namespace LAMMPS_NS {

class LAMMPS;

struct FixBiemSettings {
  enum class Flow { None, Mean, Shear, PressureDrop };

  biem::SuspensionSettings suspension;    // viscosity already in force * time / length^2
  double viscosity = 0.0;                 // as given, in the unit of the unit style
  double accuracy = 0.0;
  // Parameters of the periodic sum that the user fixes; 0: chosen from the accuracy.
  biem::EwaldMethod ewald = biem::EwaldMethod::Pswf;
  biem::EwaldTuning tuning = biem::EwaldTuning::Model;
  double cutoff = 0.0, splitting = 0.0;
  int order = 0;
  std::array<int, 3> grid{};
  Flow flow = Flow::None;
  biem::Conditions conditions;
  biem::Stepper stepper = biem::Stepper::RungeKuttaChebyshev2;
  double error_tolerance = 0.0;    // of a step, length; 0: the timestep is fixed
  bool is_multirate = false;
  biem::WatchLimits watch;
  biem::Hold hold = biem::Hold::Volume;
  // Groups of surfaces by name, bits not set; cells without a name: all atoms in no other group.
  std::vector<SurfaceGroup> surfaces;
  std::string tracers, probes;    // group names; empty: none
};

// Stops through error->all() with what is wrong and what is allowed.
FixBiemSettings parse_fix_biem(LAMMPS *lmp, int narg, char **arg);

// Factor from the unit style's dynamic viscosity to force * time / length^2.
double viscosity_factor(LAMMPS *lmp);

}    // namespace LAMMPS_NS

#endif
