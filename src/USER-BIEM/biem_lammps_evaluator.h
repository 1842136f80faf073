// One evaluation of the flow on LAMMPS' atoms, in a step or between steps: lists, forces, the
// solution it starts from, and where its results go in the array of the fix. Knows no stepper.
#ifndef BIEM_LAMMPS_EVALUATOR_H
#define BIEM_LAMMPS_EVALUATOR_H

#include "biem_lammps_columns.h"
#include "biem_lammps_history.h"
#include "biem_lammps_stage_forces.h"

namespace LAMMPS_NS {

class NeighList;

// Why a step cannot go on; thrown on all ranks alike.
struct StepFailure {
  std::string why;
};

class FlowEvaluator : protected Pointers {
 public:
  // array: the fix's, which moves when the number of atoms grows.
  FlowEvaluator(LAMMPS *lmp, Fix *fix, const biem::BackgroundFlow &flow, LammpsSolver &solver,
                double **&array) :
      Pointers(lmp),
      forces(lmp, fix), solver_(solver), array_(array),
      history_(lmp, NodeColumn::kSolution, NodeColumn::kPreviousSolution), flow_(flow)
  {
  }

  void start_run(const NodeGroups &groups);
  void set_list(NeighList *list) { list_ = list; }
  void lists_are_new();    // by LAMMPS; may throw StepFailure

  // For the forces of now; the solution becomes part of the history. Throws StepFailure, as all of
  // these. Collective.
  biem::Evaluation evaluate(double time);
  // For atoms that have been moved a little and will be moved back: keeps nothing.
  biem::Evaluation evaluate_aside(double time);
  // Multirate: splits the velocities that were stored last, of the positions of now, into a fast
  // part and the rest, which is kept.
  void split(double time);
  // Whether the rest changes slowly: what a line through the last two made of the one after them
  // was right.
  bool can_extrapolate() const;
  // Velocities to the array and the particles: the fast part for the forces of now, and the rest
  // on the line through the last two.
  void evaluate_inner(double time);
  biem::Points evaluate_inner_aside();    // the fast part
  // Velocity, traction and area to the array, for atoms as they are now, and back.
  void store(const biem::Evaluation &evaluation);
  void reload(biem::Evaluation &evaluation) const;
  void update_lists();      // ghosts, and lists where they have to be renewed
  void compute_forces();    // after update_lists()

  // Since start_run(): of the whole flow, and of the fast part alone.
  double n_evaluations() const { return n_evaluations_; }
  double n_inner() const { return n_inner_; }
  double n_all() const { return n_evaluations_ + n_inner_; }
  const NodeGroups &groups() const { return groups_; }
  biem::SurfaceKind kind(int atom_index) const;
  bool is_tracer(int atom_index) const;
  biem::Vec3 velocity(int i) const { return biem::Vec3(array_[i] + NodeColumn::kVelocity); }

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

  StageForces forces;

 private:
  void check_forces() const;
  void check_velocities(biem::PointsView velocity) const;
  void fail_at(tagint tag, const std::string &what) const;
  void refresh();
  double compute_slow_ratio(double time) const;
  void measure_slow_error(double time, biem::PointsView fast);

  LammpsSolver &solver_;
  double **&array_;
  SolutionHistory history_;
  NodeGroups groups_;
  NeighList *list_ = nullptr;
  bool has_contacts_ = false;    // a pair style that also acts on walls
  double n_evaluations_ = 0.0, n_inner_ = 0.0;
  // Of slow parts: how many there are, up to 2, and when; motions of particles relative to the
  // background flow, by molecule id. Those of nodes are in the array.
  struct SlowMotion {
    biem::Vec3 velocity = biem::Vec3::Zero(), rotation = biem::Vec3::Zero();
    biem::Vec3 previous_velocity = biem::Vec3::Zero(), previous_rotation = biem::Vec3::Zero();
  };
  int n_slow_ = 0;
  double slow_time_ = 0.0, previous_slow_time_ = 0.0;
  double slow_error_ = -1.0;    // of the last line, displacement in one step; -1: none yet
  std::map<int, SlowMotion> slow_motions_;
  const biem::BackgroundFlow flow_;
};

}    // namespace LAMMPS_NS

#endif
