// Steppers: see the header.
#include "biem_stepper.h"
#include "biem_error.h"

namespace biem {

Stepper parse_stepper(const std::string &name)
{
  if (name == "euler") return Stepper::Euler;
  if (name == "ab2") return Stepper::AdamsBashforth2;
  if (name == "rkc2") return Stepper::RungeKuttaChebyshev2;
  throw Error("unknown stepper '" + name + "': choose rkc2, ab2 or euler");
}

Vec3 compute_displacement(Stepper stepper, const Vec3 &velocity, const Vec3 &previous_velocity,
                          double dt, double previous_dt)
{
  if (stepper == Stepper::Euler || previous_dt <= 0.0) return dt * velocity;
  const double ratio = dt / previous_dt;
  return dt * (velocity + 0.5 * ratio * (velocity - previous_velocity));
}

double stability_limit(Stepper stepper)
{
  return stepper == Stepper::Euler ? 2.0 : 1.0;
}

}    // namespace biem
