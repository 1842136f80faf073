// fix biem: parses, calls the core, publishes. Physics and numerics are in the core.
#include "fix_biem.h"
#include "atom.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_history.h"
#include "biem_lammps_output.h"
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
enum {
  kVelocity = 0,
  kTraction = 3,
  kArea = 6,
  kPublished = 7,
  kPrevious = 7,
  kPreviousDt = 10,
  // Solution of the coupled system, now and one step ago; of rigid particles in the body frame.
  kSolution = 11,
  kPreviousSolution = 14
};
constexpr int kColumns = 17;
// First number of the fix's part of a restart file; changes with what follows it.
constexpr double kRestartFormat = 20261122.0;

// Relative volume errors of a stable run are below 1e-5.
constexpr double kVolumeWarning = 1e-4, kVolumeLimit = 1e-2;

}    // namespace

struct FixBiem::Impl {
  FixBiemSettings settings;
  LammpsSolver solver;
  ShearedBox box;
  NodeGroups groups;
  NeighList *list = nullptr;
  FlowOutput output;
  bool is_warned = false;
  SolutionHistory history;

  Impl(LAMMPS *lmp, Fix *fix, const FixBiemSettings &s) :
      settings(s), solver(lmp, fix, s), box(lmp, s.conditions.flow.shear_rate()), output(lmp, s),
      history(lmp, kSolution, kPreviousSolution)
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
  size_vector = FlowOutput::kVectorSize;
  array_flag = 1;
  size_array_cols = FlowOutput::kColumns;
  size_array_rows = 0;
  size_array_rows_variable = 1;
  global_freq = 1;
  extscalar = extvector = extarray = 0;
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
    return name.empty() ? 0 : group->bitmask[group->find(name.c_str())];
  };
  NodeGroups &groups = impl->groups;
  groups.surfaces = s.surfaces;
  for (SurfaceGroup &surface : groups.surfaces)
    surface.bit = bit(surface.name);
  groups.tracers_bit = bit(s.tracers);
  groups.probes_bit = bit(s.probes);
  groups.fix_bit = groupbit;
  impl->solver.prepare(groups, impl->box.is_sheared() ? 0.5 * domain->xprd : domain->xz);
  impl->output.start(impl->solver);
  size_array_rows = static_cast<int>(impl->solver.scene().surfaces.size());
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
  evaluate(SolutionStart::FromLast);
}

void FixBiem::initial_integrate(int)
{
  move_points();
  LammpsParticles &particles = impl->solver.particles;
  particles.advance(impl->settings.stepper, impl->settings.conditions.flow, update->dt);
  // The box of the new time before ghosts move and forces are computed.
  if (impl->box.advance()) next_reneighbor = update->ntimestep;
  if (!particles.is_empty()) particles.lay_atoms();
}

// Nodes of cells, and tracers.
void FixBiem::move_points()
{
  const double dt = update->dt;
  double **x = atom->x;
  for (int i = 0; i < atom->nlocal; i++) {
    const int mask = atom->mask[i];
    const bool is_cell = impl->groups.kind(mask) == biem::SurfaceKind::Cell;
    if (!is_cell && !impl->groups.is_tracer(mask)) continue;
    double *a = array[i];
    Eigen::Map<biem::Vec3> position(x[i]), velocity(a + kVelocity), previous(a + kPrevious);
    const biem::Vec3 relative =
        biem::compute_displacement(impl->settings.stepper, velocity, previous, dt, a[kPreviousDt]);
    if (relative.norm() > impl->solver.longest_edge() && is_cell)
      error->one(FLERR,
                 fmt::format("Fix biem: step {}: atom {} of molecule {} would move by "
                             "{:.3g} relative to the flow, more than the longest edge: the "
                             "timestep is far too large",
                             update->ntimestep, atom->tag[i], atom->molecule[i], relative.norm()));
    position += impl->settings.conditions.flow.displacement(position, relative, dt);
    previous = velocity;
    a[kPreviousDt] = dt;
  }
}

void FixBiem::pre_exchange()
{
  impl->box.flip_if_needed();
}

void FixBiem::post_force(int)
{
  if (neighbor->ago == 0) impl->solver.refresh(impl->list);
  evaluate(SolutionStart::Extrapolated);
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
    if (f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0) continue;
    const biem::SurfaceKind kind = impl->groups.kind(atom->mask[i]);
    if (kind == biem::SurfaceKind::None || kind == biem::SurfaceKind::Wall)
      error->one(FLERR,
                 "Fix biem: a force acts on atom " + std::to_string(atom->tag[i]) +
                     ", but tracers and probes only follow the flow, and walls do not move; take "
                     "it out of the group of the fix or pair style that causes the force, and give "
                     "the triangles of walls an angle type without forces");
  }
}

void FixBiem::evaluate(SolutionStart start)
{
  check_forces();
  Impl &m = *impl;
  const biem::Evaluation e = m.solver.evaluate(m.history.make_guess(start, m.solver, array));
  m.history.keep(start, m.solver, e.solution, array);
  for (int i = 0; i < atom->nlocal; i++) {
    double *a = array[i];
    Eigen::Map<biem::Vec3> velocity(a + kVelocity), traction(a + kTraction), total(atom->v[i]);
    const Eigen::Map<biem::Vec3> position(atom->x[i]);
    velocity = e.velocity.col(i);
    traction = e.traction.col(i);
    a[kArea] = e.areas[i];
    total = velocity + m.settings.conditions.flow.velocity(position);
  }
  m.output.publish(e, m.solver, m.box);
  check_volumes();
}

// The projection holds volumes to the error of the time stepping: a large error is an unstable run.
void FixBiem::check_volumes()
{
  const double deviation = impl->output.vector(FlowOutput::kVolumeError);
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
  return impl->output.vector(FlowOutput::kPower);
}
double FixBiem::compute_vector(int i)
{
  return impl->output.vector(i);
}
double FixBiem::compute_array(int row, int column)
{
  return impl->output.table(row, column);
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
  for (const std::vector<double> &part :
       {impl->box.get_state(), impl->history.get_state(), impl->solver.get_state()})
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
  state += ShearedBox::kStateSize;
  impl->history.set_state(state);
  impl->solver.set_state(state + SolutionHistory::kStateSize);
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
