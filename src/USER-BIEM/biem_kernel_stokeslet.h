// The free-space Stokeslet S = I/r + rr/r^3, r = target - source (velocity = S f / (8 pi mu)).
// One displacement in, one velocity out; knows nothing of periodicity, loops or surfaces.
#ifndef BIEM_KERNEL_STOKESLET_H
#define BIEM_KERNEL_STOKESLET_H

#include "biem_types.h"
#include <cmath>

namespace biem {

// S(displacement) * force; zero at coincident points, whose self part every caller treats itself.
inline Vec3 compute_stokeslet(const Vec3 &displacement, const Vec3 &force)
{
  const double r2 = displacement.squaredNorm();
  if (r2 == 0.0) return Vec3::Zero();
  const double inverse_r = 1.0 / std::sqrt(r2);
  return inverse_r * (force + (displacement.dot(force) / r2) * displacement);
}

}    // namespace biem

#endif
