// Cells, random points and the measure of a relative error, for the tests of periodic sums; and who
// this rank is.
#ifndef BIEM_TESTS_RANDOM_POINTS_H
#define BIEM_TESTS_RANDOM_POINTS_H

#include "biem_types.h"
#include <mpi.h>
#include <random>

namespace biem {

// Lattice vectors in the columns; tilt: xz / lx.
inline Mat3 make_cell(double lx, double ly, double lz, double tilt)
{
  Mat3 cell = Vec3(lx, ly, lz).asDiagonal();
  cell(0, 2) = tilt * lx;
  return cell;
}

inline Points make_random(int n, std::mt19937_64 &generator, double low, double high)
{
  std::uniform_real_distribution<double> uniform(low, high);
  Points p(3, n);
  for (Eigen::Index i = 0; i < p.size(); i++)
    p.data()[i] = uniform(generator);
  return p;
}

inline double relative_rms(const Points &a, const Points &b)
{
  return (a - b).norm() / b.norm();
}

inline int get_rank()
{
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

inline int get_n_ranks()
{
  int n_ranks;
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  return n_ranks;
}

}    // namespace biem

#endif
