// Closed forms on a flat triangle: every surface integral of 1/r, 1/r^3, 1/r^5 times polynomials
// reduces, by the divergence theorem in the plane, to three edge integrals and the solid angle
// (doc/theory, label near-triangle). In-plane vectors rho = y - (target's projection), height d of
// the target: r = (-rho, d), density f(y) = a + B rho.
#include "biem_near_triangle.h"
#include "biem_simd_math.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

// Heights below this fraction of L^3/(2 area), L the longest edge, are taken as zero: rounding
// moves the plane by 1e-16 of it, and at a triangle's own node the double layer would see a side
// that is not there. For the single layer the limit is the same from either side.
constexpr double kHeightSnap = 1e-12;

// The triangle seen from the targets.
struct View {
  Pack x, y, d;         // targets in the triangle's frame
  Pack rx[3], ry[3];    // rho of the vertices
  Pack r[3];            // distances to the vertices
  Pack solid_angle;     // >= 0
  Pack height;          // |d|
};

// One edge: p = rho.n along it, s = rho.t from s_a to s_b, moments E_m = int s^m r^-1 ds.
struct Edge {
  Pack p, s_a, s_b, r_a, r_b;
  Pack distance2;    // p^2 + d^2
  Pack logarithm;    // E_0
};

// a, and c = a - d B_3: what multiplies the in-plane moments.
struct DensityAtTarget {
  Pack a1, a2, a3, c1, c2;
};

// Sums over the edges that the single layer (n = 1) and the double layer (n = 3) have in common,
// with E_m = int s^m r^-n ds.
struct BoundarySum {
  Pack u1 = {}, u2 = {}, u3 = {};

  BIEM_INLINE void add(const TriangleFrame &t, const LinearDensity &f, int k,
                       const DensityAtTarget &v, Pack d, Pack p, const Pack (&e)[3])
  {
    const double n1 = t.outward[k][0], n2 = t.outward[k][1];
    const double t1 = t.tangent[k][0], t2 = t.tangent[k][1];
    const Pack normal = n1 * v.c1 + n2 * v.c2 + p * f.nn[k];
    const Pack tangential = t1 * v.c1 + t2 * v.c2 + p * f.shear[k];
    const Pack in_plane = e[0] * (p * normal - d * v.a3) + e[1] * tangential + e[2] * f.tt[k];
    u1 -= n1 * in_plane;
    u2 -= n2 * in_plane;
    u3 += e[0] * normal + e[1] * f.nt[k];
  }
};

BIEM_INLINE View look_from(const TriangleFrame &t, const PointPack &targets)
{
  View v;
  const Pack x = targets.x - t.origin[0], y = targets.y - t.origin[1], z = targets.z - t.origin[2];
  v.x = x * t.axis1[0] + y * t.axis1[1] + z * t.axis1[2];
  v.y = x * t.axis2[0] + y * t.axis2[1] + z * t.axis2[2];
  v.d = x * t.normal[0] + y * t.normal[1] + z * t.normal[2];
  const Pack snap = broadcast(t.smallest_height);
  v.d = select(less(absolute(v.d), snap), Pack{}, v.d);
  const Pack d2 = v.d * v.d;
  for (int k = 0; k < 3; k++) {
    v.rx[k] = t.vertex[k][0] - v.x;
    v.ry[k] = t.vertex[k][1] - v.y;
    v.r[k] = square_root(v.rx[k] * v.rx[k] + v.ry[k] * v.ry[k] + d2);
  }
  // van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 125 (1983)
  Pack denominator = v.r[0] * v.r[1] * v.r[2];
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3;
    denominator += (v.rx[k] * v.rx[l] + v.ry[k] * v.ry[l] + d2) * v.r[(k + 2) % 3];
  }
  v.height = absolute(v.d);
  v.solid_angle = 2.0 * upper_arctangent(v.height * t.twice_area, denominator);
  return v;
}

// int ds/r = ln((r_b + s_b)/(r_a + s_a)) along an edge, by the form that does not cancel. At a
// target on the edge 0 stands for it: there it only occurs times a distance that vanishes.
BIEM_INLINE Pack compute_edge_logarithm(const Edge &e)
{
  const Pack zero = {}, one = broadcast(1.0);
  const Mask starts_before = less(e.s_a, zero), ends_after = less(zero, e.s_b);
  const Pack forward_b = e.r_b + e.s_b, backward_a = e.r_a - e.s_a;
  Pack numerator = select(ends_after, forward_b * backward_a, backward_a);
  Pack denominator = select(ends_after, e.distance2, e.r_b - e.s_b);
  numerator = select(starts_before, numerator, forward_b);
  denominator = select(starts_before, denominator, e.r_a + e.s_a);
  const Mask off_the_edge = less(zero, denominator);
  return log_ratio(select(off_the_edge, numerator, one), select(off_the_edge, denominator, one));
}

BIEM_INLINE Edge make_edge(const TriangleFrame &t, const View &v, int k)
{
  const int l = (k + 1) % 3;
  Edge e;
  e.p = t.outward[k][0] * v.rx[k] + t.outward[k][1] * v.ry[k];
  e.s_a = t.tangent[k][0] * v.rx[k] + t.tangent[k][1] * v.ry[k];
  e.s_b = t.tangent[k][0] * v.rx[l] + t.tangent[k][1] * v.ry[l];
  e.r_a = v.r[k];
  e.r_b = v.r[l];
  e.distance2 = e.p * e.p + v.d * v.d;
  e.logarithm = compute_edge_logarithm(e);
  return e;
}

BIEM_INLINE DensityAtTarget evaluate_density(const LinearDensity &f, const View &v)
{
  const double(*b)[2] = f.gradient;
  DensityAtTarget a;
  a.a1 = f.at_origin[0] + b[0][0] * v.x + b[0][1] * v.y;
  a.a2 = f.at_origin[1] + b[1][0] * v.x + b[1][1] * v.y;
  a.a3 = f.at_origin[2] + b[2][0] * v.x + b[2][1] * v.y;
  a.c1 = a.a1 - v.d * b[2][0];
  a.c2 = a.a2 - v.d * b[2][1];
  return a;
}

// Single layer in the triangle's frame: moments int rho^m/r and int rho^m/r^3.
struct SingleLayer {
  DensityAtTarget at_target;
  BoundarySum sum;
  Pack edges = {};          // sum p E_0 = int 1/r + |d| (solid angle)
  Pack k1 = {}, k2 = {};    // int rho_i / r

  BIEM_INLINE void add_edge(const TriangleFrame &t, const LinearDensity &f, int k, const Edge &e,
                            Pack d)
  {
    const Pack moment = e.s_b * e.r_b - e.s_a * e.r_a, product = e.distance2 * e.logarithm;
    const Pack integral_of_r = 0.5 * (moment + product);
    sum.add(t, f, k, at_target, d, e.p, {e.logarithm, e.r_b - e.r_a, 0.5 * (moment - product)});
    edges += e.p * e.logarithm;
    k1 += t.outward[k][0] * integral_of_r;
    k2 += t.outward[k][1] * integral_of_r;
  }

  BIEM_INLINE PointPack finish(const LinearDensity &f, const View &v) const
  {
    const double(*b)[2] = f.gradient;
    const Pack i = edges - v.height * v.solid_angle;
    return {(at_target.a1 + at_target.c1) * i + k1 * (3.0 * b[0][0]) +
                k2 * (2.0 * b[0][1] + b[1][0]) + sum.u1,
            (at_target.a2 + at_target.c2) * i + k1 * (2.0 * b[1][0] + b[0][1]) +
                k2 * (3.0 * b[1][1]) + sum.u2,
            at_target.a3 * edges + k1 * b[2][0] + k2 * b[2][1] + v.d * (sum.u3 - i * f.divergence)};
  }
};

// int ds/r^3 = ratio/distance2 along an edge, ratio = s_b/r_b - s_a/r_a, by the form that does not
// cancel.
BIEM_INLINE Pack compute_inverse_cube_integral(const Edge &e, Pack ratio)
{
  const Mask beside = less(Pack{}, e.s_a * e.s_b);
  const Pack numerator = select(beside, (e.s_b - e.s_a) * (e.s_b + e.s_a), ratio);
  const Pack denominator =
      select(beside, e.r_a * e.r_b * (e.s_b * e.r_a + e.s_a * e.r_b), e.distance2);
  return numerator / denominator;
}

// Double layer in the triangle's frame: moments d^n int rho^m/r^5 with the powers of d that keep
// them finite as d -> 0.
struct DoubleLayer {
  DensityAtTarget at_target;
  BoundarySum sum;
  Pack edges = {};          // sum p int ds/r^3
  Pack a1 = {}, a2 = {};    // - int rho_i/r^3

  BIEM_INLINE void add_edge(const TriangleFrame &t, const LinearDensity &f, int k, const Edge &e,
                            Pack d, const Pack (&inverse_r)[3])
  {
    const Pack inverse_a = inverse_r[k], inverse_b = inverse_r[(k + 1) % 3];
    const Pack ratio = e.s_b * inverse_b - e.s_a * inverse_a;
    const Pack e0 = compute_inverse_cube_integral(e, ratio);
    sum.add(t, f, k, at_target, d, e.p, {e0, inverse_a - inverse_b, e.logarithm - ratio});
    edges += e.p * e0;
    a1 += t.outward[k][0] * e.logarithm;
    a2 += t.outward[k][1] * e.logarithm;
  }

  BIEM_INLINE PointPack finish(const LinearDensity &f, const View &v) const
  {
    const double(*b)[2] = f.gradient;
    const Pack zero = {}, d = v.d;
    const Pack angle = select(less(d, zero), -v.solid_angle, v.solid_angle);    // d int 1/r^3
    const double shear = b[0][1] + b[1][0];
    const Pack u1 = angle * at_target.c1 + d * (sum.u1 - a1 * (2.0 * b[0][0]) - a2 * shear);
    const Pack u2 = angle * at_target.c2 + d * (sum.u2 - a1 * shear - a2 * (2.0 * b[1][1]));
    const Pack u3 =
        angle * at_target.a3 + d * (edges * at_target.a3 + d * sum.u3 - angle * f.divergence);
    const Mask off_plane = less(zero, v.height);
    return {select(off_plane, -2.0 * u1, zero), select(off_plane, -2.0 * u2, zero),
            select(off_plane, -2.0 * u3, zero)};
  }
};

}    // namespace

TriangleFrame make_triangle_frame(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  TriangleFrame t;
  const Vec3 u = b - a, v = c - a, n = u.cross(v);
  const double length = u.norm();
  t.twice_area = n.norm();
  t.origin = a;
  t.normal = n / t.twice_area;
  t.axis1 = u / length;
  t.axis2 = t.normal.cross(t.axis1);
  t.vertex[0][0] = t.vertex[0][1] = t.vertex[1][1] = 0.0;
  t.vertex[1][0] = length;
  t.vertex[2][0] = v.dot(t.axis1);
  t.vertex[2][1] = v.dot(t.axis2);
  double longest = 0.0;
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, opposite = (k + 2) % 3;
    const double dx = t.vertex[l][0] - t.vertex[k][0], dy = t.vertex[l][1] - t.vertex[k][1];
    const double edge = std::sqrt(dx * dx + dy * dy);
    longest = std::max(longest, edge);
    t.tangent[k][0] = dx / edge;
    t.tangent[k][1] = dy / edge;
    t.outward[k][0] = dy / edge;
    t.outward[k][1] = -dx / edge;
    t.hat_gradient[opposite][0] = -dy / t.twice_area;
    t.hat_gradient[opposite][1] = dx / t.twice_area;
  }
  t.smallest_height = kHeightSnap * longest * longest * longest / t.twice_area;
  return t;
}

LinearDensity make_linear_density(const TriangleFrame &t, const Mat3 &density)
{
  LinearDensity f;
  const Vec3 *axes[3] = {&t.axis1, &t.axis2, &t.normal};
  for (int i = 0; i < 3; i++) {
    double value[3];
    for (int v = 0; v < 3; v++)
      value[v] = axes[i]->dot(density.col(v));
    f.at_origin[i] = value[0];
    for (int j = 0; j < 2; j++)
      f.gradient[i][j] = value[0] * t.hat_gradient[0][j] + value[1] * t.hat_gradient[1][j] +
                         value[2] * t.hat_gradient[2][j];
  }
  const double(*b)[2] = f.gradient;
  f.divergence = b[0][0] + b[1][1];
  for (int k = 0; k < 3; k++) {
    const double *n = t.outward[k], *s = t.tangent[k];
    const double bn[2] = {b[0][0] * n[0] + b[0][1] * n[1], b[1][0] * n[0] + b[1][1] * n[1]};
    const double bs[2] = {b[0][0] * s[0] + b[0][1] * s[1], b[1][0] * s[0] + b[1][1] * s[1]};
    f.nn[k] = n[0] * bn[0] + n[1] * bn[1];
    f.nt[k] = n[0] * bs[0] + n[1] * bs[1];
    f.tt[k] = s[0] * bs[0] + s[1] * bs[1];
    f.shear[k] = f.nt[k] + s[0] * bn[0] + s[1] * bn[1];
  }
  return f;
}

template <Layers layers>
PointPack integrate_near_triangle(const TriangleFrame &t, const LinearDensity *single_layer,
                                  const LinearDensity *double_layer, const PointPack &targets)
{
  const View v = look_from(t, targets);
  SingleLayer single;
  DoubleLayer dual;
  Pack inverse_r[3];
  if constexpr (has_single(layers)) single.at_target = evaluate_density(*single_layer, v);
  if constexpr (has_double(layers)) {
    dual.at_target = evaluate_density(*double_layer, v);
    for (int k = 0; k < 3; k++)
      inverse_r[k] = 1.0 / v.r[k];
  }
#pragma GCC unroll 3
  for (int k = 0; k < 3; k++) {
    const Edge e = make_edge(t, v, k);
    if constexpr (has_single(layers)) single.add_edge(t, *single_layer, k, e, v.d);
    if constexpr (has_double(layers)) dual.add_edge(t, *double_layer, k, e, v.d, inverse_r);
  }
  PointPack u = {};
  if constexpr (has_single(layers)) u = single.finish(*single_layer, v);
  if constexpr (has_double(layers)) {
    const PointPack w = dual.finish(*double_layer, v);
    u = {u.x + w.x, u.y + w.y, u.z + w.z};
  }
  return {u.x * t.axis1[0] + u.y * t.axis2[0] + u.z * t.normal[0],
          u.x * t.axis1[1] + u.y * t.axis2[1] + u.z * t.normal[1],
          u.x * t.axis1[2] + u.y * t.axis2[2] + u.z * t.normal[2]};
}

// In the triangle's frame DoubleLayer's formulas for a uniform density, without the density.
TensorPack integrate_near_triangle_tensor(const TriangleFrame &t, const PointPack &targets)
{
  const View v = look_from(t, targets);
  const Pack zero = {};
  Pack s11 = zero, s12 = zero, s22 = zero, s13 = zero, s23 = zero, edges = zero, inverse_r[3];
  for (int k = 0; k < 3; k++)
    inverse_r[k] = 1.0 / v.r[k];
#pragma GCC unroll 3
  for (int k = 0; k < 3; k++) {
    const Edge e = make_edge(t, v, k);
    const Pack inverse_a = inverse_r[k], inverse_b = inverse_r[(k + 1) % 3];
    const Pack e0 = compute_inverse_cube_integral(e, e.s_b * inverse_b - e.s_a * inverse_a);
    const Pack e1 = inverse_a - inverse_b, pe0 = e.p * e0;
    const double n1 = t.outward[k][0], n2 = t.outward[k][1];
    const Pack along2 = pe0 * n2 + e1 * t.tangent[k][1];
    s11 += n1 * (pe0 * n1 + e1 * t.tangent[k][0]);
    s12 += n1 * along2;
    s22 += n2 * along2;
    s13 += n1 * e0;
    s23 += n2 * e0;
    edges += pe0;
  }
  const Mask off_plane = less(zero, v.height);
  const Pack angle = select(less(v.d, zero), -v.solid_angle, v.solid_angle), d2 = v.d * v.d;
  const Pack m[3][3] = {{angle - v.d * s11, -v.d * s12, d2 * s13},
                        {-v.d * s12, angle - v.d * s22, d2 * s23},
                        {d2 * s13, d2 * s23, angle + v.d * edges}};
  const Vec3 *axes[3] = {&t.axis1, &t.axis2, &t.normal};
  auto turn = [&](int i, int j) {
    Pack sum = zero;
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        sum += ((*axes[a])[i] * (*axes[b])[j]) * m[a][b];
    return select(off_plane, -2.0 * sum, zero);
  };
  return {turn(0, 0), turn(0, 1), turn(0, 2), turn(1, 1), turn(1, 2), turn(2, 2)};
}

template PointPack integrate_near_triangle<Layers::Single>(const TriangleFrame &,
                                                           const LinearDensity *,
                                                           const LinearDensity *,
                                                           const PointPack &);
template PointPack integrate_near_triangle<Layers::Double>(const TriangleFrame &,
                                                           const LinearDensity *,
                                                           const LinearDensity *,
                                                           const PointPack &);
template PointPack integrate_near_triangle<Layers::Both>(const TriangleFrame &,
                                                         const LinearDensity *,
                                                         const LinearDensity *, const PointPack &);

}    // namespace biem
