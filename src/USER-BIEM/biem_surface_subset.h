// Some of a configuration's surfaces as sources and some of its nodes as targets: what one operator
// works on. Knows no densities and no kinds of surfaces.
#ifndef BIEM_SURFACE_SUBSET_H
#define BIEM_SURFACE_SUBSET_H

#include "biem_configuration.h"
#include "biem_operator_layers.h"

namespace biem {

class SurfaceSubset {
 public:
  SurfaceSubset();

  // is_source, layers (what the sources carry; empty: all layers): by surface; is_target: by owned
  // node. After every change of the configuration's version. Collective.
  void set_topology(const Configuration &c, const std::vector<char> &is_source,
                    const std::vector<Layers> &layers, const std::vector<char> &is_target,
                    NodeExchange &exchange);
  // After every motion of the nodes. Collective. Throws Error on collapsed elements.
  void set_geometry(const Configuration &c, NodeExchange &exchange);

  // For LayerOperator::set_geometry(); refers to this object and to c.
  SurfaceShare share(const Configuration &c) const;
  const SurfaceElements &elements() const { return *elements_; }
  const std::vector<int> &parents() const { return parents_; }    // triangles of the configuration
  const Eigen::VectorXd &areas() const { return areas_; }         // n_owned; 0 on no source
  const Points &volume_gradient() const { return gradient_; }     // 3 x n_owned, dV/dx

 private:
  std::unique_ptr<SurfaceElements> elements_;
  std::vector<int> parents_;
  std::vector<Triangle> triangles_;
  Points shift_;
  NearCandidates candidates_;
  std::vector<char> is_target_;    // n_all
  std::vector<Layers> element_layers_;
  bool has_layers_ = false;
  Eigen::VectorXd areas_;
  Points gradient_;
};

}    // namespace biem

#endif
