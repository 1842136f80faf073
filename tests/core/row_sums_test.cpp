// Row sums of the double layer over one closed surface in free space, and the closed form behind
// their near part.
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_mesh_icosphere.h"
#include "biem_operator_row_sums.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

const Points kNone(3, 0);

double compute_largest_difference(const std::vector<Mat3> &a, const std::vector<Mat3> &b)
{
  double largest = a.size() == b.size() ? 0.0 : 1e300;
  for (size_t i = 0; i < a.size() && i < b.size(); i++)
    largest = std::max(largest, (a[i] - b[i]).cwiseAbs().maxCoeff());
  return largest;
}

// An icosphere pressed flat, so that no two nodes are alike.
SurfaceMesh make_flat_body(int n_nodes)
{
  SurfaceMesh mesh = make_icosphere(compute_icosphere_frequency(n_nodes));
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); i++)
    mesh.nodes.col(i) = Vec3(1.3, 0.9, 0.3).cwiseProduct(mesh.nodes.col(i)) +
                        0.1 * Vec3(0.0, 0.0, mesh.nodes(0, i) * mesh.nodes(1, i));
  return mesh;
}

Mat3 to_matrix(const TensorPack &t, int lane)
{
  Mat3 m;
  m << t.xx[lane], t.xy[lane], t.xz[lane], t.xy[lane], t.yy[lane], t.yz[lane], t.xz[lane],
      t.yz[lane], t.zz[lane];
  return m;
}

}    // namespace

TEST(NearTensor, TimesAUniformDensityIsItsDoubleLayerAlsoAtCornersEdgesAndInThePlane)
{
  const Vec3 a(0.1, -0.2, 0.3), b(0.9, 0.1, 0.2), c(0.4, 0.7, -0.1);
  const TriangleFrame frame = make_triangle_frame(a, b, c);
  const Vec3 n = frame.normal, center = (a + b + c) / 3.0;
  const std::vector<Vec3> targets{a,
                                  0.5 * (a + b),
                                  center,
                                  2.0 * b - a,
                                  center + 1e-3 * n,
                                  center - 0.4 * n,
                                  a + 1e-9 * n,
                                  2.0 * b - a + 1e-7 * n,
                                  Vec3(1.5, -1.0, 0.7)};
  double largest = 0.0;
  for (const Vec3 &x : targets) {
    const PointPack target{broadcast(x[0]), broadcast(x[1]), broadcast(x[2])};
    const Mat3 tensor = to_matrix(integrate_near_triangle_tensor(frame, target), 0);
    largest = std::max(largest, tensor.norm());
    for (int j = 0; j < 3; j++) {
      const LinearDensity unit = make_linear_density(frame, Vec3(Vec3::Unit(j)).replicate(1, 3));
      const PointPack u = integrate_near_triangle<Layers::Double>(frame, nullptr, &unit, target);
      EXPECT_LT((tensor.col(j) - Vec3(u.x[0], u.y[0], u.z[0])).norm(), 1e-13) << x.transpose();
    }
  }
  EXPECT_GT(largest, 1.0);
}

TEST(NearTensor, OfAnElementIsTheNearCorrectionOfUnitDensities)
{
  const SurfaceMesh mesh = make_flat_body(42);
  FlatElements elements;
  elements.set_geometry(mesh.nodes, mesh.triangles);
  std::vector<int> targets{0, 3, 4, 5, 11, 12, 13, 20, 21, 40, 41};
  const int n = static_cast<int>(targets.size());
  for (int e : {0, 17, 60}) {
    targets[0] = mesh.triangles[e][1];
    std::vector<Mat3> tensors(42, Mat3::Zero()), expected = tensors;
    elements.add_near_tensors(e, targets.data(), n, mesh.nodes, tensors);
    for (int j = 0; j < 3; j++) {
      Points u = Points::Zero(3, 42);
      elements.prepare_near(kNone, Vec3(Vec3::Unit(j)).replicate(1, 42));
      elements.add_near_corrections(e, targets.data(), n, mesh.nodes, u);
      for (int i = 0; i < 42; i++)
        expected[i].col(j) = u.col(i);
    }
    EXPECT_LT(compute_largest_difference(tensors, expected), 1e-12);
  }
}

// tr T = -6 (r.n)/r^3: the trace is six times the solid angle inside of the corner.
TEST(FreeRowSums, OfAnIcosahedronHaveTheSolidAngleOfItsCornersAndTheirSymmetry)
{
  const SurfaceMesh mesh = make_icosphere(1);
  const std::vector<Mat3> sums = compute_free_row_sums(mesh.nodes, mesh.triangles);
  const double solid_angle = 2.0 * M_PI - 5.0 * std::asin(2.0 / 3.0);
  ASSERT_EQ(sums.size(), 12u);
  for (int i = 0; i < 12; i++) {
    const Vec3 axis = mesh.nodes.col(i).normalized();
    EXPECT_NEAR(sums[i].trace(), 6.0 * solid_angle, 1e-3 * 6.0 * solid_angle);
    const double along = axis.dot(sums[i] * axis), across = 0.5 * (sums[i].trace() - along);
    const Mat3 symmetric =
        across * Mat3::Identity() + (along - across) * axis * axis.transpose();
    EXPECT_LT((sums[i] - symmetric).norm(), 1e-12);
    EXPECT_GT(std::fabs(along - across), 0.1);
  }
}

TEST(FreeRowSums, TurnWithTheSurfaceAndDependNeitherOnItsPlaceNorOnItsSize)
{
  const SurfaceMesh mesh = make_flat_body(162);
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1.0, -2.0, 0.5).normalized()).matrix();
  const Points moved = (3.7 * turn * mesh.nodes).colwise() + Vec3(5.0, -3.0, 8.0);
  std::vector<Mat3> sums = compute_free_row_sums(mesh.nodes, mesh.triangles);
  for (Mat3 &m : sums)
    m = turn * m * turn.transpose();
  EXPECT_LT(compute_largest_difference(sums, compute_free_row_sums(moved, mesh.triangles)), 1e-11);
}

TEST(FreeRowSums, AtSomeNodesAreThoseOfAllNodes)
{
  const SurfaceMesh mesh = make_flat_body(162);
  const std::vector<Mat3> all = compute_free_row_sums(mesh.nodes, mesh.triangles);
  const std::vector<int> targets{161, 0, 7, 99, 3};
  std::vector<Mat3> expected;
  for (int t : targets)
    expected.push_back(all[t]);
  const std::vector<Mat3> some = compute_free_row_sums(mesh.nodes, mesh.triangles, targets);
  EXPECT_LT(compute_largest_difference(some, expected), 1e-13);
  EXPECT_TRUE(compute_free_row_sums(mesh.nodes, mesh.triangles, {}).empty());
}

TEST(FreeRowSums, RefuseACollapsedElement)
{
  SurfaceMesh mesh = make_flat_body(42);
  mesh.nodes.col(mesh.triangles[5][0]) = mesh.nodes.col(mesh.triangles[5][1]);
  EXPECT_THROW(compute_free_row_sums(mesh.nodes, mesh.triangles), Error);
}
