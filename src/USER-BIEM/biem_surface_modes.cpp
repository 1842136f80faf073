// Modes of closed surfaces: see the header.
#include "biem_surface_modes.h"
#include "biem_error.h"

namespace biem {

namespace {

// The nodes' sums of one surface, added over all ranks.
template <int n_values> class SurfaceSums {
 public:
  explicit SurfaceSums(int n_surfaces) : values_(static_cast<size_t>(n_surfaces) * n_values, 0.0) {}
  double *operator[](int surface) { return &values_[static_cast<size_t>(surface) * n_values]; }
  Eigen::Map<Vec3> vector(int surface, int first)
  {
    return Eigen::Map<Vec3>((*this)[surface] + first);
  }
  void add_over_ranks(NodeExchange &exchange)
  {
    exchange.sum(values_.data(), static_cast<int>(values_.size()));
  }

 private:
  std::vector<double> values_;
};

}    // namespace

void SurfaceModes::set_geometry(const std::vector<int> &surface_of_node, int n_surfaces,
                                PointsView unwrapped,
                                const Eigen::Ref<const Eigen::VectorXd> &areas, PointsView gradient,
                                const SurfaceElements &elements, Eigen::Index n_all,
                                NodeExchange &exchange)
{
  const auto n = static_cast<Eigen::Index>(surface_of_node.size());
  surface_of_node_ = surface_of_node;
  surfaces_.assign(n_surfaces, SurfaceGeometry());
  areas_ = areas;
  gradient_ = gradient;
  normals_ = Points::Zero(3, n);
  relative_ = Points::Zero(3, n);

  SurfaceSums<5> first(n_surfaces);    // area, area times position, flux of the normals
  for (Eigen::Index i = 0; i < n; i++) {
    const int s = surface_of_node[i];
    if (s < 0) continue;
    normals_.col(i) = gradient.col(i) / areas[i];
    first[s][0] += areas[i];
    first.vector(s, 1) += areas[i] * unwrapped.col(i);
    first[s][4] += gradient.col(i).dot(normals_.col(i));
  }
  first.add_over_ranks(exchange);
  for (int s = 0; s < n_surfaces; s++) {
    surfaces_[s].area = first[s][0];
    if (first[s][0] > 0.0) surfaces_[s].centroid = first.vector(s, 1) / first[s][0];
    surfaces_[s].normal_area = first[s][4];
  }

  Points all = Points::Zero(3, n_all), product = Points::Zero(3, n_all);
  for (Eigen::Index i = 0; i < n; i++)
    if (surface_of_node[i] >= 0)
      relative_.col(i) = unwrapped.col(i) - surfaces_[surface_of_node[i]].centroid;
  all.leftCols(n) = relative_;
  exchange.forward(all.data(), 3);
  elements.add_mass_product(all, product);
  exchange.reverse_add(product.data(), 3);
  mass_relative_ = product.leftCols(n);

  SurfaceSums<9> second(n_surfaces);
  for (Eigen::Index i = 0; i < n; i++) {
    const int s = surface_of_node[i];
    if (s < 0) continue;
    const Vec3 x = relative_.col(i), mx = mass_relative_.col(i);
    Eigen::Map<Mat3>(second[s]) +=
        x.dot(mx) * Mat3::Identity() - 0.5 * (x * mx.transpose() + mx * x.transpose());
  }
  second.add_over_ranks(exchange);
  for (int s = 0; s < n_surfaces; s++) {
    SurfaceGeometry &surface = surfaces_[s];
    if (!(surface.area > 0.0)) continue;
    surface.inertia = Eigen::Map<Mat3>(second[s]);
    bool is_regular = false;
    surface.inertia.computeInverseWithCheck(surface.inertia_inverse, is_regular, 0.0);
    if (!is_regular || !surface.inertia_inverse.allFinite())
      throw Error("surface " + std::to_string(s + 1) +
                  " has no extension: its moments of area are singular; check its nodes");
  }
}

std::vector<SurfaceMotion> SurfaceModes::compute_motions(PointsView field,
                                                         NodeExchange &exchange) const
{
  SurfaceSums<7> sums(n_surfaces());
  for (size_t i = 0; i < surface_of_node_.size(); i++) {
    const int s = surface_of_node_[i];
    if (s < 0) continue;
    const Vec3 u = field.col(i);
    sums.vector(s, 0) += areas_[i] * u;
    sums.vector(s, 3) += Vec3(mass_relative_.col(i)).cross(u);
    sums[s][6] += gradient_.col(i).dot(u);
  }
  sums.add_over_ranks(exchange);
  std::vector<SurfaceMotion> motions(surfaces_.size());
  for (int s = 0; s < n_surfaces(); s++) {
    const SurfaceGeometry &surface = surfaces_[s];
    if (!(surface.area > 0.0)) continue;
    motions[s].velocity = sums.vector(s, 0) / surface.area;
    motions[s].rotation = surface.inertia_inverse * sums.vector(s, 3);
    motions[s].flux = sums[s][6] / surface.normal_area;
  }
  return motions;
}

}    // namespace biem
