// Evaluations of the flow on LAMMPS' atoms: see the header.
#include "biem_lammps_evaluator.h"
#include "atom.h"
#include "error.h"
#include "force.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

using namespace NodeColumn;

namespace {

// Displacement that the extrapolated part may be wrong by in a step, of the longest edge.
constexpr double kSlowTolerance = 1e-3;

}    // namespace

void FlowEvaluator::start_run(const NodeGroups &groups)
{
  groups_ = groups;
  has_contacts_ = force->pair_match("biem/contact", 1) != nullptr;
  n_evaluations_ = n_inner_ = 0.0;
  forces.start_run(solver_.list_cutoff(), flow_.shear_rate());
}

void FlowEvaluator::lists_are_new()
{
  forces.lists_are_new();
  refresh();
}

void FlowEvaluator::update_lists()
{
  if (forces.update()) refresh();
}

void FlowEvaluator::refresh()
{
  const std::string finding = solver_.refresh(list_);
  if (!finding.empty()) throw StepFailure{finding};
}

void FlowEvaluator::compute_forces()
{
  forces.compute();
}

biem::SurfaceKind FlowEvaluator::kind(int i) const
{
  return groups_.kind(atom->mask[i]);
}

bool FlowEvaluator::is_tracer(int i) const
{
  return groups_.is_tracer(atom->mask[i]);
}

// tag: MAXTAGINT where this rank has none.
void FlowEvaluator::fail_at(tagint tag, const std::string &what) const
{
  tagint first;
  MPI_Allreduce(&tag, &first, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  if (first == MAXTAGINT) return;
  int molecule = 0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->tag[i] == first) molecule = static_cast<int>(atom->molecule[i]);
  MPI_Allreduce(&molecule, &all, 1, MPI_INT, MPI_MAX, world);
  throw StepFailure{fmt::format("{} of atom {} (molecule {}) is not a number: the membrane has "
                                "become unstable or folded, or a force is far too large; use a "
                                "smaller timestep",
                                what, first, all)};
}

void FlowEvaluator::check_velocities(biem::PointsView velocity) const
{
  tagint bad = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++)
    if (!std::isfinite(velocity.col(i).sum())) bad = std::min(bad, atom->tag[i]);
  fail_at(bad, "the velocity");
}

void FlowEvaluator::check_forces() const
{
  tagint bad = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *f = atom->f[i], *x = atom->x[i];
    if (!std::isfinite(f[0] + f[1] + f[2] + x[0] + x[1] + x[2])) bad = std::min(bad, atom->tag[i]);
  }
  fail_at(bad, "force or position");
  for (int i = 0; i < atom->nlocal; i++) {
    const double *f = atom->f[i];
    if (f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0) continue;
    const biem::SurfaceKind k = kind(i);
    if (k == biem::SurfaceKind::Wall && has_contacts_) {    // what holds the wall takes it up
      std::fill_n(atom->f[i], 3, 0.0);
      continue;
    }
    if (k == biem::SurfaceKind::None || k == biem::SurfaceKind::Wall)
      error->one(FLERR,
                 "Fix biem: a force acts on atom " + std::to_string(atom->tag[i]) +
                     ", but tracers and probes only follow the flow, and walls do not move; take "
                     "it out of the group of the fix or pair style that causes the force, and give "
                     "the triangles of walls an angle type without forces");
  }
}

biem::Evaluation FlowEvaluator::evaluate(double time)
{
  biem::Evaluation e = evaluate_aside(time);
  history_.keep(time, solver_, e.solution, array_);
  return e;
}

biem::Evaluation FlowEvaluator::evaluate_aside(double time)
{
  check_forces();
  n_evaluations_ += 1.0;
  try {
    biem::Evaluation e = solver_.evaluate(history_.make_guess(time, solver_, array_));
    check_velocities(e.velocity);
    return e;
  } catch (const biem::NotConverged &stalled) {
    throw StepFailure{stalled.what()};
  }
}

void FlowEvaluator::store(const biem::Evaluation &e)
{
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array_[i];
    std::copy_n(e.velocity.col(i).data(), 3, a + kVelocity);
    std::copy_n(e.traction.col(i).data(), 3, a + kTraction);
    a[kArea] = e.areas[i];
  }
}

void FlowEvaluator::reload(biem::Evaluation &e) const
{
  e.velocity.resize(3, atom->nlocal);
  e.traction.resize(3, atom->nlocal);
  e.areas.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *a = array_[i];
    std::copy_n(a + kVelocity, 3, e.velocity.col(i).data());
    std::copy_n(a + kTraction, 3, e.traction.col(i).data());
    e.areas[i] = a[kArea];
  }
}

void FlowEvaluator::split(double time)
{
  const biem::Points fast = evaluate_inner_aside();
  const bool is_new = n_slow_ == 0 || time != slow_time_;
  if (is_new && n_slow_ > 1) measure_slow_error(time, fast);
  for (int i = 0; i < atom->nlocal; i++) {
    if (is_new) std::copy_n(array_[i] + kSlow, 3, array_[i] + kPreviousSlow);
    Eigen::Map<biem::Vec3>(array_[i] + kSlow) = velocity(i) - fast.col(i);
  }
  for (const auto &entry : solver_.particles.bodies()) {
    const biem::RigidBody &body = entry.second;
    SlowMotion &motion = slow_motions_[entry.first];
    if (is_new) {
      motion.previous_velocity = motion.velocity;
      motion.previous_rotation = motion.rotation;
    }
    motion.velocity = body.velocity - flow_.velocity(body.position);
    motion.rotation = body.rotation;
  }
  if (!is_new) return;
  previous_slow_time_ = slow_time_;
  slow_time_ = time;
  n_slow_ = std::min(2, n_slow_ + 1);
}

bool FlowEvaluator::can_extrapolate() const
{
  return slow_error_ >= 0.0 && slow_error_ <= kSlowTolerance * solver_.longest_edge();
}

double FlowEvaluator::compute_slow_ratio(double time) const
{
  return n_slow_ > 1 ? (time - slow_time_) / (slow_time_ - previous_slow_time_) : 0.0;
}

// Against the velocities of now: all of them minus the fast part. The error grows quadratically to
// this value at the end of the step: a third of it counts.
void FlowEvaluator::measure_slow_error(double time, biem::PointsView fast)
{
  const double ratio = compute_slow_ratio(time);
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind(i) != biem::SurfaceKind::Cell && !is_tracer(i)) continue;
    const Eigen::Map<const biem::Vec3> now(array_[i] + kSlow), before(array_[i] + kPreviousSlow);
    const biem::Vec3 actual = velocity(i) - fast.col(i);
    largest = std::max(largest, (actual - now - ratio * (now - before)).norm());
  }
  for (const auto &entry : solver_.particles.bodies()) {
    const biem::RigidBody &body = entry.second;
    const SlowMotion &m = slow_motions_[entry.first];
    const biem::Vec3 shift = body.velocity - flow_.velocity(body.position) - m.velocity -
                             ratio * (m.velocity - m.previous_velocity);
    const biem::Vec3 turn = body.rotation - m.rotation - ratio * (m.rotation - m.previous_rotation);
    largest = std::max(largest, shift.norm() + turn.norm() * solver_.particles.radius(entry.first));
  }
  largest *= (time - slow_time_) / 3.0;
  MPI_Allreduce(&largest, &slow_error_, 1, MPI_DOUBLE, MPI_MAX, world);
}

biem::Points FlowEvaluator::evaluate_inner_aside()
{
  check_forces();
  n_inner_ += 1.0;
  biem::Points velocity = solver_.evaluate_fast();
  check_velocities(velocity);
  return velocity;
}

void FlowEvaluator::evaluate_inner(double time)
{
  check_forces();
  n_inner_ += 1.0;
  const double ratio = n_slow_ > 1 ? (time - slow_time_) / (slow_time_ - previous_slow_time_) : 0.0;
  biem::Points slow(3, atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const Eigen::Map<const biem::Vec3> now(array_[i] + kSlow), before(array_[i] + kPreviousSlow);
    slow.col(i) = now + ratio * (now - before);
  }
  const biem::Points velocity = solver_.evaluate_fast(slow);
  check_velocities(velocity);
  for (int i = 0; i < atom->nlocal; i++)
    std::copy_n(velocity.col(i).data(), 3, array_[i] + kVelocity);
  for (auto &entry : solver_.particles.bodies()) {
    biem::RigidBody &body = entry.second;
    const SlowMotion &m = slow_motions_[entry.first];
    body.velocity =
        flow_.velocity(body.position) + m.velocity + ratio * (m.velocity - m.previous_velocity);
    body.rotation = m.rotation + ratio * (m.rotation - m.previous_rotation);
  }
}

std::vector<double> FlowEvaluator::get_state() const
{
  std::vector<double> state = history_.get_state();
  state.insert(state.end(), {static_cast<double>(n_slow_), slow_time_, previous_slow_time_,
                             slow_error_, static_cast<double>(slow_motions_.size())});
  for (const auto &entry : slow_motions_) {
    state.push_back(entry.first);
    const SlowMotion &m = entry.second;
    for (const biem::Vec3 *v :
         {&m.velocity, &m.rotation, &m.previous_velocity, &m.previous_rotation})
      state.insert(state.end(), v->data(), v->data() + 3);
  }
  return state;
}

const double *FlowEvaluator::set_state(const double *state)
{
  history_.set_state(state);
  state += SolutionHistory::kStateSize;
  n_slow_ = static_cast<int>(state[0]);
  slow_time_ = state[1];
  previous_slow_time_ = state[2];
  slow_error_ = state[3];
  const int n = static_cast<int>(state[4]);
  state += 5;
  for (int k = 0; k < n; k++, state += 13)
    slow_motions_[static_cast<int>(*state)] = {biem::Vec3(state + 1), biem::Vec3(state + 4),
                                               biem::Vec3(state + 7), biem::Vec3(state + 10)};
  return state;
}

}    // namespace LAMMPS_NS
