// Flat triangles: geometry, degree-2 far rule, consistent mass, near correction.
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_simd_math.h"
#include <cmath>

namespace biem {

namespace {
// Degree-2 rule on a triangle: vertices area/12 each, centroid 3/4 area.
constexpr double kVertexWeight = 1.0 / 12.0;
constexpr double kCentroidWeight = 3.0 / 4.0;

// Columns index[0 ... n) of points, one per lane; the last one fills the rest.
BIEM_INLINE PointPack gather(PointsView points, const int *index, int n)
{
  const double *p[kLanes];
  for (int l = 0; l < kLanes; l++)
    p[l] = points.data() + points.outerStride() * index[l < n ? l : n - 1];
  PointPack x;
#pragma GCC unroll 8
  for (int l = 0; l < kLanes; l++) {
    x.x[l] = p[l][0];
    x.y[l] = p[l][1];
    x.z[l] = p[l][2];
  }
  return x;
}

BIEM_INLINE PointPack subtract(const PointPack &a, const Vec3 &b)
{
  return {a.x - b[0], a.y - b[1], a.z - b[2]};
}

BIEM_INLINE Pack dot(const PointPack &a, const Vec3 &b)
{
  return a.x * b[0] + a.y * b[1] + a.z * b[2];
}

BIEM_INLINE Pack squared_norm(const PointPack &a)
{
  return a.x * a.x + a.y * a.y + a.z * a.z;
}

// velocity -= one point of the far rule, single-layer strength f (or null) and double-layer
// strength q (or null) with unit normal n; zero at a target that coincides with the point.
BIEM_INLINE void subtract_rule_point(PointPack &velocity, const PointPack &r, const Vec3 *f,
                                     const Vec3 *q, const Vec3 &n)
{
  const Pack zero = {}, r2 = squared_norm(r);
  const Mask apart = less(zero, r2);
  const Pack inverse = select(apart, inverse_square_root(select(apart, r2, broadcast(1.0))), zero);
  const Pack inverse2 = inverse * inverse, inverse3 = inverse * inverse2;
  Pack along = zero;
  if (f) {
    along = dot(r, *f) * inverse3;
    velocity.x -= inverse * (*f)[0];
    velocity.y -= inverse * (*f)[1];
    velocity.z -= inverse * (*f)[2];
  }
  if (q) along -= 6.0 * dot(r, *q) * dot(r, n) * (inverse3 * inverse2);
  velocity.x -= along * r.x;
  velocity.y -= along * r.y;
  velocity.z -= along * r.z;
}

// tensor -= one point of the far rule of the double layer, its weight times -6 and unit normal.
BIEM_INLINE void subtract_rule_tensor(TensorPack &tensor, const PointPack &r, double weight,
                                      const Vec3 &n)
{
  const Pack zero = {}, r2 = squared_norm(r);
  const Mask apart = less(zero, r2);
  const Pack inverse = select(apart, inverse_square_root(select(apart, r2, broadcast(1.0))), zero);
  const Pack inverse2 = inverse * inverse;
  const Pack factor = weight * dot(r, n) * (inverse2 * inverse2 * inverse);
  const Pack fx = factor * r.x, fy = factor * r.y, fz = factor * r.z;
  tensor.xx -= fx * r.x;
  tensor.xy -= fx * r.y;
  tensor.xz -= fx * r.z;
  tensor.yy -= fy * r.y;
  tensor.yz -= fy * r.z;
  tensor.zz -= fz * r.z;
}
}    // namespace

void FlatElements::set_geometry(PointsView nodes, const std::vector<Triangle> &triangles)
{
  triangles_ = triangles;
  n_nodes_ = nodes.cols();
  single_ = double_ = PreparedDensity();
  layers_.clear();
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

void FlatElements::add_area_gradient(PointsRef gradient) const
{
  // A corner moves the area by half the opposite edge, turned outwards in the triangle's plane.
  for (int e = 0; e < n_elements(); e++)
    for (int v = 0; v < 3; v++) {
      const Vec3 edge = corners_[e][(v + 2) % 3] - corners_[e][(v + 1) % 3];
      gradient.col(triangles_[e][v]) += 0.5 * frames_[e].normal.cross(edge);
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

void FlatElements::add_nodal_normals(PointsRef normals) const
{
  for (int e = 0; e < n_elements(); e++) {
    const Vec3 share = (kVertexWeight * area(e)) * frames_[e].normal;
    for (int v = 0; v < 3; v++)
      normals.col(triangles_[e][v]) += share;
  }
}

void FlatElements::compute_interior_normals(PointsRef normals) const
{
  for (int e = 0; e < n_elements(); e++)
    normals.col(e) = (kCentroidWeight * area(e)) * frames_[e].normal;
}

void FlatElements::compute_interior_means(PointsView density, PointsRef means) const
{
  for (int e = 0; e < n_elements(); e++) {
    const Triangle &t = triangles_[e];
    means.col(e) = (density.col(t[0]) + density.col(t[1]) + density.col(t[2])) / 3.0;
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

int FlatElements::find_within(int e, double distance, const int *candidates, int n,
                              PointsView nodes, int *found) const
{
  int n_found = 0;
  const std::array<Vec3, 3> &x = corners_[e];
  for (int k = 0; k < n; k += kLanes) {
    const int m = n - k < kLanes ? n - k : kLanes;
    const PointPack targets = gather(nodes, candidates + k, m);
    Pack nearest = squared_norm(subtract(targets, x[0]));
    for (int v = 1; v < 3; v++) {
      const Pack other = squared_norm(subtract(targets, x[v]));
      nearest = select(less(other, nearest), other, nearest);
    }
    double squared[kLanes];
    store(squared, nearest);
    for (int l = 0; l < m; l++) {    // written always and kept if near: no branch to mispredict
      found[n_found] = candidates[k + l];
      n_found += squared[l] <= distance * distance;
    }
  }
  return n_found;
}

bool FlatElements::carries_single(int e) const
{
  return !single_.linear.empty() && (layers_.empty() || has_single(layers_[e]));
}

bool FlatElements::carries_double(int e) const
{
  return !double_.linear.empty() && (layers_.empty() || has_double(layers_[e]));
}

bool FlatElements::has_near(int e) const
{
  if (single_.linear.empty() && double_.linear.empty())
    throw Error("near corrections were asked for without a density: call prepare_near() after "
                "every set_geometry(), with a single-layer or a double-layer density");
  return carries_single(e) || carries_double(e);
}

FlatElements::PreparedDensity FlatElements::prepare(PointsView density, Layers layer) const
{
  PreparedDensity prepared;
  if (density.cols() == 0) return prepared;
  const std::string name = layer == Layers::Single ? "single" : "double";
  if (density.cols() < n_nodes_)
    throw Error("near corrections: the " + name + "-layer density has " +
                std::to_string(density.cols()) + " values for " + std::to_string(n_nodes_) +
                " nodes; give one for every node, ghosts included, or none");
  prepared.linear.resize(triangles_.size());
  prepared.rule.resize(triangles_.size());
  for (int e = 0; e < n_elements(); e++) {
    if (!layers_.empty() && layers_[e] != layer && layers_[e] != Layers::Both) continue;
    Mat3 f;
    for (int v = 0; v < 3; v++)
      f.col(v) = density.col(triangles_[e][v]);
    prepared.linear[e] = make_linear_density(frames_[e], f);
    for (int v = 0; v < 3; v++)
      prepared.rule[e][v] = (kVertexWeight * area(e)) * f.col(v);
    prepared.rule[e][3] = (kCentroidWeight * area(e) / 3.0) * f.rowwise().sum();
  }
  return prepared;
}

void FlatElements::prepare_near(PointsView single_layer_density, PointsView double_layer_density,
                                const std::vector<Layers> *layers)
{
  if (layers && layers->size() != triangles_.size())
    throw Error("near corrections: layers are given for " + std::to_string(layers->size()) +
                " of " + std::to_string(triangles_.size()) +
                " elements; give one of each, or none");
  layers_ = layers ? *layers : std::vector<Layers>();
  single_ = prepare(single_layer_density, Layers::Single);
  double_ = prepare(double_layer_density, Layers::Double);
}

template <Layers layers>
PointPack FlatElements::compute_corrections(int e, const PointPack &targets) const
{
  const LinearDensity *f = has_single(layers) ? &single_.linear[e] : nullptr;
  const LinearDensity *q = has_double(layers) ? &double_.linear[e] : nullptr;
  PointPack u = integrate_near_triangle<layers>(frames_[e], f, q, targets);
  for (int v = 0; v < 4; v++)
    subtract_rule_point(u, subtract(targets, v < 3 ? corners_[e][v] : centroid(e)),
                        has_single(layers) ? &single_.rule[e][v] : nullptr,
                        has_double(layers) ? &double_.rule[e][v] : nullptr, frames_[e].normal);
  return u;
}

void FlatElements::add_near_corrections(int e, const int *targets, int n, PointsView nodes,
                                        PointsRef velocities) const
{
  const bool is_single = carries_single(e), is_double = carries_double(e);
  if (!is_single && !is_double && !has_near(e)) return;
  for (int k = 0; k < n; k += kLanes) {
    const int m = n - k < kLanes ? n - k : kLanes;
    const PointPack x = gather(nodes, targets + k, m);
    const PointPack u = !is_double   ? compute_corrections<Layers::Single>(e, x)
                        : !is_single ? compute_corrections<Layers::Double>(e, x)
                                     : compute_corrections<Layers::Both>(e, x);
    for (int l = 0; l < m; l++) {
      double *velocity = velocities.data() + velocities.outerStride() * targets[k + l];
      velocity[0] += u.x[l];
      velocity[1] += u.y[l];
      velocity[2] += u.z[l];
    }
  }
}

void FlatElements::add_near_tensors(int e, const int *targets, int n, PointsView nodes,
                                    std::vector<Mat3> &tensors) const
{
  for (int k = 0; k < n; k += kLanes) {
    const int m = n - k < kLanes ? n - k : kLanes;
    const PointPack x = gather(nodes, targets + k, m);
    TensorPack t = integrate_near_triangle_tensor(frames_[e], x);
    for (int v = 0; v < 4; v++)
      subtract_rule_tensor(t, subtract(x, v < 3 ? corners_[e][v] : centroid(e)),
                           -6.0 * (v < 3 ? kVertexWeight : kCentroidWeight) * area(e),
                           frames_[e].normal);
    for (int l = 0; l < m; l++) {
      Mat3 tensor;
      tensor << t.xx[l], t.xy[l], t.xz[l], t.xy[l], t.yy[l], t.yz[l], t.xz[l], t.yz[l], t.zz[l];
      tensors[targets[k + l]] += tensor;
    }
  }
}

}    // namespace biem
