// Closed sheets as the kernel of the boundary operator: a sum of oriented patches is closed if
// every edge is passed as often forward as backward. Patches are the triangles connected through
// edges of two triangles; only a few of them share an edge with others, so the kernel is small.
#include "biem_mesh_sheets.h"
#include "biem_error.h"
#include "biem_mesh_lattice.h"
#include <map>
#include <string>

namespace biem {

namespace {

// A triangle at an edge; direction is +1 if it passes the edge from the lower node to the higher.
struct EdgeUse {
  int triangle, direction;
};
using Edges = std::map<std::pair<int, int>, std::vector<EdgeUse>>;

// Patch of each triangle, and the sign that turns the triangle into the patch's orientation.
struct Patches {
  std::vector<int> patch, sign;
  int n = 0;
};

Edges list_edges(const std::vector<Triangle> &triangles)
{
  Edges edges;
  for (size_t t = 0; t < triangles.size(); t++)
    for (int k = 0; k < 3; k++) {
      const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({static_cast<int>(t), a < b ? 1 : -1});
    }
  return edges;
}

// A patch that cannot be oriented keeps an edge that is passed twice in one direction, which the
// kernel below refuses.
Patches orient_patches(const Edges &edges, size_t n_triangles)
{
  std::vector<std::vector<EdgeUse>> neighbors(n_triangles);    // direction: relative
  for (const auto &[nodes, uses] : edges) {
    if (uses.size() != 2) continue;
    const int relative = -uses[0].direction * uses[1].direction;
    neighbors[uses[0].triangle].push_back({uses[1].triangle, relative});
    neighbors[uses[1].triangle].push_back({uses[0].triangle, relative});
  }
  Patches patches{std::vector<int>(n_triangles, -1), std::vector<int>(n_triangles, 1)};
  for (size_t first = 0; first < n_triangles; first++) {
    if (patches.patch[first] >= 0) continue;
    std::vector<int> open{static_cast<int>(first)};
    patches.patch[first] = patches.n;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const EdgeUse &next : neighbors[t]) {
        if (patches.patch[next.triangle] >= 0) continue;
        patches.patch[next.triangle] = patches.n;
        patches.sign[next.triangle] = patches.sign[t] * next.direction;
        open.push_back(next.triangle);
      }
    }
    patches.n++;
  }
  return patches;
}

// Factors of the patches in each closed sheet, in columns. A patch with a boundary edge is left out
// beforehand, so that many loose triangles do not make a large problem.
Eigen::MatrixXd compute_closed_sums(const Edges &edges, const Patches &patches)
{
  std::vector<int> column(patches.n, 0);
  for (const auto &[nodes, uses] : edges)
    if (uses.size() == 1) column[patches.patch[uses[0].triangle]] = -1;
  int n = 0;
  for (int &c : column)
    if (c == 0) c = n++;
  if (n == 0) return Eigen::MatrixXd(patches.n, 0);
  Eigen::MatrixXd normal_matrix = Eigen::MatrixXd::Zero(n, n);    // same kernel as the boundary's
  for (const auto &[nodes, uses] : edges) {
    std::map<int, double> passes;
    for (const EdgeUse &use : uses) {
      const int c = column[patches.patch[use.triangle]];
      if (c >= 0) passes[c] += use.direction * patches.sign[use.triangle];
    }
    for (const auto &[i, a] : passes)
      for (const auto &[j, b] : passes)
        normal_matrix(i, j) += a * b;
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(normal_matrix);
  if (factors.dimensionOfKernel() == 0) return Eigen::MatrixXd(patches.n, 0);
  const Eigen::MatrixXd kernel = factors.kernel();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(patches.n, kernel.cols());
  for (int p = 0; p < patches.n; p++)
    if (column[p] >= 0) sums.row(p) = kernel.row(column[p]);
  return sums;
}

// Normal times area.
Vec3 compute_area_vector(const WallMesh &mesh, const MeshLattice &lattice, const Triangle &t)
{
  const Vec3 a = mesh.nodes.col(t[0]);
  const Vec3 ab = lattice.wrap_difference(mesh.nodes.col(t[1]) - a);
  const Vec3 ac = lattice.wrap_difference(mesh.nodes.col(t[2]) - a);
  return 0.5 * ab.cross(ac);
}

std::string name_triangle(const Triangle &t)
{
  return "triangle " + std::to_string(t[0]) + "-" + std::to_string(t[1]) + "-" +
         std::to_string(t[2]);
}

void check_triangle(const WallMesh &mesh, const MeshLattice &lattice, const Triangle &t)
{
  constexpr double kLongest = 0.49;    // of the cell: at 1/2 the image is ambiguous
  double longest = 0.0;
  for (int k = 0; k < 3; k++) {
    if (t[k] < 0 || t[k] >= mesh.nodes.cols())
      throw Error("walls: " + name_triangle(t) + " names a node that does not exist; there are " +
                  std::to_string(mesh.nodes.cols()));
    const Vec3 edge =
        lattice.wrap_difference(mesh.nodes.col(t[(k + 1) % 3]) - mesh.nodes.col(t[k]));
    longest = std::max(longest, edge.norm());
    if (lattice.compute_fractional(edge).cwiseAbs().maxCoeff() > kLongest)
      throw Error("walls: " + name_triangle(t) + " has an edge of length " +
                  std::to_string(edge.norm()) + ", about half the periodic cell or more, and its " +
                  "image is ambiguous: use at least three triangles along each lattice vector");
  }
  if (!(compute_area_vector(mesh, lattice, t).norm() > 1e-8 * longest * longest))
    throw Error("walls: " + name_triangle(t) + " has no area: two of its nodes coincide, or all " +
                "three are on a line; mend the mesh");
}

}    // namespace

const WallMesh &check_wall_mesh(const WallMesh &mesh)
{
  const MeshLattice lattice(mesh.cell);
  if (mesh.nodes.cols() == 0) throw Error("walls: there are no nodes");
  if (!mesh.nodes.allFinite()) throw Error("walls: a node's position is not a finite number");
  for (const Triangle &t : mesh.triangles)
    check_triangle(mesh, lattice, t);
  const Eigen::VectorXd areas = compute_nodal_areas(mesh);
  for (Eigen::Index i = 0; i < areas.size(); i++)
    if (areas[i] == 0.0)
      throw Error("walls: node " + std::to_string(i) + " belongs to no triangle, so that nothing " +
                  "determines the force on it: remove it");
  return mesh;
}

Eigen::VectorXd compute_nodal_areas(const WallMesh &mesh)
{
  const MeshLattice lattice(mesh.cell);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.nodes.cols());
  for (const Triangle &t : mesh.triangles)
    for (int node : t)
      areas[node] += compute_area_vector(mesh, lattice, t).norm() / 3.0;
  return areas;
}

std::vector<Points> compute_closed_sheets(const WallMesh &mesh)
{
  const MeshLattice lattice(mesh.cell);
  const Edges edges = list_edges(mesh.triangles);
  const Patches patches = orient_patches(edges, mesh.triangles.size());
  Eigen::MatrixXd sums = compute_closed_sums(edges, patches);
  std::vector<Points> sheets;
  for (Eigen::Index s = 0; s < sums.cols(); s++) {
    const double largest = sums.col(s).cwiseAbs().maxCoeff();
    Eigen::Index first = 0;
    while (std::abs(sums(first, s)) < 1e-9 * largest)
      first++;
    sums.col(s) /= sums(first, s) > 0.0 ? largest : -largest;
    Points normals = Points::Zero(3, mesh.nodes.cols());
    for (size_t t = 0; t < mesh.triangles.size(); t++) {
      const double factor = sums(patches.patch[t], s) * patches.sign[t] / 3.0;
      for (int node : mesh.triangles[t])
        normals.col(node) += factor * compute_area_vector(mesh, lattice, mesh.triangles[t]);
    }
    sheets.push_back(std::move(normals));
  }
  return sheets;
}

}    // namespace biem
