// Subsets of sources and targets: see the header.
#include "biem_surface_subset.h"
#include "biem_element_flat.h"

namespace biem {

SurfaceSubset::SurfaceSubset() : elements_(std::make_unique<FlatElements>()) {}

void SurfaceSubset::set_topology(const Configuration &c, const std::vector<char> &is_source,
                                 const std::vector<Layers> &layers,
                                 const std::vector<char> &is_target, NodeExchange &exchange)
{
  std::vector<double> mask(c.nodes.cols(), 0.0);    // ghosts are targets with their owners
  for (int i = 0; i < c.n_owned; i++)
    mask[i] = is_target[i];
  exchange.forward(mask.data(), 1);
  is_target_.assign(mask.begin(), mask.end());
  has_layers_ = !layers.empty();
  parents_.clear();
  triangles_.clear();
  element_layers_.clear();
  for (size_t e = 0; e < c.triangles.size(); e++) {
    const int s = c.surface_of_triangle[e];
    if (!is_source[s]) continue;
    parents_.push_back(static_cast<int>(e));
    triangles_.push_back(c.triangles[e]);
    if (has_layers_) element_layers_.push_back(layers[s]);
  }
  candidates_ = select_candidates(c.candidates, parents_, &is_target_);
}

void SurfaceSubset::set_geometry(const Configuration &c, NodeExchange &exchange)
{
  const Eigen::Index n_all = c.nodes.cols();
  elements_->set_geometry(c.nodes, triangles_);
  shift_.resize(3, static_cast<Eigen::Index>(parents_.size()));
  for (size_t e = 0; e < parents_.size(); e++)
    shift_.col(e) = c.triangle_shift.col(parents_[e]);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n_all);
  Points gradient = Points::Zero(3, n_all);
  elements_->add_nodal_areas(areas);
  elements_->add_volume_gradient(gradient);
  exchange.reverse_add(areas.data(), 1);
  exchange.reverse_add(gradient.data(), 3);
  areas_ = areas.head(c.n_owned);
  gradient_ = gradient.leftCols(c.n_owned);
}

SurfaceShare SurfaceSubset::share(const Configuration &c) const
{
  return {c.nodes, c.n_owned, *elements_, candidates_, areas_, triangles_, shift_, &is_target_,
          has_layers_ ? &element_layers_ : nullptr};
}

}    // namespace biem
