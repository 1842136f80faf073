// The time steps of fix biem: moves nodes, tracers, particles and the sheared box from one step to
// the next, through as many evaluations of the flow as the stepper needs; has the watchdog look at
// what comes out, and chooses the step where it is asked to. Knows no input script and publishes
// nothing.
#ifndef BIEM_LAMMPS_INTEGRATOR_H
#define BIEM_LAMMPS_INTEGRATOR_H

#include "biem_lammps_sheared_box.h"
#include "biem_lammps_stiffness.h"
#include "biem_lammps_watchdog.h"
#include <optional>

namespace LAMMPS_NS {

// What the steps since the start of a run have cost and done.
struct StepRecord {
  double n_steps = 0.0;
  double n_repeated = 0.0;          // steps taken again with a smaller dt
  double n_split = 0.0;             // steps taken in parts because surfaces approach each other
  double n_stages = 0.0;            // of the last step, all parts together
  double last_part_stages = 0.0;    // of the last part of it
  double error = 0.0;               // estimate of the last step, length
  double fewest_stages = 0.0, most_stages = 0.0, shortest_dt = 0.0, longest_dt = 0.0;

  void add_step(double dt);
};

class LammpsIntegrator : protected Pointers {
 public:
  // array: the fix's, which moves when the number of atoms grows.
  LammpsIntegrator(LAMMPS *lmp, Fix *fix, const FixBiemSettings &settings, LammpsSolver &solver,
                   ShearedBox &box, double **&array);

  void start_run(const NodeGroups &groups);
  // The flow at the end of a step, or in a setup: for the forces that LAMMPS has computed.
  biem::Evaluation evaluate();
  // From positions and velocities of the last step to the positions of this one. True if LAMMPS
  // should renew its lists at once. Collective.
  bool step();
  void renew_lists();    // LAMMPS has renewed its own
  // Ends the run with what is wrong and what to do; within a run, at the state of the last step,
  // which is written to a restart file. Collective.
  [[noreturn]] void stop(const std::string &why);
  void reset_dt();    // by the input script or another fix

  FlowEvaluator flow;
  StiffnessEstimate stiffness;

  const StepRecord &record() const { return record_; }
  double time() const { return time_; }    // physical, since the fix was defined
  std::string describe_run() const;        // at the end of a run; empty: nothing to say

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

 private:
  bool is_mobile(int i) const { return is_cell(i) || flow.is_tracer(i); }
  bool is_cell(int i) const { return flow.kind(i) == biem::SurfaceKind::Cell; }

  void step_once();
  void step_fixed();
  void step_adaptive();
  void take_stages(double fraction, double span);
  int count_stages(double h) const;
  void begin_stages();
  void move_to_stage(const biem::ChebyshevStage &next, double h, double elapsed);
  enum class Part { All, Fast };
  void evaluate_stage(double time, Part part);
  void correct_held_cells();
  void check_positions();
  void check_crossings();
  double estimate_error(double h);
  void note_error(double error);
  bool is_radius_due() const;
  double find_closing_limit();
  void adopt_dt(double dt);
  void finish_step(double dt);

  void save_start();
  void restore_start();
  void check_displacement(double largest) const;

  const FixBiemSettings settings_;
  const biem::BackgroundFlow flow_;
  LammpsSolver &solver_;
  ShearedBox &box_;
  double **&array_;
  LammpsWatchdog watchdog_;
  biem::StepController controller_;
  StepRecord record_;
  bool wants_new_lists_ = false;
  double last_error_ = 0.0;
  bool has_grown_ = false;    // the error of the last step, suddenly
  bool has_start_ = false;    // the start of a step is saved

  double time_ = 0.0;
  double last_part_ = 0.0;    // length of the stages whose error is not known yet
  // Adaptive: what the script allows, what the next step is to be, what is in update->dt.
  double largest_dt_ = 0.0, next_dt_ = 0.0, adopted_dt_ = 0.0;
  std::map<int, biem::RigidBody> start_bodies_;
  std::optional<biem::Evaluation> finished_;    // of the positions of now, already in the array
};

}    // namespace LAMMPS_NS

#endif
