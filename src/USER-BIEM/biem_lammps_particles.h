// The rigid particles of a simulation on LAMMPS' atoms: shapes and states, the same on all ranks;
// lays the atoms at the bodies' positions, so that the meshes cannot drift. Knows no flow solver.
#ifndef BIEM_LAMMPS_PARTICLES_H
#define BIEM_LAMMPS_PARTICLES_H

#include "biem_lammps_gather.h"
#include "biem_rigid_motion.h"
#include "biem_suspension.h"
#include "pointers.h"
#include <unordered_map>

namespace LAMMPS_NS {

class LammpsParticles : protected Pointers {
 public:
  explicit LammpsParticles(LAMMPS *lmp) : Pointers(lmp) {}

  // Before a run: finds the particles. Those whose atoms lie where their state says keep it; others
  // start at rest from where their atoms are. Collective.
  void prepare(const NodeGroups &groups, const MeshSurvey &survey);
  bool is_empty() const { return bodies_.empty(); }
  // Bodies are stored by molecule id - 1 as surfaces are; shape of each, or -1.
  const std::vector<biem::SurfaceMesh> &shapes() const { return shapes_; }
  int shape(int surface) const;
  // Number of an atom within its shape; -1: it is on no particle.
  int find_index(tagint tag) const;
  std::vector<biem::Mat3> orientations(int n_surfaces) const;
  biem::Mat3 orientation(int surface) const;
  double radius(int molecule) const;    // largest distance of a node from the point of reference

  // forces (3 x n_owned) += nodal forces with the force and torque that the groups prescribe.
  void add_prescribed_loads(const NodeGroups &groups, biem::PointsRef forces) const;
  // From an evaluation: velocities of the bodies, background flow included.
  void set_motions(const biem::Evaluation &evaluation, const biem::BackgroundFlow &flow);
  void advance(biem::Stepper stepper, const biem::BackgroundFlow &flow, double dt);
  // Within a step of several stages; see biem_rigid_motion.h.
  void begin_stages(const biem::BackgroundFlow &flow);
  void advance_stage(const biem::ChebyshevStage &next, const biem::BackgroundFlow &flow, double h,
                     double elapsed);
  // Puts this rank's atoms where their bodies are, in the box of now.
  void lay_atoms() const;
  // By molecule id. Who moves a body has to lay its atoms.
  const std::map<int, biem::RigidBody> &bodies() const { return states_; }
  std::map<int, biem::RigidBody> &bodies() { return states_; }
  const std::map<int, biem::RigidBodyStages> &stages() const { return stages_; }

  std::vector<double> get_state() const;
  const double *set_state(const double *state);    // returns what follows

 private:
  struct Body {
    int shape;
    std::vector<tagint> tags;
  };

  void add_body(int molecule, const GatheredSurface &surface);
  bool is_in_place(const biem::RigidBody &state, const biem::Points &frame,
                   const biem::Points &positions) const;
  int find_or_add_shape(const biem::Points &frame, const std::vector<biem::Triangle> &triangles);

  std::map<int, Body> bodies_;    // by molecule id
  std::map<int, biem::RigidBody> states_;
  std::map<int, biem::RigidBodyStages> stages_;
  // Body frames that a restart file brought, until prepare() has taken them.
  std::map<int, biem::Points> restored_frames_;
  std::vector<biem::SurfaceMesh> shapes_;
  std::unordered_map<tagint, std::pair<int, int>> nodes_;    // molecule, index within the shape
};

}    // namespace LAMMPS_NS

#endif
