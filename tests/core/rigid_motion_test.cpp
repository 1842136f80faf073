// Rigid bodies in time: Jeffery's orbits, the background shear, steps of several stages, restart
// values, body frames.
#include "biem_error.h"
#include "biem_mesh_shape.h"
#include "biem_rigid_motion.h"
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

using namespace biem;

namespace {

constexpr double kBretherton =
    -0.8823529411764706;    // (r^2 - 1)/(r^2 + 1) at aspect ratio r = 1/4

// Jeffery, Proc. R. Soc. A 102, 161 (1922): angular velocity of a free spheroid with axis p.
Vec3 compute_jeffery_rotation(double shear_rate, const Vec3 &p)
{
  Mat3 strain = Mat3::Zero();
  strain(0, 2) = strain(2, 0) = 0.5 * shear_rate;
  return Vec3(0.0, 0.5 * shear_rate, 0.0) + kBretherton * p.cross(strain * p);
}

// The axis after time t: p' = (W + B E) p, normalized; (W + B E)^2 = -k^2 in the plane x-z.
Vec3 compute_jeffery_axis(double shear_rate, const Vec3 &p, double t)
{
  const double k = 0.5 * shear_rate * std::sqrt(1.0 - kBretherton * kBretherton);
  const double c = std::cos(k * t), s = std::sin(k * t) / k;
  return Vec3(c * p[0] + s * 0.5 * shear_rate * (kBretherton + 1.0) * p[2], p[1],
              c * p[2] + s * 0.5 * shear_rate * (kBretherton - 1.0) * p[0])
      .normalized();
}

BackgroundFlow make_shear_flow(double rate, const Vec3 &mean = Vec3::Zero())
{
  BackgroundFlow flow;
  flow.set_shear(rate);
  flow.mean = mean;
  return flow;
}

// Distance of the axis from the exact one at t = 10, with steps dt or, alternately, 0.5 dt and dt.
double compute_orbit_error(Stepper stepper, double dt, double ratio)
{
  const BackgroundFlow flow = make_shear_flow(1.3);
  RigidBody body;
  body.orientation = Eigen::Quaterniond(0.7, 0.4, -0.3, 0.2).normalized();
  const Vec3 start = body.orientation * Vec3::UnitZ();
  const double end = 10.0;
  double t = 0.0;
  for (int step = 0; t < end - 1e-9; step++) {
    const double h = std::min(end - t, step % 2 ? dt : ratio * dt);
    body.rotation = compute_jeffery_rotation(flow.shear_rate(), body.orientation * Vec3::UnitZ());
    advance(stepper, flow, h, body);
    t += h;
  }
  return (body.orientation * Vec3::UnitZ() - compute_jeffery_axis(flow.shear_rate(), start, end))
      .norm();
}

// A step h of several stages; set_motion gives the body its velocity and rotation at a time.
using SetMotion = std::function<void(double t, RigidBody &body)>;

void advance_in_stages(int n_stages, const BackgroundFlow &flow, const SetMotion &set_motion,
                       double t, double h, RigidBody &body)
{
  const auto c = compute_chebyshev_stages(n_stages);
  set_motion(t, body);
  RigidBodyStages stages = begin_stages(flow, body);
  for (int j = 1; j <= n_stages; j++) {
    if (j > 1) set_motion(t + c[j - 1].time * h, body);
    advance_stage(c[j], flow, h, (c[j].time - c[j - 1].time) * h, stages, body);
  }
}

// Orders of convergence in n_steps up to this time, of the distance that compute_error gives.
double measure_order(int n_stages, const BackgroundFlow &flow, const SetMotion &set_motion,
                     const RigidBody &start, double end, int n_steps,
                     const std::function<double(const RigidBody &)> &compute_error)
{
  double errors[2];
  for (int level = 0; level < 2; level++) {
    RigidBody body = start;
    const double h = end / (n_steps << level);
    for (int k = 0; k < n_steps << level; k++)
      advance_in_stages(n_stages, flow, set_motion, k * h, h, body);
    errors[level] = compute_error(body);
  }
  std::printf("  %d stages: %.2e %.2e\n", n_stages, errors[0], errors[1]);
  EXPECT_LT(errors[1], 1e-2);
  return std::log2(errors[0] / errors[1]);
}

SurfaceMesh make_lopsided_body()
{
  SurfaceMesh mesh = make_mesh(*make_spheroid(2.0, 1.0), 162);
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); i++)    // one end thicker than the other
    mesh.nodes.col(i) *= 1.0 + 0.3 * mesh.nodes(0, i);
  return mesh;
}

}    // namespace

TEST(RigidMotion, JefferyOrbitIsOfTheSteppersOrder)
{
  for (double ratio : {1.0, 0.5}) {
    const double coarse = compute_orbit_error(Stepper::AdamsBashforth2, 0.02, ratio);
    const double fine = compute_orbit_error(Stepper::AdamsBashforth2, 0.01, ratio);
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1) << "steps " << ratio;
    EXPECT_LT(fine, 2e-4);
  }
  const double coarse = compute_orbit_error(Stepper::Euler, 0.02, 1.0);
  const double fine = compute_orbit_error(Stepper::Euler, 0.01, 1.0);
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.1);
}

TEST(RigidMotion, OrientationStaysAUnitQuaternion)
{
  const BackgroundFlow flow = make_shear_flow(1.0);
  RigidBody body;
  body.orientation = Eigen::Quaterniond(0.5, 0.1, -0.3, 0.2).normalized();
  double largest = 0.0;
  for (int step = 0; step < 1000000; step++) {
    body.rotation = compute_jeffery_rotation(1.0, body.orientation * Vec3::UnitZ());
    advance(Stepper::AdamsBashforth2, flow, 0.01, body);
    largest = std::max(largest, std::fabs(body.orientation.norm() - 1.0));
  }
  EXPECT_LT(largest, 1e-15);
}

TEST(RigidMotion, ConstantRotationIsExactAtAnyStep)
{
  RigidBody body;
  body.rotation = Vec3(0.3, -0.8, 0.5);
  for (double dt : {0.7, 0.01, 2.3})
    advance(Stepper::AdamsBashforth2, BackgroundFlow(), dt, body);
  const Eigen::AngleAxisd exact(3.01 * body.rotation.norm(), body.rotation.normalized());
  EXPECT_LT((body.orientation.toRotationMatrix() - exact.toRotationMatrix()).norm(), 1e-14);
  RigidBody still;
  advance(Stepper::Euler, BackgroundFlow(), 1.0, still);
  EXPECT_EQ(still.orientation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(RigidMotion, BodyThatFollowsTheFlowWithConstantSlipMovesExactly)
{
  // x'' = shear_rate z' with z' constant: a parabola, which the midpoint of z integrates exactly.
  const BackgroundFlow flow = make_shear_flow(0.9, Vec3(0.2, -0.1, 0.4));
  const Vec3 slip(0.3, 0.5, -0.7), start(1.0, 2.0, 3.0);
  RigidBody body;
  body.position = start;
  double t = 0.0;
  for (double dt : {0.5, 0.1, 1.7, 0.3}) {
    body.velocity = flow.velocity(body.position) + slip;
    advance(Stepper::AdamsBashforth2, flow, dt, body);
    t += dt;
  }
  const Vec3 drift = slip + flow.mean;
  const Vec3 exact = start + t * drift +
                     Vec3(flow.shear_rate() * (start[2] * t + 0.5 * drift[2] * t * t), 0.0, 0.0);
  EXPECT_LT((body.position - exact).norm(), 1e-14 * exact.norm());
}

TEST(RigidMotion, BodyMovesAsAFreeNodeDoes)
{
  const BackgroundFlow flow = make_shear_flow(1.1, Vec3(0.0, 0.3, 0.1));
  RigidBody body;
  body.position = Vec3(0.2, 0.1, -0.4);
  Vec3 node = body.position, previous = Vec3::Zero();
  double previous_dt = 0.0, t = 0.0;
  for (double dt : {0.1, 0.2, 0.05, 0.1}) {
    const Vec3 relative(std::sin(t), node[0], -node[2]);
    body.velocity =
        flow.velocity(body.position) + Vec3(std::sin(t), body.position[0], -body.position[2]);
    node += flow.displacement(
        node, compute_displacement(Stepper::AdamsBashforth2, relative, previous, dt, previous_dt),
        dt);
    previous = relative;
    previous_dt = dt;
    advance(Stepper::AdamsBashforth2, flow, dt, body);
    t += dt;
  }
  EXPECT_LT((body.position - node).norm(), 1e-15);
}

TEST(RigidMotionInStages, PrescribedRotationIsFollowedToSecondOrder)
{
  // R = exp(g(t) z) exp(f(t) x): turns that do not commute.
  const auto f = [](double t) {
    return 1.3 * t + 0.4 * std::sin(2.0 * t);
  };
  const auto g = [](double t) {
    return 0.9 * t * t;
  };
  const SetMotion set_motion = [&](double t, RigidBody &body) {
    const Eigen::AngleAxisd about_z(g(t), Vec3::UnitZ());
    body.rotation =
        1.8 * t * Vec3::UnitZ() + (1.3 + 0.8 * std::cos(2.0 * t)) * (about_z * Vec3::UnitX());
  };
  const double end = 2.0;
  const Mat3 exact =
      (Eigen::AngleAxisd(g(end), Vec3::UnitZ()) * Eigen::AngleAxisd(f(end), Vec3::UnitX()))
          .toRotationMatrix();
  for (int s : {2, 5, 10, 20})
    EXPECT_NEAR(measure_order(s, BackgroundFlow(), set_motion, RigidBody(), end, 40,
                              [&](const RigidBody &body) {
                                return (body.orientation.toRotationMatrix() - exact).norm();
                              }),
                2.0, 0.1)
        << s << " stages";
}

TEST(RigidMotionInStages, JefferyOrbitIsOfSecondOrder)
{
  const BackgroundFlow flow = make_shear_flow(1.3);
  RigidBody start;
  start.orientation = Eigen::Quaterniond(0.7, 0.4, -0.3, 0.2).normalized();
  const double end = 10.0;
  const Vec3 exact = compute_jeffery_axis(1.3, start.orientation * Vec3::UnitZ(), end);
  const SetMotion set_motion = [](double, RigidBody &body) {
    body.rotation = compute_jeffery_rotation(1.3, body.orientation * Vec3::UnitZ());
  };
  for (int s : {2, 5, 10, 20})
    EXPECT_NEAR(measure_order(s, flow, set_motion, start, end, 200,
                              [&](const RigidBody &body) {
                                return (body.orientation * Vec3::UnitZ() - exact).norm();
                              }),
                2.0, 0.1)
        << s << " stages";
}

TEST(RigidMotionInStages, PathThroughAShearFlowIsOfSecondOrder)
{
  // Slip sin(t) along z, cos(t) - 1 along y: x'' = shear_rate z'.
  const double rate = 0.9, end = 3.0;
  const BackgroundFlow flow = make_shear_flow(rate, Vec3(0.2, 0.0, 0.1));
  const SetMotion set_motion = [&](double t, RigidBody &body) {
    body.velocity = flow.velocity(body.position) + Vec3(0.0, std::cos(t), std::sin(t));
  };
  RigidBody start;
  start.position = Vec3(1.0, 2.0, 3.0);
  const double z_slip = 1.0 - std::cos(end);
  const Vec3 exact =
      start.position + Vec3(0.2 * end + rate * (3.0 * end + 0.05 * end * end + end - std::sin(end)),
                            std::sin(end), 0.1 * end + z_slip);
  for (int s : {2, 5, 10, 20})
    EXPECT_NEAR(
        measure_order(s, flow, set_motion, start, end, 20,
                      [&](const RigidBody &body) { return (body.position - exact).norm(); }),
        2.0, 0.15)
        << s << " stages";
}

TEST(RigidMotionInStages, ConstantRotationAndSlipAreExact)
{
  const BackgroundFlow flow = make_shear_flow(0.9, Vec3(0.2, -0.1, 0.4));
  const Vec3 slip(0.3, 0.5, -0.7), start(1.0, 2.0, 3.0), rotation(0.3, -0.8, 0.5);
  const SetMotion set_motion = [&](double, RigidBody &body) {
    body.velocity = flow.velocity(body.position) + slip;
    body.rotation = rotation;
  };
  RigidBody body;
  body.position = start;
  double t = 0.0;
  for (double h : {0.5, 0.1, 1.7}) {
    advance_in_stages(7, flow, set_motion, t, h, body);
    t += h;
  }
  const Vec3 drift = slip + flow.mean;
  const Vec3 exact = start + t * drift +
                     Vec3(flow.shear_rate() * (start[2] * t + 0.5 * drift[2] * t * t), 0.0, 0.0);
  EXPECT_LT((body.position - exact).norm(), 1e-13 * exact.norm());
  const Eigen::AngleAxisd turned(t * rotation.norm(), rotation.normalized());
  EXPECT_LT((body.orientation.toRotationMatrix() - turned.toRotationMatrix()).norm(), 1e-13);
}

TEST(RigidMotionInStages, TurnRateIsTheDerivativeOfTheRotationVector)
{
  RigidBody body;
  body.orientation = Eigen::Quaterniond(0.7, 0.4, -0.3, 0.2).normalized();
  RigidBodyStages stages = begin_stages(BackgroundFlow(), body);
  stages.turn = Vec3(0.2, -0.1, 0.15);
  turn_body(stages.turn, body);
  body.rotation = Vec3(0.5, 0.7, -0.4);
  const double h = 1e-5;
  RigidBody ahead = body, behind = body;
  turn_body(h * body.rotation, ahead);
  turn_body(-h * body.rotation, behind);
  const auto find_turn = [&stages](const RigidBody &b) {
    const Eigen::AngleAxisd turn(b.orientation * stages.start_orientation.conjugate());
    return Vec3(turn.angle() * turn.axis());
  };
  EXPECT_LT((find_turn(body) - stages.turn).norm(), 1e-14);
  const Vec3 exact = (find_turn(ahead) - find_turn(behind)) / (2.0 * h);
  // The series ends before |turn|^4 / 720.
  EXPECT_LT((compute_turn_rate(stages, body) - exact).norm(),
            std::pow(stages.turn.norm(), 4) / 360.0 * body.rotation.norm());
  EXPECT_GT((body.rotation - exact).norm(), 1e-2);
}

TEST(RigidMotion, RestartValuesContinueExactly)
{
  const BackgroundFlow flow = make_shear_flow(0.8, Vec3(0.1, 0.0, 0.0));
  RigidBody body;
  body.position = Vec3(5.0, -2.0, 1.0);
  const auto step = [&flow](RigidBody &b, double dt) {
    b.velocity = flow.velocity(b.position) + b.orientation * Vec3(0.1, 0.2, 0.3);
    b.rotation = compute_jeffery_rotation(0.8, b.orientation * Vec3::UnitX());
    advance(Stepper::AdamsBashforth2, flow, dt, b);
  };
  for (int i = 0; i < 5; i++)
    step(body, 0.1 + 0.01 * i);
  const auto stored = to_values(body);
  RigidBody restarted = from_values(stored.data());
  EXPECT_EQ(to_values(restarted), stored);
  for (int i = 0; i < 3; i++) {
    step(body, 0.07);
    step(restarted, 0.07);
  }
  EXPECT_EQ(to_values(body), to_values(restarted));
  auto damaged = stored;
  damaged[4] += 0.5;
  EXPECT_THROW(from_values(damaged.data()), Error);
}

TEST(RigidMotion, CentroidOfTheVolumeIsTheBodysReferencePoint)
{
  // A tetrahedron: the mean of its corners, wherever it is.
  Points corners(3, 4);
  corners << 0, 3, 0, 0, 0, 0, 2, 0, 0, 0, 0, 5;
  const std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const Vec3 far(1000.0, -2000.0, 500.0);
  EXPECT_LT((make_rigid_body(corners.colwise() + far, faces).position - far - Vec3(0.75, 0.5, 1.25))
                .norm(),
            1e-12);
  const std::vector<Triangle> inside_out = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  EXPECT_THROW(make_rigid_body(corners, inside_out), Error);
}

TEST(RigidMotion, NodesFollowTheBodyAndItsCentroid)
{
  const SurfaceMesh mesh = make_lopsided_body();
  RigidBody body = make_rigid_body(mesh.nodes, mesh.triangles);
  EXPECT_GT(body.position.norm(), 0.1);
  const Points frame = compute_body_frame(body, mesh.nodes);
  EXPECT_LT(compute_volume_centroid(frame, mesh.triangles).norm(), 1e-15);
  body.velocity = Vec3(1.0, 2.0, 3.0);
  body.rotation = Vec3(0.4, -0.9, 0.3);
  advance(Stepper::Euler, BackgroundFlow(), 0.5, body);
  const Points moved = compute_nodes(body, frame);
  EXPECT_LT((compute_volume_centroid(moved, mesh.triangles) - body.position).norm(), 1e-14);
  EXPECT_LT((compute_body_frame(body, moved) - frame).norm(), 1e-13);
  // A small step moves the nodes by velocity + rotation x arm.
  RigidBody later = body;
  const double dt = 1e-6;
  advance(Stepper::Euler, BackgroundFlow(), dt, later);
  const Vec3 motion = (compute_nodes(later, frame).col(7) - moved.col(7)) / dt;
  EXPECT_LT((motion - body.velocity - body.rotation.cross(moved.col(7) - body.position)).norm(),
            1e-5);
  const Vec3 surface_centroid = moved.rowwise().mean();
  const Vec3 there = body.velocity + body.rotation.cross(surface_centroid - body.position);
  EXPECT_LT(
      (compute_reference_velocity(body, there, body.rotation, surface_centroid) - body.velocity)
          .norm(),
      1e-14);
}

TEST(RigidMotion, CopiesOfAShapeAreFoundWhateverTheyAreTurned)
{
  const SurfaceMesh disc = make_mesh(*make_spheroid(2.0, 0.5), 162);
  const Mat3 turn = Eigen::AngleAxisd(2.0, Vec3(1.0, -0.5, 0.3).normalized()).toRotationMatrix();
  const auto found = find_rotation(disc.nodes, turn * disc.nodes);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - turn).norm(), 1e-13);
  Points other = turn * disc.nodes;
  other(1, 80) += 1e-8;
  EXPECT_FALSE(find_rotation(disc.nodes, other));
  EXPECT_FALSE(find_rotation(disc.nodes, 1.001 * disc.nodes));
  const SurfaceMesh lopsided = make_lopsided_body();
  EXPECT_FALSE(find_rotation(lopsided.nodes, -lopsided.nodes));    // its mirror image
  EXPECT_FALSE(find_rotation(disc.nodes, disc.nodes.leftCols(42)));
}
