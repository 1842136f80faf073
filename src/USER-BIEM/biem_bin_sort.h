// Counting sort of points into bins. Knows not what the bins are.
#ifndef BIEM_BIN_SORT_H
#define BIEM_BIN_SORT_H

#include <vector>

namespace biem {

// Points of bin b: order[start[b]] ... order[start[b + 1] - 1], in their own order.
inline void sort_into_bins(const std::vector<int> &bin_of_point, int n_bins,
                           std::vector<int> &start, std::vector<int> &order)
{
  const int n = static_cast<int>(bin_of_point.size());
  start.assign(n_bins + 1, 0);
  for (int b : bin_of_point)
    start[b + 1]++;
  for (int b = 0; b < n_bins; b++)
    start[b + 1] += start[b];
  order.resize(n);
  for (int i = 0; i < n; i++)    // moves every start to the next bin's
    order[start[bin_of_point[i]]++] = i;
  for (int b = n_bins; b > 0; b--)
    start[b] = start[b - 1];
  start[0] = 0;
}

}    // namespace biem

#endif
