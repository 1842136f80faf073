// History of the coupled system's solutions: see the header.
#include "biem_lammps_history.h"
#include "atom.h"
#include <algorithm>

namespace LAMMPS_NS {

namespace {

// The frames in which the solution at a node changes slowly: of its rigid particle, or of space.
class Frames {
 public:
  explicit Frames(const LammpsSolver &solver) :
      solver_(solver),
      rotations_(solver.particles.orientations(static_cast<int>(solver.scene().surfaces.size())))
  {
  }
  const biem::Mat3 &operator[](int node) const
  {
    const int s = solver_.find_surface(node);
    return s < 0 ? space_ : rotations_[s];
  }

 private:
  const LammpsSolver &solver_;
  std::vector<biem::Mat3> rotations_;    // by surface
  biem::Mat3 space_ = biem::Mat3::Identity();
};

}    // namespace

biem::CoupledFields SolutionHistory::make_guess(double time, const LammpsSolver &solver,
                                                double **array) const
{
  biem::CoupledFields guess;
  if (!solver.has_unknowns() || n_solutions_ == 0) return guess;
  const double ratio = n_solutions_ > 1 ? (time - time_) / (time_ - previous_time_) : 0.0;
  guess.mean = mean_ + ratio * (mean_ - previous_mean_);
  guess.nodes.resize(3, atom->nlocal);
  const Frames frames(solver);
  for (int i = 0; i < atom->nlocal; i++) {
    const Eigen::Map<biem::Vec3> now(array[i] + now_), before(array[i] + before_);
    guess.nodes.col(i) = frames[i] * (now + ratio * (now - before));
  }
  return guess;
}

void SolutionHistory::keep(double time, const LammpsSolver &solver,
                           const biem::CoupledFields &solution, double **array)
{
  if (!solver.has_unknowns()) return;
  const Frames frames(solver);
  const bool is_new = n_solutions_ == 0 || time != time_;
  for (int i = 0; i < atom->nlocal; i++) {
    if (is_new) std::copy_n(array[i] + now_, 3, array[i] + before_);
    Eigen::Map<biem::Vec3>(array[i] + now_) = frames[i].transpose() * solution.nodes.col(i);
  }
  if (is_new) {
    previous_mean_ = mean_;
    previous_time_ = time_;
    n_solutions_ = std::min(2, n_solutions_ + 1);
  }
  mean_ = solution.mean;
  time_ = time;
}

std::vector<double> SolutionHistory::get_state() const
{
  return {static_cast<double>(n_solutions_),
          time_,
          previous_time_,
          mean_[0],
          mean_[1],
          mean_[2],
          previous_mean_[0],
          previous_mean_[1],
          previous_mean_[2]};
}

void SolutionHistory::set_state(const double *state)
{
  n_solutions_ = static_cast<int>(state[0]);
  time_ = state[1];
  previous_time_ = state[2];
  mean_ = biem::Vec3(state + 3);
  previous_mean_ = biem::Vec3(state + 6);
}

}    // namespace LAMMPS_NS
