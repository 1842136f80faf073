// The completed double layer of one body as a matrix, and its inverse.
#include "biem_error.h"
#include "biem_solver_body.h"
#include "free_space_body.h"
#include <gtest/gtest.h>

using namespace biem;
using free_space::flatten;
using free_space::kNone;

namespace {

SurfaceMesh make_sphere_mesh(int n_nodes)
{
  return make_mesh(*make_sphere(1.0), n_nodes);
}

SurfaceMesh make_platelet_mesh(int n_nodes)
{
  return make_mesh(*make_spheroid(0.993, 0.248), n_nodes);
}

// Not symmetric, away from the origin.
SurfaceMesh make_lopsided_mesh()
{
  SurfaceMesh mesh = make_platelet_mesh(162);
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); i++)
    mesh.nodes.col(i) *= 1.0 + 0.5 * mesh.nodes(0, i);
  mesh.nodes.colwise() += Vec3(3.0, -1.0, 2.0);
  return mesh;
}

Points make_density(const SurfaceMesh &mesh)
{
  Points q(3, mesh.nodes.cols());
  for (Eigen::Index i = 0; i < q.cols(); i++) {
    const Vec3 x = 3.0 * mesh.nodes.col(i);
    q.col(i) = Vec3(std::sin(x[1]) + 0.3, x[0] * x[2], std::cos(x[0] - x[2]));
  }
  return q;
}

Eigen::MatrixXd compute_subtracted(const SurfaceMesh &mesh)
{
  const BodyOperator body(mesh.nodes, mesh.triangles);
  Eigen::MatrixXd matrix = body.compute_double_layer();
  BodyOperator::subtract_singularity(body.compute_row_sums(), matrix);
  return matrix;
}

Eigen::MatrixXd compute_completed(const SurfaceMesh &mesh)
{
  Eigen::MatrixXd matrix = compute_subtracted(mesh);
  BodyOperator(mesh.nodes, mesh.triangles).complete(matrix);
  return matrix;
}

double compute_relative_error(const Eigen::VectorXd &computed, const Eigen::VectorXd &exact)
{
  return (computed - exact).norm() / exact.norm();
}

// |A psi - velocity| / |velocity| of the approximate inverse.
double compute_residual(const BodyInverse &inverse, const Eigen::MatrixXd &matrix,
                        const Points &velocity)
{
  return compute_relative_error(matrix * flatten(inverse.apply(velocity)), flatten(velocity));
}

double compute_condition(const Eigen::MatrixXd &matrix)
{
  const Eigen::VectorXd values = Eigen::BDCSVD<Eigen::MatrixXd>(matrix).singularValues();
  return values[0] / values[values.size() - 1];
}

}    // namespace

TEST(BodyOperator, MatrixIsTheDoubleLayerOfTheElements)
{
  for (const SurfaceMesh &mesh :
       {make_sphere_mesh(42), make_platelet_mesh(162), make_lopsided_mesh()}) {
    const Points q = make_density(mesh);
    const Eigen::VectorXd direct = flatten(free_space::compute_layers(mesh, kNone, q));
    const BodyOperator body(mesh.nodes, mesh.triangles);
    EXPECT_LT(compute_relative_error(body.compute_double_layer() * flatten(q), direct), 1e-13);
  }
}

TEST(BodyOperator, SubtractedDoubleLayerAnnihilatesUniformFieldsAndNearlyRotations)
{
  const SurfaceMesh mesh = make_lopsided_mesh();
  const BodyOperator body(mesh.nodes, mesh.triangles);
  Eigen::MatrixXd matrix = body.compute_double_layer();
  BodyOperator::subtract_singularity(body.compute_row_sums(), matrix);
  const Points uniform = Vec3(1.0, -2.0, 0.5).replicate(1, mesh.nodes.cols());
  EXPECT_LT((matrix * flatten(uniform)).norm(), 1e-11);
  SurfaceMotion turn;
  turn.rotation = Vec3(0.3, 0.4, -1.0);
  Points field(3, mesh.nodes.cols());
  for (Eigen::Index i = 0; i < field.cols(); i++)
    field.col(i) = body.modes().compute_rigid(turn, i);
  EXPECT_LT((matrix * flatten(field)).norm(), 0.01 * 8.0 * M_PI * field.norm());
}

TEST(BodyOperator, CompletedMatrixIsItsDefinition)
{
  const SurfaceMesh mesh = make_lopsided_mesh();
  const BodyOperator body(mesh.nodes, mesh.triangles);
  const Points psi = make_density(mesh);
  const SurfaceMotion motion = body.compute_motion(psi);
  Points modes(3, psi.cols());
  for (Eigen::Index i = 0; i < psi.cols(); i++)
    modes.col(i) = body.modes().compute_rigid(motion, i) + body.modes().compute_normal(motion, i);
  EXPECT_GT(modes.norm(), 0.1 * psi.norm());
  const Eigen::VectorXd exact =
      flatten(modes) - compute_subtracted(mesh) * flatten(psi - modes) / (8.0 * M_PI);
  EXPECT_LT(compute_relative_error(compute_completed(mesh) * flatten(psi), exact), 1e-13);
}

// Corona & Veerapaneni, J. Comput. Phys. 362, 327 (2018): on a sphere the vector spherical
// harmonics V_l, W_l, X_l are eigenfunctions of -D0/(8 pi) with
//   1/2 + 3/(2(2l+1)(2l+3)), 1/2 - 3/(2(2l-1)(2l+1)), 1/2 - 3/(2(2l+1)).
TEST(BodyOperator, SpectrumOnASphereIsExactToSecondOrder)
{
  double errors[2][3];
  for (int level = 0; level < 2; level++) {
    const SurfaceMesh mesh = make_sphere_mesh(level ? 642 : 162);
    const Eigen::MatrixXd matrix = compute_completed(mesh);
    Points strain(3, mesh.nodes.cols()), torsion = strain, radial = strain;
    for (Eigen::Index i = 0; i < strain.cols(); i++) {
      const Vec3 x = mesh.nodes.col(i);
      const Vec3 gradient(2.0 * x[0], -x[1], -x[2]);    // of the solid harmonic of degree 2
      strain.col(i) = gradient;                         // W_2
      torsion.col(i) = x.cross(gradient);               // X_2
      radial.col(i) = Vec3(3.0 * x[0] * x[0] - 1.0, 3.0 * x[0] * x[1], 3.0 * x[0] * x[2]);    // V_1
    }
    const Points *fields[3] = {&strain, &torsion, &radial};
    const double exact[3] = {0.4, 0.2, 0.6};
    for (int k = 0; k < 3; k++)
      errors[level][k] =
          compute_relative_error(matrix * flatten(*fields[k]), exact[k] * flatten(*fields[k]));
  }
  for (int k = 0; k < 3; k++) {
    EXPECT_LT(errors[1][k], 0.02) << k;
    EXPECT_NEAR(std::log2(errors[0][k] / errors[1][k]), 2.0, 0.4) << k;
  }
}

TEST(BodyOperator, IsWellConditionedOnAllBodies)
{
  EXPECT_LT(compute_condition(compute_completed(make_sphere_mesh(162))), 6.0);    // exact: 1/0.2
  EXPECT_LT(compute_condition(compute_completed(make_platelet_mesh(162))), 120.0);
  EXPECT_LT(compute_condition(compute_completed(make_lopsided_mesh())), 200.0);
}

TEST(BodyInverse, InvertsTheOperatorToSinglePrecision)
{
  for (const SurfaceMesh &mesh : {make_sphere_mesh(162), make_platelet_mesh(162),
                                  make_platelet_mesh(642), make_lopsided_mesh()}) {
    const BodyInverse inverse(mesh.nodes, mesh.triangles);
    ASSERT_TRUE(inverse.is_dense());
    const Eigen::MatrixXd matrix = compute_completed(mesh);
    std::srand(7);
    const Points rough = Points::Random(3, mesh.nodes.cols());
    EXPECT_LT(compute_residual(inverse, matrix, make_density(mesh)), 1e-5);
    EXPECT_LT(compute_residual(inverse, matrix, rough), 1e-5);
  }
}

TEST(BodyInverse, TurnsWithTheBody)
{
  const SurfaceMesh mesh = make_platelet_mesh(162);
  const Mat3 r = Eigen::AngleAxisd(1.1, Vec3(0.3, 1.0, -0.4).normalized()).toRotationMatrix();
  const BodyInverse inverse(mesh.nodes, mesh.triangles);
  const Points velocity = make_density(mesh);
  const Eigen::MatrixXd matrix = compute_completed({r * mesh.nodes, mesh.triangles});
  EXPECT_LT(compute_relative_error(matrix * flatten(inverse.apply(r, velocity)), flatten(velocity)),
            1e-5);
}

TEST(BodyInverse, RowSumsAreThoseOfTheOperator)
{
  const SurfaceMesh mesh = make_platelet_mesh(162);
  const BodyInverse inverse(mesh.nodes, mesh.triangles);
  ASSERT_EQ(inverse.row_sums().size(), 162u);
  const Points uniform = Vec3(1.0, 2.0, 3.0).replicate(1, 162);
  const Points direct = free_space::compute_layers(mesh, kNone, uniform);
  for (int i : {0, 50, 161})
    EXPECT_LT((inverse.row_sums()[i] * uniform.col(i) - direct.col(i)).norm(), 1e-11);
}

TEST(BodyInverse, LargeBodyGetsTheInverseOfTheSpectrum)
{
  const SurfaceMesh mesh = make_sphere_mesh(812);
  const BodyInverse inverse(mesh.nodes, mesh.triangles);
  EXPECT_FALSE(inverse.is_dense());
  // A rigid motion and the uniform flux exactly; strain, of eigenvalue 0.4, to a factor 0.8.
  Points field(3, 812);
  for (Eigen::Index i = 0; i < 812; i++)
    field.col(i) = Vec3(1.0, 2.0, 3.0) + Vec3(0.2, 0.1, -0.4).cross(mesh.nodes.col(i));
  EXPECT_LT((inverse.apply(field) - field).norm(), 1e-12 * field.norm());
  const Points strain = Vec3(1.0, 1.0, -2.0).asDiagonal() * mesh.nodes;
  EXPECT_LT((inverse.apply(strain) - 2.0 * strain).norm(), 1e-3 * strain.norm());
  EXPECT_EQ(inverse.row_sums().size(), 812u);
}

TEST(BodyInverse, ContrastIsInvertedByItsSpectrum)
{
  // The cell's own operator u + (lambda - 1)(u_flux - D0[u~]/(8 pi)) on a sphere: the product with
  // the approximate inverse has its eigenvalues near 1 for any lambda.
  const SurfaceMesh mesh = make_sphere_mesh(162);
  const BodyOperator body(mesh.nodes, mesh.triangles);
  const Eigen::MatrixXd completed = compute_completed(mesh);
  const Points field = make_density(mesh);
  for (double ratio : {0.2, 1.0, 5.0, 50.0}) {
    const SurfaceMotion motion = body.compute_motion(field);
    Points guess(3, field.cols()), rigid(3, field.cols());
    for (Eigen::Index i = 0; i < field.cols(); i++) {
      rigid.col(i) = body.modes().compute_rigid(motion, i);
      guess.col(i) = precondition_contrast(ratio, field.col(i), rigid.col(i),
                                           body.modes().compute_normal(motion, i));
    }
    const SurfaceMotion moved = body.compute_motion(guess);
    for (Eigen::Index i = 0; i < field.cols(); i++)
      rigid.col(i) = body.modes().compute_rigid(moved, i);
    const Eigen::VectorXd image =
        flatten(guess) + (ratio - 1.0) * (completed * flatten(guess) - flatten(rigid));
    EXPECT_LT(compute_relative_error(image, flatten(field)), ratio == 1.0 ? 1e-12 : 0.6);
  }
}

TEST(BodyInverse, WrongInputIsAnError)
{
  const SurfaceMesh mesh = make_sphere_mesh(42);
  const BodyInverse inverse(mesh.nodes, mesh.triangles);
  EXPECT_THROW(inverse.apply(Points::Zero(3, 41)), Error);
  EXPECT_THROW(BodyInverse(Points::Zero(3, 42), mesh.triangles), Error);
}
