// One evaluation of Eq. 5 of Zhao et al. 2012 for a whole scene: forces on all nodes in, velocities
// of all nodes out. Membrane forces act through the single layer; what else there is (other inside
// viscosities, rigid particles, walls) is the coupled system's, built only where the scene has it.
// Knows no constitutive law and no time.
#ifndef BIEM_SUSPENSION_H
#define BIEM_SUSPENSION_H

#include "biem_body_load.h"
#include "biem_coupled_system.h"
#include "biem_flow.h"
#include "biem_surface_hold.h"

namespace biem {

// From nodal forces F to the force density f on the fluid.
// Lumped: f = F / nodal area (Zhao et al. 2012, Eq. 9).
// Consistent: one Richardson step towards the consistent mass matrix, M f = F.
enum class Traction { Lumped, Consistent };
Traction parse_traction(const std::string &name);

struct SuspensionSettings {
  double viscosity = 1.0;    // outside the cells [force * time / length^2]
  Traction traction = Traction::Lumped;
  Drive drive = Drive::MeanVelocity;
  SolverControl control{1e-4, 100, 50, FinalResidual::Estimated};
};

// Of the periodic sums over the membrane forces, and of those of the coupled system, which have
// other points and layers.
struct SumParameters {
  EwaldParameters forces, coupled;
};

struct Conditions {
  BackgroundFlow flow;
  Vec3 pressure_drop = Vec3::Zero();    // -grad p that drives; read with Drive::PressureDrop
};

// Results on the owned nodes.
struct Evaluation {
  Points velocity;           // 3 x n_owned, relative to the background flow
  Points traction;           // 3 x n_owned, force density on the fluid (walls: on both sides)
  Eigen::VectorXd areas;     // n_owned
  CoupledFields solution;    // of the coupled system: initial guess of the next evaluation
  SolverReport solver;
  // By surface, of rigid particles: motion of the centroid of the surface relative to the
  // background flow there; where that is.
  std::vector<SurfaceMotion> motions;
  std::vector<Vec3> centroids;
  // By surface, where the coupled system has it: mu int (phi n + n phi) dA - sym int F x dA,
  // without trace: what it adds to the mean stress is this divided by the volume.
  std::vector<Mat3> stresslets;
  Vec3 mean_velocity = Vec3::Zero();    // of the whole cell
  Vec3 pressure_drop = Vec3::Zero();    // mean -grad p: balances all forces on the fluid
  Vec3 wall_force = Vec3::Zero();       // of the walls on the fluid
  double wall_area = 0.0;
};

class Suspension {
 public:
  // scene must outlive the suspension.
  Suspension(MPI_Comm comm, const SumParameters &parameters, const SuspensionSettings &settings,
             const Scene &scene);

  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // forces: 3 x n_owned, on the fluid; on a rigid particle only their sum and torque count, on
  // walls none may act. guess: of the coupled system's solution; empty: zero. Collective. Throws
  // Error on collapsed elements, NotConverged.
  Evaluation evaluate(const Configuration &configuration, PointsView forces,
                      const Conditions &conditions, const CoupledFields &guess, HeldCells &cells,
                      NodeExchange &exchange);

  // The fast part of the velocities (3 x n_owned): the membranes' single layer, on a cell times
  // 2/(1 + viscosity ratio) as for short waves, zero on particles and walls. Collective.
  Points evaluate_fast(const Configuration &configuration, PointsView forces,
                       NodeExchange &exchange);
  // As evaluate() does with its velocities. After evaluate_fast() or evaluate() at these positions.
  void hold(const Configuration &configuration, const BackgroundFlow &flow, HeldCells &cells,
            PointsRef velocity, NodeExchange &exchange);
  // Displacements (3 x n_owned) that bring the cells back to their references, to first order.
  // After evaluate() for a configuration of the same version. Collective.
  Points compute_hold_correction(const Configuration &configuration, HeldCells &cells,
                                 NodeExchange &exchange);

  OperatorProfile force_profile() const { return force_operator_.profile(); }
  OperatorProfile coupled_profile() const;

 private:
  void set_force_geometry(const Configuration &c, PointsView forces, NodeExchange &exchange);
  void measure_cells(const Configuration &c, HeldCells &cells, NodeExchange &exchange) const;
  void hold_cells(const Configuration &c, const BackgroundFlow &flow, const HeldCells &cells,
                  PointsRef velocity, NodeExchange &exchange) const;
  enum class Sources { All, Cells };
  Points compute_traction(const Configuration &c, PointsView forces, Sources sources,
                          NodeExchange &exchange) const;
  Points apply_forces(const Configuration &c, PointsView traction, NodeExchange &exchange);
  void spread_body_forces(const Configuration &c, PointsView forces, PointsRef density,
                          NodeExchange &exchange) const;
  void solve_coupled(const Configuration &c, PointsView forces, const Conditions &conditions,
                     const CoupledFields &guess, Evaluation &result, NodeExchange &exchange);
  void check_blocked_flow(const Conditions &conditions) const;
  void add_stresslets(const Configuration &c, PointsView forces, Evaluation &result,
                      NodeExchange &exchange) const;
  bool is_kind(const Configuration &c, int node, SurfaceKind kind) const;

  SuspensionSettings settings_;
  const Scene &scene_;
  bool has_unknowns_;
  double volume_ = 1.0;
  SurfaceSubset force_surfaces_;
  LayerOperator force_operator_;
  bool has_forces_ = true, has_body_forces_ = false;    // some surface carries a single layer of F
  long version_ = -1;
  std::vector<BodyLoad> body_loads_;    // by shape
  std::unique_ptr<CoupledSystem> coupled_;
};

}    // namespace biem

#endif
