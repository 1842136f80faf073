// Near rule: for targets close to an element, on any surface, the far rule's free-space part is
// replaced by the closed form. Picks the pairs and sums the corrections; the element knows the
// formulas, the caller the candidates (for instance from a neighbor list).
#ifndef BIEM_NEAR_CORRECTION_H
#define BIEM_NEAR_CORRECTION_H

#include "biem_element.h"

namespace biem {

// Elements and the nodes that may be near them: nodes of element e are
// node[start[e]] ... node[start[e + 1] - 1].
struct NearCandidates {
  std::vector<int> start;
  std::vector<int> node;
};

// A target is near an element within this many mean edges of one of its nodes.
constexpr double kNearFactor = 1.5;

// All nodes within reach of an element's nodes, by brute force over all pairs: for tests and small
// problems without a neighbor list.
NearCandidates find_near_candidates(const SurfaceElements &elements, PointsView nodes);

// Candidates of the listed elements, in the list's order, without nodes that are no targets
// (is_target: one for every node; null: all are).
NearCandidates select_candidates(const NearCandidates &candidates, const std::vector<int> &elements,
                                 const std::vector<char> *is_target);

// velocities (3 x n) += corrections at the near candidates; prepare_near() has been called.
// Returns the number of near pairs.
long add_near_corrections(const SurfaceElements &elements, const NearCandidates &candidates,
                          PointsView nodes, PointsRef velocities);

}    // namespace biem

#endif
