// The last two solutions of the coupled system, from which the next one starts: in columns of the
// fix's per-atom array, so that they move with the atoms; of rigid particles in the body frame.
// Knows no equations.
#ifndef BIEM_LAMMPS_HISTORY_H
#define BIEM_LAMMPS_HISTORY_H

#include "biem_lammps_solver.h"

namespace LAMMPS_NS {

// FromLast: the positions are those of the last solution, as in the setup of a run.
enum class SolutionStart { FromLast, Extrapolated };

class SolutionHistory : protected Pointers {
 public:
  // now, before: first of the three columns that hold each solution.
  SolutionHistory(LAMMPS *lmp, int now, int before) : Pointers(lmp), now_(now), before_(before) {}

  // Initial guess for the owned atoms; empty if there is no solution yet. array: of the fix.
  biem::CoupledFields make_guess(SolutionStart start, const LammpsSolver &solver,
                                 double **array) const;
  void keep(SolutionStart start, const LammpsSolver &solver, const biem::CoupledFields &solution,
            double **array);

  static constexpr int kStateSize = 8;
  std::vector<double> get_state() const;
  void set_state(const double *state);

 private:
  int now_, before_;
  // Mean velocity that a pressure drop drives, now and one step ago.
  biem::Vec3 mean_ = biem::Vec3::Zero(), previous_mean_ = biem::Vec3::Zero();
  int n_solutions_ = 0;    // up to 2
  double dt_ = 0.0;        // between the last two
};

}    // namespace LAMMPS_NS

#endif
