// Cost of one evaluation of the single layer and of its parts, one rank, with the measured error
// beside the time. CPU time; compare rows of one run only.
//   build/bench/single_layer_bench
#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include "biem_operator_single_layer.h"
#include "biem_periodic_ghosts.h"
#include <benchmark/benchmark.h>
#include <cmath>
#include <mpi.h>

using namespace biem;

namespace {

// n^3 red cells on a lattice, hematocrit 0.15, with a smooth force density.
struct Lattice {
  Mat3 cell;
  Points nodes, density;
  std::vector<Triangle> triangles;
  double longest_edge;

  Lattice(int n, int n_nodes)
  {
    const double spacing = std::cbrt(4.0 * M_PI / 3.0 / 0.15);
    cell = n * spacing * Mat3::Identity();
    const SurfaceMesh mesh = make_mesh(*make_red_cell(), n_nodes);
    longest_edge = compute_mesh_quality(mesh).longest_edge;
    const int size = static_cast<int>(mesh.nodes.cols());
    nodes.resize(3, n * n * n * size);
    density.resize(3, nodes.cols());
    for (int c = 0; c < n * n * n; c++) {
      const Vec3 center = spacing * Vec3(c % n + 0.5, c / n % n + 0.5, c / (n * n) + 0.5);
      const Mat3 rotation = Eigen::AngleAxisd(c, Vec3(1.0, c % 3, 0.5).normalized()).matrix();
      nodes.middleCols(c * size, size) = (rotation * mesh.nodes).colwise() + center;
      for (int i = 0; i < size; i++) {
        const Vec3 x = rotation * mesh.nodes.col(i);
        density.col(c * size + i) = Vec3(x[2], 0.3 * x[1], x[0]);
      }
      for (const Triangle &t : mesh.triangles)
        triangles.push_back({t[0] + c * size, t[1] + c * size, t[2] + c * size});
    }
  }
};

EwaldParameters choose(const Lattice &l, double tolerance, int n_cells, EwaldMethod method)
{
  EwaldScene scene;
  scene.cell = l.cell;
  scene.max_tilt = 0.5 * l.cell(0, 0);
  scene.n_sources = static_cast<double>(l.nodes.cols() + l.triangles.size());
  scene.n_targets = static_cast<double>(l.nodes.cols());
  scene.body_sources = scene.n_sources / n_cells;
  scene.body_radius = 1.0;
  scene.tolerance = tolerance;
  scene.method = method;
  return choose_ewald_parameters(scene);
}

// Everything that one evaluation needs, as a rank of LAMMPS would hold it.
struct Rank {
  EwaldParameters parameters;
  PeriodicGhosts ghosts;
  FlatElements elements;
  NearCandidates candidates;
  Eigen::VectorXd areas;
  Points density;
  SingleLayerOperator single_layer;

  Rank(const Lattice &l, double tolerance, int n_cells, EwaldMethod method) :
      parameters(choose(l, tolerance, n_cells, method)),
      ghosts(l.nodes, l.cell, parameters.cutoff + 2.0 * l.longest_edge),
      single_layer(MPI_COMM_SELF, parameters)
  {
    elements.set_geometry(ghosts.nodes(), l.triangles);
    candidates = find_near_candidates(elements, ghosts.nodes());
    Eigen::VectorXd all = Eigen::VectorXd::Zero(ghosts.nodes().cols());
    elements.add_nodal_areas(all);
    areas = all.head(l.nodes.cols());
    density = Points::Zero(3, ghosts.nodes().cols());
    density.leftCols(l.nodes.cols()) = l.density;
    ghosts.forward(density.data(), 3);
    single_layer.set_cell(l.cell, Vec3::Zero());
  }

  Points apply()
  {
    const SurfaceShare share{ghosts.nodes(), ghosts.n_owned(), elements, candidates, areas};
    return single_layer.apply(share, density, ghosts);
  }
};

// Arguments: cells along each axis, nodes per cell, -log10(tolerance), 0 = SPME or 1 = PSWF.
void evaluate_single_layer(benchmark::State &state)
{
  const int n = static_cast<int>(state.range(0)), n_cells = n * n * n;
  const Lattice lattice(n, static_cast<int>(state.range(1)));
  const EwaldMethod method = state.range(3) ? EwaldMethod::Pswf : EwaldMethod::Spme;
  Rank rank(lattice, std::pow(10.0, -static_cast<double>(state.range(2))), n_cells, method);
  Points velocity;
  long n_runs = 0;
  for (auto _ : state) {
    velocity = rank.apply();
    benchmark::DoNotOptimize(velocity.data());
    n_runs++;
  }
  const OperatorProfile profile = rank.single_layer.profile();
  state.counters["ms_per_cell"] = benchmark::Counter(
      n_cells * 1e-3, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["real_ms"] = 1e3 * profile.real_space / n_runs;
  state.counters["near_ms"] = 1e3 * profile.near / n_runs;
  state.counters["fourier_ms"] = 1e3 * profile.fourier / n_runs;
  state.counters["real_pairs"] = static_cast<double>(profile.n_real_pairs);
  state.counters["near_pairs"] = static_cast<double>(profile.n_near_pairs);
  const Points exact = Rank(lattice, 1e-8, n_cells, EwaldMethod::Spme).apply();
  state.counters["error"] = (velocity - exact).norm() / exact.norm();
}
BENCHMARK(evaluate_single_layer)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"cells_per_axis", "nodes", "digits", "pswf"})
    ->ArgsProduct({{1, 2}, {162, 642}, {2, 3, 4, 6}, {0, 1}})
    ->Args({3, 642, 3, 0})
    ->Args({3, 642, 3, 1});

}    // namespace

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  MPI_Finalize();
}
