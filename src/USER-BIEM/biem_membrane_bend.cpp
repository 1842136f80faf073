// Bending of the membrane: discrete hinge energy of Zhao et al. 2012, Eq. 10.
// Knows one hinge; neither meshes nor LAMMPS.
#include "biem_membrane_bend.h"

#include "biem_error.h"

#include <cmath>
#include <sstream>

namespace biem {

namespace {

struct HingeGeometry {
  Vec3 edge;                  // from b to c
  Vec3 normal_a, normal_d;    // outward, length = twice the triangle's area
  double cosine, sine;        // of the dihedral angle
};

HingeGeometry compute_geometry(const HingeNodes &p)
{
  HingeGeometry hinge;
  hinge.edge = p[2] - p[1];
  hinge.normal_a = (p[1] - p[0]).cross(p[2] - p[0]);
  hinge.normal_d = (p[2] - p[3]).cross(p[1] - p[3]);
  const double scale = 1.0 / (hinge.normal_a.norm() * hinge.normal_d.norm());
  hinge.cosine = hinge.normal_a.dot(hinge.normal_d) * scale;
  hinge.sine = hinge.normal_a.cross(hinge.normal_d).dot(hinge.edge) / hinge.edge.norm() * scale;
  return hinge;
}

[[noreturn]] void refuse(const char *name, double value, const char *condition)
{
  std::ostringstream message;
  message << "bending law: the " << name << " is " << value << "; it must be " << condition;
  throw Error(message.str());
}

}    // namespace

double compute_sphere_angle(int n_triangles)
{
  if (n_triangles < 4)
    throw Error("bending law: a closed surface has at least 4 triangles, this one has " +
                std::to_string(n_triangles));
  return std::sqrt(16.0 * M_PI / (3.0 * std::sqrt(3.0) * n_triangles));
}

double compute_hinge_angle(const HingeNodes &nodes)
{
  const HingeGeometry hinge = compute_geometry(nodes);
  return std::atan2(hinge.sine, hinge.cosine);
}

HingeLaw::HingeLaw(double bending_modulus, double spontaneous_angle) :
    // 2/sqrt(3), not 2 sqrt(3): on a cylinder of equilateral triangles the sum of
    // c (1 - cos beta) has the bending modulus (sqrt(3)/2) c
    coefficient_(2.0 / std::sqrt(3.0) * bending_modulus),
    cos_angle_(std::cos(spontaneous_angle)), sin_angle_(std::sin(spontaneous_angle))
{
  if (!(bending_modulus >= 0.0) || !std::isfinite(bending_modulus))
    refuse("bending modulus EB", bending_modulus, "zero or positive, and finite");
  if (!(std::fabs(spontaneous_angle) < M_PI))
    refuse("spontaneous angle beta0 in radian", spontaneous_angle, "between -pi and pi");
}

HingeResponse HingeLaw::compute_response(const HingeNodes &p) const
{
  const HingeGeometry hinge = compute_geometry(p);
  const double cosine = hinge.cosine * cos_angle_ + hinge.sine * sin_angle_;    // of beta - beta0
  const double sine = hinge.sine * cos_angle_ - hinge.cosine * sin_angle_;

  HingeResponse response;
  // the first form has no cancellation near the minimum, the second none near a folded hinge
  const double one_minus_cosine = cosine > 0.0 ? sine * sine / (1.0 + cosine) : 1.0 - cosine;
  response.energy = coefficient_ * one_minus_cosine;

  // d(beta)/da = -|edge| n_a/|n_a|^2, likewise for d; b and c share what makes the sum and the
  // torque vanish, split at the feet of the two heights. No division by sin(beta).
  const double slope = coefficient_ * sine;
  const double length_squared = hinge.edge.squaredNorm(), length = std::sqrt(length_squared);
  const Vec3 force_a = slope * length / hinge.normal_a.squaredNorm() * hinge.normal_a;
  const Vec3 force_d = slope * length / hinge.normal_d.squaredNorm() * hinge.normal_d;
  const double foot_a = (p[0] - p[1]).dot(hinge.edge) / length_squared;
  const double foot_d = (p[3] - p[1]).dot(hinge.edge) / length_squared;
  response.force[0] = force_a;
  response.force[1] = -(1.0 - foot_a) * force_a - (1.0 - foot_d) * force_d;
  response.force[2] = -foot_a * force_a - foot_d * force_d;
  response.force[3] = force_d;
  return response;
}

}    // namespace biem
