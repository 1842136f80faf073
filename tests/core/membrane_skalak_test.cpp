// The Skalak law on flat triangles: energy of homogeneous deformations, moduli, forces, invariance.
#include "core/membrane_checks.h"

#include "biem_error.h"
#include "biem_membrane_skalak.h"
#include "biem_mesh_icosphere.h"

#include <cmath>

namespace {

using namespace biem;
using namespace biem_test;

const TriangleNodes reference_nodes = {Vec3(0.3, -0.2, 0.1), Vec3(1.2, 0.1, 0.4),
                                       Vec3(0.5, 0.9, -0.3)};

double compute_energy(const SkalakLaw &law, const TriangleNodes &reference,
                      const TriangleNodes &nodes)
{
  return compute_skalak_response(law, compute_reference_triangle(reference), nodes).energy;
}

// The reference triangle stretched by l1 and l2 along orthogonal directions in its plane.
TriangleNodes stretch(const TriangleNodes &reference, double l1, double l2, double angle)
{
  const Vec3 normal = (reference[1] - reference[0]).cross(reference[2] - reference[0]).normalized();
  const Vec3 edge = (reference[1] - reference[0]).normalized();
  const Vec3 first = std::cos(angle) * edge + std::sin(angle) * normal.cross(edge);
  const Vec3 second = normal.cross(first);
  const Mat3 gradient = l1 * first * first.transpose() + l2 * second * second.transpose();
  TriangleNodes nodes;
  for (int i = 0; i < 3; i++) nodes[i] = gradient * reference[i];
  return nodes;
}

TEST(Skalak, HomogeneousDeformationHasTheEnergyOfEquation7)
{
  const double shear = 1.7, dilatation = 23.0;
  const SkalakLaw law(shear, dilatation);
  const double area = compute_area(reference_nodes);
  for (const double l1 : {0.6, 1.0, 1.4})
    for (const double l2 : {0.7, 1.0, 1.9})
      for (const double angle : {0.0, 0.4, 1.3}) {
        const double i1 = l1 * l1 + l2 * l2 - 2.0, i2 = l1 * l1 * l2 * l2 - 1.0;
        const double expected =
            area * (shear / 2.0 * (i1 * i1 / 2.0 + i1 - i2) + dilatation / 8.0 * i2 * i2);
        EXPECT_NEAR(compute_energy(law, reference_nodes, stretch(reference_nodes, l1, l2, angle)),
                    expected, 1e-13 * (std::fabs(expected) + area * (shear + dilatation)));
      }
}

TEST(Skalak, SmallStrainModuliAreEsAndEsPlusEd)
{
  const double shear = 1.3, dilatation = 40.0, e = 1e-4;
  const SkalakLaw law(shear, dilatation);
  const double area = compute_area(reference_nodes);
  // pure shear of strain e stores 2 ES e^2, an area strain of 2 e stores (ES + ED)/2 (2 e)^2
  const double sheared =
      compute_energy(law, reference_nodes, stretch(reference_nodes, 1.0 + e, 1.0 - e, 0.2));
  const double dilated =
      compute_energy(law, reference_nodes, stretch(reference_nodes, 1.0 + e, 1.0 + e, 0.0));
  EXPECT_NEAR(sheared / (area * 2.0 * e * e), shear, 1e-3 * shear);
  EXPECT_NEAR(dilated / (area * 2.0 * e * e), shear + dilatation, 1e-3 * (shear + dilatation));
}

TEST(Skalak, ForcesAreTheSlopesOfTheEnergy)
{
  std::mt19937 random(1);
  for (int sample = 0; sample < 50; sample++) {
    const SkalakLaw law(1.0, sample % 2 ? 100.0 : 0.0);
    TriangleNodes nodes = reference_nodes;
    for (Vec3 &x : nodes) x += make_random_vector(random, 0.2);
    const ReferenceTriangle reference = compute_reference_triangle(reference_nodes);
    const TriangleResponse response = compute_skalak_response(law, reference, nodes);
    expect_forces_are_energy_slopes(
        [&](const TriangleNodes &x) { return compute_skalak_response(law, reference, x).energy; },
        nodes, response.force, 1e-3, 1e-9);
    expect_no_force_and_torque(nodes, response.force);
  }
}

TEST(Skalak, RestsAtTheReferenceShapeInAnyOrientation)
{
  std::mt19937 random(2);
  const SkalakLaw law(1.0, 100.0);
  const Mat3 rotation = make_random_rotation(random);
  TriangleNodes nodes;
  for (int i = 0; i < 3; i++) nodes[i] = rotation * reference_nodes[i] + Vec3(5.0, -3.0, 11.0);
  const TriangleResponse response =
      compute_skalak_response(law, compute_reference_triangle(reference_nodes), nodes);
  EXPECT_LT(response.energy, 1e-26);
  for (const Vec3 &f : response.force) EXPECT_LT(f.norm(), 1e-12);
}

TEST(Skalak, RigidMotionTurnsTheForcesAndKeepsTheEnergy)
{
  std::mt19937 random(3);
  const SkalakLaw law(1.0, 10.0);
  const ReferenceTriangle reference = compute_reference_triangle(reference_nodes);
  const TriangleNodes nodes = stretch(reference_nodes, 1.3, 0.8, 0.7);
  const Mat3 rotation = make_random_rotation(random);
  TriangleNodes moved;
  for (int i = 0; i < 3; i++) moved[i] = rotation * nodes[i] + Vec3(-2.0, 7.0, 1.0);
  const TriangleResponse before = compute_skalak_response(law, reference, nodes);
  const TriangleResponse after = compute_skalak_response(law, reference, moved);
  EXPECT_NEAR(after.energy, before.energy, 1e-13 * before.energy);
  for (int i = 0; i < 3; i++)
    EXPECT_LT((after.force[i] - rotation * before.force[i]).norm(), 1e-13 * before.force[i].norm());
}

// A sphere blown up by the factor l carries an isotropic tension T: the radial forces add up to
// 2 T/R times the area (Laplace).
TEST(Skalak, InflatedSphereObeysLaplace)
{
  const double shear = 1.0, dilatation = 2.0, l = 1.1;
  const SkalakLaw law(shear, dilatation);
  const SurfaceMesh mesh = make_icosphere(8);
  Points force = Points::Zero(3, mesh.nodes.cols());
  double area = 0.0;
  for (const Triangle &t : mesh.triangles) {
    TriangleNodes reference, nodes;
    for (int k = 0; k < 3; k++) reference[k] = mesh.nodes.col(t[k]);
    for (int k = 0; k < 3; k++) nodes[k] = l * reference[k];
    const TriangleResponse response =
        compute_skalak_response(law, compute_reference_triangle(reference), nodes);
    for (int k = 0; k < 3; k++) force.col(t[k]) += response.force[k];
    area += compute_area(nodes);
  }
  double radial = 0.0;
  for (int i = 0; i < force.cols(); i++) radial -= force.col(i).dot(mesh.nodes.col(i).normalized());
  const double i1 = 2.0 * l * l - 2.0, i2 = std::pow(l, 4) - 1.0;
  // principal tension (1/l2) dW/dl1 at l1 = l2 = l
  const double tension = shear * (i1 + 1.0 - l * l) + 0.5 * dilatation * i2 * l * l;
  EXPECT_NEAR(radial, 2.0 * tension / l * area, 1e-12 * radial);
}

TEST(Skalak, RefusesModuliThatCannotHoldAMesh)
{
  EXPECT_THROW(SkalakLaw(0.0, 1.0), Error);
  EXPECT_THROW(SkalakLaw(-1.0, 1.0), Error);
  EXPECT_THROW(SkalakLaw(1.0, -1e-9), Error);
  EXPECT_THROW(SkalakLaw(NAN, 1.0), Error);
  EXPECT_NO_THROW(SkalakLaw(1.0, 0.0));
}

TEST(Skalak, TellsDegenerateTriangles)
{
  EXPECT_FALSE(is_degenerate(reference_nodes));
  EXPECT_TRUE(is_degenerate({Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.1), Vec3(0.3, 0.3, 0.3)}));
  EXPECT_TRUE(is_degenerate({Vec3(0, 0, 0), Vec3(NAN, 0, 0), Vec3(0, 1, 0)}));
  EXPECT_TRUE(is_degenerate({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}));
}

}    // namespace
