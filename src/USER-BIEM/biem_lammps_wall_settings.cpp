// Parsing of create_wall: see the header.
#include "biem_lammps_wall_settings.h"
#include <utility>

namespace LAMMPS_NS {

namespace {

class WallArguments : public CommandArguments {
 public:
  WallArguments(LAMMPS *lmp, int narg, char **arg) : CommandArguments(lmp, "create_wall", narg, arg)
  {
  }

  WallSettings parse();

 private:
  using Shape = WallSettings::Shape;

  void parse_shape();
  void parse_keyword(const std::string &name);
  bool parse_lattice_keyword(const std::string &name);
  bool parse_file_keyword(const std::string &name);
  biem::Axis parse_axis(const std::string &name);
  void check_complete();

  WallSettings settings_;
  std::string shape_;
};

WallSettings WallArguments::parse()
{
  parse_shape();
  while (!is_done())
    parse_keyword(keyword());
  check_complete();
  return settings_;
}

biem::Axis WallArguments::parse_axis(const std::string &name)
{
  const std::string axis = word(name);
  if (axis != "x" && axis != "y" && axis != "z")
    fail("unknown axis '" + axis + "' after " + name + ": choose x, y or z");
  return static_cast<biem::Axis>(axis[0] - 'x');
}

void WallArguments::parse_shape()
{
  shape_ = word("create_wall");
  if (shape_ == "plane") {
    settings_.shape = Shape::Plane;
    settings_.axis = parse_axis("plane");
    settings_.first = number("plane axis coordinate");
  } else if (shape_ == "duct") {
    settings_.shape = Shape::Duct;
    settings_.first = number("duct c1 c2");
    settings_.second = number("duct c1 c2");
  } else if (shape_ == "tube") {
    settings_.shape = Shape::Tube;
  } else if (shape_ == "mesh") {
    settings_.shape = Shape::Mesh;
    settings_.file = word("mesh");
  } else {
    fail("unknown shape '" + shape_ + "': choose plane, duct, tube or mesh");
  }
}

void WallArguments::parse_keyword(const std::string &name)
{
  if (parse_label(name, settings_.labels) || parse_lattice_keyword(name) ||
      parse_file_keyword(name))
    return;
  fail("unknown keyword '" + name +
       "': allowed are edge, axis, radius, center, scale, move, type, "
       "angle_type, molecule, group");
}

bool WallArguments::parse_lattice_keyword(const std::string &name)
{
  if (name != "edge" && name != "axis" && name != "radius" && name != "center") return false;
  const bool is_of_tube = name == "radius" || name == "center";
  if (settings_.shape == Shape::Mesh || (is_of_tube && settings_.shape != Shape::Tube) ||
      (name == "axis" && settings_.shape == Shape::Plane))
    fail(name + " does not belong to " + shape_);
  if (name == "edge") settings_.edge = positive(name);
  if (name == "axis") settings_.axis = parse_axis(name);
  if (name == "radius") settings_.radius = positive(name);
  if (name == "center") {
    settings_.first = number("center c1 c2");
    settings_.second = number("center c1 c2");
  }
  return true;
}

bool WallArguments::parse_file_keyword(const std::string &name)
{
  if (name != "scale" && name != "move") return false;
  if (settings_.shape != Shape::Mesh) fail(name + " does not belong to " + shape_);
  if (name == "scale") settings_.scale = positive(name);
  if (name == "move")
    for (int k = 0; k < 3; k++)
      settings_.shift[k] = number("move dx dy dz");
  return true;
}

void WallArguments::check_complete()
{
  if (settings_.shape != Shape::Mesh && !has("edge"))
    fail("keyword edge is missing: give the largest distance of neighboring nodes");
  if (settings_.shape == Shape::Tube && (!has("radius") || !has("center")))
    fail("tube needs radius and center");
  // about y the cyclic order is z, x; coordinates are given as x, z
  if (settings_.axis == biem::Axis::Y && settings_.shape != Shape::Plane)
    std::swap(settings_.first, settings_.second);
}

}    // namespace

WallSettings parse_create_wall(LAMMPS *lmp, int narg, char **arg)
{
  return WallArguments(lmp, narg, arg).parse();
}

}    // namespace LAMMPS_NS
