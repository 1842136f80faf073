// What the integrator knows of a whole step: its error, where it started, how to go back and stop,
// and what to say of a run.
#include "atom.h"
#include "biem_lammps_integrator.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

using namespace NodeColumn;

void StepRecord::add_step(double dt)
{
  const bool is_first = n_steps == 0.0;
  n_steps += 1.0;
  most_stages = std::max(most_stages, last_part_stages);
  fewest_stages = is_first ? last_part_stages : std::min(fewest_stages, last_part_stages);
  longest_dt = std::max(longest_dt, dt);
  shortest_dt = is_first ? dt : std::min(shortest_dt, dt);
}

// Of all nodes the largest; particles count with the point of reference and their radius.
double LammpsIntegrator::estimate_error(double h)
{
  double largest = 0.0, all;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_mobile(i)) continue;
    double *a = array_[i];
    const biem::Vec3 displacement(a + kDisplacement), start(a + kStartRate);
    const biem::Vec3 end = flow.velocity(i) + flow_.mean + flow_.gradient * displacement;
    const biem::Vec3 error =
        biem::kErrorOfDisplacement * displacement + biem::kErrorOfRate * h * (start + end);
    Eigen::Map<biem::Vec3>(a + kStepError) = error;
    const double size = error.norm();
    largest = std::isfinite(size) ? std::max(largest, size) : INFINITY;
  }
  for (const auto &entry : solver_.particles.stages()) {
    const biem::RigidBodyStages &s = entry.second;
    const biem::RigidBody &body = solver_.particles.bodies().at(entry.first);
    const biem::Vec3 shift =
        biem::kErrorOfDisplacement * s.displacement +
        biem::kErrorOfRate * h * (s.start_rate + biem::compute_displacement_rate(flow_, s, body));
    const biem::Vec3 turn =
        biem::kErrorOfDisplacement * s.turn +
        biem::kErrorOfRate * h * (s.start_rotation + biem::compute_turn_rate(s, body));
    largest = std::max(largest, shift.norm() + turn.norm() * solver_.particles.radius(entry.first));
  }
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

// LAMMPS' clock with steps of different lengths: the present step ends dt after the last one.
void LammpsIntegrator::adopt_dt(double dt)
{
  if (dt == update->dt) return;
  const bigint last = update->ntimestep - 1;
  update->atime += static_cast<double>(last - update->atimestep) * update->dt;
  update->atimestep = last;
  update->dt = adopted_dt_ = dt;
}

void LammpsIntegrator::check_displacement(double largest) const
{
  double all;
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  if (all > solver_.longest_edge())
    throw StepFailure{fmt::format("a node would move by {:.3g} relative to the flow, more than the "
                                  "longest edge {:.3g}: the timestep is far too large",
                                  all, solver_.longest_edge())};
}

void LammpsIntegrator::save_start()
{
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array_[i];
    domain->unmap(atom->x[i], atom->image[i], a + kStartPosition);
    std::copy_n(a + kVelocity, 3, a + kStartVelocity);
  }
  start_bodies_ = solver_.particles.bodies();
}

void LammpsIntegrator::restore_start()
{
  finished_.reset();
  last_part_ = 0.0;
  box_.advance(0.0);
  const imageint zero = (static_cast<imageint>(IMGMAX) << IMG2BITS) |
                        (static_cast<imageint>(IMGMAX) << IMGBITS) | IMGMAX;
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array_[i];
    std::copy_n(a + kStartPosition, 3, atom->x[i]);
    atom->image[i] = zero;
    domain->remap(atom->x[i], atom->image[i]);
    std::copy_n(a + kStartVelocity, 3, a + kVelocity);
  }
  solver_.particles.bodies() = start_bodies_;
  flow.forces.require_new_lists();
}

void LammpsIntegrator::stop(const std::string &why)
{
  const bigint step = update->ntimestep;
  if (!has_start_) error->all(FLERR, fmt::format("Fix biem: step {}: {}", step, why));
  if (comm->me == 0)    // first of all: writing the file may fail as well
    utils::logmesg(lmp, fmt::format("Fix biem: step {}: {}\n", step, why));
  restore_start();
  flow.forces.update();
  update->ntimestep--;
  const std::string file = watchdog_.write_restart(update->ntimestep);
  const std::string advice =
      file.empty() ? ""
                   : fmt::format(". The state of step {} is in {}: read_restart it and go on with "
                                 "what is advised here",
                                 update->ntimestep, file);
  error->all(FLERR, fmt::format("Fix biem: step {}: {}{}", step, why, advice));
}

std::string LammpsIntegrator::describe_run() const
{
  const StepRecord &r = record_;
  if (r.n_steps == 0.0 || settings_.stepper != biem::Stepper::RungeKuttaChebyshev2) return "";
  std::string text = fmt::format(
      "Fix biem: {:.0f} steps of {:.0f} to {:.0f} stages, {:.0f} evaluations of the flow, {:.0f} "
      "of "
      "its fast part alone; {:.0f} of these for the spectral radius, {:.4g} at the end\n",
      r.n_steps, r.fewest_stages, r.most_stages, flow.n_evaluations(), flow.n_inner(),
      stiffness.n_evaluations(), stiffness.radius());
  if (settings_.error_tolerance > 0.0)
    text += fmt::format("  dt from {:.4g} to {:.4g}, {:.0f} steps repeated\n", r.shortest_dt,
                        r.longest_dt, r.n_repeated);
  if (r.n_split > 0.0)
    text += fmt::format("  {:.0f} additional parts of steps in which surfaces approached each "
                        "other\n",
                        r.n_split);
  if (flow.forces.n_rebuilds() > 0)
    text += fmt::format("  {} neighbor lists renewed within steps\n", flow.forces.n_rebuilds());
  return text;
}

}    // namespace LAMMPS_NS
