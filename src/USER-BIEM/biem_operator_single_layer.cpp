// Single layer: see the header.
#include "biem_operator_single_layer.h"

namespace biem {

namespace {

// Polynomials of the real-space kernel are this much more accurate than the sum itself.
constexpr double kKernelMargin = 0.02;

RealSpaceKernel make_kernel(const EwaldParameters &p)
{
  return make_real_space_kernel(*make_split(p), p.cutoff, kKernelMargin * p.tolerance);
}

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
    parameters_(parameters), real_space_(make_kernel(parameters)), fourier_(comm, parameters),
    truncated_self_(make_split(parameters)->truncated_self(parameters.band_limit))
{
}

void SingleLayerOperator::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  fourier_.set_cell(cell, origin);
}

Points SingleLayerOperator::apply(const SurfaceShare &share, PointsView density,
                                  NodeExchange &exchange)
{
  const FarSources far = make_far_sources(share, density);
  Points velocity = Points::Zero(3, share.nodes.cols());
  const double start = MPI_Wtime();
  real_space_.set_points(share.nodes, far.points);
  real_space_.add_single_layer(far.strengths, velocity);
  const double real_done = MPI_Wtime();
  share.elements.prepare_near(density);
  profile_.n_near_pairs =
      add_near_corrections(share.elements, share.candidates, share.nodes, velocity);
  const double near_done = MPI_Wtime();
  exchange.reverse_add(velocity.data(), 3);
  for (size_t k = 0; k < far.node.size(); k++)
    velocity.col(far.node[k]) += truncated_self_ * far.strengths.col(k);
  Points owned = velocity.leftCols(share.n_owned);
  const double fourier_start = MPI_Wtime();
  fourier_.set_points(far.points, share.nodes.leftCols(share.n_owned));
  fourier_.add_single_layer(far.strengths, owned);
  profile_.real_space += real_done - start;
  profile_.near += near_done - real_done;
  profile_.fourier += MPI_Wtime() - fourier_start;
  profile_.n_real_pairs = real_space_.n_pairs();
  return owned;
}

}    // namespace biem
