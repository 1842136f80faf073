// Rigid bodies in time: see the header.
#include "biem_rigid_motion.h"
#include "biem_error.h"
#include "biem_mesh_moments.h"
#include <cmath>

namespace biem {

namespace {

constexpr double kShapeTolerance = 1e-10;    // of the size of the shape

// The rotation by the angle |turn| about the direction of turn.
Eigen::Quaterniond compute_exponential(const Vec3 &turn)
{
  const double angle = turn.norm();
  const double ratio = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.5;
  return {std::cos(0.5 * angle), ratio * turn[0], ratio * turn[1], ratio * turn[2]};
}

}    // namespace

Vec3 compute_volume_centroid(PointsView nodes, const std::vector<Triangle> &triangles)
{
  MeshMoments moments;
  const Vec3 origin = nodes.rowwise().mean();    // near the body, so that no digits cancel
  for (const Triangle &t : triangles)
    add_triangle_moments(nodes.col(t[0]) - origin, nodes.col(t[1]) - origin,
                         nodes.col(t[2]) - origin, moments);
  if (!(moments.volume > 0.0))
    throw Error("rigid body of " + std::to_string(nodes.cols()) +
                " nodes: its enclosed volume is " + std::to_string(moments.volume) +
                ", not positive; the triangles are not counter-clockwise seen from outside, the "
                "surface is open, or it is not in one piece");
  return origin + Vec3(moments.volume_first) / moments.volume;
}

RigidBody make_rigid_body(PointsView nodes, const std::vector<Triangle> &triangles)
{
  RigidBody body;
  body.position = compute_volume_centroid(nodes, triangles);
  return body;
}

Points compute_body_frame(const RigidBody &body, PointsView nodes)
{
  return body.orientation.toRotationMatrix().transpose() * (nodes.colwise() - body.position);
}

Points compute_nodes(const RigidBody &body, PointsView body_frame)
{
  return (body.orientation.toRotationMatrix() * body_frame).colwise() + body.position;
}

std::optional<Mat3> find_rotation(PointsView shape, PointsView body_frame)
{
  if (shape.cols() != body_frame.cols()) return std::nullopt;
  // The best rotation (Kabsch, Acta Cryst. A 32, 922 (1976)); never a reflection.
  const Mat3 correlation = body_frame * shape.transpose();
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = correlation.determinant() < 0.0 ? -1.0 : 1.0;
  const Mat3 rotation =
      svd.matrixU() * Vec3(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  const double distance = (body_frame - rotation * shape).colwise().norm().maxCoeff();
  if (!(distance <= kShapeTolerance * shape.colwise().norm().maxCoeff())) return std::nullopt;
  return rotation;
}

void advance(Stepper stepper, const BackgroundFlow &flow, double dt, RigidBody &body)
{
  const Vec3 relative_velocity = body.velocity - flow.velocity(body.position);
  const Vec3 relative = compute_displacement(stepper, relative_velocity, body.previous_velocity, dt,
                                             body.previous_dt);
  const Vec3 turn =
      compute_displacement(stepper, body.rotation, body.previous_rotation, dt, body.previous_dt);
  body.position += flow.displacement(body.position, relative, dt);
  body.orientation = (compute_exponential(turn) * body.orientation).normalized();
  body.previous_velocity = relative_velocity;
  body.previous_rotation = body.rotation;
  body.previous_dt = dt;
}

RigidBodyStages begin_stages(const BackgroundFlow &flow, const RigidBody &body)
{
  RigidBodyStages stages;
  stages.start_orientation = body.orientation;
  stages.start_rotation = body.rotation;
  stages.start_rate = compute_displacement_rate(flow, stages, body);
  return stages;
}

Vec3 compute_displacement_rate(const BackgroundFlow &flow, const RigidBodyStages &stages,
                               const RigidBody &body)
{
  return body.velocity - flow.velocity(body.position) + flow.mean +
         flow.gradient * stages.displacement;
}

// The series of the inverse of the derivative of the exponential (Iserles et al., Acta Numerica 9,
// 215, 2000), to terms of fifth order in the turn of one step.
Vec3 compute_turn_rate(const RigidBodyStages &stages, const RigidBody &body)
{
  const Vec3 once = stages.turn.cross(body.rotation);
  return body.rotation - 0.5 * once + stages.turn.cross(once) / 12.0;
}

void advance_stage(const ChebyshevStage &next, const BackgroundFlow &flow, double h, double elapsed,
                   RigidBodyStages &stages, RigidBody &body)
{
  const Vec3 rate = compute_displacement_rate(flow, stages, body);
  const Vec3 displacement = combine(next, stages.displacement, stages.previous_displacement,
                                    h * rate, h * stages.start_rate);
  const Vec3 turn = combine(next, stages.turn, stages.previous_turn,
                            h * compute_turn_rate(stages, body), h * stages.start_rotation);
  const Vec3 carried = body.position - stages.displacement;
  body.position = carried + elapsed * flow.gradient * carried + displacement;
  body.orientation = (compute_exponential(turn) * stages.start_orientation).normalized();
  stages.previous_displacement = stages.displacement;
  stages.previous_turn = stages.turn;
  stages.displacement = displacement;
  stages.turn = turn;
}

void turn_body(const Vec3 &turn, RigidBody &body)
{
  body.orientation = (compute_exponential(turn) * body.orientation).normalized();
}

std::array<double, kRigidBodyValues> to_values(const RigidBody &body)
{
  std::array<double, kRigidBodyValues> values;
  double *next = values.data();
  const auto put = [&next](const auto &vector) {
    for (Eigen::Index i = 0; i < vector.size(); i++)
      *next++ = vector[i];
  };
  put(body.position);
  put(body.orientation.coeffs());
  put(body.velocity);
  put(body.rotation);
  put(body.previous_velocity);
  put(body.previous_rotation);
  *next = body.previous_dt;
  return values;
}

RigidBody from_values(const double *values)
{
  RigidBody body;
  const double *next = values;
  const auto take = [&next](auto &vector) {
    for (Eigen::Index i = 0; i < vector.size(); i++)
      vector[i] = *next++;
  };
  take(body.position);
  take(body.orientation.coeffs());
  take(body.velocity);
  take(body.rotation);
  take(body.previous_velocity);
  take(body.previous_rotation);
  body.previous_dt = *next;
  if (!(std::fabs(body.orientation.norm() - 1.0) < 1e-12))
    throw Error("rigid body: the stored orientation has the norm " +
                std::to_string(body.orientation.norm()) +
                ", not 1; the restart data is damaged or of another version");
  return body;
}

}    // namespace biem
