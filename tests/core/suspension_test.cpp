// The single layer of stretched red cells in a sheared cell with their own membrane tractions:
// measured against requested error.
#include "biem_element_flat.h"
#include "biem_membrane_skalak.h"
#include "biem_mesh_shape.h"
#include "biem_periodic_ghosts.h"
#include "biem_suspension.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

struct RedCells {
  Mat3 cell;
  Points nodes;
  std::vector<Triangle> triangles;
  std::vector<int> surface_of_node, surface_of_triangle;
  Points forces;
  double longest_edge = 0.0;
};

// Four red cells, stretched by 10 % in a direction of their own, in a tilted cell.
RedCells make_scene(int n_nodes)
{
  RedCells s;
  s.cell = 6.0 * Mat3::Identity();
  s.cell(0, 2) = 0.35 * 6.0;
  const SurfaceMesh mesh = make_mesh(*make_red_cell(), n_nodes);
  const int n = static_cast<int>(mesh.nodes.cols());
  s.nodes.resize(3, 4 * n);
  s.forces = Points::Zero(3, 4 * n);
  for (int c = 0; c < 4; c++) {
    const Mat3 rotation =
        Eigen::AngleAxisd(0.9 * c, Vec3(1.0, 0.3 * c, 0.5).normalized()).toRotationMatrix();
    const Vec3 center = s.cell * Vec3(0.25 + 0.5 * (c % 2), 0.3 + 0.4 * (c / 2), 0.2 + 0.2 * c);
    Mat3 stretch = Mat3::Identity();
    stretch.diagonal() = Vec3(1.1, 0.97, 0.98);
    s.nodes.middleCols(c * n, n) = (rotation * stretch * mesh.nodes).colwise() + center;
    for (const Triangle &t : mesh.triangles) {
      s.triangles.push_back({t[0] + c * n, t[1] + c * n, t[2] + c * n});
      s.surface_of_triangle.push_back(c);
      TriangleNodes x, reference;
      for (int v = 0; v < 3; v++) {
        x[v] = s.nodes.col(t[v] + c * n);
        reference[v] = mesh.nodes.col(t[v]);
        s.longest_edge = std::max(s.longest_edge,
                                  (mesh.nodes.col(t[v]) - mesh.nodes.col(t[(v + 1) % 3])).norm());
      }
      const TriangleResponse response =
          compute_skalak_response(SkalakLaw(2.0, 100.0), compute_reference_triangle(reference), x);
      for (int v = 0; v < 3; v++)
        s.forces.col(t[v] + c * n) += response.force[v];
    }
    for (int i = 0; i < n; i++)
      s.surface_of_node.push_back(c);
  }
  return s;
}

Evaluation evaluate(const RedCells &s, double tolerance, double cutoff = 0.0,
                    EwaldMethod method = EwaldMethod::Spme)
{
  EwaldScene scene;
  scene.cell = s.cell;
  scene.max_tilt = 3.0;
  scene.n_sources = static_cast<double>(s.nodes.cols() + s.triangles.size());
  scene.n_targets = static_cast<double>(s.nodes.cols());
  scene.body_sources = scene.n_sources / 4.0;
  scene.body_radius = 1.0;
  scene.tolerance = tolerance;
  scene.method = method;
  scene.cutoff = cutoff;
  const EwaldParameters p = choose_ewald_parameters(scene);
  PeriodicGhosts ghosts(s.nodes, s.cell, p.cutoff + 2.0 * s.longest_edge);
  FlatElements elements;
  elements.set_geometry(ghosts.nodes(), s.triangles);
  const NearCandidates candidates = find_near_candidates(elements, ghosts.nodes());
  const Points shift = Points::Zero(3, s.triangles.size());
  const std::vector<int> no_index(s.nodes.cols(), -1);
  const std::vector<Mat3> orientations;
  const Configuration configuration{ghosts.nodes(),
                                    ghosts.n_owned(),
                                    s.triangles,
                                    s.surface_of_triangle,
                                    s.surface_of_node,
                                    no_index,
                                    shift,
                                    s.nodes,
                                    candidates,
                                    orientations,
                                    0};
  Scene cells;
  cells.surfaces.assign(4, Surface{SurfaceKind::Cell});
  Suspension suspension(MPI_COMM_SELF, {p, p}, SuspensionSettings{}, cells);
  suspension.set_cell(s.cell, Vec3::Zero());
  HeldCells held;
  return suspension.evaluate(configuration, s.forces, Conditions(), CoupledFields(), held, ghosts);
}

}    // namespace

TEST(Suspension, MeasuredErrorOfMembraneVelocitiesIsBelowTheTolerance)
{
  const RedCells s = make_scene(162);
  const Points exact = evaluate(s, 1e-9).velocity;
  for (EwaldMethod method : {EwaldMethod::Spme, EwaldMethod::Pswf})
    for (double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      const Points velocity = evaluate(s, tolerance, 0.0, method).velocity;
      const double error = (velocity - exact).norm() / exact.norm();
      std::printf("  %s: tolerance %.0e measured %.2e\n", describe(method).c_str(), tolerance,
                  error);
      EXPECT_LE(error, tolerance);
    }
}

TEST(Suspension, VelocityDoesNotDependOnTheSplitBetweenRealAndFourierSpace)
{
  const RedCells s = make_scene(162);
  const Points a = evaluate(s, 1e-6, 1.2).velocity, b = evaluate(s, 1e-6, 2.5).velocity;
  EXPECT_LT((a - b).norm(), 2e-6 * a.norm());
}
