// Where bodies of a packing come too near to each other or to obstacles, and the rigid motions
// that push them apart. Knows one given configuration; the strategy is biem_mesh_packing's.
#ifndef BIEM_MESH_PACKING_CONTACTS_H
#define BIEM_MESH_PACKING_CONTACTS_H

#include "biem_mesh_obstacles.h"
#include "biem_mesh_packing.h"

#include <vector>

namespace biem {

class PackingContacts {
 public:
  enum class Samples { nodes, nodes_and_edges };

  // gap: distance that counts as contact, length. Bodies are sampled at the nodes, and perhaps the
  // midpoints of the edges, of a mesh of n_sample_nodes nodes; scale_to_volume is that of the mesh
  // whose gaps are to be kept.
  struct Setup {
    const Shape *shape;
    int n_sample_nodes;
    Samples samples;
    double scale_to_volume;
    double gap;
  };

  PackingContacts(const Setup &setup, const MeshLattice &lattice,
                  const PackingObstacles &obstacles);

  // Finds all contacts of bodies that have the given fraction of their size (and of the gap).
  void find(const std::vector<RigidPlacement> &bodies, double size);

  // Results of find: the largest penetration into the gap, of all bodies and of one (length).
  double worst() const;
  double worst_of(int body) const { return systems_[body].worst; }

  // Least-squares rigid motions that resolve each body's contacts, with half the way for it.
  void apply_motions(std::vector<RigidPlacement> &bodies, PackingRotation rotation) const;

  const MeshObstacles &obstacles() const { return obstacles_; }
  double bounding_radius() const { return table_.bounding_radius(); }

 private:
  // Normal equations of one body: rows (n, r x n) for a push by the penetration along n at r.
  struct BodySystem {
    Eigen::Matrix<double, 6, 6> matrix;
    Eigen::Matrix<double, 6, 1> right_side;
    double worst;

    void add(const Vec3 &arm, const Vec3 &normal, double penetration);
  };

  void find_between(const std::vector<RigidPlacement> &bodies, int i, int j);
  void find_samples_inside(const RigidPlacement &moved, const RigidPlacement &other, int i, int j);
  void find_with_obstacles(const RigidPlacement &body, int i);
  void update_near_nodes(const Vec3 &center, int i);

  MeshLattice lattice_;
  SignedDistanceTable table_;
  MeshObstacles obstacles_;
  Points samples_;    // in the frame of the body, at full size
  double gap_, size_;
  std::vector<BodySystem> systems_;
  std::vector<std::vector<int>> near_nodes_;    // of each body: obstacle nodes that may touch it
  std::vector<Vec3> near_center_;               // where the body was when they were collected
};

}    // namespace biem

#endif
