// Connectivity of triangulated surfaces: hinges, checks, and even storage of angles and dihedrals.
// Knows node indices; positions only where the enclosed volume is asked for.
#ifndef BIEM_MESH_TOPOLOGY_H
#define BIEM_MESH_TOPOLOGY_H

#include "biem_types.h"

#include <vector>

namespace biem {

// One hinge per edge, in the order in which the edges first appear in the triangles.
// The triangles must have passed check_closed_oriented.
std::vector<Hinge> make_hinges(const std::vector<Triangle> &triangles);

// Error unless the triangles form one closed, consistently oriented surface with every node
// 0 <= i < n_nodes in use and no handle. The message names the nodes or edge at fault.
void check_closed_oriented(const std::vector<Triangle> &triangles, int n_nodes);

// The same, and an Error if the enclosed volume is not positive (triangles clockwise from outside).
void check_closed_oriented(const PointsView &nodes, const std::vector<Triangle> &triangles);

// One flag per triangle: 1 if it is part of a closed body (a connected surface with two triangles
// at every edge and no handle), 0 if it is part of a sheet or tube, open or closed through the box.
std::vector<char> find_closed_bodies(const std::vector<Triangle> &triangles, int n_nodes);

// The largest numbers of triangles and hinges whose second node is one and the same node.
struct MiddleNodeLoad {
  int max_triangles, max_hinges;
};

// LAMMPS stores an angle and a dihedral with its second atom. Rotates triangles (keeping their
// orientation) and flips hinges (a,b,c,d) -> (d,c,b,a) so that second nodes are spread evenly:
// on an icosphere at most 2 triangles and 3 hinges per node.
MiddleNodeLoad balance_middle_nodes(std::vector<Triangle> &triangles, std::vector<Hinge> &hinges,
                                    int n_nodes);

}    // namespace biem

#endif
