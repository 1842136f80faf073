// Surfaces and points that are already in the periodic cell: distance of a point to them.
// Surfaces may have any shape; knows nothing of the bodies that are being placed.
#ifndef BIEM_MESH_OBSTACLES_H
#define BIEM_MESH_OBSTACLES_H

#include "biem_mesh_lattice.h"
#include "biem_mesh_signed_distance.h"

#include <array>
#include <vector>

namespace biem {

// Whether the straight line from p - arm to p goes through the triangle; corners in columns.
bool is_crossed(const Mat3 &corners, const Vec3 &p, const Vec3 &arm);

class MeshObstacles {
 public:
  // nodes: 3 x n in any periodic images; nodes without a triangle are points with no inside.
  // reach: typical limit of evaluate (length); decides the size of the search bins only.
  // Closed bodies have an inside; all other surfaces (walls), or all where asked, have two sides.
  enum class Sides { FromTopology, Two };
  MeshObstacles(const MeshLattice &lattice, const Points &nodes,
                const std::vector<Triangle> &triangles, double reach,
                Sides sides = Sides::FromTopology);

  const Points &nodes() const { return nodes_; }

  // To the nearest point of the nearest triangle; limit if none is as near. Negative inside, and
  // behind a surface of two sides: where point and point - arm are on different sides of it.
  SignedDistance evaluate(const Vec3 &point, const Vec3 &arm, double limit) const;

  // Whether the straight line from point - arm to point goes through a triangle.
  bool intersects(const Vec3 &point, const Vec3 &arm) const;

  // Indices of the nodes within radius of the point.
  std::vector<int> find_nodes(const Vec3 &point, double radius) const;

  // Whether the point is inside a closed body, however deep. Slow: looks at every triangle.
  bool is_inside(const Vec3 &point) const;

 private:
  struct Facet {
    Vec3 center;
    Mat3 corners;    // relative to the center, one per column
    Mat3 normals;    // at the corners: area-weighted means of the triangles there
    double radius;   // of the sphere about the center that holds the corners
    bool is_body;    // or a surface of two sides
  };
  struct Nearest {
    double distance;
    Vec3 offset;       // from the surface to the point
    Vec3 normal;       // interpolated between the corners
    const Facet *facet;
  };

  void make_facets(const std::vector<Triangle> &triangles, Sides sides);
  void make_bins();
  std::array<int, 3> find_bin(const Vec3 &point) const;
  std::size_t compute_bin_index(const std::array<int, 3> &bin) const;
  template <class Visitor>
  void for_each_bin(const Vec3 &point, double radius, Visitor visit) const;
  void update_nearest(const Facet &facet, const Vec3 &point, Nearest &nearest) const;

  MeshLattice lattice_;
  Points nodes_;
  double largest_radius_, reach_;
  std::vector<Facet> facets_;
  std::array<int, 3> n_bins_;
  std::vector<std::vector<int>> facets_of_bin_, nodes_of_bin_;
};

}    // namespace biem

#endif
