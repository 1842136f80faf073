// Parsing of fix biem: see the header.
#include "biem_lammps_settings.h"
#include "biem_error.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps.h"
#include "pointers.h"
#include "update.h"
#include "utils.h"
#include <cmath>
#include <map>
#include <set>

namespace LAMMPS_NS {

namespace {

// Keywords that may be given more than once.
const std::set<std::string> kRepeatable = {"cells", "rigid", "wall"};
// Residual of the coupled system, of the accuracy that the periodic sum is asked for.
constexpr double kSolverShare = 0.1;

constexpr double kLeastTolerance = 1e-14;
constexpr int kMostGridPoints = 4096;    // along one axis
constexpr int kMostIterations = 10000;
constexpr int kMostInterval = 1000000000;    // steps

// A cursor over the arguments that knows how to complain.
class Arguments : protected Pointers {
 public:
  Arguments(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp), narg_(narg), arg_(arg), next_(3) {}

  bool is_done() const { return next_ >= narg_; }
  std::string word(const std::string &keyword)
  {
    if (is_done())
      error->all(FLERR, "Fix biem: keyword '" + keyword +
                            "' ends too early: a value is missing (see the page of fix biem)");
    return arg_[next_++];
  }
  bool yes_or_no(const std::string &keyword)
  {
    const std::string answer = word(keyword);
    if (answer != "yes" && answer != "no") fail(keyword + " " + answer + ": choose yes or no");
    return answer == "yes";
  }
  // Takes the next word if it is this one.
  bool takes(const std::string &option)
  {
    if (is_done() || option != arg_[next_]) return false;
    next_++;
    return true;
  }
  double number(const std::string &keyword)
  {
    const std::string text = word(keyword);
    const double value = utils::numeric(FLERR, arg_[next_ - 1], false, lmp);
    if (!std::isfinite(value)) fail(keyword + " " + text + " is not a finite number");
    return value;
  }
  double positive(const std::string &keyword)
  {
    const double value = number(keyword);
    if (!(value > 0.0))
      fail(keyword + " " + std::string(arg_[next_ - 1]) + " must be a positive number");
    return value;
  }
  int integer(const std::string &keyword, int low, int high)
  {
    const std::string text = word(keyword);
    const int value = utils::inumeric(FLERR, arg_[next_ - 1], false, lmp);
    if (value < low || value > high)
      fail(keyword + " " + text + " is out of range: allowed are integers from " +
           std::to_string(low) + " to " + std::to_string(high));
    return value;
  }
  std::string group_name(const std::string &keyword)
  {
    const std::string name = word(keyword);
    if (group->find(name.c_str()) < 0)
      fail("group '" + name + "' after keyword '" + keyword +
           "' does not exist: define it with the group command first");
    return name;
  }
  biem::Vec3 vector(const std::string &keyword)
  {
    biem::Vec3 value;
    for (int a = 0; a < 3; a++)
      value[a] = number(keyword);
    return value;
  }
  [[noreturn]] void fail(const std::string &what) { error->all(FLERR, "Fix biem: " + what); }

 private:
  int narg_;
  char **arg_;
  int next_;
};

void parse_flow(Arguments &arguments, FixBiemSettings &s)
{
  const std::string kind = arguments.word("flow");
  if (kind == "none") {
    s.flow = FixBiemSettings::Flow::None;
  } else if (kind == "mean") {
    s.flow = FixBiemSettings::Flow::Mean;
    s.conditions.flow.mean = arguments.vector("flow mean");
  } else if (kind == "pressure/drop") {
    s.flow = FixBiemSettings::Flow::PressureDrop;
    s.suspension.drive = biem::Drive::PressureDrop;
    s.conditions.pressure_drop = arguments.vector("flow pressure/drop");
  } else if (kind == "shear") {
    const std::string plane = arguments.word("flow shear");
    if (plane != "xz")
      arguments.fail("flow shear " + plane +
                     ": the shear is u = (rate z, 0, 0), so only 'shear xz <rate>' is allowed");
    s.flow = FixBiemSettings::Flow::Shear;
    s.conditions.flow.set_shear(arguments.number("flow shear xz"));
  } else {
    arguments.fail("unknown flow '" + kind +
                   "': choose none, mean ux uy uz, pressure/drop gx gy gz, or shear xz rate");
  }
}

SurfaceGroup parse_surfaces(Arguments &arguments, const std::string &keyword)
{
  SurfaceGroup g;
  g.name = arguments.group_name(keyword);
  if (keyword == "cells") {
    if (arguments.takes("viscosity/ratio"))
      g.viscosity_ratio = arguments.positive("viscosity/ratio");
  } else if (keyword == "wall") {
    g.kind = biem::SurfaceKind::Wall;
    if (arguments.takes("velocity")) g.velocity = arguments.vector("wall velocity");
  } else {
    g.kind = biem::SurfaceKind::Rigid;
    if (arguments.takes("force")) g.force = arguments.vector("rigid force");
    if (arguments.takes("torque")) g.torque = arguments.vector("rigid torque");
  }
  return g;
}

// The part of the atoms that no keyword names are cells, unless cells are named.
void complete_surfaces(Arguments &arguments, bool has_ratio, double ratio, FixBiemSettings &s)
{
  std::set<std::string> names;
  bool has_cells = false;
  for (const SurfaceGroup &g : s.surfaces) {
    if (!names.insert(g.name).second)
      arguments.fail("group '" + g.name + "' is named twice: each group has one kind of surfaces");
    has_cells = has_cells || g.kind == biem::SurfaceKind::Cell;
  }
  for (const std::string &points : {s.tracers, s.probes})
    if (!points.empty() && !names.insert(points).second)
      arguments.fail("group '" + points +
                     "' is named twice: its atoms are either on surfaces, or "
                     "tracers, or probes");
  if (has_cells && has_ratio)
    arguments.fail("viscosity/ratio stands alone, but cells are named: give it after the group, "
                   "'cells <group> viscosity/ratio <ratio>'");
  if (has_cells) return;
  SurfaceGroup rest;
  rest.viscosity_ratio = ratio;
  s.surfaces.push_back(rest);
}

void parse_solver_keyword(Arguments &arguments, const std::string &keyword, FixBiemSettings &s)
{
  if (keyword == "solver/tolerance") {
    const double tolerance = arguments.positive(keyword);
    if (tolerance >= 1.0 || tolerance < kLeastTolerance)
      arguments.fail(fmt::format("solver/tolerance {:.8g} is out of range: it must be less than 1 "
                                 "and at least {:g}, where rounding errors begin",
                                 tolerance, kLeastTolerance));
    s.suspension.control.tolerance = tolerance;
  } else {
    s.suspension.control.max_iterations = arguments.integer(keyword, 1, kMostIterations);
  }
}

// Ratios are at least 1; "off" leaves what cannot be computed with.
void parse_watch(Arguments &arguments, biem::WatchLimits &w)
{
  if (arguments.takes("off")) {
    w.edge_stretch = w.area_stretch = INFINITY;
    w.fold_cosine = -2.0;
    w.crossing_interval = 0;
    return;
  }
  auto take_ratio = [&](const std::string &name, double &ratio) {
    if (!arguments.takes(name)) return false;
    ratio = arguments.number("watch " + name);
    if (!(ratio > 1.0))
      arguments.fail(fmt::format("watch {} {:.6g}: the largest ratio to the reference must be "
                                 "larger than 1",
                                 name, ratio));
    return true;
  };
  bool has_any = false, has_more = true;
  for (; has_more; has_any = has_any || has_more) {
    has_more = take_ratio("edge", w.edge_stretch) || take_ratio("area", w.area_stretch);
    if (!has_more && arguments.takes("crossings")) {
      w.crossing_interval = arguments.integer("watch crossings", 0, kMostInterval);
      has_more = true;
    }
  }
  if (!has_any)
    arguments.fail("keyword 'watch' needs off, or any of: edge ratio, area ratio, crossings "
                   "interval");
}

void parse_keyword(Arguments &arguments, const std::string &keyword, FixBiemSettings &s)
{
  if (keyword == "viscosity") {
    s.viscosity = arguments.positive(keyword);
  } else if (keyword == "accuracy") {
    s.accuracy = arguments.positive(keyword);
  } else if (keyword == "flow") {
    parse_flow(arguments, s);
  } else if (keyword == "cutoff") {
    s.cutoff = arguments.positive(keyword);
  } else if (keyword == "splitting") {
    s.splitting = arguments.positive(keyword);
  } else if (keyword == "order") {
    s.order = arguments.integer(keyword, biem::kMinWindowOrder, biem::kMaxWindowOrder);
  } else if (keyword == "grid") {
    for (int &n : s.grid)
      n = arguments.integer(keyword, 4, kMostGridPoints);
  } else if (kRepeatable.count(keyword)) {
    s.surfaces.push_back(parse_surfaces(arguments, keyword));
  } else if (keyword == "probes") {
    s.probes = arguments.group_name(keyword);
  } else if (keyword == "solver/tolerance" || keyword == "solver/iterations") {
    parse_solver_keyword(arguments, keyword, s);
  } else if (keyword == "tracers") {
    s.tracers = arguments.group_name(keyword);
  } else if (keyword == "stepper") {
    s.stepper = biem::parse_stepper(arguments.word(keyword));
  } else if (keyword == "error/tolerance") {
    s.error_tolerance = arguments.positive(keyword);
  } else if (keyword == "multirate") {
    s.is_multirate = arguments.yes_or_no(keyword);
  } else if (keyword == "hold") {
    s.hold = biem::parse_hold(arguments.word(keyword));
  } else if (keyword == "watch") {
    parse_watch(arguments, s.watch);
  } else if (keyword == "traction") {
    s.suspension.traction = biem::parse_traction(arguments.word(keyword));
  } else if (keyword == "ewald") {
    s.ewald = biem::parse_ewald_method(arguments.word(keyword));
  } else if (keyword == "tune") {
    s.tuning = biem::parse_ewald_tuning(arguments.word(keyword));
  } else {
    arguments.fail(
        "unknown keyword '" + keyword +
        "': allowed are viscosity, accuracy, flow, viscosity/ratio, cells, rigid, wall, tracers, "
        "probes, stepper, error/tolerance, multirate, hold, watch, traction, solver/tolerance, "
        "solver/iterations, ewald, tune, cutoff, "
        "splitting, order, grid");
  }
}

}    // namespace

FixBiemSettings parse_fix_biem(LAMMPS *lmp, int narg, char **arg)
{
  FixBiemSettings s;
  Arguments arguments(lmp, narg, arg);
  std::set<std::string> given;
  double ratio = 1.0;
  while (!arguments.is_done()) {
    const std::string keyword = arguments.word("fix biem");
    if (!given.insert(keyword).second && !kRepeatable.count(keyword))
      arguments.fail("keyword '" + keyword + "' is given twice" +
                     (keyword == "flow" ? ": the flow is driven in one way, for instance by a mean "
                                          "velocity or by a pressure drop"
                                        : ""));
    try {
      if (keyword == "viscosity/ratio")
        ratio = arguments.positive(keyword);
      else
        parse_keyword(arguments, keyword, s);
    } catch (const biem::Error &e) {
      arguments.fail(e.what());
    }
  }
  for (const char *needed : {"viscosity", "accuracy", "flow"})
    if (!given.count(needed))
      arguments.fail(std::string("keyword '") + needed +
                     "' is missing: fix ID group biem viscosity mu accuracy tolerance flow ...");
  if (s.stepper != biem::Stepper::RungeKuttaChebyshev2 &&
      (s.error_tolerance > 0.0 || s.is_multirate))
    arguments.fail("error/tolerance and multirate need stepper rkc2");
  complete_surfaces(arguments, given.count("viscosity/ratio") > 0, ratio, s);
  if (!given.count("solver/tolerance")) s.suspension.control.tolerance = kSolverShare * s.accuracy;
  s.suspension.viscosity = s.viscosity * viscosity_factor(lmp);
  return s;
}

double viscosity_factor(LAMMPS *lmp)
{
  // Poise -> force * time / length^2 through LAMMPS' own pressure conversion nktv2p:
  // 0.1 Pa s in units of (pressure unit) * (time unit), divided by nktv2p.
  const std::string style = lmp->update->unit_style;
  const double nktv2p = lmp->force->nktv2p;
  if (style == "real") return 0.1 / 101325.0 * 1e15 / nktv2p;    // atm, fs
  if (style == "metal") return 0.1 / 1e5 * 1e12 / nktv2p;        // bar, ps
  if (style == "electron")
    lmp->error->all(FLERR, "Fix biem: units electron has no unit of viscosity; use lj, si, cgs, "
                           "micro, nano, real or metal");
  return 1.0;
}

}    // namespace LAMMPS_NS
