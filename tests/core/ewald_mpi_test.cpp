// Periodic sums and slab transforms on several ranks: the numbers of one rank, also with more ranks
// than planes of the grid.
#include "biem_ewald_sum.h"
#include "biem_periodic_ghosts.h"
#include "core/random_points.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

struct Cloud {
  Points x, forces, densities, normals;

  explicit Cloud(int n) : x(3, n), forces(3, n), densities(3, n), normals(3, n) {}

  Cloud select(const std::vector<int> &columns) const
  {
    Cloud part(static_cast<int>(columns.size()));
    for (size_t i = 0; i < columns.size(); i++) {
      part.x.col(i) = x.col(columns[i]);
      part.forces.col(i) = forces.col(columns[i]);
      part.densities.col(i) = densities.col(columns[i]);
      part.normals.col(i) = normals.col(columns[i]);
    }
    return part;
  }
};

Cloud make_cloud(const Mat3 &cell, int n)
{
  std::mt19937_64 generator(11);
  Cloud cloud(n);
  for (Points *p : {&cloud.x, &cloud.forces, &cloud.densities, &cloud.normals})
    *p = make_random(n, generator, -1.0, 1.0);
  cloud.x = cell * cloud.x;
  return cloud;
}

Points sum(MPI_Comm comm, const Mat3 &cell, const Cloud &cloud, const EwaldParameters &p)
{
  PeriodicGhosts ghosts(comm, cloud.x, cell, p.cutoff);
  PeriodicSum periodic(comm, p);
  periodic.set_cell(cell, Vec3(0.1, -0.2, 0.3));
  periodic.set_points({ghosts.nodes(), ghosts.n_owned(), cloud.x, cloud.normals, Points(3, 0)},
                      Layers::Both);
  Points u = Points::Zero(3, ghosts.nodes().cols());
  periodic.add_layers(Layers::Both, cloud.forces, cloud.densities, ghosts, u);
  return u.leftCols(ghosts.n_owned());
}

}    // namespace

TEST(PeriodicSumOnRanks, HasTheNumbersOfOneRank)
{
  const Mat3 cell = make_cell(1.4, 0.9, 1.1, 0.3);
  const Cloud all = make_cloud(cell, 500);
  const std::vector<int> owner = assign_to_ranks(all.x, cell, get_n_ranks());
  std::vector<int> mine;
  for (int i = 0; i < 500; i++)
    if (owner[i] == get_rank()) mine.push_back(i);
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf}) {
    EwaldScene scene;
    scene.cell = cell;
    scene.n_sources = scene.n_targets = 500;
    scene.tolerance = 1e-4;
    scene.method = method;
    scene.layers = Layers::Both;
    const EwaldParameters p = choose_ewald_parameters(scene);
    const Points exact = sum(MPI_COMM_SELF, cell, all, p);
    const Points part = sum(MPI_COMM_WORLD, cell, all.select(mine), p);
    for (size_t i = 0; i < mine.size(); i++)
      EXPECT_LT((part.col(i) - exact.col(mine[i])).norm(), 1e-11 * exact.norm());
  }
}

// A wave of the kept modes, on 3 planes: on four ranks one has none.
TEST(SlabTransformOnRanks, KeepsWavesAlsoWithMoreRanksThanPlanes)
{
  const std::array<int, 3> grid{3, 10, 12}, modes{1, 3, 4}, wave{1, -2, 3};
  SlabTransform transform(MPI_COMM_WORLD, grid, modes);
  const int n_fields = 3;
  double *values = transform.values(n_fields);
  auto phase = [&](int x, int y, int z) {
    return 2.0 * M_PI *
           (wave[0] * x / double(grid[0]) + wave[1] * y / double(grid[1]) +
            wave[2] * z / double(grid[2]));
  };
  auto at = [&](int x, int y, int z, int f) -> double & {
    return values[(x - transform.planes().begin) * transform.plane_size(n_fields) +
                  (y * grid[2] + z) * n_fields + f];
  };
  auto for_each = [&](auto action) {
    for (int x = transform.planes().begin; x < transform.planes().end; x++)
      for (int y = 0; y < grid[1]; y++)
        for (int z = 0; z < grid[2]; z++)
          for (int f = 0; f < n_fields; f++) action(at(x, y, z, f), (f + 1) * std::cos(phase(x, y, z)));
  };
  for_each([](double &value, double expected) { value = expected; });
  transform.forward(n_fields);
  transform.forward_columns(0, transform.n_columns(), n_fields);
  const double size = grid[0] * grid[1] * grid[2];
  int n_found = 0;
  for (int i = 0; i < transform.n_columns(); i++)
    for (int f = 0; f < n_fields; f++)
      for (int n0 = 0; n0 < grid[0]; n0++) {
        const bool is_wave = transform.column_modes(i) == std::array<int, 2>{wave[1], wave[2]} &&
                             n0 == wave[0];
        n_found += is_wave;
        EXPECT_NEAR(std::abs(transform.column(i)[f * grid[0] + n0] -
                             (is_wave ? 0.5 * size * (f + 1) : 0.0)),
                    0.0, 1e-12 * size);
      }
  MPI_Allreduce(MPI_IN_PLACE, &n_found, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(n_found, n_fields);
  transform.backward_columns(0, transform.n_columns());
  transform.backward();
  for_each([size](double &value, double expected) { EXPECT_NEAR(value / size, expected, 1e-13); });
}
