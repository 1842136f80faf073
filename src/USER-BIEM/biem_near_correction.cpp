// Near pairs: see the header.
#include "biem_near_correction.h"
#include <algorithm>
#include <numeric>

namespace biem {

namespace {
double reach(const SurfaceElements &elements, int e)
{
  return kNearFactor * elements.mean_edge(e);
}
}    // namespace

NearCandidates find_near_candidates(const SurfaceElements &elements, PointsView nodes)
{
  const int n = static_cast<int>(nodes.cols());
  std::vector<int> all(n), found(n);
  std::iota(all.begin(), all.end(), 0);
  NearCandidates candidates;
  candidates.start.push_back(0);
  for (int e = 0; e < elements.n_elements(); e++) {
    const int n_found =
        elements.find_within(e, reach(elements, e), all.data(), n, nodes, found.data());
    candidates.node.insert(candidates.node.end(), found.begin(), found.begin() + n_found);
    candidates.start.push_back(static_cast<int>(candidates.node.size()));
  }
  return candidates;
}

NearCandidates select_candidates(const NearCandidates &candidates, const std::vector<int> &elements,
                                 const std::vector<char> *is_target)
{
  size_t n_most = 0;
  for (int e : elements)
    n_most += candidates.start[e + 1] - candidates.start[e];
  NearCandidates selected;
  selected.start.reserve(elements.size() + 1);
  selected.start.push_back(0);
  selected.node.resize(n_most + 1);    // written always and kept if a target: no branch
  int n = 0;
  for (int e : elements) {
    for (int k = candidates.start[e]; k < candidates.start[e + 1]; k++) {
      const int node = candidates.node[k];
      selected.node[n] = node;
      n += !is_target || (*is_target)[node];
    }
    selected.start.push_back(n);
  }
  selected.node.resize(n);
  return selected;
}

long add_near_corrections(const SurfaceElements &elements, const NearCandidates &candidates,
                          PointsView nodes, PointsRef velocities)
{
  long n_pairs = 0;
  std::vector<int> near;
  for (int e = 0; e < elements.n_elements(); e++) {
    const int first = candidates.start[e], n = candidates.start[e + 1] - first;
    if (n == 0 || !elements.has_near(e)) continue;
    near.resize(std::max<size_t>(near.size(), n));
    const int n_near = elements.find_within(e, reach(elements, e), candidates.node.data() + first,
                                            n, nodes, near.data());
    elements.add_near_corrections(e, near.data(), n_near, nodes, velocities);
    n_pairs += n_near;
  }
  return n_pairs;
}

}    // namespace biem
