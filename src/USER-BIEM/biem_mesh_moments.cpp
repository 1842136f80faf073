// Exact volume and surface moments of a closed polyhedron of flat triangles, and the cell shape
// that follows. Knows neither meshes nor LAMMPS.
#include "biem_mesh_moments.h"

#include "biem_error.h"

#include <cmath>
#include <sstream>

namespace biem {

namespace {

constexpr int row_of[6] = {0, 1, 2, 0, 0, 1}, column_of[6] = {0, 1, 2, 1, 2, 2};
constexpr double degrees = 180.0 / M_PI;

Mat3 make_symmetric(const double *values)
{
  Mat3 tensor;
  tensor << values[0], values[3], values[4], values[3], values[1], values[5], values[4], values[5],
      values[2];
  return tensor;
}

// The tensor about the center of mass: parallel-axis theorem.
Mat3 compute_central(const double *second, const Vec3 &first, double weight)
{
  return make_symmetric(second) - first * first.transpose() / weight;
}

// Principal directions of a symmetric tensor in the x-z plane.
struct PlanePrincipal {
  double largest, smallest;    // eigenvalues
  double angle;                // of the direction of the largest one from x, degrees, (-90, 90]
};

PlanePrincipal compute_plane_principal(double xx, double zz, double xz)
{
  const double mean = 0.5 * (xx + zz), radius = std::hypot(0.5 * (xx - zz), xz);
  return {mean + radius, mean - radius, 0.5 * std::atan2(2.0 * xz, xx - zz) * degrees};
}

}    // namespace

double add_triangle_moments(const Vec3 &x0, const Vec3 &x1, const Vec3 &x2, MeshMoments &moments)
{
  const Vec3 sum = x0 + x1 + x2;
  const double area = 0.5 * (x1 - x0).cross(x2 - x0).norm();
  const double volume = x0.dot(x1.cross(x2)) / 6.0;    // tetrahedron with its tip at the origin
  moments.area += area;
  moments.volume += volume;
  for (int c = 0; c < 3; c++) {
    moments.area_first[c] += area / 3.0 * sum[c];
    moments.volume_first[c] += 0.25 * volume * sum[c];
  }
  for (int k = 0; k < 6; k++) {
    const int i = row_of[k], j = column_of[k];
    const double product = x0[i] * x0[j] + x1[i] * x1[j] + x2[i] * x2[j] + sum[i] * sum[j];
    moments.area_second[k] += area / 12.0 * product;
    moments.volume_second[k] += volume / 20.0 * product;
  }
  return area;
}

CellShape compute_cell_shape(const MeshMoments &moments)
{
  if (!(moments.volume > 0.0)) {
    std::ostringstream message;
    message << "its enclosed volume is " << moments.volume
            << ", not positive: the triangles are not counter-clockwise seen from outside, or the "
               "surface is open";
    throw Error(message.str());
  }
  CellShape shape;
  const Vec3 volume_first(moments.volume_first), area_first(moments.area_first);
  shape.centroid = volume_first / moments.volume;

  // an ellipsoid with semi-axes L has the second moments V L^2/5
  const Mat3 solid = compute_central(moments.volume_second, volume_first, moments.volume);
  const Mat3 ellipsoid = 5.0 / moments.volume * solid;
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(ellipsoid, Eigen::EigenvaluesOnly);
  shape.semi_axes = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();

  // its cut with the plane y = 0 through the center: x.(inverse tensor).x = 1 with y = 0
  const Mat3 inverse = ellipsoid.inverse();
  const PlanePrincipal cut =
      compute_plane_principal(-inverse(0, 0), -inverse(2, 2), -inverse(0, 2));
  const double axis1 = 1.0 / std::sqrt(-cut.largest), axis2 = 1.0 / std::sqrt(-cut.smallest);
  shape.ellipsoid_angle = cut.angle;
  shape.deformation = (axis1 - axis2) / (axis1 + axis2);

  // inertia = tr(S) - S: its smallest eigenvalue belongs to the largest of S
  const Mat3 surface = compute_central(moments.area_second, area_first, moments.area);
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(surface);
  shape.axis = solver.eigenvectors().col(2);
  shape.inclination = std::acos(std::min(1.0, std::fabs(shape.axis.x()))) * degrees;
  shape.inclination_in_plane =
      compute_plane_principal(surface(0, 0), surface(2, 2), surface(0, 2)).angle;
  return shape;
}

}    // namespace biem
