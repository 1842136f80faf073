// Flow solver on LAMMPS' atoms: see the header.
#include "biem_lammps_solver.h"
#include "atom.h"
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

// Edges may grow to this multiple of the longest edge at the start of a run.
constexpr double kEdgeGrowth = 1.6;

// A parameter agrees with what the user fixed; 0 leaves it free.
template <class T> bool is_as_given(T given, T value)
{
  return given == T() || given == value;
}

}    // namespace

LammpsSolver::~LammpsSolver()
{
  if (comm->cutghostuser == own_comm_cutoff_) comm->cutghostuser = user_comm_cutoff_;
}

void LammpsSolver::prepare(const NodeGroups &groups, double max_tilt)
{
  survey_ = survey_meshes(lmp, groups);
  check_lengths();
  keep_volumes();
  groups_ = groups;
  guarded(lmp, "Fix biem", [&] { make_scene(groups); });
  choose_parameters(max_tilt);
  set_cutoffs();
  auto find_index = [this](tagint tag) {
    const auto wall = wall_index_.find(tag);
    return wall == wall_index_.end() ? particles.find_index(tag) : wall->second;
  };
  configuration_ = std::make_unique<LammpsConfiguration>(lmp, groups, find_index, list_cutoff_);
  const double cutoffs[2] = {comm->cutghostuser, list_cutoff_};
  const std::string text = describe_setup(lmp, survey_, parameters_, cutoffs);
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

void LammpsSolver::keep_volumes()
{
  if (volumes_.reference.empty())
    volumes_.reference = survey_.volumes;
  else if (static_cast<int>(volumes_.reference.size()) != survey_.n_molecules)
    error->all(FLERR,
               fmt::format("Fix biem: the number of surfaces has changed from {} to {} since "
                           "the fix was defined; define it anew",
                           volumes_.reference.size(), survey_.n_molecules));
  volumes_.current.resize(survey_.n_molecules);
  set_timestep(update->dt);
}

// Kinds of all surfaces, shapes of the particles, all walls as one mesh.
void LammpsSolver::make_scene(const NodeGroups &groups)
{
  particles.prepare(groups, survey_);
  scene_ = biem::Scene();
  scene_.shapes = particles.shapes();
  bool has_walls = false;
  for (int s = 0; s < survey_.n_molecules; s++) {
    biem::Surface surface;
    if (survey_.group[s] >= 0) {
      const SurfaceGroup &group = groups.surfaces[survey_.group[s]];
      surface = {group.kind, group.viscosity_ratio, particles.shape(s), group.velocity};
      has_walls = has_walls || group.kind == biem::SurfaceKind::Wall;
    }
    scene_.surfaces.push_back(surface);
  }
  wall_index_.clear();
  if (!has_walls) return;
  scene_.walls.cell = get_cell(lmp);
  for (const auto &entry : gather_surfaces(lmp, groups, biem::SurfaceKind::Wall)) {
    const GatheredSurface &wall = entry.second;
    const auto first = static_cast<int>(scene_.walls.nodes.cols());
    scene_.walls.nodes.conservativeResize(3, first + wall.positions.cols());
    for (Eigen::Index i = 0; i < wall.positions.cols(); i++) {
      biem::Vec3 x = wall.positions.col(i);
      domain->remap(x.data());
      scene_.walls.nodes.col(first + i) = x;
      wall_index_[wall.tags[i]] = first + static_cast<int>(i);
    }
    for (const biem::Triangle &t : wall.triangles)
      scene_.walls.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

// Parameters once chosen stay, also through a restart, unless the accuracy or the box changes.
void LammpsSolver::choose_parameters(double max_tilt)
{
  biem::EwaldScene scene;
  scene.cell = get_cell(lmp);
  scene.max_tilt = max_tilt;
  scene.n_sources = static_cast<double>(survey_.n_nodes + survey_.n_triangles);
  scene.n_targets = static_cast<double>(atom->natoms);
  scene.tolerance = settings_.accuracy;
  scene.method = settings_.ewald;
  scene.cutoff = settings_.cutoff;
  scene.splitting = settings_.splitting;
  scene.order = settings_.order;
  scene.grid = settings_.grid;
  if (scene_.has_unknowns() && biem::has_double(scene_.unknown_layers()))
    scene.layers = biem::Layers::Both;
  if (survey_.n_surfaces > 0) {
    double volume = 0.0;
    for (double v : survey_.volumes)
      volume += v / survey_.n_surfaces;
    scene.body_sources = scene.n_sources / survey_.n_surfaces;
    scene.body_radius = std::cbrt(3.0 * volume / (4.0 * M_PI));
  }
  const bool is_chosen =
      parameters_.order > 0 && parameters_.method == scene.method &&
      parameters_.tolerance == scene.tolerance && parameter_lengths_ == scene.cell.diagonal() &&
      parameter_layers_ == scene.layers && is_as_given(settings_.cutoff, parameters_.cutoff) &&
      is_as_given(settings_.splitting, parameters_.splitting) &&
      is_as_given(settings_.order, parameters_.order) &&
      (settings_.grid[0] == 0 || parameters_.grid == settings_.grid);
  suspension_ = guarded(lmp, "Fix biem", [&] {
    if (!is_chosen) parameters_ = choose(scene);
    return std::make_unique<biem::Suspension>(world, parameters_, settings_.suspension, scene_);
  });
  parameter_lengths_ = scene.cell.diagonal();
  parameter_layers_ = scene.layers;
}

biem::EwaldParameters LammpsSolver::choose(const biem::EwaldScene &scene)
{
  if (settings_.tuning == biem::EwaldTuning::Model) return biem::choose_ewald_parameters(scene);
  const Eigen::Map<const biem::Points> points(atom->nlocal > 0 ? atom->x[0] : nullptr, 3,
                                              atom->nlocal);
  const biem::EwaldTimings t = biem::search_ewald_parameters(world, scene, points);
  if (comm->me == 0)
    utils::logmesg(lmp,
                   fmt::format("Fix biem: tuned on this machine: {} choices timed, {:.3g} ms "
                               "per periodic sum, {:.3g} ms with the cost model's choice; "
                               "error of these points {:.2g} times the predicted one\n",
                               t.n_tried, 1e3 * t.seconds, 1e3 * t.model_seconds, t.error_factor));
  return t.fastest;
}

void LammpsSolver::set_cutoffs()
{
  const double edge = kEdgeGrowth * survey_.longest_edge;
  list_cutoff_ = edge + kEdgeGrowth * biem::kNearFactor * survey_.longest_mean_edge;
  const double needed = std::max(list_cutoff_, parameters_.cutoff + edge) + neighbor->skin;
  const bool is_own = comm->cutghostuser == own_comm_cutoff_;
  if (comm->cutghostuser > 0.0 && !is_own && comm->cutghostuser < needed)
    error->all(FLERR, fmt::format("Fix biem: communication cutoff {:.8g} is too small, {:.8g} is "
                                  "needed (real-space cutoff, edges and skin); remove 'comm_modify "
                                  "cutoff' so that fix biem sets it, or give at least this value",
                                  comm->cutghostuser, needed));
  if (comm->cutghostuser >= needed && !is_own) return;
  if (!is_own) user_comm_cutoff_ = comm->cutghostuser;
  comm->cutghostuser = own_comm_cutoff_ = needed;
}

std::string LammpsSolver::who() const
{
  return "Fix biem: step " + std::to_string(update->ntimestep);
}

void LammpsSolver::refresh(NeighList *list)
{
  guarded(lmp, who(), [&] { configuration_->refresh(list); });
}

biem::Evaluation LammpsSolver::evaluate(const biem::CoupledFields &guess)
{
  suspension_->set_cell(get_cell(lmp), get_origin(lmp));
  biem::Points forces = Eigen::Map<const biem::Points>(atom->f[0], 3, atom->nlocal);
  if (!particles.is_empty()) particles.add_prescribed_loads(groups_, forces);
  return guarded(lmp, who(), [&] {
    biem::Evaluation e =
        suspension_->evaluate(configuration_->get(particles.orientations(survey_.n_molecules)),
                              forces, settings_.conditions, guess, volumes_, exchange);
    if (!particles.is_empty()) particles.set_motions(e, settings_.conditions.flow);
    return e;
  });
}

double LammpsSolver::volume_error() const
{
  double largest = 0.0;
  for (size_t c = 0; c < volumes_.reference.size(); c++)
    if (scene_.surfaces[c].kind == biem::SurfaceKind::Cell)
      largest = std::max(largest, std::fabs(volumes_.current[c] / volumes_.reference[c] - 1.0));
  return largest;
}

std::vector<double> LammpsSolver::get_state() const
{
  std::vector<double> state = to_state(parameters_);
  state.insert(state.end(), {own_comm_cutoff_, parameter_lengths_[0], parameter_lengths_[1],
                             parameter_lengths_[2], static_cast<double>(parameter_layers_),
                             static_cast<double>(volumes_.reference.size())});
  state.insert(state.end(), volumes_.reference.begin(), volumes_.reference.end());
  const std::vector<double> bodies = particles.get_state();
  state.insert(state.end(), bodies.begin(), bodies.end());
  return state;
}

const double *LammpsSolver::set_state(const double *state)
{
  parameters_ = to_ewald_parameters(state);
  state += kEwaldStateSize;
  own_comm_cutoff_ = *state++;
  for (int a = 0; a < 3; a++)
    parameter_lengths_[a] = *state++;
  parameter_layers_ = static_cast<biem::Layers>(static_cast<int>(*state++));
  const int n_cells = static_cast<int>(*state++);
  volumes_.reference.assign(state, state + n_cells);
  return particles.set_state(state + n_cells);
}

}    // namespace LAMMPS_NS
