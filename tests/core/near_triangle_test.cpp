// Closed-form single layer of one flat triangle against adaptive subdivision quadrature, for targets
// above, beside and on the triangle; far rule against the closed form as the distance grows.
#include "biem_element_flat.h"
#include "biem_kernel_stokeslet.h"
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

// Degree-5 rule of 7 points (Radon), then subdivision into four until a patch is small against its
// distance from the target; what is left around a target on the triangle is dropped.
Vec3 integrate(const Patch &p, const Vec3 &target, int depth)
{
  const Vec3 center = (p.x[0] + p.x[1] + p.x[2]) / 3.0;
  double size = 0.0;
  for (int v = 0; v < 3; v++) size = std::max(size, (p.x[v] - center).norm());
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
        sum += w[rule] * area * compute_stokeslet(target - corners * barycentric,
                                                  p.f * barycentric);
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
    sum += integrate(child, target, depth - 1);
  }
  return sum;
}

Vec3 closed_form(const Vec3 &target)
{
  const TriangleFrame frame = make_triangle_frame(kA, kB, kC);
  return compute_single_layer(frame, make_linear_density(frame, make_density()), target);
}

Vec3 quadrature(const Vec3 &target, int depth = 12)
{
  return integrate(Patch{{kA, kB, kC}, make_density()}, target, depth);
}

}    // namespace

TEST(NearTriangle, AgreesWithAdaptiveQuadratureOffTheTriangle)
{
  const Vec3 normal = (kB - kA).cross(kC - kA).normalized(), center = (kA + kB + kC) / 3.0;
  for (const Vec3 &foot : {center, kA, Vec3(0.5 * (kA + kB)), Vec3(kB + 0.4 * (kB - kC)),
                           Vec3(kA + 1.5 * (kB - kA))})
    for (double height : {1.0, 0.1, -0.1}) {
      const Vec3 target = foot + height * normal, exact = quadrature(target);
      EXPECT_LT((closed_form(target) - exact).norm(), 1e-9 * exact.norm()) << height;
    }
}

TEST(NearTriangle, AgreesWithAdaptiveQuadratureOnTheTriangle)
{
  // The patches that hold the target are dropped: an error of the order of their size, 20 x 2^-24.
  for (const Vec3 &target : {Vec3((kA + kB + kC) / 3.0), kA, kB, kC, Vec3(0.5 * (kA + kB)),
                             Vec3(0.3 * kB + 0.7 * kC)}) {
    const Vec3 exact = quadrature(target, 24);
    EXPECT_LT((closed_form(target) - exact).norm(), 1e-5 * exact.norm());
  }
}

TEST(NearTriangle, IsContinuousThroughTheTriangleAndItsPlane)
{
  const Vec3 normal = (kB - kA).cross(kC - kA).normalized();
  for (const Vec3 &foot : {Vec3((kA + kB + kC) / 3.0), kA, Vec3(kA + 1.5 * (kB - kA)),
                           Vec3(0.5 * (kA + kB))}) {
    const Vec3 on = closed_form(foot);
    for (double height : {1e-6, 1e-9, 1e-12, 1e-15, -1e-9})
      EXPECT_LT((closed_form(foot + height * normal) - on).norm(),
                (1e-12 + 40.0 * std::fabs(height)) * on.norm())
          << height;
  }
}

TEST(FlatElements, FarRuleApproachesTheClosedFormAsTheThirdPowerOfTheDistance)
{
  // Degree 2 is exact for a linear density times a linear kernel; the second derivative of the
  // kernel, r^-3, is what remains: 4 times less against u ~ r^-1 when the distance doubles.
  Points nodes(3, 3);
  nodes << kA, kB, kC;
  FlatElements element;
  element.set_geometry(nodes, {{0, 1, 2}});
  element.prepare_near(make_density());
  const Vec3 center = (kA + kB + kC) / 3.0, direction = Vec3(0.3, -0.5, 0.8).normalized();
  double previous = 0.0;
  for (double r : {8.0, 16.0, 32.0}) {
    const Vec3 target = center + r * direction;
    const double relative =
        element.compute_near_correction(0, target).norm() / closed_form(target).norm();
    if (previous > 0.0) EXPECT_GT(previous / relative, 3.8);
    EXPECT_LT(relative, 0.1 / (r * r));
    previous = relative;
  }
}

TEST(FlatElements, FarRuleAndMassKeepTheTotalForce)
{
  Points nodes(3, 3);
  nodes << kA, kB, kC;
  FlatElements element;
  element.set_geometry(nodes, {{0, 1, 2}});
  const Mat3 f = make_density();
  const Vec3 total = element.area(0) * f.rowwise().mean();
  Points interior(3, 1), product = Points::Zero(3, 3);
  element.compute_interior_strengths(f, interior);
  const Vec3 rule = element.nodal_fraction() * element.area(0) / 3.0 * f.rowwise().sum() +
      interior.col(0);
  EXPECT_LT((rule - total).norm(), 1e-15);
  element.add_mass_product(f, product);
  EXPECT_LT((product.rowwise().sum() - total).norm(), 1e-15);
}
