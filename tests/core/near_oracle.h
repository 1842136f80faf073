// Scalar oracle of the closed forms on a flat triangle in extended precision, with every moment
// tensor written out: int rho_i.../r, /r^3 and d^n int rho_i.../r^5. Slow and plain on purpose.
#ifndef BIEM_TEST_NEAR_ORACLE_H
#define BIEM_TEST_NEAR_ORACLE_H

#include "biem_types.h"
#include <cmath>

namespace near_oracle {

using Real = long double;
using Vec3 = Eigen::Matrix<Real, 3, 1>;
using Vec2 = Eigen::Matrix<Real, 2, 1>;
using Mat2 = Eigen::Matrix<Real, 2, 2>;

struct Integrals {
  Vec3 single_layer, double_layer;
};

struct Edge {
  Vec2 n, t;
  Real p, moments1[3], moments3[3];    // int s^m r^-1 ds, int s^m r^-3 ds
  Real integral_of_r;
};

inline Real guarded(Real x)
{
  return x > 0 ? 1 / x : 0;
}

inline Edge make_edge(const Vec2 &a, const Vec2 &b, Real d)
{
  Edge e;
  e.t = (b - a).normalized();
  e.n = Vec2(e.t[1], -e.t[0]);
  e.p = e.n.dot(a);
  const Real sa = e.t.dot(a), sb = e.t.dot(b), d2 = e.p * e.p + d * d;
  const Real ra = std::sqrt(a.squaredNorm() + d * d), rb = std::sqrt(b.squaredNorm() + d * d);
  Real log = 0;
  if (sa >= 0)
    log = ra + sa > 0 ? std::log((rb + sb) / (ra + sa)) : 0;
  else if (sb <= 0)
    log = rb - sb > 0 ? std::log((ra - sa) / (rb - sb)) : 0;
  else if (d2 > 0)
    log = std::log((rb + sb) * (ra - sa) / d2);
  const Real moment = sb * rb - sa * ra, ratio = sb * guarded(rb) - sa * guarded(ra);
  e.moments1[0] = log;
  e.moments1[1] = rb - ra;
  e.moments1[2] = (moment - d2 * log) / 2;
  e.integral_of_r = (moment + d2 * log) / 2;
  e.moments3[0] = sa * sb > 0
                      ? (sb * sb - sa * sa) * guarded(ra * rb * std::fabs(sb * ra + sa * rb)) *
                            (sb > 0 ? 1 : -1)
                      : ratio * guarded(d2);
  e.moments3[1] = guarded(ra) - guarded(rb);
  e.moments3[2] = log - ratio;
  return e;
}

// Moment tensors over the triangle, rank 0 to 3.
struct Tensors {
  Real m0 = 0, m1[2] = {}, m2[2][2] = {}, m3[2][2][2] = {};
};

// sum over the edges of n_i int rho_j rho_k r^-n ds: what the divergence theorem leaves.
inline Tensors sum_edges(const Edge (&edges)[3], const Real (Edge::*moments)[3])
{
  Tensors s;
  for (const Edge &e : edges) {
    const Real *m = e.*moments;
    s.m0 += e.p * m[0];
    for (int i = 0; i < 2; i++) {
      s.m1[i] += e.n[i] * m[0];
      for (int j = 0; j < 2; j++) {
        s.m2[i][j] += e.n[i] * (e.p * e.n[j] * m[0] + e.t[j] * m[1]);
        for (int k = 0; k < 2; k++)
          s.m3[i][j][k] +=
              e.n[i] * (e.p * e.p * e.n[j] * e.n[k] * m[0] +
                        e.p * (e.n[j] * e.t[k] + e.t[j] * e.n[k]) * m[1] + e.t[j] * e.t[k] * m[2]);
      }
    }
  }
  return s;
}

// int (v_i v_j) f_j weighted, with v = (-rho, d) and f = a + b rho, from the tensors of the weight.
inline Vec3 contract(const Tensors &t, Real d, const Vec3 &a, const Eigen::Matrix<Real, 3, 2> &b)
{
  Vec3 u = Vec3::Zero();
  Real along = t.m0 * a[2];    // int of weight f_3
  for (int j = 0; j < 2; j++) {
    along += t.m1[j] * b(2, j);
    u[2] -= d * t.m1[j] * a[j];
    for (int k = 0; k < 2; k++)
      u[2] -= d * t.m2[j][k] * b(j, k);
  }
  u[2] += d * d * along;
  for (int i = 0; i < 2; i++) {
    u[i] -= d * t.m1[i] * a[2];
    for (int j = 0; j < 2; j++) {
      u[i] += t.m2[i][j] * (a[j] - d * b(2, j));
      for (int k = 0; k < 2; k++)
        u[i] += t.m3[i][j][k] * b(j, k);
    }
  }
  return u;
}

// corners and density (columns at the corners) in global axes; lower targets count as in the plane.
inline Integrals integrate(const biem::Mat3 &corners, const biem::Mat3 &density,
                           const biem::Vec3 &target, Real smallest_height)
{
  const Eigen::Matrix<Real, 3, 3> x = corners.cast<Real>(), f = density.cast<Real>();
  Eigen::Matrix<Real, 3, 3> axes;
  axes.col(0) = (x.col(1) - x.col(0)).normalized();
  axes.col(2) = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  Eigen::Matrix<Real, 3, 3> v = axes.transpose() * (x.colwise() - target.cast<Real>());
  const Real twice_area = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
  Real d = -v(2, 0);
  if (std::fabs(d) < smallest_height) d = 0;
  v.row(2).setConstant(-d);

  const Real r[3] = {v.col(0).norm(), v.col(1).norm(), v.col(2).norm()};
  const Real denominator = r[0] * r[1] * r[2] + v.col(0).dot(v.col(1)) * r[2] +
                           v.col(1).dot(v.col(2)) * r[0] + v.col(2).dot(v.col(0)) * r[1];
  const Real omega = d == 0 ? 0 : 2 * std::atan2(std::fabs(d) * twice_area, denominator);
  const Real signed_omega = d > 0 ? omega : -omega;

  const Eigen::Matrix<Real, 3, 3> local = axes.transpose() * f;
  Eigen::Matrix<Real, 3, 3> plane;    // f = a + b rho at the corners
  plane << Vec3::Ones(), v.topRows(2).transpose();
  const Eigen::Matrix<Real, 3, 3> coefficients = (plane.inverse() * local.transpose()).transpose();
  const Vec3 a = coefficients.col(0);
  const Eigen::Matrix<Real, 3, 2> b = coefficients.rightCols(2);

  Edge edges[3];
  for (int k = 0; k < 3; k++)
    edges[k] = make_edge(v.col(k).head(2), v.col((k + 1) % 3).head(2), d);
  const Tensors first = sum_edges(edges, &Edge::moments1),
                third = sum_edges(edges, &Edge::moments3);
  const Real i1 = first.m0 - std::fabs(d) * omega;
  Real k[2] = {};
  for (const Edge &e : edges)
    for (int i = 0; i < 2; i++)
      k[i] += e.n[i] * e.integral_of_r;

  Tensors cubed,
      fifth;    // int rho.../r^3, d int rho.../r^5 (scalar: with d int 1/r^3, d^3 int 1/r^5)
  for (int i = 0; i < 2; i++) {
    cubed.m1[i] = -first.m1[i];
    fifth.m1[i] = -d * third.m1[i] / 3;
    for (int j = 0; j < 2; j++) {
      cubed.m2[i][j] = (i == j) * i1 - first.m2[i][j];
      fifth.m2[i][j] = ((i == j) * signed_omega - d * third.m2[i][j]) / 3;
      for (int l = 0; l < 2; l++) {
        cubed.m3[i][j][l] = (i == j) * k[l] + (i == l) * k[j] - first.m3[i][j][l];
        fifth.m3[i][j][l] =
            d * (-(i == j) * first.m1[l] - (i == l) * first.m1[j] - third.m3[i][j][l]) / 3;
      }
    }
  }
  Integrals result;
  result.single_layer = contract(cubed, d, a, b);
  for (int i = 0; i < 3; i++)
    result.single_layer[i] += a[i] * i1 + b(i, 0) * k[0] + b(i, 1) * k[1];
  result.single_layer[2] += std::fabs(d) * omega * a[2];    // d^2 int 1/r^3 = |d| omega
  result.double_layer = d == 0 ? Vec3(Vec3::Zero()) : Vec3(-6 * contract(fifth, d, a, b));
  if (d != 0) result.double_layer[2] -= 2 * (signed_omega + d * third.m0) * a[2];
  result.single_layer = axes * result.single_layer;
  result.double_layer = axes * result.double_layer;
  return result;
}

}    // namespace near_oracle

#endif
