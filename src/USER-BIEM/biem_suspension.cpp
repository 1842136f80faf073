// One evaluation of the suspension: see the header.
#include "biem_suspension.h"
#include "biem_element_flat.h"
#include "biem_error.h"
#include <cmath>

namespace biem {

Traction parse_traction(const std::string &name)
{
  if (name == "lumped") return Traction::Lumped;
  if (name == "consistent") return Traction::Consistent;
  throw Error("unknown traction '" + name + "': choose lumped or consistent");
}

Suspension::Suspension(MPI_Comm comm, const EwaldParameters &parameters,
                       const SuspensionSettings &settings) :
    settings_(settings),
    layers_(comm, parameters), elements_(std::make_unique<FlatElements>())
{
}

Points Suspension::compute_traction(const Configuration &c, PointsView forces,
                                    const Eigen::VectorXd &areas, NodeExchange &exchange) const
{
  Points density = Points::Zero(3, c.nodes.cols());
  auto divide_by_area = [&](PointsView source, PointsRef target) {
    for (int i = 0; i < c.n_owned; i++)
      if (areas[i] > 0.0) target.col(i) += source.col(i) / areas[i];
  };
  divide_by_area(forces, density);
  exchange.forward(density.data(), 3);
  if (settings_.traction == Traction::Lumped) return density;
  Points product = Points::Zero(3, c.nodes.cols());
  elements_->add_mass_product(density, product);
  exchange.reverse_add(product.data(), 3);
  const Points residual = forces - product.leftCols(c.n_owned);
  divide_by_area(residual, density);
  exchange.forward(density.data(), 3);
  return density;
}

Evaluation Suspension::evaluate(const Configuration &c, PointsView forces, CellVolumes &volumes,
                                NodeExchange &exchange)
{
  elements_->set_geometry(c.nodes, c.triangles);
  const Eigen::Index n_all = c.nodes.cols();
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n_all);
  Points gradient = Points::Zero(3, n_all);
  elements_->add_nodal_areas(areas);
  elements_->add_volume_gradient(gradient);
  exchange.reverse_add(areas.data(), 1);
  exchange.reverse_add(gradient.data(), 3);

  std::fill(volumes.current.begin(), volumes.current.end(), 0.0);
  for (int e = 0; e < elements_->n_elements(); e++)
    volumes.current[c.cell_of_triangle[e]] += elements_->volume(e, -c.triangle_shift.col(e));
  exchange.sum(volumes.current.data(), static_cast<int>(volumes.current.size()));

  Evaluation result;
  result.areas = areas.head(c.n_owned);
  const Points density = compute_traction(c, forces, result.areas, exchange);
  result.traction = density.leftCols(c.n_owned);
  layers_.set_geometry(
      {c.nodes, c.n_owned, *elements_, c.candidates, result.areas, c.triangles, c.triangle_shift},
      Layers::Single, exchange);
  result.velocity = layers_.apply(Layers::Single, density, Points(3, 0), exchange) /
                    (8.0 * M_PI * settings_.viscosity);
  if (!volumes.reference.empty())
    project_volume(c.cell_of_node, gradient.leftCols(c.n_owned), volumes, exchange,
                   result.velocity);
  return result;
}

void project_volume(const std::vector<int> &cell_of_node, PointsView gradient,
                    const CellVolumes &volumes, NodeExchange &exchange, PointsRef velocity)
{
  const size_t n_cells = volumes.reference.size();
  std::vector<double> sums(2 * n_cells, 0.0);    // flux and total |g| of each cell
  const auto n = static_cast<Eigen::Index>(cell_of_node.size());
  for (Eigen::Index i = 0; i < n; i++) {
    const int cell = cell_of_node[i];
    if (cell < 0) continue;
    sums[2 * cell] += velocity.col(i).dot(gradient.col(i));
    sums[2 * cell + 1] += gradient.col(i).norm();
  }
  exchange.sum(sums.data(), static_cast<int>(sums.size()));
  for (Eigen::Index i = 0; i < n; i++) {
    const int cell = cell_of_node[i];
    const double size = gradient.col(i).norm();
    if (cell < 0 || size == 0.0) continue;
    const double wanted =
        volumes.relaxation_rate * (volumes.reference[cell] - volumes.current[cell]);
    const double alpha = (sums[2 * cell] - wanted) / sums[2 * cell + 1];
    velocity.col(i) -= alpha / size * gradient.col(i);
  }
}

}    // namespace biem
