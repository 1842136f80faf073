// In-plane elasticity of the red cell membrane: the Skalak law.
// Knows the strain invariants only.
#include "biem_membrane_skalak.h"

#include "biem_error.h"

#include <cmath>
#include <sstream>

namespace biem {

namespace {

[[noreturn]] void refuse(const char *name, double value, const char *condition)
{
  std::ostringstream message;
  message << "Skalak law: the " << name << " is " << value << "; it must be " << condition;
  throw Error(message.str());
}

}    // namespace

SkalakLaw::SkalakLaw(double shear_modulus, double dilatation_modulus) :
    shear_modulus_(shear_modulus), dilatation_modulus_(dilatation_modulus)
{
  if (!(shear_modulus > 0.0) || !std::isfinite(shear_modulus))
    refuse("shear modulus ES", shear_modulus, "positive and finite (it keeps the mesh together)");
  if (!(dilatation_modulus >= 0.0) || !std::isfinite(dilatation_modulus))
    refuse("dilatation modulus ED", dilatation_modulus, "zero or positive, and finite");
}

EnergyDensity SkalakLaw::compute_density(double i1, double i2) const
{
  EnergyDensity density;
  density.value = 0.5 * shear_modulus_ * (0.5 * i1 * i1 + i1 - i2) +
      0.125 * dilatation_modulus_ * i2 * i2;
  density.dI1 = 0.5 * shear_modulus_ * (i1 + 1.0);
  density.dI2 = -0.5 * shear_modulus_ + 0.25 * dilatation_modulus_ * i2;
  return density;
}

TriangleResponse compute_skalak_response(const SkalakLaw &law, const ReferenceTriangle &reference,
                                         const TriangleNodes &nodes)
{
  return compute_triangle_response(law, reference, nodes);
}

}    // namespace biem
