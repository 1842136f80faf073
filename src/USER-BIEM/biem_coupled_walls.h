// The walls' block of the coupled system, distributed: exact solution for walls alone, with the
// mean velocity where a pressure drop is given instead. Knows no particles, no cells and no GMRES.
// doc/theory, label walls.
#ifndef BIEM_COUPLED_WALLS_H
#define BIEM_COUPLED_WALLS_H

#include "biem_node_exchange.h"
#include "biem_solver_wall.h"

namespace biem {

// Values at the owned nodes (3 x n_owned), and the one that belongs to the mean velocity.
struct CoupledFields {
  Points nodes;
  Vec3 mean = Vec3::Zero();
};

// What drives the flow: a given mean velocity of the whole cell, or a given pressure drop.
enum class Drive { MeanVelocity, PressureDrop };

class WallBlock {
 public:
  // Velocities (3 x n_owned) that force densities (3 x n_owned) at the walls cause. Collective.
  using Response = std::function<Points(PointsView densities)>;

  explicit WallBlock(Drive drive) : drive_(drive) {}

  // index: by owned node, its number within mesh, -1: on no wall; areas: n_owned nodal areas;
  // volume of the cell. At the first call mesh is inverted. Call again when nodes have migrated.
  // Collective.
  void set_nodes(const WallMesh &mesh, std::vector<int> index, Eigen::VectorXd areas, double volume,
                 const Response &response, NodeExchange &exchange);

  // Solves  -v(f) - U = residual at the walls,  L^-1 load(f) = residual.mean,  where load(f) is
  // compute_load() and L maps a uniform mean velocity to the load that walls alone take of it; a
  // given mean velocity has U = 0. Writes the walls' nodes of result, and its mean. Collective.
  void solve(const CoupledFields &residual, CoupledFields &result, NodeExchange &exchange) const;
  // Force per volume that the walls take of the driving pressure: -1/V int f dA. Collective.
  Vec3 compute_load(PointsView densities, NodeExchange &exchange) const;
  // L^-1 load; in blocked directions 0.
  Vec3 to_velocity(const Vec3 &load) const { return loads_to_velocity_ * load; }

  bool is_empty() const { return !inverse_; }
  // Directions in which a closed wall lets no mean flow through.
  const std::array<bool, 3> &is_blocked() const { return is_blocked_; }
  // Force densities that cause no flow, 3 x n_owned each: unit pressure jumps across closed sheets.
  std::vector<Points> compute_null_vectors() const;
  double area() const { return area_; }    // of all walls
  // Relative residual of the inverse for a rough velocity, measured when it was made: what noise
  // of the periodic sum leaves.
  double residual() const { return residual_; }
  std::string describe() const { return inverse_->describe(); }

 private:
  bool is_wall(Eigen::Index node) const { return index_[node] >= 0; }
  Points distribute(const Points &replicated) const;
  Points gather(PointsView field, NodeExchange &exchange) const;
  void invert(const WallMesh &mesh, const Response &response, NodeExchange &exchange);
  double measure_residual(const WallResponse &respond) const;
  void find_blocked_directions(NodeExchange &exchange);

  Drive drive_;
  std::unique_ptr<WallInverse> inverse_;
  Eigen::Index n_wall_nodes_ = 0;
  std::vector<int> index_;
  Eigen::VectorXd areas_;
  double volume_ = 1.0, area_ = 0.0, residual_ = 0.0;
  std::array<bool, 3> is_blocked_{};
  // Force densities -W^-1 e_a that a uniform velocity asks of the walls, 3 x n_owned each; zero in
  // blocked directions. L, and its inverse.
  std::array<Points, 3> uniform_forces_;
  Mat3 loads_to_velocity_ = Mat3::Zero();
};

}    // namespace biem

#endif
