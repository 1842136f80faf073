// In-plane elasticity of the red cell membrane: the Skalak law in the form of Zhao et al. 2012,
// Eq. 7.
// Knows the strain invariants only; the triangle they belong to is in biem_membrane_triangle.h.
#ifndef BIEM_MEMBRANE_SKALAK_H
#define BIEM_MEMBRANE_SKALAK_H

#include "biem_membrane_triangle.h"

namespace biem {

// W = ES/2 (I1^2/2 + I1 - I2) + ED/8 I2^2 per reference area. Small strains: shear modulus ES,
// area modulus ES + ED, surface Poisson ratio ED/(2 ES + ED); C = ED/(2 ES) in capsule texts.
class SkalakLaw {
 public:
  // ES > 0 and ED >= 0, force/length (= energy/length^2).
  SkalakLaw(double shear_modulus, double dilatation_modulus);

  EnergyDensity compute_density(double i1, double i2) const;

 private:
  double shear_modulus_, dilatation_modulus_;
};

// Energy and nodal forces of one triangle.
TriangleResponse compute_skalak_response(const SkalakLaw &law, const ReferenceTriangle &reference,
                                         const TriangleNodes &nodes);

}    // namespace biem

#endif
