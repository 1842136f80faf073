// Points of the benchmarks: see the header.
#include "bench_points.h"
#include "biem_element_flat.h"
#include "biem_error.h"
#include "biem_mesh_shape.h"
#include <cmath>
#include <random>

using namespace biem;

namespace biem_bench {

namespace {

constexpr int kNodesPerCell = 642;
constexpr double kHematocrit = 0.1;    // no two cells touch in any orientation
constexpr double kCorner = 0.15;
constexpr double kDoubleLayer = 0.3;    // of the densities, against forces of size 1

Points make_uniform(std::mt19937_64 &generator, int n, double low, double high)
{
  std::uniform_real_distribution<double> distribution(low, high);
  Points points(3, n);
  for (Eigen::Index i = 0; i < points.size(); i++)
    points.data()[i] = distribution(generator);
  return points;
}

Points wrap(const Mat3 &cell, const Points &points)
{
  Points s = cell.inverse() * points;
  s.array() -= s.array().floor();
  return cell * s;
}

// Bodies along each lattice vector: about n in total, as evenly spaced as possible.
std::array<int, 3> choose_lattice(const Mat3 &cell, double n)
{
  std::array<int, 3> best{1, 1, 1};
  double least = 1e300;
  const int most = 2 + static_cast<int>(3.0 * std::cbrt(n));
  for (int i = 1; i <= most; i++)
    for (int j = 1; j <= most; j++)
      for (int k = 1; k <= most; k++) {
        const double count = static_cast<double>(i) * j * k;
        if (count < 0.7 * n || count > std::max(2.0, 1.6 * n)) continue;
        const Vec3 spacing = cell.diagonal().cwiseQuotient(Vec3(i, j, k));
        const double badness =
            spacing.maxCoeff() / spacing.minCoeff() + 0.1 * std::fabs(std::log(count / n));
        if (badness >= least) continue;
        least = badness;
        best = {i, j, k};
      }
  return best;
}

// The far rule of one red cell: points, weights (area), normals times area.
struct FarRule {
  Points points, normals;
  Eigen::VectorXd weights;
};

FarRule make_far_rule()
{
  const SurfaceMesh mesh = make_mesh(*make_red_cell(), kNodesPerCell);
  FlatElements elements;
  elements.set_geometry(mesh.nodes, mesh.triangles);
  const Eigen::Index n_nodes = mesh.nodes.cols(), n_elements = elements.n_elements();
  FarRule rule;
  rule.points.resize(3, n_nodes + n_elements);
  rule.points.leftCols(n_nodes) = mesh.nodes;
  elements.compute_interior_points(rule.points.rightCols(n_elements));
  rule.weights = Eigen::VectorXd::Zero(n_nodes + n_elements);
  elements.add_nodal_areas(rule.weights.head(n_nodes));
  rule.weights.head(n_nodes) *= elements.nodal_fraction();
  for (int e = 0; e < n_elements; e++)
    rule.weights[n_nodes + e] = (1.0 - elements.nodal_fraction()) * elements.area(e);
  rule.normals = Points::Zero(3, n_nodes + n_elements);
  elements.add_nodal_normals(rule.normals.leftCols(n_nodes));
  elements.compute_interior_normals(rule.normals.rightCols(n_elements));
  return rule;
}

PointSet make_red_cells(const Mat3 &unit, int n)
{
  const FarRule rule = make_far_rule();
  const Eigen::Index size = rule.points.cols();
  const std::array<int, 3> lattice =
      choose_lattice(unit, std::max(1.0, static_cast<double>(n) / size));
  const int n_bodies = lattice[0] * lattice[1] * lattice[2];
  PointSet set;
  const double volume = n_bodies * 4.0 * M_PI / 3.0 / kHematocrit;
  set.cell = std::cbrt(volume / unit.determinant()) * unit;
  set.body_sources = static_cast<double>(size);
  set.body_radius = 1.0;
  set.unwrapped.resize(3, n_bodies * size);
  set.forces.resize(3, n_bodies * size);
  set.densities.resize(3, n_bodies * size);
  set.normals.resize(3, n_bodies * size);
  for (int b = 0; b < n_bodies; b++) {
    const Vec3 place(b % lattice[0] + 0.5, b / lattice[0] % lattice[1] + 0.5,
                     b / (lattice[0] * lattice[1]) + 0.5);
    const Vec3 center = set.cell * place.cwiseQuotient(Vec3(lattice[0], lattice[1], lattice[2]));
    const Mat3 rotation = Eigen::AngleAxisd(b, Vec3(1.0, b % 3, 0.5).normalized()).matrix();
    const Points rotated = rotation * rule.points;
    set.unwrapped.middleCols(b * size, size) = rotated.colwise() + center;
    set.normals.middleCols(b * size, size) = rotation * rule.normals;
    for (Eigen::Index i = 0; i < size; i++) {
      const Vec3 x = rotated.col(i);
      set.forces.col(b * size + i) = rule.weights[i] * Vec3(x[2], 0.3 * x[1], x[0]);
      set.densities.col(b * size + i) = kDoubleLayer * Vec3(x[2], x[0] * x[1], 0.5 * x[0]);
    }
  }
  set.points = wrap(set.cell, set.unwrapped);
  return set;
}

}    // namespace

Mat3 make_cell(const std::string &name)
{
  Mat3 cell = Mat3::Identity();
  if (name == "cubic") return cell;
  if (name == "sheared") {
    cell(0, 2) = 0.5;
    return cell;
  }
  if (name == "orthogonal") {
    cell.diagonal() << 1.6, 0.9, 1.2;
    return cell;
  }
  if (name == "triclinic") {
    cell.diagonal() << 1.4, 0.8, 1.1;
    cell(0, 2) = 0.23;
    return cell;
  }
  throw Error("unknown cell '" + name + "': choose cubic, orthogonal, sheared or triclinic");
}

PointSet make_points(const std::string &kind, const std::string &cell_name, int n)
{
  const Mat3 cell = make_cell(cell_name);
  if (n < 1) throw Error("number of points " + std::to_string(n) + ": give at least 1");
  if (kind == "cells-smooth") return make_red_cells(cell, n);
  PointSet set;
  std::mt19937_64 generator(1);
  double size = 1.0;    // of the region that holds the points, over the cell
  if (kind == "cells-random") {
    set = make_red_cells(cell, n);
    n = static_cast<int>(set.points.cols());
  } else if (kind == "random" || kind == "corner") {
    if (kind == "corner") size = kCorner;
    set.cell = cell;
    set.points = cell * make_uniform(generator, n, 0.0, size);
    set.unwrapped = set.points;
  } else {
    throw Error("unknown points '" + kind +
                "': choose random, corner, cells-random or cells-smooth");
  }
  const double spacing = size * std::cbrt(set.cell.determinant() / n);
  set.forces = make_uniform(generator, n, -1.0, 1.0);
  set.densities = kDoubleLayer * spacing * make_uniform(generator, n, -1.0, 1.0);
  set.normals = make_uniform(generator, n, -1.0, 1.0);
  return set;
}

}    // namespace biem_bench
