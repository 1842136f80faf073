// Flat triangles: geometry, degree-2 far rule, consistent mass, near correction.
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_kernel_stokeslet.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {
// Degree-2 rule on a triangle: vertices area/12 each, centroid 3/4 area.
constexpr double kVertexWeight = 1.0 / 12.0;
constexpr double kCentroidWeight = 3.0 / 4.0;
}    // namespace

void FlatElements::set_geometry(PointsView nodes, const std::vector<Triangle> &triangles)
{
  triangles_ = triangles;
  const size_t n = triangles.size();
  corners_.resize(n);
  frames_.resize(n);
  mean_edges_.resize(n);
  for (size_t e = 0; e < n; e++) {
    for (int v = 0; v < 3; v++)
      corners_[e][v] = nodes.col(triangles[e][v]);
    const Vec3 &a = corners_[e][0], &b = corners_[e][1], &c = corners_[e][2];
    frames_[e] = make_triangle_frame(a, b, c);
    mean_edges_[e] = ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0;
    if (!(frames_[e].twice_area > 1e-12 * mean_edges_[e] * mean_edges_[e]))
      throw Error("triangle of local nodes " + std::to_string(triangles[e][0]) + ", " +
                  std::to_string(triangles[e][1]) + ", " + std::to_string(triangles[e][2]) +
                  " has collapsed (area " + std::to_string(0.5 * frames_[e].twice_area) +
                  "): the membrane has folded; use a smaller timestep or a finer mesh");
  }
}

Vec3 FlatElements::centroid(int e) const
{
  return (corners_[e][0] + corners_[e][1] + corners_[e][2]) / 3.0;
}

void FlatElements::add_nodal_areas(Eigen::Ref<Eigen::VectorXd> areas) const
{
  for (int e = 0; e < n_elements(); e++)
    for (int v = 0; v < 3; v++)
      areas[triangles_[e][v]] += area(e) / 3.0;
}

void FlatElements::add_volume_gradient(PointsRef gradient) const
{
  // V = sum a.(b x c)/6; written with differences to one vertex so that the origin drops out of a
  // closed surface only in the sum, while each term stays of the size of the triangle's area.
  for (int e = 0; e < n_elements(); e++) {
    const Vec3 share = frames_[e].normal * (frames_[e].twice_area / 6.0);
    for (int v = 0; v < 3; v++)
      gradient.col(triangles_[e][v]) += share;
  }
}

double FlatElements::volume(int e, const Vec3 &origin) const
{
  return (corners_[e][0] - origin).dot(frames_[e].normal) * frames_[e].twice_area / 6.0;
}

void FlatElements::compute_interior_points(PointsRef points) const
{
  for (int e = 0; e < n_elements(); e++)
    points.col(e) = centroid(e);
}

void FlatElements::compute_interior_strengths(PointsView density, PointsRef strengths) const
{
  for (int e = 0; e < n_elements(); e++) {
    const Triangle &t = triangles_[e];
    strengths.col(e) = (kCentroidWeight * area(e) / 3.0) *
                       (density.col(t[0]) + density.col(t[1]) + density.col(t[2]));
  }
}

void FlatElements::add_mass_product(PointsView density, PointsRef result) const
{
  for (int e = 0; e < n_elements(); e++) {
    const Triangle &t = triangles_[e];
    const Vec3 sum = density.col(t[0]) + density.col(t[1]) + density.col(t[2]);
    for (int v = 0; v < 3; v++)
      result.col(t[v]) += (area(e) / 12.0) * (sum + density.col(t[v]));
  }
}

double FlatElements::squared_distance(int e, const Vec3 &target) const
{
  return std::min({(corners_[e][0] - target).squaredNorm(), (corners_[e][1] - target).squaredNorm(),
                   (corners_[e][2] - target).squaredNorm()});
}

void FlatElements::prepare_near(PointsView density)
{
  densities_.resize(triangles_.size());
  rule_strengths_.resize(triangles_.size());
  for (int e = 0; e < n_elements(); e++) {
    Mat3 f;
    for (int v = 0; v < 3; v++)
      f.col(v) = density.col(triangles_[e][v]);
    densities_[e] = make_linear_density(frames_[e], f);
    for (int v = 0; v < 3; v++)
      rule_strengths_[e][v] = (kVertexWeight * area(e)) * f.col(v);
    rule_strengths_[e][3] = (kCentroidWeight * area(e) / 3.0) * f.rowwise().sum();
  }
}

Vec3 FlatElements::compute_near_correction(int e, const Vec3 &target) const
{
  Vec3 u = compute_single_layer(frames_[e], densities_[e], target);
  for (int v = 0; v < 3; v++)
    u -= compute_stokeslet(target - corners_[e][v], rule_strengths_[e][v]);
  return u - compute_stokeslet(target - centroid(e), rule_strengths_[e][3]);
}

}    // namespace biem
