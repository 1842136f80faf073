// Basic types shared by every file of the core: points, triangles, hinges.
// Knows nothing of LAMMPS, MPI or of any physics.
#ifndef BIEM_TYPES_H
#define BIEM_TYPES_H

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace biem {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// 3 x n, one point (or vector) per column; contiguous as x0 y0 z0 x1 y1 z1 ...
using Points = Eigen::Matrix3Xd;
using PointsView = Eigen::Ref<const Eigen::Matrix3Xd>;
using PointsRef = Eigen::Ref<Eigen::Matrix3Xd>;

// What an operator or a sum is made of: single layer, double layer, or both at once.
enum class Layers { Single, Double, Both };
constexpr bool has_single(Layers layers) { return layers != Layers::Double; }
constexpr bool has_double(Layers layers) { return layers != Layers::Single; }

// Three node indices, counter-clockwise seen from outside (from the suspending fluid).
using Triangle = std::array<int, 3>;

// Two triangles that share the edge (b, c): (a, b, c) and (d, c, b), both counter-clockwise from
// outside. LAMMPS stores it as the dihedral a-b-c-d.
struct Hinge {
  int a, b, c, d;
};

}    // namespace biem

#endif
