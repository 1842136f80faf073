// Cost of the near field per pair of target and triangle: the closed forms alone, and the near
// corrections of red cells with everything that belongs to them (near test, closed form, far rule,
// accumulation). CPU time; compare rows of one run only.
//   build/bench/near_triangle_bench
#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include "biem_near_correction.h"
#include <benchmark/benchmark.h>

using namespace biem;

namespace {

// One triangle against one pack of targets; ns_per_pair counts every lane.
template <Layers layers> void integrate_triangle(benchmark::State &state)
{
  const TriangleFrame frame =
      make_triangle_frame(Vec3(0, 0, 0), Vec3(1, 0.1, 0), Vec3(0.4, 1, 0.2));
  const LinearDensity density = make_linear_density(frame, Mat3::Identity());
  PointPack targets;
  for (int l = 0; l < kLanes; l++) {
    targets.x[l] = 0.3 - 0.2 * l;
    targets.y[l] = 0.2 + 0.1 * l;
    targets.z[l] = 0.05 * l;
  }
  for (auto _ : state) {
    const PointPack u = integrate_near_triangle<layers>(frame, &density, &density, targets);
    targets.x += 1e-9 * u.x;
    benchmark::DoNotOptimize(targets);
  }
  state.counters["ns_per_pair"] = benchmark::Counter(
      1e-9 * kLanes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(integrate_triangle<Layers::Single>);
BENCHMARK(integrate_triangle<Layers::Double>);
BENCHMARK(integrate_triangle<Layers::Both>);

// Near corrections of one red cell on its own nodes. Arguments: nodes; single layer; double layer;
// reach of the candidates over the reach of the near rule, in percent.
void correct_near(benchmark::State &state)
{
  const SurfaceMesh mesh = make_mesh(*make_red_cell(), static_cast<int>(state.range(0)));
  const auto n = static_cast<int>(mesh.nodes.cols());
  FlatElements elements;
  elements.set_geometry(mesh.nodes, mesh.triangles);
  std::vector<int> all(n), found(n);
  for (int i = 0; i < n; i++)
    all[i] = i;
  NearCandidates candidates;
  candidates.start.push_back(0);
  for (int e = 0; e < elements.n_elements(); e++) {
    const double reach = 1e-2 * state.range(3) * kNearFactor * elements.mean_edge(e);
    const int n_found = elements.find_within(e, reach, all.data(), n, mesh.nodes, found.data());
    candidates.node.insert(candidates.node.end(), found.begin(), found.begin() + n_found);
    candidates.start.push_back(static_cast<int>(candidates.node.size()));
  }
  const Points none(3, 0), single = state.range(1) ? mesh.nodes : none,
                           dual = state.range(2) ? mesh.nodes : none;
  Points velocity = Points::Zero(3, n);
  long n_pairs = 0;
  for (auto _ : state) {
    elements.prepare_near(single, dual);
    n_pairs = add_near_corrections(elements, candidates, mesh.nodes, velocity);
    benchmark::DoNotOptimize(velocity.data());
  }
  state.counters["ns_per_pair"] = benchmark::Counter(
      1e-9 * n_pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["pairs_per_triangle"] = static_cast<double>(n_pairs) / elements.n_elements();
  state.counters["candidates_per_pair"] = static_cast<double>(candidates.node.size()) / n_pairs;
}
BENCHMARK(correct_near)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"nodes", "single", "double", "reach"})
    ->ArgsProduct({{642}, {1}, {0}, {100, 150, 200}})
    ->Args({642, 0, 1, 150})
    ->Args({642, 1, 1, 150});

}    // namespace

BENCHMARK_MAIN();
