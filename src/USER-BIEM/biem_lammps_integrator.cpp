// Time steps on LAMMPS' atoms: see the header.
#include "biem_lammps_integrator.h"
#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

using namespace NodeColumn;

namespace {

// Margin of the spectral radius: estimates come from below, and it grows where triangles shrink.
constexpr double kRadiusMargin = 1.15;
// Evaluations between two estimates of the radius, of which one takes three: many small steps of
// one evaluation change less than a few large ones.
constexpr double kBetweenEstimates = 40.0, kBetweenChecks = 200.0;
// So much larger than that of the step before, the error of a step asks for a new estimate.
constexpr double kErrorGrowth = 1.5;
// The first step of all begins with a part this long, and each part is twice the one before:
// tensions that a flow suddenly causes grow faster than the stages of a long step follow.
constexpr double kStartSpan = 1.0 / 31.0;
// Surfaces come closer by at most this part of their gap in a step.
constexpr double kClosingShare = 0.5;
// A step is split into at most so many parts; an adaptive step shrinks to this part of the largest.
constexpr int kMostParts = 64;
constexpr double kSmallestDt = 1e-4;

}    // namespace

LammpsIntegrator::LammpsIntegrator(LAMMPS *lmp, Fix *fix, const FixBiemSettings &settings,
                                   LammpsSolver &solver, ShearedBox &box, double **&array) :
    Pointers(lmp),
    flow(lmp, fix, settings.conditions.flow, solver, array), stiffness(lmp, flow, solver, array),
    settings_(settings), flow_(settings.conditions.flow), solver_(solver), box_(box), array_(array),
    watchdog_(lmp, settings.watch), controller_(settings.error_tolerance, 0.0)
{
}

void LammpsIntegrator::start_run(const NodeGroups &groups)
{
  if (settings_.is_multirate) stiffness.use_fast_part();
  stiffness.start_run();
  flow.start_run(groups);
  watchdog_.prepare(groups);
  record_ = StepRecord();
  has_start_ = false;
  last_part_ = 0.0;
  finished_.reset();
  reset_dt();
}

void LammpsIntegrator::reset_dt()
{
  if (settings_.error_tolerance <= 0.0) return;
  if (update->dt != adopted_dt_) largest_dt_ = update->dt;    // else that of the last step
  if (controller_.last_dt() > 0.0) solver_.set_timestep(controller_.last_dt());
  controller_.set_largest(largest_dt_);
  next_dt_ = next_dt_ > 0.0 ? std::min(next_dt_, largest_dt_) : largest_dt_;
}

void LammpsIntegrator::renew_lists()
{
  try {
    flow.lists_are_new();
  } catch (const StepFailure &failure) {
    stop(failure.why);
  }
}

biem::Evaluation LammpsIntegrator::evaluate()
{
  try {
    biem::Evaluation e = finished_ ? std::move(*finished_) : flow.evaluate(time_);
    if (finished_)
      flow.reload(e);
    else
      flow.store(e);
    if (last_part_ > 0.0) note_error(estimate_error(last_part_));
    if (settings_.is_multirate) flow.split(time_);
    last_part_ = 0.0;
    finished_.reset();
    return e;
  } catch (const StepFailure &failure) {
    stop(failure.why);
  }
}

bool LammpsIntegrator::step()
{
  wants_new_lists_ = false;
  save_start();
  has_start_ = true;
  try {
    if (settings_.stepper != biem::Stepper::RungeKuttaChebyshev2)
      step_once();
    else if (settings_.error_tolerance > 0.0)
      step_adaptive();
    else
      step_fixed();
  } catch (const StepFailure &failure) {
    stop(failure.why);
  }
  return wants_new_lists_;
}

// Euler and Adams-Bashforth: the velocities of the last step are all there is.
void LammpsIntegrator::step_once()
{
  const double dt = update->dt;
  if (stiffness.is_due(kBetweenChecks)) stiffness.renew(time_);
  const double limit = biem::stability_limit(settings_.stepper);
  if (dt * stiffness.radius() > limit)
    throw StepFailure{
        fmt::format("timestep {:.6g} is beyond the limit of stability of the stepper, "
                    "{:.4g} with a spectral radius of {:.4g}; use a smaller one, or "
                    "stepper rkc2",
                    dt, limit / stiffness.radius(), stiffness.radius())};
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_mobile(i)) continue;
    double *a = array_[i];
    Eigen::Map<biem::Vec3> position(atom->x[i]), velocity(a + kVelocity), previous(a + kPrevious);
    const biem::Vec3 relative =
        biem::compute_displacement(settings_.stepper, velocity, previous, dt, a[kPreviousDt]);
    position += flow_.displacement(position, relative, dt);
    previous = velocity;
    a[kPreviousDt] = dt;
    largest = std::max(largest, relative.norm());
  }
  check_displacement(largest);
  solver_.particles.advance(settings_.stepper, flow_, dt);
  box_.begin_step(dt);
  wants_new_lists_ = box_.advance(1.0);
  if (!solver_.particles.is_empty()) solver_.particles.lay_atoms();
  check_positions();
  finish_step(dt);
}

void LammpsIntegrator::step_fixed()
{
  const double dt = update->dt;
  if (is_radius_due()) stiffness.renew(time_);
  box_.begin_step(dt);
  record_.n_stages = 0.0;
  const bool is_start = last_error_ == 0.0;
  double start_span = kStartSpan;
  for (double fraction = 0.0;;) {
    const double rest = 1.0 - fraction;
    const double parts = std::ceil(rest * dt / find_closing_limit());
    if (!(parts <= kMostParts))
      throw StepFailure{fmt::format("surfaces would jump through each other within a step: the "
                                    "timestep {:.6g} is far larger than the time in which the gap "
                                    "between two of them closes; use a smaller timestep",
                                    dt)};
    double span = rest / std::max(1.0, parts);
    if (is_start) span = std::min(span, start_span);
    start_span *= 2.0;
    const bool is_last = span > (1.0 - 1e-9) * rest;
    take_stages(fraction, is_last ? rest : span);
    correct_held_cells();
    if (is_last) break;
    fraction += span;
    evaluate_stage(time_ + fraction * dt, Part::All);
    record_.n_split += is_start ? 0.0 : 1.0;
  }
  solver_.set_timestep(dt);
  check_positions();
  finish_step(dt);
}

// Tries steps until the estimate of their error is below the tolerance. The flow at the end of the
// step that is kept is known then.
void LammpsIntegrator::step_adaptive()
{
  if (is_radius_due()) stiffness.renew(time_);
  double dt = std::min({next_dt_, largest_dt_, find_closing_limit()});
  for (;; record_.n_repeated += 1.0) {
    std::string why;
    double error = INFINITY;
    box_.begin_step(dt);
    adopt_dt(dt);
    record_.n_stages = 0.0;
    try {
      take_stages(0.0, 1.0);
      correct_held_cells();
      evaluate_stage(time_ + dt, Part::All);
      check_crossings();
      error = estimate_error(dt);
    } catch (const StepFailure &failure) {
      why = failure.why;
    }
    if (controller_.is_accepted(error)) {
      note_error(error);
      last_part_ = 0.0;
      next_dt_ = controller_.choose_next(dt, error);
      break;
    }
    restore_start();
    dt = controller_.choose_again(dt, error);
    if (dt < kSmallestDt * largest_dt_)
      throw StepFailure{why.empty()
                            ? fmt::format("no step down to {:.3g} of the timestep has an error "
                                          "below error/tolerance {:.6g}; allow a larger error",
                                          kSmallestDt, settings_.error_tolerance)
                            : why};
  }
  finish_step(dt);
}

bool LammpsIntegrator::is_radius_due() const
{
  return has_grown_ || stiffness.is_due(kBetweenEstimates);
}

// An error that grows suddenly may be a mode that the stages do not damp any more.
void LammpsIntegrator::note_error(double error)
{
  has_grown_ = last_error_ > 0.0 && error > kErrorGrowth * last_error_;
  record_.error = last_error_ = error;
}

int LammpsIntegrator::count_stages(double h) const
{
  const double radius = kRadiusMargin * stiffness.upper_radius(kBetweenEstimates);
  const int n = biem::choose_stages(h, radius);
  if (n > biem::kMostStages)
    throw StepFailure{
        fmt::format("a timestep of {:.6g} with a spectral radius of {:.4g} needs more "
                    "than {} stages; use a smaller timestep",
                    h, radius, biem::kMostStages)};
  return n;
}

// A part of LAMMPS' step: from fraction on, of length span. Leaves atoms at the last stage, which
// is not evaluated.
void LammpsIntegrator::take_stages(double fraction, double span)
{
  const double dt = update->dt, h = span * dt;
  solver_.set_timestep(h);
  const int n = count_stages(h);
  const std::vector<biem::ChebyshevStage> stages = biem::compute_chebyshev_stages(n);
  begin_stages();
  for (int j = 1; j <= n; j++) {
    move_to_stage(stages[j], h, (stages[j].time - stages[j - 1].time) * h);
    const double now = fraction + stages[j].time * span;
    wants_new_lists_ = box_.advance(now);
    if (!solver_.particles.is_empty()) solver_.particles.lay_atoms();
    if (j < n) evaluate_stage(time_ + now * dt, flow.can_extrapolate() ? Part::Fast : Part::All);
  }
  record_.n_stages += n;
  record_.last_part_stages = n;
  last_part_ = h;
}

void LammpsIntegrator::begin_stages()
{
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array_[i];
    Eigen::Map<biem::Vec3>(a + kStartRate) = flow.velocity(i) + flow_.mean;
    std::fill_n(a + kDisplacement, 6, 0.0);
  }
  solver_.particles.begin_stages(flow_);
}

// Positions and the box have to be of the same time when lists are renewed: the caller moves the
// box next.
void LammpsIntegrator::move_to_stage(const biem::ChebyshevStage &next, double h, double elapsed)
{
  double largest = 0.0, all;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_mobile(i)) continue;
    double *a = array_[i];
    Eigen::Map<biem::Vec3> position(atom->x[i]), last(a + kDisplacement),
        before(a + kPreviousDisplacement), start(a + kStartRate);
    const biem::Vec3 rate = flow.velocity(i) + flow_.mean + flow_.gradient * last;
    const biem::Vec3 displacement = biem::combine(next, last, before, h * rate, h * start);
    const biem::Vec3 carried = position - last;    // by the background shear alone
    position = carried + elapsed * flow_.gradient * carried + displacement;
    const double move = (displacement - last).norm();
    largest = std::isfinite(move) ? std::max(largest, move) : INFINITY;
    before = last;
    last = displacement;
  }
  solver_.particles.advance_stage(next, flow_, h, elapsed);
  for (const auto &entry : solver_.particles.stages()) {
    const biem::RigidBodyStages &s = entry.second;
    largest = std::max(largest, (s.displacement - s.previous_displacement).norm() +
                                    (s.turn - s.previous_turn).norm() *
                                        solver_.particles.radius(entry.first));
  }
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  const double limit = 0.5 * std::min({domain->xprd, domain->yprd, domain->zprd});
  if (!(all < limit)) {
    flow.forces.update_ghosts();
    const std::string finding = watchdog_.check();    // names the cell
    if (!finding.empty()) throw StepFailure{finding};
    throw StepFailure{
        fmt::format("a node would move by {:.3g} from one stage to the next, more than "
                    "half of the box: a force is far too large, or the timestep; use "
                    "a smaller timestep",
                    all)};
  }
  flow.forces.note_move(all, elapsed);
}

void LammpsIntegrator::evaluate_stage(double time, Part part)
{
  flow.update_lists();
  const std::string finding = watchdog_.check();
  if (!finding.empty()) throw StepFailure{finding};
  flow.compute_forces();
  if (part == Part::Fast) {
    flow.evaluate_inner(time);
    return;
  }
  biem::Evaluation e = flow.evaluate(time);
  flow.store(e);
  finished_ = std::move(e);
}

// What stages of finite length do to volumes; the velocities hold them to first order only.
void LammpsIntegrator::correct_held_cells()
{
  flow.forces.update_ghosts();
  const biem::Points displacement = solver_.compute_hold_correction();
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; a < 3; a++)
      atom->x[i][a] += displacement(a, i);
}

// At the end of a step, before LAMMPS computes its forces.
void LammpsIntegrator::check_positions()
{
  finished_.reset();
  flow.forces.update_ghosts();
  const std::string finding = watchdog_.check();
  if (!finding.empty()) throw StepFailure{finding};
  check_crossings();
}

void LammpsIntegrator::check_crossings()
{
  const bigint interval = watchdog_.limits().crossing_interval;
  if (interval == 0 || update->ntimestep % interval != 0) return;
  const std::string finding = watchdog_.check_crossings();
  if (!finding.empty()) throw StepFailure{finding};
}

double LammpsIntegrator::find_closing_limit()
{
  return kClosingShare * solver_.find_closing_time(array_, kVelocity, flow_);
}

void LammpsIntegrator::finish_step(double dt)
{
  time_ += dt;
  record_.add_step(dt);
}

std::vector<double> LammpsIntegrator::get_state() const
{
  std::vector<double> state = {time_,       largest_dt_,           next_dt_,
                               adopted_dt_, controller_.last_dt(), controller_.last_error(),
                               last_error_, has_grown_ ? 1.0 : 0.0};
  for (const std::vector<double> &part : {flow.get_state(), stiffness.get_state()})
    state.insert(state.end(), part.begin(), part.end());
  return state;
}

const double *LammpsIntegrator::set_state(const double *state)
{
  time_ = state[0];
  largest_dt_ = state[1];
  next_dt_ = state[2];
  adopted_dt_ = state[3];
  controller_.set_last(state[4], state[5]);
  last_error_ = state[6];
  has_grown_ = state[7] != 0.0;
  return stiffness.set_state(flow.set_state(state + 8));
}

}    // namespace LAMMPS_NS
