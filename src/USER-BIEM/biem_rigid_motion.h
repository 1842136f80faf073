// Position, orientation and time steps of one rigid body, and the places of its nodes.
// Pure functions; knows no solver, no periodicity, no LAMMPS and not why the body moves.
#ifndef BIEM_RIGID_MOTION_H
#define BIEM_RIGID_MOTION_H

#include "biem_flow.h"
#include "biem_stepper.h"
#include "biem_stepper_rkc.h"
#include "biem_types.h"
#include <optional>

namespace biem {

// Nodes of a body: x = position + orientation * b, with b constant, in the body frame.
struct RigidBody {
  Vec3 position = Vec3::Zero();    // of the reference point, the centroid of the volume; unwrapped
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();    // body to lab frame, unit
  // Now, lab frame, background flow included: velocity of the reference point [length/time] and
  // angular velocity [1/time].
  Vec3 velocity = Vec3::Zero();
  Vec3 rotation = Vec3::Zero();
  // One step ago. The velocity is relative to the flow at the place where the body was then, as the
  // history of a free node is: the stepper extrapolates what the flow does not prescribe.
  Vec3 previous_velocity = Vec3::Zero();
  Vec3 previous_rotation = Vec3::Zero();
  double previous_dt = 0.0;    // <= 0: no history, the next step is an Euler step
};

// Centroid of the volume inside a closed surface of flat triangles in one piece: exact.
// Throws Error if the volume is not positive.
Vec3 compute_volume_centroid(PointsView nodes, const std::vector<Triangle> &triangles);

// A body at rest at the centroid of its volume; the lab's axes are its axes.
RigidBody make_rigid_body(PointsView nodes, const std::vector<Triangle> &triangles);

// 3 x n from 3 x n: nodes (unwrapped) to the body frame, and back.
Points compute_body_frame(const RigidBody &body, PointsView nodes);
Points compute_nodes(const RigidBody &body, PointsView body_frame);

// The rotation R with body_frame = R shape, if there is one: then the bodies are of equal shape and
// what is known of the shape needs to be computed once. Nodes of both are about their reference
// points; they agree to 1e-10 of the size of the shape.
std::optional<Mat3> find_rotation(PointsView shape, PointsView body_frame);

// Velocity of the reference point of a body of which the point at centroid has this velocity.
inline Vec3 compute_reference_velocity(const RigidBody &body, const Vec3 &velocity,
                                       const Vec3 &rotation, const Vec3 &centroid)
{
  return velocity + rotation.cross(body.position - centroid);
}

// One step with velocity and rotation; they become the history. The background shear is integrated
// as for a free node (BackgroundFlow::displacement); the orientation turns by the exponential of
// the mean rotation of the step, which is of second order with Adams-Bashforth 2 and variable dt.
void advance(Stepper stepper, const BackgroundFlow &flow, double dt, RigidBody &body);

// A body within a step of several stages. Displacements are what a free node's are: relative to
// where the linear part of the flow alone would take the place of the start.
struct RigidBodyStages {
  Vec3 displacement = Vec3::Zero(), previous_displacement = Vec3::Zero();
  Vec3 turn = Vec3::Zero(), previous_turn = Vec3::Zero();    // rotation vector since the start
  Vec3 start_rate, start_rotation;                           // of displacement and turn
  Eigen::Quaterniond start_orientation;
};

RigidBodyStages begin_stages(const BackgroundFlow &flow, const RigidBody &body);
// From one stage to the next of a step h, with the body's velocity and rotation of now; elapsed:
// time between the two.
void advance_stage(const ChebyshevStage &next, const BackgroundFlow &flow, double h, double elapsed,
                   RigidBodyStages &stages, RigidBody &body);
// Rates of displacement and turn now, as the error estimate needs them at the end of a step.
Vec3 compute_displacement_rate(const BackgroundFlow &flow, const RigidBodyStages &stages,
                               const RigidBody &body);
Vec3 compute_turn_rate(const RigidBodyStages &stages, const RigidBody &body);
// Turns a body about its reference point by a rotation vector.
void turn_body(const Vec3 &turn, RigidBody &body);

// All of a body as plain numbers, for restart files: from_values(to_values(b)) continues exactly.
constexpr int kRigidBodyValues = 20;
std::array<double, kRigidBodyValues> to_values(const RigidBody &body);
RigidBody from_values(const double *values);    // kRigidBodyValues; Error if no unit quaternion

}    // namespace biem

#endif
