// fix biem: parses, calls the core, publishes. Physics and numerics are in the core.
#include "fix_biem.h"
#include "atom.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_integrator.h"
#include "biem_lammps_output.h"
#include "biem_lammps_script_check.h"
#include "biem_lammps_settings.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_biem_contact.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cmath>
#include <memory>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace NodeColumn;

namespace {

// First number of the fix's part of a restart file; changes with what follows it.
constexpr double kRestartFormat = 20261124.0;

// Relative volume errors of a stable run are below 1e-5.
constexpr double kVolumeWarning = 1e-4, kVolumeLimit = 1e-2;

}    // namespace

struct FixBiem::Impl {
  FixBiemSettings settings;
  LammpsSolver solver;
  ShearedBox box;
  NodeGroups groups;
  FlowOutput output;
  LammpsIntegrator integrator;
  bool is_warned = false;

  Impl(LAMMPS *lmp, Fix *fix, const FixBiemSettings &s, double **&array) :
      settings(s), solver(lmp, fix, s), box(lmp, s.conditions.flow.shear_rate()), output(lmp, s),
      integrator(lmp, fix, s, solver, box, array)
  {
  }
};

FixBiem::FixBiem(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), array(nullptr)
{
  impl = new Impl(lmp, this, parse_fix_biem(lmp, narg, arg), array);
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
  impl->integrator.start_run(groups);
  BiemCompat::request_full_list(neighbor, this, instance_me, impl->solver.list_cutoff());
}

void FixBiem::init_list(int, NeighList *list)
{
  impl->integrator.flow.set_list(list);
}

void FixBiem::reset_dt()
{
  impl->box.start();
  impl->solver.set_timestep(update->dt);
  impl->integrator.reset_dt();
}

void FixBiem::setup(int)
{
  LammpsIntegrator &integrator = impl->integrator;
  const double before = integrator.flow.n_all();
  integrator.renew_lists();
  publish();
  integrator.stiffness.skip(integrator.flow.n_all() - before);
}

void FixBiem::initial_integrate(int)
{
  if (impl->integrator.step()) next_reneighbor = update->ntimestep;
}

void FixBiem::pre_exchange()
{
  impl->box.flip_if_needed();
}

void FixBiem::post_force(int)
{
  if (neighbor->ago == 0) impl->integrator.renew_lists();
  publish();
}

void FixBiem::publish()
{
  Impl &m = *impl;
  const biem::Evaluation e = m.integrator.evaluate();
  for (int i = 0; i < atom->nlocal; i++) {
    const Eigen::Map<biem::Vec3> velocity(array[i] + kVelocity), position(atom->x[i]);
    Eigen::Map<biem::Vec3>(atom->v[i]) = velocity + m.settings.conditions.flow.velocity(position);
  }
  m.output.publish(e, m.solver, m.box, m.integrator);
  check_volumes();
}

void FixBiem::post_run()
{
  std::string text = impl->integrator.describe_run();
  const auto *contact = dynamic_cast<PairBiemContact *>(force->pair_match("biem/contact", 1));
  if (contact) text += "Fix biem: " + contact->describe_statistics() + "\n";
  if (comm->me == 0 && !text.empty()) utils::logmesg(lmp, text);
}

// The projection holds volumes to the error of the time stepping: a large error is an unstable run.
void FixBiem::check_volumes()
{
  const double deviation = impl->output.vector(FlowOutput::kVolumeError);
  if (impl->settings.hold == biem::Hold::None || deviation <= kVolumeWarning) return;
  const std::string text =
      fmt::format("relative volume error {:.2g} of cell {}: the timestep is too large for how fast "
                  "its shape changes; use a smaller one, or error/tolerance (see doc/fix_biem.md)",
                  deviation, impl->solver.worst_volume());
  if (deviation > kVolumeLimit) impl->integrator.stop(text);
  if (!impl->is_warned && comm->me == 0)
    error->warning(FLERR, fmt::format("Fix biem: step {}: {}", update->ntimestep, text));
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
       {impl->box.get_state(), impl->integrator.get_state(), impl->solver.get_state()})
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
  impl->solver.set_state(impl->integrator.set_state(state));
}

int FixBiem::pack_restart(int i, double *buffer)
{
  buffer[0] = kKept + 1;
  std::copy_n(array[i], kKept, buffer + 1);
  return kKept + 1;
}

void FixBiem::unpack_restart(int nlocal, int nth)
{
  double **extra = atom->extra;
  int m = 0;
  std::fill_n(array[nlocal], kColumns, 0.0);
  for (int i = 0; i < nth; i++)
    m += static_cast<int>(extra[nlocal][m]);
  std::copy_n(extra[nlocal] + m + 1, kKept, array[nlocal]);
}

int FixBiem::size_restart(int)
{
  return kKept + 1;
}
int FixBiem::maxsize_restart()
{
  return kKept + 1;
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
