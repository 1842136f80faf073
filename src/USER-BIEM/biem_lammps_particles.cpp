// Rigid particles on LAMMPS' atoms: see the header.
#include "biem_lammps_particles.h"
#include "atom.h"
#include "biem_error.h"
#include "domain.h"
#include "error.h"
#include <cmath>

namespace LAMMPS_NS {

namespace {

// Of the size of a body: atoms that are where the state of their body says; shapes that are equal.
constexpr double kInPlace = 1e-8, kSameShape = 1e-10;

double compute_size(const biem::Points &frame)
{
  return std::sqrt(frame.colwise().squaredNorm().maxCoeff());
}

double compute_distance(const biem::Points &a, const biem::Points &b)
{
  return std::sqrt((a - b).colwise().squaredNorm().maxCoeff());
}

// The rotation R and position that bring frame closest to positions (Kabsch, Acta Cryst. A 32, 922,
// 1976).
biem::RigidBody fit_body(const biem::Points &frame, const biem::Points &positions)
{
  const biem::Vec3 from = frame.rowwise().mean(), to = positions.rowwise().mean();
  const biem::Mat3 covariance = (positions.colwise() - to) * (frame.colwise() - from).transpose();
  const Eigen::JacobiSVD<biem::Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  biem::Vec3 signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  const biem::Mat3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  biem::RigidBody body;
  body.orientation = Eigen::Quaterniond(rotation).normalized();
  body.position = to - body.orientation * from;
  return body;
}

}    // namespace

int LammpsParticles::shape(int surface) const
{
  const auto found = bodies_.find(surface + 1);
  return found == bodies_.end() ? -1 : found->second.shape;
}

int LammpsParticles::find_index(tagint tag) const
{
  const auto found = nodes_.find(tag);
  return found == nodes_.end() ? -1 : found->second.second;
}

biem::Mat3 LammpsParticles::orientation(int surface) const
{
  return states_.at(surface + 1).orientation.toRotationMatrix();
}

double LammpsParticles::radius(int molecule) const
{
  return compute_size(shapes_[bodies_.at(molecule).shape].nodes);
}

std::vector<biem::Mat3> LammpsParticles::orientations(int n_surfaces) const
{
  std::vector<biem::Mat3> result(n_surfaces, biem::Mat3::Identity());
  for (const auto &entry : states_)
    result[entry.first - 1] = entry.second.orientation.toRotationMatrix();
  return result;
}

void LammpsParticles::prepare(const NodeGroups &groups, const MeshSurvey &survey)
{
  bool has_rigid = false;
  for (int g : survey.group)
    has_rigid = has_rigid || (g >= 0 && groups.surfaces[g].kind == biem::SurfaceKind::Rigid);
  std::map<int, GatheredSurface> surfaces;
  if (has_rigid) surfaces = gather_surfaces(lmp, groups, biem::SurfaceKind::Rigid);
  for (const auto &entry : bodies_)    // the frames that are in use
    restored_frames_[entry.first] = shapes_[entry.second.shape].nodes;
  bodies_.clear();
  shapes_.clear();
  nodes_.clear();
  for (const auto &entry : surfaces)
    add_body(entry.first, entry.second);
  restored_frames_.clear();
  for (auto state = states_.begin(); state != states_.end();)
    state = bodies_.count(state->first) ? std::next(state) : states_.erase(state);
}

void LammpsParticles::add_body(int molecule, const GatheredSurface &s)
{
  const auto restored = restored_frames_.find(molecule);
  const auto state = states_.find(molecule);
  biem::Points frame;
  if (restored != restored_frames_.end() && state != states_.end() &&
      is_in_place(state->second, restored->second, s.positions)) {
    frame = restored->second;
  } else {
    // The shape as it was created, if the atoms have kept it: equal bodies then share it.
    biem::RigidBody body = fit_body(s.references, s.positions);
    frame = s.references;
    if (!is_in_place(body, frame, s.positions)) {
      body = biem::RigidBody();
      frame = s.positions;
    }
    const biem::Vec3 centroid = biem::compute_volume_centroid(frame, s.triangles);
    frame.colwise() -= centroid;
    body.position += body.orientation * centroid;
    states_[molecule] = body;
  }
  bodies_[molecule] = {find_or_add_shape(frame, s.triangles), s.tags};
  for (size_t i = 0; i < s.tags.size(); i++)
    nodes_[s.tags[i]] = {molecule, static_cast<int>(i)};
}

bool LammpsParticles::is_in_place(const biem::RigidBody &state, const biem::Points &frame,
                                  const biem::Points &positions) const
{
  const double size = compute_size(positions.colwise() - biem::Vec3(positions.rowwise().mean()));
  return frame.cols() == positions.cols() &&
         compute_distance(biem::compute_nodes(state, frame), positions) <= kInPlace * size;
}

int LammpsParticles::find_or_add_shape(const biem::Points &frame,
                                       const std::vector<biem::Triangle> &triangles)
{
  for (size_t k = 0; k < shapes_.size(); k++)
    if (shapes_[k].triangles == triangles && shapes_[k].nodes.cols() == frame.cols() &&
        compute_distance(shapes_[k].nodes, frame) <= kSameShape * compute_size(frame))
      return static_cast<int>(k);
  shapes_.push_back({frame, triangles});
  return static_cast<int>(shapes_.size()) - 1;
}

// Of all nodal forces with this sum and this moment, those that vary linearly over the body.
void LammpsParticles::add_prescribed_loads(const NodeGroups &groups, biem::PointsRef forces) const
{
  struct Load {
    biem::Vec3 center, force, spin;
    biem::Mat3 orientation;
    const biem::Points *frame;
  };
  std::map<int, Load> loads;
  for (int i = 0; i < atom->nlocal; i++) {
    const int g = groups.find_surface(atom->mask[i]);
    if (g < 0 || groups.surfaces[g].kind != biem::SurfaceKind::Rigid) continue;
    const SurfaceGroup &group = groups.surfaces[g];
    if (group.force.isZero(0.0) && group.torque.isZero(0.0)) continue;
    const std::pair<int, int> &node = nodes_.at(atom->tag[i]);
    if (!loads.count(node.first)) {
      const biem::Points &frame = shapes_[bodies_.at(node.first).shape].nodes;
      const biem::Mat3 r = orientation(node.first - 1);
      const biem::Vec3 center = frame.rowwise().mean();
      biem::Mat3 moments = biem::Mat3::Zero();
      for (Eigen::Index k = 0; k < frame.cols(); k++) {
        const biem::Vec3 x = frame.col(k) - center;
        moments += x.squaredNorm() * biem::Mat3::Identity() - x * x.transpose();
      }
      const biem::Vec3 torque = group.torque - (r * center).cross(group.force);
      loads[node.first] = {center, group.force / static_cast<double>(frame.cols()),
                           r * moments.inverse() * r.transpose() * torque, r, &frame};
    }
    const Load &load = loads[node.first];
    const biem::Vec3 x = load.orientation * (load.frame->col(node.second) - load.center);
    forces.col(i) += load.force + load.spin.cross(x);
  }
}

void LammpsParticles::set_motions(const biem::Evaluation &e, const biem::BackgroundFlow &flow)
{
  for (auto &entry : states_) {
    const int s = entry.first - 1;
    const biem::SurfaceMotion &motion = e.motions[s];
    biem::RigidBody &body = entry.second;
    body.rotation = motion.rotation;
    body.velocity = biem::compute_reference_velocity(
        body, flow.velocity(e.centroids[s]) + motion.velocity, motion.rotation, e.centroids[s]);
  }
}

void LammpsParticles::advance(biem::Stepper stepper, const biem::BackgroundFlow &flow, double dt)
{
  for (auto &entry : states_)
    biem::advance(stepper, flow, dt, entry.second);
}

void LammpsParticles::begin_stages(const biem::BackgroundFlow &flow)
{
  for (const auto &entry : states_)
    stages_[entry.first] = biem::begin_stages(flow, entry.second);
}

void LammpsParticles::advance_stage(const biem::ChebyshevStage &next,
                                    const biem::BackgroundFlow &flow, double h, double elapsed)
{
  for (auto &entry : states_)
    biem::advance_stage(next, flow, h, elapsed, stages_.at(entry.first), entry.second);
}

void LammpsParticles::lay_atoms() const
{
  std::map<int, biem::Mat3> rotations;
  for (const auto &entry : states_)
    rotations[entry.first] = entry.second.orientation.toRotationMatrix();
  for (int i = 0; i < atom->nlocal; i++) {
    const auto node = nodes_.find(atom->tag[i]);
    if (node == nodes_.end()) continue;
    const int molecule = node->second.first;
    const biem::Points &frame = shapes_[bodies_.at(molecule).shape].nodes;
    const biem::Vec3 unwrapped =
        states_.at(molecule).position + rotations[molecule] * frame.col(node->second.second);
    double image_shift[3], zero[3] = {0.0, 0.0, 0.0};
    domain->unmap(zero, atom->image[i], image_shift);
    for (int a = 0; a < 3; a++)
      atom->x[i][a] = unwrapped[a] - image_shift[a];
  }
}

std::vector<double> LammpsParticles::get_state() const
{
  std::vector<double> state = {static_cast<double>(states_.size())};
  for (const auto &entry : states_) {
    const biem::Points &frame = shapes_[bodies_.at(entry.first).shape].nodes;
    state.push_back(entry.first);
    const auto values = biem::to_values(entry.second);
    state.insert(state.end(), values.begin(), values.end());
    state.push_back(static_cast<double>(frame.cols()));
    state.insert(state.end(), frame.data(), frame.data() + frame.size());
  }
  return state;
}

const double *LammpsParticles::set_state(const double *state)
{
  const int n = static_cast<int>(*state++);
  for (int k = 0; k < n; k++) {
    const int molecule = static_cast<int>(*state++);
    states_[molecule] = biem::from_values(state);
    state += biem::kRigidBodyValues;
    const auto n_nodes = static_cast<Eigen::Index>(*state++);
    restored_frames_[molecule] = Eigen::Map<const biem::Points>(state, 3, n_nodes);
    state += 3 * n_nodes;
  }
  return state;
}

}    // namespace LAMMPS_NS
