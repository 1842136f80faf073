// Repulsive pressure between two surfaces as a function of their distance: pure formulas.
// Does not know how distances are found.
#ifndef BIEM_CONTACT_LAW_H
#define BIEM_CONTACT_LAW_H

namespace biem {

struct ContactResponse {
  double pressure;    // pushes the surfaces apart, force/area
  double energy;      // minus its integral over the distance, energy/area
};

// p(d) = k (delta/d - 1) for d < delta, which diverges at contact; below a small distance, and
// where the surfaces penetrate (d < 0), it goes on along its tangent, so that it stays finite.
class ContactLaw {
 public:
  // stiffness k: force/area, >= 0; range delta: length, > 0
  ContactLaw(double stiffness, double range);

  // distance: length, negative where a node is behind the surface
  ContactResponse compute_response(double distance) const;

  // Where the tangent takes over, as a fraction of the range.
  static constexpr double kTangentFraction = 0.02;

 private:
  double stiffness_, range_;
};

}    // namespace biem

#endif
