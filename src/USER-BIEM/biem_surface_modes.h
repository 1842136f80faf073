// Rigid motions and net fluxes of fields on closed surfaces: the parts of a double-layer density
// that the operator must not see, and the motion of a rigid particle. Inner product of the
// consistent linear mass matrix M. Knows no kernels, forces or time. doc/theory, label modes.
#ifndef BIEM_SURFACE_MODES_H
#define BIEM_SURFACE_MODES_H

#include "biem_element.h"
#include "biem_node_exchange.h"

namespace biem {

// A field on one surface is  velocity + rotation x (x - centroid) + flux g/A + rest,  where g_i =
// dV/dx_i and A_i is the nodal area: the rest has no rigid motion and no net flux.
struct SurfaceMotion {
  Vec3 velocity = Vec3::Zero();    // of the centroid
  Vec3 rotation = Vec3::Zero();    // [1/time]
  double flux = 0.0;               // amplitude of g/A, a normal velocity
};

struct SurfaceGeometry {
  Vec3 centroid = Vec3::Zero();    // of the surface, where it is in one piece
  double area = 0.0;
  Mat3 inertia = Mat3::Zero();    // int (x^2 I - xx) dA about the centroid, by M
  Mat3 inertia_inverse = Mat3::Zero();
  double normal_area = 0.0;    // flux of g/A
};

class SurfaceModes {
 public:
  // surface_of_node: n_owned; -1: on none of the closed surfaces. unwrapped: 3 x n_owned, every
  // surface in one piece. areas: n_owned. gradient: 3 x n_owned, dV/dx. elements: of the closed
  // surfaces at least, on n_all nodes; give() fills ghosts. Collective. Throws Error on a surface
  // without extension.
  void set_geometry(const std::vector<int> &surface_of_node, int n_surfaces, PointsView unwrapped,
                    const Eigen::Ref<const Eigen::VectorXd> &areas, PointsView gradient,
                    const SurfaceElements &elements, Eigen::Index n_all, NodeExchange &exchange);

  int n_surfaces() const { return static_cast<int>(surfaces_.size()); }
  const SurfaceGeometry &surface(int s) const { return surfaces_[s]; }
  // Position relative to the centroid of the node's surface, 3 x n_owned; zero on none.
  const Points &relative() const { return relative_; }

  // field: 3 x n_owned. Collective.
  std::vector<SurfaceMotion> compute_motions(PointsView field, NodeExchange &exchange) const;
  // What a motion is at an owned node: its rigid part, and its flux part.
  Vec3 compute_rigid(const SurfaceMotion &motion, Eigen::Index node) const
  {
    return motion.velocity + motion.rotation.cross(relative_.col(node));
  }
  Vec3 compute_normal(const SurfaceMotion &motion, Eigen::Index node) const
  {
    return motion.flux * normals_.col(node);
  }

 private:
  std::vector<int> surface_of_node_;
  std::vector<SurfaceGeometry> surfaces_;
  Points relative_, mass_relative_;    // x - centroid, M (x - centroid)
  Points gradient_, normals_;          // g, g/A
  Eigen::VectorXd areas_;
};

}    // namespace biem

#endif
