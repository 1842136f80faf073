// What GMRES refuses and how it says so: no convergence, values that are not finite, wrong input.
// Every rank must throw, or the others would wait for ever.
#include "gmres_system.h"
#include <limits>

using namespace biem;
using namespace biem_test;

namespace {

// Moves every value to the next place: GMRES finds nothing before the last of n iterations.
MatrixXd make_cyclic_shift(int n)
{
  MatrixXd shift = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; i++)
    shift((i + 1) % n, i) = 1.0;
  return shift;
}

// The message of the Error that solve throws; empty if it does not.
template <class Solve> std::string get_error(const Solve &solve)
{
  try {
    solve();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string &message, const std::vector<std::string> &words)
{
  for (const std::string &word : words)
    EXPECT_NE(message.find(word), std::string::npos) << word << " is missing in: " << message;
}

}    // namespace

TEST(GmresBreakdown, SingularOperatorIsAnErrorAtOnce)
{
  System system = make_system(30);
  system.matrix.setIdentity();
  system.matrix(3, 3) = 0.0;
  try {
    system.solve();
    FAIL() << "a singular operator must be an error";
  } catch (const NotConverged &error) {
    const VectorXd &b = system.right_hand_side;
    EXPECT_NEAR(error.report().residual, std::fabs(b[3]) / b.norm(), 1e-13);
    EXPECT_LE(error.report().iterations, 4);
    expect_words(error.what(), {"singular", "null vector"});
  }
  system.matrix.setZero();
  expect_words(get_error([&] { system.solve(); }), {"relative residual 1 ", "singular"});
}

TEST(GmresErrors, NotConvergedTellsResidualIterationsAndCauses)
{
  System system{make_cyclic_shift(12), VectorXd::Unit(12, 0)};
  EXPECT_EQ(system.solve().iterations, 12);
  EXPECT_LT(compute_relative_residual(system), 1e-13);
  system.control = {1e-3, 11, 50};
  expect_words(get_error([&] { system.solve(); }),
               {"relative residual 1 ", "11 iterations", "tolerance 0.001", "nearly touch", "mesh",
                "accuracy of the operator"});
}

TEST(GmresErrors, EstimateIsNotTrustedWhenTheOperatorIsInaccurate)
{
  System system = make_system(40);
  system.control = {1e-8, 100, 50};
  const Share share = system.share();
  const LinearMap exact = share.map(system.matrix);
  int n_calls = 0, n_inaccurate = 1000000;
  const auto noisy = [&](const VectorXd &in, VectorXd &out) {
    exact(in, out);
    if (n_calls++ < n_inaccurate)
      out += 1e-3 * share.rows(VectorXd(make_random(40, 1, 100 + n_calls))) / std::sqrt(40.0);
  };
  expect_words(get_error([&] { system.solve_with(share, noisy, {}); }),
               {"100 iterations", "iteration itself expected", "accuracy of the operator"});
  n_calls = 0;
  n_inaccurate = 20;    // the iteration goes on until the true residual is small
  EXPECT_LE(system.solve_with(share, noisy, {}).residual, 1e-8);
  EXPECT_LE(compute_relative_residual(system), 1e-8);
}

TEST(GmresErrors, ValuesThatAreNotFiniteNameTheirSourceOnEveryRank)
{
  System system = make_system(40);
  const Share share = system.share();
  const LinearMap exact = share.map(system.matrix);
  int n_calls = 0;
  const auto spoil = [&](const VectorXd &in, VectorXd &out) {    // in its second call, on rank 0
    exact(in, out);
    if (++n_calls == 2 && share.rank() == 0)
      out.head(2).setConstant(std::numeric_limits<double>::infinity());
  };
  expect_words(get_error([&] { system.solve_with(share, spoil, {}); }),
               {"iteration 2", "the operator returned 2 values", "not finite", "40 unknowns"});
  n_calls = 0;
  expect_words(get_error([&] { system.solve_with(share, exact, spoil); }),
               {"iteration 2", "the preconditioner returned 2 values", "not finite"});
  n_calls = 1;
  system.guess = make_random(40, 1, 2);
  expect_words(get_error([&] { system.solve_with(share, spoil, {}); }),
               {"residual after 0 iterations", "the operator"});
  const auto enlarge = [&](const VectorXd &in, VectorXd &out) {
    out = 1e200 * in;
  };
  system.guess.setZero();
  expect_words(get_error([&] { system.solve_with(share, enlarge, {}); }),
               {"iteration 1", "norm is too large"});
}

TEST(GmresErrors, SolverCanBeUsedAgainAfterAnError)
{
  const System system = make_system(40);
  const Share share = system.share();
  const VectorXd right_hand_side = share.rows(system.right_hand_side);
  VectorXd solution = VectorXd::Zero(right_hand_side.size());
  Gmres gmres(MPI_COMM_WORLD, system.control);
  const auto spoil = [](const VectorXd &in, VectorXd &out) {
    out.setConstant(in.size(), std::numeric_limits<double>::quiet_NaN());
  };
  EXPECT_THROW(gmres.solve(spoil, {}, right_hand_side, solution), Error);
  EXPECT_EQ(solution, VectorXd::Zero(right_hand_side.size()));
  gmres.set_null_vectors(share.rows(make_random(40, 1, 9)));
  EXPECT_LE(gmres.solve(share.map(system.matrix), {}, right_hand_side, solution).residual, 1e-13);
}

TEST(GmresErrors, VectorsOfWrongLengthAreRefusedOnEveryRank)
{
  System system = make_system(40);
  const Share share = system.share();
  const auto lengthen = [&](const VectorXd &in, VectorXd &out) {
    out = VectorXd::Zero(in.size() + (share.is_last() ? 1 : 0));
  };
  expect_words(get_error([&] { system.solve_with(share, lengthen, {}); }),
               {"the operator returned", "wrong length on 1 ranks"});
  Gmres gmres(MPI_COMM_WORLD, SolverControl());
  const VectorXd right_hand_side = share.rows(system.right_hand_side);
  VectorXd solution = VectorXd::Zero(right_hand_side.size() + (share.is_last() ? 1 : 0));
  const LinearMap map = share.map(system.matrix);
  expect_words(get_error([&] { gmres.solve(map, {}, right_hand_side, solution); }),
               {"initial guess", "not as long"});
  solution.setZero(right_hand_side.size());
  gmres.set_null_vectors(MatrixXd::Ones(right_hand_side.size() + (share.is_last() ? 1 : 0), 1));
  expect_words(get_error([&] { gmres.solve(map, {}, right_hand_side, solution); }),
               {"null vectors", "not as long"});
}

TEST(GmresErrors, WrongInputIsRefused)
{
  System system = make_system(40);
  system.right_hand_side[0] = std::numeric_limits<double>::quiet_NaN();
  expect_words(get_error([&] { system.solve(); }), {"right-hand side has 1 values"});
  system.right_hand_side[0] = 1.0;
  system.guess = VectorXd::Constant(40, std::numeric_limits<double>::infinity());
  expect_words(get_error([&] { system.solve(); }), {"initial guess has 40 values"});
  system.null_vectors = MatrixXd::Ones(40, 2);
  expect_words(get_error([&] { system.solve(); }), {"null vector 2 of 2", "combination"});
  for (double tolerance : {0.0, -1e-3, 1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(Gmres(MPI_COMM_WORLD, {tolerance, 10, 10}), Error);
  EXPECT_THROW(Gmres(MPI_COMM_WORLD, {1e-3, 0, 10}), Error);
  EXPECT_THROW(Gmres(MPI_COMM_WORLD, {1e-3, 10, 0}), Error);
}
