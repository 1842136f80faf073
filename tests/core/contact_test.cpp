// Contact: the law of the pressure, the nearest point of a triangle, and the side of a surface from
// finds of single triangles.
#include "biem_contact_law.h"
#include "biem_contact_slots.h"
#include "biem_error.h"
#include "biem_mesh_crossings.h"
#include "biem_mesh_icosphere.h"
#include "biem_mesh_nearest_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace biem {
namespace {

constexpr double kRange = 0.1, kStiffness = 3.0;

TEST(ContactLaw, PressureIsTheSlopeOfTheEnergy)
{
  const ContactLaw law(kStiffness, kRange);
  const double h = 1e-6;
  for (double d : {0.0999, 0.07, 0.03, 0.01, 0.0021, 0.0019, 0.001, 0.0, -0.004, -0.09}) {
    const double slope =
        (law.compute_response(d + h).energy - law.compute_response(d - h).energy) / (2.0 * h);
    const double pressure = law.compute_response(d).pressure;
    EXPECT_NEAR(-slope, pressure, 1e-6 * pressure + 1e-8) << d;
  }
}

TEST(ContactLaw, ValuesAndBothEnds)
{
  const ContactLaw law(kStiffness, kRange);
  EXPECT_DOUBLE_EQ(law.compute_response(0.05).pressure, kStiffness);
  EXPECT_DOUBLE_EQ(law.compute_response(0.05).energy,
                   kStiffness * kRange * (std::log(2.0) - 0.5));
  EXPECT_EQ(law.compute_response(kRange).pressure, 0.0);
  EXPECT_EQ(law.compute_response(2.0).energy, 0.0);
  EXPECT_NEAR(law.compute_response(kRange * (1.0 - 1e-9)).pressure, 0.0, 1e-8);
  const double tangent = ContactLaw::kTangentFraction * kRange;
  const ContactResponse above = law.compute_response(tangent * (1.0 + 1e-12));
  const ContactResponse below = law.compute_response(tangent * (1.0 - 1e-12));
  EXPECT_NEAR(above.pressure, below.pressure, 1e-9 * above.pressure);
  EXPECT_NEAR(above.energy, below.energy, 1e-9 * above.energy);
  // penetrated: finite, and growing with depth
  EXPECT_GT(law.compute_response(-0.05).pressure, law.compute_response(0.0).pressure);
}

TEST(ContactLaw, RefusesBadParameters)
{
  EXPECT_THROW(ContactLaw(-1.0, kRange), Error);
  EXPECT_THROW(ContactLaw(std::nan(""), kRange), Error);
  EXPECT_THROW(ContactLaw(1.0, 0.0), Error);
  EXPECT_THROW(ContactLaw(1.0, -0.1), Error);
}

// The smallest distance over a fine grid of weights.
double search_distance(const Vec3 &p, const Mat3 &corners, int n)
{
  double smallest = 1e300;
  for (int i = 0; i <= n; i++)
    for (int j = 0; i + j <= n; j++)
      smallest = std::min(smallest,
                          (p - corners * Vec3(i, j, n - i - j) / static_cast<double>(n)).norm());
  return smallest;
}

TEST(NearestPoint, IsNotFartherThanAnyOther)
{
  std::mt19937 random(4711);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int n_corners[4] = {0, 0, 0, 0};
  for (int trial = 0; trial < 400; trial++) {
    Mat3 corners;
    corners << draw(), draw(), draw();
    const Vec3 p = draw();
    const Vec3 w = compute_nearest_weights(p, corners.col(0), corners.col(1), corners.col(2));
    EXPECT_GE(w.minCoeff(), 0.0);
    EXPECT_NEAR(w.sum(), 1.0, 1e-14);
    const Vec3 offset = p - corners * w;
    EXPECT_LE(offset.norm(), search_distance(p, corners, 60) + 1e-13);
    // the offset is normal to the feature, and the triangle lies behind it
    for (int k = 0; k < 3; k++) {
      const double along = offset.dot(corners.col(k) - corners * w);
      EXPECT_LE(along, 1e-12);
      if (w[k] > 0.0) { EXPECT_NEAR(along, 0.0, 1e-12); }
    }
    n_corners[(w.array() != 0.0).count()]++;
  }
  for (int k = 1; k <= 3; k++) EXPECT_GT(n_corners[k], 20) << k;    // corners, edges, faces
}

Contact find_on(const Vec3 &p, const Points &nodes, const Triangle &t)
{
  Mat3 corners;
  corners << nodes.col(t[0]), nodes.col(t[1]), nodes.col(t[2]);
  const Vec3 weights =
      compute_nearest_weights(p, corners.col(0), corners.col(1), corners.col(2));
  Contact contact = make_contact(p, corners, {t[0] + 1, t[1] + 1, t[2] + 1}, weights);
  contact.surface = 1;
  return contact;
}

// The solid angles of the triangles add up to 4 pi inside.
bool is_inside(const Vec3 &p, const Points &nodes, const std::vector<Triangle> &triangles)
{
  double sum = 0.0;
  for (const Triangle &t : triangles) {
    SurfaceTriangle corners{};
    for (int k = 0; k < 3; k++)
      Eigen::Map<Vec3>(corners.corners + 3 * k) = nodes.col(t[k]);
    sum += compute_solid_angle(corners, p);
  }
  return sum > 2.0 * EIGEN_PI;
}

// A node above a face, at its edge but for rounding: the triangle beyond the edge, folded under the
// face, has the node behind it and must not decide.
TEST(ContactSlots, FaceDecidesBesideAFold)
{
  Points nodes(3, 4);
  nodes << 0.0, 1.0, 0.5, 0.5, 0.0, 0.0, 1.0, 0.9, 0.0, 0.0, 0.0, -0.05;
  const Triangle face = {0, 1, 2}, fold = {1, 0, 3};
  const Vec3 p(0.5, 1e-12, 0.01);
  ASSERT_LT(find_on(p, nodes, fold).side, 0.0);
  for (const std::array<Triangle, 2> &order :
       {std::array<Triangle, 2>{face, fold}, std::array<Triangle, 2>{fold, face}}) {
    ContactSlots slots;
    for (const Triangle &t : order) slots.merge(find_on(p, nodes, t));
    ASSERT_EQ(slots.size(), 1);
    EXPECT_GT(slots[0].side, 0.0);
  }
}

struct Body {
  Points nodes;
  std::vector<Triangle> triangles;
};

// An icosphere with sharp spikes and dents: corners and edges where single triangles mislead.
Body make_spiky_body()
{
  Body body;
  const SurfaceMesh mesh = make_icosphere(2);
  body.nodes = mesh.nodes;
  body.triangles = mesh.triangles;
  for (int i = 0; i < body.nodes.cols(); i += 3) body.nodes.col(i) *= i % 2 ? 2.2 : 0.4;
  return body;
}

TEST(ContactSlots, SideIsThatOfTheSolidAngle)
{
  const Body body = make_spiky_body();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  int n_inside = 0, n_features[4] = {0, 0, 0, 0};
  for (int trial = 0; trial < 3000; trial++) {
    const Vec3 p(uniform(random), uniform(random), uniform(random));
    ContactSlots slots;
    for (const Triangle &t : body.triangles) slots.merge(find_on(p, body.nodes, t));
    ASSERT_EQ(slots.size(), 1);
    const bool inside = is_inside(p, body.nodes, body.triangles);
    EXPECT_EQ(slots[0].side < 0.0, inside) << p.transpose();
    n_inside += inside;
    n_features[3 - std::count(slots[0].feature.begin(), slots[0].feature.end(), 0)]++;
  }
  EXPECT_GT(n_inside, 50);
  for (int k = 1; k <= 3; k++) EXPECT_GT(n_features[k], 100) << k;
}

TEST(ContactSlots, OrderAndGroupingOfFindsDoNotMatter)
{
  const Body body = make_spiky_body();
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  std::vector<Triangle> shuffled = body.triangles;
  for (int trial = 0; trial < 300; trial++) {
    const Vec3 p(uniform(random), uniform(random), uniform(random));
    ContactSlots all, parts[2];
    for (const Triangle &t : body.triangles) all.merge(find_on(p, body.nodes, t));
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (std::size_t k = 0; k < shuffled.size(); k++)
      parts[k % 2].merge(find_on(p, body.nodes, shuffled[k]));
    for (int k = 0; k < parts[1].size(); k++) parts[0].merge(parts[1][k]);
    EXPECT_EQ(parts[0][0].triangle, all[0].triangle);
    EXPECT_EQ(parts[0][0].feature, all[0].feature);
    EXPECT_NEAR(parts[0][0].distance, all[0].distance, 1e-14);
    EXPECT_NEAR(parts[0][0].side, all[0].side, 1e-12);
  }
}

TEST(ContactSlots, KeepsTheNearestSurfaces)
{
  ContactSlots slots;
  Contact contact{};
  for (int surface : {7, 3, 9, 1, 5, 2}) {
    contact.surface = surface;
    contact.distance = 0.01 * surface;
    contact.feature = contact.triangle = {surface, surface + 10, surface + 20};
    slots.merge(contact);
  }
  EXPECT_EQ(slots.size(), ContactSlots::kCapacity);
  for (int surface : {1, 2, 3, 5}) EXPECT_NE(slots.find(surface), nullptr) << surface;
  EXPECT_EQ(slots.find(9), nullptr);
}

TEST(ContactSlots, NodeOnTheSurfaceIsPushedAlongTheNormal)
{
  Mat3 corners;
  corners << Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0);
  const Vec3 weights(0.5, 0.25, 0.25);
  const Contact contact = make_contact(corners * weights, corners, {5, 4, 6}, weights);
  EXPECT_EQ(contact.distance, 0.0);
  EXPECT_EQ(contact.direction, Vec3(0, 0, 1));
  EXPECT_GT(contact.side, 0.0);
  EXPECT_EQ(contact.triangle, (ContactIds{4, 5, 6}));
}

}    // namespace
}    // namespace biem
