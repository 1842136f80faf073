// Periodic single and double layers over all surfaces at all nodes,
//   int G(x, y) f(y) dA(y)  and  int T(x, y) : q(y) n(y) dA(y),
// each alone or both in one sum: far rule by the periodic sum, closed form near every element.
// Distributed: each rank brings its nodes and elements. Knows no forces, cells or time.
// Zhao et al. 2012, Eqs. 1 and 5; doc/theory, labels single-layer, double-layer.
#ifndef BIEM_OPERATOR_LAYERS_H
#define BIEM_OPERATOR_LAYERS_H

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
  // Read for a double layer only: the elements' triangles, and what moves each of them (3 x n) to
  // where its closed surface is in one piece.
  const std::vector<Triangle> &triangles;
  PointsView triangle_shift;
  // Only what is wanted is paid for. Leave out the elements of surfaces that are no sources, and
  // give candidates as select_candidates() returns them. Like the next one, given on all ranks or
  // on none. n_all, ghosts as their owners; null: every node is a target.
  const std::vector<char> *is_target = nullptr;
  // What each element carries of the layers that are applied; a node carries what its elements do.
  // Null: all of them.
  const std::vector<Layers> *element_layers = nullptr;
};

// CPU seconds of this rank since construction, and near pairs of the last application.
struct OperatorProfile {
  PeriodicSumProfile sum;
  double near = 0.0;
  long n_near_pairs = 0;
};

// The double layer of (e_1, e_2, e_3) at each owned node, in columns.
using RowSums = std::vector<Mat3>;

class LayerOperator {
 public:
  LayerOperator(MPI_Comm comm, const EwaldParameters &parameters);

  void set_cell(const Mat3 &cell, const Vec3 &origin);
  // layers: all that will be applied to this geometry; a double layer costs its normals and slopes.
  // share's elements and candidates must live until the next call; the views are not kept.
  // Collective.
  void set_geometry(const SurfaceShare &share, Layers layers, NodeExchange &exchange);
  // Densities: 3 x n_all, ghosts filled; not read when layers does not ask for them, nor on
  // surfaces that do not carry them. Returns 3 x n_owned, without the factors 1/(8 pi mu) and
  // 1/(8 pi), zero at nodes that are no targets. At a node of its own surface the
  // double layer is the raw principal value of the faceted surface: see subtract_singularity().
  // Collective.
  Points apply(Layers layers, PointsView single_density, PointsView double_density,
               NodeExchange &exchange);
  // Three applications of the double layer, once per geometry; compute_free_row_sums() is cheaper
  // where a rank has a whole surface. is_closed: n_all, 1 at the nodes of
  // the closed surfaces that carry double layers, 0 elsewhere, ghosts filled. Collective.
  RowSums compute_row_sums(const Eigen::Ref<const Eigen::VectorXd> &is_closed,
                           NodeExchange &exchange);

  const EwaldParameters &parameters() const { return sum_.parameters(); }
  OperatorProfile profile() const;

 private:
  void list_far_nodes(const SurfaceShare &share, NodeExchange &exchange);
  void set_far_points(const SurfaceShare &share, Layers layers, NodeExchange &exchange);
  void compute_far_strengths(Layers layers, PointsView single_density, PointsView double_density);

  PeriodicSum sum_;
  Layers layers_ = Layers::Single;    // of the geometry
  SurfaceElements *elements_ = nullptr;
  const NearCandidates *candidates_ = nullptr;
  Points nodes_;
  int n_owned_ = 0;
  // Sources of the far rule: owned nodes on a surface, then one interior point per element.
  std::vector<int> far_nodes_;
  std::vector<double> far_areas_;    // of the far nodes
  std::vector<char> is_target_;      // n_owned; empty: all
  std::vector<Layers> element_layers_, source_layers_;    // empty: all
  Points forces_, densities_;        // strengths of the sources
  OperatorProfile profile_;
};

// From the raw double layer to D0[q](x) = DL[q - q(x) on the closed surfaces](x): velocities
// (3 x n_owned) -= row sums times density (3 x n_all). On the own surface, periodic images and
// k = 0 term included, this takes away what the corners of the facets do to the principal value:
// D0 of a uniform q is zero, and the principal value of the smooth surface is D0[q] + 4 pi q. The
// row sums of all closed surfaces together are those of the own one, because a target outside of
// the others gets exactly zero from their uniform density; what is subtracted for them is their
// quadrature error times q(x), measured below 6e-4 of 8 pi q at any gap. To keep that small, leave
// rigid motions out of q: D0 of a rigid motion of each surface is zero. At a point on no surface
// (q = 0) nothing is subtracted.
void subtract_singularity(const RowSums &row_sums, PointsView density, PointsRef velocities);

}    // namespace biem

#endif
