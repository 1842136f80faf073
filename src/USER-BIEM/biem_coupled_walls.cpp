// Walls of the coupled system: see the header.
#include "biem_coupled_walls.h"
#include "biem_error.h"
#include <cmath>

namespace biem {

namespace {

// A closed wall blocks a direction if the net area that it turns there is more than this part.
constexpr double kBlockedArea = 1e-3;
// Of the inverse, relative; measured: below 2e-4 at accuracy 1e-3.
constexpr double kLargestResidual = 0.05;

}    // namespace

Points WallBlock::distribute(const Points &replicated) const
{
  Points field = Points::Zero(3, static_cast<Eigen::Index>(index_.size()));
  for (Eigen::Index i = 0; i < field.cols(); i++)
    if (is_wall(i)) field.col(i) = replicated.col(index_[i]);
  return field;
}

Points WallBlock::gather(PointsView field, NodeExchange &exchange) const
{
  Points all = Points::Zero(3, n_wall_nodes_);
  for (Eigen::Index i = 0; i < field.cols(); i++)
    if (is_wall(i)) all.col(index_[i]) = field.col(i);
  exchange.sum(all.data(), static_cast<int>(all.size()));
  return all;
}

void WallBlock::set_nodes(const WallMesh &mesh, std::vector<int> index, Eigen::VectorXd areas,
                          double volume, const Response &response, NodeExchange &exchange)
{
  n_wall_nodes_ = mesh.nodes.cols();
  index_ = std::move(index);
  areas_ = std::move(areas);
  volume_ = volume;
  if (!inverse_) invert(mesh, response, exchange);
  find_blocked_directions(exchange);
  Mat3 loads;    // columns: of unit velocities
  for (int a = 0; a < 3; a++) {
    const Points uniform = Vec3(Vec3::Unit(a)).replicate(1, n_wall_nodes_);
    uniform_forces_[a] = is_blocked_[a] ? Points(Points::Zero(3, areas_.size()))
                                        : Points(-distribute(inverse_->apply(uniform)));
    loads.col(a) = compute_load(uniform_forces_[a], exchange);
  }
  for (int a = 0; a < 3; a++)
    if (is_blocked_[a]) loads.row(a) = Vec3::Unit(a);
  loads_to_velocity_ = loads.inverse();
  for (int a = 0; a < 3; a++)
    if (is_blocked_[a]) loads_to_velocity_.row(a).setZero();
}

void WallBlock::invert(const WallMesh &mesh, const Response &response, NodeExchange &exchange)
{
  const WallResponse respond = [&](const Points &densities) {
    return gather(response(distribute(densities)), exchange);
  };
  inverse_ = std::make_unique<WallInverse>(mesh, respond);
  residual_ = measure_residual(respond);
  if (!(residual_ < kLargestResidual))
    throw Error("walls of " + std::to_string(n_wall_nodes_) +
                " nodes: the inverse of their equations leaves a residual of " +
                std::to_string(residual_) +
                "; likely cause: parts of walls that nearly coincide, or very uneven triangles. "
                "Check the wall mesh, or ask for a smaller accuracy");
}

double WallBlock::measure_residual(const WallResponse &respond) const
{
  Points rough(3, n_wall_nodes_);
  for (Eigen::Index i = 0; i < rough.size(); i++)    // no lattice has this pattern
    rough.data()[i] = std::sin(1.0 + 0.7 * static_cast<double>(i) * static_cast<double>(i));
  const Points wanted = inverse_->remove_null_part(rough);
  const Points found = inverse_->remove_null_part(respond(inverse_->apply(wanted)));
  return (found - wanted).norm() / wanted.norm();
}

void WallBlock::find_blocked_directions(NodeExchange &exchange)
{
  const std::vector<Points> jumps = compute_null_vectors();
  Points sums = Points::Zero(3, static_cast<Eigen::Index>(jumps.size()));
  area_ = 0.0;
  for (Eigen::Index i = 0; i < areas_.size(); i++) {
    if (!is_wall(i)) continue;
    area_ += areas_[i];
    for (size_t v = 0; v < jumps.size(); v++)
      sums.col(static_cast<Eigen::Index>(v)) += areas_[i] * jumps[v].col(i);
  }
  exchange.sum(&area_, 1);
  exchange.sum(sums.data(), static_cast<int>(sums.size()));
  for (int a = 0; a < 3; a++)
    is_blocked_[a] = !jumps.empty() && sums.row(a).cwiseAbs().maxCoeff() > kBlockedArea * area_;
}

std::vector<Points> WallBlock::compute_null_vectors() const
{
  std::vector<Points> result;
  for (const Points &jump : inverse_->null_vectors())
    result.push_back(distribute(jump));
  return result;
}

Vec3 WallBlock::compute_load(PointsView densities, NodeExchange &exchange) const
{
  Vec3 force = Vec3::Zero();
  for (Eigen::Index i = 0; i < densities.cols(); i++)
    if (is_wall(i)) force += areas_[i] * densities.col(i);
  exchange.sum(force.data(), 3);
  return -force / volume_;
}

void WallBlock::solve(const CoupledFields &residual, CoupledFields &result,
                      NodeExchange &exchange) const
{
  const Points densities = distribute(inverse_->apply(gather(residual.nodes, exchange)));
  for (Eigen::Index i = 0; i < densities.cols(); i++)
    if (is_wall(i)) result.nodes.col(i) = -densities.col(i);
  if (drive_ == Drive::MeanVelocity) return;
  result.mean = residual.mean - to_velocity(compute_load(result.nodes, exchange));
  for (int a = 0; a < 3; a++) {
    if (is_blocked_[a]) result.mean[a] = residual.mean[a];
    result.nodes += result.mean[a] * uniform_forces_[a];
  }
}

}    // namespace biem
