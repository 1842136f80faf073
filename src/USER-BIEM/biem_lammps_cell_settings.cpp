// Parsing of create_cells: see the header.
#include "biem_lammps_cell_settings.h"
#include "biem_error.h"
#include <cmath>
#include <map>

namespace LAMMPS_NS {

namespace {

const double kPi = 3.14159265358979323846;

constexpr double kBeadRadius = 0.532;    // diameter 3 um, in radii of a red cell of 2.82 um

// The shape's own numbers; 0: not given.
struct ShapeArguments {
  std::string name;
  double radius = 0.0, diameter = 0.0, thickness = 0.0;
  std::string edge;
};

// Which keywords give the size of which shape.
const std::map<std::string, std::string> kSizeKeywords = {{"rbc", "radius"},
                                                          {"sphere", "radius"},
                                                          {"platelet", "diameter thickness edge"},
                                                          {"bead", "radius diameter"},
                                                          {"mesh", "radius scale"}};

class CellArguments : public CommandArguments {
 public:
  CellArguments(LAMMPS *lmp, int narg, char **arg) :
      CommandArguments(lmp, "create_cells", narg, arg)
  {
  }

  CellSettings parse();

 private:
  void parse_keyword(const std::string &keyword);
  bool parse_shape_keyword(const std::string &keyword);
  bool parse_placement(const std::string &keyword);
  void parse_orientation();
  void check_complete();
  void check_size();
  std::unique_ptr<biem::Shape> make_shape();

  ShapeArguments shape_;
  CellSettings settings_;
};

CellSettings CellArguments::parse()
{
  shape_.name = word("create_cells");
  if (!kSizeKeywords.count(shape_.name))
    fail("unknown shape '" + shape_.name + "': choose rbc, sphere, platelet, bead or mesh");
  if (shape_.name == "mesh") settings_.mesh_file = word("mesh");
  while (!is_done())
    parse_keyword(keyword());
  check_complete();
  check_size();
  if (shape_.name == "mesh") return std::move(settings_);
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
  if (parse_shape_keyword(keyword) || parse_placement(keyword) ||
      parse_label(keyword, settings_.labels))
    return;
  if (keyword == "nodes") {
    settings_.n_nodes = positive_integer(keyword);
  } else if (keyword == "orientation") {
    parse_orientation();
  } else if (keyword == "roll") {
    settings_.roll = number(keyword) * kPi / 180.0;
  } else if (keyword == "gap") {
    settings_.gap = number(keyword);
    if (!(settings_.gap >= 0.0)) fail("gap must be 0 or a positive length");
  } else if (keyword == "dihedral_type") {
    settings_.dihedral_type = positive_integer(keyword);
  } else {
    fail("unknown keyword '" + keyword +
         "': allowed are radius, diameter, thickness, edge, scale, "
         "nodes, single, random, hematocrit, orientation, roll, gap, type, angle_type, "
         "dihedral_type, molecule, group");
  }
}

bool CellArguments::parse_shape_keyword(const std::string &keyword)
{
  if (keyword != "radius" && keyword != "diameter" && keyword != "thickness" && keyword != "edge" &&
      keyword != "scale")
    return false;
  const std::string &own = kSizeKeywords.at(shape_.name);
  if (own.find(keyword) == std::string::npos)
    fail(keyword + " does not belong to " + shape_.name + ", which takes: " + own);
  if (keyword == "radius") shape_.radius = positive(keyword);
  if (keyword == "scale") settings_.mesh_scale = positive(keyword);
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
    for (int k = 0; k < 3; k++)
      settings_.center[k] = number("single x y z");
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
  step_back();
  settings_.orientation = CellSettings::Orientation::Axis;
  for (int k = 0; k < 3; k++)
    settings_.axis[k] = number("orientation ex ey ez");
  if (!(settings_.axis.norm() > 0.0)) fail("orientation 0 0 0 is no direction");
}

void CellArguments::check_complete()
{
  using Placement = CellSettings::Placement;
  using Orientation = CellSettings::Orientation;
  if (settings_.n_nodes == 0 && shape_.name != "mesh")
    fail("keyword nodes is missing: give the nodes per cell, 10 f^2 + 2, e.g. nodes 642");
  if (settings_.placement == Placement::None)
    fail("a placement is missing: give 'single x y z', 'random count seed' or "
         "'hematocrit fraction seed'");
  const bool is_single = settings_.placement == Placement::Single;
  if (is_single && settings_.orientation == Orientation::Random)
    fail("orientation random needs a seed: place the cell with 'random 1 seed' or give its axis");
  if (settings_.orientation == Orientation::Default)
    settings_.orientation = is_single ? Orientation::Axis : Orientation::Random;
  if (has("roll") && settings_.orientation == Orientation::Random)
    fail("roll turns a cell about a given axis: give 'orientation ex ey ez' as well");
}

void CellArguments::check_size()
{
  if (shape_.name == "bead" && shape_.radius > 0.0 && shape_.diameter > 0.0)
    fail("both radius and diameter are given: give one of them");
  if (shape_.name == "platelet" && (shape_.diameter == 0.0 || shape_.thickness == 0.0))
    fail("platelet needs diameter and thickness");
  if (shape_.name != "mesh") return;
  if (settings_.placement != CellSettings::Placement::Single)
    fail("a mesh from a file can be placed with 'single x y z' only: random placement knows bodies "
         "of revolution; repeat the command for each body");
  if (settings_.n_nodes > 0) fail("nodes does not belong to mesh: the file has its own");
  if (has("radius") && has("scale")) fail("both radius and scale are given: give one of them");
  settings_.mesh_radius = shape_.radius;
}

std::unique_ptr<biem::Shape> CellArguments::make_shape()
{
  if (shape_.name == "platelet")
    return shape_.edge == "rounded" ? biem::make_rounded_disc(shape_.diameter, shape_.thickness)
                                    : biem::make_spheroid(shape_.diameter, shape_.thickness);
  if (shape_.name == "bead") {
    const double radius = shape_.diameter > 0.0 ? 0.5 * shape_.diameter : shape_.radius;
    return biem::make_sphere(radius > 0.0 ? radius : kBeadRadius);
  }
  const double radius = shape_.radius > 0.0 ? shape_.radius : 1.0;
  return shape_.name == "rbc" ? biem::make_red_cell(radius) : biem::make_sphere(radius);
}

}    // namespace

CellSettings parse_create_cells(LAMMPS *lmp, int narg, char **arg)
{
  return CellArguments(lmp, narg, arg).parse();
}

}    // namespace LAMMPS_NS
