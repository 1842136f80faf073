// Output of fix biem: see the header.
#include "biem_lammps_output.h"
#include "atom.h"
#include "error.h"
#include "update.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

double FlowOutput::table(int row, int column) const
{
  const size_t k = static_cast<size_t>(row) * kColumns + column;
  return k < table_.size() ? table_[k] : 0.0;
}

void FlowOutput::start(const LammpsSolver &solver)
{
  get_times(solver, start_times_);
}

void FlowOutput::get_times(const LammpsSolver &solver, double *times)
{
  const biem::OperatorProfile force = solver.force_profile(), coupled = solver.coupled_profile();
  const biem::OperatorProfile all = force + coupled;
  times[kReal] = all.sum.search + all.sum.real_space + all.sum.ghosts;
  times[kNear] = all.near;
  times[kFourier] = all.sum.fourier.total();
  times[kCoupled] = coupled.sum.search + coupled.sum.real_space + coupled.sum.ghosts +
                    coupled.near + coupled.sum.fourier.total();
}

void FlowOutput::publish(const biem::Evaluation &e, LammpsSolver &solver, const ShearedBox &box,
                         const LammpsIntegrator &integrator)
{
  update_velocities(e, solver);
  update_table(e, solver);
  vector_[kVolumeError] = solver.volume_error();
  vector_[kStrain] = box.strain();
  vector_[kFlips] = box.n_flips();
  double times[kTimes];
  get_times(solver, times);
  vector_[kRealTime] = times[kReal] - start_times_[kReal];
  vector_[kNearTime] = times[kNear] - start_times_[kNear];
  vector_[kFourierTime] = times[kFourier] - start_times_[kFourier];
  vector_[kCoupledTime] = times[kCoupled] - start_times_[kCoupled];
  vector_[kExpectedError] = solver.expected_error();
  vector_[kIterations] = e.solver.iterations;
  vector_[kResidual] = e.solver.residual;
  const StepRecord &record = integrator.record();
  vector_[kEvaluations] = integrator.flow.n_evaluations();
  vector_[kInnerEvaluations] = integrator.flow.n_inner();
  vector_[kStages] = record.n_stages;
  vector_[kRadius] = integrator.stiffness.radius();
  vector_[kTime] = integrator.time();
  vector_[kStepError] = record.error;
  vector_[kRepeated] = record.n_repeated + record.n_split;
  for (int a = 0; a < 3; a++) {
    vector_[kMeanVelocity + a] = e.mean_velocity[a];
    vector_[kPressureDrop + a] = e.pressure_drop[a];
    vector_[kWallStress + a] = e.wall_area > 0.0 ? -0.5 * e.wall_force[a] / e.wall_area : 0.0;
  }
}

void FlowOutput::update_velocities(const biem::Evaluation &e, LammpsSolver &solver)
{
  double sums[2] = {0.0, 0.0}, largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    const biem::Vec3 velocity = e.velocity.col(i);
    sums[0] += Eigen::Map<const biem::Vec3>(atom->f[i]).dot(velocity);
    sums[1] += velocity.squaredNorm();
    largest = std::max(largest, velocity.norm());
  }
  solver.exchange.sum(sums, 2);
  MPI_Allreduce(&largest, &vector_[kMaxVelocity], 1, MPI_DOUBLE, MPI_MAX, world);
  if (!std::isfinite(sums[1]))
    error->all(FLERR, "Fix biem: a velocity is not a number at step " +
                          std::to_string(update->ntimestep) + ": use a smaller timestep");
  vector_[kPower] = sums[0];
  vector_[kRmsVelocity] = atom->natoms > 0 ? std::sqrt(sums[1] / static_cast<double>(atom->natoms))
                                           : 0.0;
}

void FlowOutput::update_table(const biem::Evaluation &e, LammpsSolver &solver)
{
  if (!solver.has_unknowns()) return;
  const std::vector<biem::Surface> &surfaces = solver.scene().surfaces;
  table_.assign(surfaces.size() * kColumns, 0.0);
  // Forces on the fluid: of walls by their traction, of all others the nodal forces.
  std::vector<double> forces(3 * surfaces.size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    const int s = solver.find_surface(i);
    if (s < 0) continue;
    const bool is_wall = surfaces[s].kind == biem::SurfaceKind::Wall;
    for (int a = 0; a < 3; a++)
      forces[3 * s + a] += is_wall ? e.areas[i] * e.traction(a, i) : atom->f[i][a];
  }
  solver.exchange.sum(forces.data(), static_cast<int>(forces.size()));
  double size = 0.0;    // walls that move against each other have forces against each other
  for (size_t s = 0; s < surfaces.size(); s++)
    if (surfaces[s].kind == biem::SurfaceKind::Wall)
      size += Eigen::Map<const biem::Vec3>(&forces[3 * s]).norm();
  if (e.wall_area > 0.0)
    vector_[kWallShearRate] = 0.5 * size / e.wall_area / settings_.suspension.viscosity;
  for (size_t s = 0; s < surfaces.size(); s++) {
    double *row = &table_[s * kColumns];
    std::copy_n(&forces[3 * s], 3, row + kForce);
    if (!surfaces[s].is_unknown() || !surfaces[s].is_closed()) continue;
    const biem::Mat3 &stresslet = e.stresslets[s];
    const double entries[6] = {stresslet(0, 0), stresslet(1, 1), stresslet(2, 2),
                               stresslet(0, 1), stresslet(0, 2), stresslet(1, 2)};
    std::copy_n(entries, 6, row + kStresslet);
    const auto body = solver.particles.bodies().find(static_cast<int>(s) + 1);
    if (body == solver.particles.bodies().end()) {    // a cell
      const biem::Vec3 velocity =
          e.motions[s].velocity + settings_.conditions.flow.velocity(e.centroids[s]);
      std::copy_n(e.centroids[s].data(), 3, row + kPosition);
      std::copy_n(velocity.data(), 3, row + kBodyVelocity);
      std::copy_n(e.motions[s].rotation.data(), 3, row + kRotation);
      row[kQuaternion] = 1.0;
      continue;
    }
    const biem::RigidBody &b = body->second;
    const double quaternion[4] = {b.orientation.w(), b.orientation.x(), b.orientation.y(),
                                  b.orientation.z()};
    std::copy_n(b.position.data(), 3, row + kPosition);
    std::copy_n(b.velocity.data(), 3, row + kBodyVelocity);
    std::copy_n(b.rotation.data(), 3, row + kRotation);
    std::copy_n(quaternion, 4, row + kQuaternion);
    const SurfaceGroup *group = solver.group_of(static_cast<int>(s));
    for (int a = 0; a < 3; a++)
      row[kForce + a] += group->force[a];
  }
}

}    // namespace LAMMPS_NS
