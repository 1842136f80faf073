// Wall meshes in a periodic box: plane sheets, ducts and tubes of lattice nodes that repeat
// themselves under every lattice step along the wall. Knows geometry only: no flow, no LAMMPS.
#ifndef BIEM_MESH_WALL_H
#define BIEM_MESH_WALL_H

#include "biem_mesh_icosphere.h"

namespace biem {

enum class Axis { X = 0, Y = 1, Z = 2 };

// An orthogonal periodic box; walls in a tilted one are an Error.
struct WallBox {
  Mat3 lattice;    // lattice vectors in columns, length
  Vec3 origin;     // lower corner, length
};

// All nodes lie inside the box; triangles may cross its faces: an edge is the shortest image of
// the difference of its nodes. In every function, edge is the largest lattice spacing (length):
// n = ceil(L / edge) nodes along a length L, at least 3, so edge must be below half of L. Every
// lattice cell is cut into two triangles along the same diagonal.

// A sheet normal to the axis at the coordinate, across the whole box. With (a, b, axis) cyclic,
// node i + n_a * j is i steps along a and j along b from the corner of the box. Normals: + axis.
SurfaceMesh make_plane_wall(const WallBox &box, Axis normal, double coordinate, double edge);

// Two sheets along the axis that cross: with (axis, b, c) cyclic, at b = first and at c = second.
// They share the nodes of the line where they cross. Node i + n_axis * line; line 0 is the crossing
// line. Normals: + b and + c.
struct WallDuct {
  Axis axis;
  double first, second;    // length
};
SurfaceMesh make_duct_wall(const WallBox &box, const WallDuct &duct, double edge);

// A circular cylinder along the axis through b = first, c = second, (axis, b, c) cyclic. Node
// i + n_axis * j is i steps along the axis and j around it. The nodes lie slightly outside the
// cylinder, so that the polygon of a cross-section has the area pi radius^2. Normals: away from
// the axis.
struct WallTube {
  Axis axis;
  double first, second;    // length
  double radius;           // length
};
SurfaceMesh make_tube_wall(const WallBox &box, const WallTube &tube, double edge);

// Joins nodes that coincide in the periodic box, to within 1e-6 of the shortest edge, so that a
// mesh from a file that spans the box closes upon itself. Any lattice. Error where two corners of
// one triangle coincide.
SurfaceMesh join_periodic_nodes(const Mat3 &lattice, const SurfaceMesh &mesh);

// Lengths and area of a mesh whose edges are shortest images.
struct WallMeasures {
  double shortest_edge, longest_edge;    // length
  double area;                           // length^2
  int n_open_edges;                      // edges with a single triangle
};
WallMeasures compute_wall_measures(const Mat3 &lattice, const SurfaceMesh &mesh);

}    // namespace biem

#endif
