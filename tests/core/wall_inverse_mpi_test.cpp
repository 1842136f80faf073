// The inverse of the walls' single layer: what it finds of the mesh, that it is the inverse, and
// the flows between planes, in a duct and in a tube that follow from it. On 1, 2 and 4 ranks.
#include "biem_error.h"
#include "biem_solver_wall.h"
#include "wall_operator.h"
#include <gtest/gtest.h>
#include <random>

namespace {

bool is_first_rank()
{
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank == 0;
}

Points make_random(Eigen::Index n)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Points values(3, n);
  for (double &value : values.reshaped())
    value = uniform(generator);
  return values;
}

WallMesh make_perturbed_plane()
{
  WallMesh mesh = make_plane({5, 5, 6}, 1.3, 0.5);
  mesh.nodes += Vec3(0.1, 0.1, 0.04).asDiagonal() * make_random(mesh.nodes.cols());
  return mesh;
}

WallMesh make_two_planes(double first, double second)
{
  WallMesh mesh = make_plane({6, 6, 6}, first, 0.5);
  add_wall(mesh, make_plane_wall(get_wall_box(mesh), Axis::Z, second, 0.5));
  return mesh;
}

// Walls with their operator and its inverse.
struct Walls {
  WallMesh mesh;
  WallOperator layer;
  int n_responses = 0;
  WallInverse inverse;

  Walls(const WallMesh &walls, double tolerance) :
      mesh(walls), layer(MPI_COMM_WORLD, mesh, tolerance), inverse(mesh, [this](const Points &f) {
        n_responses++;
        return layer.apply(f);
      })
  {
  }

  // The force per area on the fluid for velocities (3 x n) relative to the mean flow; mu = 1.
  Points solve(const Points &velocities) const { return 8.0 * M_PI * inverse.apply(velocities); }
  Points make_uniform(const Vec3 &velocity) const
  {
    return velocity.replicate(1, mesh.nodes.cols());
  }
  Vec3 sum_force(const Points &density) const { return density * inverse.areas(); }

  // -dp/dx for a mean flow 1 along x.
  double compute_pressure_gradient() const
  {
    const Points f = solve(make_uniform(-Vec3::UnitX()));
    return -sum_force(f)[0] / mesh.cell.determinant();
  }
};

double compute_largest(const Points &values)
{
  return values.cwiseAbs().maxCoeff();
}

std::string describe(const WallMesh &mesh)
{
  return WallInverse(mesh, [&](const Points &f) { return Points(f); }).describe();
}

size_t count_closed_sheets(const WallMesh &mesh)
{
  return compute_closed_sheets(mesh).size();
}

// Mean velocity in a rectangle a x b for -dp/dx = mu = 1.
double compute_duct_mean(double a, double b)
{
  double sum = 0.0;
  for (int n = 1; n < 40; n += 2)
    sum += std::tanh(0.5 * n * M_PI * a / b) / std::pow(n, 5);
  return b * b / 12.0 * (1.0 - 192.0 * b / (std::pow(M_PI, 5) * a) * sum);
}

void expect_error(const WallMesh &mesh, const std::string &text)
{
  try {
    describe(mesh);
    ADD_FAILURE() << "no error with " << text;
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

}    // namespace

TEST(WallTranslations, AreThoseOfTheLattice)
{
  EXPECT_EQ(describe(make_plane({8, 9, 6}, 1.3, 0.5)), "lattice sheet 16 x 18: 2D FFT");
  EXPECT_EQ(describe(make_duct({6, 4, 5}, 0.5)), "12 shifts along x, 17 nodes each");
  EXPECT_EQ(describe(make_tube(5, 2, 0.5)), "10 shifts along x, 26 nodes each");
  EXPECT_EQ(describe(make_perturbed_plane()), "dense, 100 nodes");
  EXPECT_EQ(describe(make_two_planes(1, 3)), "12 x 12 shifts along x, y, 2 nodes each");
  EXPECT_EQ(describe(make_two_planes(1, 4)), "12 x 12 x 2 shifts along x, y, z, 1 node each");
}

TEST(WallTranslations, MapTrianglesToo)
{
  WallMesh mesh = make_plane({6, 6, 6}, 1.0, 0.5);
  // The diagonal of each second cell along x the other way round.
  for (size_t t = 0; t < mesh.triangles.size(); t += 4) {
    const auto [a, b, c] = mesh.triangles[t];
    const int d = mesh.triangles[t + 1][2];
    mesh.triangles[t] = {a, b, d};
    mesh.triangles[t + 1] = {b, c, d};
  }
  EXPECT_EQ(describe(mesh), "6 x 12 shifts along x, y, 2 nodes each");
}

TEST(WallTranslations, OrderIsThatOfShiftedUnitCells)
{
  const WallMesh mesh = make_duct({6, 4, 5}, 0.5);
  const MeshTranslations translations(mesh);
  const int n_unit = translations.n_unit_nodes();
  std::vector<int> sorted = translations.order();
  std::sort(sorted.begin(), sorted.end());
  for (int i = 0; i < static_cast<int>(sorted.size()); i++) {
    EXPECT_EQ(sorted[i], i);
    const Vec3 difference =
        mesh.nodes.col(translations.order()[i]) - mesh.nodes.col(translations.order()[i % n_unit]);
    Vec3 s = mesh.cell.inverse() * difference - Vec3((i / n_unit) / 12.0, 0, 0);
    s.array() -= s.array().round();
    EXPECT_LT(s.norm(), 1e-12);
  }
}

TEST(ClosedSheets, AreCounted)
{
  EXPECT_EQ(count_closed_sheets(make_plane({8, 9, 6}, 1.3, 0.5)), 1u);
  EXPECT_EQ(count_closed_sheets(make_duct({6, 4, 5}, 0.5)), 2u);
  EXPECT_EQ(count_closed_sheets(make_tube(5, 2, 0.5)), 1u);
  EXPECT_EQ(count_closed_sheets(make_two_planes(1, 4)), 2u);
  WallMesh open = make_plane({8, 9, 6}, 1.3, 0.5);
  open.triangles.pop_back();
  EXPECT_EQ(count_closed_sheets(open), 0u);
}

TEST(ClosedSheets, OfCrossingPlanesAreThePlanesAndTheCompartments)
{
  // Two planes each way: four closed planes, and the wall of one of the compartments between.
  WallMesh mesh = make_box(6, 6, 6);
  const WallBox box = get_wall_box(mesh);
  for (double place : {1.0, 4.0}) {
    add_wall(mesh, make_plane_wall(box, Axis::Y, place, 0.5));
    add_wall(mesh, make_plane_wall(box, Axis::Z, place, 0.5));
  }
  const SurfaceMesh joined = join_periodic_nodes(mesh.cell, {mesh.nodes, mesh.triangles});
  mesh.nodes = joined.nodes;
  mesh.triangles = joined.triangles;
  EXPECT_EQ(count_closed_sheets(mesh), 5u);
}

TEST(ClosedSheets, DoNotDependOnTheOrderOfATrianglesNodes)
{
  WallMesh mesh = make_plane({8, 9, 6}, 1.3, 0.5);
  for (size_t t = 1; t < mesh.triangles.size(); t += 3)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][2]);
  const std::vector<Points> sheets = compute_closed_sheets(mesh);
  ASSERT_EQ(sheets.size(), 1u);
  EXPECT_LT((sheets[0].rowwise().sum() - Vec3(0, 0, 72)).norm(), 1e-10);
  EXPECT_LT(compute_largest(sheets[0].colwise() - Vec3(0, 0, 0.25)), 1e-12);
}

// A null vector of the discrete operator is that of the smooth one up to the error of quadrature;
// in a duct the two sheets' jumps cannot be told apart at the nodes of the crossing line.
TEST(WallInverse, IsTheInverseForVelocitiesWithoutFlux)
{
  const struct {
    const char *name;
    WallMesh mesh;
    double flux_error;
  } cases[] = {{"plane", make_plane({8, 9, 6}, 1.3, 0.5), 1e-10},
               {"duct", make_duct({6, 4, 5}, 0.5), 2e-2},
               {"tube", make_tube(5, 2, 0.5), 1e-4},
               {"two planes", make_two_planes(1, 3), 1e-10},
               {"two equal planes", make_two_planes(1, 4), 1e-10},
               {"perturbed", make_perturbed_plane(), 2e-2}};
  for (const auto &c : cases) {
    Walls walls(c.mesh, 1e-10);
    const WallInverse &inverse = walls.inverse;
    const Points v = inverse.remove_null_part(make_random(c.mesh.nodes.cols()));
    const Points f = inverse.apply(v);
    const Points residual = walls.layer.apply(f) - v;
    const double error = compute_largest(inverse.remove_null_part(residual));
    const double flux = compute_largest(residual);
    const double null_part = compute_largest(f - inverse.remove_null_part(f));
    double null_response = 0.0;    // against that of a random density
    for (const Points &n : inverse.null_vectors())
      null_response =
          std::max(null_response, walls.layer.apply(n).norm() / n.norm() * f.norm() / v.norm());
    if (is_first_rank())
      std::printf("  %-16s %-50s %3d responses, error %.1e, with flux %.1e, null vector %.1e, "
                  "condition %.0f\n",
                  c.name, inverse.describe().c_str(), walls.n_responses, error, flux, null_response,
                  inverse.condition());
    EXPECT_LT(error, 1e-10) << c.name;
    EXPECT_LT(flux, c.flux_error) << c.name;
    EXPECT_LT(null_part, 1e-13) << c.name;
    EXPECT_LT(inverse.condition(), 300) << c.name;
    for (const Points &n : inverse.null_vectors())
      EXPECT_LT(compute_largest(inverse.apply(n)), 1e-12) << c.name;
  }
}

TEST(WallInverse, OfALatticeIsTheDenseOneOfAlmostTheSameMesh)
{
  const WallMesh lattice = make_duct({3, 3, 4}, 0.5);
  WallMesh moved = lattice;
  moved.nodes(0, 3) += 1e-4;
  Walls a(lattice, 1e-10), b(moved, 1e-10);
  EXPECT_EQ(b.inverse.describe(), "dense, 78 nodes");
  const Points v = make_random(lattice.nodes.cols());
  const Points x = a.inverse.apply(v), y = b.inverse.apply(v);
  EXPECT_LT((x - y).norm(), 1e-3 * x.norm());
}

TEST(WallInverse, IsTheSameOnEveryRank)
{
  Walls walls(make_duct({6, 4, 5}, 0.5), 1e-3);
  const Points f = walls.inverse.apply(make_random(walls.mesh.nodes.cols()));
  Points least = f, largest = f;
  const int n = static_cast<int>(f.size());
  MPI_Allreduce(f.data(), least.data(), n, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(f.data(), largest.data(), n, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_EQ(compute_largest(largest - least), 0.0);
}

TEST(WallInverse, SolvesToTheErrorOfThePeriodicSum)
{
  for (double tolerance : {1e-3, 1e-4, 1e-5}) {
    Walls walls(make_duct({6, 4, 5}, 0.5), tolerance);
    const Points v = make_random(walls.mesh.nodes.cols());
    const Points residual = walls.layer.apply(walls.inverse.apply(v)) - v;
    const double error = walls.inverse.remove_null_part(residual).norm() / v.norm();
    if (is_first_rank()) std::printf("  tolerance %.0e error %.1e\n", tolerance, error);
    EXPECT_LT(error, tolerance);
  }
}

// First order with a small factor: beyond the near rule's fixed number of edges, quadrature of a
// uniform density errs by a fixed part of the edge.
TEST(PlanePoiseuille, PressureGradientIsTwelveOverTheHeightSquared)
{
  double previous = 0.0;
  for (double edge : {1.0, 0.5, 0.25}) {
    const double height = 5.0;
    Walls walls(make_plane({4, 4, height}, 0.7, edge), 1e-7);
    const double exact = 12.0 / (height * height);
    const double error = std::abs(walls.compute_pressure_gradient() / exact - 1.0);
    if (is_first_rank()) std::printf("  edge %.2f error %.2e\n", edge, error);
    EXPECT_LT(error, 1.5e-4 * edge);
    if (previous > 0.0) EXPECT_GT(previous / error, 1.9);
    previous = error;
  }
}

TEST(DuctPoiseuille, ResistanceIsThatOfTheSeries)
{
  double previous = 0.0;
  for (double edge : {1.0, 0.5}) {
    Walls walls(make_duct({4, 10, 15}, edge), 1e-6);
    const double exact = 1.0 / compute_duct_mean(15, 10);
    const double error = std::abs(walls.compute_pressure_gradient() / exact - 1.0);
    if (is_first_rank()) std::printf("  edge %.2f error %.2e\n", edge, error);
    EXPECT_LT(error, 1e-3 * edge * edge);
    if (previous > 0.0) EXPECT_GT(previous / error, 3.0);
    previous = error;
  }
}

TEST(TubePoiseuille, VelocityOnTheAxisIsThatOfItsPressureGradient)
{
  double previous = 0.0;
  for (double edge : {0.6, 0.3}) {
    const double radius = 2.0;
    Walls walls(make_tube(5, radius, edge), 1e-6);
    WallMesh with_probe = walls.mesh;
    const Eigen::Index n = with_probe.nodes.cols();
    with_probe.nodes.conservativeResize(3, n + 1);
    with_probe.nodes.col(n) = Vec3(1.1, 2.5, 2.5);
    Points f = Points::Zero(3, n + 1);
    f.leftCols(n) = walls.solve(walls.make_uniform(-Vec3::UnitX()));
    const Points sum = WallOperator(MPI_COMM_WORLD, with_probe, 1e-6).apply(f);
    const Vec3 velocity = Vec3::UnitX() + sum.col(n) / (8.0 * M_PI);
    const double gradient = -walls.sum_force(f.leftCols(n))[0] / 125.0;
    const double exact = 0.25 * gradient * radius * radius;
    const double error = (velocity / exact - Vec3::UnitX()).norm();
    if (is_first_rank())
      std::printf("  edge %.2f velocity %.4f error %.2e\n", edge, velocity[0], error);
    EXPECT_LT(error, 2e-3 * edge * edge);
    if (previous > 0.0) EXPECT_GT(previous / error, 3.0);
    previous = error;
  }
}

TEST(Couette, StressIsTheVelocityDifferenceOverTheGaps)
{
  Walls walls(make_two_planes(1, 3), 1e-7);    // gaps 2 and 4, mean velocity 1/2
  const Eigen::Index n = walls.mesh.nodes.cols() / 2;
  Points velocity = walls.make_uniform(Vec3(-0.5, 0, 0));
  velocity.rightCols(n).colwise() = Vec3(0.5, 0, 0);
  const Points f = walls.solve(velocity);
  const Vec3 force = f.rightCols(n) * walls.inverse.areas().tail(n) / 36.0;
  const double exact = 1.0 / 2.0 + 1.0 / 4.0;
  if (is_first_rank()) std::printf("  error %.2e\n", force[0] / exact - 1.0);
  EXPECT_NEAR(force[0], exact, 1e-4 * exact);
  EXPECT_LT(force.tail(2).norm(), 1e-4);    // all diagonals of the mesh point the same way
  EXPECT_LT(walls.sum_force(f).norm(), 1e-6);
}

TEST(WallInverse, RefusesMeshesThatAreNotFit)
{
  const WallMesh plane = make_plane({6, 6, 6}, 1.0, 0.5);
  WallMesh mesh = plane;
  add_wall(mesh, {Points::Constant(3, 1, 2.0), {}});
  expect_error(mesh, "belongs to no triangle");
  mesh = plane;
  add_wall(mesh, {plane.nodes, plane.triangles});
  expect_error(mesh, "at the same place");
  mesh = plane;
  mesh.triangles.push_back({0, 1, 144});
  expect_error(mesh, "does not exist");
  mesh.triangles.back() = {0, 1, 6};
  expect_error(mesh, "half the periodic cell");
  mesh.triangles.back() = {0, 1, 1};
  expect_error(mesh, "no area");
  expect_error(make_box(1, 1, 1), "no nodes");
}

TEST(WallInverse, RefusesADenseProblemThatIsTooLarge)
{
  WallMesh mesh = make_plane({70, 70, 6}, 1.0, 1.0);
  mesh.nodes(0, 0) += 0.1;
  expect_error(mesh, "GB");
}

TEST(WallInverse, RefusesAResponseThatIsNotFit)
{
  const WallMesh mesh = make_plane({6, 6, 6}, 1.0, 0.5);
  EXPECT_THROW(WallInverse(mesh, [](const Points &f) { return Points(f.leftCols(2)); }), Error);
  EXPECT_THROW(WallInverse(mesh, [](const Points &f) { return Points(0.0 * f); }), Error);
  const WallInverse inverse(mesh, [](const Points &f) { return Points(f); });
  EXPECT_THROW(inverse.apply(Points::Zero(3, 5)), Error);
}
