// The flow solver of one simulation on LAMMPS' atoms: surveys the meshes, chooses the parameters,
// holds the suspension and its volumes, evaluates velocities. Knows no input script and no stepper.
#ifndef BIEM_LAMMPS_SOLVER_H
#define BIEM_LAMMPS_SOLVER_H

#include "biem_lammps_bridge.h"
#include "biem_lammps_settings.h"
#include <memory>

namespace LAMMPS_NS {

class LammpsSolver : protected Pointers {
 public:
  LammpsSolver(LAMMPS *lmp, Fix *fix, const FixBiemSettings &settings) :
      Pointers(lmp), exchange(lmp, fix), settings_(settings)
  {
  }
  ~LammpsSolver() override;

  // Before a run: survey, parameters, cutoffs; says what was chosen if it is new. max_tilt: of xz.
  void prepare(const NodeGroups &groups, double max_tilt);
  // Cutoff of the near list without skin, for the neighbor request.
  double list_cutoff() const { return list_cutoff_; }
  // dt: volume errors decay over ten steps.
  void set_timestep(double dt) { volumes_.relaxation_rate = 0.1 / dt; }
  void refresh(NeighList *list);
  // Velocities, tractions and areas of the owned atoms for the present forces. Collective.
  biem::Evaluation evaluate();

  double longest_edge() const { return survey_.longest_edge; }    // at the start of the run
  double volume_error() const;    // largest relative error over the cells
  biem::OperatorProfile profile() const { return suspension_->profile(); }
  const biem::EwaldParameters &parameters() const { return parameters_; }

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

  LammpsExchange exchange;

 private:
  std::string who() const;    // start of an error message
  void check_lengths() const;
  void keep_volumes();
  void choose_parameters(double max_tilt);
  biem::EwaldParameters choose(const biem::EwaldScene &scene);
  void set_cutoffs();

  FixBiemSettings settings_;
  MeshSurvey survey_;
  std::unique_ptr<LammpsScene> scene_;
  std::unique_ptr<biem::Suspension> suspension_;
  biem::EwaldParameters parameters_;
  biem::Vec3 parameter_lengths_ = biem::Vec3::Zero();    // box lengths they were chosen for
  biem::CellVolumes volumes_;
  double list_cutoff_ = 0.0;
  double own_comm_cutoff_ = -1.0;    // what prepare() has set itself
  double user_comm_cutoff_ = 0.0;    // what it was before
  std::string reported_;             // setup text of the last run
};

}    // namespace LAMMPS_NS

#endif
