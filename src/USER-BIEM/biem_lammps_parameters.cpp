// Parameters of a periodic sum: see the header.
#include "biem_lammps_parameters.h"
#include "comm.h"
#include "fmt/format.h"
#include "utils.h"

namespace LAMMPS_NS {

namespace {

// A parameter agrees with what the user fixed; 0 leaves it free.
template <class T> bool is_as_given(T given, T value)
{
  return given == T() || given == value;
}

}    // namespace

bool LammpsParameters::choose(biem::EwaldScene scene, biem::PointsView points)
{
  scene.tolerance = settings_.accuracy;
  scene.method = settings_.ewald;
  scene.cutoff = settings_.cutoff;
  scene.splitting = settings_.splitting;
  scene.order = settings_.order;
  scene.grid = settings_.grid;
  if (is_still_valid(scene)) return false;
  values_ = settings_.tuning == biem::EwaldTuning::Model ? biem::choose_ewald_parameters(scene)
                                                         : search(scene, points);
  lengths_ = scene.cell.diagonal();
  layers_ = scene.layers;
  return true;
}

bool LammpsParameters::is_still_valid(const biem::EwaldScene &scene) const
{
  return values_.order > 0 && values_.method == scene.method &&
         values_.tolerance == scene.tolerance && lengths_ == scene.cell.diagonal() &&
         layers_ == scene.layers && is_as_given(settings_.cutoff, values_.cutoff) &&
         is_as_given(settings_.splitting, values_.splitting) &&
         is_as_given(settings_.order, values_.order) &&
         (settings_.grid[0] == 0 || values_.grid == settings_.grid);
}

biem::EwaldParameters LammpsParameters::search(const biem::EwaldScene &scene,
                                               biem::PointsView points) const
{
  const biem::EwaldTimings t = biem::search_ewald_parameters(world, scene, points);
  if (comm->me == 0)
    utils::logmesg(lmp,
                   fmt::format("Fix biem: tuned on this machine: {} choices timed, {:.3g} ms "
                               "per periodic sum, {:.3g} ms with the cost model's choice; "
                               "error of these points {:.2g} times the predicted one\n",
                               t.n_tried, 1e3 * t.seconds, 1e3 * t.model_seconds, t.error_factor));
  return t.fastest;
}

std::vector<double> LammpsParameters::get_state() const
{
  const biem::EwaldParameters &p = values_;
  std::vector<double> state = {
      static_cast<double>(p.method), p.cutoff,    p.splitting,     p.band_limit, p.oversampling,
      static_cast<double>(p.order),  p.tolerance, p.expected_error};
  for (int a = 0; a < 3; a++) {
    state.push_back(static_cast<double>(p.grid[a]));
    state.push_back(static_cast<double>(p.modes[a]));
    state.push_back(lengths_[a]);
  }
  state.push_back(static_cast<double>(layers_));
  return state;
}

void LammpsParameters::set_state(const double *state)
{
  biem::EwaldParameters &p = values_;
  p.method = static_cast<biem::EwaldMethod>(static_cast<int>(state[0]));
  p.cutoff = state[1];
  p.splitting = state[2];
  p.band_limit = state[3];
  p.oversampling = state[4];
  p.order = static_cast<int>(state[5]);
  p.tolerance = state[6];
  p.expected_error = state[7];
  for (int a = 0; a < 3; a++) {
    p.grid[a] = static_cast<int>(state[8 + 3 * a]);
    p.modes[a] = static_cast<int>(state[9 + 3 * a]);
    lengths_[a] = state[10 + 3 * a];
  }
  layers_ = static_cast<biem::Layers>(static_cast<int>(state[17]));
}

}    // namespace LAMMPS_NS
