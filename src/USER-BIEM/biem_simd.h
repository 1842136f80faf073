// Packs of doubles in one source for AVX-512 (8), AVX2 (4) and anything else (2): the width follows
// from the compiler's target. Arithmetic and literals work through the compiler's vector extension.
// Knows no physics.
#ifndef BIEM_SIMD_H
#define BIEM_SIMD_H

#include <cmath>
#include <cstddef>
#include <cstring>
#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace biem {

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define BIEM_SIMD_AVX512
constexpr int kLanes = 8;
#elif defined(__AVX2__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif

typedef double Pack __attribute__((vector_size(8 * kLanes)));
typedef long long IntPack __attribute__((vector_size(8 * kLanes)));
#ifdef BIEM_SIMD_AVX512
using Mask = __mmask8;
#else
using Mask = IntPack;    // -1 where true
#endif

#define BIEM_INLINE inline __attribute__((always_inline))

// n rounded up to whole packs.
constexpr int round_up_to_packs(int n)
{
  return (n + kLanes - 1) / kLanes * kLanes;
}

BIEM_INLINE Pack load(const double *p)
{
  Pack v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

BIEM_INLINE void store(double *p, Pack v)
{
  std::memcpy(p, &v, sizeof(v));
}

BIEM_INLINE Pack broadcast(double x)
{
  return x - Pack{};
}

BIEM_INLINE Mask less(Pack a, Pack b)
{
#ifdef BIEM_SIMD_AVX512
  return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
#else
  return a < b;
#endif
}

// True in lanes 0 ... n-1.
BIEM_INLINE Mask first_lanes(int n)
{
#ifdef BIEM_SIMD_AVX512
  return static_cast<Mask>(n >= kLanes ? 0xff : (1 << n) - 1);
#else
  Mask m;
  for (int l = 0; l < kLanes; l++)
    m[l] = l < n ? -1 : 0;
  return m;
#endif
}

BIEM_INLINE Pack select(Mask m, Pack a, Pack b)
{
#ifdef BIEM_SIMD_AVX512
  return _mm512_mask_blend_pd(m, b, a);
#else
  return m ? a : b;
#endif
}

BIEM_INLINE int count(Mask m)
{
#ifdef BIEM_SIMD_AVX512
  return __builtin_popcount(m);
#else
  int n = 0;
  for (int l = 0; l < kLanes; l++)
    n -= static_cast<int>(m[l]);
  return n;
#endif
}

BIEM_INLINE bool any(Mask m)
{
#if defined(BIEM_SIMD_AVX512)
  return m != 0;
#elif defined(__AVX2__)
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(m)) != 0;
#else
  return count(m) != 0;
#endif
}

BIEM_INLINE Pack absolute(Pack v)
{
  return reinterpret_cast<Pack>(reinterpret_cast<IntPack>(v) & 0x7fffffffffffffffLL);
}

}    // namespace biem

#endif
