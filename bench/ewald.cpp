// Time and error of the periodic Stokes sums: one CSV row for each combination of the listed
// kernels, splits, numbers of points, cells, tolerances and kinds of points.
//   mpirun -np 2 build/bench/ewald --n 1000,10000 --tolerance 1e-3,1e-6 --kernel SL,SL+DL
// One evaluation = geometry and sum (set_points and add_layers); the best of the repetitions; CPU
// time of the slowest rank. The exchange of ghost positions is not counted: under LAMMPS it belongs
// to its neighbor lists.
#include "bench_options.h"
#include "bench_reference.h"
#include "biem_cpu_clock.h"
#include "biem_ewald_sum.h"
#include "biem_periodic_ghosts.h"
#include <cstdio>
#include <getopt.h>
#include <iostream>
#include <memory>

using namespace biem;
using namespace biem_bench;

namespace {

struct Options {
  std::vector<std::string> kernels{"SL"}, splits{"pswf", "spme"}, numbers{"1000", "10000"},
      cells{"cubic"}, tolerances{"1e-3"}, kinds{"random"};
  int n_repetitions = 5;
  double seconds = 2.0;    // no further repetition after this CPU time
  int n_targets = 100;     // of the reference
  double cutoff = 0.0;     // 0: chosen
  bool has_header = true;
};

const char kUsage[] =
    "usage: ewald [options]; lists are separated by commas\n"
    "  --kernel LIST      of SL, DL, SL+DL\n"
    "  --split LIST       of pswf, spme\n"
    "  --n LIST           points (both sources and targets)\n"
    "  --cell LIST        of cubic, orthogonal, sheared, triclinic\n"
    "  --tolerance LIST   requested relative errors\n"
    "  --points LIST      of random, corner, cells-random, cells-smooth\n"
    "  --repeat N         evaluations, the fastest counts (5)\n"
    "  --seconds S        after two evaluations, stop repeating after S seconds of CPU time (2)\n"
    "  --targets N        points at which the error is measured; 0: not measured (100)\n"
    "  --cutoff L         real-space cutoff instead of the chosen one\n"
    "  --no-header        without the first line\n";

Layers parse_kernel(const std::string &name)
{
  if (name == "SL") return Layers::Single;
  if (name == "DL") return Layers::Double;
  if (name == "SL+DL") return Layers::Both;
  throw Error("unknown kernel '" + name + "': choose SL, DL or SL+DL");
}

constexpr const char *kPhases[] = {"search",         "real_space",  "ghosts",
                                   "windows",        "spread",      "transform",
                                   "kernel_scaling", "interpolate", "exchange"};
constexpr int kNPhases = 9;
using Phases = std::array<double, kNPhases>;

Phases to_phases(const PeriodicSumProfile &p)
{
  return {p.search,          p.real_space,          p.ghosts,
          p.fourier.windows, p.fourier.spread,      p.fourier.transform,
          p.fourier.kernel,  p.fourier.interpolate, p.fourier.exchange};
}

void print_header()
{
  std::printf("kernel,split,n,cell,tolerance,measured_error,cpu_seconds,us_per_point,ranks,"
              "points,expected_error");
  for (const char *phase : kPhases)
    std::printf(",%s", phase);
  std::printf(",cutoff,grid,order,pairs_per_target,setup_seconds\n");
}

// Points of one kind in one cell, dealt to the ranks.
struct Dealt {
  PointSet all;
  std::vector<int> owned;
  Points points, unwrapped, forces, densities, normals;    // of this rank
  std::unique_ptr<Reference> reference;

  Dealt(MPI_Comm comm, const std::string &kind, const std::string &cell, int n, int n_targets) :
      all(make_points(kind, cell, n))
  {
    const std::vector<int> ranks = assign_to_ranks(all.points, all.cell, get_n_ranks(comm));
    for (size_t i = 0; i < ranks.size(); i++)
      if (ranks[i] == get_rank(comm)) owned.push_back(static_cast<int>(i));
    points = all.points(Eigen::all, owned);
    unwrapped = all.unwrapped(Eigen::all, owned);
    forces = all.forces(Eigen::all, owned);
    densities = all.densities(Eigen::all, owned);
    normals = all.normals(Eigen::all, owned);
    reference = std::make_unique<Reference>(comm, all, owned, n_targets);
  }
};

struct Measurement {
  double seconds = 1e300;    // CPU time of the slowest rank in the fastest evaluation
  Phases phases{};           // of the same rank
  double pairs_per_target = 0.0, error = 0.0, setup_seconds = 0.0;
};

EwaldScene make_scene(const PointSet &set, Layers layers, EwaldMethod method, double tolerance,
                      double cutoff)
{
  EwaldScene scene;
  scene.cell = set.cell;
  scene.max_tilt = std::fabs(set.cell(0, 2));
  scene.n_sources = scene.n_targets = static_cast<double>(set.points.cols());
  scene.body_sources = set.body_sources;
  scene.body_radius = set.body_radius;
  scene.tolerance = tolerance;
  scene.method = method;
  scene.layers = layers;
  scene.cutoff = cutoff;
  return scene;
}

// The slowest rank of one evaluation: keeps its time and phases if the evaluation is the fastest.
// Returns the time.
double keep_fastest(MPI_Comm comm, double seconds, Phases phases, Measurement &best)
{
  struct {
    double seconds;
    int rank;
  } slowest{seconds, get_rank(comm)};
  MPI_Allreduce(MPI_IN_PLACE, &slowest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  MPI_Bcast(phases.data(), kNPhases, MPI_DOUBLE, slowest.rank, comm);
  if (slowest.seconds < best.seconds) {
    best.seconds = slowest.seconds;
    best.phases = phases;
  }
  return slowest.seconds;
}

Measurement measure(MPI_Comm comm, const Options &options, Dealt &dealt, Layers layers,
                    const EwaldParameters &parameters)
{
  Measurement result;
  CpuClock setup_clock;
  PeriodicGhosts ghosts(comm, dealt.points, dealt.all.cell, parameters.cutoff);
  setup_clock.restart();
  PeriodicSum sum(comm, parameters);
  sum.set_cell(dealt.all.cell, Vec3::Zero());
  result.setup_seconds = setup_clock.restart();
  const Points none(3, 0);
  Points velocities;
  double used = 0.0;
  for (int r = 0; r < options.n_repetitions && (r < 2 || used < options.seconds); r++) {
    const Phases before = to_phases(sum.profile());
    velocities = Points::Zero(3, ghosts.nodes().cols());
    MPI_Barrier(comm);
    CpuClock clock;
    sum.set_points({ghosts.nodes(), ghosts.n_owned(), dealt.points,
                    has_double(layers) ? dealt.normals : none, dealt.unwrapped},
                   layers);
    sum.add_layers(layers, dealt.forces, dealt.densities, ghosts, velocities);
    const double seconds = clock.restart();
    Phases phases = to_phases(sum.profile());
    for (int p = 0; p < kNPhases; p++)
      phases[p] -= before[p];
    used += keep_fastest(comm, seconds, phases, result);
  }
  double pairs = static_cast<double>(sum.profile().n_pairs);
  MPI_Allreduce(MPI_IN_PLACE, &pairs, 1, MPI_DOUBLE, MPI_SUM, comm);
  result.pairs_per_target = pairs / static_cast<double>(dealt.all.points.cols());
  result.error = dealt.reference->compute_error(layers, velocities.leftCols(ghosts.n_owned()));
  return result;
}

void sweep_points(MPI_Comm comm, const Options &options, const std::string &kind,
                  const std::string &cell, int n)
{
  Dealt dealt(comm, kind, cell, n, options.n_targets);
  n = static_cast<int>(dealt.all.points.cols());
  for (const std::string &kernel : options.kernels)
    for (const std::string &split : options.splits)
      for (const std::string &tolerance : options.tolerances) {
        const Layers layers = parse_kernel(kernel);
        CpuClock clock;
        const EwaldParameters p = choose_ewald_parameters(make_scene(
            dealt.all, layers, parse_ewald_method(split), parse_number(tolerance), options.cutoff));
        const double choice_seconds = clock.restart();
        const Measurement m = measure(comm, options, dealt, layers, p);
        if (get_rank(comm) != 0) continue;
        std::printf("%s,%s,%d,%s,%s,%.3e,%.6g,%.4g,%d,%s,%.3e", kernel.c_str(), split.c_str(), n,
                    cell.c_str(), tolerance.c_str(), m.error, m.seconds, 1e6 * m.seconds / n,
                    get_n_ranks(comm), kind.c_str(), p.expected_error);
        for (double phase : m.phases)
          std::printf(",%.4g", phase);
        std::printf(",%.5g,%dx%dx%d,%d,%.4g,%.3g\n", p.cutoff, p.grid[0], p.grid[1], p.grid[2],
                    p.order, m.pairs_per_target, m.setup_seconds + choice_seconds);
        std::fflush(stdout);
      }
}

enum class Action { Run, ShowUsage };

Action parse_options(int argc, char **argv, Options &options)
{
  const option table[] = {{"kernel", required_argument, nullptr, 'k'},
                          {"split", required_argument, nullptr, 's'},
                          {"n", required_argument, nullptr, 'n'},
                          {"cell", required_argument, nullptr, 'c'},
                          {"tolerance", required_argument, nullptr, 't'},
                          {"points", required_argument, nullptr, 'p'},
                          {"repeat", required_argument, nullptr, 'r'},
                          {"seconds", required_argument, nullptr, 'b'},
                          {"targets", required_argument, nullptr, 'e'},
                          {"cutoff", required_argument, nullptr, 'l'},
                          {"no-header", no_argument, nullptr, 'H'},
                          {"help", no_argument, nullptr, 'h'},
                          {nullptr, 0, nullptr, 0}};
  for (int c; (c = getopt_long(argc, argv, "h", table, nullptr)) != -1;)
    switch (c) {
      case 'k':
        options.kernels = split_list(optarg);
        break;
      case 's':
        options.splits = split_list(optarg);
        break;
      case 'n':
        options.numbers = split_list(optarg);
        break;
      case 'c':
        options.cells = split_list(optarg);
        break;
      case 't':
        options.tolerances = split_list(optarg);
        break;
      case 'p':
        options.kinds = split_list(optarg);
        break;
      case 'r':
        options.n_repetitions = static_cast<int>(parse_number(optarg));
        break;
      case 'b':
        options.seconds = parse_number(optarg);
        break;
      case 'e':
        options.n_targets = static_cast<int>(parse_number(optarg));
        break;
      case 'l':
        options.cutoff = parse_number(optarg);
        break;
      case 'H':
        options.has_header = false;
        break;
      case 'h':
        return Action::ShowUsage;
      default:
        throw Error("unknown option; ewald --help lists them");
    }
  if (optind < argc) throw Error(std::string("unexpected argument '") + argv[optind] + "'");
  if (options.n_repetitions < 1) throw Error("--repeat must be at least 1");
  return Action::Run;
}

void run(int argc, char **argv)
{
  const MPI_Comm comm = MPI_COMM_WORLD;
  Options options;
  if (parse_options(argc, argv, options) == Action::ShowUsage) {
    if (get_rank(comm) == 0) std::cout << kUsage;
    return;
  }
  if (options.has_header && get_rank(comm) == 0) print_header();
  for (const std::string &n : options.numbers)
    for (const std::string &cell : options.cells)
      for (const std::string &kind : options.kinds)
        sweep_points(comm, options, kind, cell, static_cast<int>(parse_number(n)));
}

}    // namespace

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  try {
    run(argc, argv);
  } catch (const std::exception &error) {
    std::cerr << "ewald: " << error.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
}
