// What the motion of a suspension must not depend on, and what the theory of Stokes flow says of
// any solution: positive power, reciprocity. And what the solver says when it fails.
#include "biem_error.h"
#include "coupled_scene.h"
#include <gtest/gtest.h>
#include <random>

using namespace biem;

namespace {

constexpr double kSumTolerance = 1e-7, kSolverTolerance = 1e-9;

Evaluation evaluate(const CoupledScene &scene, const Points &forces, const Conditions &conditions)
{
  DistributedSuspension suspension(MPI_COMM_WORLD, scene, kSumTolerance,
                                   make_settings(kSolverTolerance));
  return suspension.evaluate(forces, conditions);
}

Conditions make_gradient_flow()
{
  Conditions conditions;
  conditions.flow.gradient << 0.1, 0.2, 0.9, 0.0, -0.3, 0.1, 0.2, 0.0, 0.2;
  return conditions;
}

Conditions make_mean_flow(const Vec3 &mean)
{
  Conditions conditions;
  conditions.flow.mean = mean;
  return conditions;
}

// The same scene turned by a matrix that maps the axes onto each other.
CoupledScene turn(const CoupledScene &scene, const Mat3 &rotation)
{
  CoupledScene turned(rotation * scene.cell * rotation.transpose());
  for (size_t s = 0; s < scene.parts.size(); s++) {
    const Surface &surface = scene.scene.surfaces[s];
    const SurfaceMesh mesh{rotation * scene.parts[s].nodes, scene.parts[s].triangles};
    if (surface.kind == SurfaceKind::Cell)
      turned.add_cell(surface.viscosity_ratio, mesh);
    else if (surface.kind == SurfaceKind::Wall)
      turned.add_wall(rotation * surface.velocity, mesh);
    else {
      const SurfaceMesh &shape = scene.scene.shapes[surface.shape];
      const Mat3 orientation = rotation * scene.orientations[s];
      turned.add_body(shape, orientation, mesh.nodes.col(0) - orientation * shape.nodes.col(0));
    }
  }
  turned.add_points(rotation * scene.nodes(Eigen::all, scene.list_nodes(-1)));
  return turned;
}

double compute_power(const CoupledScene &scene, const Points &forces, const Points &velocity,
                     int surface)
{
  double power = 0.0;
  for (int i : scene.list_nodes(surface))
    power += forces.col(i).dot(velocity.col(i));
  return power;
}

Points select_forces(const CoupledScene &scene, int surface)
{
  const Points all = make_forces(scene);
  Points forces = Points::Zero(3, all.cols());
  for (int i : scene.list_nodes(surface))
    forces.col(i) = all.col(i);
  return forces;
}

CoupledScene make_scene_at_rest(double ratio, int n_nodes)
{
  CoupledScene scene = make_coupled_scene(make_box(), ratio, n_nodes);
  scene.scene.surfaces[kWall].velocity.setZero();
  return scene;
}

std::string find_message(const std::function<void()> &run)
{
  try {
    run();
  } catch (const Error &e) {
    return e.what();
  }
  return "";
}

}    // namespace

TEST(CoupledSymmetry, AMeanVelocityOfWallsAndFluidTogetherOnlyAdds)
{
  const Vec3 mean(0.7, -0.4, 0.0);
  for (const Mat3 &cell : {make_box(), make_tilted_box()}) {
    CoupledScene scene = make_coupled_scene(cell, 5.0);
    const Points forces = make_forces(scene);
    const Evaluation a = evaluate(scene, forces, Conditions());
    if (scene.scene.has(SurfaceKind::Wall)) scene.scene.surfaces[kWall].velocity += mean;
    const Evaluation b = evaluate(scene, forces, make_mean_flow(mean));
    EXPECT_LT(compute_difference(b.velocity, a.velocity), 1e-12);
    EXPECT_LT((b.wall_force - a.wall_force).norm(), 1e-11 * a.wall_force.norm() + 1e-300);
    EXPECT_EQ(b.mean_velocity - a.mean_velocity, mean);
  }
}

TEST(CoupledSymmetry, TheImageInWhichASurfaceIsDoesNotMatter)
{
  CoupledScene scene = make_coupled_scene(make_tilted_box(), 5.0);
  const Points forces = make_forces(scene);
  const Conditions conditions = make_gradient_flow();
  const Evaluation a = evaluate(scene, forces, conditions);
  scene.shift_surface(kContrast, scene.cell * Vec3(2, -1, 3));
  const Evaluation one = evaluate(scene, forces, conditions);
  for (int s : {kContrast, kRigid, kFree})
    scene.shift_surface(s, scene.cell * Vec3(-1, 4, 2));
  const Evaluation all = evaluate(scene, forces, conditions);
  for (const Evaluation &b : {one, all}) {
    EXPECT_LT(compute_difference(b.velocity, a.velocity), 1e-10);
    for (int s : {kContrast, kRigid})
      EXPECT_LT((b.stresslets[s] - a.stresslets[s]).norm(), 1e-10 * a.stresslets[s].norm());
    EXPECT_LT((b.motions[kRigid].rotation - a.motions[kRigid].rotation).norm(), 1e-10);
  }
  EXPECT_GT(compute_difference(a.velocity, evaluate(scene, forces, Conditions()).velocity), 0.1);
}

TEST(CoupledSymmetry, TheOriginDoesNotMatter)
{
  const Vec3 shift(0.37, 2.2, -0.81);
  CoupledScene scene = make_coupled_scene(make_tilted_box(), 5.0);
  const Points forces = make_forces(scene);
  const Conditions conditions = make_gradient_flow();
  const Evaluation a = evaluate(scene, forces, conditions);
  scene.nodes.colwise() += shift;
  for (SurfaceMesh &part : scene.parts)
    part.nodes.colwise() += shift;
  const Evaluation b = evaluate(scene, forces, conditions);
  EXPECT_LT(compute_difference(b.velocity, a.velocity), 10.0 * kSumTolerance);
}

TEST(CoupledSymmetry, SurfacesAreEqual)
{
  const CoupledScene scene = make_coupled_scene(make_box(), 5.0);
  const CoupledScene other = scene.select({kWall, kFree, kContrast, kRigid});
  const Conditions conditions = make_mean_flow(Vec3(0.5, 0.2, 0.0));
  const Evaluation a = evaluate(scene, make_forces(scene), conditions);
  const Evaluation b = evaluate(other, make_forces(other), conditions);
  EXPECT_LT(compute_difference(b.velocity, a.velocity(Eigen::all, other.numbers)), 1e-10);
  EXPECT_LT((b.stresslets[3] - a.stresslets[kRigid]).norm(), 1e-9 * b.stresslets[3].norm());
}

TEST(CoupledSymmetry, DirectionsAreEqual)
{
  Mat3 rotation;    // x to y, y to z, z to x: the wall is normal to x then
  rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const CoupledScene scene = make_coupled_scene(make_box(), 5.0), other = turn(scene, rotation);
  const Points forces = make_forces(scene);
  const Vec3 mean(0.5, 0.2, 0.0);
  const Evaluation a = evaluate(scene, forces, make_mean_flow(mean));
  const Evaluation b = evaluate(other, rotation * forces, make_mean_flow(rotation * mean));
  EXPECT_LT(compute_difference(b.velocity, rotation * a.velocity), 10.0 * kSumTolerance);
  EXPECT_LT((b.wall_force - rotation * a.wall_force).norm(),
            20.0 * kSumTolerance * a.wall_force.norm());
}

TEST(CoupledSymmetry, AnyForcesDissipate)
{
  for (double ratio : {0.2, 5.0}) {
    const CoupledScene scene = make_scene_at_rest(ratio, 42);
    DistributedSuspension suspension(MPI_COMM_WORLD, scene, 1e-5, make_settings(1e-6));
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int trial = 0; trial < 4; trial++) {
      Points forces = Points::Zero(3, scene.nodes.cols());
      for (int s : {kContrast, kRigid, kFree})
        for (int i : scene.list_nodes(s))
          forces.col(i) = Vec3(uniform(generator), uniform(generator), uniform(generator));
      const Points velocity = suspension.evaluate(forces, Conditions()).velocity;
      const double power = forces.cwiseProduct(velocity).sum();
      if (is_first_rank())
        std::printf("  ratio %g power %.3f of %.3f\n", ratio, power,
                    forces.norm() * velocity.norm());
      EXPECT_GT(power, 0.3 * forces.norm() * velocity.norm());
    }
  }
}

TEST(CoupledSymmetry, ForcesAndVelocitiesOfTwoSurfacesAreReciprocal)
{
  for (int n_nodes : {42, 162}) {
    const CoupledScene scene = make_scene_at_rest(5.0, n_nodes);
    DistributedSuspension suspension(MPI_COMM_WORLD, scene, 1e-5, make_settings(1e-6));
    std::vector<Points> forces, velocities;
    for (int s : {kContrast, kRigid, kFree}) {
      forces.push_back(select_forces(scene, s));
      velocities.push_back(suspension.evaluate(forces.back(), Conditions()).velocity);
    }
    for (int a : {kContrast, kRigid, kFree})
      for (int b = 0; b < a; b++) {
        const double ab = compute_power(scene, forces[a], velocities[b], a);
        const double ba = compute_power(scene, forces[b], velocities[a], b);
        const double size = std::sqrt(compute_power(scene, forces[a], velocities[a], a) *
                                      compute_power(scene, forces[b], velocities[b], b));
        if (is_first_rank())
          std::printf("  %d nodes: %d %d: %.5f %.5f of %.5f, difference %.1e\n", n_nodes, a, b, ab,
                      ba, size, (ab - ba) / size);
        EXPECT_LT(std::fabs(ab - ba), (n_nodes == 42 ? 5e-3 : 1.2e-3) * size);
        EXPECT_GT(std::fabs(ab), 0.01 * size);
      }
  }
}

// The force on the walls when a force acts on a surface, and the motion of the surface when the
// walls move. Of second order in the edge of the surface.
TEST(CoupledSymmetry, WallsAndSurfacesAreReciprocal)
{
  const Vec3 wall_velocity(0.3, -0.5, 0.0);
  double previous[3] = {};
  for (int n_nodes : {42, 162}) {
    CoupledScene scene = make_scene_at_rest(5.0, n_nodes);
    scene.scene.surfaces[kWall].velocity = wall_velocity;
    const Points none = Points::Zero(3, scene.nodes.cols());
    const Points moved = evaluate(scene, none, Conditions()).velocity;
    scene.scene.surfaces[kWall].velocity.setZero();
    DistributedSuspension suspension(MPI_COMM_WORLD, scene, 1e-5, make_settings(1e-6));
    for (int s : {kContrast, kRigid, kFree}) {
      const Points forces = select_forces(scene, s);
      const Vec3 wall_force = suspension.evaluate(forces, Conditions()).wall_force;
      const double a = compute_power(scene, forces, moved, s), b = -wall_force.dot(wall_velocity);
      const double error = std::fabs((a - b) / b);
      if (is_first_rank())
        std::printf("  %d nodes: surface %d: %.5f %.5f, difference %.1e\n", n_nodes, s, a, b,
                    error);
      EXPECT_LT(error, n_nodes == 42 ? 0.06 : 0.015);
      if (n_nodes == 162) EXPECT_LT(error, 0.45 * previous[s]);
      previous[s] = error;
    }
  }
}

TEST(CoupledErrors, NotConvergedNamesResidualIterationsAndSurface)
{
  const CoupledScene scene = make_coupled_scene(make_box(), 50.0).select({kRigid, kContrast});
  SuspensionSettings settings = make_settings(1e-6);
  settings.control.max_iterations = 1;
  DistributedSuspension suspension(MPI_COMM_WORLD, scene, 1e-4, settings);
  try {
    suspension.evaluate(select_forces(scene, 1), Conditions());
    FAIL() << "one iteration is not enough";
  } catch (const NotConverged &e) {
    const std::string message = e.what();
    EXPECT_NE(message.find("relative residual 0."), std::string::npos) << message;
    EXPECT_NE(message.find("after 1 iterations"), std::string::npos) << message;
    EXPECT_NE(message.find("molecule 2"), std::string::npos) << message;
    EXPECT_EQ(e.report().iterations, 1);
    EXPECT_GT(e.report().residual, 1e-6);
    if (is_first_rank()) std::printf("  %s\n", message.c_str());
  }
}

TEST(CoupledErrors, FlowsThatWallsDoNotAllow)
{
  CoupledScene scene = make_coupled_scene(make_box(), 5.0).select({kWall});
  const Points none = Points::Zero(3, scene.nodes.cols());
  DistributedSuspension given(MPI_COMM_WORLD, scene, 1e-4, make_settings(1e-4));
  DistributedSuspension driven(MPI_COMM_WORLD, scene, 1e-4,
                               make_settings(1e-4, Drive::PressureDrop));
  const auto run = [&](DistributedSuspension &suspension, const Conditions &conditions) {
    return find_message([&] { suspension.evaluate(none, conditions); });
  };
  EXPECT_EQ(run(given, make_mean_flow(Vec3::UnitX())), "");
  EXPECT_NE(run(given, make_mean_flow(Vec3::UnitZ())).find("closed wall"), std::string::npos);
  EXPECT_NE(run(given, make_gradient_flow()).find("linear background flow"), std::string::npos);
  Conditions drop;
  drop.pressure_drop = Vec3::UnitY();
  EXPECT_EQ(run(driven, drop), "");
  drop.pressure_drop = Vec3::UnitZ();
  EXPECT_NE(run(driven, drop).find("closed wall"), std::string::npos);
  scene.scene.surfaces[0].velocity = Vec3::UnitZ();
  DistributedSuspension pushed(MPI_COMM_WORLD, scene, 1e-4, make_settings(1e-4));
  EXPECT_NE(run(pushed, Conditions()).find("wall velocity"), std::string::npos);
  const CoupledScene cells = make_coupled_scene(make_box(), 5.0).select({kContrast});
  EXPECT_NE(find_message([&] {
              DistributedSuspension(MPI_COMM_WORLD, cells, 1e-4,
                                    make_settings(1e-4, Drive::PressureDrop));
            }).find("this scene has none"),
            std::string::npos);
}
