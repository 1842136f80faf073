// Timing of candidates: see the header.
#include "biem_ewald_tuning.h"
#include "biem_cpu_clock.h"
#include "biem_error.h"
#include "biem_ewald_sum.h"
#include "biem_periodic_ghosts.h"
#include <algorithm>
#include <cmath>

namespace biem {

namespace {

constexpr int kCandidates = 6;
constexpr int kRepeats = 2;    // the first one fetches the memory

// The points, then copies a little aside, until there are as many sources as the scene has.
Points make_sources(const EwaldScene &scene, PointsView points)
{
  const double ratio = scene.n_sources / std::max(1.0, scene.n_targets);
  const int n_copies = std::clamp(static_cast<int>(std::lround(ratio)), 1, 8);
  const double shift = 0.1 * std::cbrt(scene.cell.determinant() / std::max(1.0, scene.n_sources));
  Points sources(3, n_copies * points.cols());
  for (int c = 0; c < n_copies; c++)
    sources.middleCols(c * points.cols(), points.cols()) =
        points.colwise() + c * shift * Vec3(0.8, -0.5, 0.3);
  return sources;
}

double time_sum(MPI_Comm comm, const EwaldScene &scene, const EwaldParameters &p, PointsView points)
{
  const Points none(3, 0), sources = make_sources(scene, points);
  const Points ones = Points::Ones(3, sources.cols());
  PeriodicGhosts ghosts(comm, points, scene.cell, 1.1 * p.cutoff);
  PeriodicSum sum(comm, p);
  sum.set_cell(scene.cell, Vec3::Zero());
  double seconds = 0.0;
  for (int i = 0; i < kRepeats; i++) {
    CpuClock clock;
    Points velocities = Points::Zero(3, ghosts.nodes().cols());
    sum.set_points(
        {ghosts.nodes(), ghosts.n_owned(), sources, has_double(scene.layers) ? ones : none, none});
    sum.add_layers(scene.layers, ones, ones, ghosts, velocities);
    seconds = clock.restart();
  }
  MPI_Allreduce(MPI_IN_PLACE, &seconds, 1, MPI_DOUBLE, MPI_MAX, comm);
  return seconds;
}

}    // namespace

EwaldTuning parse_ewald_tuning(const std::string &name)
{
  if (name == "model") return EwaldTuning::Model;
  if (name == "search") return EwaldTuning::Search;
  throw Error("unknown tuning '" + name + "': choose model or search");
}

EwaldTimings search_ewald_parameters(MPI_Comm comm, const EwaldScene &scene, PointsView points)
{
  EwaldTimings result;
  for (const EwaldParameters &p : rank_ewald_parameters(scene, kCandidates)) {
    const double seconds = time_sum(comm, scene, p, points);
    if (result.n_tried == 0) result.model_seconds = seconds;
    if (result.n_tried++ == 0 || seconds < result.seconds) {
      result.seconds = seconds;
      result.fastest = p;
    }
  }
  return result;
}

}    // namespace biem
