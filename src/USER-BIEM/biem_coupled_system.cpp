// Coupled unknowns of cells, particles and walls: see the header.
#include "biem_coupled_system.h"
#include "biem_error.h"
#include "biem_operator_row_sums.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

const Points kNone(3, 0);

}    // namespace

OperatorProfile operator+(const OperatorProfile &a, const OperatorProfile &b)
{
  OperatorProfile sum = a;
  sum.near += b.near;
  sum.n_near_pairs += b.n_near_pairs;
  sum.sum.search += b.sum.search;
  sum.sum.real_space += b.sum.real_space;
  sum.sum.ghosts += b.sum.ghosts;
  sum.sum.n_pairs += b.sum.n_pairs;
  FourierProfile &f = sum.sum.fourier;
  const FourierProfile &g = b.sum.fourier;
  f.windows += g.windows;
  f.spread += g.spread;
  f.transform += g.transform;
  f.kernel += g.kernel;
  f.interpolate += g.interpolate;
  f.exchange += g.exchange;
  return sum;
}

CoupledSystem::CoupledSystem(MPI_Comm comm, const EwaldParameters &parameters, double viscosity,
                             const SolverControl &control, const Scene &scene, Drive drive) :
    comm_(comm),
    scene_(scene), viscosity_(viscosity), layers_(scene.unknown_layers()),
    has_double_(has_double(layers_)), has_contrast_(scene.has_contrast()),
    has_mean_(drive == Drive::PressureDrop), operator_(comm, parameters),
    field_operator_(comm, parameters), gmres_(comm, control), replicas_(comm), walls_(drive)
{
  int rank;
  MPI_Comm_rank(comm, &rank);
  holds_mean_ = has_mean_ && rank == 0;
  for (const SurfaceMesh &shape : scene.shapes)
    body_inverses_.push_back(std::make_unique<BodyInverse>(shape.nodes, shape.triangles));
}

void CoupledSystem::set_cell(const Mat3 &cell, const Vec3 &origin)
{
  volume_ = std::fabs(cell.determinant());
  operator_.set_cell(cell, origin);
  field_operator_.set_cell(cell, origin);
}

void CoupledSystem::set_geometry(const Configuration &c, NodeExchange &exchange)
{
  const bool is_new = c.version != version_;
  if (is_new) set_topology(c, exchange);
  surfaces_.set_geometry(c, exchange);
  operator_.set_geometry(surfaces_.share(c), layers_, exchange);
  if (has_others_) {
    field_surfaces_.set_geometry(c, exchange);
    field_operator_.set_geometry(field_surfaces_.share(c), layers_, exchange);
  }
  weights_.resize(static_cast<Eigen::Index>(unknown_nodes_.size()));
  for (size_t k = 0; k < unknown_nodes_.size(); k++)
    weights_[k] = std::sqrt(surfaces_.areas()[unknown_nodes_[k]]);
  if (has_double_) {
    modes_.set_geometry(surface_of_mode_, static_cast<int>(scene_.surfaces.size()), c.unwrapped,
                        surfaces_.areas(), surfaces_.volume_gradient(), surfaces_.elements(),
                        c.nodes.cols(), exchange);
    set_row_sums(c);
  }
  if (is_new && scene_.has(SurfaceKind::Wall)) set_walls(c, exchange);
  version_ = c.version;
}

void CoupledSystem::set_topology(const Configuration &c, NodeExchange &exchange)
{
  std::vector<char> is_source(scene_.surfaces.size()), is_target(c.n_owned);
  std::vector<Layers> layers;
  for (const Surface &s : scene_.surfaces) {
    is_source[&s - scene_.surfaces.data()] = s.is_unknown();
    if (layers_ == Layers::Both)
      layers.push_back(s.kind == SurfaceKind::Wall ? Layers::Single : Layers::Double);
  }
  is_other_.assign(c.n_owned, 0);
  surface_of_unknown_.assign(c.n_owned, -1);
  surface_of_mode_.assign(c.n_owned, -1);
  unknown_nodes_.clear();
  double n_others = 0.0;
  for (int i = 0; i < c.n_owned; i++) {
    const int s = c.surface_of_node[i];
    is_target[i] = s >= 0 && is_source[s];
    is_other_[i] = !is_target[i];
    n_others += is_other_[i];
    if (!is_target[i]) continue;
    unknown_nodes_.push_back(i);
    surface_of_unknown_[i] = s;
    if (surface(s).is_closed()) surface_of_mode_[i] = s;
  }
  exchange.sum(&n_others, 1);
  has_others_ = n_others > 0.0;
  surfaces_.set_topology(c, is_source, layers, is_target, exchange);
  if (has_contrast_) {
    std::vector<int> cell_of_node(c.n_owned, -1);
    for (int i : unknown_nodes_)
      if (surface(surface_of_unknown_[i]).kind == SurfaceKind::Cell)
        cell_of_node[i] = surface_of_unknown_[i];
    replicas_.set_nodes(cell_of_node, c.index_of_node);
  }
  if (has_others_) field_surfaces_.set_topology(c, is_source, layers, is_other_, exchange);
}

// Of rigid particles the row sums are those of the shape; of cells they change with the shape.
void CoupledSystem::set_row_sums(const Configuration &c)
{
  row_sums_.assign(c.n_owned, Mat3::Zero());
  if (has_contrast_) {
    std::map<int, std::vector<int>> owned, targets;    // by surface: nodes, numbers within it
    for (int i : unknown_nodes_) {
      const int s = surface_of_unknown_[i];
      if (surface(s).kind != SurfaceKind::Cell) continue;
      owned[s].push_back(i);
      targets[s].push_back(c.index_of_node[i]);
    }
    for (const auto &[s, nodes] : replicas_.gather(c.unwrapped)) {
      const std::vector<Mat3> sums =
          compute_free_row_sums(nodes, scene_.connectivities[surface(s).shape], targets[s]);
      for (size_t k = 0; k < sums.size(); k++)
        row_sums_[owned[s][k]] = sums[k];
    }
  }
  for (int i = 0; i < c.n_owned; i++) {
    const int s = surface_of_mode_[i];
    if (s < 0 || surface(s).kind != SurfaceKind::Rigid) continue;
    const Mat3 &r = c.orientations[s];
    row_sums_[i] =
        r * body_inverses_[surface(s).shape]->row_sums()[c.index_of_node[i]] * r.transpose();
  }
}

void CoupledSystem::set_walls(const Configuration &c, NodeExchange &exchange)
{
  std::vector<int> index(c.n_owned, -1);
  for (int i : unknown_nodes_)
    if (is_wall(i)) index[i] = c.index_of_node[i];
  auto respond = [&](PointsView densities) {
    Points field = Points::Zero(3, c.nodes.cols());
    field.leftCols(c.n_owned) = densities;
    exchange.forward(field.data(), 3);
    return Points(operator_.apply(Layers::Single, field, kNone, exchange) /
                  (8.0 * M_PI * viscosity_));
  };
  walls_.set_nodes(scene_.walls, std::move(index), surfaces_.areas(), volume_, respond, exchange);
  mean_weight_ = std::sqrt(walls_.area());
  // Distributed anew, as nodes have migrated.
  const std::vector<Points> jumps = walls_.compute_null_vectors();
  Eigen::MatrixXd vectors(pack({Points::Zero(3, c.n_owned)}).size(),
                          static_cast<Eigen::Index>(jumps.size()));
  for (size_t v = 0; v < jumps.size(); v++)
    vectors.col(static_cast<Eigen::Index>(v)) = pack({jumps[v]});
  gmres_.set_null_vectors(vectors);
}

void CoupledSystem::compute_densities(const Configuration &c, PointsView unknowns,
                                      const std::vector<SurfaceMotion> &motions,
                                      NodeExchange &exchange)
{
  if (has_single(layers_)) single_density_ = Points::Zero(3, c.nodes.cols());
  if (has_double_) double_density_ = Points::Zero(3, c.nodes.cols());
  for (int i : unknown_nodes_) {
    const int s = surface_of_unknown_[i];
    if (surface(s).kind == SurfaceKind::Wall) {
      single_density_.col(i) = unknowns.col(i) / viscosity_;
      continue;
    }
    const Vec3 rest = unknowns.col(i) - modes_.compute_rigid(motions[s], i) -
                      modes_.compute_normal(motions[s], i);
    double_density_.col(i) = surface(s).double_layer_factor() * rest;
  }
  if (has_single(layers_)) exchange.forward(single_density_.data(), 3);
  if (has_double_) exchange.forward(double_density_.data(), 3);
}

CoupledFields CoupledSystem::apply_operator(const Configuration &c, const CoupledFields &unknowns,
                                            NodeExchange &exchange)
{
  std::vector<SurfaceMotion> motions;
  if (has_double_) motions = modes_.compute_motions(unknowns.nodes, exchange);
  compute_densities(c, unknowns.nodes, motions, exchange);
  Points v = operator_.apply(layers_, single_density_, double_density_, exchange);
  if (has_double_) subtract_singularity(row_sums_, double_density_, v);
  CoupledFields result{-v / (8.0 * M_PI)};
  for (int i : unknown_nodes_) {
    result.nodes.col(i) -= unknowns.mean;
    const int s = surface_of_unknown_[i];
    const Surface &kind = surface(s);
    if (kind.kind == SurfaceKind::Wall) continue;
    const Vec3 normal = modes_.compute_normal(motions[s], i);
    if (kind.kind == SurfaceKind::Cell)
      result.nodes.col(i) += unknowns.nodes.col(i) + kind.double_layer_factor() * normal;
    else
      result.nodes.col(i) += modes_.compute_rigid(motions[s], i) + normal;
  }
  if (has_mean_) {
    result.mean = walls_.to_velocity(walls_.compute_load(unknowns.nodes, exchange));
    for (int a = 0; a < 3; a++)
      if (walls_.is_blocked()[a]) result.mean[a] = unknowns.mean[a];
  }
  return result;
}

CoupledFields CoupledSystem::apply_preconditioner(const Configuration &c,
                                                  const CoupledFields &residual,
                                                  NodeExchange &exchange)
{
  CoupledFields result{Points::Zero(3, c.n_owned)};
  std::vector<SurfaceMotion> motions;
  if (has_double_) motions = modes_.compute_motions(residual.nodes, exchange);
  for (int i : unknown_nodes_) {
    const int s = surface_of_unknown_[i];
    if (surface(s).kind != SurfaceKind::Cell) continue;
    const Vec3 rigid = modes_.compute_rigid(motions[s], i);
    const Vec3 normal = modes_.compute_normal(motions[s], i);
    result.nodes.col(i) =
        precondition_contrast(surface(s).viscosity_ratio, residual.nodes.col(i), rigid, normal);
  }
  if (!scene_.shapes.empty()) precondition_bodies(c, residual.nodes, result.nodes, exchange);
  if (!walls_.is_empty()) walls_.solve(residual, result, exchange);
  return result;
}

// Each particle's values are gathered; the ranks share the particles.
void CoupledSystem::precondition_bodies(const Configuration &c, PointsView residual, Points &result,
                                        NodeExchange &exchange) const
{
  std::vector<int> first(scene_.surfaces.size(), -1);
  int n = 0, rank, n_ranks, n_bodies = 0;
  for (size_t s = 0; s < first.size(); s++)
    if (scene_.surfaces[s].kind == SurfaceKind::Rigid) {
      first[s] = n;
      n += static_cast<int>(scene_.shapes[scene_.surfaces[s].shape].nodes.cols());
    }
  auto body_index = [&](int i) {
    const int s = surface_of_unknown_[i];
    return first[s] >= 0 ? first[s] + c.index_of_node[i] : -1;
  };
  Points gathered = Points::Zero(3, n);
  for (int i : unknown_nodes_)
    if (const int k = body_index(i); k >= 0) gathered.col(k) = residual.col(i);
  exchange.sum(gathered.data(), static_cast<int>(gathered.size()));
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &n_ranks);
  Points densities = Points::Zero(3, n);
  for (size_t s = 0; s < first.size(); s++) {
    if (first[s] < 0 || n_bodies++ % n_ranks != rank) continue;
    const int shape = scene_.surfaces[s].shape;
    const Eigen::Index size = scene_.shapes[shape].nodes.cols();
    densities.middleCols(first[s], size) =
        body_inverses_[shape]->apply(c.orientations[s], gathered.middleCols(first[s], size));
  }
  exchange.sum(densities.data(), static_cast<int>(densities.size()));
  for (int i : unknown_nodes_)
    if (const int k = body_index(i); k >= 0) result.col(i) = densities.col(k);
}

SolverReport CoupledSystem::solve(const Configuration &c, const CoupledFields &right_hand_side,
                                  CoupledFields &solution, NodeExchange &exchange)
{
  CoupledFields wanted = right_hand_side;
  if (has_mean_) wanted.mean = walls_.to_velocity(right_hand_side.mean);
  if (!has_double_) {    // walls alone: their inverse is all that it takes
    walls_.solve(wanted, solution, exchange);
    SolverReport report;
    report.residual = walls_.residual();
    return report;
  }
  auto operate = [&](const Eigen::VectorXd &in, Eigen::VectorXd &out) {
    out = pack(apply_operator(c, unpack(in, exchange), exchange));
  };
  auto precondition = [&](const Eigen::VectorXd &in, Eigen::VectorXd &out) {
    out = pack(apply_preconditioner(c, unpack(in, exchange), exchange));
  };
  Eigen::VectorXd unknowns = pack(solution);
  SolverReport report;
  try {
    report = gmres_.solve(operate, precondition, pack(wanted), unknowns);
  } catch (const NotConverged &e) {
    rethrow_with_surface(e, c, exchange);
  }
  solution = unpack(unknowns, exchange);
  return report;
}

void CoupledSystem::rethrow_with_surface(const NotConverged &e, const Configuration &c,
                                         NodeExchange &exchange) const
{
  std::vector<double> squares(scene_.surfaces.size(), 0.0);
  const Eigen::VectorXd &residual = gmres_.residual();
  double total = 0.0;
  for (size_t k = 0; k < unknown_nodes_.size(); k++)
    squares[c.surface_of_node[unknown_nodes_[k]]] +=
        residual.segment<3>(3 * static_cast<Eigen::Index>(k)).squaredNorm();
  exchange.sum(squares.data(), static_cast<int>(squares.size()));
  for (double s : squares)
    total += s;
  const auto worst = std::max_element(squares.begin(), squares.end());
  throw NotConverged(std::string(e.what()) + "; " +
                         std::to_string(static_cast<int>(std::lround(100.0 * *worst / total))) +
                         " % of the squared residual is on the surface of molecule " +
                         std::to_string(worst - squares.begin() + 1),
                     e.report());
}

Points CoupledSystem::compute_velocity(const Configuration &c, PointsView solution,
                                       const std::vector<SurfaceMotion> &motions,
                                       NodeExchange &exchange)
{
  if (!has_others_) return Points::Zero(3, c.n_owned);
  compute_densities(c, solution, motions, exchange);
  return field_operator_.apply(layers_, single_density_, double_density_, exchange) / (8.0 * M_PI);
}

// The mean velocity is with the first rank.
Eigen::VectorXd CoupledSystem::pack(const CoupledFields &fields) const
{
  const auto n = static_cast<Eigen::Index>(unknown_nodes_.size());
  Eigen::VectorXd unknowns(3 * n + (holds_mean_ ? 3 : 0));
  for (Eigen::Index k = 0; k < n; k++)
    unknowns.segment<3>(3 * k) = weights_[k] * fields.nodes.col(unknown_nodes_[k]);
  if (holds_mean_) unknowns.tail<3>() = mean_weight_ * fields.mean;
  return unknowns;
}

CoupledFields CoupledSystem::unpack(const Eigen::VectorXd &unknowns, NodeExchange &exchange) const
{
  CoupledFields fields{Points::Zero(3, static_cast<Eigen::Index>(surface_of_unknown_.size()))};
  for (size_t k = 0; k < unknown_nodes_.size(); k++)
    fields.nodes.col(unknown_nodes_[k]) =
        unknowns.segment<3>(3 * static_cast<Eigen::Index>(k)) / weights_[k];
  if (holds_mean_) fields.mean = unknowns.tail<3>() / mean_weight_;
  if (has_mean_) exchange.sum(fields.mean.data(), 3);
  return fields;
}

OperatorProfile CoupledSystem::profile() const
{
  return operator_.profile() + field_operator_.profile();
}

}    // namespace biem
