// Contact search between bodies through their signed distance, and block-Jacobi rigid motions.
// Does not decide how bodies grow nor when a packing is finished.
#include "biem_mesh_packing_contacts.h"

#include "biem_mesh_topology.h"

#include <algorithm>
#include <cmath>

namespace biem {
namespace {

Points make_samples(const PackingContacts::Setup &setup)
{
  const SurfaceMesh mesh = make_mesh(*setup.shape, setup.n_sample_nodes);
  if (setup.samples == PackingContacts::Samples::nodes) return mesh.nodes;
  const auto hinges = make_hinges(mesh.triangles);
  Points samples(3, mesh.nodes.cols() + static_cast<int>(hinges.size()));
  samples.leftCols(mesh.nodes.cols()) = mesh.nodes;
  int n = static_cast<int>(mesh.nodes.cols());
  for (const Hinge &h : hinges)
    samples.col(n++) = 0.5 * (mesh.nodes.col(h.b) + mesh.nodes.col(h.c));
  return samples;
}

}    // namespace

PackingContacts::PackingContacts(const Setup &setup, const MeshLattice &lattice,
                                 const PackingObstacles &obstacles) :
    lattice_(lattice),
    table_(*setup.shape, setup.scale_to_volume, 1.2 * setup.gap),
    obstacles_(lattice, obstacles.nodes, obstacles.triangles,
               1.2 * setup.gap + 0.1 * table_.bounding_radius()),
    samples_(make_samples(setup)), gap_(setup.gap),
    size_(1.0)
{
}

void PackingContacts::BodySystem::add(const Vec3 &arm, const Vec3 &normal, double penetration)
{
  Eigen::Matrix<double, 6, 1> row;
  row << normal, arm.cross(normal);
  matrix += row * row.transpose();
  right_side += penetration * row;
  worst = std::max(worst, penetration);
}

void PackingContacts::find(const std::vector<RigidPlacement> &bodies, double size)
{
  const int n_bodies = static_cast<int>(bodies.size());
  size_ = size;
  systems_.resize(n_bodies);
  near_nodes_.resize(n_bodies);
  near_center_.resize(n_bodies, Vec3::Constant(1e300));
  for (BodySystem &system : systems_) {
    system.matrix.setZero();
    system.right_side.setZero();
    system.worst = 0.0;
  }
  for (int i = 0; i < n_bodies; i++) {
    for (int j = i; j < n_bodies; j++) find_between(bodies, i, j);
    find_with_obstacles(bodies[i], i);
  }
}

void PackingContacts::find_between(const std::vector<RigidPlacement> &bodies, int i, int j)
{
  const double cutoff = size_ * (2.0 * table_.bounding_radius() + gap_);
  const Vec3 difference = bodies[j].center - bodies[i].center;
  lattice_.for_each_image(difference, cutoff, [&](const Vec3 &image) {
    if (i == j && image.squaredNorm() < 1e-12 * cutoff * cutoff) return;
    RigidPlacement other = bodies[j];
    other.center = bodies[i].center + image;
    find_samples_inside(bodies[i], other, i, j);
    find_samples_inside(other, bodies[i], j, i);
  });
}

// Samples of body i against the distance field of body j.
void PackingContacts::find_samples_inside(const RigidPlacement &moved, const RigidPlacement &other,
                                          int i, int j)
{
  const Mat3 relative = other.rotation.transpose() * moved.rotation;
  const Vec3 shift = other.rotation.transpose() * (moved.center - other.center) / size_;
  const double limit = table_.bounding_radius() + gap_;
  for (int k = 0; k < samples_.cols(); k++) {
    const Vec3 local = relative * samples_.col(k) + shift;
    if (local.squaredNorm() > limit * limit) continue;
    const SignedDistance distance = table_.evaluate(local);
    if (distance.value >= gap_) continue;
    const double penetration = size_ * (gap_ - distance.value);
    const Vec3 normal = other.rotation * distance.normal;
    systems_[i].add(size_ * (moved.rotation * samples_.col(k)), normal, penetration);
    systems_[j].add(size_ * (other.rotation * local), -normal, penetration);
  }
}

void PackingContacts::find_with_obstacles(const RigidPlacement &body, int i)
{
  if (obstacles_.nodes().cols() == 0) return;
  update_near_nodes(body.center, i);
  if (near_nodes_[i].empty()) return;
  const double limit = size_ * (gap_ + 0.1 * table_.bounding_radius());    // sees some overlap
  for (int k = 0; k < samples_.cols(); k++) {
    const Vec3 arm = size_ * (body.rotation * samples_.col(k));
    const SignedDistance distance = obstacles_.evaluate(body.center + arm, arm, limit);
    const double penetration = size_ * gap_ - distance.value;
    if (penetration > 0.0) systems_[i].add(arm, distance.normal, penetration);
  }
  for (int node : near_nodes_[i]) {
    const Vec3 arm = lattice_.wrap_difference(obstacles_.nodes().col(node) - body.center);
    const SignedDistance distance = table_.evaluate(body.rotation.transpose() * arm / size_);
    const double penetration = size_ * (gap_ - distance.value);
    if (penetration > 0.0) systems_[i].add(arm, body.rotation * -distance.normal, penetration);
  }
}

void PackingContacts::update_near_nodes(const Vec3 &center, int i)
{
  const double skin = 0.5 * table_.bounding_radius();
  if ((center - near_center_[i]).norm() < skin) return;
  const double radius = table_.bounding_radius() + 1.2 * gap_ + skin;
  near_center_[i] = center;
  near_nodes_[i] = obstacles_.find_nodes(center, radius);
}

double PackingContacts::worst() const
{
  double worst = 0.0;
  for (const BodySystem &system : systems_) worst = std::max(worst, system.worst);
  return worst;
}

void PackingContacts::apply_motions(std::vector<RigidPlacement> &bodies,
                                    PackingRotation rotation) const
{
  const double radius = size_ * table_.bounding_radius();
  for (std::size_t i = 0; i < bodies.size(); i++) {
    const BodySystem &system = systems_[i];
    if (system.worst <= 0.0) continue;
    // Levenberg-Marquardt damping picks the shortest motion where contacts leave a freedom
    Eigen::Matrix<double, 6, 6> matrix = system.matrix;
    const double damping = 0.02 * matrix.diagonal().head<3>().sum();
    matrix.diagonal().head<3>().array() += damping;
    matrix.diagonal().tail<3>().array() += damping * radius * radius;
    Vec3 shift, turn = Vec3::Zero();
    if (rotation == PackingRotation::free) {
      const Eigen::Matrix<double, 6, 1> motion = 0.5 * matrix.ldlt().solve(system.right_side);
      shift = motion.head<3>();
      turn = motion.tail<3>();
    } else {
      shift = 0.5 * matrix.topLeftCorner<3, 3>().ldlt().solve(system.right_side.head<3>());
    }
    const double largest = 0.1 * radius, length = shift.norm() + radius * turn.norm();
    if (length > largest) {
      shift *= largest / length;
      turn *= largest / length;
    }
    bodies[i].center += shift;
    const double angle = turn.norm();
    if (angle > 0.0) {
      const Mat3 step = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
      bodies[i].rotation = Eigen::Quaterniond(step * bodies[i].rotation).normalized()
                               .toRotationMatrix();
    }
  }
}

}    // namespace biem
