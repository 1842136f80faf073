// Row sums in free space: see the header.
#include "biem_operator_row_sums.h"
#include "biem_element_flat.h"
#include "biem_near_correction.h"
#include "biem_simd_gather.h"
#include "biem_simd_math.h"
#include <cmath>
#include <numeric>

namespace biem {

namespace {

constexpr double kFarAway = 1e30;    // a fill whose normal is zero

// Points of the far rule, coordinate by coordinate, filled up to whole packs.
class FarRule {
 public:
  FarRule(const SurfaceElements &elements, PointsView nodes)
  {
    const Eigen::Index n_nodes = nodes.cols(), n_elements = elements.n_elements();
    Points points(3, n_nodes + n_elements), normals = Points::Zero(3, n_nodes + n_elements);
    points.leftCols(n_nodes) = nodes;
    elements.compute_interior_points(points.rightCols(n_elements));
    elements.add_nodal_normals(normals.leftCols(n_nodes));
    elements.compute_interior_normals(normals.rightCols(n_elements));
    n_ = round_up_to_packs(static_cast<int>(points.cols()));
    for (int a = 0; a < 3; a++) {
      points_[a].assign(n_, kFarAway);
      normals_[a].assign(n_, 0.0);
      for (Eigen::Index s = 0; s < points.cols(); s++) {
        points_[a][s] = points(a, s);
        normals_[a][s] = normals(a, s);
      }
    }
  }

  // sum of -6 r r (r.n)/r^5; a point that coincides with the target is left out.
  Mat3 compute_tensor(const Vec3 &target) const
  {
    const Pack zero = {};
    Pack xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
    for (int s = 0; s < n_; s += kLanes) {
      const Pack x = target[0] - load(&points_[0][s]), y = target[1] - load(&points_[1][s]),
                 z = target[2] - load(&points_[2][s]);
      const Pack r2 = x * x + y * y + z * z;
      const Mask is_apart = less(zero, r2);
      const Pack inverse = inverse_square_root(select(is_apart, r2, broadcast(1.0)));
      const Pack inverse2 = inverse * inverse;
      const Pack along_normal = x * load(&normals_[0][s]) + y * load(&normals_[1][s]) +
                                z * load(&normals_[2][s]);
      const Pack factor = (along_normal * inverse) * (inverse2 * inverse2);
      const Pack fx = factor * x, fy = factor * y, fz = factor * z;
      xx += fx * x;
      xy += fx * y;
      xz += fx * z;
      yy += fy * y;
      yz += fy * z;
      zz += fz * z;
    }
    Mat3 tensor;
    tensor << sum(xx), sum(xy), sum(xz), sum(xy), sum(yy), sum(yz), sum(xz), sum(yz), sum(zz);
    return -6.0 * tensor;
  }

 private:
  int n_;
  std::array<std::vector<double>, 3> points_, normals_;
};

// Targets, coordinate by coordinate, of which few are near an element.
class NearTargets {
 public:
  NearTargets(PointsView nodes, const std::vector<int> &targets) : nodes_(nodes), targets_(targets)
  {
    found_.resize(targets.size() + kLanes);
    for (int a = 0; a < 3; a++) {
      points_[a].assign(targets.size() + kLanes, kFarAway);
      for (size_t t = 0; t < targets.size(); t++)
        points_[a][t] = nodes(a, targets[t]);
    }
  }

  // Within kNearFactor mean edges of a corner of the element: number, and nodes in found(). First
  // those around the centre, which is less than a mean edge from every corner.
  int find(const SurfaceElements &elements, int element, const Vec3 &center)
  {
    const double reach = kNearFactor * elements.mean_edge(element);
    const Pack limit2 = broadcast(std::pow(reach + elements.mean_edge(element), 2));
    int n = 0;
    for (int t = 0; t < static_cast<int>(targets_.size()); t += kLanes) {
      const Pack x = load(&points_[0][t]) - center[0], y = load(&points_[1][t]) - center[1],
                 z = load(&points_[2][t]) - center[2];
      const Mask is_close = less(x * x + y * y + z * z, limit2);
      if (any(is_close)) n += compress_store_counted(&found_[n], is_close, t);
    }
    for (int k = 0; k < n; k++)
      found_[k] = targets_[found_[k]];
    return elements.find_within(element, reach, found_.data(), n, nodes_, found_.data());
  }

  const int *found() const { return found_.data(); }

 private:
  PointsView nodes_;
  const std::vector<int> &targets_;
  std::array<std::vector<double>, 3> points_;
  std::vector<int> found_;
};

}    // namespace

std::vector<Mat3> compute_free_row_sums(PointsView nodes, const std::vector<Triangle> &triangles,
                                        const std::vector<int> &targets)
{
  FlatElements elements;
  elements.set_geometry(nodes, triangles);
  std::vector<Mat3> tensors(nodes.cols(), Mat3::Zero());
  const FarRule far_rule(elements, nodes);
  for (int t : targets)
    tensors[t] = far_rule.compute_tensor(nodes.col(t));
  NearTargets near(nodes, targets);
  Points centers(3, elements.n_elements());
  elements.compute_interior_points(centers);
  for (int e = 0; e < elements.n_elements(); e++) {
    const int n = near.find(elements, e, centers.col(e));
    elements.add_near_tensors(e, near.found(), n, nodes, tensors);
  }
  std::vector<Mat3> sums;
  for (int t : targets)
    sums.push_back(tensors[t]);
  return sums;
}

std::vector<Mat3> compute_free_row_sums(PointsView nodes, const std::vector<Triangle> &triangles)
{
  std::vector<int> all(nodes.cols());
  std::iota(all.begin(), all.end(), 0);
  return compute_free_row_sums(nodes, triangles, all);
}

}    // namespace biem
