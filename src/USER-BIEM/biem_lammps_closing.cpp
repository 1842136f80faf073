// How soon surfaces would touch if they went on as they move now. Knows nodes and triangles that
// are near each other; nothing of forces.
#include "atom.h"
#include "biem_lammps_solver.h"
#include "biem_mesh_nearest_point.h"
#include <algorithm>
#include <limits>

namespace LAMMPS_NS {

namespace {

// Gaps below this part of the edges of a triangle count as so large: what closes them is resolved
// by the stages of a step, or else by a contact pair style.
constexpr double kSmallestGap = 0.02;

}    // namespace

double LammpsSolver::find_closing_time(double **array, int column, const biem::BackgroundFlow &flow)
{
  const biem::Configuration c = configuration_->get(particles.orientations(survey_.n_molecules));
  biem::Points velocity(3, c.nodes.cols());
  for (int i = 0; i < c.n_owned; i++)
    velocity.col(i) = biem::Vec3(array[i] + column);
  exchange.forward(velocity.data(), 3);
  for (Eigen::Index i = 0; i < c.nodes.cols(); i++)
    velocity.col(i) += flow.velocity(c.nodes.col(i));
  double fastest = 0.0, all;    // closing speed / gap
  for (size_t e = 0; e < c.triangles.size(); e++) {
    const biem::Triangle &t = c.triangles[e];
    biem::Mat3 corners, speeds;
    for (int k = 0; k < 3; k++) {
      corners.col(k) = c.nodes.col(t[k]);
      speeds.col(k) = velocity.col(t[k]);
    }
    const double least = kSmallestGap * (corners.col(1) - corners.col(0)).norm();
    for (int n = c.candidates.start[e]; n < c.candidates.start[e + 1]; n++) {
      const int j = c.candidates.node[n];
      if (atom->molecule[j] == c.surface_of_triangle[e] + 1 ||
          groups_.find_surface(atom->mask[j]) < 0)
        continue;
      const biem::Vec3 weights = biem::compute_nearest_weights(c.nodes.col(j), corners.col(0),
                                                               corners.col(1), corners.col(2));
      const biem::Vec3 apart = c.nodes.col(j) - corners * weights;
      const double gap = apart.norm();
      if (gap == 0.0) continue;
      const biem::Vec3 relative = velocity.col(j) - speeds * weights;
      fastest = std::max(fastest, -relative.dot(apart) / gap / std::max(gap, least));
    }
  }
  MPI_Allreduce(&fastest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all > 0.0 ? 1.0 / all : std::numeric_limits<double>::infinity();
}

}    // namespace LAMMPS_NS
