// Linear systems for the tests of GMRES: every rank makes the same one and holds its rows of the
// unknowns.
#ifndef GMRES_SYSTEM_H
#define GMRES_SYSTEM_H

#include "biem_solver_gmres.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace biem_test {

using namespace biem;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows of n unknowns on this rank of a communicator: unequal shares, none on the second rank.
class Share {
 public:
  Share(MPI_Comm comm, int n) : comm_(comm)
  {
    MPI_Comm_rank(comm, &rank_);
    MPI_Comm_size(comm, &n_ranks_);
    const int n_holders = n_ranks_ > 1 ? n_ranks_ - 1 : 1;
    for (int r = 0, end = 0, holder = 0; r < n_ranks_; r++) {
      offsets_.push_back(end);
      if (r != 1) end = ++holder == n_holders ? n : end + n / n_ranks_ + 1;
      counts_.push_back(end - offsets_.back());
    }
  }

  int rank() const { return rank_; }
  bool is_last() const { return rank_ == n_ranks_ - 1; }
  template <class Matrix> Matrix rows(const Matrix &all) const
  {
    return all.middleRows(offsets_[rank_], counts_[rank_]);
  }
  VectorXd gather(const VectorXd &own) const
  {
    VectorXd all(offsets_.back() + counts_.back());
    MPI_Allgatherv(own.data(), counts_[rank_], MPI_DOUBLE, all.data(), counts_.data(),
                   offsets_.data(), MPI_DOUBLE, comm_);
    return all;
  }
  LinearMap map(const MatrixXd &matrix) const
  {
    return [this, own = rows(matrix)](const VectorXd &in, VectorXd &out) {
      out = own * gather(in);
    };
  }

 private:
  MPI_Comm comm_;
  int rank_, n_ranks_;
  std::vector<int> counts_, offsets_;
};

inline MatrixXd make_random(int rows, int columns, unsigned seed)
{
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); i++)
    matrix.data()[i] = normal(generator);
  return matrix;
}

// Nonsymmetric; eigenvalues in a disc of radius 1 around 2.
inline MatrixXd make_operator(int n)
{
  return 2.0 * MatrixXd::Identity(n, n) + make_random(n, n, 5) / std::sqrt(double(n));
}

inline LinearMap count_calls(const LinearMap &map, int &n_calls)
{
  return [map, &n_calls](const VectorXd &in, VectorXd &out) {
    n_calls++;
    map(in, out);
  };
}

// A system on all ranks and its solution by Gmres.
struct System {
  MatrixXd matrix;
  VectorXd right_hand_side;
  MPI_Comm comm = MPI_COMM_WORLD;
  SolverControl control{1e-13, 200, 200};
  MatrixXd null_vectors = MatrixXd(0, 0);
  VectorXd guess = VectorXd(0);

  VectorXd solution = VectorXd(0);
  VectorXd residual = VectorXd(0);
  int n_operator_calls = 0;

  int n() const { return static_cast<int>(matrix.rows()); }
  Share share() const { return Share(comm, n()); }

  SolverReport solve(const LinearMap &preconditioner = {})
  {
    const Share share = this->share();
    return solve_with(share, count_calls(share.map(matrix), n_operator_calls), preconditioner);
  }

  SolverReport solve_with(const Share &share, const LinearMap &map, const LinearMap &preconditioner)
  {
    Gmres gmres(comm, control);
    if (null_vectors.cols() > 0) gmres.set_null_vectors(share.rows(null_vectors));
    VectorXd own = share.rows(guess.size() > 0 ? guess : VectorXd(VectorXd::Zero(n())));
    const SolverReport report = gmres.solve(map, preconditioner, share.rows(right_hand_side), own);
    solution = share.gather(own);
    residual = share.gather(gmres.residual());
    return report;
  }
};

inline System make_system(int n)
{
  return {make_operator(n), make_random(n, 1, 7)};
}

inline double compute_relative_residual(const System &s)
{
  return (s.right_hand_side - s.matrix * s.solution).norm() / s.right_hand_side.norm();
}

}    // namespace biem_test

#endif
