// Near pairs: see the header.
#include "biem_near_correction.h"

namespace biem {

namespace {
bool is_near(const SurfaceElements &elements, int e, const Vec3 &x)
{
  const double reach = kNearFactor * elements.mean_edge(e);
  return elements.squared_distance(e, x) <= reach * reach;
}
}    // namespace

NearCandidates find_near_candidates(const SurfaceElements &elements, PointsView nodes)
{
  NearCandidates candidates;
  candidates.start.push_back(0);
  for (int e = 0; e < elements.n_elements(); e++) {
    for (int i = 0; i < nodes.cols(); i++)
      if (is_near(elements, e, nodes.col(i))) candidates.node.push_back(i);
    candidates.start.push_back(static_cast<int>(candidates.node.size()));
  }
  return candidates;
}

long add_near_corrections(const SurfaceElements &elements, const NearCandidates &candidates,
                          PointsView nodes, PointsRef velocities)
{
  long n_pairs = 0;
  for (int e = 0; e < elements.n_elements(); e++)
    for (int c = candidates.start[e]; c < candidates.start[e + 1]; c++) {
      const int i = candidates.node[c];
      const Vec3 x = nodes.col(i);
      if (!is_near(elements, e, x)) continue;
      velocities.col(i) += elements.compute_near_correction(e, x);
      n_pairs++;
    }
  return n_pairs;
}

}    // namespace biem
