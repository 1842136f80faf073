// The direct periodic sums against what they must be: independent of the split and of the choice of
// lattice vectors, derivatives of each other, and the free kernels in a large box.
#include "biem_error.h"
#include "biem_oracle_periodic.h"
#include "core/random_points.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

// Sources in a general triclinic cell, targets elsewhere.
struct Scene {
  Mat3 cell = make_cell(2.0, 1.5, 1.2, 0.37);
  Points targets, sources, densities, normals;

  explicit Scene(int seed)
  {
    std::mt19937_64 generator(seed);
    cell(0, 1) = 0.3;
    cell(1, 2) = -0.2;
    targets = make_random(5, generator, -1.0, 1.0);
    sources = make_random(7, generator, -1.0, 1.0);
    densities = make_random(7, generator, -1.0, 1.0);
    normals = make_random(7, generator, -1.0, 1.0);
  }
  Points sum(const Points &x, double splitting = 0.0) const
  {
    return compute_oracle_double_layer(cell, x, sources, densities, normals, splitting);
  }
};

}    // namespace

TEST(Oracle, DoesNotDependOnTheSplit)
{
  std::mt19937_64 generator(1);
  const Mat3 cell = make_cell(2.0, 1.5, 1.2, 0.37);
  const Points x = make_random(6, generator, 0.0, 1.0), f = make_random(6, generator, -1.0, 1.0);
  const Points a = compute_oracle_single_layer(cell, x, x, f, 1.0);
  EXPECT_LT(relative_rms(compute_oracle_single_layer(cell, x, x, f, 1.6), a), 1e-12);
  EXPECT_LT(relative_rms(compute_oracle_single_layer(cell, x, x, f, 4.0), a), 1e-12);
  EXPECT_LT(relative_rms(compute_oracle_single_layer(cell, x, x, f), a), 1e-12);
}

TEST(Oracle, DoesNotSeeATiltFlip)
{
  std::mt19937_64 generator(2);
  const Points x = make_random(6, generator, 0.0, 1.0), f = make_random(6, generator, -1.0, 1.0);
  const Points a = compute_oracle_single_layer(make_cell(1, 1.2, 1.1, 0.5), x, x, f);
  const Points b = compute_oracle_single_layer(make_cell(1, 1.2, 1.1, -0.5), x, x, f);
  EXPECT_LT(relative_rms(a, b), 1e-12);
}

TEST(Oracle, DoubleLayerDoesNotDependOnTheSplit)
{
  const Scene scene(3);
  for (const Points &x : {scene.targets, scene.sources}) {    // apart from and on the sources
    const Points a = scene.sum(x, 1.1);
    EXPECT_LT(relative_rms(scene.sum(x, 1.6), a), 1e-12);
    EXPECT_LT(relative_rms(scene.sum(x, 4.0), a), 1e-12);
    EXPECT_LT(relative_rms(scene.sum(x), a), 1e-12);
  }
}

TEST(Oracle, DoubleLayerDoesNotSeeATiltFlip)
{
  Scene scene(4);
  scene.cell = make_cell(1.0, 1.2, 1.1, 0.5);
  const Points a = scene.sum(scene.targets);
  scene.cell = make_cell(1.0, 1.2, 1.1, -0.5);
  EXPECT_LT(relative_rms(scene.sum(scene.targets), a), 1e-12);
}

TEST(Oracle, SumsAreThoseOfAllPairs)
{
  // Linear in the sources: the images found for one pair cannot depend on the other points.
  const Scene s(5);
  Points double_layer = Points::Zero(3, s.targets.cols()), single_layer = double_layer;
  for (Eigen::Index i = 0; i < s.sources.cols(); i++) {
    const Points y = s.sources.col(i), q = s.densities.col(i), n = s.normals.col(i);
    double_layer += compute_oracle_double_layer(s.cell, s.targets, y, q, n);
    single_layer += compute_oracle_single_layer(s.cell, s.targets, y, q);
  }
  const Points all = compute_oracle_single_layer(s.cell, s.targets, s.sources, s.densities);
  EXPECT_LT(relative_rms(s.sum(s.targets), double_layer), 1e-12);
  EXPECT_LT(relative_rms(all, single_layer), 1e-12);
}

TEST(Oracle, TracelessDoubleLayerIsTheGradientOfTheSingleLayer)
{
  // d_k S_ij + d_j S_ik = T_ijk + 2 delta_jk r_i / r^3: with q.n = 0 the last term, the flow of a
  // point source, drops out and T q n = (n.grad) S q + (q.grad) S n.
  Scene s(6);
  for (Eigen::Index i = 0; i < s.sources.cols(); i++) {
    const Vec3 n = s.normals.col(i), q = s.densities.col(i);
    s.densities.col(i) = q - n * n.dot(q) / n.squaredNorm();
  }
  constexpr double kStep = 1e-4;
  Points gradient = Points::Zero(3, s.targets.cols());
  for (Eigen::Index i = 0; i < s.sources.cols(); i++)
    for (int swap = 0; swap < 2; swap++) {
      const Points y = s.sources.col(i);
      const Points f = swap ? s.normals.col(i) : s.densities.col(i);
      const Vec3 along = kStep * (swap ? s.densities.col(i) : s.normals.col(i));
      const Points ahead = s.targets.colwise() + along, behind = s.targets.colwise() - along;
      gradient += (compute_oracle_single_layer(s.cell, ahead, y, f) -
                   compute_oracle_single_layer(s.cell, behind, y, f)) /
                  (2.0 * kStep);
    }
  EXPECT_LT(relative_rms(s.sum(s.targets), gradient), 1e-6);
}

TEST(Oracle, FluxThroughAPlaneIsThatOfTheSourcesBetween)
{
  // A stresslet is a sink of strength 8 pi q.n. With sum q.n = 0 and the mean of zero wave vector,
  // no net flux passes the planes that leave all sources on one side.
  Scene s(7);
  s.cell = make_cell(2.0, 1.5, 1.2, 0.37);
  s.sources.resize(3, 2);
  s.sources << 0.1, -0.2, 0.3, 0.1, -0.3, 0.25;
  s.normals = s.normals.leftCols(2).eval();
  s.densities = s.densities.leftCols(2).eval();
  s.densities.col(1) *=
      -s.densities.col(0).dot(s.normals.col(0)) / s.densities.col(1).dot(s.normals.col(1));
  const double strength = 8.0 * M_PI * s.densities.col(0).dot(s.normals.col(0));

  constexpr int kPoints = 48;    // along each of x and y: the rule converges exponentially
  const double area = s.cell(0, 0) * s.cell(1, 1);
  const auto compute_flux = [&](double z) {
    Points plane(3, kPoints * kPoints);
    for (int i = 0; i < kPoints * kPoints; i++)
      plane.col(i) = Vec3(i % kPoints * s.cell(0, 0), i / kPoints * s.cell(1, 1), z * kPoints) /
                     static_cast<double>(kPoints);
    return s.sum(plane).row(2).mean() * area;
  };
  EXPECT_NEAR(compute_flux(-0.6), 0.0, 1e-8 * std::fabs(strength));
  EXPECT_NEAR(compute_flux(0.55), 0.0, 1e-8 * std::fabs(strength));
  EXPECT_NEAR(compute_flux(0.0), -strength, 1e-4 * std::fabs(strength));
}

TEST(Oracle, TendsToTheFreeKernelsInALargeBox)
{
  Scene s(8);
  Points free_double = Points::Zero(3, s.targets.cols());
  for (Eigen::Index t = 0; t < s.targets.cols(); t++)
    for (Eigen::Index i = 0; i < s.sources.cols(); i++) {
      const Vec3 r = s.targets.col(t) - s.sources.col(i);
      free_double.col(t) -=
          6.0 * r.dot(s.densities.col(i)) * r.dot(s.normals.col(i)) * r / std::pow(r.norm(), 5);
    }
  const Mat3 shape = s.cell;
  double error[2];
  for (int i = 0; i < 2; i++) {
    s.cell = (i + 1) * 100.0 * shape;
    error[i] = relative_rms(s.sum(s.targets), free_double);
  }
  EXPECT_LT(error[1], 1e-5);
  EXPECT_NEAR(error[0] / error[1], 8.0, 0.1);    // the images' flow is linear in r / L^3
}

TEST(Oracle, PointGivesNothingAtItsOwnPlace)
{
  const Scene s(9);
  for (Eigen::Index i = 0; i < s.sources.cols(); i++) {
    const Points y = s.sources.col(i), q = s.densities.col(i), n = s.normals.col(i);
    EXPECT_LT(compute_oracle_double_layer(s.cell, y, y, q, n).norm(), 1e-12);
  }
}

TEST(Oracle, WrongInputIsRefused)
{
  const Scene s(10);
  const Points fewer = s.densities.leftCols(3);
  EXPECT_THROW(compute_oracle_single_layer(Mat3::Zero(), s.targets, s.sources, s.densities), Error);
  EXPECT_THROW(compute_oracle_single_layer(s.cell, s.targets, s.sources, fewer), Error);
  EXPECT_THROW(compute_oracle_double_layer(s.cell, s.targets, s.sources, s.densities, fewer),
               Error);
}
