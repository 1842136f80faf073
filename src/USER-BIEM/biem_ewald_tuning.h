// A short search on the machine at hand: measures the error on a scene's own points, times the
// best choices of the cost model and takes the fastest. Knows no surfaces. doc/theory, label
// ewald-errors.
#ifndef BIEM_EWALD_TUNING_H
#define BIEM_EWALD_TUNING_H

#include "biem_ewald_parameters.h"
#include <mpi.h>

namespace biem {

// Where the parameters come from: the cost model alone, the same on every machine, or a search
// whose result depends on timings.
enum class EwaldTuning { Model, Search };
EwaldTuning parse_ewald_tuning(const std::string &name);

struct EwaldTimings {
  EwaldParameters fastest;
  double seconds = 0.0;          // of the fastest, slowest rank
  double model_seconds = 0.0;    // of the cost model's choice
  double error_factor = 1.0;     // measured over predicted error, random strengths
  int n_tried = 0;
};

// points: 3 x n of this rank, targets and (repeated up to the scene's ratio) sources. First the
// error of the model's choice is measured with random strengths, and the choices are relaxed or
// tightened accordingly. Takes about twenty evaluations. Collective; the same answer on every rank.
EwaldTimings search_ewald_parameters(MPI_Comm comm, const EwaldScene &scene, PointsView points);

}    // namespace biem

#endif
