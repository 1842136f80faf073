// Law of the contact pressure: see the header.
#include "biem_contact_law.h"

#include "biem_error.h"

#include <cmath>
#include <string>

namespace biem {

ContactLaw::ContactLaw(double stiffness, double range) : stiffness_(stiffness), range_(range)
{
  if (!(stiffness >= 0.0) || !std::isfinite(stiffness))
    throw Error("Contact: the stiffness k is " + std::to_string(stiffness) +
                "; it must be zero or positive (force/area)");
  if (!(range > 0.0) || !std::isfinite(range))
    throw Error("Contact: the range delta is " + std::to_string(range) +
                "; it must be positive (length)");
}

ContactResponse ContactLaw::compute_response(double distance) const
{
  if (distance >= range_) return {0.0, 0.0};
  const double tangent = kTangentFraction * range_;
  const double d = distance > tangent ? distance : tangent;
  const double pressure = stiffness_ * (range_ / d - 1.0);
  const double energy = stiffness_ * (range_ * std::log(range_ / d) - (range_ - d));
  const double slope = stiffness_ * range_ / (d * d), beyond = d - distance;
  return {pressure + slope * beyond, energy + (pressure + 0.5 * slope * beyond) * beyond};
}

}    // namespace biem
