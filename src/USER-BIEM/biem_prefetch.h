// Fetching ahead of use: points come in any order, and a loop over them in the order of the grid or
// of search cells would wait for memory at every step. Knows nothing else.
#ifndef BIEM_PREFETCH_H
#define BIEM_PREFETCH_H

#include <cstddef>
#include <vector>

namespace biem {

// Starts to fetch the column (three doubles) of a later entry of order than the i-th.
inline void fetch_ahead(const double *columns, const std::vector<int> &order, size_t i)
{
  constexpr size_t kAhead = 16;
  if (i + kAhead < order.size()) __builtin_prefetch(columns + 3 * order[i + kAhead]);
}

}    // namespace biem

#endif
