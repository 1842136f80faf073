// fix biem: parses, calls the core, publishes. Physics and numerics are in the core.
#include "fix_biem.h"
#include "atom.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_script_check.h"
#include "biem_lammps_settings.h"
#include "biem_lammps_sheared_box.h"
#include "biem_lammps_solver.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cmath>
#include <memory>

using namespace LAMMPS_NS;
using namespace FixConst;

namespace {

// Columns of the per-atom array; the first kPublished are visible to the input script.
enum { kVelocity = 0, kTraction = 3, kArea = 6, kPublished = 7, kPrevious = 7, kPreviousDt = 10 };
constexpr int kColumns = 11;
// First number of the fix's part of a restart file; changes with what follows it.
constexpr double kRestartFormat = 20261121.0;

// Relative volume errors of a stable run are below 1e-5.
constexpr double kVolumeWarning = 1e-4, kVolumeLimit = 1e-2;

enum {
  kPower,
  kVolumeError,
  kRmsVelocity,
  kMaxVelocity,
  kStrain,
  kFlips,
  kRealTime,
  kNearTime,
  kFourierTime,
  kExpectedError,
  kVectorSize
};

}    // namespace

struct FixBiem::Impl {
  FixBiemSettings settings;
  LammpsSolver solver;
  ShearedBox box;
  NodeGroups groups;
  NeighList *list = nullptr;
  bool is_warned = false;
  double vector[kVectorSize] = {};

  Impl(LAMMPS *lmp, Fix *fix, const FixBiemSettings &s) :
      settings(s), solver(lmp, fix, s), box(lmp, s.background.shear_rate)
  {
  }
};

FixBiem::FixBiem(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), array(nullptr)
{
  impl = new Impl(lmp, this, parse_fix_biem(lmp, narg, arg));
  if (!atom->molecule_flag)
    error->all(FLERR, "Fix biem: atoms have no molecule ids, which number the cells; use "
                      "atom_style molecular");
  if (atom->tag_enable == 0 || atom->map_style == 0)
    error->all(FLERR, "Fix biem: needs atom ids and an atom map; add 'atom_modify map yes' before "
                      "the box is created");
  if (impl->box.is_sheared()) {
    if (!domain->triclinic)
      error->all(FLERR, "Fix biem: flow shear needs a triclinic box; create it as a prism (region "
                        "... prism) or use 'change_box all triclinic'");
    box_change |= BOX_CHANGE_XZ;
    no_change_box = 1;
    force_reneighbor = 1;
    next_reneighbor = -1;
  }
  time_integrate = 1;
  scalar_flag = vector_flag = 1;
  size_vector = kVectorSize;
  global_freq = 1;
  extscalar = extvector = 0;
  peratom_flag = 1;
  size_peratom_cols = kPublished;
  peratom_freq = 1;
  restart_global = restart_peratom = 1;
  create_attribute = 1;
  comm_forward = comm_reverse = 3;
  dynamic_group_allow = 0;
  FixBiem::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++)
    FixBiem::set_arrays(i);
}

FixBiem::~FixBiem()
{
  if (modify) {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }
  memory->destroy(array);
  delete impl;
}

int FixBiem::setmask()
{
  int mask = INITIAL_INTEGRATE | POST_FORCE;
  if (impl->box.is_sheared()) mask |= PRE_EXCHANGE;
  return mask;
}

void FixBiem::init()
{
  check_script(lmp, this);
  const FixBiemSettings &s = impl->settings;
  auto bit = [&](const std::string &name) {
    return group->bitmask[group->find(name.c_str())];
  };
  NodeGroups &groups = impl->groups;
  groups.cells = s.cells.empty() ? NodeGroups::Cells::Rest : NodeGroups::Cells::Named;
  groups.cells_bit = s.cells.empty() ? groupbit : bit(s.cells);
  groups.tracers_bit = s.tracers.empty() ? 0 : bit(s.tracers);
  groups.fix_bit = groupbit;
  impl->solver.prepare(groups, impl->box.is_sheared() ? 0.5 * domain->xprd : domain->xz);
  impl->box.start();
  BiemCompat::request_full_list(neighbor, this, instance_me, impl->solver.list_cutoff());
}

void FixBiem::init_list(int, NeighList *list)
{
  impl->list = list;
}

void FixBiem::reset_dt()
{
  impl->box.start();
  impl->solver.set_timestep(update->dt);
}

void FixBiem::setup(int)
{
  impl->solver.refresh(impl->list);
  evaluate();
}

void FixBiem::initial_integrate(int)
{
  const double dt = update->dt;
  double **x = atom->x;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *a = array[i];
    Eigen::Map<biem::Vec3> position(x[i]), velocity(a + kVelocity), previous(a + kPrevious);
    const biem::Vec3 relative =
        biem::compute_displacement(impl->settings.stepper, velocity, previous, dt, a[kPreviousDt]);
    if (relative.norm() > impl->solver.longest_edge() && impl->groups.is_cell(atom->mask[i]))
      error->one(FLERR,
                 fmt::format("Fix biem: step {}: atom {} of molecule {} would move by "
                             "{:.3g} relative to the flow, more than the longest edge: the "
                             "timestep is far too large",
                             update->ntimestep, atom->tag[i], atom->molecule[i], relative.norm()));
    position += impl->settings.background.displacement(position, relative, dt);
    previous = velocity;
    a[kPreviousDt] = dt;
  }
  // The box of the new time before ghosts move and forces are computed.
  if (impl->box.advance()) next_reneighbor = update->ntimestep;
}

void FixBiem::pre_exchange()
{
  impl->box.flip_if_needed();
}

void FixBiem::post_force(int)
{
  if (neighbor->ago == 0) impl->solver.refresh(impl->list);
  evaluate();
}

void FixBiem::check_forces()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const double *f = atom->f[i], *x = atom->x[i];
    if (!std::isfinite(f[0] + f[1] + f[2] + x[0] + x[1] + x[2]))
      error->one(FLERR, "Fix biem: force or position of atom " + std::to_string(atom->tag[i]) +
                            " (molecule " + std::to_string(atom->molecule[i]) +
                            ") is not a number at step " + std::to_string(update->ntimestep) +
                            ": the membrane has become unstable or folded; use a smaller timestep");
    if (impl->groups.is_tracer(atom->mask[i]) && (f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0))
      error->one(FLERR,
                 "Fix biem: a force acts on tracer " + std::to_string(atom->tag[i]) +
                     ", but tracers only follow the flow; take it out of the group of the fix or "
                     "pair style that causes the force");
  }
}

void FixBiem::evaluate()
{
  check_forces();
  Impl &m = *impl;
  const biem::Evaluation e = m.solver.evaluate();
  double sums[2] = {0.0, 0.0}, largest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array[i];
    Eigen::Map<biem::Vec3> velocity(a + kVelocity), traction(a + kTraction), total(atom->v[i]);
    const Eigen::Map<biem::Vec3> position(atom->x[i]), force(atom->f[i]);
    velocity = e.velocity.col(i);
    traction = e.traction.col(i);
    a[kArea] = e.areas[i];
    total = velocity + m.settings.background.velocity(position);
    sums[0] += force.dot(velocity);
    sums[1] += velocity.squaredNorm();
    largest = std::max(largest, velocity.norm());
  }
  m.solver.exchange.sum(sums, 2);
  MPI_Allreduce(&largest, &m.vector[kMaxVelocity], 1, MPI_DOUBLE, MPI_MAX, world);
  if (!std::isfinite(sums[1]))
    error->all(FLERR, "Fix biem: a velocity is not a number at step " +
                          std::to_string(update->ntimestep) + ": use a smaller timestep");
  m.vector[kPower] = sums[0];
  m.vector[kRmsVelocity] = atom->natoms > 0 ? std::sqrt(sums[1] / static_cast<double>(atom->natoms))
                                            : 0.0;
  m.vector[kVolumeError] = m.solver.volume_error();
  m.vector[kStrain] = m.box.strain();
  m.vector[kFlips] = m.box.n_flips();
  check_volumes();
  const biem::OperatorProfile profile = m.solver.profile();
  m.vector[kRealTime] = profile.sum.search + profile.sum.real_space + profile.sum.ghosts;
  m.vector[kNearTime] = profile.near;
  m.vector[kFourierTime] = profile.sum.fourier.total();
  m.vector[kExpectedError] = m.solver.parameters().expected_error;
}

// The projection holds volumes to the error of the time stepping: a large error is an unstable run.
void FixBiem::check_volumes()
{
  const double deviation = impl->vector[kVolumeError];
  if (deviation <= kVolumeWarning) return;
  const std::string text = fmt::format(
      "Fix biem: relative volume error {:.2g} of a cell at step {}: the timestep is beyond "
      "the limit of stability of the stepper; use a smaller one (see doc/fix_biem.md)",
      deviation, update->ntimestep);
  if (deviation > kVolumeLimit) error->all(FLERR, text);
  if (!impl->is_warned && comm->me == 0) error->warning(FLERR, text);
  impl->is_warned = true;
}

double FixBiem::compute_scalar()
{
  return impl->vector[kPower];
}
double FixBiem::compute_vector(int i)
{
  return impl->vector[i];
}
double FixBiem::memory_usage()
{
  return static_cast<double>(atom->nmax) * kColumns * sizeof(double);
}

void FixBiem::grow_arrays(int n)
{
  memory->grow(array, n, kColumns, "biem:array");
  array_atom = array;
}

void FixBiem::copy_arrays(int i, int j, int)
{
  std::copy_n(array[i], kColumns, array[j]);
}
void FixBiem::set_arrays(int i)
{
  std::fill_n(array[i], kColumns, 0.0);
}

int FixBiem::pack_exchange(int i, double *buffer)
{
  std::copy_n(array[i], kColumns, buffer);
  return kColumns;
}

int FixBiem::unpack_exchange(int i, double *buffer)
{
  std::copy_n(buffer, kColumns, array[i]);
  return kColumns;
}

void FixBiem::write_restart(FILE *file)
{
  if (comm->me != 0) return;
  std::vector<double> list = {kRestartFormat};
  for (const std::vector<double> &part : {impl->box.get_state(), impl->solver.get_state()})
    list.insert(list.end(), part.begin(), part.end());
  const int size = static_cast<int>(list.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, file);
  fwrite(list.data(), sizeof(double), list.size(), file);
}

void FixBiem::restart(char *buffer)
{
  const double *state = reinterpret_cast<const double *>(buffer);
  if (*state++ != kRestartFormat)
    error->all(FLERR, "Fix biem: the restart file was written by another version of this package; "
                      "continue it with that version, or write a data file and start from it");
  impl->box.set_state(state);
  impl->solver.set_state(state + ShearedBox::kStateSize);
}

int FixBiem::pack_restart(int i, double *buffer)
{
  buffer[0] = kColumns + 1;
  std::copy_n(array[i], kColumns, buffer + 1);
  return kColumns + 1;
}

void FixBiem::unpack_restart(int nlocal, int nth)
{
  double **extra = atom->extra;
  int m = 0;
  for (int i = 0; i < nth; i++)
    m += static_cast<int>(extra[nlocal][m]);
  std::copy_n(extra[nlocal] + m + 1, kColumns, array[nlocal]);
}

int FixBiem::size_restart(int)
{
  return kColumns + 1;
}
int FixBiem::maxsize_restart()
{
  return kColumns + 1;
}

int FixBiem::pack_forward_comm(int n, int *list, double *buffer, int, int *)
{
  return impl->solver.exchange.pack_forward(n, list, buffer);
}

void FixBiem::unpack_forward_comm(int n, int first, double *buffer)
{
  impl->solver.exchange.unpack_forward(n, first, buffer);
}

int FixBiem::pack_reverse_comm(int n, int first, double *buffer)
{
  return impl->solver.exchange.pack_reverse(n, first, buffer);
}

void FixBiem::unpack_reverse_comm(int n, int *list, double *buffer)
{
  impl->solver.exchange.unpack_reverse(n, list, buffer);
}
