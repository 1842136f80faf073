// Closed forms of one flat triangle against adaptive subdivision quadrature, for targets above,
// beside and on the triangle; continuity of the single layer, jump of the double layer.
#include "biem_kernel_stokeslet.h"
#include "biem_kernel_stresslet.h"
#include "biem_near_triangle.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

const Vec3 kA(0.1, -0.2, 0.3), kB(1.2, 0.1, 0.2), kC(0.4, 0.9, 0.5);

Mat3 make_density()
{
  Mat3 f;
  f << 1.0, -0.5, 0.3, 0.2, 0.8, -1.0, -0.7, 0.4, 0.6;
  return f;
}

struct Patch {
  Vec3 x[3];
  Mat3 f;    // density at the corners
};

Vec3 evaluate_kernel(Layers layer, const Patch &p, const Vec3 &r, const Vec3 &density)
{
  if (layer == Layers::Single) return compute_stokeslet(r, density);
  return compute_stresslet(r, density, (p.x[1] - p.x[0]).cross(p.x[2] - p.x[0]).normalized());
}

// Degree-5 rule of 7 points (Radon), then subdivision into four until a patch is small against its
// distance from the target; what is left around a target on the triangle is dropped.
Vec3 integrate(Layers layer, const Patch &p, const Vec3 &target, int depth)
{
  const Vec3 center = (p.x[0] + p.x[1] + p.x[2]) / 3.0;
  double size = 0.0;
  for (int v = 0; v < 3; v++)
    size = std::max(size, (p.x[v] - center).norm());
  if (depth == 0) return Vec3::Zero();
  if ((center - target).norm() > 20.0 * size) {
    const double area = 0.5 * (p.x[1] - p.x[0]).cross(p.x[2] - p.x[0]).norm();
    const double root = std::sqrt(15.0);
    const double a[3] = {1.0 / 3.0, (6.0 - root) / 21.0, (6.0 + root) / 21.0};
    const double w[3] = {9.0 / 40.0, (155.0 - root) / 1200.0, (155.0 + root) / 1200.0};
    Vec3 sum = Vec3::Zero();
    for (int rule = 0; rule < 3; rule++)
      for (int v = 0; v < (rule == 0 ? 1 : 3); v++) {
        Vec3 barycentric = Vec3::Constant(a[rule]);
        barycentric[v] = 1.0 - 2.0 * a[rule];
        Mat3 corners;
        corners << p.x[0], p.x[1], p.x[2];
        sum += w[rule] * area *
               evaluate_kernel(layer, p, target - corners * barycentric, p.f * barycentric);
      }
    return sum;
  }
  Vec3 sum = Vec3::Zero();
  const Vec3 m[3] = {0.5 * (p.x[0] + p.x[1]), 0.5 * (p.x[1] + p.x[2]), 0.5 * (p.x[2] + p.x[0])};
  Mat3 g;
  g << 0.5 * (p.f.col(0) + p.f.col(1)), 0.5 * (p.f.col(1) + p.f.col(2)),
      0.5 * (p.f.col(2) + p.f.col(0));
  for (int v = 0; v < 4; v++) {
    Patch child;
    child.x[0] = v < 3 ? p.x[v] : m[0];
    child.x[1] = v < 3 ? m[v] : m[1];
    child.x[2] = v < 3 ? m[(v + 2) % 3] : m[2];
    if (v < 3)
      child.f << p.f.col(v), g.col(v), g.col((v + 2) % 3);
    else
      child.f = g;
    sum += integrate(layer, child, target, depth - 1);
  }
  return sum;
}

Vec3 closed_form(Layers layer, const Vec3 &target)
{
  const TriangleFrame frame = make_triangle_frame(kA, kB, kC);
  const LinearDensity f = make_linear_density(frame, make_density());
  const PointPack x{broadcast(target[0]), broadcast(target[1]), broadcast(target[2])};
  const PointPack u = layer == Layers::Single
                          ? integrate_near_triangle<Layers::Single>(frame, &f, nullptr, x)
                          : integrate_near_triangle<Layers::Double>(frame, nullptr, &f, x);
  return Vec3(u.x[0], u.y[0], u.z[0]);
}

Vec3 quadrature(Layers layer, const Vec3 &target, int depth = 12)
{
  return integrate(layer, Patch{{kA, kB, kC}, make_density()}, target, depth);
}

const Vec3 kNormal = (kB - kA).cross(kC - kA).normalized(), kCenter = (kA + kB + kC) / 3.0;
const double kSize = (kB - kA).norm();

// Above the inside, a corner, an edge, the line of an edge, and beside the triangle.
const std::vector<Vec3> kFeet = {kCenter, kA, 0.5 * (kA + kB), kB + 0.4 * (kB - kC),
                                 kA + 1.5 * (kB - kA)};

// Of the quadrature: its remainder grows with the powers of 1/r in the kernel.
double tolerance(Layers layer)
{
  return layer == Layers::Single ? 1e-9 : 1e-8;
}

class NearTriangle : public ::testing::TestWithParam<Layers> {};

INSTANTIATE_TEST_SUITE_P(Layers, NearTriangle, ::testing::Values(Layers::Single, Layers::Double));

}    // namespace

TEST_P(NearTriangle, AgreesWithAdaptiveQuadratureOffTheTriangle)
{
  for (const Vec3 &foot : kFeet)
    for (double height : {1000.0, 30.0, 1.0, 0.1, -0.1, 0.01}) {
      const Vec3 target = foot + height * kSize * kNormal, exact = quadrature(GetParam(), target);
      // the moments cancel as the third power of the distance
      const double rounding = 1e-14 * std::pow(std::max(1.0, std::fabs(height)), 3);
      EXPECT_LT((closed_form(GetParam(), target) - exact).norm(),
                (tolerance(GetParam()) + rounding) * exact.norm())
          << height;
    }
}

TEST_P(NearTriangle, AgreesWithAdaptiveQuadratureVeryCloseToTheTriangle)
{
  for (const Vec3 &foot : kFeet)
    for (double height : {1e-3, -1e-3}) {
      const Vec3 target = foot + height * kSize * kNormal;
      const Vec3 exact = quadrature(GetParam(), target, 17);
      EXPECT_LT((closed_form(GetParam(), target) - exact).norm(),
                tolerance(GetParam()) * exact.norm())
          << height;
    }
}

TEST(NearTriangleSingleLayer, AgreesWithAdaptiveQuadratureOnTheTriangle)
{
  // The patches that hold the target are dropped: an error of the order of their size, 20 x 2^-24.
  for (const Vec3 &target :
       {kCenter, kA, kB, kC, Vec3(0.5 * (kA + kB)), Vec3(0.3 * kB + 0.7 * kC)}) {
    const Vec3 exact = quadrature(Layers::Single, target, 24);
    EXPECT_LT((closed_form(Layers::Single, target) - exact).norm(), 1e-5 * exact.norm());
  }
}

TEST(NearTriangleSingleLayer, IsContinuousThroughTheTriangleAndItsPlane)
{
  for (const Vec3 &foot : kFeet) {
    const Vec3 on = closed_form(Layers::Single, foot);
    for (double height : {1e-6, 1e-9, 1e-12, 1e-15, -1e-9})
      EXPECT_LT((closed_form(Layers::Single, foot + height * kNormal) - on).norm(),
                (1e-12 + 40.0 * std::fabs(height)) * on.norm())
          << height;
  }
}

TEST(NearTriangleDoubleLayer, VanishesInThePlane)
{
  for (const Vec3 &foot : kFeet)
    EXPECT_EQ(closed_form(Layers::Double, foot), Vec3(Vec3::Zero()));
}

TEST(NearTriangleDoubleLayer, JumpsByTheDensityAcrossTheTriangle)
{
  // -+ 4 pi q on the outside and the inside: from 8 pi inside to 0 outside of a closed surface.
  const Vec3 q = make_density().rowwise().mean();
  for (double height : {1e-6, 1e-8, 1e-10}) {
    EXPECT_LT((closed_form(Layers::Double, kCenter - height * kNormal) - 4.0 * M_PI * q).norm(),
              300.0 * height);
    EXPECT_LT((closed_form(Layers::Double, kCenter + height * kNormal) + 4.0 * M_PI * q).norm(),
              300.0 * height);
  }
}
