// Time and error of one velocity evaluation of a suspension of red cells, and its parts: one CSV
// row for each combination of the listed forces, splits and tolerances.
//   mpirun -np 2 build/bench/suspension --tolerance 1e-3,1e-4
// CPU time summed over the ranks, in milliseconds per cell, of the fastest repetition. The error is
// relative to the same evaluation at a tolerance of 1e-8. The neighbor list is not counted.
#include "bench_options.h"
#include "bench_suspension_share.h"
#include "biem_cpu_clock.h"
#include <cmath>
#include <cstdio>
#include <getopt.h>
#include <iostream>

using namespace biem;
using namespace biem_bench;

namespace {

constexpr double kHematocrit = 0.15;
constexpr double kReferenceTolerance = 1e-8;

struct Options {
  std::vector<std::string> splits{"pswf", "spme"}, tolerances{"1e-2", "1e-3", "1e-4", "1e-6"},
      forces{"membrane", "smooth"};
  int cells_per_axis = 3, n_nodes = 642, n_repetitions = 5;
  bool has_header = true;
};

const char kUsage[] =
    "usage: suspension [options]; lists are separated by commas\n"
    "  --split LIST       of pswf, spme\n"
    "  --tolerance LIST   accuracy of the periodic sum\n"
    "  --forces LIST      of membrane (stretched cells), smooth (linear density)\n"
    "  --cells N          N^3 cells (3)\n"
    "  --nodes N          nodes of one cell (642)\n"
    "  --repeat N         evaluations, the fastest counts (5)\n"
    "  --no-header        without the first line\n";

// Parts of one evaluation; communication includes waiting for other ranks.
constexpr const char *kParts[] = {"membrane",    "near",          "search",    "real_space",
                                  "windows",     "spread",        "transform", "kernel_scaling",
                                  "interpolate", "communication", "rest"};
constexpr int kNParts = 11, kMembrane = 0, kCommunication = 9, kRest = 10;
using Parts = std::array<double, kNParts>;

Parts to_parts(const OperatorProfile &p)
{
  const FourierProfile &f = p.sum.fourier;
  return {0.0,         p.near,   p.sum.search,  p.sum.real_space,          f.windows, f.spread,
          f.transform, f.kernel, f.interpolate, f.exchange + p.sum.ghosts, 0.0};
}

struct Measurement {
  double slowest = 1e300;    // rank, of the fastest repetition
  double seconds = 0.0;      // summed over the ranks
  Parts parts{};             // summed over the ranks
  EwaldParameters parameters;
  Points velocities;    // 3 x n of all cells, on every rank
  double near_pairs = 0.0;
};

void print_header()
{
  std::printf("forces,split,tolerance,n_cells,n_nodes,ranks,measured_error,cpu_ms_per_cell,"
              "cpu_seconds");
  for (const char *part : kParts)
    std::printf(",%s", part);
  std::printf(",cutoff,grid,order,near_pairs_per_cell\n");
}

EwaldScene make_scene(const RedCells &cells, EwaldMethod method, double tolerance)
{
  EwaldScene scene;
  scene.cell = cells.box;
  scene.max_tilt = 0.5 * cells.box(0, 0);    // the box of a suspension in shear
  scene.n_targets = static_cast<double>(cells.n_nodes());
  scene.n_sources = static_cast<double>(cells.n_nodes() + cells.triangles.size());
  scene.body_sources = scene.n_sources / cells.n_cells;
  scene.body_radius = 1.0;
  scene.tolerance = tolerance;
  scene.method = method;
  return scene;
}

// Nodal forces on the fluid of a smooth density: lumped with the nodal areas.
Points compute_smooth_forces(const RedCells &cells, SuspensionShare &share)
{
  const Configuration c = share.configuration();
  Points forces = Points::Zero(3, c.nodes.cols());
  std::vector<double> areas(c.nodes.cols(), 0.0);
  for (const Triangle &t : c.triangles)
    for (int v : t)
      areas[v] += compute_area({c.nodes.col(t[0]), c.nodes.col(t[1]), c.nodes.col(t[2])}) / 3.0;
  share.ghosts().reverse_add(areas.data(), 1);
  for (int i = 0; i < c.n_owned; i++)
    forces.col(i) = areas[i] * cells.smooth_density.col(share.owned()[i]);
  return forces;
}

// Forces that are given instead of the membrane's; the membrane is computed in any case.
enum class Forces { Membrane, Smooth };

// One evaluation: its parts on this rank, which add up to its CPU time. velocity: 3 x n_owned.
Parts evaluate(Suspension &suspension, SuspensionShare &share, const Points &smooth_forces,
               Forces kind, HeldCells &held, Points &velocity)
{
  const Parts before = to_parts(suspension.force_profile());
  CpuClock total, clock;
  Points forces = share.compute_membrane_forces();
  const double membrane = clock.restart();
  share.ghosts().reverse_add(forces.data(), 3);
  const double exchange = clock.restart();
  if (kind == Forces::Smooth) forces = smooth_forces;
  const Configuration c = share.configuration();
  velocity = suspension
                 .evaluate(c, forces.leftCols(c.n_owned), Conditions(), CoupledFields(), held,
                           share.ghosts())
                 .velocity;
  const double seconds = total.restart();
  Parts parts = to_parts(suspension.force_profile());
  for (int p = 0; p < kNParts; p++)
    parts[p] -= before[p];
  parts[kMembrane] += membrane;
  parts[kCommunication] += exchange;
  double known = 0.0;
  for (double part : parts)
    known += part;
  parts[kRest] = seconds - known;
  return parts;
}

void keep_fastest(MPI_Comm comm, Parts parts, Measurement &best)
{
  double seconds = 0.0;
  for (double part : parts)
    seconds += part;
  double slowest = seconds;
  MPI_Allreduce(MPI_IN_PLACE, &slowest, 1, MPI_DOUBLE, MPI_MAX, comm);
  MPI_Allreduce(MPI_IN_PLACE, &seconds, 1, MPI_DOUBLE, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, parts.data(), kNParts, MPI_DOUBLE, MPI_SUM, comm);
  if (slowest >= best.slowest) return;
  best.slowest = slowest;
  best.seconds = seconds;
  best.parts = parts;
}

Measurement measure(MPI_Comm comm, const RedCells &cells, const EwaldScene &scene, Forces kind,
                    int n_repetitions)
{
  Measurement result;
  result.parameters = choose_ewald_parameters(scene);
  const double reach =
      std::max(result.parameters.cutoff + cells.longest_edge, 4.0 * cells.longest_edge);
  SuspensionShare share(comm, cells, reach);
  Scene surfaces;
  surfaces.surfaces.assign(cells.n_cells, Surface{SurfaceKind::Cell});
  Suspension suspension(comm, {result.parameters, result.parameters}, SuspensionSettings(),
                        surfaces);
  suspension.set_cell(cells.box, Vec3::Zero());
  HeldCells held;
  held.reference_volume.assign(cells.n_cells, 4.0 * M_PI / 3.0);
  const Points smooth_forces = compute_smooth_forces(cells, share);
  Points velocity;
  for (int r = 0; r < n_repetitions; r++) {
    MPI_Barrier(comm);
    keep_fastest(comm, evaluate(suspension, share, smooth_forces, kind, held, velocity), result);
  }
  result.velocities = Points::Zero(3, cells.n_nodes());
  for (size_t i = 0; i < share.owned().size(); i++)
    result.velocities.col(share.owned()[i]) = velocity.col(i);
  MPI_Allreduce(MPI_IN_PLACE, result.velocities.data(), static_cast<int>(result.velocities.size()),
                MPI_DOUBLE, MPI_SUM, comm);
  result.near_pairs = static_cast<double>(suspension.force_profile().n_near_pairs);
  MPI_Allreduce(MPI_IN_PLACE, &result.near_pairs, 1, MPI_DOUBLE, MPI_SUM, comm);
  return result;
}

void print_row(MPI_Comm comm, const RedCells &cells, const Options &options,
               const std::string &labels, const Measurement &m, double error)
{
  if (get_rank(comm) != 0) return;
  const double scale = 1e3 / cells.n_cells;
  std::printf("%s,%d,%d,%d,%.3e,%.4g,%.4g", labels.c_str(), cells.n_cells, options.n_nodes,
              get_n_ranks(comm), error, scale * m.seconds, m.slowest);
  for (double part : m.parts)
    std::printf(",%.4g", scale * part);
  const EwaldParameters &p = m.parameters;
  std::printf(",%.5g,%dx%dx%d,%d,%.4g\n", p.cutoff, p.grid[0], p.grid[1], p.grid[2], p.order,
              m.near_pairs / cells.n_cells);
  std::fflush(stdout);
}

void sweep(MPI_Comm comm, const Options &options)
{
  const RedCells cells = make_red_cells(options.cells_per_axis, options.n_nodes, kHematocrit);
  for (const std::string &name : options.forces) {
    if (name != "membrane" && name != "smooth")
      throw Error("unknown forces '" + name + "': choose membrane or smooth");
    const Forces kind = name == "smooth" ? Forces::Smooth : Forces::Membrane;
    const Measurement exact =
        measure(comm, cells, make_scene(cells, EwaldMethod::Spme, kReferenceTolerance), kind, 1);
    for (const std::string &split : options.splits)
      for (const std::string &tolerance : options.tolerances) {
        const EwaldScene scene =
            make_scene(cells, parse_ewald_method(split), parse_number(tolerance));
        const Measurement m = measure(comm, cells, scene, kind, options.n_repetitions);
        const double error = (m.velocities - exact.velocities).norm() / exact.velocities.norm();
        print_row(comm, cells, options, name + "," + split + "," + tolerance, m, error);
      }
  }
}

enum class Action { Run, ShowUsage };

Action parse_options(int argc, char **argv, Options &options)
{
  const option table[] = {{"split", required_argument, nullptr, 's'},
                          {"tolerance", required_argument, nullptr, 't'},
                          {"forces", required_argument, nullptr, 'f'},
                          {"cells", required_argument, nullptr, 'c'},
                          {"nodes", required_argument, nullptr, 'n'},
                          {"repeat", required_argument, nullptr, 'r'},
                          {"no-header", no_argument, nullptr, 'H'},
                          {"help", no_argument, nullptr, 'h'},
                          {nullptr, 0, nullptr, 0}};
  for (int c; (c = getopt_long(argc, argv, "h", table, nullptr)) != -1;)
    switch (c) {
      case 's':
        options.splits = split_list(optarg);
        break;
      case 't':
        options.tolerances = split_list(optarg);
        break;
      case 'f':
        options.forces = split_list(optarg);
        break;
      case 'c':
        options.cells_per_axis = static_cast<int>(parse_number(optarg));
        break;
      case 'n':
        options.n_nodes = static_cast<int>(parse_number(optarg));
        break;
      case 'r':
        options.n_repetitions = static_cast<int>(parse_number(optarg));
        break;
      case 'H':
        options.has_header = false;
        break;
      case 'h':
        return Action::ShowUsage;
      default:
        throw Error("unknown option; suspension --help lists them");
    }
  if (optind < argc) throw Error(std::string("unexpected argument '") + argv[optind] + "'");
  if (options.n_repetitions < 1 || options.cells_per_axis < 1)
    throw Error("--repeat and --cells must be at least 1");
  return Action::Run;
}

void run(int argc, char **argv)
{
  const MPI_Comm comm = MPI_COMM_WORLD;
  Options options;
  const Action action = parse_options(argc, argv, options);
  if (get_rank(comm) == 0) {
    if (action == Action::ShowUsage) std::cout << kUsage;
    if (action == Action::Run && options.has_header) print_header();
  }
  if (action == Action::Run) sweep(comm, options);
}

}    // namespace

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  try {
    run(argc, argv);
  } catch (const std::exception &error) {
    std::cerr << "suspension: " << error.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
}
