// Periodic sums of both layers against the direct oracle: every cell shape, every tolerance.
#include "biem_error.h"
#include "biem_ewald_split_pswf.h"
#include "biem_ewald_sum.h"
#include "biem_ewald_tuning.h"
#include "biem_oracle_periodic.h"
#include "biem_periodic_ghosts.h"
#include "core/random_points.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

// Targets = sources: positions, forces, densities and normals of n random points in the fraction
// size of the cell along each axis.
struct Cloud {
  Points x, forces, densities, normals;

  Cloud(const Mat3 &cell, int n, unsigned seed, double size = 1.0)
  {
    std::mt19937_64 generator(seed);
    x = size * cell * make_random(n, generator, 0.0, 1.0);
    forces = make_random(n, generator, -1.0, 1.0);
    // As large as the forces at the mean distance of the points, so that both layers matter.
    densities = 0.3 * size * std::cbrt(cell.determinant() / n) * make_random(n, generator, -1.0, 1.0);
    normals = make_random(n, generator, -1.0, 1.0);
  }
};

Points sum_exact(const Mat3 &cell, const Cloud &c, Layers layers)
{
  Points u = Points::Zero(3, c.x.cols());
  if (has_single(layers)) u += compute_oracle_single_layer(cell, c.x, c.x, c.forces);
  if (has_double(layers)) u += compute_oracle_double_layer(cell, c.x, c.x, c.densities, c.normals);
  return u;
}

// The fast sum on one rank.
Points sum_fast(const Mat3 &cell, const Cloud &c, Layers layers, const EwaldParameters &p)
{
  PeriodicGhosts ghosts(c.x, cell, p.cutoff);
  const int n = static_cast<int>(c.x.cols());
  const Points none(3, 0);
  PeriodicSum sum(MPI_COMM_SELF, p);
  sum.set_cell(cell, Vec3(-0.3, 0.2, 0.1));
  sum.set_points({ghosts.nodes(), n, c.x, has_double(layers) ? c.normals : none, none},
                 layers);
  Points u = Points::Zero(3, ghosts.nodes().cols());
  sum.add_layers(layers, has_single(layers) ? c.forces : none,
                 has_double(layers) ? c.densities : none, ghosts, u);
  return u.leftCols(n);
}

EwaldScene make_scene(const Mat3 &cell, int n, double tolerance, EwaldMethod method,
                      Layers layers = Layers::Single)
{
  EwaldScene scene;
  scene.method = method;
  scene.layers = layers;
  scene.cell = cell;
  scene.max_tilt = 0.5 * cell(0, 0);
  scene.n_sources = scene.n_targets = n;
  scene.tolerance = tolerance;
  return scene;
}

}    // namespace

TEST(BsplineWindow, WeightsArePartitionOfUnityWithTheRightMean)
{
  for (int order : {4, 5, 6, 8, 10})
    for (double s : {0.0, 0.3, 7.5, 11.999}) {
      double w[kMaxWindowOrder], sum = 0.0, mean = 0.0;
      const int first = BsplineWindow(order).compute_weights(s, w);
      for (int j = 0; j < order; j++) {
        EXPECT_GE(w[j], -1e-16);
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
  Layers layers;
};

std::string name_of(const SumCase &c)
{
  const char *layers[] = {"single layer", "double layer", "both layers"};
  return std::string(c.method == EwaldMethod::Spme ? "spme" : "pswf") + ", " +
         layers[static_cast<int>(c.layers)];
}

class EwaldAccuracy : public ::testing::TestWithParam<SumCase> {
 protected:
  // Measured error over tolerance.
  double measure(const Cloud &cloud, const Points &exact, double tolerance)
  {
    const SumCase c = GetParam();
    const int n = static_cast<int>(cloud.x.cols());
    const EwaldParameters p =
        choose_ewald_parameters(make_scene(cell, n, tolerance, c.method, c.layers));
    const double error = relative_rms(sum_fast(cell, cloud, c.layers, p), exact);
    std::printf("  %s: tolerance %.0e measured %.2e expected %.2e cutoff %.3f grid %d %d %d "
                "order %d\n", name_of(c).c_str(), tolerance, error, p.expected_error, p.cutoff,
                p.grid[0], p.grid[1], p.grid[2], p.order);
    EXPECT_LE(p.expected_error, tolerance);
    return error / tolerance;
  }

  const Mat3 cell =
      make_cell(GetParam().lx, GetParam().ly, GetParam().lz, GetParam().tilt);
};

TEST_P(EwaldAccuracy, RandomPointsMeetTheToleranceWithoutWaste)
{
  const Cloud cloud(cell, 400, 3);
  const Points exact = sum_exact(cell, cloud, GetParam().layers);
  for (double tolerance : {1e-2, 1e-3, 1e-4, 1e-6, 1e-8}) {
    const double ratio = measure(cloud, exact, tolerance);
    EXPECT_LE(ratio, 1.0);
    // A double layer of random points lives from its closest pairs, which have no error at all.
    EXPECT_GE(ratio, GetParam().layers == Layers::Single ? 0.1 : 0.02) << "the parameters over-solve";
  }
}

TEST_P(EwaldAccuracy, PointsInOneCornerMeetTheTolerance)
{
  const Cloud cloud(cell, 400, 4, 0.15);
  const Points exact = sum_exact(cell, cloud, GetParam().layers);
  for (double tolerance : {1e-2, 1e-4, 1e-6}) EXPECT_LE(measure(cloud, exact, tolerance), 1.0);
}

std::vector<SumCase> make_cases()
{
  std::vector<SumCase> cases;
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf})
    for (Layers layers : {Layers::Single, Layers::Double, Layers::Both})
      for (const SumCase &c :
           {SumCase{1, 1, 1, 0.0, method, layers}, SumCase{1.6, 0.9, 1.2, 0.0, method, layers},
            SumCase{1, 1, 1, 0.5, method, layers}, SumCase{1, 1, 1, -0.5, method, layers},
            SumCase{1.6, 0.9, 1.2, 0.23, method, layers},
            SumCase{16, 9, 12, -0.41, method, layers}, SumCase{1, 1, 4, 0.3, method, layers},
            SumCase{1, 1, 0.15, 0.2, method, layers}})    // thinner than the cutoff
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

TEST(Windows, SlopesAreTheDerivativesOfTheWeights)
{
  const BsplineWindow bspline(6);
  const KaiserBesselWindow kaiser(8, 1.5), widest(13, 1.2);
  for (const EwaldWindow *window : {static_cast<const EwaldWindow *>(&bspline),
                                    static_cast<const EwaldWindow *>(&kaiser),
                                    static_cast<const EwaldWindow *>(&widest)})
    for (double s : {10.1, 10.37, 10.9}) {
      const double step = 1e-5;
      double w[3][kMaxWindowOrder], slopes[kMaxWindowOrder];
      window->compute_weights(s - step, w[0]);
      window->compute_weights(s + step, w[1]);
      window->compute_weights_and_slopes(s, w[2], slopes);
      for (int j = 0; j < window->order(); j++)
        EXPECT_NEAR(slopes[j], (w[1][j] - w[0][j]) / (2.0 * step), 1e-5);
    }
}

TEST(Splits, RealAndFourierPartsAddUpToTheFreeStokeslet)
{
  // The smooth remainder is the inverse transform of the Fourier part: at r = 0 it is 2 P =
  // (8 pi) (2/3) int gamma/k^2 k^2 dk 4 pi/(2 pi)^3 over all k.
  const PswfSplit pswf(14.0, 0.7);
  const GaussianSplit gauss(3.0);
  for (const EwaldSplit *split : {static_cast<const EwaldSplit *>(&pswf),
                                  static_cast<const EwaldSplit *>(&gauss)}) {
    const double limit = split == &pswf ? 14.35 / 0.7 : 12.0;
    constexpr int kPoints = 4000;
    double sum = 0.0;
    for (int i = 0; i < kPoints; i++)
      sum += split->fourier_factor(std::pow((i + 0.5) * limit / kPoints, 2)) * limit / kPoints;
    sum *= 8.0 * M_PI * 2.0 / 3.0 * 4.0 * M_PI / std::pow(2.0 * M_PI, 3);
    EXPECT_NEAR(2.0 * split->mollified_slope(0.0), sum + split->truncated_self(limit), 1e-6 * sum);
  }
}

TEST(Splits, DerivativesOfTheRealSpaceKernelAreThoseOfItsSlope)
{
  const PswfSplit split(14.0, 0.7);
  const RealSpaceKernel kernel = make_real_space_kernel(split, 0.7, 14.35 / 0.7, 1e-10);
  auto evaluate = [](const std::vector<double> &c, double v) {
    double value = 0.0;
    for (size_t k = c.size(); k-- > 0;) value = value * v + c[k];
    return value;
  };
  auto slope = [&](double r2) { return split.mollified_slope(std::sqrt(r2)); };
  for (double r2 : {0.05, 0.2, 0.4}) {
    const double v = 2.0 * r2 / 0.49 - 1.0, h = 1e-3;
    EXPECT_NEAR(evaluate(kernel.slope, v), slope(r2), 1e-9);
    EXPECT_NEAR(evaluate(kernel.slope1, v), (slope(r2 + h) - slope(r2 - h)) / (2.0 * h), 1e-3);
    EXPECT_NEAR(evaluate(kernel.slope2, v),
                (slope(r2 + h) - 2.0 * slope(r2) + slope(r2 - h)) / (h * h), 1e-2);
  }
}

TEST(Ewald, TiltFlipDoesNotChangeTheSum)
{
  const Mat3 before = make_cell(1.0, 1.1, 0.9, 0.5), after = make_cell(1.0, 1.1, 0.9, -0.5);
  const Cloud cloud(before, 100, 5);
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf}) {
    const EwaldParameters p =
        choose_ewald_parameters(make_scene(before, 100, 1e-4, method, Layers::Both));
    EXPECT_LT(relative_rms(sum_fast(before, cloud, Layers::Both, p),
                           sum_fast(after, cloud, Layers::Both, p)),
              1e-10);
  }
}

TEST(Ewald, ManyRightHandSidesOnOneGeometryAreIndependent)
{
  const Mat3 cell = make_cell(1.0, 1.1, 0.9, 0.2);
  const Cloud cloud(cell, 200, 6);
  const EwaldParameters p =
      choose_ewald_parameters(make_scene(cell, 200, 1e-4, EwaldMethod::Pswf, Layers::Both));
  PeriodicGhosts ghosts(cloud.x, cell, p.cutoff);
  PeriodicSum sum(MPI_COMM_SELF, p);
  sum.set_cell(cell, Vec3::Zero());
  sum.set_points({ghosts.nodes(), 200, cloud.x, cloud.normals, Points(3, 0)}, Layers::Both);
  auto apply = [&](Layers layers, const Points &forces, const Points &densities) {
    Points u = Points::Zero(3, ghosts.nodes().cols());
    sum.add_layers(layers, forces, densities, ghosts, u);
    return Points(u.leftCols(200));
  };
  const Points first = apply(Layers::Both, cloud.forces, cloud.densities);
  const Points single = apply(Layers::Single, cloud.forces, Points(3, 0));
  const Points twice = apply(Layers::Double, Points(3, 0), 2.0 * cloud.densities);
  EXPECT_LT(relative_rms(single + 0.5 * twice, first), 1e-13);
  EXPECT_EQ(apply(Layers::Both, cloud.forces, cloud.densities), first);
}

TEST(Ewald, TargetsMayDifferFromSources)
{
  const Mat3 cell = make_cell(1.3, 1.1, 0.9, 0.2);
  const Cloud sources(cell, 150, 7), targets(cell, 60, 8);
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf}) {
    const EwaldParameters p =
        choose_ewald_parameters(make_scene(cell, 150, 1e-5, method, Layers::Both));
    PeriodicGhosts ghosts(targets.x, cell, p.cutoff + 2.0);    // all images that any source may reach
    PeriodicSum sum(MPI_COMM_SELF, p);
    sum.set_cell(cell, Vec3::Zero());
    sum.set_points({ghosts.nodes(), 60, sources.x, sources.normals, Points(3, 0)}, Layers::Both);
    Points u = Points::Zero(3, ghosts.nodes().cols());
    sum.add_layers(Layers::Both, sources.forces, sources.densities, ghosts, u);
    const Points exact =
        compute_oracle_single_layer(cell, targets.x, sources.x, sources.forces) +
        compute_oracle_double_layer(cell, targets.x, sources.x, sources.densities, sources.normals);
    EXPECT_LT(relative_rms(u.leftCols(60), exact), 1e-5);
  }
}

TEST(Ewald, CoincidentPointsGiveThePeriodicRemainder)
{
  const Mat3 cell = make_cell(1.0, 1.1, 0.9, 0.2);
  Cloud cloud(cell, 100, 9);
  cloud.x.col(7) = cloud.x.col(3);    // two points at one place
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf}) {
    const EwaldParameters p =
        choose_ewald_parameters(make_scene(cell, 100, 1e-6, method, Layers::Both));
    EXPECT_LT(relative_rms(sum_fast(cell, cloud, Layers::Both, p),
                           sum_exact(cell, cloud, Layers::Both)), 1e-6);
  }
}

TEST(Ewald, EveryParameterCanBeFixed)
{
  EwaldScene scene = make_scene(make_cell(1, 1, 1, 0), 1000, 1e-3, EwaldMethod::Pswf);
  scene.cutoff = 0.21;
  scene.order = 9;
  EXPECT_EQ(choose_ewald_parameters(scene).cutoff, 0.21);
  EXPECT_EQ(choose_ewald_parameters(scene).order, 9);
  EXPECT_LE(choose_ewald_parameters(scene).expected_error, 1e-3);
  scene.grid = {12, 12, 12};    // too coarse: the expected error says so
  const EwaldParameters coarse = choose_ewald_parameters(scene);
  EXPECT_EQ(coarse.grid, scene.grid);
  EXPECT_GT(coarse.expected_error, 1e-3);
  scene.grid = {};
  scene.splitting = 40.0;
  EXPECT_EQ(choose_ewald_parameters(scene).splitting, 40.0);
}

TEST(Ewald, SearchMeasuresTheErrorAndMeetsTheToleranceWithLessWaste)
{
  const Mat3 cell = make_cell(1.0, 1.1, 0.9, 0.2);
  for (double size : {1.0, 0.15}) {    // random points, points in one corner
    const Cloud cloud(cell, 500, 10, size);
    const Points exact = sum_exact(cell, cloud, Layers::Single);
    const EwaldScene scene = make_scene(cell, 500, 1e-4, EwaldMethod::Pswf);
    const EwaldTimings timings = search_ewald_parameters(MPI_COMM_SELF, scene, cloud.x);
    EXPECT_GE(timings.n_tried, 2);
    auto measure = [&](const EwaldParameters &p) {
      return relative_rms(sum_fast(cell, cloud, Layers::Single, p), exact);
    };
    const EwaldParameters chosen = choose_ewald_parameters(scene);
    EXPECT_NEAR(timings.error_factor, measure(chosen) / chosen.expected_error, 0.3);
    const double error = measure(timings.fastest);
    EXPECT_LE(error, 1e-4);
    if (size < 1.0) EXPECT_GT(error, 1.5 * measure(chosen));
  }
}

TEST(Ewald, AccuracyOutOfRangeIsRefused)
{
  for (double accuracy : {1e-14, 0.0, 1.0, std::nan("")})
    EXPECT_THROW(choose_ewald_parameters(
                     make_scene(make_cell(1, 1, 1, 0), 10, accuracy, EwaldMethod::Pswf)),
                 Error);
}

TEST(Ewald, AccuracyThatTheCutoffCannotGiveIsRefused)
{
  EwaldScene scene = make_scene(make_cell(1, 1, 1, 0), 1000, 1e-8, EwaldMethod::Pswf);
  scene.cutoff = 1e-3;
  EXPECT_THROW(choose_ewald_parameters(scene), Error);
}
