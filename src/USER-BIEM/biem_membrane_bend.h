// Bending of the membrane: discrete hinge energy of Zhao et al. 2012, Eq. 10.
// Knows one hinge (two triangles with a common edge); neither meshes nor LAMMPS.
#ifndef BIEM_MEMBRANE_BEND_H
#define BIEM_MEMBRANE_BEND_H

#include "biem_types.h"

namespace biem {

using HingeNodes = std::array<Vec3, 4>;    // positions a, b, c, d of a biem::Hinge, length

struct HingeResponse {
  double energy;
  std::array<Vec3, 4> force;    // on a, b, c, d; -d(energy)/d(node)
};

// Dihedral angle of the hinges of n_triangles equilateral triangles on a sphere, rad:
// beta0 = sqrt(16 pi / (3 sqrt(3) n_triangles)) (Zhao et al. 2012, below Eq. 10).
double compute_sphere_angle(int n_triangles);

// Angle between the outward normals of the triangles (a,b,c) and (d,c,b), rad, in (-pi, pi]:
// 0 flat, positive where the surface is convex.
double compute_hinge_angle(const HingeNodes &nodes);

// W = (2/sqrt(3)) EB [1 - cos(beta - beta0)] per hinge.
class HingeLaw {
 public:
  // EB >= 0, energy; beta0 in rad.
  HingeLaw(double bending_modulus, double spontaneous_angle);

  // Finite for every angle, folded hinges included; not finite only if a triangle has no area.
  HingeResponse compute_response(const HingeNodes &nodes) const;

 private:
  double coefficient_, cos_angle_, sin_angle_;
};

}    // namespace biem

#endif
