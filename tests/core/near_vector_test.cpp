// The packed closed forms against a scalar oracle in extended precision: random, flat and needle
// triangles; targets anywhere, close, far, on corners, edges and in the plane.
#include "biem_near_triangle.h"
#include "near_oracle.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

using namespace biem;

namespace {

struct Worst {
  double single_layer = 0.0, double_layer = 0.0;
};

// The larger one; an error that is no number counts as infinite.
double update(double worst, double error)
{
  return std::isfinite(error) ? std::max(worst, error) : INFINITY;
}

Vec3 take_lane(const PointPack &p, int l)
{
  return Vec3(p.x[l], p.y[l], p.z[l]);
}

class Samples {
 public:
  explicit Samples(int seed) : random_(seed) {}

  double normal() { return normal_(random_); }
  Vec3 vector() { return Vec3(normal(), normal(), normal()); }
  double uniform(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

PointPack make_pack(const std::function<Vec3()> &place)
{
  PointPack pack;
  for (int l = 0; l < kLanes; l++) {
    const Vec3 target = place();
    pack.x[l] = target[0];
    pack.y[l] = target[1];
    pack.z[l] = target[2];
  }
  return pack;
}

double longest_edge(const Mat3 &x)
{
  return std::max(
      {(x.col(1) - x.col(0)).norm(), (x.col(2) - x.col(1)).norm(), (x.col(0) - x.col(2)).norm()});
}

// Worst error over many triangles with a pack of targets each, relative to what the layers are at
// the target's distance r, size^2/r and (size/r)^2, at most size and 1, times the density, and to
// the aspect ratio of the triangle, which is the condition of its plane.
Worst compare(int seed, double shortest_height,
              const std::function<Vec3(Samples &, const Mat3 &)> &place)
{
  Samples samples(seed);
  Worst worst;
  for (int n = 0; n < 2000; n++) {
    Mat3 x, f;
    x << samples.vector(), samples.vector(), samples.vector();
    f << samples.vector(), samples.vector(), samples.vector();
    x.col(2) = 0.5 * (x.col(0) + x.col(1)) +
               std::pow(shortest_height, samples.uniform(0, 1)) * (x.col(2) - x.col(0));
    const TriangleFrame frame = make_triangle_frame(x.col(0), x.col(1), x.col(2));
    const LinearDensity density = make_linear_density(frame, f);
    const PointPack targets = make_pack([&]() { return place(samples, x); });
    const PointPack u = integrate_near_triangle<Layers::Single>(frame, &density, nullptr, targets);
    const PointPack w = integrate_near_triangle<Layers::Double>(frame, nullptr, &density, targets);
    const PointPack both =
        integrate_near_triangle<Layers::Both>(frame, &density, &density, targets);
    const double size = longest_edge(x);
    const double aspect = size * size / frame.twice_area;
    for (int l = 0; l < kLanes; l++) {
      const near_oracle::Integrals exact =
          near_oracle::integrate(x, f, take_lane(targets, l), frame.smallest_height);
      const double r = (take_lane(targets, l) - x.rowwise().mean()).norm();
      const double unit = f.norm() * size / (1.0 + r / size);
      const Vec3 du = take_lane(u, l) - exact.single_layer.cast<double>();
      const Vec3 dw = take_lane(w, l) - exact.double_layer.cast<double>();
      const double distance = std::max(1.0, r / size);
      worst.single_layer = update(worst.single_layer, du.norm() / (unit * aspect));
      worst.double_layer =
          update(worst.double_layer, dw.norm() / (f.norm() * aspect) * distance * distance);
      EXPECT_LT((take_lane(both, l) - take_lane(u, l) - take_lane(w, l)).norm(),
                1e-13 * (take_lane(u, l).norm() + take_lane(w, l).norm() + unit));
    }
  }
  return worst;
}

Vec3 place_inside(Samples &s, const Mat3 &x)
{
  const double a = std::sqrt(s.uniform(0, 1)), b = s.uniform(0, 1);
  return x * Vec3(1 - a, a * (1 - b), a * b);
}

Vec3 normal_of(const Mat3 &x)
{
  return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).normalized();
}

Vec3 place_around(Samples &s, const Mat3 &x)
{
  return x.rowwise().mean() + 1.5 * (x.col(1) - x.col(0)).norm() * s.vector();
}

Vec3 place_above(Samples &s, const Mat3 &x)
{
  return place_inside(s, x) +
         std::pow(10.0, s.uniform(-6, 0)) * (s.normal() > 0 ? 1 : -1) * normal_of(x);
}

Vec3 place_on_edge(Samples &s, const Mat3 &x)
{
  const int k = static_cast<int>(s.uniform(0, 3));
  const double a = s.uniform(-1, 2);
  const double h = s.normal() > 0 ? 0.0 : std::pow(10.0, s.uniform(-6, 0));
  return x.col(k) + a * (x.col((k + 1) % 3) - x.col(k)) + h * normal_of(x);
}

Vec3 place_on_corner(Samples &s, const Mat3 &x)
{
  const int k = static_cast<int>(s.uniform(0, 3));
  const double h = s.normal() > 0 ? 0.0 : std::pow(10.0, s.uniform(-6, 0));
  return x.col(k) + h * s.vector();
}

Vec3 place_in_plane(Samples &s, const Mat3 &x)
{
  return x.col(0) + s.normal() * (x.col(1) - x.col(0)) + s.normal() * (x.col(2) - x.col(0));
}

}    // namespace

TEST(NearVector, IsRightToRoundingAround)
{
  const Worst w = compare(1, 0.5, place_around);
  EXPECT_LT(w.single_layer, 1e-11);
  EXPECT_LT(w.double_layer, 1e-11);
}

TEST(NearVector, IsRightToRoundingAboveTheTriangle)
{
  const Worst w = compare(2, 0.5, place_above);
  EXPECT_LT(w.single_layer, 1e-13);
  EXPECT_LT(w.double_layer, 1e-10);
}

// The double layer jumps across the surface and so turns around an edge within the distance from
// it: rounding of the target's position counts in proportion to 1/distance, here 1e6 and more.
TEST(NearVector, IsRightOnEdgesAndTheirLines)
{
  const Worst w = compare(3, 0.5, place_on_edge);
  EXPECT_LT(w.single_layer, 1e-13);
  EXPECT_LT(w.double_layer, 1e-6);
}

TEST(NearVector, IsRightOnCorners)
{
  const Worst w = compare(4, 0.5, place_on_corner);
  EXPECT_LT(w.single_layer, 1e-13);
  EXPECT_LT(w.double_layer, 1e-6);
}

TEST(NearVector, IsRightInThePlane)
{
  const Worst w = compare(5, 0.5, place_in_plane);
  EXPECT_LT(w.single_layer, 1e-12);
  EXPECT_EQ(w.double_layer, 0.0);
}

TEST(NearVector, NeedlesLoseDigitsOnlyInProportion)
{
  for (auto place : {place_around, place_inside, place_on_edge, place_on_corner}) {
    const Worst w = compare(6, 1e-4, place);
    EXPECT_LT(w.single_layer, 1e-12);
    EXPECT_LT(w.double_layer, 1e-6);
  }
}

TEST(NearVector, FarTargetsLoseDigitsAsTheMomentsCancel)
{
  for (double distance : {10.0, 100.0, 1000.0}) {
    const Worst w = compare(7, 0.5, [distance](Samples &s, const Mat3 &x) {
      return Vec3(place_inside(s, x) + distance * s.vector().normalized());
    });
    EXPECT_LT(w.single_layer, 1e-14 * std::pow(distance, 3));
    EXPECT_LT(w.double_layer, 1e-14 * std::pow(distance, 3));
  }
}

TEST(NearVector, ALaneDoesNotDependOnTheOthers)
{
  Samples s(8);
  Mat3 x, f;
  x << s.vector(), s.vector(), s.vector();
  f << s.vector(), s.vector(), s.vector();
  const TriangleFrame frame = make_triangle_frame(x.col(0), x.col(1), x.col(2));
  const LinearDensity density = make_linear_density(frame, f);
  int n = 0;
  const PointPack mixed =
      make_pack([&]() { return n++ % 2 ? place_around(s, x) : place_on_corner(s, x); });
  const PointPack u = integrate_near_triangle<Layers::Both>(frame, &density, &density, mixed);
  for (int l = 0; l < kLanes; l++) {
    const PointPack one{broadcast(mixed.x[l]), broadcast(mixed.y[l]), broadcast(mixed.z[l])};
    const PointPack v = integrate_near_triangle<Layers::Both>(frame, &density, &density, one);
    EXPECT_EQ(take_lane(u, l), take_lane(v, kLanes - 1 - l));
  }
}
