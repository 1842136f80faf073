// Picking a few of many points in packs: which candidates are close, by a fast test in single
// precision, and their records from memory as packs of channels. Knows no physics.
#ifndef BIEM_SIMD_GATHER_H
#define BIEM_SIMD_GATHER_H

#include "biem_simd.h"

namespace biem {

typedef float FloatPack __attribute__((vector_size(8 * kLanes)));
constexpr int kFloatLanes = 2 * kLanes;

BIEM_INLINE FloatPack load(const float *p)
{
  FloatPack v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}

// Writes index[l] of the lanes l with a[l] < b[l] to out, in order; returns their number. Up to
// kFloatLanes values are written.
BIEM_INLINE int pick_less(FloatPack a, FloatPack b, const int *index, int *out)
{
#ifdef BIEM_SIMD_AVX512
  const __mmask16 mask = _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
  if (!mask) return 0;
  _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(index)));
  return __builtin_popcount(mask);
#else
  int n = 0;
  for (int l = 0; l < kFloatLanes; l++) {
    out[n] = index[l];
    n += a[l] < b[l];
  }
  return n;
#endif
}

// The lanes of v where m is true, in order and in single precision, to p; up to kLanes written.
BIEM_INLINE void compress_store(float *p, Mask m, Pack v)
{
#ifdef BIEM_SIMD_AVX512
  _mm256_storeu_ps(p, _mm512_cvtpd_ps(_mm512_maskz_compress_pd(m, v)));
#else
  int n = 0;
  for (int l = 0; l < kLanes; l++) {
    p[n] = static_cast<float>(v[l]);
    n -= static_cast<int>(m[l]);
  }
#endif
}

// first + l of the lanes l where m is true to p; returns their number. Up to kLanes written.
BIEM_INLINE int compress_store_counted(int *p, Mask m, int first)
{
#ifdef BIEM_SIMD_AVX512
  const __m256i lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i index = _mm256_add_epi32(_mm256_set1_epi32(first), lane);
  _mm256_storeu_si256(reinterpret_cast<__m256i *>(p), _mm256_maskz_compress_epi32(m, index));
  return __builtin_popcount(m);
#else
  int n = 0;
  for (int l = 0; l < kLanes; l++) {
    p[n] = first + l;
    n -= static_cast<int>(m[l]);
  }
  return n;
#endif
}

// Rows to columns of a square of kLanes x kLanes.
BIEM_INLINE void transpose(Pack (&m)[kLanes])
{
#if defined(BIEM_SIMD_AVX512)
  __m512d pair[8], quad[8];
  for (int i = 0; i < 8; i += 2) {
    pair[i] = _mm512_unpacklo_pd(m[i], m[i + 1]);
    pair[i + 1] = _mm512_unpackhi_pd(m[i], m[i + 1]);
  }
  for (int i = 0; i < 8; i += 4)
    for (int j = 0; j < 2; j++) {
      quad[i + j] = _mm512_shuffle_f64x2(pair[i + j], pair[i + j + 2], 0x88);
      quad[i + j + 2] = _mm512_shuffle_f64x2(pair[i + j], pair[i + j + 2], 0xdd);
    }
  for (int j = 0; j < 4; j++) {
    m[j] = _mm512_shuffle_f64x2(quad[j], quad[j + 4], 0x88);
    m[j + 4] = _mm512_shuffle_f64x2(quad[j], quad[j + 4], 0xdd);
  }
#elif defined(__AVX2__)
  const __m256d low01 = _mm256_unpacklo_pd(m[0], m[1]), high01 = _mm256_unpackhi_pd(m[0], m[1]);
  const __m256d low23 = _mm256_unpacklo_pd(m[2], m[3]), high23 = _mm256_unpackhi_pd(m[2], m[3]);
  m[0] = _mm256_permute2f128_pd(low01, low23, 0x20);
  m[1] = _mm256_permute2f128_pd(high01, high23, 0x20);
  m[2] = _mm256_permute2f128_pd(low01, low23, 0x31);
  m[3] = _mm256_permute2f128_pd(high01, high23, 0x31);
#else
  const Pack first = {m[0][0], m[1][0]};
  m[1] = Pack{m[0][1], m[1][1]};
  m[0] = first;
#endif
}

// channels[c][l] = records[size index[l] + c]: kLanes records of size doubles each, size a multiple
// of kLanes.
template <int size>
BIEM_INLINE void load_records(const double *records, const int *index, Pack (&channels)[size])
{
  for (int c = 0; c < size; c += kLanes) {
    Pack square[kLanes];
    for (int l = 0; l < kLanes; l++)
      square[l] = load(records + static_cast<std::ptrdiff_t>(size) * index[l] + c);
    transpose(square);
    for (int l = 0; l < kLanes; l++)
      channels[c + l] = square[l];
  }
}

}    // namespace biem

#endif
