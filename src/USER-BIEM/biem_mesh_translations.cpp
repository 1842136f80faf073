// Translations by trial: the number of shifts along a lattice vector divides the number of nodes,
// because a shift leaves no node in place.
#include "biem_mesh_translations.h"
#include "biem_error.h"
#include "biem_mesh_lattice.h"
#include <algorithm>
#include <numeric>
#include <set>
#include <string>

namespace biem {

namespace {

// Nodes by position, in a periodic grid of bins.
class NodeFinder {
 public:
  NodeFinder(PointsView nodes, const MeshLattice &lattice, double tolerance) :
      lattice_(lattice), tolerance_(tolerance), fractional_(3, nodes.cols()),
      bins_(kBins * kBins * kBins)
  {
    for (Eigen::Index i = 0; i < nodes.cols(); i++) {
      fractional_.col(i) = lattice.compute_fractional(nodes.col(i));
      const int present = find(fractional_.col(i));
      if (present >= 0)
        throw Error("walls: nodes " + std::to_string(present) + " and " + std::to_string(i) +
                    " are at the same place, so that the forces on them are undetermined: merge "
                    "them, or move the walls apart");
      bins_[get_bin(fractional_.col(i), Vec3::Zero())].push_back(static_cast<int>(i));
    }
  }

  const Points &fractional() const { return fractional_; }

  // The node at a place, or -1.
  int find(const Vec3 &place) const
  {
    std::set<int> bins;    // more than one only next to the side of a bin
    for (int corner = 0; corner < 8; corner++) {
      const Vec3 offset(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      bins.insert(get_bin(place, offset));
    }
    for (int bin : bins)
      for (int i : bins_[bin]) {
        Vec3 s = fractional_.col(i) - place;
        s.array() -= s.array().round();
        if ((lattice_.vectors() * s).norm() < tolerance_) return i;
      }
    return -1;
  }

 private:
  static constexpr int kBins = 32;

  // offset: in tolerances along each lattice vector.
  int get_bin(const Vec3 &place, const Vec3 &offset) const
  {
    int bin = 0;
    for (int k = 0; k < 3; k++) {
      const double s = place[k] + offset[k] * tolerance_ / lattice_.heights()[k];
      bin = bin * kBins + static_cast<int>(std::floor((s - std::floor(s)) * kBins)) % kBins;
    }
    return bin;
  }

  const MeshLattice &lattice_;
  double tolerance_;
  Points fractional_;
  std::vector<std::vector<int>> bins_;
};

using TriangleSet = std::set<Triangle>;

Triangle sort_nodes(Triangle t)
{
  std::sort(t.begin(), t.end());
  return t;
}

double compute_mean_edge(const WallMesh &mesh, const MeshLattice &lattice)
{
  double sum = 0.0;
  for (const Triangle &t : mesh.triangles)
    sum += lattice.wrap_difference(mesh.nodes.col(t[1]) - mesh.nodes.col(t[0])).norm();
  return sum / static_cast<double>(std::max<size_t>(1, mesh.triangles.size()));
}

// The node on which the shift puts each node; empty if it does not map the mesh onto itself.
std::vector<int> find_images(const NodeFinder &finder, const Vec3 &shift,
                             const std::vector<Triangle> &triangles, const TriangleSet &sorted)
{
  const Eigen::Index n = finder.fractional().cols();
  std::vector<int> images(n);
  for (Eigen::Index i = 0; i < n; i++) {
    images[i] = finder.find(finder.fractional().col(i) + shift);
    if (images[i] < 0) return {};
  }
  for (const Triangle &t : triangles)
    if (!sorted.count(sort_nodes({images[t[0]], images[t[1]], images[t[2]]}))) return {};
  return images;
}

}    // namespace

MeshTranslations::MeshTranslations(const WallMesh &mesh)
{
  const MeshLattice lattice(mesh.cell);
  const NodeFinder finder(mesh.nodes, lattice, 1e-5 * compute_mean_edge(mesh, lattice));
  TriangleSet sorted;
  for (const Triangle &t : mesh.triangles)
    sorted.insert(sort_nodes(t));
  const int n = static_cast<int>(mesh.nodes.cols());
  std::array<std::vector<int>, 3> images;
  for (int axis = 0; axis < 3; axis++) {
    images[axis].resize(n);
    std::iota(images[axis].begin(), images[axis].end(), 0);
    for (int count = n; count > 1 && counts_[axis] == 1; count--) {
      if (n % count) continue;
      std::vector<int> found =
          find_images(finder, Vec3::Unit(axis) / count, mesh.triangles, sorted);
      if (found.empty()) continue;
      counts_[axis] = count;
      images[axis] = std::move(found);
    }
  }
  std::stable_sort(axes_.begin(), axes_.end(),
                   [this](int a, int b) { return counts_[a] < counts_[b]; });
  set_order(images);
}

void MeshTranslations::set_order(const std::array<std::vector<int>, 3> &images)
{
  const size_t n = images[0].size(), n_unit = n / n_shifts();
  order_.resize(n);
  std::vector<char> is_placed(n, 0);
  size_t unit = 0;
  for (size_t first = 0; first < n; first++) {
    if (is_placed[first]) continue;
    size_t shift = 0;
    int outer = static_cast<int>(first);
    for (int i = 0; i < counts_[axes_[0]]; i++, outer = images[axes_[0]][outer]) {
      int middle = outer;
      for (int j = 0; j < counts_[axes_[1]]; j++, middle = images[axes_[1]][middle]) {
        int node = middle;
        for (int k = 0; k < counts_[axes_[2]]; k++, node = images[axes_[2]][node]) {
          order_[shift++ * n_unit + unit] = node;
          is_placed[node] = 1;
        }
      }
    }
    unit++;
  }
}

}    // namespace biem
