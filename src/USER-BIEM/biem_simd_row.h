// A short row of doubles whose length is known to the compiler, in packs of 8, 4 and 2 as the
// processor has them, so that little beyond its end is touched. Knows no physics.
#ifndef BIEM_SIMD_ROW_H
#define BIEM_SIMD_ROW_H

#include "biem_simd.h"

namespace biem {

template <int n_values> class SimdRow {
 public:
  // Values touched: n_values, one more if that is odd.
  static constexpr int kSize = (n_values + 1) / 2 * 2;

  static BIEM_INLINE SimdRow load_from(const double *p)
  {
    SimdRow row;
    row.for_each([p](auto &pack, int at) { std::memcpy(&pack, p + at, sizeof(pack)); });
    return row;
  }

  BIEM_INLINE void store_to(double *p) const
  {
    for_each([p](const auto &pack, int at) { std::memcpy(p + at, &pack, sizeof(pack)); });
  }

  // *this += factor other
  BIEM_INLINE void add(double factor, const SimdRow &other)
  {
    for (int i = 0; i < kEights; i++)
      eight_[i] += factor * other.eight_[i];
    for (int i = 0; i < kFours; i++)
      four_[i] += factor * other.four_[i];
    for (int i = 0; i < kTwos; i++)
      two_[i] += factor * other.two_[i];
  }

 private:
  typedef double Eight __attribute__((vector_size(64)));
  typedef double Four __attribute__((vector_size(32)));
  typedef double Two __attribute__((vector_size(16)));
  static constexpr int kEights = kLanes >= 8 ? kSize / 8 : 0;
  static constexpr int kFours = kLanes >= 4 ? (kSize - 8 * kEights) / 4 : 0;
  static constexpr int kTwos = (kSize - 8 * kEights - 4 * kFours) / 2;

  template <class Action> BIEM_INLINE void for_each(const Action &action)
  {
    for (int i = 0; i < kEights; i++)
      action(eight_[i], 8 * i);
    for (int i = 0; i < kFours; i++)
      action(four_[i], 8 * kEights + 4 * i);
    for (int i = 0; i < kTwos; i++)
      action(two_[i], 8 * kEights + 4 * kFours + 2 * i);
  }
  template <class Action> BIEM_INLINE void for_each(const Action &action) const
  {
    const_cast<SimdRow *>(this)->for_each(action);
  }

  Eight eight_[kEights > 0 ? kEights : 1];
  Four four_[kFours > 0 ? kFours : 1];
  Two two_[kTwos > 0 ? kTwos : 1];
};

}    // namespace biem

#endif
