// The free-space stresslet T_ijk = -6 r_i r_j r_k/r^5, r = target - source; velocity = T:qn/(8 pi).
// One displacement in, one velocity out; knows nothing of periodicity, loops or surfaces.
#ifndef BIEM_KERNEL_STRESSLET_H
#define BIEM_KERNEL_STRESSLET_H

#include "biem_types.h"
#include <cmath>

namespace biem {

// T_ijk q_j n_k, with n the outward normal: a closed surface of uniform q gives 8 pi q inside.
// Zero at coincident points, whose self part every caller treats itself.
inline Vec3 compute_stresslet(const Vec3 &displacement, const Vec3 &strength, const Vec3 &normal)
{
  const double r2 = displacement.squaredNorm();
  if (r2 == 0.0) return Vec3::Zero();
  const double inverse_r = 1.0 / std::sqrt(r2), inverse_r2 = inverse_r * inverse_r;
  const double product = displacement.dot(strength) * displacement.dot(normal);
  return (-6.0 * product * inverse_r2 * inverse_r2 * inverse_r) * displacement;
}

}    // namespace biem

#endif
