// A rigid body alone in free space by the completed double layer, against exact solutions:
// stresslet and rotation of a sphere, Jeffery's spheroid, bodies driven by forces and torques.
#include "free_space_body.h"
#include <gtest/gtest.h>

using namespace biem;
using free_space::Body;

namespace {

constexpr double kViscosity = 1.7;

Mat3 make_shear(double rate)
{
  Mat3 gradient = Mat3::Zero();
  gradient(0, 2) = rate;
  return gradient;
}

// Any strain that is no symmetry of the mesh.
Mat3 make_strain()
{
  Mat3 strain;
  strain << 0.4, 0.7, -0.2, 0.7, -0.9, 0.3, -0.2, 0.3, 0.5;
  return strain;
}

SurfaceMesh rotate(const SurfaceMesh &mesh, const Mat3 &rotation)
{
  return {rotation * mesh.nodes, mesh.triangles};
}

double compute_stresslet_error(int n_nodes)
{
  const double radius = 1.3;
  const Body body(make_mesh(*make_sphere(radius), n_nodes));
  const Mat3 strain = make_strain();
  const Mat3 exact = 20.0 / 3.0 * M_PI * kViscosity * std::pow(radius, 3) * strain;
  const Mat3 computed = body.compute_stresslet_moment(body.solve_in_flow(strain), kViscosity);
  return (computed - exact).norm() / exact.norm();
}

// Kim & Karrila, Microhydrodynamics (1991), Sec. 3.3: resistances of an oblate spheroid in units of
// those of the sphere around it; along: about or along the symmetry axis.
struct OblateResistance {
  double force_along, force_across, torque_along, torque_across;
};

OblateResistance compute_oblate_resistance(double aspect_ratio)
{
  const double e = std::sqrt(1.0 - aspect_ratio * aspect_ratio), e2 = e * e, e3 = e * e2;
  const double c = std::atan2(e, aspect_ratio), root = e * aspect_ratio;
  return {4.0 / 3.0 * e3 / ((2.0 * e2 - 1.0) * c + root),
          8.0 / 3.0 * e3 / ((2.0 * e2 + 1.0) * c - root), 2.0 / 3.0 * e3 / (c - root),
          2.0 / 3.0 * e3 * (2.0 - e2) / (root - (1.0 - 2.0 * e2) * c)};
}

}    // namespace

TEST(RigidInFreeSpace, StressletOfASphereConvergesToEinsteins)
{
  const double coarse = compute_stresslet_error(162), fine = compute_stresslet_error(642);
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, 0.0075);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3);
}

TEST(RigidInFreeSpace, SphereInShearTurnsWithHalfTheVorticity)
{
  const Body body(make_mesh(*make_sphere(0.8), 162));
  const SurfaceMotion motion = body.compute_motion(body.solve_in_flow(make_shear(1.5)));
  EXPECT_LT((motion.rotation - Vec3(0.0, 0.75, 0.0)).norm(), 1e-10);
  EXPECT_LT(motion.velocity.norm(), 1e-10);
  EXPECT_LT(std::fabs(motion.flux), 1e-10);
}

TEST(RigidInFreeSpace, BodyMovesWithAFlowThatIsARigidMotion)
{
  const Body body(make_mesh(*make_spheroid(2.0, 0.5), 162));
  Mat3 spin;    // of the angular velocity (1, 2, 3)
  spin << 0.0, -3.0, 2.0, 3.0, 0.0, -1.0, -2.0, 1.0, 0.0;
  const Points density = body.solve_in_flow(spin);
  EXPECT_LT((body.compute_motion(density).rotation - Vec3(1.0, 2.0, 3.0)).norm(), 1e-11);
  EXPECT_LT(body.compute_stresslet_moment(density, kViscosity).norm(), 1e-10);
}

TEST(RigidInFreeSpace, OblateSpheroidTurnsAtJefferysRate)
{
  const double aspect_ratio = 0.25, rate = 1.3;
  const double bretherton =
      (aspect_ratio * aspect_ratio - 1.0) / (aspect_ratio * aspect_ratio + 1.0);
  const Mat3 gradient = make_shear(rate), strain = 0.5 * (gradient + gradient.transpose());
  double errors[2];
  for (int level = 0; level < 2; level++) {
    const SurfaceMesh mesh = make_mesh(*make_spheroid(2.0, 2.0 * aspect_ratio), level ? 642 : 162);
    const Body body(mesh);
    errors[level] = 0.0;
    for (const Vec3 &turn : {Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.8, 0.0), Vec3(0.0, -1.2, 0.0),
                             Vec3(0.9, 0.4, -0.3), Vec3(M_PI / 2.0, 0.0, 0.0)}) {
      // The flow turned into the body's frame is the body turned in the flow.
      const Mat3 r = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()).toRotationMatrix();
      const Points density = body.solve_in_flow(r.transpose() * gradient * r);
      const Vec3 rotation = r * body.compute_motion(density).rotation;
      const Vec3 axis = r.col(2);
      const Vec3 exact = Vec3(0.0, 0.5 * rate, 0.0) + bretherton * axis.cross(strain * axis);
      errors[level] = std::max(errors[level], (rotation - exact).norm() / rate);
    }
  }
  EXPECT_LT(errors[0], 0.005);    // of the shear rate
  EXPECT_LT(errors[1], 0.0006);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
}

TEST(RigidInFreeSpace, SolutionTurnsWithTheBody)
{
  const SurfaceMesh mesh = make_mesh(*make_spheroid(1.0, 0.4), 162);
  const Mat3 r = Eigen::AngleAxisd(0.7, Vec3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Mat3 gradient = make_shear(1.0) + make_strain();
  const Points turned = Body(rotate(mesh, r)).solve_in_flow(gradient);
  const Points own = Body(mesh).solve_in_flow(r.transpose() * gradient * r);
  EXPECT_LT((turned - r * own).norm(), 1e-11 * own.norm());
}

TEST(RigidInFreeSpace, ForceAndTorqueDriveASphereAsStokesSays)
{
  const double radius = 0.7;
  const Vec3 force(0.3, -1.0, 0.5), torque(-0.2, 0.4, 0.9);
  const Vec3 velocity = force / (6.0 * M_PI * kViscosity * radius);
  const Vec3 rotation = torque / (8.0 * M_PI * kViscosity * std::pow(radius, 3));
  double errors[2][2];
  for (int level = 0; level < 2; level++) {
    const Body body(make_mesh(*make_sphere(radius), level ? 642 : 162));
    const SurfaceMotion motion = body.compute_motion(body.solve_driven(force, torque, kViscosity));
    errors[level][0] = (motion.velocity - velocity).norm() / velocity.norm();
    errors[level][1] = (motion.rotation - rotation).norm() / rotation.norm();
  }
  for (int part = 0; part < 2; part++) {
    EXPECT_LT(errors[1][part], 0.005);
    EXPECT_NEAR(std::log2(errors[0][part] / errors[1][part]), 2.0, 0.3);
  }
}

// The weighted force density is the traction of a translating ellipsoid; of a turning one it is not,
// and there the error is larger.
TEST(RigidInFreeSpace, ForceAndTorqueDriveAnOblateSpheroidAsOberbeckSays)
{
  const double radius = 1.1, aspect_ratio = 0.25;
  const OblateResistance exact = compute_oblate_resistance(aspect_ratio);
  const double drag = 6.0 * M_PI * kViscosity * radius;
  const double turning = 8.0 * M_PI * kViscosity * std::pow(radius, 3);
  double errors[2][4];
  for (int level = 0; level < 2; level++) {
    const auto shape = make_spheroid(2.0 * radius, 2.0 * radius * aspect_ratio);
    const Body body(make_mesh(*shape, level ? 642 : 162));
    for (int k = 0; k < 2; k++) {
      const Vec3 unit = Vec3::Unit(2 * k);
      const SurfaceMotion motion = body.compute_motion(body.solve_driven(unit, unit, kViscosity));
      const double force = k ? exact.force_along : exact.force_across;
      const double torque = k ? exact.torque_along : exact.torque_across;
      errors[level][k] = std::fabs(motion.velocity[2 * k] * drag * force - 1.0);
      errors[level][2 + k] = std::fabs(motion.rotation[2 * k] * turning * torque - 1.0);
    }
  }
  for (int k = 0; k < 4; k++) {
    std::printf("  %s %s error %.2e, ratio %.2f\n", k < 2 ? "velocity" : "rotation",
                k % 2 ? "along the axis" : "across", errors[1][k], errors[0][k] / errors[1][k]);
    EXPECT_LT(errors[1][k], k < 2 ? 0.004 : 0.012) << k;
    EXPECT_GT(std::log2(errors[0][k] / errors[1][k]), 1.8) << k;
  }
}
