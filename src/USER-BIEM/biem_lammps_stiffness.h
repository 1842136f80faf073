// How fast the fastest mode of the scene relaxes: spectral radius of the velocities' Jacobian, by
// Arnoldi's method on differences of evaluations; doc/theory, label stiffness. The mode is kept on
// the atoms, so that the next estimate starts from it. Knows no time step.
#ifndef BIEM_LAMMPS_STIFFNESS_H
#define BIEM_LAMMPS_STIFFNESS_H

#include "biem_lammps_evaluator.h"

namespace LAMMPS_NS {

class StiffnessEstimate : protected Pointers {
 public:
  StiffnessEstimate(LAMMPS *lmp, FlowEvaluator &flow, LammpsSolver &solver, double **&array) :
      Pointers(lmp), flow_(flow), solver_(solver), array_(array)
  {
  }

  // The evaluations of a new run are counted from zero.
  void start_run();
  // Of the velocities' fast part alone.
  void use_fast_part() { is_fast_ = true; }
  // Whether so many evaluations have been made since the last estimate, or there is none.
  bool is_due(double n_evaluations) const;
  // Evaluations that are no part of a step, as those of a setup, do not bring it closer.
  void skip(double n_evaluations) { last_count_ += n_evaluations; }
  // At the positions of now, whose velocities are in the array; atoms stay where they are.
  // Collective.
  void renew(double time);
  double radius() const { return radius_; }    // 1/time; 0: nothing relaxes
  // What it may have grown to since: as between the last two estimates, which were about so many
  // evaluations apart.
  double upper_radius(double n_evaluations) const;
  double n_evaluations() const { return n_evaluations_; }    // for estimates, since the start

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

 private:
  // Displacements of the nodes of cells are in columns of the array; those of a rigid particle are
  // there, too, and here as what they are.
  struct BodyMode {
    biem::Vec3 shift = biem::Vec3::Zero(), turn = biem::Vec3::Zero();
  };
  using BodyModes = std::map<int, BodyMode>;    // by molecule id

  void save_positions();
  void set_start_rates();
  void restore_positions();
  void start_mode();
  void add_step_error();
  double iterate();
  void apply_jacobian(int from, int to);
  biem::Points evaluate();
  void lay_body_mode(int k);
  double dot(int j, int k) const;
  void add(double factor, int from, int to);
  void scale(int k, double factor);
  double find_largest(int k) const;
  bool moves(int i) const;
  double *vector(int i, int k) const;    // of atom i

  FlowEvaluator &flow_;
  LammpsSolver &solver_;
  double **&array_;
  double time_ = 0.0;
  bool is_started_ = false, is_fast_ = false;
  double radius_ = 0.0, previous_radius_ = 0.0;
  double last_count_ = 0.0, n_evaluations_ = 0.0;
  std::vector<BodyModes> body_modes_;
  std::map<int, biem::RigidBody> bodies_;    // as they are, during an estimate
};

}    // namespace LAMMPS_NS

#endif
