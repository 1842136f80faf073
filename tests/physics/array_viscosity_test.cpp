// A rigid sphere in a simple cubic array under a linear flow: its stresslet against the exact
// viscosity of the array at the instant when it is aligned, in both directions of a cubic lattice.
#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include "biem_periodic_ghosts.h"
#include "biem_suspension.h"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

using namespace biem;

namespace {

constexpr double kViscosity = 1.3;

struct ArrayRow {
  double fraction, alpha, beta;
};

std::vector<ArrayRow> read_reference()
{
  std::ifstream file(BIEM_REPOSITORY "/tests/reference/periodic_array_viscosity.csv");
  std::vector<ArrayRow> rows;
  std::string line, lattice;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    ArrayRow row;
    if (words >> lattice >> row.fraction >> row.alpha >> row.beta) rows.push_back(row);
  }
  return rows;
}

EwaldParameters choose_parameters(const SurfaceMesh &mesh, double length)
{
  EwaldScene scene;
  scene.cell = length * Mat3::Identity();
  scene.n_sources = static_cast<double>(mesh.nodes.cols() + mesh.triangles.size());
  scene.n_targets = static_cast<double>(mesh.nodes.cols());
  scene.body_sources = scene.n_sources;
  scene.body_radius = 1.0;
  scene.tolerance = 1e-5;
  scene.layers = Layers::Both;
  return choose_ewald_parameters(scene);
}

Evaluation evaluate(double length, int n_nodes, const Mat3 &gradient)
{
  const SurfaceMesh mesh = make_mesh(*make_sphere(1.0), n_nodes);
  const Eigen::Index n = mesh.nodes.cols();
  const Mat3 cell = length * Mat3::Identity();
  const EwaldParameters parameters = choose_parameters(mesh, length);
  PeriodicGhosts ghosts(mesh.nodes, cell,
                        parameters.cutoff + 2.0 * compute_mesh_quality(mesh).longest_edge);
  FlatElements elements;
  elements.set_geometry(ghosts.nodes(), mesh.triangles);
  const NearCandidates candidates = find_near_candidates(elements, ghosts.nodes());
  const std::vector<int> surface_of_triangle(mesh.triangles.size(), 0), surface_of_node(n, 0);
  std::vector<int> index_of_node(n);
  for (Eigen::Index i = 0; i < n; i++)
    index_of_node[i] = static_cast<int>(i);
  const Points shift = Points::Zero(3, mesh.triangles.size());
  const std::vector<Mat3> orientations(1, Mat3::Identity());
  const Configuration configuration{ghosts.nodes(),
                                    ghosts.n_owned(),
                                    mesh.triangles,
                                    surface_of_triangle,
                                    surface_of_node,
                                    index_of_node,
                                    shift,
                                    mesh.nodes,
                                    candidates,
                                    orientations,
                                    0};
  Scene scene;
  scene.surfaces = {Surface{SurfaceKind::Rigid, 1.0, 0}};
  scene.shapes = {mesh};
  SuspensionSettings settings;
  settings.viscosity = kViscosity;
  settings.control.tolerance = 1e-6;
  Suspension suspension(MPI_COMM_SELF, {parameters, parameters}, settings, scene);
  suspension.set_cell(cell, Vec3::Zero());
  Conditions conditions;
  conditions.flow.gradient = gradient;
  HeldCells cells;
  return suspension.evaluate(configuration, Points::Zero(3, n), conditions, CoupledFields(),
                             cells, ghosts);
}

// mu_eff/mu - 1 = S:E/(2 mu V E:E).
double compute_excess_viscosity(double fraction, int n_nodes, const Mat3 &strain)
{
  const double length = std::cbrt(4.0 * M_PI / 3.0 / fraction);
  const Evaluation e = evaluate(length, n_nodes, strain);
  return e.stresslets[0].cwiseProduct(strain).sum() /
      (2.0 * kViscosity * std::pow(length, 3) * strain.squaredNorm());
}

Mat3 make_extension() { return Vec3(2.0, -1.0, -1.0).asDiagonal(); }

Mat3 make_shear()
{
  Mat3 strain = Mat3::Zero();
  strain(0, 2) = strain(2, 0) = 0.7;
  return strain;
}

void check(const char *name, double fraction, double exact, const Mat3 &strain)
{
  double errors[2];
  for (int level = 0; level < 2; level++) {
    const int n_nodes = level ? 642 : 162;
    const double computed = compute_excess_viscosity(fraction, n_nodes, strain);
    errors[level] = computed / exact - 1.0;
    std::printf("  | %s | %g | %d | %.7f | %.7f | %+.2f %% |\n", name, fraction, n_nodes, computed,
                exact, 100.0 * errors[level]);
  }
  EXPECT_LT(std::fabs(errors[1]), 0.01) << name << " at volume fraction " << fraction;
  EXPECT_NEAR(std::log2(std::fabs(errors[0] / errors[1])), 2.0, 0.4)
      << name << " at volume fraction " << fraction;
}

}    // namespace

TEST(ArrayOfRigidSpheres, ViscosityInExtensionConvergesToNunanAndKellers)
{
  const std::vector<ArrayRow> rows = read_reference();
  ASSERT_EQ(rows.size(), 5u);
  for (const ArrayRow &row : rows)
    check("alpha", row.fraction, row.alpha, make_extension());
}

TEST(ArrayOfRigidSpheres, ViscosityInShearConvergesToNunanAndKellers)
{
  for (const ArrayRow &row : read_reference())
    check("beta", row.fraction, row.beta, make_shear());
}

// A linear flow's rotation turns the sphere and strains nothing.
TEST(ArrayOfRigidSpheres, SphereTurnsWithTheRotationOfTheFlow)
{
  Mat3 spin = Mat3::Zero();
  spin(0, 2) = 0.5;
  spin(2, 0) = -0.5;
  const Evaluation e = evaluate(3.0, 162, spin);
  EXPECT_LT((e.motions[0].rotation - Vec3(0.0, 0.5, 0.0)).norm(), 1e-5);
  EXPECT_LT(e.motions[0].velocity.norm(), 1e-5);
  EXPECT_LT(e.stresslets[0].norm(), 1e-3);
}
