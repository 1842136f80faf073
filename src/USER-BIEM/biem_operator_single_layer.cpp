// Single layer: see the header.
#include "biem_operator_single_layer.h"
#include "biem_cpu_clock.h"

namespace biem {

namespace {

// Sources of the far rule: owned nodes on a surface, then one interior point per element.
struct FarSources {
  std::vector<int> node;    // owned node of each of the first sources
  Points points, strengths;
};

FarSources make_far_sources(const SurfaceShare &s, PointsView density)
{
  FarSources far;
  for (int i = 0; i < s.n_owned; i++)
    if (s.areas[i] > 0.0) far.node.push_back(i);
  const auto n_nodes = static_cast<Eigen::Index>(far.node.size());
  const Eigen::Index n_elements = s.elements.n_elements();
  far.points.resize(3, n_nodes + n_elements);
  far.strengths.resize(3, n_nodes + n_elements);
  for (Eigen::Index k = 0; k < n_nodes; k++) {
    const int i = far.node[k];
    far.points.col(k) = s.nodes.col(i);
    far.strengths.col(k) = s.elements.nodal_fraction() * s.areas[i] * density.col(i);
  }
  s.elements.compute_interior_points(far.points.rightCols(n_elements));
  s.elements.compute_interior_strengths(density, far.strengths.rightCols(n_elements));
  return far;
}

}    // namespace

SingleLayerOperator::SingleLayerOperator(MPI_Comm comm, const EwaldParameters &parameters) :
    sum_(comm, parameters)
{
}

void SingleLayerOperator::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  sum_.set_cell(cell, origin);
}

Points SingleLayerOperator::apply(const SurfaceShare &share, PointsView density,
                                  NodeExchange &exchange)
{
  const Points none(3, 0);
  const FarSources far = make_far_sources(share, density);
  sum_.set_points({share.nodes, share.n_owned, far.points, none, none});
  CpuClock clock;
  Points velocity = Points::Zero(3, share.nodes.cols());
  share.elements.prepare_near(density, none);
  profile_.n_near_pairs =
      add_near_corrections(share.elements, share.candidates, share.nodes, velocity);
  profile_.near += clock.restart();
  sum_.add_layers(Layers::Single, far.strengths, none, exchange, velocity);
  return velocity.leftCols(share.n_owned);
}

OperatorProfile SingleLayerOperator::profile() const
{
  OperatorProfile result = profile_;
  result.sum = sum_.profile();
  return result;
}

}    // namespace biem
