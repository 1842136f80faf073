// The unknowns of Eq. 5 of Zhao et al. 2012 in one configuration, [u of cells with another
// viscosity inside, psi of rigid particles, f of walls]: operator, preconditioner, solution.
// Only the blocks that the scene has. Knows no membrane forces and no time.
// doc/theory, label coupled-system.
//
// With phi = (lambda - 1) u on cells, psi on particles, without rigid motions and net flux (~), and
//   v(x) = 1/(8 pi mu) int G f dA + 1/(8 pi) D0[phi~](x)
// the equations are, for the right-hand side w(x) that everything else causes,
//   cells:     u + (lambda - 1) u_flux - v = w
//   particles: psi_rigid + psi_flux - v = w
//   walls:     -v = w
// With a prescribed pressure drop the mean velocity U joins the unknowns: v contains U, and
//   -1/V int f dA = what the drop asks of the walls.
#ifndef BIEM_COUPLED_SYSTEM_H
#define BIEM_COUPLED_SYSTEM_H

#include "biem_coupled_walls.h"
#include "biem_scene.h"
#include "biem_solver_body.h"
#include "biem_solver_gmres.h"
#include "biem_surface_modes.h"
#include "biem_surface_replicas.h"
#include "biem_surface_subset.h"

namespace biem {

// Of two operators together.
OperatorProfile operator+(const OperatorProfile &a, const OperatorProfile &b);

class CoupledSystem {
 public:
  // scene must outlive the system. Collective.
  CoupledSystem(MPI_Comm comm, const EwaldParameters &parameters, double viscosity,
                const SolverControl &control, const Scene &scene, Drive drive);

  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // At the first call the walls' inverse and the particles' factors are made. Collective.
  void set_geometry(const Configuration &c, NodeExchange &exchange);

  // right_hand_side: read at the unknowns' nodes; mean: force per volume that the walls have to
  // take, not read with a given mean velocity. solution: initial guess in, solution out; velocity,
  // density or force per area; mean velocity. Collective. Throws NotConverged.
  SolverReport solve(const Configuration &c, const CoupledFields &right_hand_side,
                     CoupledFields &solution, NodeExchange &exchange);
  // The velocity v, 3 x n_owned, that the solution causes at the nodes without unknowns; zero at
  // the others. motions: modes().compute_motions(solution), not read without closed surfaces.
  // Collective.
  Points compute_velocity(const Configuration &c, PointsView solution,
                          const std::vector<SurfaceMotion> &motions, NodeExchange &exchange);
  const SurfaceModes &modes() const { return modes_; }
  const SurfaceSubset &surfaces() const { return surfaces_; }
  bool is_unknown(int node) const { return surface_of_unknown_[node] >= 0; }
  const WallBlock &walls() const { return walls_; }
  OperatorProfile profile() const;

 private:
  void set_topology(const Configuration &c, NodeExchange &exchange);
  void set_walls(const Configuration &c, NodeExchange &exchange);
  void set_row_sums(const Configuration &c);
  // Densities of both layers from the unknowns, ghosts filled; for all nodes.
  void compute_densities(const Configuration &c, PointsView unknowns,
                         const std::vector<SurfaceMotion> &motions, NodeExchange &exchange);
  CoupledFields apply_operator(const Configuration &c, const CoupledFields &unknowns,
                               NodeExchange &exchange);
  CoupledFields apply_preconditioner(const Configuration &c, const CoupledFields &residual,
                                     NodeExchange &exchange);
  void precondition_bodies(const Configuration &c, PointsView residual, Points &result,
                           NodeExchange &exchange) const;
  Eigen::VectorXd pack(const CoupledFields &fields) const;
  CoupledFields unpack(const Eigen::VectorXd &unknowns, NodeExchange &exchange) const;
  [[noreturn]] void rethrow_with_surface(const NotConverged &e, const Configuration &c,
                                         NodeExchange &exchange) const;
  const Surface &surface(int s) const { return scene_.surfaces[s]; }
  bool is_wall(int node) const
  {
    const int s = surface_of_unknown_[node];
    return s >= 0 && surface(s).kind == SurfaceKind::Wall;
  }

  MPI_Comm comm_;
  const Scene &scene_;
  double viscosity_;
  Layers layers_;
  bool has_double_, has_contrast_;        // has cells with unknowns
  bool has_mean_, holds_mean_ = false;    // the mean velocity is an unknown; of this rank
  double volume_ = 1.0, mean_weight_ = 1.0;
  LayerOperator operator_, field_operator_;
  SurfaceSubset surfaces_, field_surfaces_;
  SurfaceModes modes_;
  Gmres gmres_;
  long version_ = -1;
  // Of owned nodes: surface if it has unknowns, else -1; the same for closed surfaces only.
  std::vector<int> surface_of_unknown_, surface_of_mode_;
  std::vector<int> unknown_nodes_;
  std::vector<char> is_other_;    // targets of the field operator
  bool has_others_ = false;       // on any rank
  Eigen::VectorXd weights_;       // sqrt(area) of the unknown nodes: norms are those of L2
  SurfaceReplicas replicas_;      // of cells
  RowSums row_sums_;
  WallBlock walls_;
  std::vector<std::unique_ptr<BodyInverse>> body_inverses_;    // by shape
  Points single_density_, double_density_;                     // 3 x n_all
};

}    // namespace biem

#endif
