// The coupled system of cells, particles and walls against dense matrices of the same equations,
// for every combination of blocks; balances; what must not matter. On 1, 2 and 4 ranks.
#include "coupled_oracle.h"
#include <gtest/gtest.h>

using namespace biem;

namespace {

constexpr double kSumTolerance = 1e-7, kSolverTolerance = 1e-8;

// The full scenes and their layers are made once: combinations of surfaces are blocks of them.
struct Oracle {
  CoupledScene scene;
  DenseLayers layers;
  explicit Oracle(const Mat3 &cell) :
      scene(make_coupled_scene(cell, 5.0)), layers(MPI_COMM_WORLD, scene)
  {
  }
};

const Oracle &get_oracle()
{
  static const Oracle oracle(make_box());
  return oracle;
}

const Oracle &get_tilted_oracle()
{
  static const Oracle oracle(make_tilted_box());
  return oracle;
}

Conditions make_mean_flow()
{
  Conditions conditions;
  conditions.flow.mean = Vec3(0.5, 0.2, 0.0);
  return conditions;
}

Evaluation evaluate(const CoupledScene &scene, const Conditions &conditions,
                    MPI_Comm comm = MPI_COMM_WORLD)
{
  DistributedSuspension suspension(comm, scene, kSumTolerance, make_settings(kSolverTolerance));
  return suspension.evaluate(make_forces(scene), conditions);
}

// In the frame in which the oracle works.
Points add_flow(const CoupledScene &scene, const Points &velocity, const BackgroundFlow &flow)
{
  Points sum = velocity;
  for (Eigen::Index i = 0; i < sum.cols(); i++)
    sum.col(i) += flow.velocity(scene.nodes.col(i));
  return sum;
}

void compare_with_oracle(const Oracle &oracle, const std::vector<int> &surfaces, double ratio,
                         const Conditions &conditions)
{
  CoupledScene whole = oracle.scene;
  whole.scene.surfaces[kContrast].viscosity_ratio = ratio;
  const CoupledScene scene = whole.select(surfaces);
  const Evaluation e = evaluate(scene, conditions);
  const Points velocity = add_flow(scene, e.velocity, conditions.flow);
  const Points density = make_densities(scene, oracle.layers, make_forces(scene));
  double errors[2], wall_errors[2];
  for (Form form : {Form::Deflated, Form::Original}) {
    const DenseSolution exact = DenseSuspension(oracle.layers, scene, form)
                                    .solve(density, make_settings(1e-8).viscosity, conditions.flow);
    const int k = form == Form::Original;
    errors[k] = compute_difference(velocity, exact.velocity);
    wall_errors[k] = scene.scene.has(SurfaceKind::Wall)
                         ? (e.wall_force - exact.wall_force).norm() / exact.wall_force.norm()
                         : 0.0;
  }
  if (is_first_rank())
    std::printf("  surfaces %s ratio %g: %d iterations, difference %.1e, original form %.1e; "
                "wall force %.1e, %.1e\n",
                ::testing::PrintToString(surfaces).c_str(), ratio, e.solver.iterations, errors[0],
                errors[1], wall_errors[0], wall_errors[1]);
  EXPECT_LT(errors[0], 2.0 * kSolverTolerance);
  EXPECT_LT(wall_errors[0], 2.0 * kSolverTolerance);
  // Row sums of all surfaces together, and fluxes that the facets leave.
  EXPECT_LT(errors[1], 2e-3);
  EXPECT_LT(wall_errors[1], 2e-3);
}

}    // namespace

TEST(CoupledSystem, AgreesWithDenseMatricesInEveryCombinationOfBlocks)
{
  for (const std::vector<int> &surfaces :
       std::vector<std::vector<int>>{{kContrast},
                                     {kRigid},
                                     {kWall},
                                     {kContrast, kRigid},
                                     {kContrast, kWall},
                                     {kRigid, kWall},
                                     {kFree, kWall},
                                     {kContrast, kRigid, kWall},
                                     {kContrast, kRigid, kFree, kWall}})
    compare_with_oracle(get_oracle(), surfaces, 5.0, make_mean_flow());
}

TEST(CoupledSystem, AgreesWithDenseMatricesAtOtherViscosityRatios)
{
  for (double ratio : {0.2, 50.0})
    compare_with_oracle(get_oracle(), {kContrast, kRigid, kFree, kWall}, ratio, make_mean_flow());
}

TEST(CoupledSystem, AgreesWithDenseMatricesInAShearedCell)
{
  Conditions conditions;
  conditions.flow.mean = Vec3(0.2, -0.1, 0.4);
  conditions.flow.gradient << 0.1, 0.2, 0.9, 0.0, -0.3, 0.1, 0.2, 0.0, 0.2;
  for (double ratio : {0.2, 5.0})
    compare_with_oracle(get_tilted_oracle(), {kContrast, kRigid, kFree}, ratio, conditions);
}

TEST(CoupledSystem, AgreesWithDenseMatricesWithConsistentTractions)
{
  const Oracle &oracle = get_oracle();
  const CoupledScene scene = oracle.scene.select({kContrast, kRigid, kFree, kWall});
  const Points forces = make_forces(scene);
  const BackgroundFlow none;
  SuspensionSettings settings = make_settings(kSolverTolerance);
  settings.traction = Traction::Consistent;
  const Points velocity = DistributedSuspension(MPI_COMM_WORLD, scene, kSumTolerance, settings)
                              .evaluate(forces, Conditions())
                              .velocity;
  const DenseSuspension dense(oracle.layers, scene, Form::Deflated);
  const auto solve = [&](Traction traction) {
    return dense
        .solve(make_densities(scene, oracle.layers, forces, traction), settings.viscosity, none)
        .velocity;
  };
  EXPECT_LT(compute_difference(velocity, solve(Traction::Consistent)), 2.0 * kSolverTolerance);
  EXPECT_GT(compute_difference(velocity, solve(Traction::Lumped)), 1e-3);
}

TEST(CoupledSystem, NetFluxThroughClosedSurfacesVanishes)
{
  const Oracle &oracle = get_oracle();
  const Evaluation e = evaluate(oracle.scene, make_mean_flow());
  for (int s : {kContrast, kRigid, kFree}) {
    double flux = 0.0, area = 0.0;
    for (int i : oracle.scene.list_nodes(s)) {
      flux += oracle.layers.gradient.col(i).dot(e.velocity.col(i));
      area += oracle.layers.areas[i];
    }
    const double size = std::sqrt(e.velocity.squaredNorm() / e.velocity.cols());
    if (is_first_rank()) std::printf("  surface %d: relative flux %.1e\n", s, flux / (area * size));
    EXPECT_LT(std::fabs(flux), 2e-3 * area * size);
  }
}

TEST(CoupledSystem, MeanPressureGradientBalancesAllForces)
{
  const CoupledScene &scene = get_oracle().scene;
  const Points forces = make_forces(scene);
  const Evaluation e = evaluate(scene, make_mean_flow());
  Vec3 wall = Vec3::Zero();
  for (int i : scene.list_nodes(kWall))
    wall += e.areas[i] * e.traction.col(i);
  const Vec3 total = forces.rowwise().sum() + wall;
  const double volume = scene.cell.determinant();
  EXPECT_LT((total + volume * e.pressure_drop).norm(), 1e-12 * wall.norm());
  EXPECT_LT((e.wall_force - wall).norm(), 1e-12 * wall.norm());
  EXPECT_NEAR(e.wall_area, scene.cell(0, 0) * scene.cell(1, 1), 1e-12 * e.wall_area);
  EXPECT_GT(e.pressure_drop[0], 0.1);
}

TEST(CoupledSystem, PressureDropReturnsTheMeanVelocityThatNeedsIt)
{
  for (const std::vector<int> &surfaces :
       std::vector<std::vector<int>>{{kFree, kWall}, {kContrast, kRigid, kFree, kWall}}) {
    const CoupledScene scene = get_oracle().scene.select(surfaces);
    const Conditions given = make_mean_flow();
    const Evaluation a = evaluate(scene, given);
    Conditions conditions;
    conditions.pressure_drop = a.pressure_drop;
    conditions.pressure_drop[2] = 0.0;    // the wall lets nothing through
    DistributedSuspension suspension(MPI_COMM_WORLD, scene, kSumTolerance,
                                     make_settings(kSolverTolerance, Drive::PressureDrop));
    const Evaluation b = suspension.evaluate(make_forces(scene), conditions);
    const double size = given.flow.mean.norm();
    const double error = (b.mean_velocity - given.flow.mean).norm() / size;
    const double field = compute_difference(b.velocity, add_flow(scene, a.velocity, given.flow));
    const double drop =
        (b.pressure_drop - a.pressure_drop).head<2>().norm() / a.pressure_drop.head<2>().norm();
    if (is_first_rank())
      std::printf("  %d iterations, mean velocity %.1e, velocities %.1e, pressure drop %.1e\n",
                  b.solver.iterations, error, field, drop);
    EXPECT_LT(error, 1e-6);
    EXPECT_LT(field, 1e-6);
    EXPECT_LT(drop, 1e-6);
  }
}

TEST(CoupledSystem, CellsOfRatioNearOneAreCellsWithoutUnknowns)
{
  const auto solve = [](double ratio) {
    CoupledScene whole = get_oracle().scene;
    whole.scene.surfaces[kContrast].viscosity_ratio = ratio;
    return evaluate(whole.select({kContrast, kRigid, kFree, kWall}), make_mean_flow()).velocity;
  };
  const Points one = solve(1.0);
  EXPECT_LT(compute_difference(solve(1.0 + 1e-12), one), 1e-7);
  const double step = 1e-3;
  const Points above = solve(1.0 + step) - one, below = solve(1.0 - step) - one;
  if (is_first_rank())
    std::printf("  change %.1e, its asymmetry %.1e\n", above.norm() / one.norm(),
                (above + below).norm() / above.norm());
  EXPECT_GT(above.norm(), 0.01 * step * one.norm());
  EXPECT_LT((above + below).norm(), 10.0 * step * above.norm());
}

TEST(CoupledSystem, CellsWithoutForcesAndFreePointsChangeNothing)
{
  const Oracle &oracle = get_oracle();
  const CoupledScene with = oracle.scene.select({kContrast, kRigid, kWall, kFree});
  CoupledScene without(oracle.scene.cell);    // nor free points
  without.add_cell(5.0, oracle.scene.parts[kContrast]);
  without.add_body(oracle.scene.scene.shapes[0], oracle.scene.orientations[kRigid],
                   Vec3(1.2, 1.2, 1.8));
  without.add_wall(oracle.scene.scene.surfaces[kWall].velocity, oracle.scene.parts[kWall]);
  Points forces = make_forces(with);
  for (int i : with.list_nodes(3))
    forces.col(i).setZero();
  const Eigen::Index n = without.nodes.cols();
  const SuspensionSettings settings = make_settings(kSolverTolerance);
  const Conditions conditions = make_mean_flow();
  const Evaluation a = DistributedSuspension(MPI_COMM_WORLD, with, kSumTolerance, settings)
                           .evaluate(forces, conditions);
  const Evaluation b = DistributedSuspension(MPI_COMM_WORLD, without, kSumTolerance, settings)
                           .evaluate(forces.leftCols(n), conditions);
  EXPECT_LT(compute_difference(a.velocity.leftCols(n), b.velocity), 1e-10);
  EXPECT_LT((a.wall_force - b.wall_force).norm(), 1e-10 * b.wall_force.norm());
}

TEST(CoupledSystem, StressletsAreTheMomentsOfTheDenseSolution)
{
  const Oracle &oracle = get_oracle();
  const CoupledScene scene = oracle.scene.select({kContrast, kRigid, kFree, kWall});
  const Points forces = make_forces(scene);
  const Conditions conditions = make_mean_flow();
  const Evaluation e = evaluate(scene, conditions);
  const double viscosity = make_settings(1e-8).viscosity;
  const Points x =
      DenseSuspension(oracle.layers, scene, Form::Deflated)
          .solve(make_densities(scene, oracle.layers, forces), viscosity, conditions.flow)
          .unknowns;
  for (int s : {kContrast, kRigid}) {
    Mat3 moment = Mat3::Zero();
    const SurfaceMesh &mesh = scene.parts[s];
    const std::vector<int> nodes = scene.list_nodes(s);
    double area = 0.0;
    Vec3 center = Vec3::Zero();
    for (const Triangle &t : mesh.triangles) {
      const Vec3 a = mesh.nodes.col(t[0]), b = mesh.nodes.col(t[1]), c = mesh.nodes.col(t[2]);
      const Vec3 normal = 0.5 * (b - a).cross(c - a);
      const Vec3 mean = (x.col(nodes[t[0]]) + x.col(nodes[t[1]]) + x.col(nodes[t[2]])) / 3.0;
      const double factor = viscosity * (s == kContrast ? 4.0 : 1.0);
      moment += factor * (mean * normal.transpose() + normal * mean.transpose());
      area += normal.norm();
      center += normal.norm() * (a + b + c) / 3.0;
    }
    for (int i : nodes) {
      const Mat3 fx = forces.col(i) * (scene.nodes.col(i) - center / area).transpose();
      moment -= 0.5 * (fx + fx.transpose());
    }
    moment -= moment.trace() / 3.0 * Mat3::Identity();
    EXPECT_LT((e.stresslets[s] - moment).norm(), 1e-6 * moment.norm()) << "surface " << s;
  }
}

TEST(CoupledSystem, SolutionIsItsOwnInitialGuess)
{
  const CoupledScene &scene = get_oracle().scene;
  const Points forces = make_forces(scene);
  DistributedSuspension suspension(MPI_COMM_WORLD, scene, kSumTolerance, make_settings(1e-6));
  const Evaluation first = suspension.evaluate(forces, make_mean_flow());
  EXPECT_GT(first.solver.iterations, 5);
  const Evaluation second = suspension.evaluate(forces, make_mean_flow(), first.solution);
  EXPECT_EQ(second.solver.iterations, 0);
  EXPECT_LT(compute_difference(second.velocity, first.velocity), 1e-12);
}

TEST(CoupledSystem, DoesNotDependOnTheNumberOfRanks)
{
  const CoupledScene &scene = get_oracle().scene;
  const Evaluation a = evaluate(scene, make_mean_flow());
  const Evaluation b = evaluate(scene, make_mean_flow(), MPI_COMM_SELF);
  EXPECT_LT(compute_difference(a.velocity, b.velocity), 1e-11);
  EXPECT_LT(compute_difference(a.solution.nodes, b.solution.nodes), 1e-10);
  EXPECT_LT((a.pressure_drop - b.pressure_drop).norm(), 1e-10 * b.pressure_drop.norm());
  EXPECT_EQ(a.solver.iterations, b.solver.iterations);
}
