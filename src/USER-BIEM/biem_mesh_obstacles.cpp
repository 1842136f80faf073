// Nearest triangle by a periodic grid of bins; inside or outside by the normal there.
// Does not know how the surfaces came there nor what is placed between them.
#include "biem_mesh_obstacles.h"

#include "biem_mesh_nearest_point.h"
#include "biem_mesh_topology.h"

#include <algorithm>
#include <cmath>

namespace biem {

// Moeller & Trumbore, J. Graphics Tools 2, 21 (1997).
bool is_crossed(const Mat3 &corners, const Vec3 &p, const Vec3 &arm)
{
  const Vec3 ab = corners.col(1) - corners.col(0), ac = corners.col(2) - corners.col(0);
  const Vec3 normal = ab.cross(ac);
  const double along = normal.dot(arm);
  const double t = normal.dot(p - corners.col(0)) / along;    // back from p, in units of arm
  if (!(t >= 0.0 && t <= 1.0)) return false;                  // also where arm is parallel
  const Vec3 hit = p - t * arm - corners.col(0);
  const double u = normal.dot(hit.cross(ac)), v = normal.dot(ab.cross(hit));
  return u >= 0.0 && v >= 0.0 && u + v <= normal.squaredNorm();
}

MeshObstacles::MeshObstacles(const MeshLattice &lattice, const Points &nodes,
                             const std::vector<Triangle> &triangles, double reach,
                             Sides sides) :
    lattice_(lattice), nodes_(nodes), largest_radius_(0.0), reach_(reach)
{
  make_facets(triangles, sides);
  make_bins();
}

void MeshObstacles::make_facets(const std::vector<Triangle> &triangles, Sides sides)
{
  Points normals = Points::Zero(3, nodes_.cols());
  for (const Triangle &t : triangles) {
    const Vec3 a = nodes_.col(t[0]);
    const Vec3 ab = lattice_.wrap_difference(nodes_.col(t[1]) - a);
    const Vec3 ac = lattice_.wrap_difference(nodes_.col(t[2]) - a);
    const Vec3 center = (ab + ac) / 3.0;
    Facet facet;
    facet.center = a + center;
    facet.corners << -center, ab - center, ac - center;
    facet.radius = facet.corners.colwise().norm().maxCoeff();
    facet.normals.setZero();
    facet.is_body = false;
    largest_radius_ = std::max(largest_radius_, facet.radius);
    facets_.push_back(facet);
    for (int node : t) normals.col(node) += ab.cross(ac);
  }
  if (sides == Sides::FromTopology) {
    const auto is_body = find_closed_bodies(triangles, static_cast<int>(nodes_.cols()));
    for (std::size_t i = 0; i < triangles.size(); i++) facets_[i].is_body = is_body[i];
  }
  for (std::size_t i = 0; i < triangles.size(); i++)
    for (int k = 0; k < 3; k++)
      facets_[i].normals.col(k) = normals.col(triangles[i][k]).normalized();
}

void MeshObstacles::make_bins()
{
  std::size_t n_all = 1;
  for (int k = 0; k < 3; k++) {
    const double n = std::min(64.0, lattice_.heights()[k] / (largest_radius_ + reach_));
    n_bins_[k] = std::max(1, static_cast<int>(n));
    n_all *= n_bins_[k];
  }
  facets_of_bin_.resize(n_all);
  nodes_of_bin_.resize(n_all);
  for (int i = 0; i < nodes_.cols(); i++)
    nodes_of_bin_[compute_bin_index(find_bin(nodes_.col(i)))].push_back(i);
  for (std::size_t i = 0; i < facets_.size(); i++)
    facets_of_bin_[compute_bin_index(find_bin(facets_[i].center))].push_back(static_cast<int>(i));
}

std::array<int, 3> MeshObstacles::find_bin(const Vec3 &point) const
{
  const Vec3 s = lattice_.compute_fractional(point);
  std::array<int, 3> bin;
  for (int k = 0; k < 3; k++)
    bin[k] = std::min(static_cast<int>((s[k] - std::floor(s[k])) * n_bins_[k]), n_bins_[k] - 1);
  return bin;
}

std::size_t MeshObstacles::compute_bin_index(const std::array<int, 3> &bin) const
{
  return (static_cast<std::size_t>(bin[2]) * n_bins_[1] + bin[1]) * n_bins_[0] + bin[0];
}

// Calls visit(bin index) once for every bin that may hold something within radius of the point.
template <class Visitor>
void MeshObstacles::for_each_bin(const Vec3 &point, double radius, Visitor visit) const
{
  const std::array<int, 3> home = find_bin(point);
  int low[3], high[3];
  for (int k = 0; k < 3; k++) {
    const int n = n_bins_[k];
    const int reach = static_cast<int>(radius / lattice_.heights()[k] * n) + 1;
    low[k] = 2 * reach + 1 < n ? home[k] - reach + n : 0;
    high[k] = 2 * reach + 1 < n ? home[k] + reach + n : n - 1;
  }
  for (int i = low[0]; i <= high[0]; i++)
    for (int j = low[1]; j <= high[1]; j++)
      for (int k = low[2]; k <= high[2]; k++)
        visit(compute_bin_index({i % n_bins_[0], j % n_bins_[1], k % n_bins_[2]}));
}

void MeshObstacles::update_nearest(const Facet &facet, const Vec3 &point, Nearest &nearest) const
{
  const Vec3 p = lattice_.wrap_difference(point - facet.center);
  const double bound = nearest.distance + facet.radius;
  if (p.squaredNorm() >= bound * bound) return;
  const Vec3 weights = compute_nearest_weights(p, facet.corners.col(0), facet.corners.col(1),
                                               facet.corners.col(2));
  const Vec3 offset = p - facet.corners * weights;
  const double distance = offset.norm();
  if (distance < nearest.distance) nearest = {distance, offset, facet.normals * weights, &facet};
}

SignedDistance MeshObstacles::evaluate(const Vec3 &point, const Vec3 &arm, double limit) const
{
  Nearest nearest = {limit, Vec3::Zero(), Vec3::Zero(), nullptr};
  for_each_bin(point, limit + largest_radius_, [&](std::size_t bin) {
    for (int facet : facets_of_bin_[bin]) update_nearest(facets_[facet], point, nearest);
  });
  const double distance = nearest.distance;
  if (distance >= limit) return {limit, Vec3::Zero()};
  if (!nearest.facet->is_body) {
    const Mat3 &corners = nearest.facet->corners;
    const Vec3 plane = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    const double side = plane.dot(nearest.offset - arm);
    const Vec3 toward = side < 0.0 ? Vec3(-plane.normalized()) : Vec3(plane.normalized());
    if (side * plane.dot(nearest.offset) < 0.0) return {-distance, toward};
    return {distance, distance > 0.0 ? Vec3(nearest.offset / distance) : toward};
  }
  if (nearest.offset.dot(nearest.normal) < 0.0) return {-distance, nearest.normal.normalized()};
  return {distance, distance > 0.0 ? Vec3(nearest.offset / distance) : nearest.normal};
}

bool MeshObstacles::intersects(const Vec3 &point, const Vec3 &arm) const
{
  bool is_hit = false;
  for_each_bin(point, arm.norm() + largest_radius_, [&](std::size_t bin) {
    for (int i : facets_of_bin_[bin]) {
      const Facet &facet = facets_[i];
      const Vec3 p = lattice_.wrap_difference(point - 0.5 * arm - facet.center) + 0.5 * arm;
      is_hit = is_hit || is_crossed(facet.corners, p, arm);
    }
  });
  return is_hit;
}

std::vector<int> MeshObstacles::find_nodes(const Vec3 &point, double radius) const
{
  std::vector<int> found;
  for_each_bin(point, radius, [&](std::size_t bin) {
    for (int node : nodes_of_bin_[bin])
      if (lattice_.wrap_difference(nodes_.col(node) - point).norm() < radius)
        found.push_back(node);
  });
  return found;
}

bool MeshObstacles::is_inside(const Vec3 &point) const
{
  Nearest nearest = {1e100, Vec3::Zero(), Vec3::Zero(), nullptr};
  for (const Facet &facet : facets_)
    if (facet.is_body) update_nearest(facet, point, nearest);
  return nearest.offset.dot(nearest.normal) < 0.0;
}

}    // namespace biem
