// Undisturbed flow that drives the suspension: at rest, uniform mean velocity, or a linear flow.
#ifndef BIEM_FLOW_H
#define BIEM_FLOW_H

#include "biem_types.h"

namespace biem {

// u(x) = mean + gradient x; gradient [1/time], mean [length/time].
struct BackgroundFlow {
  Vec3 mean = Vec3::Zero();
  Mat3 gradient = Mat3::Zero();

  // Simple shear u = (rate z, 0, 0).
  void set_shear(double rate)
  {
    gradient.setZero();
    gradient(0, 2) = rate;
  }
  double shear_rate() const { return gradient(0, 2); }

  Vec3 velocity(const Vec3 &x) const { return mean + gradient * x; }

  // Displacement in dt of a point at x whose own displacement relative to the flow is relative:
  // the flow is integrated by the midpoint, exact for points that only follow a simple shear.
  Vec3 displacement(const Vec3 &x, const Vec3 &relative, double dt) const
  {
    return relative + dt * velocity(x + 0.5 * (relative + dt * mean));
  }
};

}    // namespace biem

#endif
