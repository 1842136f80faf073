// GMRES against dense linear algebra, on any number of ranks.
#include "gmres_system.h"

using namespace biem;
using namespace biem_test;

namespace {

double compute_relative_error(const VectorXd &computed, const VectorXd &expected)
{
  return (computed - expected).norm() / expected.norm();
}

}    // namespace

TEST(Gmres, SolutionIsThatOfDenseFactorization)
{
  System system = make_system(60);
  const SolverReport report = system.solve();
  const VectorXd exact = system.matrix.partialPivLu().solve(system.right_hand_side);
  EXPECT_LT(compute_relative_error(system.solution, exact), 1e-12);
  EXPECT_LE(report.residual, 1e-13);
  EXPECT_LT(report.iterations, 60);
  EXPECT_EQ(report.history.size(), report.iterations + 1u);
  EXPECT_EQ(report.history.front(), 1.0);
  EXPECT_EQ(report.history.back(), report.residual);
  EXPECT_EQ(system.n_operator_calls, report.iterations + 1);    // one for the true residual
}

TEST(Gmres, IterationsAndSolutionDoNotDependOnTheNumberOfRanks)
{
  System distributed = make_system(60), alone = make_system(60);
  alone.comm = MPI_COMM_SELF;
  for (int restart : {200, 7}) {
    distributed.control.restart = alone.control.restart = restart;
    EXPECT_EQ(distributed.solve().iterations, alone.solve().iterations);
    EXPECT_LT(compute_relative_error(distributed.solution, alone.solution), 1e-12);
  }
}

TEST(Gmres, ReportedResidualIsTheTrueOne)
{
  for (double tolerance : {1e-2, 1e-5, 1e-9}) {
    System system = make_system(50);
    system.control.tolerance = tolerance;
    const SolverReport report = system.solve();
    EXPECT_LE(report.residual, tolerance);
    EXPECT_GT(report.residual, 0.05 * tolerance);    // and no more than was asked for
    EXPECT_NEAR(report.residual, compute_relative_residual(system), 1e-13);
    const VectorXd rest = system.right_hand_side - system.matrix * system.solution;
    EXPECT_LT((system.residual - rest).norm(), 1e-12);
  }
}

TEST(Gmres, ResidualIsTheSmallestOfTheKrylovSpace)
{
  System system = make_system(40);
  const SolverReport report = system.solve();
  const double scale = system.right_hand_side.norm();
  MatrixXd images(40, 0);    // orthonormal basis of A b, A^2 b, ...
  VectorXd next = system.right_hand_side;
  for (int k = 1; k <= 10; k++) {
    next = (system.matrix * next).normalized();
    images.conservativeResize(40, k);
    images.col(k - 1) = next;
    const MatrixXd q = images.householderQr().householderQ() * MatrixXd::Identity(40, k);
    const VectorXd rest = system.right_hand_side - q * (q.transpose() * system.right_hand_side);
    EXPECT_NEAR(report.history.at(k), rest.norm() / scale, 1e-9);
  }
}

TEST(Gmres, RestartGoesOnFromTheSolutionReached)
{
  System whole = make_system(60), restarted = make_system(60);
  restarted.control.restart = 4;
  const SolverReport report = restarted.solve();
  EXPECT_GT(report.iterations, whole.solve().iterations);
  EXPECT_LT(compute_relative_error(restarted.solution, whole.solution), 1e-12);
  for (size_t i = 1; i < report.history.size(); i++)
    EXPECT_LE(report.history[i], report.history[i - 1] * (1.0 + 1e-3));
}

TEST(Gmres, CyclesOfOneIterationAreMinimalResidualSteps)
{
  System system = make_system(30);
  system.control = {1e-6, 200, 1};
  const SolverReport report = system.solve();
  VectorXd rest = system.right_hand_side;
  for (int i = 1; i <= report.iterations; i++) {
    const VectorXd image = system.matrix * rest;
    rest -= rest.dot(image) / image.squaredNorm() * image;
    EXPECT_NEAR(report.history.at(i), rest.norm() / system.right_hand_side.norm(), 1e-11);
  }
  EXPECT_GT(report.iterations, 3);
}

TEST(GmresPreconditioner, ExactInverseConvergesInOneIteration)
{
  System system = make_system(50);
  system.control.tolerance = 1e-11;
  const Share share = system.share();
  const SolverReport report = system.solve(share.map(system.matrix.inverse()));
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LE(compute_relative_residual(system), 1e-11);
}

TEST(GmresPreconditioner, ActsFromTheRightAndSavesIterations)
{
  // Rows of very different size: a left preconditioner would report another residual.
  System system = make_system(50);
  const VectorXd sizes = VectorXd::LinSpaced(50, -2.0, 2.0).array().exp();
  system.matrix = sizes.asDiagonal() * system.matrix;
  system.control.tolerance = 1e-6;
  const int n_plain = system.solve().iterations;
  const Share share = system.share();
  const MatrixXd inverse = sizes.cwiseInverse().asDiagonal();
  const SolverReport report = system.solve(share.map(inverse));
  EXPECT_LT(report.iterations, n_plain - 5);
  EXPECT_NEAR(report.residual, compute_relative_residual(system), 1e-12);
}

TEST(GmresPreconditioner, MayChangeFromIterationToIteration)
{
  System system = make_system(50);
  system.control = {1e-12, 40, 40};
  const Share share = system.share();
  const LinearMap coarse =
      share.map(MatrixXd(system.matrix.diagonal().cwiseInverse().asDiagonal()));
  const LinearMap fine = share.map((system.matrix + 0.05 * make_random(50, 50, 3)).inverse());
  int n_calls = 0;
  const auto changing = [&](const VectorXd &in, VectorXd &out) {
    (n_calls++ % 3 == 1 ? fine : coarse)(in, out);
  };
  const SolverReport report = system.solve(changing);
  EXPECT_EQ(n_calls, report.iterations);
  EXPECT_EQ(system.n_operator_calls, report.iterations + 1);    // the first estimate was right
  EXPECT_LE(compute_relative_residual(system), 1e-12);
}

TEST(GmresGuess, SolutionAsGuessNeedsNoIteration)
{
  System system = make_system(40);
  system.control.tolerance = 1e-10;
  system.guess = system.matrix.partialPivLu().solve(system.right_hand_side);
  const SolverReport report = system.solve();
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.history, std::vector<double>{report.residual});
  EXPECT_EQ(system.n_operator_calls, 1);
  EXPECT_EQ(system.solution, system.guess);
}

TEST(GmresGuess, NearbyGuessSavesIterations)
{
  System system = make_system(40);
  system.control.tolerance = 1e-6;
  const int n_cold = system.solve().iterations;
  system.guess =
      system.matrix.partialPivLu().solve(system.right_hand_side) + 1e-4 * make_random(40, 1, 2);
  const SolverReport warm = system.solve();
  EXPECT_LT(warm.iterations, 0.7 * n_cold);
  EXPECT_GT(warm.iterations, 0);
  EXPECT_LE(compute_relative_residual(system), 1e-6);    // relative to b, not to the first residual
}

TEST(GmresGuess, ZeroRightHandSideGivesZeroAtOnce)
{
  System system = make_system(20);
  system.right_hand_side.setZero();
  system.guess = make_random(20, 1, 2);
  const SolverReport report = system.solve();
  EXPECT_EQ(system.solution, VectorXd::Zero(20));
  EXPECT_EQ(system.n_operator_calls, 0);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.residual, 0.0);
}

TEST(GmresNullVectors, AreKeptOutOfSolutionAndResidual)
{
  System system = make_system(40);
  system.null_vectors = make_random(40, 2, 9);    // neither of length one nor orthogonal
  system.guess = make_random(40, 1, 2);
  const MatrixXd q = system.null_vectors.householderQr().householderQ() * MatrixXd::Identity(40, 2);
  const MatrixXd p = MatrixXd::Identity(40, 40) - q * q.transpose();
  const VectorXd exact =
      (p * system.matrix * p + q * q.transpose()).partialPivLu().solve(p * system.right_hand_side);
  const MatrixXd inverse = (system.matrix + 0.05 * make_random(40, 40, 3)).inverse();
  const Share share = system.share();
  for (const LinearMap &preconditioner : {LinearMap(), share.map(inverse)})
    for (int restart : {100, 3}) {
      system.control.restart = restart;
      EXPECT_LE(system.solve(preconditioner).residual, 1e-13);
      EXPECT_LT(compute_relative_error(system.solution, exact), 1e-12);
      EXPECT_LT((q.transpose() * system.solution).norm(), 1e-13);
      EXPECT_LT((q.transpose() * system.residual).norm(), 1e-13);
    }
}

TEST(GmresNullVectors, SingularOperatorIsSolvedWhereItCanBe)
{
  // A n = 0, and b has a part that A cannot reach: with the null vector that part does not count.
  System system = make_system(40);
  const VectorXd null = make_random(40, 1, 4).normalized();
  const MatrixXd p = MatrixXd::Identity(40, 40) - null * null.transpose();
  system.matrix = (p * system.matrix * p).eval();
  EXPECT_THROW(system.solve(), NotConverged);
  system.null_vectors = -3.0 * null;
  system.solve();
  const VectorXd rest = system.right_hand_side - system.matrix * system.solution;
  EXPECT_LT((p * rest).norm(), 1e-12);
  EXPECT_LT(std::fabs(null.dot(system.solution)), 1e-13);
}

TEST(GmresNullVectors, RightHandSideInTheNullSpaceGivesZero)
{
  System system = make_system(40);
  system.null_vectors = make_random(40, 2, 9);
  system.right_hand_side = system.null_vectors * Eigen::Vector2d(3.0, -0.2);
  system.guess = make_random(40, 1, 2);
  EXPECT_EQ(system.solve().iterations, 0);
  EXPECT_EQ(system.solution, VectorXd::Zero(40));
}

TEST(Gmres, SecondKindOperatorNeedsAsManyIterationsOnEveryMesh)
{
  // u(t) + int k(t, s) u(s) ds = f(t) on a circle by the trapezoidal rule, which is spectral.
  std::vector<int> iterations;
  for (int n : {40, 80, 160, 320}) {
    const VectorXd t = VectorXd::LinSpaced(n + 1, 0.0, 2.0 * M_PI).head(n);
    System system{MatrixXd::Identity(n, n), t.array().cos().exp().matrix()};
    system.control.tolerance = 1e-8;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        system.matrix(i, j) += 0.8 / n * std::exp(std::sin(t[j]) - std::cos(t[i] - t[j]));
    iterations.push_back(system.solve().iterations);
  }
  EXPECT_EQ(iterations, std::vector<int>(4, iterations[0]));
  EXPECT_LE(iterations[0], 10);
}

TEST(GmresBreakdown, InvariantSubspaceGivesTheExactSolution)
{
  System system = make_system(30);
  system.matrix = VectorXd::LinSpaced(30, 1.0, 30.0).asDiagonal();
  system.right_hand_side.setZero();
  for (int i : {2, 11, 29})
    system.right_hand_side[i] = 1.0;
  EXPECT_EQ(system.solve().iterations, 3);
  EXPECT_LT(compute_relative_residual(system), 1e-13);
  system.matrix.setIdentity();
  EXPECT_EQ(system.solve().iterations, 1);
  EXPECT_EQ(system.solution, system.right_hand_side);
}
