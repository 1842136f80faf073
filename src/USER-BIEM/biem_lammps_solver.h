// The flow solver of one simulation on LAMMPS' atoms: surveys the meshes, chooses the parameters,
// holds the suspension and its volumes, evaluates velocities. Knows no input script and no stepper.
#ifndef BIEM_LAMMPS_SOLVER_H
#define BIEM_LAMMPS_SOLVER_H

#include "biem_lammps_bridge.h"
#include "biem_lammps_particles.h"
#include "biem_lammps_settings.h"
#include <memory>

namespace LAMMPS_NS {

class LammpsSolver : protected Pointers {
 public:
  LammpsSolver(LAMMPS *lmp, Fix *fix, const FixBiemSettings &settings) :
      Pointers(lmp), exchange(lmp, fix), particles(lmp), settings_(settings)
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
  // Velocities, tractions and areas of the owned atoms for the present forces. guess: of the
  // coupled system's solution; empty: none. Collective.
  biem::Evaluation evaluate(const biem::CoupledFields &guess);

  double longest_edge() const { return survey_.longest_edge; }    // at the start of the run
  double volume_error() const;    // largest relative error over the cells
  bool has_unknowns() const { return scene_.has_unknowns(); }
  const biem::Scene &scene() const { return scene_; }
  // Number of the surface of an owned atom, or -1; what its group has in common, or null.
  int find_surface(int node) const { return configuration_->find_surface(node); }
  const SurfaceGroup *group_of(int surface) const
  {
    const int g = survey_.group[surface];
    return g < 0 ? nullptr : &groups_.surfaces[g];
  }
  biem::OperatorProfile force_profile() const { return suspension_->force_profile(); }
  biem::OperatorProfile coupled_profile() const { return suspension_->coupled_profile(); }
  const biem::EwaldParameters &parameters() const { return parameters_; }

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

  LammpsExchange exchange;
  LammpsParticles particles;

 private:
  std::string who() const;    // start of an error message
  void check_lengths() const;
  void keep_volumes();
  void make_scene(const NodeGroups &groups);
  void choose_parameters(double max_tilt);
  biem::EwaldParameters choose(const biem::EwaldScene &scene);
  void set_cutoffs();

  FixBiemSettings settings_;
  MeshSurvey survey_;
  NodeGroups groups_;
  biem::Scene scene_;
  std::unordered_map<tagint, int> wall_index_;    // within all walls, by tag
  std::unique_ptr<LammpsConfiguration> configuration_;
  std::unique_ptr<biem::Suspension> suspension_;
  biem::EwaldParameters parameters_;
  // Box lengths and layers that they were chosen for.
  biem::Vec3 parameter_lengths_ = biem::Vec3::Zero();
  biem::Layers parameter_layers_ = biem::Layers::Single;
  biem::CellVolumes volumes_;
  double list_cutoff_ = 0.0;
  double own_comm_cutoff_ = -1.0;    // what prepare() has set itself
  double user_comm_cutoff_ = 0.0;    // what it was before
  std::string reported_;             // setup text of the last run
};

}    // namespace LAMMPS_NS

#endif
