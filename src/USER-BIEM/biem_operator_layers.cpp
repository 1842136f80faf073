// Single and double layers: see the header.
#include "biem_operator_layers.h"
#include "biem_cpu_clock.h"
#include "biem_error.h"

namespace biem {

namespace {

const Points kNone(3, 0);

// Positions (3 x n_all, owned columns valid) with every closed surface in one piece. Which image of
// its surface a node belongs to is known to its triangles: a corner moved by the triangle's shift
// is the same point for all of them, also if the corner is an image of the node and the triangle is
// on another rank. So the node is where they are in the mean.
Points compute_unwrapped(const SurfaceShare &s, NodeExchange &exchange)
{
  Points corners = Points::Zero(3, s.nodes.cols());
  Eigen::VectorXd n_corners = Eigen::VectorXd::Zero(s.nodes.cols());
  for (size_t e = 0; e < s.triangles.size(); e++)
    for (int i : s.triangles[e]) {
      corners.col(i) += s.nodes.col(i) + s.triangle_shift.col(e);
      n_corners[i] += 1.0;
    }
  exchange.reverse_add(corners.data(), 3);
  exchange.reverse_add(n_corners.data(), 1);
  for (int i = 0; i < s.n_owned; i++)
    if (n_corners[i] > 0.0) corners.col(i) /= n_corners[i];
  return corners;
}

// Elements around each owned node that carry a single layer, and that carry a double layer.
Eigen::Matrix2Xd count_carriers(const SurfaceShare &s, NodeExchange &exchange)
{
  Eigen::Matrix2Xd n = Eigen::Matrix2Xd::Zero(2, s.nodes.cols());
  for (size_t e = 0; e < s.triangles.size(); e++)
    for (int i : s.triangles[e]) {
      n(0, i) += has_single((*s.element_layers)[e]);
      n(1, i) += has_double((*s.element_layers)[e]);
    }
  exchange.reverse_add(n.data(), 2);
  return n;
}

void check_sizes(const SurfaceShare &s)
{
  const auto n_nodes = static_cast<size_t>(s.nodes.cols());
  const auto n_elements = static_cast<size_t>(s.elements.n_elements());
  if (s.is_target && s.is_target->size() != n_nodes)
    throw Error("layer operator: " + std::to_string(s.is_target->size()) +
                " marks of targets were given for " + std::to_string(n_nodes) +
                " nodes; give one for every node, ghosts included, or none");
  if (s.element_layers && (s.element_layers->size() != n_elements ||
                           s.triangles.size() != n_elements))
    throw Error("layer operator: " + std::to_string(n_elements) + " elements come with " +
                std::to_string(s.element_layers->size()) + " layers and " +
                std::to_string(s.triangles.size()) +
                " triangles; give one of each for every element");
  const size_t n_ends = s.candidates.start.empty() ? 0 : s.candidates.start.size() - 1;
  if (n_ends != n_elements)
    throw Error("layer operator: near candidates are given for " + std::to_string(n_ends) +
                " elements, but there are " + std::to_string(n_elements) +
                "; select the candidates of these elements");
}

}    // namespace

LayerOperator::LayerOperator(MPI_Comm comm, const EwaldParameters &parameters) :
    sum_(comm, parameters)
{
}

void LayerOperator::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  sum_.set_cell(cell, origin);
}

void LayerOperator::set_geometry(const SurfaceShare &share, Layers layers, NodeExchange &exchange)
{
  const Eigen::Index n_elements = share.elements.n_elements();
  if (has_double(layers) && (static_cast<Eigen::Index>(share.triangles.size()) != n_elements ||
                             share.triangle_shift.cols() != n_elements))
    throw Error("double layer: " + std::to_string(n_elements) + " elements come with " +
                std::to_string(share.triangles.size()) + " triangles and " +
                std::to_string(share.triangle_shift.cols()) +
                " shifts; give one of each for every element");
  check_sizes(share);
  layers_ = layers;
  elements_ = &share.elements;
  candidates_ = &share.candidates;
  nodes_ = share.nodes;
  n_owned_ = share.n_owned;
  is_target_.clear();
  if (share.is_target)
    is_target_.assign(share.is_target->begin(), share.is_target->begin() + n_owned_);
  element_layers_.clear();
  if (share.element_layers) element_layers_ = *share.element_layers;
  list_far_nodes(share, exchange);
  set_far_points(share, layers, exchange);
}

void LayerOperator::list_far_nodes(const SurfaceShare &s, NodeExchange &exchange)
{
  Eigen::Matrix2Xd carriers;    // elements with a single layer, with a double layer
  if (s.element_layers) carriers = count_carriers(s, exchange);
  far_nodes_.clear();
  far_areas_.clear();
  source_layers_.clear();
  for (int i = 0; i < n_owned_; i++) {
    if (!(s.areas[i] > 0.0)) continue;
    if (s.element_layers) {
      const bool is_single = carriers(0, i) > 0.0, is_double = carriers(1, i) > 0.0;
      if (!is_single && !is_double) continue;
      source_layers_.push_back(!is_double   ? Layers::Single
                               : !is_single ? Layers::Double
                                            : Layers::Both);
    }
    far_nodes_.push_back(i);
    far_areas_.push_back(s.elements.nodal_fraction() * s.areas[i]);
  }
  source_layers_.insert(source_layers_.end(), element_layers_.begin(), element_layers_.end());
}

void LayerOperator::set_far_points(const SurfaceShare &s, Layers layers, NodeExchange &exchange)
{
  const auto n_nodes = static_cast<Eigen::Index>(far_nodes_.size());
  const Eigen::Index n_elements = s.elements.n_elements();
  Points points(3, n_nodes + n_elements);
  for (Eigen::Index k = 0; k < n_nodes; k++)
    points.col(k) = s.nodes.col(far_nodes_[k]);
  s.elements.compute_interior_points(points.rightCols(n_elements));
  const std::vector<Layers> *source_layers = s.element_layers ? &source_layers_ : nullptr;
  if (!has_double(layers)) {
    sum_.set_points({s.nodes, s.n_owned, points, kNone, kNone, s.is_target, source_layers}, layers);
    return;
  }
  Points nodal_normals = Points::Zero(3, s.nodes.cols());
  s.elements.add_nodal_normals(nodal_normals);
  exchange.reverse_add(nodal_normals.data(), 3);    // triangles of an owned node on other ranks
  const Points unwrapped_nodes = compute_unwrapped(s, exchange);
  Points normals(3, points.cols()), unwrapped(3, points.cols());
  for (Eigen::Index k = 0; k < n_nodes; k++) {
    normals.col(k) = nodal_normals.col(far_nodes_[k]);
    unwrapped.col(k) = unwrapped_nodes.col(far_nodes_[k]);
  }
  s.elements.compute_interior_normals(normals.rightCols(n_elements));
  unwrapped.rightCols(n_elements) = points.rightCols(n_elements) + s.triangle_shift;
  sum_.set_points({s.nodes, s.n_owned, points, normals, unwrapped, s.is_target, source_layers},
                  layers);
}

void LayerOperator::compute_far_strengths(Layers layers, PointsView single_density,
                                          PointsView double_density)
{
  const auto n_nodes = static_cast<Eigen::Index>(far_nodes_.size());
  const Eigen::Index n_elements = elements_->n_elements();
  if (has_single(layers)) {
    forces_.resize(3, n_nodes + n_elements);
    for (Eigen::Index k = 0; k < n_nodes; k++)
      forces_.col(k) = far_areas_[k] * single_density.col(far_nodes_[k]);
    elements_->compute_interior_strengths(single_density, forces_.rightCols(n_elements));
  }
  if (has_double(layers)) {
    densities_.resize(3, n_nodes + n_elements);
    for (Eigen::Index k = 0; k < n_nodes; k++)
      densities_.col(k) = double_density.col(far_nodes_[k]);
    elements_->compute_interior_means(double_density, densities_.rightCols(n_elements));
  }
}

Points LayerOperator::apply(Layers layers, PointsView single_density, PointsView double_density,
                            NodeExchange &exchange)
{
  if (!elements_ || (has_single(layers) && !has_single(layers_)) ||
      (has_double(layers) && !has_double(layers_)))
    throw Error("layer operator: a layer was asked for that its geometry was not set for; call "
                "set_geometry() first, with all layers that will be applied");
  compute_far_strengths(layers, single_density, double_density);
  CpuClock clock;
  Points velocity = Points::Zero(3, nodes_.cols());
  elements_->prepare_near(has_single(layers) ? single_density : PointsView(kNone),
                          has_double(layers) ? double_density : PointsView(kNone),
                          element_layers_.empty() ? nullptr : &element_layers_);
  profile_.n_near_pairs = add_near_corrections(*elements_, *candidates_, nodes_, velocity);
  profile_.near += clock.restart();
  sum_.add_layers(layers, forces_, densities_, exchange, velocity);
  for (size_t i = 0; i < is_target_.size(); i++)
    if (!is_target_[i]) velocity.col(i).setZero();
  return velocity.leftCols(n_owned_);
}

RowSums LayerOperator::compute_row_sums(const Eigen::Ref<const Eigen::VectorXd> &is_closed,
                                        NodeExchange &exchange)
{
  RowSums sums(n_owned_);
  for (int j = 0; j < 3; j++) {
    Points density = Points::Zero(3, nodes_.cols());
    density.row(j) = is_closed.transpose();
    const Points velocity = apply(Layers::Double, kNone, density, exchange);
    for (int i = 0; i < n_owned_; i++)
      sums[i].col(j) = velocity.col(i);
  }
  return sums;
}

OperatorProfile LayerOperator::profile() const
{
  OperatorProfile result = profile_;
  result.sum = sum_.profile();
  return result;
}

void subtract_singularity(const RowSums &row_sums, PointsView density, PointsRef velocities)
{
  for (size_t i = 0; i < row_sums.size(); i++)
    velocities.col(i) -= row_sums[i] * density.col(i);
}

}    // namespace biem
