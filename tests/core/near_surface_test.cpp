// Flat elements as a surface: far rule, near corrections of both layers and what they add up to on
// a closed surface.
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_kernel_stokeslet.h"
#include "biem_kernel_stresslet.h"
#include "biem_mesh_icosphere.h"
#include "biem_near_correction.h"
#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace biem;

namespace {

const Points kNone(3, 0);

Points make_triangle()
{
  Points nodes(3, 3);
  nodes << Vec3(0.1, -0.2, 0.3), Vec3(1.2, 0.1, 0.2), Vec3(0.4, 0.9, 0.5);
  return nodes;
}

Mat3 make_density()
{
  Mat3 f;
  f << 1.0, -0.5, 0.3, 0.2, 0.8, -1.0, -0.7, 0.4, 0.6;
  return f;
}

// Nodes of a sphere and targets that are on no surface, inside, outside and close to it.
struct Scene {
  SurfaceMesh mesh = make_icosphere(4);
  Eigen::Index n_nodes = mesh.nodes.cols();
  Points points;    // nodes, then targets
  FlatElements elements;

  explicit Scene(const Points &targets = Points(3, 0)) : points(3, n_nodes + targets.cols())
  {
    points << mesh.nodes, targets;
    elements.set_geometry(points, mesh.triangles);
  }

  // A density that varies over the surface; nothing on the targets.
  Points smooth_density(double seed) const
  {
    Points f = Points::Zero(3, points.cols());
    for (Eigen::Index i = 0; i < n_nodes; i++) {
      const Vec3 x = points.col(i);
      f.col(i) = Vec3(x[2] + seed, std::sin(2.0 * x[0]), x[1] * x[0] - seed);
    }
    return f;
  }

  // The far rule of both layers, from the sources that the contract gives.
  Points apply_far_rule(const Points &f, const Points &q) const
  {
    const Eigen::Index n = elements.n_elements();
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(points.cols());
    Points normals = Points::Zero(3, points.cols()), u = Points::Zero(3, points.cols());
    Points interior(3, n), strengths(3, n), interior_normals(3, n), means(3, n);
    elements.add_nodal_areas(areas);
    elements.add_nodal_normals(normals);
    elements.compute_interior_points(interior);
    elements.compute_interior_strengths(f, strengths);
    elements.compute_interior_normals(interior_normals);
    elements.compute_interior_means(q, means);
    for (Eigen::Index i = 0; i < points.cols(); i++) {
      const Vec3 x = points.col(i);
      for (Eigen::Index s = 0; s < n_nodes; s++) {
        const Vec3 r = x - points.col(s);
        u.col(i) += compute_stokeslet(r, elements.nodal_fraction() * areas[s] * f.col(s)) +
                    compute_stresslet(r, q.col(s), normals.col(s));
      }
      for (Eigen::Index s = 0; s < n; s++) {
        const Vec3 r = x - interior.col(s);
        u.col(i) += compute_stokeslet(r, strengths.col(s)) +
                    compute_stresslet(r, means.col(s), interior_normals.col(s));
      }
    }
    return u;
  }

  // Closed form of both layers on every element.
  Points integrate(const Points &f, const Points &q) const
  {
    Points u = Points::Zero(3, points.cols());
    for (const Triangle &t : mesh.triangles) {
      const TriangleFrame frame =
          make_triangle_frame(points.col(t[0]), points.col(t[1]), points.col(t[2]));
      Mat3 ft, qt;
      ft << f.col(t[0]), f.col(t[1]), f.col(t[2]);
      qt << q.col(t[0]), q.col(t[1]), q.col(t[2]);
      const LinearDensity fl = make_linear_density(frame, ft), ql = make_linear_density(frame, qt);
      for (Eigen::Index i = 0; i < points.cols(); i++) {
        const PointPack x{broadcast(points(0, i)), broadcast(points(1, i)),
                          broadcast(points(2, i))};
        const PointPack v = integrate_near_triangle<Layers::Both>(frame, &fl, &ql, x);
        u.col(i) += Vec3(v.x[0], v.y[0], v.z[0]);
      }
    }
    return u;
  }

  NearCandidates everything() const
  {
    NearCandidates all;
    all.start.push_back(0);
    for (int e = 0; e < elements.n_elements(); e++) {
      for (int i = 0; i < points.cols(); i++)
        all.node.push_back(i);
      all.start.push_back(static_cast<int>(all.node.size()));
    }
    return all;
  }
};

Points make_targets()
{
  Points targets(3, 7);
  targets << Vec3(0.1, 0.2, -0.3), Vec3(0.5, 0.7, 0.4), Vec3(0.0, 0.0, 1.1), Vec3(0.9, 0.9, 0.9),
      Vec3(0.3, -1.0, 0.1), Vec3(-0.9, 0.0, 0.05), Vec3(2.0, 0.0, 0.0);
  return targets;
}

// Adds the corrections of all elements at all points, near or not.
Points correct_everywhere(const Scene &scene)
{
  Points u = Points::Zero(3, scene.points.cols());
  const NearCandidates all = scene.everything();
  for (int e = 0; e < scene.elements.n_elements(); e++)
    scene.elements.add_near_corrections(e, all.node.data() + all.start[e],
                                        all.start[e + 1] - all.start[e], scene.points, u);
  return u;
}

}    // namespace

TEST(FlatElements, FarRuleApproachesTheClosedFormAsTheThirdPowerOfTheDistance)
{
  // Degree 2 is exact for a linear density times a linear kernel; what remains is the kernel's
  // second derivative: 4 times less against the layer itself when the distance doubles.
  const Points nodes = make_triangle();
  const Vec3 direction = Vec3(0.3, -0.5, 0.8).normalized();
  for (Layers layer : {Layers::Single, Layers::Double}) {
    FlatElements element;
    element.set_geometry(nodes, {{0, 1, 2}});
    const Points f = layer == Layers::Single ? Points(make_density()) : kNone;
    const Points q = layer == Layers::Double ? Points(make_density()) : kNone;
    element.prepare_near(f, q);
    const double power = layer == Layers::Single ? 1.0 : 2.0;    // of the layer's own decay
    double previous = 0.0;
    for (double r : {8.0, 16.0, 32.0}) {
      const Points target = nodes.rowwise().mean() + r * direction;
      const int first = 0;
      Points u = Points::Zero(3, 1);
      element.add_near_corrections(0, &first, 1, target, u);
      const double relative = u.norm() * std::pow(r, power);
      if (previous > 0.0) EXPECT_GT(previous / relative, 3.7);
      EXPECT_LT(relative, 1.0 / (r * r));
      previous = relative;
    }
  }
}

TEST(FlatElements, FarRuleAndMassKeepTheTotalForce)
{
  FlatElements element;
  element.set_geometry(make_triangle(), {{0, 1, 2}});
  const Mat3 f = make_density();
  const Vec3 total = element.area(0) * f.rowwise().mean();
  Points interior(3, 1), product = Points::Zero(3, 3);
  element.compute_interior_strengths(f, interior);
  const Vec3 rule =
      element.nodal_fraction() * element.area(0) / 3.0 * f.rowwise().sum() + interior.col(0);
  EXPECT_LT((rule - total).norm(), 1e-15);
  element.add_mass_product(f, product);
  EXPECT_LT((product.rowwise().sum() - total).norm(), 1e-15);
}

TEST(FlatElements, FarRuleNormalsKeepTheAreaVectorAndTheMeanDensity)
{
  const Points nodes = make_triangle();
  FlatElements element;
  element.set_geometry(nodes, {{0, 1, 2}});
  const Vec3 area =
      0.5 * Vec3(nodes.col(1) - nodes.col(0)).cross(Vec3(nodes.col(2) - nodes.col(0)));
  Points nodal = Points::Zero(3, 3), interior(3, 1), mean(3, 1);
  element.add_nodal_normals(nodal);
  element.compute_interior_normals(interior);
  EXPECT_LT((nodal.rowwise().sum() + interior.col(0) - area).norm(), 1e-15);
  EXPECT_LT((nodal.rowwise().sum() - 0.25 * area).norm(), 1e-15);
  element.compute_interior_means(make_density(), mean);
  EXPECT_LT((mean.col(0) - make_density().rowwise().mean()).norm(), 1e-15);
}

TEST(FlatElements, FindsTheCandidatesWithinADistanceInOrder)
{
  const Scene scene(make_targets());
  const int e = 17, n = static_cast<int>(scene.points.cols());
  std::vector<int> candidates, expected, found(n);
  for (int i = n - 1; i >= 0; i--)
    candidates.push_back(i);
  for (double distance : {0.0, 0.3, 0.5, 0.8, 10.0}) {
    expected.clear();
    for (int i : candidates)
      for (int node : scene.mesh.triangles[e])
        if ((scene.points.col(i) - scene.points.col(node)).norm() <= distance) {
          expected.push_back(i);
          break;
        }
    const int n_found =
        scene.elements.find_within(e, distance, candidates.data(), n, scene.points, found.data());
    EXPECT_EQ(std::vector<int>(found.begin(), found.begin() + n_found), expected) << distance;
  }
}

TEST(FlatElements, CorrectionsNeedADensityOfTheRightSize)
{
  Scene scene;
  Points u = Points::Zero(3, scene.points.cols());
  const int target = 0;
  EXPECT_THROW(scene.elements.add_near_corrections(0, &target, 1, scene.points, u), Error);
  EXPECT_THROW(scene.elements.prepare_near(Points::Zero(3, 5), kNone), Error);
  EXPECT_THROW(scene.elements.prepare_near(kNone, Points::Zero(3, 5)), Error);
  scene.elements.prepare_near(scene.smooth_density(0.1), kNone);
  EXPECT_NO_THROW(scene.elements.add_near_corrections(0, &target, 1, scene.points, u));
  scene.elements.set_geometry(scene.points, scene.mesh.triangles);
  EXPECT_THROW(scene.elements.add_near_corrections(0, &target, 1, scene.points, u), Error);
}

TEST(FlatElements, FarRulePlusCorrectionsEverywhereIsTheClosedForm)
{
  Scene scene(make_targets());
  const Points f = scene.smooth_density(0.3), q = scene.smooth_density(-0.2);
  const Points zero = Points::Zero(3, scene.points.cols());
  const Points layers[3][2] = {{f, kNone}, {kNone, q}, {f, q}};
  for (const auto &layer : layers) {
    const Points single = layer[0].cols() ? layer[0] : zero,
                 dual = layer[1].cols() ? layer[1] : zero;
    scene.elements.prepare_near(layer[0], layer[1]);
    const Points sum = scene.apply_far_rule(single, dual) + correct_everywhere(scene);
    const Points exact = scene.integrate(single, dual);
    EXPECT_LT((sum - exact).norm(), 1e-12 * exact.norm());
    EXPECT_GT(correct_everywhere(scene).norm(), 1e-3 * exact.norm());    // the rule alone is not it
  }
}

TEST(FlatElements, CorrectionsAddAndDoNotDependOnTheOtherTargets)
{
  Scene scene(make_targets());
  const int n = static_cast<int>(scene.points.cols());
  scene.elements.prepare_near(scene.smooth_density(0.3), scene.smooth_density(-0.2));
  Points together = Points::Constant(3, n, 0.25), one_by_one = together;
  std::vector<int> all(n);
  for (int i = 0; i < n; i++)
    all[i] = (7 * i) % n;
  ASSERT_EQ(std::set<int>(all.begin(), all.end()).size(), all.size());
  scene.elements.add_near_corrections(3, all.data(), n, scene.points, together);
  for (int i = 0; i < n; i++)
    scene.elements.add_near_corrections(3, &i, 1, scene.points, one_by_one);
  EXPECT_EQ(together, one_by_one);
}

TEST(NearCorrection, CorrectsTheNearPairsOfTheCandidatesAndNoOthers)
{
  Scene scene(make_targets());
  const Points f = scene.smooth_density(0.3);
  scene.elements.prepare_near(f, f);
  Points expected = Points::Zero(3, scene.points.cols()), from_all = expected, from_near = expected;
  long n_expected = 0;
  for (int e = 0; e < scene.elements.n_elements(); e++)
    for (int i = 0; i < scene.points.cols(); i++) {
      double nearest = 1e300;
      for (int node : scene.mesh.triangles[e])
        nearest = std::min(nearest, (scene.points.col(i) - scene.points.col(node)).norm());
      if (nearest > kNearFactor * scene.elements.mean_edge(e)) continue;
      scene.elements.add_near_corrections(e, &i, 1, scene.points, expected);
      n_expected++;
    }
  const NearCandidates near = find_near_candidates(scene.elements, scene.points);
  EXPECT_EQ(static_cast<long>(near.node.size()), n_expected);
  EXPECT_EQ(add_near_corrections(scene.elements, near, scene.points, from_near), n_expected);
  EXPECT_EQ(add_near_corrections(scene.elements, scene.everything(), scene.points, from_all),
            n_expected);
  EXPECT_EQ(from_near, expected);
  EXPECT_EQ(from_all, expected);
}

// The closed surface of uniform density: 8 pi inside, 0 outside, 4 pi on the inside of a face; at a
// node the interior solid angle of the polyhedron counts in place of 2 pi, tensorially.
TEST(DoubleLayer, OfUniformDensityIsEightPiInsideAndZeroOutside)
{
  const SurfaceMesh mesh = make_icosphere(4);
  const Triangle &face = mesh.triangles[11];
  Points targets(3, 6);
  const Vec3 on_face =
      0.2 * mesh.nodes.col(face[0]) + 0.3 * mesh.nodes.col(face[1]) + 0.5 * mesh.nodes.col(face[2]);
  targets << Vec3(0.1, 0.2, -0.3), Vec3(0.99 * on_face), Vec3((1 - 1e-7) * on_face), on_face,
      Vec3((1 + 1e-7) * on_face), Vec3(0.3, 1.9, -0.4);
  const double expected[6] = {8.0, 8.0, 8.0, 4.0, 0.0, 0.0};
  const Scene scene(targets);
  const Vec3 value(0.3, -1.0, 0.7);
  Points q = Points::Zero(3, scene.points.cols());
  q.leftCols(scene.n_nodes).colwise() = value;
  const Points w = scene.integrate(Points::Zero(3, scene.points.cols()), q);
  for (int i = 0; i < 6; i++)
    EXPECT_LT((w.col(scene.n_nodes + i) - expected[i] * M_PI * value).norm(), 1e-9) << i;
}

TEST(DoubleLayer, FarRuleAloneOfUniformDensityIsSmallOutsideAndCloseToEightPiInside)
{
  // Away from the surface the rule stands by itself: a wrong sign or weight of one of its parts
  // would show here, and not in the sum with the corrections.
  Points targets(3, 3);
  targets << Vec3(0.0, 0.0, 0.0), Vec3(0.2, -0.3, 0.1), Vec3(2.0, 0.5, -0.3);
  const Scene scene(targets);
  const Vec3 value(0.3, -1.0, 0.7);
  Points q = Points::Zero(3, scene.points.cols());
  q.leftCols(scene.n_nodes).colwise() = value;
  const Points w = scene.apply_far_rule(Points::Zero(3, scene.points.cols()), q);
  for (int i = 0; i < 3; i++)
    EXPECT_LT((w.col(scene.n_nodes + i) - (i < 2 ? 8.0 : 0.0) * M_PI * value).norm(), 1e-2) << i;
}
