// fix biem: parses, calls the core, publishes. Physics and numerics are in the core.
#include "fix_biem.h"
#include "atom.h"
#include "biem_lammps_bridge.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_report.h"
#include "biem_lammps_script_check.h"
#include "biem_lammps_settings.h"
#include "biem_lammps_sheared_box.h"
#include "biem_lammps_topology.h"
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

// Edges may grow to this multiple of the longest edge at the start of a run.
constexpr double kEdgeGrowth = 1.6;

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
  MeshSurvey survey;
  LammpsExchange exchange;
  std::unique_ptr<LammpsScene> scene;
  std::unique_ptr<biem::Suspension> suspension;
  biem::EwaldScene ewald_scene;
  biem::EwaldParameters ewald;
  biem::Vec3 ewald_lengths = biem::Vec3::Zero();    // box lengths they were chosen for
  biem::Evaluation evaluation;
  biem::CellVolumes volumes;
  NeighList *list = nullptr;
  NodeGroups groups;
  bool is_warned = false;
  std::string reported;    // setup text of the last run, not repeated while it is the same
  double list_cutoff = 0.0;
  double own_comm_cutoff = -1.0;    // what this fix has set itself
  ShearedBox box;
  double vector[kVectorSize] = {};

  Impl(LAMMPS *lmp, Fix *fix, const FixBiemSettings &s) :
      settings(s), exchange(lmp, fix), box(lmp, s.background.shear_rate)
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

void FixBiem::check_cutoffs(double needed)
{
  const bool is_own = comm->cutghostuser == impl->own_comm_cutoff;
  if (comm->cutghostuser > 0.0 && !is_own && comm->cutghostuser < needed)
    error->all(FLERR, fmt::format("Fix biem: communication cutoff {:.8g} is too small, {:.8g} is "
                                  "needed (real-space cutoff, edges and skin); remove 'comm_modify "
                                  "cutoff' so that fix biem sets it, or give at least this value",
                                  comm->cutghostuser, needed));
  if (comm->cutghostuser < needed || is_own) comm->cutghostuser = impl->own_comm_cutoff = needed;
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
  prepare_scene();
  BiemCompat::request_full_list(neighbor, this, instance_me, impl->list_cutoff);
}

void FixBiem::prepare_scene()
{
  Impl &m = *impl;
  m.survey = survey_meshes(lmp, m.groups);
  const MeshSurvey &survey = m.survey;
  const double shortest = std::min({domain->xprd, domain->yprd, domain->zprd});
  if (survey.longest_edge > 0.5 * shortest)
    error->all(FLERR,
               "Fix biem: the longest mesh edge is " + std::to_string(survey.longest_edge) +
                   ", more than half of the shortest box length " + std::to_string(shortest) +
                   ": refine the mesh or enlarge the box; if the mesh is fine, the image flags of "
                   "the nodes of one cell do not belong together");
  if (m.volumes.reference.empty()) {
    m.volumes.reference = survey.volumes;
  } else if (static_cast<int>(m.volumes.reference.size()) != survey.n_cells) {
    error->all(FLERR, "Fix biem: the number of cells has changed from " +
                          std::to_string(m.volumes.reference.size()) + " to " +
                          std::to_string(survey.n_cells) +
                          " since the fix was defined; define it anew");
  }
  m.volumes.current.resize(survey.n_cells);
  m.volumes.relaxation_rate = 0.1 / update->dt;

  biem::EwaldScene &scene = m.ewald_scene;
  scene.cell = get_cell(lmp);
  scene.max_tilt = impl->box.is_sheared() ? 0.5 * domain->xprd : std::fabs(domain->xz);
  scene.n_sources = static_cast<double>(survey.n_nodes + survey.n_triangles);
  scene.n_targets = static_cast<double>(atom->natoms);
  scene.body_sources = survey.n_cells > 0 ? scene.n_sources / survey.n_cells : 0.0;
  double volume = 0.0;
  for (double v : survey.volumes)
    volume += v / survey.n_cells;
  scene.body_radius = std::cbrt(3.0 * volume / (4.0 * M_PI));
  scene.tolerance = m.settings.accuracy;
  scene.min_cutoff = scene.max_cutoff = m.settings.cutoff;
  // Parameters once chosen stay, also through a restart, unless the accuracy or the box changes.
  const bool is_chosen = m.ewald.order > 0 && m.ewald.tolerance == scene.tolerance &&
                         m.ewald_lengths == scene.cell.diagonal() &&
                         (m.settings.cutoff == 0.0 || m.ewald.cutoff == m.settings.cutoff);
  m.suspension = guarded(lmp, "Fix biem", [&] {
    if (!is_chosen) m.ewald = biem::choose_ewald_parameters(scene);
    m.ewald_lengths = scene.cell.diagonal();
    return std::make_unique<biem::Suspension>(world, m.ewald, m.settings.suspension);
  });
  const double edge = kEdgeGrowth * survey.longest_edge;
  m.list_cutoff = edge + kEdgeGrowth * biem::kNearFactor * survey.longest_mean_edge;
  const double cutoff = m.suspension->parameters().cutoff;
  check_cutoffs(std::max(m.list_cutoff, cutoff + edge) + neighbor->skin);
  m.scene = std::make_unique<LammpsScene>(lmp, m.groups, m.list_cutoff);
  m.box.start();
  const double cutoffs[2] = {comm->cutghostuser, m.list_cutoff};
  const std::string text = describe_setup(lmp, m.survey, m.suspension->parameters(), cutoffs);
  if (comm->me == 0 && text != m.reported) utils::logmesg(lmp, text);
  m.reported = text;
}

void FixBiem::init_list(int, NeighList *list)
{
  impl->list = list;
}

void FixBiem::reset_dt()
{
  impl->box.start();
  impl->volumes.relaxation_rate = 0.1 / update->dt;
}

void FixBiem::setup(int)
{
  guarded(lmp, "Fix biem", [&] { impl->scene->refresh(impl->list); });
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
  if (neighbor->ago == 0) guarded(lmp, "Fix biem", [&] { impl->scene->refresh(impl->list); });
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
  m.suspension->set_cell(get_cell(lmp), get_origin(lmp));
  const Eigen::Map<const biem::Points> forces(atom->f[0], 3, atom->nlocal);
  m.evaluation = guarded(lmp, "Fix biem: step " + std::to_string(update->ntimestep), [&] {
    return m.suspension->evaluate(m.scene->get_configuration(), forces, m.volumes, m.exchange);
  });
  publish();
}

void FixBiem::publish()
{
  Impl &m = *impl;
  const biem::Evaluation &e = m.evaluation;
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
  m.exchange.sum(sums, 2);
  MPI_Allreduce(&largest, &m.vector[kMaxVelocity], 1, MPI_DOUBLE, MPI_MAX, world);
  if (!std::isfinite(sums[1]))
    error->all(FLERR, "Fix biem: a velocity is not a number at step " +
                          std::to_string(update->ntimestep) + ": use a smaller timestep");
  m.vector[kPower] = sums[0];
  m.vector[kRmsVelocity] = atom->natoms > 0 ? std::sqrt(sums[1] / static_cast<double>(atom->natoms))
                                            : 0.0;
  m.vector[kVolumeError] = 0.0;
  for (size_t c = 0; c < m.volumes.reference.size(); c++)
    if (m.volumes.reference[c] > 0.0)
      m.vector[kVolumeError] = std::max(
          m.vector[kVolumeError], std::fabs(m.volumes.current[c] / m.volumes.reference[c] - 1.0));
  m.vector[kStrain] = m.box.strain();
  m.vector[kFlips] = m.box.n_flips();
  check_volumes();
  const biem::OperatorProfile &profile = m.suspension->profile();
  m.vector[kRealTime] = profile.real_space;
  m.vector[kNearTime] = profile.near;
  m.vector[kFourierTime] = profile.fourier;
  m.vector[kExpectedError] = m.suspension->parameters().expected_error;
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
  const Impl &m = *impl;
  std::vector<double> list = m.box.get_state();
  const std::vector<double> ewald = to_state(m.ewald);
  list.insert(list.end(), ewald.begin(), ewald.end());
  list.insert(list.end(), {m.own_comm_cutoff, m.ewald_lengths[0], m.ewald_lengths[1],
                           m.ewald_lengths[2], static_cast<double>(m.volumes.reference.size())});
  list.insert(list.end(), m.volumes.reference.begin(), m.volumes.reference.end());
  const int size = static_cast<int>(list.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, file);
  fwrite(list.data(), sizeof(double), list.size(), file);
}

void FixBiem::restart(char *buffer)
{
  const double *next = reinterpret_cast<const double *>(buffer);
  Impl &m = *impl;
  m.box.set_state(next);
  next += ShearedBox::kStateSize;
  m.ewald = to_ewald_parameters(next);
  next += kEwaldStateSize;
  m.own_comm_cutoff = *next++;
  for (int a = 0; a < 3; a++)
    m.ewald_lengths[a] = *next++;
  const int n_cells = static_cast<int>(*next++);
  m.volumes.reference.assign(next, next + n_cells);
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
  return impl->exchange.pack_forward(n, list, buffer);
}

void FixBiem::unpack_forward_comm(int n, int first, double *buffer)
{
  impl->exchange.unpack_forward(n, first, buffer);
}

int FixBiem::pack_reverse_comm(int n, int first, double *buffer)
{
  return impl->exchange.pack_reverse(n, first, buffer);
}

void FixBiem::unpack_reverse_comm(int n, int *list, double *buffer)
{
  impl->exchange.unpack_reverse(n, list, buffer);
}
