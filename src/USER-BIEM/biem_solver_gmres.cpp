// GMRES: see the header.
#include "biem_solver_gmres.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace biem {

namespace {

using Eigen::VectorXd;

// What is left of a vector, relative to it, that rounding cannot tell from nothing: of an image,
// and of a null vector, which may come from computed normals.
constexpr double kRounding = 1e-14, kDependent = 1e-10;
// True over estimated residual, which is 1 for an exact operator.
constexpr double kDistrust = 2.0;

// min || beta e_1 - H y || while H, upper Hessenberg, grows by columns: Givens rotations.
class HessenbergLeastSquares {
 public:
  HessenbergLeastSquares(int max_columns, double beta) :
      triangle_(max_columns, max_columns), target_(VectorXd::Zero(max_columns + 1))
  {
    target_[0] = beta;
    rotations_.reserve(max_columns);
  }

  // column: n + 2 entries for n columns so far. Returns the norm of the residual.
  double add_column(VectorXd column)
  {
    const double norm = column.norm();
    for (int i = 0; i < n_; i++)
      column.applyOnTheLeft(i, i + 1, rotations_[i].adjoint());
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(column[n_], column[n_ + 1]);
    column.applyOnTheLeft(n_, n_ + 1, rotation.adjoint());
    // Only the last column of a broken-down basis can depend on the others: it adds nothing.
    if (std::fabs(column[n_]) <= kRounding * norm) return std::fabs(target_[n_]);
    target_.applyOnTheLeft(n_, n_ + 1, rotation.adjoint());
    triangle_.col(n_).head(n_ + 1) = column.head(n_ + 1);
    rotations_.push_back(rotation);
    n_++;
    return std::fabs(target_[n_]);
  }

  VectorXd solve() const
  {
    return triangle_.topLeftCorner(n_, n_).triangularView<Eigen::Upper>().solve(target_.head(n_));
  }

 private:
  int n_ = 0;
  Eigen::MatrixXd triangle_;
  VectorXd target_;
  std::vector<Eigen::JacobiRotation<double>> rotations_;
};

double count_not_finite(const VectorXd &vector)
{
  return static_cast<double>(vector.size() - vector.array().isFinite().count());
}

}    // namespace

Gmres::Gmres(MPI_Comm comm, const SolverControl &control) : comm_(comm), control_(control)
{
  std::ostringstream message;
  if (!(control.tolerance > 0.0 && control.tolerance < 1.0))
    message << "tolerance " << control.tolerance
            << " is out of range: give a number between 0 and 1";
  else if (control.max_iterations < 1)
    message << "maximum number of iterations is " << control.max_iterations << ": give 1 or more";
  else if (control.restart < 1)
    message << "restart after " << control.restart << " iterations: give 1 or more";
  if (!message.str().empty()) throw Error("GMRES: " + message.str());
}

void Gmres::set_null_vectors(const Eigen::MatrixXd &vectors)
{
  const int n = static_cast<int>(vectors.cols());
  operator_faults_ = preconditioner_faults_ = Faults();
  basis_.resize(vectors.rows(), n);
  for (int i = 0; i < n; i++) {
    VectorXd vector = vectors.col(i);
    const VectorXd coefficients = orthogonalise(i, vector);
    const double rest = coefficients[i];
    if (!(rest > kDependent * coefficients.norm()))    // NaN, too
      throw Error("GMRES: null vector " + std::to_string(i + 1) + " of " + std::to_string(n) +
                  " is zero, not finite or a combination of those before it; give each null "
                  "vector once");
    basis_.col(i) = vector / rest;
  }
  null_vectors_ = basis_;
}

SolverReport Gmres::solve(const LinearMap &apply_operator, const LinearMap &apply_preconditioner,
                          const VectorXd &right_hand_side, VectorXd &solution)
{
  check_input(right_hand_side, solution);
  const int n_null = static_cast<int>(null_vectors_.cols());
  const int n_cycle = std::min(control_.restart, control_.max_iterations);
  basis_.resize(solution.size(), n_null + n_cycle + 1);    // pages not written to cost no memory
  directions_.resize(solution.size(), n_cycle);
  if (n_null > 0) basis_.leftCols(n_null) = null_vectors_;
  operator_faults_ = preconditioner_faults_ = Faults();

  residual_ = right_hand_side;
  scale_ = project(residual_, "in the right-hand side");
  if (scale_ == 0.0) solution.setZero();
  const bool has_guess = project(solution, "in the initial guess") > 0.0;
  SolverReport report;
  report.residual = scale_ == 0.0 ? 0.0 : 1.0;
  if (has_guess) report.residual = compute_residual(apply_operator, right_hand_side, solution, 0);
  report.history = {report.residual};
  while (report.residual > control_.tolerance) {
    const double before = report.residual;
    const CycleEnd end = run_cycle(apply_operator, apply_preconditioner, report, solution);
    const double estimate = report.history.back();
    report.residual = estimate;
    const bool is_trusted = control_.final_residual == FinalResidual::Estimated;
    if (is_trusted && estimate <= control_.tolerance) break;
    report.residual =
        compute_residual(apply_operator, right_hand_side, solution, report.iterations);
    report.history.back() = report.residual;
    if (report.residual <= control_.tolerance) break;
    const bool is_stuck = end == CycleEnd::Breakdown && report.residual > 0.5 * before;
    if (is_stuck || report.iterations >= control_.max_iterations)
      throw_not_converged(report, estimate, is_stuck ? end : CycleEnd::Regular);
  }
  return report;
}

// Adds the best correction of one Krylov space to the solution.
Gmres::CycleEnd Gmres::run_cycle(const LinearMap &apply_operator,
                                 const LinearMap &apply_preconditioner, SolverReport &report,
                                 VectorXd &solution)
{
  const int n_null = static_cast<int>(null_vectors_.cols());
  const int n_steps = std::min(control_.restart, control_.max_iterations - report.iterations);
  HessenbergLeastSquares least_squares(n_steps, report.residual);    // relative to scale_
  VectorXd vector = residual_, direction, image;
  double norm = report.residual * scale_;
  for (int j = 0; j < n_steps; j++) {
    vector /= norm;
    basis_.col(n_null + j) = vector;
    direction = vector;
    if (apply_preconditioner) {
      apply(apply_preconditioner, vector, direction, preconditioner_faults_);
      if (n_null > 0) subtract_projection(n_null, direction);
    }
    directions_.col(j) = direction;
    apply(apply_operator, direction, image, operator_faults_);
    const VectorXd column = orthogonalise(n_null + j + 1, image);
    report.iterations++;
    check_finite(column, "in iteration " + std::to_string(report.iterations));
    report.history.push_back(least_squares.add_column(column.tail(j + 2)));
    norm = column[n_null + j + 1];
    if (norm == 0.0 || report.history.back() <= control_.tolerance) break;
    vector.swap(image);
  }
  const VectorXd weights = least_squares.solve();
  solution.noalias() += directions_.leftCols(weights.size()) * (scale_ * weights);
  return norm == 0.0 ? CycleEnd::Breakdown : CycleEnd::Regular;
}

// Relative; fills residual_.
double Gmres::compute_residual(const LinearMap &apply_operator, const VectorXd &right_hand_side,
                               const VectorXd &solution, int iterations)
{
  apply(apply_operator, solution, residual_, operator_faults_);
  residual_ = right_hand_side - residual_;
  return project(residual_, "in the residual after " + std::to_string(iterations) + " iterations") /
         scale_;
}

// Removes the null vectors and returns the norm of the rest.
double Gmres::project(VectorXd &vector, const std::string &where) const
{
  const int n_null = static_cast<int>(null_vectors_.cols());
  const VectorXd coefficients = orthogonalise(n_null, vector);
  check_finite(coefficients, where);
  if (coefficients[n_null] == 0.0) vector.setZero();    // what is left is rounding
  return coefficients[n_null];
}

// Classical Gram-Schmidt against the first n_basis vectors, twice, which keeps the basis orthogonal
// to rounding (Giraud et al., Numer. Math. 101, 87, 2005). Returns the coefficients, then the norm
// of the rest: zero if the vector lies in the space of the basis.
VectorXd Gmres::orthogonalise(int n_basis, VectorXd &vector) const
{
  const VectorXd first = subtract_projection(n_basis, vector);
  const VectorXd second = subtract_projection(n_basis, vector);
  VectorXd coefficients = first + second;
  // Pythagoras saves a message: the second pass takes next to nothing away, or the rest is noise.
  const double rest = second[n_basis] - second.head(n_basis).squaredNorm();
  const double whole = first[n_basis];
  const bool is_noise = rest < 0.5 * second[n_basis] || rest <= kRounding * kRounding * whole;
  if (!std::isfinite(whole))
    coefficients[n_basis] = whole;
  else
    coefficients[n_basis] = is_noise ? 0.0 : std::sqrt(rest);
  return coefficients;
}

// One pass and one message. Returns the coefficients, then the square of the norm before.
VectorXd Gmres::subtract_projection(int n_basis, VectorXd &vector) const
{
  VectorXd sums(n_basis + 1);
  sums.head(n_basis).noalias() = basis_.leftCols(n_basis).transpose() * vector;
  // A rank that has seen a fault tells the others in the message that is sent anyway.
  sums[n_basis] = has_faults() ? std::numeric_limits<double>::quiet_NaN() : vector.squaredNorm();
  sum_over_ranks(sums.data(), n_basis + 1);
  vector.noalias() -= basis_.leftCols(n_basis) * sums.head(n_basis);
  return sums;
}

// MPI promises the same result on every rank, so all ranks take the same decisions.
void Gmres::sum_over_ranks(double *values, int n) const
{
  MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, comm_);
}

void Gmres::apply(const LinearMap &map, const VectorXd &in, VectorXd &out, Faults &faults)
{
  out.resize(in.size());
  map(in, out);
  if (out.size() == in.size())
    faults.n_not_finite += count_not_finite(out);
  else {
    faults.n_wrong_length += 1.0;
    out.setZero(in.size());
  }
}

bool Gmres::has_faults() const
{
  const Faults &a = operator_faults_, &b = preconditioner_faults_;
  return a.n_not_finite + a.n_wrong_length + b.n_not_finite + b.n_wrong_length > 0.0;
}

void Gmres::check_input(const VectorXd &right_hand_side, const VectorXd &solution) const
{
  const auto n = right_hand_side.size();
  const bool has_null_vectors = null_vectors_.cols() > 0;
  double sums[] = {count_not_finite(right_hand_side), count_not_finite(solution),
                   solution.size() == n ? 0.0 : 1.0,
                   has_null_vectors && null_vectors_.rows() != n ? 1.0 : 0.0};
  sum_over_ranks(sums, 4);
  std::ostringstream message;
  if (sums[0] > 0)
    message << "the right-hand side has " << sums[0] << " values that are not finite; check the "
            << "forces, the prescribed velocities and the positions they come from";
  else if (sums[1] > 0)
    message << "the initial guess has " << sums[1]
            << " values that are not finite; start from zero";
  else if (sums[2] > 0)
    message << "the initial guess is not as long as the right-hand side on " << sums[2] << " ranks";
  else if (sums[3] > 0)
    message << "the null vectors are not as long as the right-hand side on " << sums[3]
            << " ranks; set them again when unknowns move between ranks";
  if (!message.str().empty()) throw Error("GMRES: " + message.str());
}

// coefficients: sums over the ranks, so that every rank finds the same.
void Gmres::check_finite(const VectorXd &coefficients, const std::string &where) const
{
  if (coefficients.allFinite()) return;
  double sums[] = {preconditioner_faults_.n_not_finite, preconditioner_faults_.n_wrong_length,
                   operator_faults_.n_not_finite, operator_faults_.n_wrong_length,
                   static_cast<double>(basis_.rows())};
  sum_over_ranks(sums, 5);
  const bool is_preconditioner = sums[0] + sums[1] > 0;    // then the operator's are its results
  const double *faults = is_preconditioner ? sums : sums + 2;
  const std::string who = is_preconditioner ? "the preconditioner" : "the operator";
  std::ostringstream message;
  message << "GMRES " << where << ": ";
  if (faults[1] > 0)
    message << who << " returned a vector of the wrong length on " << faults[1] << " ranks";
  else if (faults[0] > 0)
    message << who << " returned " << faults[0] << " values that are not finite, of " << sums[4]
            << " unknowns; likely causes: surfaces that touch or cross, collapsed elements, "
            << "positions that are not finite. Look at the last steps and reduce the time step";
  else
    message << "a norm is too large to be represented; check the units and the forces";
  throw Error(message.str());
}

void Gmres::throw_not_converged(const SolverReport &report, double estimate, CycleEnd end) const
{
  std::ostringstream message;
  message << "GMRES did not converge: relative residual " << report.residual << " after "
          << report.iterations << " iterations, tolerance " << control_.tolerance;
  if (end == CycleEnd::Breakdown)
    message << "; more iterations cannot reduce it. Likely causes: an operator or preconditioner "
            << "that is singular (a null vector that was not given), or a tolerance below rounding";
  else if (report.residual > kDistrust * estimate)
    message << "; the iteration itself expected " << estimate << ". Likely cause: the tolerance is "
            << "below the accuracy of the operator; loosen it or compute the operator more "
            << "accurately";
  else
    message
        << ". Likely causes: surfaces that nearly touch, a mesh too coarse for the gaps between "
           "them, or a tolerance below the accuracy of the operator. Reduce the time step, "
           "refine the mesh or loosen the tolerance";
  throw NotConverged(message.str(), report);
}

}    // namespace biem
