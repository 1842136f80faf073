// Flow solver on LAMMPS' atoms: see the header.
#include "biem_lammps_solver.h"
#include "atom.h"
#include "biem_lammps_overlap_check.h"
#include "biem_lammps_report.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

namespace {

// Edges may grow to this multiple of the longest edge at the start of a run: within what is
// communicated, and in the near list, where it costs less.
constexpr double kEdgeGrowth = 1.6, kListGrowth = 2.0;

// Flat parts of surfaces that may be within the cutoff of a node, its own included.
constexpr double kSurfacesInReach = 4.0;

}    // namespace

LammpsSolver::~LammpsSolver()
{
  if (comm->cutghostuser == own_comm_cutoff_) comm->cutghostuser = user_comm_cutoff_;
}

void LammpsSolver::prepare(const NodeGroups &groups, double max_tilt)
{
  survey_ = survey_meshes(lmp, groups);
  check_lengths();
  check_overlaps(lmp, groups, survey_,
                 cells_.reference_volume.empty() ? RunStart::First : RunStart::Continued);
  keep_references();
  groups_ = groups;
  guarded(lmp, "Fix biem", [&] { make_suspension(max_tilt); });
  set_cutoffs();
  auto find_index = [this](tagint tag) {
    const auto found = node_index_.find(tag);
    return found == node_index_.end() ? particles.find_index(tag) : found->second;
  };
  const long version = configuration_ ? configuration_->version() : 0;
  configuration_ =
      std::make_unique<LammpsConfiguration>(lmp, groups, find_index, list_cutoff_, version);
  const double cutoffs[2] = {comm->cutghostuser, list_cutoff_};
  const std::string text =
      describe_setup(lmp, survey_, force_parameters_.values(),
                     has_unknowns_ ? &coupled_parameters_.values() : nullptr, cutoffs);
  if (comm->me == 0 && text != reported_) utils::logmesg(lmp, text);
  reported_ = text;
}

void LammpsSolver::check_lengths() const
{
  const double shortest = std::min({domain->xprd, domain->yprd, domain->zprd});
  if (settings_.cutoff > shortest)
    error->all(FLERR, fmt::format("Fix biem: cutoff {:.6g} is larger than the shortest box length "
                                  "{:.6g}, which only costs time; give a smaller one or leave the "
                                  "keyword out",
                                  settings_.cutoff, shortest));
  if (survey_.longest_edge > 0.5 * shortest)
    error->all(FLERR, fmt::format("Fix biem: the longest mesh edge is {:.6g}, more than half of "
                                  "the shortest box length {:.6g}: refine the mesh or enlarge the "
                                  "box; if the mesh is fine, the image flags of the nodes of one "
                                  "cell do not belong together",
                                  survey_.longest_edge, shortest));
}

void LammpsSolver::keep_references()
{
  if (cells_.reference_volume.empty()) {
    cells_.reference_volume = survey_.volumes;
    cells_.reference_area = survey_.areas;
  } else if (static_cast<int>(cells_.reference_volume.size()) != survey_.n_molecules)
    error->all(FLERR,
               fmt::format("Fix biem: the number of surfaces has changed from {} to {} since "
                           "the fix was defined; define it anew",
                           cells_.reference_volume.size(), survey_.n_molecules));
  cells_.volume.resize(survey_.n_molecules);
  cells_.hold = settings_.hold;
  set_timestep(update->dt);
}

// Keeps the suspension where nothing that it is made of has changed: inverses of walls and
// particles take a while.
void LammpsSolver::make_suspension(double max_tilt)
{
  particles.prepare(groups_, survey_);
  biem::Scene scene = make_scene();
  const bool is_same = suspension_ && scene == *scene_;
  if (!is_same) {
    suspension_.reset();    // refers to the scene
    scene_ = std::make_unique<biem::Scene>(std::move(scene));
    has_unknowns_ = scene_->has_unknowns();
  }
  const bool is_new = choose_parameters(max_tilt);
  if (is_same && !is_new) return;
  suspension_ = std::make_unique<biem::Suspension>(
      world, biem::SumParameters{force_parameters_.values(), coupled_parameters_.values()},
      settings_.suspension, *scene_);
}

// Kinds of all surfaces, shapes of the particles, all walls as one mesh.
biem::Scene LammpsSolver::make_scene()
{
  biem::Scene scene;
  scene.shapes = particles.shapes();
  for (int s = 0; s < survey_.n_molecules; s++) {
    biem::Surface surface;
    if (survey_.group[s] >= 0) {
      const SurfaceGroup &group = groups_.surfaces[survey_.group[s]];
      surface = {group.kind, group.viscosity_ratio, particles.shape(s), group.velocity};
    }
    scene.surfaces.push_back(surface);
  }
  node_index_.clear();
  if (scene.has_contrast()) add_connectivities(scene);
  if (scene.has(biem::SurfaceKind::Wall)) add_walls(scene.walls);
  return scene;
}

// Cells with unknowns: numbers of their nodes, triangles; equal cells share the latter.
void LammpsSolver::add_connectivities(biem::Scene &scene)
{
  auto &all = scene.connectivities;
  for (const auto &entry : gather_surfaces(lmp, groups_, biem::SurfaceKind::Cell)) {
    biem::Surface &surface = scene.surfaces[entry.first - 1];
    if (!surface.is_unknown()) continue;
    const GatheredSurface &cell = entry.second;
    for (size_t i = 0; i < cell.tags.size(); i++)
      node_index_[cell.tags[i]] = static_cast<int>(i);
    const auto found = std::find(all.begin(), all.end(), cell.triangles);
    surface.shape = static_cast<int>(found - all.begin());
    if (found == all.end()) all.push_back(cell.triangles);
  }
}

void LammpsSolver::add_walls(biem::WallMesh &walls)
{
  walls.cell = get_cell(lmp);
  for (const auto &entry : gather_surfaces(lmp, groups_, biem::SurfaceKind::Wall)) {
    const GatheredSurface &wall = entry.second;
    const auto first = static_cast<int>(walls.nodes.cols());
    walls.nodes.conservativeResize(3, first + wall.positions.cols());
    for (Eigen::Index i = 0; i < wall.positions.cols(); i++) {
      biem::Vec3 x = wall.positions.col(i);
      domain->remap(x.data());
      walls.nodes.col(first + i) = x;
      node_index_[wall.tags[i]] = first + static_cast<int>(i);
    }
    for (const biem::Triangle &t : wall.triangles)
      walls.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

// Returns whether any parameter is new.
bool LammpsSolver::choose_parameters(double max_tilt)
{
  const Eigen::Map<const biem::Points> points(atom->nlocal > 0 ? atom->x[0] : nullptr, 3,
                                              atom->nlocal);
  const auto is_cell = [](const biem::Surface &s) {
    return s.kind == biem::SurfaceKind::Cell;
  };
  const auto is_unknown = [](const biem::Surface &s) {
    return s.is_unknown();
  };
  const bool has_cells = scene_->has(biem::SurfaceKind::Cell);
  biem::EwaldScene scene = describe_points(max_tilt, has_cells ? is_cell : is_unknown);
  scene.n_targets = static_cast<double>(atom->natoms);
  bool is_new = force_parameters_.choose(scene, points);
  if (has_unknowns_) {
    scene = describe_points(max_tilt, is_unknown);
    scene.layers = scene_->unknown_layers();
    is_new = coupled_parameters_.choose(scene, points) || is_new;
  }
  return is_new;
}

// What the choice of the parameters needs to know of some of the surfaces, as sources and targets:
// nodes and triangles, of which there are 2 n - 4 on a closed surface and 2 n on a periodic one.
biem::EwaldScene LammpsSolver::describe_points(double max_tilt,
                                               bool (*is_in)(const biem::Surface &)) const
{
  biem::EwaldScene scene;
  scene.cell = get_cell(lmp);
  scene.max_tilt = max_tilt;
  double n_bodies = 0.0, radius = 0.0;
  for (size_t s = 0; s < scene_->surfaces.size(); s++) {
    if (!is_in(scene_->surfaces[s])) continue;
    n_bodies += 1.0;
    radius += survey_.volumes[s] > 0.0 ? std::cbrt(survey_.volumes[s] / (4.0 * M_PI / 3.0))
                                       : std::sqrt(survey_.areas[s] / (4.0 * M_PI));
    const double n_nodes = survey_.nodes[s];
    scene.n_targets += n_nodes;
    scene.n_sources += n_nodes + 2.0 * n_nodes - (scene_->surfaces[s].is_closed() ? 4.0 : 0.0);
  }
  if (n_bodies > 0.0) {
    scene.body_sources = scene.n_sources / n_bodies;
    scene.body_radius = radius / n_bodies;
  }
  return scene;
}

double LammpsSolver::expected_error() const
{
  const double forces = force_parameters_.values().expected_error;
  return has_unknowns_ ? std::max(forces, coupled_parameters_.values().expected_error) : forces;
}

void LammpsSolver::set_cutoffs()
{
  const double edge = kEdgeGrowth * survey_.longest_edge;
  list_cutoff_ =
      kListGrowth * (survey_.longest_edge + biem::kNearFactor * survey_.longest_mean_edge);
  set_list_size();
  double cutoff = force_parameters_.values().cutoff;
  if (has_unknowns_) cutoff = std::max(cutoff, coupled_parameters_.values().cutoff);
  const double needed = std::max(list_cutoff_, cutoff + edge) + neighbor->skin;
  const bool is_own = comm->cutghostuser == own_comm_cutoff_;
  if (comm->cutghostuser > 0.0 && !is_own && comm->cutghostuser < needed)
    error->all(FLERR,
               fmt::format("Fix biem: communication cutoff {:.10g} is too small, {:.10g} is needed "
                           "(real-space cutoff, edges and skin); remove 'comm_modify cutoff' so "
                           "that fix biem sets it, or give at least this value. If a restart file "
                           "has brought it from a fix biem of another ID: 'comm_modify cutoff 0.0'",
                           comm->cutghostuser, needed));
  if (comm->cutghostuser >= needed && !is_own) return;
  if (!is_own) user_comm_cutoff_ = comm->cutghostuser;
  comm->cutghostuser = own_comm_cutoff_ = needed;
}

// LAMMPS gives each atom room for a fixed number of neighbors: too few where a fine mesh is close
// to one with long edges, which decide the cutoff.
void LammpsSolver::set_list_size()
{
  double density = 0.0;    // nodes per area of the finest surface
  for (size_t s = 0; s < survey_.areas.size(); s++)
    if (survey_.areas[s] > 0.0) density = std::max(density, survey_.nodes[s] / survey_.areas[s]);
  const double reach = list_cutoff_ + neighbor->skin;
  const double n_neighbors = kSurfacesInReach * M_PI * reach * reach * density;
  if (n_neighbors <= neighbor->oneatom) return;
  neighbor->oneatom = static_cast<int>(n_neighbors);
  neighbor->pgsize = std::max(neighbor->pgsize, 10 * neighbor->oneatom);
}

std::string LammpsSolver::who() const
{
  return "Fix biem: step " + std::to_string(update->ntimestep);
}

std::string LammpsSolver::refresh(NeighList *list)
{
  configuration_->refresh(list);
  struct {
    double reach;
    int molecule;
  } longest = {configuration_->lost_reach(), configuration_->lost_molecule()}, all;
  MPI_Allreduce(&longest, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  if (all.reach == 0.0) return "";
  return fmt::format(
      "molecule {} has a triangle that has stretched beyond the reach of the neighbor "
      "list: it needs {:.4g}, the list has {:.4g}. Either the timestep is too large, "
      "or the membrane too soft for this flow; if it may stretch so far, go on in a "
      "new run, which makes lists for the edges that it finds",
      all.molecule, all.reach, list_cutoff_);
}

biem::Evaluation LammpsSolver::evaluate(const biem::CoupledFields &guess)
{
  suspension_->set_cell(get_cell(lmp), get_origin(lmp));
  biem::Points forces = Eigen::Map<const biem::Points>(atom->f[0], 3, atom->nlocal);
  if (!particles.is_empty()) particles.add_prescribed_loads(groups_, forces);
  return guarded(lmp, who(), [&] {
    biem::Evaluation e =
        suspension_->evaluate(configuration_->get(particles.orientations(survey_.n_molecules)),
                              forces, settings_.conditions, guess, cells_, exchange);
    if (!particles.is_empty()) particles.set_motions(e, settings_.conditions.flow);
    return e;
  });
}

biem::Points LammpsSolver::evaluate_fast()
{
  suspension_->set_cell(get_cell(lmp), get_origin(lmp));
  const Eigen::Map<const biem::Points> forces(atom->f[0], 3, atom->nlocal);
  return guarded(lmp, who(), [&] {
    return suspension_->evaluate_fast(
        configuration_->get(particles.orientations(survey_.n_molecules)), forces, exchange);
  });
}

biem::Points LammpsSolver::evaluate_fast(biem::PointsView slow)
{
  biem::Points velocity = evaluate_fast() + slow;
  guarded(lmp, who(), [&] {
    suspension_->hold(configuration_->get(particles.orientations(survey_.n_molecules)),
                      settings_.conditions.flow, cells_, velocity, exchange);
  });
  return velocity;
}

biem::Points LammpsSolver::compute_hold_correction()
{
  return guarded(lmp, who(), [&] {
    return suspension_->compute_hold_correction(
        configuration_->get(particles.orientations(survey_.n_molecules)), cells_, exchange);
  });
}

double LammpsSolver::volume_error(size_t cell) const
{
  if (scene_->surfaces[cell].kind != biem::SurfaceKind::Cell) return 0.0;
  return std::fabs(cells_.volume[cell] / cells_.reference_volume[cell] - 1.0);
}

double LammpsSolver::volume_error() const
{
  const int worst = worst_volume();
  return worst == 0 ? 0.0 : volume_error(worst - 1);
}

int LammpsSolver::worst_volume() const
{
  size_t worst = 0;
  for (size_t c = 0; c < cells_.volume.size(); c++)
    if (volume_error(c) > volume_error(worst)) worst = c;
  return cells_.volume.empty() ? 0 : static_cast<int>(worst) + 1;
}

std::vector<double> LammpsSolver::get_state() const
{
  std::vector<double> state = {own_comm_cutoff_,
                               static_cast<double>(cells_.reference_volume.size())};
  for (const std::vector<double> &part :
       {cells_.reference_volume, cells_.reference_area, force_parameters_.get_state(),
        coupled_parameters_.get_state(), particles.get_state()})
    state.insert(state.end(), part.begin(), part.end());
  return state;
}

const double *LammpsSolver::set_state(const double *state)
{
  own_comm_cutoff_ = *state++;
  const int n_cells = static_cast<int>(*state++);
  for (std::vector<double> *reference : {&cells_.reference_volume, &cells_.reference_area}) {
    reference->assign(state, state + n_cells);
    state += n_cells;
  }
  for (LammpsParameters *parameters : {&force_parameters_, &coupled_parameters_}) {
    parameters->set_state(state);
    state += LammpsParameters::kStateSize;
  }
  return particles.set_state(state);
}

}    // namespace LAMMPS_NS
