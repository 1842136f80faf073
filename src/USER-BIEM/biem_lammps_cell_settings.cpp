// Parsing of create_cells: see the header.
#include "biem_lammps_cell_settings.h"
#include "biem_error.h"
#include "error.h"
#include "pointers.h"
#include "utils.h"
#include <cmath>
#include <set>

namespace LAMMPS_NS {

namespace {

const double kPi = 3.14159265358979323846;

// The shape's own numbers; 0: not given.
struct ShapeArguments {
  std::string name;
  double radius = 0.0, diameter = 0.0, thickness = 0.0;
  std::string edge;
};

class CellArguments : protected Pointers {
 public:
  CellArguments(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp), narg_(narg), arg_(arg) {}

  CellSettings parse();

 private:
  void parse_keyword(const std::string &keyword);
  bool parse_shape_keyword(const std::string &keyword);
  bool parse_placement(const std::string &keyword);
  void parse_orientation();
  void check_complete();
  std::unique_ptr<biem::Shape> make_shape();

  bool is_done() const { return next_ >= narg_; }
  [[noreturn]] void fail(const std::string &what)
  {
    error->all(FLERR, "create_cells: " + what);
    throw biem::Error("unreachable: LAMMPS' error handler returned");
  }
  std::string word(const std::string &keyword)
  {
    if (is_done()) fail("keyword '" + keyword + "' ends too early: a value is missing");
    return arg_[next_++];
  }
  double number(const std::string &keyword)
  {
    word(keyword);
    return utils::numeric(FLERR, arg_[next_ - 1], false, lmp);
  }
  double positive(const std::string &keyword)
  {
    const double value = number(keyword);
    if (!(value > 0.0) || !std::isfinite(value))
      fail(keyword + " " + std::string(arg_[next_ - 1]) + " must be a positive number");
    return value;
  }
  int integer(const std::string &keyword)
  {
    word(keyword);
    return utils::inumeric(FLERR, arg_[next_ - 1], false, lmp);
  }
  int positive_integer(const std::string &keyword)
  {
    const int value = integer(keyword);
    if (value < 1) fail(keyword + " " + std::to_string(value) + " must be 1 or more");
    return value;
  }

  int narg_;
  char **arg_;
  int next_ = 0;
  std::set<std::string> seen_;
  ShapeArguments shape_;
  CellSettings settings_;
};

CellSettings CellArguments::parse()
{
  shape_.name = word("create_cells");
  if (shape_.name != "rbc" && shape_.name != "sphere" && shape_.name != "platelet")
    fail("unknown shape '" + shape_.name + "': choose rbc, sphere or platelet");
  while (!is_done()) {
    const std::string keyword = arg_[next_++];
    if (!seen_.insert(keyword).second) fail("keyword '" + keyword + "' is given twice");
    parse_keyword(keyword);
  }
  check_complete();
  try {
    settings_.shape = make_shape();
    biem::compute_icosphere_frequency(settings_.n_nodes);
  } catch (const biem::Error &e) {
    fail(e.what());
  }
  return std::move(settings_);
}

void CellArguments::parse_keyword(const std::string &keyword)
{
  if (parse_shape_keyword(keyword) || parse_placement(keyword)) return;
  if (keyword == "nodes") {
    settings_.n_nodes = positive_integer(keyword);
  } else if (keyword == "orientation") {
    parse_orientation();
  } else if (keyword == "roll") {
    settings_.roll = number(keyword) * kPi / 180.0;
  } else if (keyword == "gap") {
    settings_.gap = number(keyword);
    if (!(settings_.gap >= 0.0)) fail("gap must be 0 or a positive length");
  } else if (keyword == "type") {
    settings_.type = positive_integer(keyword);
  } else if (keyword == "angle_type") {
    settings_.angle_type = positive_integer(keyword);
  } else if (keyword == "dihedral_type") {
    settings_.dihedral_type = positive_integer(keyword);
  } else if (keyword == "molecule") {
    settings_.first_molecule = positive_integer(keyword);
  } else if (keyword == "group") {
    settings_.group = word(keyword);
  } else {
    fail("unknown keyword '" + keyword + "': allowed are radius, diameter, thickness, edge, "
         "nodes, single, random, hematocrit, orientation, roll, gap, type, angle_type, "
         "dihedral_type, molecule, group");
  }
}

bool CellArguments::parse_shape_keyword(const std::string &keyword)
{
  const bool is_size_of_round = keyword == "radius";
  const bool is_size_of_disc =
      keyword == "diameter" || keyword == "thickness" || keyword == "edge";
  if (!is_size_of_round && !is_size_of_disc) return false;
  if (is_size_of_round && shape_.name == "platelet")
    fail("radius does not belong to platelet: give diameter and thickness");
  if (is_size_of_disc && shape_.name != "platelet")
    fail(keyword + " does not belong to " + shape_.name + ": give radius");
  if (keyword == "radius") shape_.radius = positive(keyword);
  if (keyword == "diameter") shape_.diameter = positive(keyword);
  if (keyword == "thickness") shape_.thickness = positive(keyword);
  if (keyword == "edge") {
    shape_.edge = word(keyword);
    if (shape_.edge != "spheroid" && shape_.edge != "rounded")
      fail("unknown edge '" + shape_.edge + "': choose spheroid or rounded");
  }
  return true;
}

bool CellArguments::parse_placement(const std::string &keyword)
{
  using Placement = CellSettings::Placement;
  if (keyword != "single" && keyword != "random" && keyword != "hematocrit") return false;
  if (settings_.placement != Placement::None)
    fail("'" + keyword + "' after another placement: give one of single, random, hematocrit");
  if (keyword == "single") {
    settings_.placement = Placement::Single;
    for (int k = 0; k < 3; k++) settings_.center[k] = number("single x y z");
    return true;
  }
  if (keyword == "random") {
    settings_.placement = Placement::Random;
    settings_.n_cells = positive_integer("random count");
  } else {
    settings_.placement = Placement::Hematocrit;
    settings_.hematocrit = positive(keyword);
    if (settings_.hematocrit >= 1.0)
      fail("hematocrit " + std::to_string(settings_.hematocrit) +
           " must be below 1: it is a volume fraction, not a percentage");
  }
  settings_.seed = positive_integer("seed of " + keyword);
  return true;
}

void CellArguments::parse_orientation()
{
  const std::string first = word("orientation");
  if (first == "random") {
    settings_.orientation = CellSettings::Orientation::Random;
    return;
  }
  next_--;
  settings_.orientation = CellSettings::Orientation::Axis;
  for (int k = 0; k < 3; k++) settings_.axis[k] = number("orientation ex ey ez");
  if (!(settings_.axis.norm() > 0.0)) fail("orientation 0 0 0 is no direction");
}

void CellArguments::check_complete()
{
  using Placement = CellSettings::Placement;
  using Orientation = CellSettings::Orientation;
  if (settings_.n_nodes == 0)
    fail("keyword nodes is missing: give the nodes per cell, 10 f^2 + 2, e.g. nodes 642");
  if (settings_.placement == Placement::None)
    fail("a placement is missing: give 'single x y z', 'random count seed' or "
         "'hematocrit fraction seed'");
  const bool is_single = settings_.placement == Placement::Single;
  if (is_single && settings_.orientation == Orientation::Random)
    fail("orientation random needs a seed: place the cell with 'random 1 seed' or give its axis");
  if (settings_.orientation == Orientation::Default)
    settings_.orientation = is_single ? Orientation::Axis : Orientation::Random;
  if (seen_.count("roll") && settings_.orientation == Orientation::Random)
    fail("roll turns a cell about a given axis: give 'orientation ex ey ez' as well");
  if (shape_.name == "platelet" && (shape_.diameter == 0.0 || shape_.thickness == 0.0))
    fail("platelet needs diameter and thickness");
}

std::unique_ptr<biem::Shape> CellArguments::make_shape()
{
  if (shape_.name == "platelet")
    return shape_.edge == "rounded" ? biem::make_rounded_disc(shape_.diameter, shape_.thickness)
                                    : biem::make_spheroid(shape_.diameter, shape_.thickness);
  const double radius = shape_.radius > 0.0 ? shape_.radius : 1.0;
  return shape_.name == "rbc" ? biem::make_red_cell(radius) : biem::make_sphere(radius);
}

}    // namespace

CellSettings parse_create_cells(LAMMPS *lmp, int narg, char **arg)
{
  return CellArguments(lmp, narg, arg).parse();
}

}    // namespace LAMMPS_NS
