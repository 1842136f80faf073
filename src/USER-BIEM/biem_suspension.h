// The scene: forces on the nodes of all surfaces in, velocities of all nodes out. With a viscosity
// ratio of 1 and no other surfaces, Eq. 5 of Zhao et al. 2012 is one evaluation of the single
// layer:   u(x) = u_inf(x) + 1/(8 pi mu) int G(x, y) f(y) dA(y), followed by a projection that
// keeps every cell's volume. Knows no constitutive law and no time.
#ifndef BIEM_SUSPENSION_H
#define BIEM_SUSPENSION_H

#include "biem_operator_layers.h"

namespace biem {

// From nodal forces F to the force density f on the fluid.
// Lumped: f = F / nodal area (Zhao et al. 2012, Eq. 9).
// Consistent: one Richardson step towards the consistent mass matrix, M f = F.
enum class Traction { Lumped, Consistent };
Traction parse_traction(const std::string &name);

struct SuspensionSettings {
  double viscosity = 1.0;    // [force * time / length^2]
  Traction traction = Traction::Lumped;
};

// One rank's share of a configuration; closed surfaces are numbered 0 ... n_cells - 1 globally.
struct Configuration {
  PointsView nodes;    // 3 x n_all, owned first, then ghosts
  int n_owned;
  const std::vector<Triangle> &triangles;    // each on exactly one rank
  const std::vector<int> &cell_of_triangle;
  const std::vector<int> &cell_of_node;    // owned nodes; -1: on no surface
  PointsView triangle_shift;               // 3 x n: from the triangle's image to its cell's
  const NearCandidates &candidates;
};

// Volumes of the cells and how they are held.
struct CellVolumes {
  std::vector<double> reference;    // per cell; empty: no projection
  std::vector<double> current;      // filled by evaluate()
  double relaxation_rate = 0.0;     // [1/time] at which a volume error decays
};

// Results on the owned nodes.
struct Evaluation {
  Points velocity;          // 3 x n_owned, relative to the background flow
  Points traction;          // 3 x n_owned, force density on the fluid
  Eigen::VectorXd areas;    // n_owned
};

class Suspension {
 public:
  Suspension(MPI_Comm comm, const EwaldParameters &parameters, const SuspensionSettings &settings);

  void set_cell(const Mat3 &cell, const Vec3 &origin) { layers_.set_cell(cell, origin); }
  // forces: 3 x n_owned, on the fluid. Collective. Throws Error on collapsed elements.
  Evaluation evaluate(const Configuration &configuration, PointsView forces, CellVolumes &volumes,
                      NodeExchange &exchange);

  OperatorProfile profile() const { return layers_.profile(); }
  const EwaldParameters &parameters() const { return layers_.parameters(); }

 private:
  Points compute_traction(const Configuration &c, PointsView forces, const Eigen::VectorXd &areas,
                          NodeExchange &exchange) const;

  SuspensionSettings settings_;
  LayerOperator layers_;
  std::unique_ptr<SurfaceElements> elements_;
};

// Removes the flux through each closed surface, up to what restores the reference volume in
// 1/relaxation_rate: u -= alpha n with alpha = (sum u.g - wanted) / sum |g|, g = dV/dx (3 x
// n_owned).
void project_volume(const std::vector<int> &cell_of_node, PointsView gradient,
                    const CellVolumes &volumes, NodeExchange &exchange, PointsRef velocity);

}    // namespace biem

#endif
