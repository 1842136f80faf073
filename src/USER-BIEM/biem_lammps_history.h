// The last two solutions of the coupled system, from which the next one starts: in columns of the
// fix's per-atom array, so that they move with the atoms; of rigid particles in the body frame.
// Knows no equations.
#ifndef BIEM_LAMMPS_HISTORY_H
#define BIEM_LAMMPS_HISTORY_H

#include "biem_lammps_solver.h"

namespace LAMMPS_NS {

class SolutionHistory : protected Pointers {
 public:
  // now, before: first of the three columns that hold each solution.
  SolutionHistory(LAMMPS *lmp, int now, int before) : Pointers(lmp), now_(now), before_(before) {}

  // Initial guess for the owned atoms at a time: on the line through the last two solutions; empty
  // if there is none yet. array: of the fix.
  biem::CoupledFields make_guess(double time, const LammpsSolver &solver, double **array) const;
  // At the time of the last solution: takes its place.
  void keep(double time, const LammpsSolver &solver, const biem::CoupledFields &solution,
            double **array);

  static constexpr int kStateSize = 9;
  std::vector<double> get_state() const;
  void set_state(const double *state);

 private:
  int now_, before_;
  // Mean velocity that a pressure drop drives, now and one step ago.
  biem::Vec3 mean_ = biem::Vec3::Zero(), previous_mean_ = biem::Vec3::Zero();
  int n_solutions_ = 0;    // up to 2
  double time_ = 0.0, previous_time_ = 0.0;
};

}    // namespace LAMMPS_NS

#endif
