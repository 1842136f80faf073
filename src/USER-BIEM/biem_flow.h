// Undisturbed flow that drives the suspension: at rest, uniform mean velocity, or simple shear.
#ifndef BIEM_FLOW_H
#define BIEM_FLOW_H

#include "biem_types.h"

namespace biem {

// u(x) = mean + (shear_rate * z, 0, 0); shear_rate [1/time], mean [length/time].
struct BackgroundFlow {
  double shear_rate = 0.0;
  Vec3 mean = Vec3::Zero();

  Vec3 velocity(const Vec3 &x) const { return mean + Vec3(shear_rate * x[2], 0.0, 0.0); }

  // Displacement in dt of a point at x whose own displacement relative to the flow is relative:
  // the shear is integrated by the midpoint of z, exact for points that only follow the flow.
  Vec3 displacement(const Vec3 &x, const Vec3 &relative, double dt) const
  {
    return relative + dt * velocity(x + 0.5 * (relative + dt * mean));
  }
};

}    // namespace biem

#endif
