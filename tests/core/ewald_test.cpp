// Periodic single-layer sums against the direct oracle: every cell shape, every tolerance.
#include "biem_error.h"
#include "biem_ewald_fourier.h"
#include "biem_ewald_parameters.h"
#include "biem_ewald_real_space.h"
#include "biem_ewald_split_pswf.h"
#include "biem_ewald_window.h"
#include "biem_oracle_periodic.h"
#include "biem_periodic_ghosts.h"
#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace biem;

namespace {

Mat3 make_cell(double lx, double ly, double lz, double tilt)
{
  Mat3 cell = Mat3::Zero();
  cell.diagonal() = Vec3(lx, ly, lz);
  cell(0, 2) = tilt * lx;
  return cell;
}

Points make_random(int n, std::mt19937_64 &generator, double low, double high)
{
  std::uniform_real_distribution<double> uniform(low, high);
  Points p(3, n);
  for (Eigen::Index i = 0; i < p.size(); i++) p.data()[i] = uniform(generator);
  return p;
}

double relative_rms(const Points &a, const Points &b) { return (a - b).norm() / b.norm(); }

// The fast sum on one rank, sources = targets.
Points sum_fast(const Mat3 &cell, const Points &x, const Points &f, const EwaldParameters &p)
{
  const std::unique_ptr<EwaldSplit> split = make_split(p);
  PeriodicGhosts ghosts(x, cell, p.cutoff);
  Points all = Points::Zero(3, ghosts.nodes().cols());
  RealSpaceSum real(make_real_space_kernel(*split, p.cutoff, 0.02 * p.tolerance));
  real.set_points(ghosts.nodes(), x);
  real.add_single_layer(f, all);
  ghosts.reverse_add(all.data(), 3);
  Points u = all.leftCols(x.cols()) + split->truncated_self(p.band_limit) * f;
  FourierSum fourier(MPI_COMM_SELF, p);
  fourier.set_cell(cell, Vec3(-0.3, 0.2, 0.1));
  fourier.set_points(x, x);
  fourier.add_single_layer(f, u);
  return u;
}

EwaldScene make_scene(const Mat3 &cell, int n, double tolerance,
                      EwaldMethod method = EwaldMethod::Spme)
{
  EwaldScene scene;
  scene.method = method;
  scene.cell = cell;
  scene.max_tilt = 0.5 * cell(0, 0);
  scene.n_sources = scene.n_targets = n;
  scene.tolerance = tolerance;
  return scene;
}

}    // namespace

TEST(Oracle, DoesNotDependOnTheSplit)
{
  std::mt19937_64 generator(1);
  const Mat3 cell = make_cell(2.0, 1.5, 1.2, 0.37);
  const Points x = make_random(6, generator, 0.0, 1.0), f = make_random(6, generator, -1.0, 1.0);
  const Points a = compute_oracle_single_layer(cell, x, x, f, 1.0);
  EXPECT_LT(relative_rms(compute_oracle_single_layer(cell, x, x, f, 1.6), a), 1e-12);
}

TEST(Oracle, DoesNotSeeATiltFlip)
{
  std::mt19937_64 generator(2);
  const Points x = make_random(6, generator, 0.0, 1.0), f = make_random(6, generator, -1.0, 1.0);
  const Points a = compute_oracle_single_layer(make_cell(1, 1.2, 1.1, 0.5), x, x, f);
  const Points b = compute_oracle_single_layer(make_cell(1, 1.2, 1.1, -0.5), x, x, f);
  EXPECT_LT(relative_rms(a, b), 1e-12);
}

TEST(BsplineWindow, WeightsArePartitionOfUnityWithTheRightMean)
{
  for (int order : {4, 5, 6, 8, 10})
    for (double s : {0.0, 0.3, 7.5, 11.999}) {
      double w[kMaxWindowOrder], sum = 0.0, mean = 0.0;
      const int first = BsplineWindow(order).compute_weights(s, w);
      for (int j = 0; j < order; j++) {
        EXPECT_GE(w[j], 0.0);
        sum += w[j];
        mean += w[j] * (first + j);
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
      EXPECT_NEAR(mean, s, 1e-13);
    }
}

struct SumCase {
  double lx, ly, lz, tilt;
  EwaldMethod method;
};

class EwaldAccuracy : public ::testing::TestWithParam<SumCase> {};

TEST_P(EwaldAccuracy, MeasuredErrorIsBelowTheToleranceForRandomPoints)
{
  const SumCase c = GetParam();
  const Mat3 cell = make_cell(c.lx, c.ly, c.lz, c.tilt);
  std::mt19937_64 generator(3);
  const int n = 120;
  const Points x = cell * make_random(n, generator, 0.0, 1.0);
  const Points f = make_random(n, generator, -1.0, 1.0);
  const Points exact = compute_oracle_single_layer(cell, x, x, f);
  for (double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const EwaldParameters p = choose_ewald_parameters(make_scene(cell, n, tolerance, c.method));
    const double error = relative_rms(sum_fast(cell, x, f, p), exact);
    std::printf("  tolerance %.0e measured %.2e expected %.2e  cutoff %.3f grid %d %d %d order %d\n",
                tolerance, error, p.expected_error, p.cutoff, p.grid[0], p.grid[1], p.grid[2],
                p.order);
    EXPECT_LE(error, tolerance);
    EXPECT_GE(error, 0.01 * tolerance) << "the parameters over-solve";
  }
}

TEST_P(EwaldAccuracy, MeasuredErrorIsBelowTheToleranceForPointsInOneCorner)
{
  const SumCase c = GetParam();
  const Mat3 cell = make_cell(c.lx, c.ly, c.lz, c.tilt);
  std::mt19937_64 generator(4);
  const int n = 120;
  const Points x = 0.15 * cell * make_random(n, generator, 0.0, 1.0);
  const Points f = make_random(n, generator, -1.0, 1.0);
  const Points exact = compute_oracle_single_layer(cell, x, x, f);
  for (double tolerance : {1e-2, 1e-4, 1e-6}) {
    const EwaldParameters p = choose_ewald_parameters(make_scene(cell, n, tolerance, c.method));
    EXPECT_LE(relative_rms(sum_fast(cell, x, f, p), exact), tolerance);
  }
}

std::vector<SumCase> make_cases()
{
  std::vector<SumCase> cases;
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf})
    for (const SumCase &c :
         {SumCase{1, 1, 1, 0.0, method}, SumCase{1.6, 0.9, 1.2, 0.0, method},
          SumCase{1, 1, 1, 0.5, method}, SumCase{1, 1, 1, -0.5, method},
          SumCase{1.6, 0.9, 1.2, 0.23, method}, SumCase{16, 9, 12, -0.41, method}})
      cases.push_back(c);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Cells, EwaldAccuracy, ::testing::ValuesIn(make_cases()));

TEST(Windows, TransformIsTheFourierTransformOfTheWeights)
{
  // sum over grid points and a full period of positions of w exp(-2 pi i f (m - s)) = W(f)
  const BsplineWindow bspline(6);
  const KaiserBesselWindow kaiser(8, 1.5), widest(12, 2.9);
  for (const EwaldWindow *window : {static_cast<const EwaldWindow *>(&bspline),
                                    static_cast<const EwaldWindow *>(&kaiser),
                                    static_cast<const EwaldWindow *>(&widest)})
    for (double f : {0.0, 0.1, 0.3, 0.7}) {
      constexpr int kPositions = 4000;
      double sum = 0.0;
      for (int i = 0; i < kPositions; i++) {
        const double s = 20.0 + (i + 0.5) / kPositions;
        double w[kMaxWindowOrder];
        const int first = window->compute_weights(s, w);
        for (int j = 0; j < window->order(); j++)
          sum += w[j] * std::cos(2.0 * M_PI * f * (first + j - s)) / kPositions;
      }
      EXPECT_NEAR(sum, window->transform(f), 2e-7);
    }
}

TEST(Splits, RealAndFourierPartsAddUpToTheFreeStokeslet)
{
  // The smooth remainder is the inverse transform of the Fourier part: at r = 0 its isotropic
  // coefficient is (8 pi) (2/3) int gamma/k^2 k^2 dk 4 pi/(2 pi)^3.
  const PswfSplit pswf(14.0, 0.7);
  const GaussianSplit gauss(3.0);
  for (const EwaldSplit *split : {static_cast<const EwaldSplit *>(&pswf),
                                  static_cast<const EwaldSplit *>(&gauss)}) {
    const double limit = split == &pswf ? 14.0 / 0.7 : 40.0;
    constexpr int kPoints = 4000;
    double sum = 0.0;
    for (int i = 0; i < kPoints; i++)
      sum += split->fourier_factor(std::pow((i + 0.5) * limit / kPoints, 2)) * limit / kPoints;
    sum *= 8.0 * M_PI * 2.0 / 3.0 * 4.0 * M_PI / std::pow(2.0 * M_PI, 3);
    EXPECT_NEAR(split->isotropic_remainder(0.0) / sum, 1.0, 1e-3);
  }
}

TEST(Ewald, TiltFlipDoesNotChangeTheSum)
{
  std::mt19937_64 generator(5);
  const int n = 100;
  const Mat3 before = make_cell(1.0, 1.1, 0.9, 0.5), after = make_cell(1.0, 1.1, 0.9, -0.5);
  const Points x = before * make_random(n, generator, 0.0, 1.0);
  const Points f = make_random(n, generator, -1.0, 1.0);
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf}) {
    const EwaldParameters p = choose_ewald_parameters(make_scene(before, n, 1e-4, method));
    EXPECT_LT(relative_rms(sum_fast(before, x, f, p), sum_fast(after, x, f, p)), 1e-10);
  }
}

TEST(Ewald, AccuracyOutOfRangeIsRefused)
{
  EXPECT_THROW(choose_ewald_parameters(make_scene(make_cell(1, 1, 1, 0), 10, 1e-14)), Error);
  EXPECT_THROW(choose_ewald_parameters(make_scene(make_cell(1, 1, 1, 0), 10, 0.0)), Error);
  EXPECT_THROW(choose_ewald_parameters(make_scene(make_cell(1, 1, 1, 0), 10, 1.0)), Error);
}
