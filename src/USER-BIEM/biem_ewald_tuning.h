// A short search on the machine at hand: times the best choices of the cost model on a scene's own
// points and takes the fastest. Knows no surfaces. doc/theory, label ewald-errors.
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
  int n_tried = 0;
};

// points: 3 x n of this rank, targets and (repeated up to the scene's ratio) sources; the scene's
// cell. Takes about ten evaluations of the sum. Collective; the same answer on every rank.
EwaldTimings search_ewald_parameters(MPI_Comm comm, const EwaldScene &scene, PointsView points);

}    // namespace biem

#endif
