// Closed forms on a flat triangle: every surface integral of 1/r, 1/r^3 times polynomials reduces,
// by the divergence theorem in the plane, to three edge integrals and the solid angle (doc/theory,
// label near-triangle). Checked against adaptive quadrature to 1e-13.
#include "biem_near_triangle.h"
#include <cmath>

namespace biem {

namespace {

// A height below this fraction of the triangle's size is taken as zero: the limit from either side
// is the same for the single layer, and rounding noise in the solid angle would be amplified.
constexpr double kHeightSnap = 1e-12;

// Moments over the triangle, in-plane vector rho = y - (target's projection), height d:
struct Moments {
  double i = 0.0;                                           // int 1/r
  double k1 = 0.0, k2 = 0.0;                                // int rho_i / r
  double a1 = 0.0, a2 = 0.0;                                // int rho_i / r^3
  double a11 = 0.0, a12 = 0.0, a22 = 0.0;                   // int rho_i rho_j / r^3
  double a111 = 0.0, a112 = 0.0, a122 = 0.0, a222 = 0.0;    // int rho_i rho_j rho_k / r^3
  double height_times_solid_angle = 0.0;                    // d^2 int 1/r^3 = |d| Omega
};

// ln((r_b + s_b)/(r_a + s_a)) along an edge, by the branch that does not cancel.
double compute_edge_logarithm(double s_a, double s_b, double r_a, double r_b, double distance2)
{
  if (s_a >= 0.0) {
    const double q = r_a + s_a;
    return q > 0.0 ? std::log((r_b + s_b) / q) : 0.0;
  }
  if (s_b <= 0.0) {
    const double q = r_b - s_b;
    return q > 0.0 ? std::log((r_a - s_a) / q) : 0.0;
  }
  return distance2 > 0.0 ? std::log((r_b + s_b) * (r_a - s_a) / distance2) : 0.0;
}

Moments compute_moments(const TriangleFrame &t, const double rx[3], const double ry[3], double d)
{
  const double d2 = d * d;
  double r[3];
  for (int k = 0; k < 3; k++)
    r[k] = std::sqrt(rx[k] * rx[k] + ry[k] * ry[k] + d2);
  Moments m;
  const double height = std::fabs(d);
  double solid_angle = 0.0;
  if (height > 0.0) {    // van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 125 (1983)
    const double denominator = r[0] * r[1] * r[2] + (rx[0] * rx[1] + ry[0] * ry[1] + d2) * r[2] +
                               (rx[1] * rx[2] + ry[1] * ry[2] + d2) * r[0] +
                               (rx[2] * rx[0] + ry[2] * ry[0] + d2) * r[1];
    solid_angle = 2.0 * std::atan2(height * t.twice_area, denominator);
  }
  m.height_times_solid_angle = height * solid_angle;
  m.i = -m.height_times_solid_angle;
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3;
    const double n1 = t.outward[k][0], n2 = t.outward[k][1];
    const double t1 = t.tangent[k][0], t2 = t.tangent[k][1];
    const double p = n1 * rx[k] + n2 * ry[k];
    const double sa = t1 * rx[k] + t2 * ry[k], sb = t1 * rx[l] + t2 * ry[l];
    const double distance2 = p * p + d2;
    const double log_term = compute_edge_logarithm(sa, sb, r[k], r[l], distance2);
    const double difference = r[l] - r[k], moment = sb * r[l] - sa * r[k];
    const double e = 0.5 * (moment + distance2 * log_term);
    const double q = 0.5 * (moment - distance2 * log_term);
    const double pl = p * log_term, pd = p * difference, ppl = p * pl;
    m.i += pl;
    m.k1 += n1 * e;
    m.k2 += n2 * e;
    m.a1 -= n1 * log_term;
    m.a2 -= n2 * log_term;
    m.a11 -= n1 * (n1 * pl + t1 * difference);
    m.a12 -= n1 * (n2 * pl + t2 * difference);
    m.a22 -= n2 * (n2 * pl + t2 * difference);
    const double m11 = ppl * n1 * n1 + 2.0 * pd * n1 * t1 + q * t1 * t1;
    const double m12 = ppl * n1 * n2 + pd * (n1 * t2 + t1 * n2) + q * t1 * t2;
    const double m22 = ppl * n2 * n2 + 2.0 * pd * n2 * t2 + q * t2 * t2;
    m.a111 -= n1 * m11;
    m.a112 -= n1 * m12;
    m.a122 -= n1 * m22;
    m.a222 -= n2 * m22;
  }
  m.a11 += m.i;
  m.a22 += m.i;
  m.a111 += 2.0 * m.k1;
  m.a112 += m.k2;
  m.a222 += 2.0 * m.k2;
  return m;
}

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
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, opposite = (k + 2) % 3;
    const double dx = t.vertex[l][0] - t.vertex[k][0], dy = t.vertex[l][1] - t.vertex[k][1];
    const double edge = std::sqrt(dx * dx + dy * dy);
    t.tangent[k][0] = dx / edge;
    t.tangent[k][1] = dy / edge;
    t.outward[k][0] = dy / edge;
    t.outward[k][1] = -dx / edge;
    t.hat_gradient[opposite][0] = -dy / t.twice_area;
    t.hat_gradient[opposite][1] = dx / t.twice_area;
  }
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
  return f;
}

Vec3 compute_single_layer(const TriangleFrame &t, const LinearDensity &f, const Vec3 &target)
{
  const Vec3 offset = target - t.origin;
  const double x = offset.dot(t.axis1), y = offset.dot(t.axis2);
  double d = offset.dot(t.normal);
  if (d * d < kHeightSnap * kHeightSnap * t.twice_area) d = 0.0;
  double rx[3], ry[3];
  for (int k = 0; k < 3; k++) {
    rx[k] = t.vertex[k][0] - x;
    ry[k] = t.vertex[k][1] - y;
  }
  const Moments m = compute_moments(t, rx, ry, d);
  const double(*b)[2] = f.gradient;
  double a[3];    // density at the target's projection: f(y) = a + b rho
  for (int i = 0; i < 3; i++)
    a[i] = f.at_origin[i] - b[i][0] * rx[0] - b[i][1] * ry[0];

  // r = target - y = (-rho, d), hence the signs of the mixed terms
  double u1 = a[0] * m.i + b[0][0] * m.k1 + b[0][1] * m.k2;
  double u2 = a[1] * m.i + b[1][0] * m.k1 + b[1][1] * m.k2;
  double u3 = a[2] * m.i + b[2][0] * m.k1 + b[2][1] * m.k2;
  const double shear = b[0][1] + b[1][0];
  u1 += m.a11 * a[0] + m.a12 * a[1] + m.a111 * b[0][0] + m.a112 * shear + m.a122 * b[1][1] -
        d * (m.a1 * a[2] + m.a11 * b[2][0] + m.a12 * b[2][1]);
  u2 += m.a12 * a[0] + m.a22 * a[1] + m.a112 * b[0][0] + m.a122 * shear + m.a222 * b[1][1] -
        d * (m.a2 * a[2] + m.a12 * b[2][0] + m.a22 * b[2][1]);
  u3 += -d * (m.a1 * a[0] + m.a2 * a[1] + m.a11 * b[0][0] + m.a12 * shear + m.a22 * b[1][1]) +
        m.height_times_solid_angle * a[2] + d * d * (m.a1 * b[2][0] + m.a2 * b[2][1]);
  return u1 * t.axis1 + u2 * t.axis2 + u3 * t.normal;
}

}    // namespace biem
