// Growth of random seeds to full size, then refinement on the mesh whose gaps are to be kept.
// Does not know how contacts are found nor where the bodies will be used.
#include "biem_mesh_packing.h"

#include "biem_error.h"
#include "biem_mesh_packing_contacts.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace biem {
namespace {

const double pi = 3.14159265358979323846;

// Uniform numbers in [0, 1) that are the same with every standard library.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  double draw() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  Vec3 draw_fractional()
  {
    const double a = draw(), b = draw(), c = draw();
    return Vec3(a, b, c);
  }

  // Uniform on the rotation group (Shoemake, Graphics Gems III, 1992).
  Mat3 draw_rotation()
  {
    const Vec3 u = draw_fractional();
    const double r = std::sqrt(1.0 - u[0]), s = std::sqrt(u[0]);
    const double a = 2.0 * pi * u[1], b = 2.0 * pi * u[2];
    return Eigen::Quaterniond(s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b))
        .toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

// The distance between smooth bodies that guarantees the gap between their meshes, and the part
// of it that may be missing. The flat triangles stand out of a concave side of the smooth body.
struct GapTarget {
  double gap, slack;    // length
};

GapTarget compute_gap_target(const PackingRequest &request)
{
  const double scale = compute_volume_scale(*request.shape, request.n_nodes);
  const double radius = request.shape->compute_meridian_point(0.5 * pi).rho * scale;
  const SignedDistanceTable table(*request.shape, scale, 0.3 * radius);
  const SurfaceMesh mesh = make_mesh(*request.shape, request.n_nodes);
  double excess = 0.0;
  auto update = [&](const Vec3 &point) {
    excess = std::max(excess, table.evaluate(point).value);
  };
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.nodes.col(t[0]), b = mesh.nodes.col(t[1]), c = mesh.nodes.col(t[2]);
    update((a + b + c) / 3.0);
    update(0.5 * (a + b));
    update(0.5 * (b + c));
    update(0.5 * (c + a));
  }
  const double slack = 0.005 * radius;
  return {request.minimum_gap + 1.1 * excess + table.accuracy() + slack, slack};
}

PackingContacts::Setup make_setup(const PackingRequest &request, const GapTarget &target,
                                  int n_sample_nodes, PackingContacts::Samples samples)
{
  return {request.shape, n_sample_nodes, samples,
          compute_volume_scale(*request.shape, request.n_nodes), target.gap};
}

class RandomPacking {
 public:
  RandomPacking(const PackingRequest &request, const PackingObstacles &obstacles) :
      request_(request), lattice_(request.lattice), target_(compute_gap_target(request)),
      coarse_(make_setup(request, target_, std::min(request.n_nodes, n_coarse_nodes_),
                         PackingContacts::Samples::nodes),
              lattice_, obstacles),
      fine_(make_setup(request, target_, request.n_nodes,
                       PackingContacts::Samples::nodes_and_edges),
            lattice_, obstacles),
      random_(request.seed)
  {
  }

  bool try_once()
  {
    if (!place_seeds() || !grow()) return false;
    return relax(fine_, 1000) && are_outside_obstacles();
  }

  const std::vector<RigidPlacement> &bodies() const { return bodies_; }

  // The number of bodies that keep the gap when the worst others are taken away.
  int count_placed()
  {
    std::vector<RigidPlacement> kept = bodies_;
    while (!kept.empty()) {
      fine_.find(kept, 1.0);
      int worst = 0;
      for (int i = 1; i < static_cast<int>(kept.size()); i++)
        if (fine_.worst_of(i) > fine_.worst_of(worst)) worst = i;
      if (fine_.worst_of(worst) <= target_.slack) break;
      kept.erase(kept.begin() + worst);
    }
    return static_cast<int>(kept.size());
  }

 private:
  bool place_seeds()
  {
    bodies_.clear();
    for (int i = 0; i < request_.n_bodies; i++) {
      RigidPlacement body;
      int n_trials = 0;
      do {
        if (n_trials++ == 1000) return false;
        body.center = request_.lattice * random_.draw_fractional();
      } while (!is_free(body.center));
      const bool is_fixed = request_.rotation == PackingRotation::fixed;
      body.rotation = is_fixed ? request_.orientation : random_.draw_rotation();
      bodies_.push_back(body);
    }
    return true;
  }

  bool is_free(const Vec3 &center) const
  {
    const double size = first_size_ * coarse_.bounding_radius();
    const MeshObstacles &obstacles = coarse_.obstacles();
    return obstacles.find_nodes(center, size).empty() && !obstacles.is_inside(center);
  }

  // Bodies that are pushed apart only once they touch settle at random close packing; growing
  // slowly, and shaking where growth stalls, leads past the first jammed state.
  bool grow()
  {
    double size = first_size_;
    int n_stalled = 0;
    const double tolerance = 0.02 * coarse_.bounding_radius();
    for (int step = 0; step < n_growth_steps_; step++) {
      coarse_.find(bodies_, size);
      if (coarse_.worst() < tolerance * size) {
        if (size >= 1.0) return relax(coarse_, 500);
        size = std::min(1.0, size + growth_);
        n_stalled = 0;
      } else if (++n_stalled > 200) {
        size = std::max(first_size_, size - 10.0 * growth_);
        shake(0.1 * size);
        n_stalled = 0;
        continue;
      }
      coarse_.apply_motions(bodies_, request_.rotation);
    }
    return false;
  }

  void shake(double amplitude)
  {
    for (RigidPlacement &body : bodies_) {
      const Vec3 shift = 2.0 * random_.draw_fractional() - Vec3::Ones();
      const Vec3 turn = 2.0 * random_.draw_fractional() - Vec3::Ones();
      body.center += amplitude * coarse_.bounding_radius() * shift;
      if (request_.rotation == PackingRotation::fixed) continue;
      const double angle = amplitude * turn.norm();
      body.rotation = Eigen::AngleAxisd(angle, turn.normalized()) * body.rotation;
    }
  }

  bool relax(PackingContacts &contacts, int n_steps)
  {
    for (int step = 0; step < n_steps; step++) {
      contacts.find(bodies_, 1.0);
      if (contacts.worst() <= target_.slack) return true;
      contacts.apply_motions(bodies_, request_.rotation);
    }
    return false;
  }

  bool are_outside_obstacles() const
  {
    for (const RigidPlacement &body : bodies_)
      if (fine_.obstacles().is_inside(body.center)) return false;
    return true;
  }

  static constexpr int n_coarse_nodes_ = 162, n_growth_steps_ = 4000;
  static constexpr double first_size_ = 0.1, growth_ = 0.01;

  PackingRequest request_;
  MeshLattice lattice_;
  GapTarget target_;
  PackingContacts coarse_, fine_;
  RandomNumbers random_;
  std::vector<RigidPlacement> bodies_;
};

std::string describe_fraction(const PackingRequest &request, int n_bodies)
{
  const double volume = MeshLattice(request.lattice).compute_volume();
  return std::to_string(n_bodies * request.shape->compute_volume() / volume);
}

std::string describe_goal(const PackingRequest &request)
{
  return std::to_string(request.n_bodies) + " bodies (" + request.shape->describe() +
      ", volume fraction " + describe_fraction(request, request.n_bodies) + ") with gap " +
      std::to_string(request.minimum_gap);
}

void check_request(const PackingRequest &request)
{
  if (request.n_bodies < 1)
    throw Error("Random packing: the number of bodies is " + std::to_string(request.n_bodies) +
                " but must be 1 or more");
  if (!(request.minimum_gap >= 0.0) || !std::isfinite(request.minimum_gap))
    throw Error("Random packing: the minimum gap is " + std::to_string(request.minimum_gap) +
                " but must be 0 or a positive length");
  const double volume = MeshLattice(request.lattice).compute_volume();
  if (!(request.n_bodies * request.shape->compute_volume() < 0.74 * volume))
    throw Error("Random packing: " + describe_goal(request) +
                " cannot fit: that is denser than any arrangement of spheres (0.74); "
                "take fewer or smaller bodies or a larger box");
}

}    // namespace

std::vector<RigidPlacement> make_random_packing(const PackingRequest &request,
                                                const PackingObstacles &obstacles)
{
  check_request(request);
  RandomPacking packing(request, obstacles);
  const int n_attempts = 3;
  int n_placed = 0;
  for (int attempt = 0; attempt < n_attempts; attempt++) {
    if (packing.try_once()) return packing.bodies();
    n_placed = std::max(n_placed, packing.count_placed());
  }
  throw Error("Random packing: cannot place " + describe_goal(request) + ": at most " +
              std::to_string(n_placed) + " keep the gap (volume fraction " +
              describe_fraction(request, n_placed) + ") after " + std::to_string(n_attempts) +
              " attempts of growing and pushing apart, because the others find no room" +
              (obstacles.nodes.cols() ? " between what is in the box already" : "") +
              "; take fewer bodies, a smaller gap, a larger box or another seed");
}

void check_placement(const PackingRequest &request, const RigidPlacement &placement,
                     const PackingObstacles &obstacles)
{
  const GapTarget target = compute_gap_target(request);
  const double needed = target.gap - target.slack;
  PackingContacts contacts(make_setup(request, {needed, 0.0}, request.n_nodes,
                                      PackingContacts::Samples::nodes_and_edges),
                           MeshLattice(request.lattice), obstacles);
  contacts.find({placement}, 1.0);
  if (contacts.worst() <= 0.0 && !contacts.obstacles().is_inside(placement.center)) return;
  throw Error("Placement: the " + request.shape->describe() + " does not keep the gap " +
              std::to_string(request.minimum_gap) +
              " to what is in the box already or to its own periodic image; "
              "move it, lower the gap or enlarge the box");
}

Mat3 compute_rotation_to_axis(const Vec3 &axis, double roll)
{
  const Vec3 z = axis.normalized();
  const Vec3 turn = Vec3::UnitZ().cross(z);
  // a half turn for the opposite direction has no unique axis: take x
  const Vec3 about = turn.norm() > 1e-14 ? Vec3(turn.normalized()) : Vec3(Vec3::UnitX());
  const double angle = std::atan2(turn.norm(), z[2]);
  return Eigen::AngleAxisd(angle, about).toRotationMatrix() *
      Eigen::AngleAxisd(roll, Vec3::UnitZ()).toRotationMatrix();
}

}    // namespace biem
