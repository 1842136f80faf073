// The periodic single layer int G(x, y) f(y) dA(y) over all surfaces at all nodes: far rule by
// SPME, closed form near every element. Distributed: each rank brings its nodes and elements. Knows
// no forces, cells or time. Zhao et al. 2012, Eq. 1; doc/theory, label single-layer.
#ifndef BIEM_OPERATOR_SINGLE_LAYER_H
#define BIEM_OPERATOR_SINGLE_LAYER_H

#include "biem_ewald_sum.h"
#include "biem_near_correction.h"
#include <mpi.h>

namespace biem {

// One rank's share of the surfaces in one configuration. Elements index into nodes and are on
// exactly one rank each; ghosts reach at least cutoff + longest edge around the owned nodes.
struct SurfaceShare {
  PointsView nodes;    // 3 x n_all: owned first, then ghosts
  int n_owned;
  SurfaceElements &elements;
  const NearCandidates &candidates;
  Eigen::Ref<const Eigen::VectorXd> areas;    // n_owned nodal areas; 0 for points on no surface
};

// CPU seconds of this rank since construction, and near pairs of the last application.
struct OperatorProfile {
  PeriodicSumProfile sum;
  double near = 0.0;
  long n_near_pairs = 0;
};

class SingleLayerOperator {
 public:
  SingleLayerOperator(MPI_Comm comm, const EwaldParameters &parameters);

  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // density: 3 x n_all, ghosts filled. Returns 3 x n_owned, without the factor 1/(8 pi mu).
  Points apply(const SurfaceShare &share, PointsView density, NodeExchange &exchange);

  const EwaldParameters &parameters() const { return sum_.parameters(); }
  OperatorProfile profile() const;

 private:
  PeriodicSum sum_;
  OperatorProfile profile_;
};

}    // namespace biem

#endif
