// The tilt xz of a periodic box that shears with u = (rate z, 0, 0): advances it, flips the box,
// counts strain and flips. Knows no atoms' velocities and no forces.
#ifndef BIEM_LAMMPS_SHEARED_BOX_H
#define BIEM_LAMMPS_SHEARED_BOX_H

#include "lmptype.h"
#include "pointers.h"
#include <vector>

namespace LAMMPS_NS {

class ShearedBox : protected Pointers {
 public:
  // rate [1/time]; 0: a box at rest, for which every call does nothing.
  ShearedBox(LAMMPS *lmp, double rate) : Pointers(lmp), rate_(rate) {}
  ~ShearedBox() override;

  bool is_sheared() const { return rate_ != 0.0; }
  // Start of a run, or a new timestep: continues the count of the tilt, or starts it anew where the
  // box, the timestep or the count of steps has been changed from outside.
  void start();
  // Before the step to the present count of steps, which is to be of length dt.
  void begin_step(double dt);
  // Sets the tilt of this part of the present step, 0 to 1. True if the box should be flipped.
  bool advance(double fraction);
  // Flips the box if its tilt has passed one half, and moves the atoms to their new ranks.
  void flip_if_needed();

  double strain() const { return strain_; }
  double n_flips() const { return static_cast<double>(n_flips_); }

  static constexpr int kStateSize = 9;
  std::vector<double> get_state() const;
  void set_state(const double *state);

 private:
  void rebase(bigint step, double dt);

  double rate_;
  // At step n: strain = base strain + rate (n - base_step) base_dt, unflipped tilt likewise, so
  // that nothing is added up step by step.
  double base_tilt_ = 0.0, base_strain_ = 0.0, base_dt_ = 0.0, base_rate_ = 0.0;
  bigint base_step_ = 0;
  double tilt_ = 0.0, strain_ = 0.0;    // of last_step_
  bigint last_step_ = 0;
  bool is_started_ = false;
  bigint n_flips_ = 0;
};

}    // namespace LAMMPS_NS

#endif
