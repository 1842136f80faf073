// Meridian curves of the bodies and the mapping of the icosphere to them.
// Knows nothing of position, orientation, LAMMPS or mechanics.
#include "biem_mesh_shape.h"

#include "biem_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

namespace biem {
namespace {

const double pi = 3.14159265358979323846;

std::string format(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

void require_positive(const std::string &shape, const std::string &what, double value)
{
  if (!(value > 0.0) || !std::isfinite(value))
    throw Error("Shape " + shape + ": " + what + " is " + format(value) +
                " but must be a positive length");
}

class RedCell : public Shape {
 public:
  explicit RedCell(double radius) : radius_(radius) { require_positive("rbc", "radius", radius); }

  // Zhao et al. 2012, Section II: rho = alpha sin(phi),
  // z = (alpha/2) (0.207 + 2.003 sin^2 - 1.123 sin^4) cos(phi), volume 4 pi/3
  MeridianPoint compute_meridian_point(double theta) const override
  {
    const double s = std::sin(theta), s2 = s * s;
    const double half_size = 0.5 * alpha_ * radius_;
    return {2.0 * half_size * s,
            half_size * (0.207 + 2.003 * s2 - 1.123 * s2 * s2) * std::cos(theta)};
  }

  double compute_volume() const override { return 4.0 * pi / 3.0 * std::pow(radius_, 3); }
  std::string describe() const override
  {
    return "red cell of equivalent radius " + format(radius_);
  }

 private:
  static constexpr double alpha_ = 1.3858189;
  double radius_;
};

class Sphere : public Shape {
 public:
  explicit Sphere(double radius) : radius_(radius) { require_positive("sphere", "radius", radius); }

  MeridianPoint compute_meridian_point(double theta) const override
  {
    return {radius_ * std::sin(theta), radius_ * std::cos(theta)};
  }

  double compute_volume() const override { return 4.0 * pi / 3.0 * std::pow(radius_, 3); }
  std::string describe() const override { return "sphere of radius " + format(radius_); }

 private:
  double radius_;
};

// A convex disc-like body meshed evenly along its meridian: equal steps of the polar angle are
// equal arc lengths, because the polar angle of a thin body itself leaves the rim without nodes.
class Disc : public Shape {
 public:
  Disc(const std::string &name, double diameter, double thickness) :
      name_(name), radius_(0.5 * diameter), half_thickness_(0.5 * thickness)
  {
    require_positive(name, "diameter", diameter);
    require_positive(name, "thickness", thickness);
    if (thickness > diameter)
      throw Error("Shape " + name + ": thickness " + format(thickness) + " exceeds the diameter " +
                  format(diameter) + "; exchange them, or make the body flatter");
  }

  std::string describe() const override
  {
    return name_ + " of diameter " + format(2.0 * radius_) + " and thickness " +
        format(2.0 * half_thickness_);
  }

 protected:
  std::string name_;
  double radius_, half_thickness_;
};

class Spheroid : public Disc {
 public:
  Spheroid(double diameter, double thickness) : Disc("spheroid", diameter, thickness)
  {
    // midpoint rule for the arc length from the pole to the equator
    arc_.resize(n_steps_ + 1, 0.0);
    const double step = 0.5 * pi / n_steps_;
    for (int i = 0; i < n_steps_; i++) {
      const double t = (i + 0.5) * step;
      arc_[i + 1] = arc_[i] +
          step * std::hypot(radius_ * std::cos(t), half_thickness_ * std::sin(t));
    }
  }

  MeridianPoint compute_meridian_point(double theta) const override
  {
    const bool is_upper = theta <= 0.5 * pi;
    const double t = compute_parameter(is_upper ? theta : pi - theta);
    const double z = half_thickness_ * std::cos(t);
    return {radius_ * std::sin(t), is_upper ? z : -z};
  }

  double compute_volume() const override
  {
    return 4.0 * pi / 3.0 * radius_ * radius_ * half_thickness_;
  }

 private:
  // The ellipse parameter at the arc-length fraction theta/(pi/2), theta in [0, pi/2].
  double compute_parameter(double theta) const
  {
    const double target = arc_.back() * theta / (0.5 * pi);
    const int last = static_cast<int>(std::lower_bound(arc_.begin(), arc_.end(), target) -
                                      arc_.begin());
    const int i = std::min(std::max(last - 1, 0), n_steps_ - 1);
    const double fraction = (target - arc_[i]) / (arc_[i + 1] - arc_[i]);
    return (i + fraction) * 0.5 * pi / n_steps_;
  }

  static constexpr int n_steps_ = 2000;
  std::vector<double> arc_;    // arc length at i * (pi/2)/n_steps_
};

class RoundedDisc : public Disc {
 public:
  RoundedDisc(double diameter, double thickness) : Disc("rounded disc", diameter, thickness) {}

  MeridianPoint compute_meridian_point(double theta) const override
  {
    const bool is_upper = theta <= 0.5 * pi;
    const double flat = radius_ - half_thickness_;
    const double total = flat + 0.5 * pi * half_thickness_;
    const double arc = total * (is_upper ? theta : pi - theta) / (0.5 * pi);
    if (arc <= flat) return {arc, is_upper ? half_thickness_ : -half_thickness_};
    const double turn = (arc - flat) / half_thickness_;
    const double z = half_thickness_ * std::cos(turn);
    return {flat + half_thickness_ * std::sin(turn), is_upper ? z : -z};
  }

  double compute_volume() const override
  {
    // slab + half torus (Pappus)
    const double flat = radius_ - half_thickness_, h = half_thickness_;
    return 2.0 * pi * flat * flat * h + pi * pi * h * h * flat + 4.0 * pi / 3.0 * h * h * h;
  }
};

SurfaceMesh make_unscaled_mesh(const Shape &shape, int n_nodes)
{
  SurfaceMesh mesh = make_icosphere(compute_icosphere_frequency(n_nodes));
  for (int i = 0; i < mesh.nodes.cols(); i++) {
    const Vec3 x = mesh.nodes.col(i);
    const double rho = std::hypot(x[0], x[1]);
    const MeridianPoint point = shape.compute_meridian_point(std::atan2(rho, x[2]));
    const double stretch = rho > 0.0 ? point.rho / rho : 0.0;
    mesh.nodes.col(i) = Vec3(stretch * x[0], stretch * x[1], point.z);
  }
  return mesh;
}

double compute_scale_to_volume(const SurfaceMesh &mesh, double volume)
{
  return std::cbrt(volume / compute_enclosed_volume(mesh.nodes, mesh.triangles));
}

}    // namespace

std::unique_ptr<Shape> make_red_cell(double radius)
{
  return std::unique_ptr<Shape>(new RedCell(radius));
}

std::unique_ptr<Shape> make_sphere(double radius)
{
  return std::unique_ptr<Shape>(new Sphere(radius));
}

std::unique_ptr<Shape> make_spheroid(double diameter, double thickness)
{
  return std::unique_ptr<Shape>(new Spheroid(diameter, thickness));
}

std::unique_ptr<Shape> make_rounded_disc(double diameter, double thickness)
{
  return std::unique_ptr<Shape>(new RoundedDisc(diameter, thickness));
}

SurfaceMesh make_mesh(const Shape &shape, int n_nodes)
{
  SurfaceMesh mesh = make_unscaled_mesh(shape, n_nodes);
  mesh.nodes *= compute_scale_to_volume(mesh, shape.compute_volume());
  return mesh;
}

double compute_volume_scale(const Shape &shape, int n_nodes)
{
  return compute_scale_to_volume(make_unscaled_mesh(shape, n_nodes), shape.compute_volume());
}

double compute_enclosed_volume(const PointsView &nodes, const std::vector<Triangle> &triangles)
{
  double sum = 0.0;
  for (const Triangle &t : triangles) {
    const Vec3 a = nodes.col(t[0]), b = nodes.col(t[1]), c = nodes.col(t[2]);
    sum += a.dot(b.cross(c));
  }
  return sum / 6.0;
}

MeshQuality compute_mesh_quality(const SurfaceMesh &mesh)
{
  const double huge = std::numeric_limits<double>::max();
  MeshQuality quality = {huge, 0.0, huge, huge, 0.0};
  for (const Triangle &t : mesh.triangles) {
    for (int i = 0; i < 3; i++) {
      const Vec3 origin = mesh.nodes.col(t[i]);
      const Vec3 u = mesh.nodes.col(t[(i + 1) % 3]) - origin;
      const Vec3 v = mesh.nodes.col(t[(i + 2) % 3]) - origin;
      const double twice_area = u.cross(v).norm();
      quality.shortest_edge = std::min(quality.shortest_edge, u.norm());
      quality.longest_edge = std::max(quality.longest_edge, u.norm());
      quality.smallest_angle = std::min(quality.smallest_angle, std::atan2(twice_area, u.dot(v)));
      quality.smallest_area = std::min(quality.smallest_area, 0.5 * twice_area);
      quality.largest_area = std::max(quality.largest_area, 0.5 * twice_area);
    }
  }
  return quality;
}

}    // namespace biem
