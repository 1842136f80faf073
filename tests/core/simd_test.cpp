// Packs against scalar arithmetic: logarithm and arctangent over the whole range of doubles.
#include "biem_simd_math.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

using namespace biem;

namespace {

// Difference in units in the last place of the exact value.
double compute_ulps(double value, long double exact)
{
  const double size = std::fabs(static_cast<double>(exact));
  const double ulp = std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  return static_cast<double>(std::fabs(value - exact)) / ulp;
}

double take_lane(Pack v, int lane)
{
  return v[lane];
}

double log_of(double a, double b)
{
  return take_lane(log_ratio(broadcast(a), broadcast(b)), 0);
}

double arctangent_of(double y, double x)
{
  return take_lane(upper_arctangent(broadcast(y), broadcast(x)), kLanes - 1);
}

}    // namespace

TEST(Simd, LogarithmIsRightToTwoUnitsInTheLastPlace)
{
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-1021.0, 1021.0), uniform(-1.0, 1.0);
  double worst = 0.0;
  for (int i = 0; i < 200000; i++) {
    const double near_one = 1.0 + uniform(random) * std::exp2(-(i % 52));
    for (double x : {std::exp2(exponent(random)), near_one, 1.5 + 0.5 * uniform(random)})
      if (x > 0.0 && x != 1.0)
        worst = std::max(worst, compute_ulps(log_of(x, 1.0), std::log((long double)x)));
  }
  EXPECT_LT(worst, 2.0);
  EXPECT_EQ(log_of(1.0, 1.0), 0.0);
  EXPECT_EQ(log_of(0.3, 0.3), 0.0);
}

TEST(Simd, LogarithmOfARatioNeedsNoRepresentableRatio)
{
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-1021.0, 1021.0);
  double worst = 0.0;
  for (int i = 0; i < 200000; i++) {
    const double a = std::exp2(exponent(random)), b = i % 2 ? std::exp2(exponent(random)) : 1.1 * a;
    worst = std::max(worst, compute_ulps(log_of(a, b), std::log((long double)a / (long double)b)));
  }
  EXPECT_LT(worst, 2.0);
}

TEST(Simd, ArctangentIsRightToTwoUnitsInTheLastPlace)
{
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-500.0, 500.0), uniform(0.0, 1.0);
  double worst = 0.0;
  for (int i = 0; i < 200000; i++) {
    const double sign = i % 2 ? 1.0 : -1.0, angle = 4.0 * std::atan(1.0) * uniform(random);
    worst = std::max(worst, compute_ulps(arctangent_of(std::sin(angle), std::cos(angle)),
                                         std::atan2((long double)std::sin(angle),
                                                    (long double)std::cos(angle))));
    const double y = std::exp2(exponent(random)), x = sign * std::exp2(exponent(random));
    worst = std::max(worst,
                     compute_ulps(arctangent_of(y, x), std::atan2((long double)y, (long double)x)));
  }
  EXPECT_LT(worst, 2.0);
}

TEST(Simd, ArctangentOnTheAxesIsExact)
{
  EXPECT_EQ(arctangent_of(0.0, 0.0), 0.0);
  for (double x : {1e-300, 1.0, 1e300}) {
    EXPECT_EQ(arctangent_of(0.0, x), 0.0);
    EXPECT_EQ(arctangent_of(0.0, -x), std::atan2(0.0, -1.0));
    EXPECT_EQ(arctangent_of(x, 0.0), std::atan2(1.0, 0.0));
    EXPECT_EQ(arctangent_of(x, x), std::atan2(1.0, 1.0));
    EXPECT_EQ(arctangent_of(x, -x), std::atan2(1.0, -1.0));
  }
}

TEST(Simd, LanesDoNotDependOnEachOther)
{
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(-20.0, 20.0);
  for (int i = 0; i < 1000; i++) {
    Pack a, b;
    for (int l = 0; l < kLanes; l++) {
      a[l] = std::exp2(exponent(random));
      b[l] = std::exp2(exponent(random));
    }
    const Pack logarithm = log_ratio(a, b), angle = upper_arctangent(a, b - 1.0);
    for (int l = 0; l < kLanes; l++) {
      EXPECT_EQ(take_lane(logarithm, l), log_of(a[l], b[l]));
      EXPECT_EQ(take_lane(angle, l), arctangent_of(a[l], b[l] - 1.0));
    }
  }
}

TEST(Simd, MasksSelectAndCountTheirLanes)
{
  Pack v;
  for (int l = 0; l < kLanes; l++)
    v[l] = l % 2 ? l : -l - 1.0;
  const Mask negative = less(v, Pack{});
  EXPECT_EQ(count(negative), kLanes / 2);
  EXPECT_TRUE(any(negative));
  EXPECT_FALSE(any(less(v, v)));
  const Pack chosen = select(negative, absolute(v), broadcast(0.5));
  for (int l = 0; l < kLanes; l++)
    EXPECT_EQ(take_lane(chosen, l), l % 2 ? 0.5 : l + 1.0);
}

TEST(Simd, RootsAreRightToAFewUnitsInTheLastPlace)
{
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(-900.0, 900.0);
  for (int i = 0; i < 20000; i++) {
    const double x = std::exp2(exponent(random));
    EXPECT_EQ(take_lane(square_root(broadcast(x)), 0), std::sqrt(x));
    EXPECT_LT(compute_ulps(take_lane(inverse_square_root(broadcast(x)), 0),
                           1 / std::sqrt(static_cast<long double>(x))),
              4.0);
  }
}
