// A mesh of walls in the periodic cell and the closed sheets in it: those through which no fluid
// gets. Knows no operator and no physics of the flow.
#ifndef BIEM_MESH_SHEETS_H
#define BIEM_MESH_SHEETS_H

#include "biem_types.h"

namespace biem {

// All walls of a scene, the same on every rank. An edge of a triangle is the shortest image of the
// difference of its nodes, and must be shorter than half the cell along each lattice vector.
struct WallMesh {
  Points nodes;    // 3 x n, at any periodic image
  std::vector<Triangle> triangles;
  Mat3 cell;    // lattice vectors in columns
};

// The mesh; throws Error on a node or a triangle that is not fit for a wall.
const WallMesh &check_wall_mesh(const WallMesh &mesh);

// int dA of the hat functions (n), area.
Eigen::VectorXd compute_nodal_areas(const WallMesh &mesh);

// int n dA of the hat functions (3 x n, area), n the unit normal, for a basis of the closed sheets:
// oriented surfaces without boundary, made of whole triangles. A plane through the cell is one, so
// is a tube along the cell, or a sphere. Walls that cross in a line of common nodes go straight on
// (a duct of two planes has two closed sheets); planes that enclose compartments have one more for
// each of these. An open patch, with a boundary edge, belongs to none. Normals are those of the
// first triangle of each sheet, whatever the others' order of nodes.
std::vector<Points> compute_closed_sheets(const WallMesh &mesh);

}    // namespace biem

#endif
