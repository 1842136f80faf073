// One evaluation of the scene: see the header.
#include "biem_suspension.h"
#include "biem_error.h"
#include <cmath>

namespace biem {

Traction parse_traction(const std::string &name)
{
  if (name == "lumped") return Traction::Lumped;
  if (name == "consistent") return Traction::Consistent;
  throw Error("unknown traction '" + name + "': choose lumped or consistent");
}

Suspension::Suspension(MPI_Comm comm, const SumParameters &parameters,
                       const SuspensionSettings &settings, const Scene &scene) :
    settings_(settings),
    scene_(scene), has_unknowns_(scene.has_unknowns()), force_operator_(comm, parameters.forces)
{
  if (settings.drive == Drive::PressureDrop && !scene.has(SurfaceKind::Wall))
    throw Error("a pressure drop drives a flow only against walls, and this scene has none; give a "
                "mean velocity instead");
  for (const SurfaceMesh &shape : scene.shapes)
    body_loads_.emplace_back(shape.nodes, shape.triangles);
  if (has_unknowns_)
    coupled_ = std::make_unique<CoupledSystem>(comm, parameters.coupled, settings.viscosity,
                                               settings.control, scene, settings.drive);
}

void Suspension::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  volume_ = std::fabs(cell.determinant());
  force_operator_.set_cell(cell, origin);
  if (coupled_) coupled_->set_cell(cell, origin);
}

bool Suspension::is_kind(const Configuration &c, int node, SurfaceKind kind) const
{
  const int s = c.surface_of_node[node];
  return s >= 0 && scene_.surfaces[s].kind == kind;
}

// Sources of the force operator: cells, and rigid particles while forces act on any of them.
void Suspension::set_force_geometry(const Configuration &c, PointsView forces,
                                    NodeExchange &exchange)
{
  double n_forced = 0.0;
  if (scene_.has(SurfaceKind::Rigid)) {
    for (int i = 0; i < c.n_owned; i++)
      n_forced += is_kind(c, i, SurfaceKind::Rigid) && !forces.col(i).isZero(0.0);
    exchange.sum(&n_forced, 1);
  }
  const bool has_body_forces = n_forced > 0.0;
  has_forces_ = has_body_forces || scene_.has(SurfaceKind::Cell);
  if (has_forces_ && (version_ != c.version || has_body_forces != has_body_forces_)) {
    std::vector<char> is_source(scene_.surfaces.size());
    for (size_t s = 0; s < is_source.size(); s++) {
      const SurfaceKind kind = scene_.surfaces[s].kind;
      is_source[s] = kind == SurfaceKind::Cell || (kind == SurfaceKind::Rigid && has_body_forces);
    }
    force_surfaces_.set_topology(c, is_source, {}, std::vector<char>(c.n_owned, 1), exchange);
    version_ = c.version;
  }
  has_body_forces_ = has_body_forces;
  if (has_forces_) force_surfaces_.set_geometry(c, exchange);
}

// Volumes and areas in one sum.
void Suspension::measure_cells(const Configuration &c, HeldCells &cells,
                               NodeExchange &exchange) const
{
  const size_t n = scene_.surfaces.size();
  std::vector<double> sums(2 * n, 0.0);
  if (scene_.has(SurfaceKind::Cell)) {
    const std::vector<int> &parents = force_surfaces_.parents();
    const SurfaceElements &elements = force_surfaces_.elements();
    for (int e = 0; e < static_cast<int>(parents.size()); e++) {
      const int s = c.surface_of_triangle[parents[e]];
      if (scene_.surfaces[s].kind != SurfaceKind::Cell) continue;
      sums[s] += elements.volume(e, -c.triangle_shift.col(parents[e]));
      sums[n + s] += elements.area(e);
    }
    exchange.sum(sums.data(), static_cast<int>(sums.size()));
  }
  const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(n);
  cells.volume.assign(sums.begin(), middle);
  cells.area.assign(middle, sums.end());
}

// 3 x n_all, ghosts filled.
Points Suspension::compute_traction(const Configuration &c, PointsView forces, Sources sources,
                                    NodeExchange &exchange) const
{
  const Eigen::VectorXd &areas = force_surfaces_.areas();
  Points density = Points::Zero(3, c.nodes.cols());
  auto divide_by_area = [&](PointsView source, PointsRef target) {
    for (int i = 0; i < c.n_owned; i++)
      if (areas[i] > 0.0 && is_kind(c, i, SurfaceKind::Cell))
        target.col(i) += source.col(i) / areas[i];
  };
  divide_by_area(forces, density);
  if (settings_.traction == Traction::Consistent) {
    exchange.forward(density.data(), 3);
    Points product = Points::Zero(3, c.nodes.cols());
    force_surfaces_.elements().add_mass_product(density, product);
    exchange.reverse_add(product.data(), 3);
    const Points residual = forces - product.leftCols(c.n_owned);
    divide_by_area(residual, density);
  }
  if (has_body_forces_ && sources == Sources::All) spread_body_forces(c, forces, density, exchange);
  exchange.forward(density.data(), 3);
  return density;
}

// Only the sum of the forces on a particle and their torque count.
void Suspension::spread_body_forces(const Configuration &c, PointsView forces, PointsRef density,
                                    NodeExchange &exchange) const
{
  const SurfaceModes &modes = coupled_->modes();
  const size_t n = scene_.surfaces.size();
  std::vector<double> loads(6 * n, 0.0);
  auto load = [&](int s, int first) {
    return Eigen::Map<Vec3>(&loads[6 * s + first]);
  };
  for (int i = 0; i < c.n_owned; i++) {
    if (!is_kind(c, i, SurfaceKind::Rigid)) continue;
    const int s = c.surface_of_node[i];
    const Vec3 force = forces.col(i), x = modes.relative().col(i);
    load(s, 0) += force;
    load(s, 3) += x.cross(force);
  }
  exchange.sum(loads.data(), static_cast<int>(loads.size()));
  std::vector<BodyLoad::Coefficients> coefficients(n);    // in the body frames
  for (size_t s = 0; s < n; s++) {
    if (scene_.surfaces[s].kind != SurfaceKind::Rigid) continue;
    const Mat3 to_body = c.orientations[s].transpose();
    const int k = static_cast<int>(s);
    coefficients[s] =
        body_loads_[scene_.surfaces[s].shape].solve(to_body * load(k, 0), to_body * load(k, 3));
  }
  for (int i = 0; i < c.n_owned; i++) {
    if (!is_kind(c, i, SurfaceKind::Rigid)) continue;
    const int s = c.surface_of_node[i];
    density.col(i) = c.orientations[s] * body_loads_[scene_.surfaces[s].shape].compute_density(
                                             coefficients[s], c.index_of_node[i]);
  }
}

Evaluation Suspension::evaluate(const Configuration &c, PointsView forces,
                                const Conditions &conditions, const CoupledFields &guess,
                                HeldCells &cells, NodeExchange &exchange)
{
  set_force_geometry(c, forces, exchange);
  if (has_unknowns_) coupled_->set_geometry(c, exchange);
  measure_cells(c, cells, exchange);

  Evaluation result;
  result.velocity = result.traction = Points::Zero(3, c.n_owned);
  result.areas = Eigen::VectorXd::Zero(c.n_owned);
  if (has_forces_) {
    result.areas = force_surfaces_.areas();
    const Points density = compute_traction(c, forces, Sources::All, exchange);
    result.traction = density.leftCols(c.n_owned);
    result.velocity = apply_forces(c, density, exchange);
  }
  Vec3 force = forces.rowwise().sum();
  exchange.sum(force.data(), 3);
  result.mean_velocity = conditions.flow.mean;
  result.pressure_drop = -force / volume_;
  if (has_unknowns_) solve_coupled(c, forces, conditions, guess, result, exchange);
  hold_cells(c, conditions.flow, cells, result.velocity, exchange);
  return result;
}

// traction: 3 x n_all, ghosts filled.
Points Suspension::apply_forces(const Configuration &c, PointsView traction, NodeExchange &exchange)
{
  force_operator_.set_geometry(force_surfaces_.share(c), Layers::Single, exchange);
  return force_operator_.apply(Layers::Single, traction, Points(3, 0), exchange) /
         (8.0 * M_PI * settings_.viscosity);
}

Points Suspension::evaluate_fast(const Configuration &c, PointsView forces, NodeExchange &exchange)
{
  set_force_geometry(c, forces, exchange);
  if (!scene_.has(SurfaceKind::Cell)) return Points::Zero(3, c.n_owned);
  Points velocity =
      apply_forces(c, compute_traction(c, forces, Sources::Cells, exchange), exchange);
  for (int i = 0; i < c.n_owned; i++) {
    const int s = c.surface_of_node[i];
    if (s < 0) continue;
    const Surface &surface = scene_.surfaces[s];
    velocity.col(i) *= surface.kind == SurfaceKind::Cell ? 2.0 / (1.0 + surface.viscosity_ratio)
                                                         : 0.0;
  }
  return velocity;
}

void Suspension::hold(const Configuration &c, const BackgroundFlow &flow, HeldCells &cells,
                      PointsRef velocity, NodeExchange &exchange)
{
  measure_cells(c, cells, exchange);
  hold_cells(c, flow, cells, velocity, exchange);
}

Points Suspension::compute_hold_correction(const Configuration &c, HeldCells &cells,
                                           NodeExchange &exchange)
{
  Points displacement = Points::Zero(3, c.n_owned);
  if (cells.hold == Hold::None || !scene_.has(SurfaceKind::Cell)) return displacement;
  force_surfaces_.set_geometry(c, exchange);
  measure_cells(c, cells, exchange);
  HeldCells all_at_once = cells;
  all_at_once.relaxation_rate = 1.0;
  hold_cells(c, BackgroundFlow(), all_at_once, displacement, exchange);
  return displacement;
}

void Suspension::hold_cells(const Configuration &c, const BackgroundFlow &flow,
                            const HeldCells &cells, PointsRef velocity,
                            NodeExchange &exchange) const
{
  if (cells.reference_volume.empty() || !scene_.has(SurfaceKind::Cell)) return;
  std::vector<int> cell_of_node(c.n_owned, -1);
  for (int i = 0; i < c.n_owned; i++)
    if (is_kind(c, i, SurfaceKind::Cell)) cell_of_node[i] = c.surface_of_node[i];
  Points area_gradient;
  if (cells.hold == Hold::VolumeAndArea) {
    area_gradient = Points::Zero(3, c.nodes.cols());
    force_surfaces_.elements().add_area_gradient(area_gradient);
    exchange.reverse_add(area_gradient.data(), 3);
  }
  project_held(
      cells,
      {cell_of_node, force_surfaces_.volume_gradient(), area_gradient, c.unwrapped, flow.gradient},
      exchange, velocity);
}

// result comes with the velocity that the forces alone cause and leaves with all of it.
void Suspension::solve_coupled(const Configuration &c, PointsView forces,
                               const Conditions &conditions, const CoupledFields &guess,
                               Evaluation &result, NodeExchange &exchange)
{
  check_blocked_flow(conditions);
  const SurfaceModes &modes = coupled_->modes();
  const Mat3 &gradient = conditions.flow.gradient;
  auto surface_of = [&](int i) -> const Surface & {
    return scene_.surfaces[c.surface_of_node[i]];
  };
  // Unknowns of a closed surface are relative to the background flow at its centroid: a shear is
  // then the same for all images of the surface.
  CoupledFields wanted{result.velocity};
  for (int i = 0; i < c.n_owned; i++) {
    if (!coupled_->is_unknown(i)) continue;
    if (surface_of(i).kind == SurfaceKind::Wall)
      wanted.nodes.col(i) += conditions.flow.mean - surface_of(i).velocity;
    else
      wanted.nodes.col(i) += gradient * modes.relative().col(i);
  }
  wanted.mean = conditions.pressure_drop - result.pressure_drop;    // what the forces leave
  result.solution = guess;
  if (guess.nodes.cols() != c.n_owned) result.solution = {Points::Zero(3, c.n_owned)};
  result.solver = coupled_->solve(c, wanted, result.solution, exchange);

  const Points &x = result.solution.nodes;
  if (modes.n_surfaces() > 0) result.motions = modes.compute_motions(x, exchange);
  result.velocity += coupled_->compute_velocity(c, x, result.motions, exchange);
  for (int s = 0; s < modes.n_surfaces(); s++)
    result.centroids.push_back(modes.surface(s).centroid);
  for (int i = 0; i < c.n_owned; i++) {
    if (!coupled_->is_unknown(i)) {
      result.velocity.col(i) += result.solution.mean;
      continue;
    }
    result.areas[i] = coupled_->surfaces().areas()[i];
    const int s = c.surface_of_node[i];
    if (surface_of(i).kind == SurfaceKind::Wall) {
      result.velocity.col(i) = surface_of(i).velocity - conditions.flow.mean;
      result.traction.col(i) = x.col(i);
    } else if (surface_of(i).kind == SurfaceKind::Rigid) {
      result.velocity.col(i) =
          modes.compute_rigid(result.motions[s], i) - gradient * modes.relative().col(i);
    } else {
      result.velocity.col(i) = x.col(i) - gradient * modes.relative().col(i);
    }
  }
  if (!coupled_->walls().is_empty()) {
    const Vec3 load = coupled_->walls().compute_load(x, exchange);
    result.wall_force = -volume_ * load;
    result.wall_area = coupled_->walls().area();
    result.pressure_drop += load;
  }
  result.mean_velocity += result.solution.mean;
  add_stresslets(c, forces, result, exchange);
}

void Suspension::check_blocked_flow(const Conditions &conditions) const
{
  if (coupled_->walls().is_empty()) return;
  if (!conditions.flow.gradient.isZero(0.0))
    throw Error("a linear background flow cannot be combined with walls: shear the fluid by walls "
                "that move");
  const double size = std::max(conditions.flow.mean.norm(), conditions.pressure_drop.norm());
  for (int a = 0; a < 3; a++) {
    if (!coupled_->walls().is_blocked()[a]) continue;
    const std::string axis(1, "xyz"[a]);
    if (std::fabs(conditions.flow.mean[a]) > 1e-12 * size)
      throw Error("mean velocity " + std::to_string(conditions.flow.mean[a]) + " along " + axis +
                  " would go through a closed wall; it must be zero there");
    if (std::fabs(conditions.pressure_drop[a]) > 1e-12 * size)
      throw Error("pressure drop " + std::to_string(conditions.pressure_drop[a]) + " along " +
                  axis +
                  " acts on a closed wall, which lets nothing through; it must be zero "
                  "there");
    for (const Surface &s : scene_.surfaces)
      if (s.kind == SurfaceKind::Wall && s.velocity[a] != 0.0)
        throw Error("wall velocity " + std::to_string(s.velocity[a]) + " along " + axis +
                    " pushes a closed wall through the fluid; walls can move in their own plane "
                    "only");
  }
}

void Suspension::add_stresslets(const Configuration &c, PointsView forces, Evaluation &result,
                                NodeExchange &exchange) const
{
  const SurfaceModes &modes = coupled_->modes();
  if (modes.n_surfaces() == 0) return;
  const Points &gradient = coupled_->surfaces().volume_gradient();
  result.stresslets.assign(scene_.surfaces.size(), Mat3::Zero());
  for (int i = 0; i < c.n_owned; i++) {
    if (!coupled_->is_unknown(i) || is_kind(c, i, SurfaceKind::Wall)) continue;
    const int s = c.surface_of_node[i];
    const double factor = settings_.viscosity * scene_.surfaces[s].double_layer_factor();
    const Mat3 phi_n = factor * result.solution.nodes.col(i) * gradient.col(i).transpose();
    const Mat3 f_x = forces.col(i) * modes.relative().col(i).transpose();
    result.stresslets[s] += phi_n + phi_n.transpose() - 0.5 * (f_x + f_x.transpose());
  }
  exchange.sum(result.stresslets[0].data(), static_cast<int>(9 * result.stresslets.size()));
  for (Mat3 &s : result.stresslets)
    s -= s.trace() / 3.0 * Mat3::Identity();
}

OperatorProfile Suspension::coupled_profile() const
{
  return coupled_ ? coupled_->profile() : OperatorProfile();
}

}    // namespace biem
