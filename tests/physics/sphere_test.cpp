// A sphere under uniform traction in a periodic cell, uniform pressure, targets close to a surface:
// the single layer of whole surfaces against exact and tabulated values.
#include "biem_element_flat.h"
#include "biem_mesh_icosphere.h"
#include "biem_operator_layers.h"
#include "biem_periodic_ghosts.h"
#include "biem_suspension.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

// Icosphere of n_nodes scaled to the volume of a sphere of radius 1.
SurfaceMesh make_unit_sphere(int n_nodes)
{
  SurfaceMesh mesh = make_icosphere(compute_icosphere_frequency(n_nodes));
  double volume = 0.0;
  for (const Triangle &t : mesh.triangles)
    volume += mesh.nodes.col(t[0]).dot(mesh.nodes.col(t[1]).cross(mesh.nodes.col(t[2]))) / 6.0;
  mesh.nodes *= std::cbrt(4.0 * M_PI / 3.0 / volume);
  return mesh;
}

struct Layer {
  Points velocity;    // at the nodes, then at extra targets
  Eigen::VectorXd areas;
};

// Single layer of one surface in a cubic cell; extra targets are nodes on no surface.
Layer compute_layer(const SurfaceMesh &mesh, const Points &density, double length, double tolerance,
                    const Points &extra = Points(3, 0))
{
  const Mat3 cell = length * Mat3::Identity();
  const Eigen::Index n = mesh.nodes.cols();
  Points owned(3, n + extra.cols());
  owned << mesh.nodes, extra;
  EwaldScene scene;
  scene.cell = cell;
  scene.n_sources = static_cast<double>(n + mesh.triangles.size());
  scene.n_targets = static_cast<double>(owned.cols());
  scene.body_sources = scene.n_sources;
  scene.body_radius = 1.0;
  scene.tolerance = tolerance;
  const EwaldParameters p = choose_ewald_parameters(scene);
  PeriodicGhosts ghosts(owned, cell, p.cutoff + 1.0);
  FlatElements elements;
  elements.set_geometry(ghosts.nodes(), mesh.triangles);
  const NearCandidates candidates = find_near_candidates(elements, ghosts.nodes());
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(ghosts.nodes().cols());
  elements.add_nodal_areas(areas);
  Points all = Points::Zero(3, ghosts.nodes().cols());
  all.leftCols(n) = density;
  ghosts.forward(all.data(), 3);
  LayerOperator layers(MPI_COMM_SELF, p);
  layers.set_cell(cell, Vec3::Zero());
  const Eigen::VectorXd owned_areas = areas.head(owned.cols());
  const Points shift = Points::Zero(3, elements.n_elements());
  layers.set_geometry({ghosts.nodes(), static_cast<int>(owned.cols()), elements, candidates,
                       owned_areas, mesh.triangles, shift},
                      Layers::Single, ghosts);
  return {layers.apply(Layers::Single, all, Points(3, 0), ghosts), owned_areas};
}

Points make_uniform(Eigen::Index n, const Vec3 &value) { return value.replicate(1, n); }

}    // namespace

// periodic_array_drag: K = F/(6 pi mu U) for simple cubic arrays, U the superficial velocity, of
// spheres at volume fraction c; the mean surface velocity of a uniform traction F/(4 pi) in a
// zero-mean flow is U.  (Zick & Homsy 1982; table computed to 1e-6.)  For c <= 0.008 the traction
// of the rigid sphere is uniform to the order of c.
struct DragCase {
  double fraction, k;
};

class PeriodicSphere : public ::testing::TestWithParam<DragCase> {};

TEST_P(PeriodicSphere, MeanSurfaceVelocityConvergesToTheArrayDrag)
{
  const double length = std::cbrt(4.0 * M_PI / 3.0 / GetParam().fraction);
  double previous = 0.0;
  for (int n_nodes : {162, 642, 2562}) {
    const SurfaceMesh mesh = make_unit_sphere(n_nodes);
    const Vec3 traction(1.0, 0.0, 0.0);
    const Layer layer =
        compute_layer(mesh, make_uniform(mesh.nodes.cols(), traction), length, 1e-6);
    const Vec3 mean = layer.velocity * layer.areas / layer.areas.sum() / (8.0 * M_PI);
    const double k = layer.areas.sum() / (6.0 * M_PI * mean[0]);
    const double error = k / GetParam().k - 1.0;
    std::printf("  c %.3f nodes %4d K %.6f exact %.6f error %.2e ratio %.2f\n", GetParam().fraction,
                n_nodes, k, GetParam().k, error, previous / error);
    EXPECT_LT(std::fabs(error), 0.012 * 162 / n_nodes);
    if (previous > 0.0) EXPECT_GT(previous / error, 3.6);    // second order: 4
    previous = error;
  }
}

INSTANTIATE_TEST_SUITE_P(Fractions, PeriodicSphere,
                         ::testing::Values(DragCase{0.001, 1.2121409123},
                                           DragCase{0.008, 1.5246544959}));

TEST(UniformPressure, CausesNoFlow)
{
  // A uniform normal force density is a pressure jump: no flow.
  double previous = 0.0;
  for (int n_nodes : {162, 642}) {
    const SurfaceMesh mesh = make_unit_sphere(n_nodes);
    FlatElements elements;
    elements.set_geometry(mesh.nodes, mesh.triangles);
    Points gradient = Points::Zero(3, mesh.nodes.cols());    // area times normal
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.nodes.cols());
    elements.add_volume_gradient(gradient);
    elements.add_nodal_areas(areas);
    Points density = gradient;
    for (Eigen::Index i = 0; i < density.cols(); i++) density.col(i) /= areas[i];
    const Layer layer = compute_layer(mesh, density, 8.0, 1e-5);
    const double rms = std::sqrt(layer.velocity.squaredNorm() / mesh.nodes.cols()) / (8.0 * M_PI);
    std::printf("  nodes %d rms velocity of a unit pressure %.2e ratio %.2f\n", n_nodes, rms,
                previous / rms);
    EXPECT_LT(rms, n_nodes == 162 ? 1.5e-3 : 3e-4);
    previous = rms;
  }
}

TEST(NearRule, ErrorIsFlatInTheDistanceFromTheSurface)
{
  // A straining traction on a sphere, targets at 1 h ... 0.01 h outside its surface, against a mesh
  // that is four times finer. What remains at every distance is the error of the mesh itself.
  const SurfaceMesh mesh = make_unit_sphere(642);
  const double h = 0.1546;    // mean edge
  Points density(3, mesh.nodes.cols());
  for (Eigen::Index i = 0; i < density.cols(); i++) {
    const Vec3 x = mesh.nodes.col(i);
    density.col(i) = Vec3(x[2], 0.5 * x[1], x[0]);    // a straining traction, force-free
  }
  const SurfaceMesh fine = make_unit_sphere(10242);
  Points fine_density(3, fine.nodes.cols());
  for (Eigen::Index i = 0; i < fine_density.cols(); i++) {
    const Vec3 x = fine.nodes.col(i);
    fine_density.col(i) = Vec3(x[2], 0.5 * x[1], x[0]);
  }
  const Vec3 direction = Vec3(0.3, 0.5, 0.81).normalized();
  std::vector<double> distances = {1.0, 0.5, 0.1, 0.03, 0.01};
  Points extra(3, distances.size());
  for (size_t k = 0; k < distances.size(); k++)
    extra.col(k) = (1.0 + distances[k] * h) * direction;
  const Points u = compute_layer(mesh, density, 10.0, 1e-5, extra).velocity.rightCols(extra.cols());
  const Points exact =
      compute_layer(fine, fine_density, 10.0, 1e-5, extra).velocity.rightCols(extra.cols());
  for (size_t k = 0; k < distances.size(); k++) {
    const double error = (u.col(k) - exact.col(k)).norm() / exact.col(k).norm();
    std::printf("  distance %.2f h error %.2e\n", distances[k], error);
    EXPECT_LT(error, 0.003);
  }
}
