// Flexible, right-preconditioned, restarted GMRES on callables; every rank holds a share of the
// unknowns. Knows no surfaces or kernels: only vectors and their dot products over the ranks.
// Saad, Iterative Methods for Sparse Linear Systems (2003), Algorithm 9.6.
#ifndef BIEM_SOLVER_GMRES_H
#define BIEM_SOLVER_GMRES_H

#include "biem_error.h"
#include <Eigen/Dense>
#include <functional>
#include <mpi.h>
#include <string>
#include <vector>

namespace biem {

// out = map(in), this rank's shares, of equal length; called on all ranks together.
using LinearMap = std::function<void(const Eigen::VectorXd &in, Eigen::VectorXd &out)>;

// The residual that ends the iteration: one more application of the operator to the solution, or
// the estimate from the iteration itself, which differs from it by rounding only as long as the
// operator is the same linear map in all applications.
enum class FinalResidual { Computed, Estimated };

struct SolverControl {
  double tolerance = 1e-4;     // of the residual's norm, relative to the right-hand side's
  int max_iterations = 100;    // over all cycles
  int restart = 50;            // iterations of a cycle; each keeps two vectors
  FinalResidual final_residual = FinalResidual::Computed;
};

// Norms are relative to that of the right-hand side, without its part along the null vectors.
struct SolverReport {
  int iterations = 0;
  double residual = 0.0;    // of the returned solution; see FinalResidual
  // Before the first and after each iteration: estimates, the true residual where a cycle ends.
  std::vector<double> history;
};

// The residual did not fall to the tolerance. Gmres::residual() tells where it is large.
class NotConverged : public Error {
 public:
  NotConverged(const std::string &message, const SolverReport &report) :
      Error(message), report_(report)
  {
  }
  const SolverReport &report() const { return report_; }

 private:
  SolverReport report_;
};

// Norms are those of the plain vector: the caller scales unknowns and equations of unlike units.
// All member functions but residual() are collective, and so are their errors.
class Gmres {
 public:
  Gmres(MPI_Comm comm, const SolverControl &control);

  // n_local x n_vectors, as many on all ranks, linearly independent; orthonormalised here. They are
  // kept out of the solution and out of the residual: A becomes P A P, P = 1 - N N^T.
  void set_null_vectors(const Eigen::MatrixXd &vectors);

  // Solves apply_operator(solution) = right_hand_side. solution: initial guess in, solution out;
  // after NotConverged the last one reached. apply_preconditioner approximates the inverse of the
  // operator; it may change between calls, and may be empty.
  SolverReport solve(const LinearMap &apply_operator, const LinearMap &apply_preconditioner,
                     const Eigen::VectorXd &right_hand_side, Eigen::VectorXd &solution);

  // P (right_hand_side - A solution) of the last solve, this rank's share; after a solve that ended
  // with an estimate, that of the last one that was computed.
  const Eigen::VectorXd &residual() const { return residual_; }

 private:
  // What a callable did wrong: counts of values and of ranks.
  struct Faults {
    double n_not_finite = 0.0, n_wrong_length = 0.0;
  };
  enum class CycleEnd { Regular, Breakdown };

  static void apply(const LinearMap &map, const Eigen::VectorXd &in, Eigen::VectorXd &out,
                    Faults &faults);
  bool has_faults() const;    // of this rank, in this solve
  void sum_over_ranks(double *values, int n) const;
  void check_input(const Eigen::VectorXd &right_hand_side, const Eigen::VectorXd &solution) const;
  void check_finite(const Eigen::VectorXd &coefficients, const std::string &where) const;
  Eigen::VectorXd subtract_projection(int n_basis, Eigen::VectorXd &vector) const;
  Eigen::VectorXd orthogonalise(int n_basis, Eigen::VectorXd &vector) const;
  double project(Eigen::VectorXd &vector, const std::string &where) const;
  double compute_residual(const LinearMap &apply_operator, const Eigen::VectorXd &right_hand_side,
                          const Eigen::VectorXd &solution, int iterations);
  CycleEnd run_cycle(const LinearMap &apply_operator, const LinearMap &apply_preconditioner,
                     SolverReport &report, Eigen::VectorXd &solution);
  [[noreturn]] void throw_not_converged(const SolverReport &report, double estimate,
                                        CycleEnd end) const;

  MPI_Comm comm_;
  SolverControl control_;
  Eigen::MatrixXd null_vectors_;    // n_local x n_null, orthonormal over the ranks
  Eigen::MatrixXd basis_;           // null vectors, then the Krylov basis V of this cycle
  Eigen::MatrixXd directions_;      // Z: preconditioned V, kept as the preconditioner may change
  Eigen::VectorXd residual_;
  double scale_ = 0.0;    // norm of the projected right-hand side
  Faults operator_faults_, preconditioner_faults_;
};

}    // namespace biem

#endif
