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

// Keywords that belong to the full boundary-integral equation but are not part of this version.
const std::map<std::string, std::string> kRefused = {
    {"viscosity/ratio", "cells have the viscosity of the suspending fluid (ratio 1)"},
    {"rigid", "rigid particles are not available: make every surface a deformable cell"},
    {"wall", "walls are not available: the box is periodic in x, y and z"},
    {"probes", "use 'tracers' with 'run 0' for velocities at given points"}};

constexpr int kMostGridPoints = 4096;    // along one axis

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
  void fail(const std::string &what) { error->all(FLERR, "Fix biem: " + what); }

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
    for (int a = 0; a < 3; a++)
      s.background.mean[a] = arguments.number("flow mean");
  } else if (kind == "shear") {
    const std::string plane = arguments.word("flow shear");
    if (plane != "xz")
      arguments.fail("flow shear " + plane +
                     ": the shear is u = (rate z, 0, 0), so only 'shear xz <rate>' is allowed");
    s.flow = FixBiemSettings::Flow::Shear;
    s.background.shear_rate = arguments.number("flow shear xz");
  } else {
    arguments.fail("unknown flow '" + kind + "': choose none, mean ux uy uz, or shear xz rate");
  }
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
  } else if (keyword == "cells") {
    s.cells = arguments.group_name(keyword);
  } else if (keyword == "tracers") {
    s.tracers = arguments.group_name(keyword);
  } else if (keyword == "stepper") {
    s.stepper = biem::parse_stepper(arguments.word(keyword));
  } else if (keyword == "traction") {
    s.suspension.traction = biem::parse_traction(arguments.word(keyword));
  } else if (keyword == "ewald") {
    s.ewald = biem::parse_ewald_method(arguments.word(keyword));
  } else if (keyword == "tune") {
    s.tuning = biem::parse_ewald_tuning(arguments.word(keyword));
  } else if (kRefused.count(keyword)) {
    arguments.fail("keyword '" + keyword +
                   "' is not part of this version: " + kRefused.at(keyword));
  } else {
    arguments.fail(
        "unknown keyword '" + keyword +
        "': allowed are viscosity, accuracy, flow, cells, tracers, stepper, traction, ewald, "
        "tune, "
        "cutoff, splitting, order, grid");
  }
}

}    // namespace

FixBiemSettings parse_fix_biem(LAMMPS *lmp, int narg, char **arg)
{
  FixBiemSettings s;
  Arguments arguments(lmp, narg, arg);
  std::set<std::string> given;
  while (!arguments.is_done()) {
    const std::string keyword = arguments.word("fix biem");
    if (!given.insert(keyword).second) arguments.fail("keyword '" + keyword + "' is given twice");
    try {
      parse_keyword(arguments, keyword, s);
    } catch (const biem::Error &e) {
      arguments.fail(e.what());
    }
  }
  for (const char *needed : {"viscosity", "accuracy", "flow"})
    if (!given.count(needed))
      arguments.fail(std::string("keyword '") + needed +
                     "' is missing: fix ID group biem viscosity mu accuracy tolerance flow ...");
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
