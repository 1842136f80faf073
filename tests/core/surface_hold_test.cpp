// Volume and area held by a projection: its rates, what it adds, where it cannot hold an area, and
// ellipsoids that a strain flow would stretch.
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_mesh_shape.h"
#include "biem_surface_hold.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace biem;

namespace {

class Alone : public NodeExchange {
 public:
  void forward(double *, int) override {}
  void reverse_add(double *, int) override {}
  void sum(double *, int) override {}
};

// Closed surfaces, one after the other, and what the projection needs of them.
class Surfaces {
 public:
  std::vector<Triangle> triangles;
  std::vector<int> cell_of_node, cell_of_triangle;
  Points nodes;
  Points volume_gradient, area_gradient;
  Mat3 flow_gradient = Mat3::Zero();
  HeldCells held;

  void add(const SurfaceMesh &mesh, const Vec3 &stretch, const Vec3 &center)
  {
    const auto first = nodes.cols();
    const int cell = n_cells_++;
    nodes.conservativeResize(3, first + mesh.nodes.cols());
    nodes.rightCols(mesh.nodes.cols()) = (stretch.asDiagonal() * mesh.nodes).colwise() + center;
    for (const Triangle &t : mesh.triangles) {
      triangles.push_back({t[0] + int(first), t[1] + int(first), t[2] + int(first)});
      cell_of_triangle.push_back(cell);
    }
    cell_of_node.resize(nodes.cols(), cell);
  }

  void measure()
  {
    FlatElements elements;
    elements.set_geometry(nodes, triangles);
    volume_gradient = area_gradient = Points::Zero(3, nodes.cols());
    elements.add_volume_gradient(volume_gradient);
    elements.add_area_gradient(area_gradient);
    held.volume.assign(n_cells_, 0.0);
    held.area.assign(n_cells_, 0.0);
    for (int e = 0; e < elements.n_elements(); e++) {
      held.volume[cell_of_triangle[e]] += elements.volume(e, Vec3::Zero());
      held.area[cell_of_triangle[e]] += elements.area(e);
    }
  }

  void keep_references()
  {
    held.reference_volume = held.volume;
    held.reference_area = held.area;
  }

  Points project(const Points &velocity) const
  {
    Alone alone;
    Points projected = velocity;
    project_held(held, {cell_of_node, volume_gradient, area_gradient, nodes, flow_gradient}, alone,
                 projected);
    return projected;
  }

  double compute_rate(const Points &velocity, const Points &gradient, int cell) const
  {
    double rate = 0.0;
    for (Eigen::Index i = 0; i < velocity.cols(); i++)
      if (cell_of_node[i] == cell) rate += velocity.col(i).dot(gradient.col(i));
    return rate;
  }

 private:
  int n_cells_ = 0;
};

// A red cell, two ellipsoids and, last, a sphere.
Surfaces make_surfaces(Hold hold)
{
  Surfaces s;
  s.add(make_mesh(*make_red_cell(), 162), Vec3::Ones(), Vec3(1.0, 2.0, 3.0));
  s.add(make_mesh(*make_sphere(1.0), 162), Vec3(1.3, 1.0, 0.8), Vec3(4.0, 0.0, 0.0));
  s.add(make_mesh(*make_sphere(0.7), 42), Vec3(0.8, 0.9, 1.5), Vec3(-4.0, 0.0, 0.0));
  s.add(make_mesh(*make_sphere(1.0), 162), Vec3::Ones(), Vec3(0.0, 0.0, -4.0));
  s.measure();
  s.keep_references();
  for (int c = 0; c < 4; c++) {
    s.held.reference_volume[c] *= 1.0 + 0.02 * (c - 1);
    s.held.reference_area[c] *= 1.0 - 0.01 * (c + 1);
  }
  s.held.hold = hold;
  s.held.relaxation_rate = 0.7;
  return s;
}

constexpr int kSphere = 3;

Points make_velocity(const Surfaces &s)
{
  return Points(s.nodes.array().cos()) + 0.3 * Points::Random(3, s.nodes.cols());
}

double wanted_volume_rate(const HeldCells &h, int cell)
{
  return h.relaxation_rate * (h.reference_volume[cell] - h.volume[cell]);
}

double wanted_area_rate(const HeldCells &h, int cell)
{
  return h.relaxation_rate * (h.reference_area[cell] - h.area[cell]);
}

// Largest relative changes of an ellipsoid in explicit Euler steps up to time 0.5 in a strain flow,
// half of it as velocities and half as background flow; and the smallest angle of its triangles.
struct Drift {
  double volume = 0.0, area = 0.0, smallest_angle = 0.0;
};

Drift follow_ellipsoid(Hold hold, double rate, double dt)
{
  Surfaces s;
  s.add(make_mesh(*make_sphere(1.0), 642), Vec3(1.4, 1.0, 0.7), Vec3(0.5, 0.0, 0.0));
  s.measure();
  s.keep_references();
  s.held.hold = hold;
  s.held.relaxation_rate = 0.1 / dt;
  s.flow_gradient = 0.5 * rate * Vec3(1.0, 0.0, -1.0).asDiagonal();
  Drift largest;
  const int n_steps = static_cast<int>(std::lround(0.5 / dt));
  for (int step = 0; step < n_steps; step++) {
    const Points flow = s.flow_gradient * s.nodes;
    s.nodes += dt * (s.project(flow) + flow);
    s.measure();
    const HeldCells &h = s.held;
    largest.volume = std::max(largest.volume, std::fabs(h.volume[0] / h.reference_volume[0] - 1.0));
    largest.area = std::max(largest.area, std::fabs(h.area[0] / h.reference_area[0] - 1.0));
  }
  largest.smallest_angle = compute_mesh_quality({s.nodes, s.triangles}).smallest_angle;
  return largest;
}

}    // namespace

TEST(AreaGradient, IsTheDerivativeOfTheArea)
{
  Surfaces s = make_surfaces(Hold::Volume);
  const auto compute_area = [&s](const Points &nodes) {
    FlatElements elements;
    elements.set_geometry(nodes, s.triangles);
    double area = 0.0;
    for (int e = 0; e < elements.n_elements(); e++)
      area += elements.area(e);
    return area;
  };
  const double h = 3e-5;
  for (Eigen::Index i = 0; i < s.nodes.cols(); i += 7)
    for (int a = 0; a < 3; a++) {
      Points ahead = s.nodes, behind = s.nodes;
      ahead(a, i) += h;
      behind(a, i) -= h;
      EXPECT_NEAR(s.area_gradient(a, i), (compute_area(ahead) - compute_area(behind)) / (2.0 * h),
                  1e-8)
          << "node " << i << " axis " << a;
    }
  // No translation changes the area of a cell; an expansion does at the rate 2 A.
  for (int c = 0; c < 4; c++) {
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index i = 0; i < s.nodes.cols(); i++)
      if (s.cell_of_node[i] == c) sum += s.area_gradient.col(i);
    EXPECT_LT(sum.norm(), 1e-13);
    EXPECT_NEAR(s.compute_rate(s.nodes, s.area_gradient, c), 2.0 * s.held.area[c], 1e-12);
  }
}

TEST(HeldVolume, RemovesTheFluxOfEachCellAndNothingElse)
{
  const Surfaces s = make_surfaces(Hold::Volume);
  const Points before = make_velocity(s), after = s.project(before);
  for (int c = 0; c < 4; c++)
    EXPECT_NEAR(s.compute_rate(after, s.volume_gradient, c), wanted_volume_rate(s.held, c), 1e-13);
  for (Eigen::Index i = 0; i < after.cols(); i++)
    EXPECT_LT((after.col(i) - before.col(i)).cross(s.volume_gradient.col(i)).norm(), 1e-14);
}

TEST(HeldVolume, NothingIsChangedWhereNothingIsHeld)
{
  const Surfaces s = make_surfaces(Hold::None);
  const Points velocity = make_velocity(s);
  EXPECT_EQ(s.project(velocity), velocity);
  Surfaces other = make_surfaces(Hold::VolumeAndArea);
  std::fill(other.cell_of_node.begin(), other.cell_of_node.end(), -1);
  EXPECT_EQ(other.project(velocity), velocity);
}

TEST(HeldArea, RatesOfVolumeAndAreaAreTheWantedOnes)
{
  Surfaces s = make_surfaces(Hold::VolumeAndArea);
  s.flow_gradient << 0.4, 0.3, 0.0, -0.1, -0.6, 0.5, 0.2, 0.0, 0.2;
  const Points flow = s.flow_gradient * s.nodes;
  const Points before = make_velocity(s), after = s.project(before);
  for (int c = 0; c < kSphere; c++) {
    EXPECT_NEAR(s.compute_rate(after, s.volume_gradient, c), wanted_volume_rate(s.held, c), 1e-12);
    EXPECT_NEAR(s.compute_rate(after + flow, s.area_gradient, c), wanted_area_rate(s.held, c),
                1e-12);
    EXPECT_GT(
        std::fabs(s.compute_rate(before + flow, s.area_gradient, c) - wanted_area_rate(s.held, c)),
        1e-2);    // it was another one before
  }
  EXPECT_LT((s.project(after) - after).norm(), 1e-12 * after.norm());
}

TEST(HeldArea, CorrectionIsAlongTheNormalsAndAStrainOfTheWholeCell)
{
  const Surfaces s = make_surfaces(Hold::VolumeAndArea);
  const Points before = make_velocity(s), correction = s.project(before) - before;
  for (int c = 0; c < kSphere; c++) {
    // A (I/3 - <n n>), from the normals of the triangles.
    Mat3 anisotropy = s.held.area[c] / 3.0 * Mat3::Identity();
    for (size_t e = 0; e < s.triangles.size(); e++) {
      if (s.cell_of_triangle[e] != c) continue;
      const Mat3 x = s.nodes(Eigen::all, s.triangles[e]);
      const Vec3 normal = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0));
      anisotropy -= 0.5 / normal.norm() * normal * normal.transpose();
    }
    Eigen::Matrix<double, Eigen::Dynamic, 2> span(3 * s.nodes.cols(), 2);
    Eigen::VectorXd values(3 * s.nodes.cols());
    span.setZero();
    values.setZero();
    Vec3 center = Vec3::Zero();
    double n = 0.0;
    for (Eigen::Index i = 0; i < s.nodes.cols(); i++) {
      if (s.cell_of_node[i] != c) continue;
      center += s.nodes.col(i);
      n += 1.0;
    }
    for (Eigen::Index i = 0; i < s.nodes.cols(); i++) {
      if (s.cell_of_node[i] != c) continue;
      span.block<3, 1>(3 * i, 0) = s.volume_gradient.col(i).normalized();
      span.block<3, 1>(3 * i, 1) = anisotropy * (s.nodes.col(i) - center / n);
      values.segment<3>(3 * i) = correction.col(i);
    }
    const Eigen::Vector2d k = span.colPivHouseholderQr().solve(values);
    EXPECT_LT((span * k - values).norm(), 1e-12 * values.norm()) << "cell " << c;
    EXPECT_GT((span.col(1) * k[1]).norm(), 1e-2 * values.norm()) << "cell " << c;
  }
}

TEST(HeldArea, OfASphereOnlyTheVolumeIsHeld)
{
  const Surfaces both = make_surfaces(Hold::VolumeAndArea);
  const Surfaces volume = make_surfaces(Hold::Volume);
  const Points before = make_velocity(both);
  const Points a = both.project(before), b = volume.project(before);
  for (Eigen::Index i = 0; i < a.cols(); i++)
    if (both.cell_of_node[i] == kSphere) EXPECT_EQ(Vec3(a.col(i)), Vec3(b.col(i)));
  EXPECT_GT((a - b).norm(), 1e-2);
}

TEST(HeldArea, EllipsoidInAStrainFlowKeepsVolumeAndArea)
{
  for (double rate : {1.0, -1.0}) {
    const Drift coarse = follow_ellipsoid(Hold::VolumeAndArea, rate, 0.01);
    const Drift fine = follow_ellipsoid(Hold::VolumeAndArea, rate, 0.005);
    const Drift volume = follow_ellipsoid(Hold::Volume, rate, 0.005);
    std::printf("  rate %+g: volume %.1e %.1e, area %.1e %.1e; area if only the volume is held "
                "%.1e; angle %.3f\n",
                rate, coarse.volume, fine.volume, coarse.area, fine.area, volume.area,
                fine.smallest_angle);
    // The error of a step, dt^2, decays over ten steps.
    EXPECT_LT(fine.volume, 1e-4);
    EXPECT_LT(fine.area, 1e-4);
    EXPECT_GT(std::log2(coarse.volume / fine.volume), 1.4);
    EXPECT_GT(std::log2(coarse.area / fine.area), 1.4);
    EXPECT_GT(volume.area, 0.05);
    EXPECT_GT(fine.smallest_angle, 0.5);
  }
}

TEST(Hold, NamesAreReadAndOthersRefused)
{
  EXPECT_EQ(parse_hold("none"), Hold::None);
  EXPECT_EQ(parse_hold("volume"), Hold::Volume);
  EXPECT_EQ(parse_hold("area"), Hold::VolumeAndArea);
  EXPECT_THROW(parse_hold("shape"), Error);
}
