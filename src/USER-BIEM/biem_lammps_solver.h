// The flow solver of one simulation on LAMMPS' atoms: surveys the meshes, chooses the parameters,
// holds the suspension and what it keeps of its cells, evaluates velocities. Knows no input script
// and no stepper.
#ifndef BIEM_LAMMPS_SOLVER_H
#define BIEM_LAMMPS_SOLVER_H

#include "biem_lammps_bridge.h"
#include "biem_lammps_parameters.h"
#include "biem_lammps_particles.h"
#include <memory>

namespace LAMMPS_NS {

class LammpsSolver : protected Pointers {
 public:
  LammpsSolver(LAMMPS *lmp, Fix *fix, const FixBiemSettings &settings) :
      Pointers(lmp), exchange(lmp, fix), particles(lmp), settings_(settings),
      force_parameters_(lmp, settings), coupled_parameters_(lmp, settings)
  {
  }
  ~LammpsSolver() override;

  // Before a run: survey, parameters, cutoffs; says what was chosen if it is new. max_tilt: of xz.
  void prepare(const NodeGroups &groups, double max_tilt);
  // Cutoff of the near list without skin, for the neighbor request.
  double list_cutoff() const { return list_cutoff_; }
  // dt: errors of volumes and areas decay over ten steps.
  void set_timestep(double dt) { cells_.relaxation_rate = 0.1 / dt; }
  // Where edges have grown beyond the reach of the list: which, and what to do. Collective.
  std::string refresh(NeighList *list);
  // Velocities, tractions and areas of the owned atoms for the present forces. guess: of the
  // coupled system's solution; empty: none. Collective. Throws biem::NotConverged.
  biem::Evaluation evaluate(const biem::CoupledFields &guess);

  // The part of the velocities that follows the membranes' forces at once (3 x n_owned), with all
  // of the rest (slow) added to it and what is held taken care of.
  biem::Points evaluate_fast();
  biem::Points evaluate_fast(biem::PointsView slow);
  // Displacements of the owned atoms that bring the cells back to what is held of them.
  biem::Points compute_hold_correction();
  // Least gap / closing speed over all pairs of near surfaces. Collective.
  double find_closing_time(double **array, int column, const biem::BackgroundFlow &flow);

  double longest_edge() const { return survey_.longest_edge; }    // at the start of the run
  double volume_error() const;    // largest relative error over the cells
  int worst_volume() const;       // molecule id of the cell that has it
  bool has_unknowns() const { return has_unknowns_; }
  const biem::Scene &scene() const { return *scene_; }
  // Number of the surface of an owned atom, or -1; what its group has in common, or null.
  int find_surface(int node) const { return configuration_->find_surface(node); }
  const SurfaceGroup *group_of(int surface) const
  {
    const int g = survey_.group[surface];
    return g < 0 ? nullptr : &groups_.surfaces[g];
  }
  biem::OperatorProfile force_profile() const { return suspension_->force_profile(); }
  biem::OperatorProfile coupled_profile() const { return suspension_->coupled_profile(); }
  double expected_error() const;    // of the periodic sums in use, the largest

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

  LammpsExchange exchange;
  LammpsParticles particles;

 private:
  double volume_error(size_t cell) const;
  std::string who() const;    // start of an error message
  void check_lengths() const;
  void keep_references();
  void make_suspension(double max_tilt);
  biem::Scene make_scene();
  void add_connectivities(biem::Scene &scene);
  void add_walls(biem::WallMesh &walls);
  bool choose_parameters(double max_tilt);
  biem::EwaldScene describe_points(double max_tilt, bool (*is_in)(const biem::Surface &)) const;
  void set_cutoffs();
  void set_list_size();

  FixBiemSettings settings_;
  MeshSurvey survey_;
  NodeGroups groups_;
  std::unique_ptr<biem::Scene> scene_;
  bool has_unknowns_ = false;
  // By tag: number within all walls, or within a cell that has unknowns.
  std::unordered_map<tagint, int> node_index_;
  std::unique_ptr<LammpsConfiguration> configuration_;
  std::unique_ptr<biem::Suspension> suspension_;
  // Of the sum over membrane forces, and of those of the coupled system: fewer points.
  LammpsParameters force_parameters_, coupled_parameters_;
  biem::HeldCells cells_;
  double list_cutoff_ = 0.0;
  double own_comm_cutoff_ = -1.0;    // what prepare() has set itself
  double user_comm_cutoff_ = 0.0;    // what it was before
  std::string reported_;             // setup text of the last run
};

}    // namespace LAMMPS_NS

#endif
