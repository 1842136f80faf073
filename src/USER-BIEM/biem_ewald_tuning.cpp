// Timing of candidates: see the header.
#include "biem_ewald_tuning.h"
#include "biem_cpu_clock.h"
#include "biem_error.h"
#include "biem_ewald_sum.h"
#include "biem_periodic_ghosts.h"
#include <algorithm>
#include <cmath>
#include <random>

namespace biem {

namespace {

constexpr int kCandidates = 6;
constexpr int kRepeats = 2;             // the first one fetches the memory
constexpr double kReference = 0.03;     // tolerance of the reference for a measured error
constexpr double kErrorMargin = 1.3;    // strengths of other kinds, deforming surfaces
constexpr double kLeastFactor = 0.2;    // a single measurement does not relax more than this

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

// The sum of one scene: sources around this rank's points with random strengths.
class Trial {
 public:
  Trial(MPI_Comm comm, const EwaldScene &scene, PointsView points) :
      comm_(comm), scene_(scene), points_(points), sources_(make_sources(scene, points)),
      normals_(has_double(scene.layers) ? draw(2) : Points(3, 0)), forces_(draw(0)),
      densities_(draw(1))
  {
  }

  // Velocities of this rank's points; seconds: of the slowest rank, without planning.
  Points evaluate(const EwaldParameters &p, double &seconds) const
  {
    PeriodicGhosts ghosts(comm_, points_, scene_.cell, 1.1 * p.cutoff);
    PeriodicSum sum(comm_, p);
    sum.set_cell(scene_.cell, Vec3::Zero());
    Points velocities;
    for (int i = 0; i < kRepeats; i++) {
      CpuClock clock;
      velocities = Points::Zero(3, ghosts.nodes().cols());
      sum.set_points({ghosts.nodes(), ghosts.n_owned(), sources_, normals_, Points(3, 0)},
                     scene_.layers);
      sum.add_layers(scene_.layers, forces_, densities_, ghosts, velocities);
      seconds = clock.restart();
    }
    MPI_Allreduce(MPI_IN_PLACE, &seconds, 1, MPI_DOUBLE, MPI_MAX, comm_);
    return velocities.leftCols(ghosts.n_owned());
  }

  // Relative rms error of p against parameters for a tolerance that is kReference times smaller.
  double measure_error(const EwaldParameters &p) const
  {
    EwaldScene tight = scene_;
    tight.tolerance = std::max(kTightestTolerance, kReference * scene_.tolerance);
    double seconds;
    const Points exact = evaluate(choose_ewald_parameters(tight), seconds);
    double squares[2] = {(evaluate(p, seconds) - exact).squaredNorm(), exact.squaredNorm()};
    MPI_Allreduce(MPI_IN_PLACE, squares, 2, MPI_DOUBLE, MPI_SUM, comm_);
    return std::sqrt(squares[0] / squares[1]);
  }

 private:
  Points draw(int stream) const
  {
    int rank;
    MPI_Comm_rank(comm_, &rank);
    std::mt19937_64 generator(1 + stream + 3 * rank);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Points strengths(3, sources_.cols());
    for (Eigen::Index i = 0; i < strengths.size(); i++)
      strengths.data()[i] = uniform(generator);
    return strengths;
  }

  MPI_Comm comm_;
  const EwaldScene &scene_;
  PointsView points_;
  Points sources_, normals_, forces_, densities_;
};

}    // namespace

EwaldTuning parse_ewald_tuning(const std::string &name)
{
  if (name == "model") return EwaldTuning::Model;
  if (name == "search") return EwaldTuning::Search;
  throw Error("unknown tuning '" + name + "': choose model or search");
}

EwaldTimings search_ewald_parameters(MPI_Comm comm, const EwaldScene &scene, PointsView points)
{
  const Trial trial(comm, scene, points);
  EwaldTimings result;
  const EwaldParameters first = choose_ewald_parameters(scene);
  trial.evaluate(first, result.model_seconds);
  EwaldScene calibrated = scene;
  result.error_factor = trial.measure_error(first) / first.expected_error;
  calibrated.error_factor = std::clamp(kErrorMargin * result.error_factor, kLeastFactor, 2.0);
  for (const EwaldParameters &p : rank_ewald_parameters(calibrated, kCandidates)) {
    double seconds;
    trial.evaluate(p, seconds);
    if (result.n_tried++ == 0 || seconds < result.seconds) {
      result.seconds = seconds;
      result.fastest = p;
    }
  }
  return result;
}

}    // namespace biem
