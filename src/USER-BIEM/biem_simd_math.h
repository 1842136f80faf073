// Functions of packs: sum, roots; logarithm and arctangent, branch free, to about two units in the
// last place.
// Knows no physics.
#ifndef BIEM_SIMD_MATH_H
#define BIEM_SIMD_MATH_H

#include "biem_simd.h"

namespace biem {

BIEM_INLINE double sum(Pack v)
{
#ifdef BIEM_SIMD_AVX512
  return _mm512_reduce_add_pd(v);
#else
  double total = 0.0;
  for (int l = 0; l < kLanes; l++)
    total += v[l];
  return total;
#endif
}

BIEM_INLINE Pack square_root(Pack v)
{
#if defined(BIEM_SIMD_AVX512)
  return _mm512_sqrt_pd(v);
#elif defined(__AVX2__)
  return _mm256_sqrt_pd(v);
#else
  for (int l = 0; l < kLanes; l++)
    v[l] = std::sqrt(v[l]);
  return v;
#endif
}

// 1/sqrt(v) to rounding error of a few units; v > 0 (0 gives no number).
BIEM_INLINE Pack inverse_square_root(Pack v)
{
#ifdef BIEM_SIMD_AVX512
  Pack y = _mm512_rsqrt14_pd(v);    // two Newton steps: 14, 28, 53 bits
  const Pack half = 0.5 * v;
  y = y * (1.5 - half * y * y);
  return y * (1.5 - half * y * y);
#else
  return 1.0 / square_root(v);
#endif
}

typedef unsigned long long BitPack __attribute__((vector_size(8 * kLanes)));

// sum over k = 1 ... n_terms of z^k/(2k+1): atanh(f) = f + f S(f^2), atan(f) = f + f S(-f^2).
template <int n_terms> BIEM_INLINE Pack sum_inverse_tangent_series(Pack z)
{
  Pack total = broadcast(1.0 / (2 * n_terms + 1));
#pragma GCC unroll 16
  for (int k = n_terms - 1; k > 0; k--)
    total = total * z + 1.0 / (2 * k + 1);
  return total * z;
}

// 2^52 + the biased exponent of v > 0: the difference of two of them is exact.
BIEM_INLINE Pack shifted_exponent(Pack v)
{
  constexpr unsigned long long kTwoTo52 = 0x4330000000000000ULL;
  return reinterpret_cast<Pack>((reinterpret_cast<BitPack>(v) >> 52) | kTwoTo52);
}

// The significand of v > 0, in [1, 2).
BIEM_INLINE Pack significand(Pack v)
{
  constexpr unsigned long long kDigits = 0x000fffffffffffffULL, kOne = 0x3ff0000000000000ULL;
  return reinterpret_cast<Pack>((reinterpret_cast<BitPack>(v) & kDigits) | kOne);
}

// ln(numerator/denominator) for positive normal numbers; the quotient itself may overflow.
// With a/b the ratio of the significands, brought into [1/sqrt 2, sqrt 2]:
// ln = e ln 2 + 2 atanh f, f = (a - b)/(a + b), where a - b is exact and f^2 < 0.0295.
BIEM_INLINE Pack log_ratio(Pack numerator, Pack denominator)
{
  constexpr double kRoot2 = 1.4142135623730951;
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;    // short enough that e * high is exact
  constexpr double kLn2Low = 0x1.ef35793c76730p-45;    // ln 2 - high
  Pack a = significand(numerator), b = significand(denominator);
  Pack e = shifted_exponent(numerator) - shifted_exponent(denominator);
  const Mask above = less(kRoot2 * b, a), below = less(kRoot2 * a, b);
  e += select(above, broadcast(1.0), select(below, broadcast(-1.0), Pack{}));
  a = select(above, 0.5 * a, a);
  b = select(below, 0.5 * b, b);
  const Pack f = (a - b) / (a + b), twice = f + f;
  return e * kLn2High + (twice + (twice * sum_inverse_tangent_series<9>(f * f) + e * kLn2Low));
}

// atan2(y, x) for finite y >= 0 and finite x, in [0, pi]; 0 at the origin.
// The smaller of y and |x| over the larger, t in [0, 1], is turned back by the nearest of atan 0,
// atan 1/2 and atan 1: f = (t - c)/(1 + c t), f^2 < 0.068.
// With c = 1/2 from t = 0.26 on, no result loses digits against atan 1/2.
BIEM_INLINE Pack upper_arctangent(Pack y, Pack x)
{
  constexpr double kAtanHalf = 0.46364760900080609, kHalfPi = 1.5707963267948966;
  const Pack width = absolute(x), zero = {}, one = broadcast(1.0);
  const Mask steep = less(width, y), left = less(x, zero);
  const Pack small = select(steep, width, y), large = select(steep, y, width);
  const Mask beyond_zero = less(0.26 * large, small);

  const Mask beyond_half = less(0.72 * large, small);
  const Pack c = select(beyond_half, one, select(beyond_zero, 0.5 * one, zero));
  Pack angle = select(beyond_half, broadcast(0.5 * kHalfPi), broadcast(kAtanHalf));
  angle = select(beyond_zero, angle, zero);
  angle = select(steep, kHalfPi - angle, angle);    // reflections of the nearest angle, and of f
  angle = select(left, 2.0 * kHalfPi - angle, angle);
  Pack f = (small - c * large) / select(less(zero, large), large + c * small, one);
  f = select(steep, -f, f);
  f = select(left, -f, f);
  return angle + (f + f * sum_inverse_tangent_series<13>(-f * f));
}

}    // namespace biem

#endif
