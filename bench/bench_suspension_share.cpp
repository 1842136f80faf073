// Share of a suspension: see the header.
#include "bench_suspension_share.h"
#include "bench_options.h"
#include "biem_element_flat.h"
#include "biem_mesh_shape.h"
#include "biem_mesh_topology.h"
#include <cmath>
#include <map>

using namespace biem;

namespace biem_bench {

namespace {

// Moduli of potentials/red_cell_zhao2012.lmp at a capillary number of 1.
constexpr double kShearModulus = 1.0, kDilatationModulus = 100.0, kBendingModulus = 3.3e-3;
constexpr double kStretch = 0.02;      // along one axis of the cell
constexpr double kListMargin = 1.1;    // candidates of the near rule, as in a neighbor list

Points wrap(const Mat3 &cell, const Points &points)
{
  Points s = cell.inverse() * points;
  s.array() -= s.array().floor();
  return cell * s;
}

std::vector<int> list_owned(MPI_Comm comm, const RedCells &cells)
{
  const std::vector<int> ranks = assign_to_ranks(cells.unwrapped, cells.box, get_n_ranks(comm));
  std::vector<int> owned;
  for (size_t i = 0; i < ranks.size(); i++)
    if (ranks[i] == get_rank(comm)) owned.push_back(static_cast<int>(i));
  return owned;
}

// Local copies of every node, owned and ghosts.
class LocalCopies {
 public:
  LocalCopies(const std::vector<int> &owned, PeriodicGhosts &ghosts) : nodes_(ghosts.nodes())
  {
    std::vector<double> ids(nodes_.cols());
    std::copy(owned.begin(), owned.end(), ids.begin());
    ghosts.forward(ids.data(), 1);
    for (size_t i = 0; i < ids.size(); i++)
      copies_[static_cast<int>(ids[i])].push_back(static_cast<int>(i));
  }

  // Of the copies of a node, the one closest to a local node.
  int find_closest(int node, int local) const
  {
    int best = -1;
    double least = 1e300;
    const auto place = copies_.find(node);
    if (place == copies_.end()) throw Error("suspension: the ghosts do not reach a whole element");
    for (int i : place->second) {
      const double distance = (nodes_.col(i) - nodes_.col(local)).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      best = i;
    }
    return best;
  }

 private:
  const Points &nodes_;
  std::map<int, std::vector<int>> copies_;
};

}    // namespace

RedCells make_red_cells(int n, int nodes_per_cell, double hematocrit)
{
  const double spacing = std::cbrt(4.0 * M_PI / 3.0 / hematocrit);
  const SurfaceMesh mesh = make_mesh(*make_red_cell(), nodes_per_cell);
  const std::vector<Hinge> hinges = make_hinges(mesh.triangles);
  RedCells cells;
  cells.box = n * spacing * Mat3::Identity();
  cells.n_cells = n * n * n;
  cells.nodes_per_cell = nodes_per_cell;
  cells.longest_edge = (1.0 + kStretch) * compute_mesh_quality(mesh).longest_edge;
  cells.unwrapped.resize(3, cells.n_nodes());
  cells.reference.resize(3, cells.n_nodes());
  cells.smooth_density.resize(3, cells.n_nodes());
  const Mat3 stretch =
      Vec3(1.0 + kStretch, 1.0, 1.0 / (1.0 + kStretch)).asDiagonal();    // keeps the volume
  for (int c = 0; c < cells.n_cells; c++) {
    const int first = c * nodes_per_cell;
    const Vec3 center = spacing * Vec3(c % n + 0.5, c / n % n + 0.5, c / (n * n) + 0.5);
    const Mat3 rotation = Eigen::AngleAxisd(c, Vec3(1.0, c % 3, 0.5).normalized()).matrix();
    const Points rotated = rotation * stretch * mesh.nodes;
    cells.unwrapped.middleCols(first, nodes_per_cell) = rotated.colwise() + center;
    cells.reference.middleCols(first, nodes_per_cell) = mesh.nodes;
    for (int i = 0; i < nodes_per_cell; i++)
      cells.smooth_density.col(first + i) = Vec3(rotated(2, i), 0.3 * rotated(1, i), rotated(0, i));
    for (const Triangle &t : mesh.triangles)
      cells.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    for (const Hinge &h : hinges)
      cells.hinges.push_back({h.a + first, h.b + first, h.c + first, h.d + first});
  }
  return cells;
}

SuspensionShare::SuspensionShare(MPI_Comm comm, const RedCells &cells, double reach) :
    owned_(list_owned(comm, cells)),
    ghosts_(comm, wrap(cells.box, cells.unwrapped(Eigen::all, owned_)), cells.box, reach),
    skalak_(kShearModulus, kDilatationModulus),
    bend_(kBendingModulus, compute_sphere_angle(2 * cells.nodes_per_cell - 4))
{
  for (int i : owned_)
    surface_of_node_.push_back(i / cells.nodes_per_cell);
  no_index_.assign(owned_.size(), -1);
  unwrapped_ = cells.unwrapped(Eigen::all, owned_);
  list_elements(cells);
  list_candidates();
}

void SuspensionShare::list_elements(const RedCells &cells)
{
  const LocalCopies copies(owned_, ghosts_);
  std::vector<int> local(cells.n_nodes(), -1);    // of owned nodes
  for (size_t i = 0; i < owned_.size(); i++)
    local[owned_[i]] = static_cast<int>(i);
  std::vector<Vec3> shifts;
  for (const Triangle &t : cells.triangles) {
    const int middle = local[t[1]];
    if (middle < 0) continue;
    triangles_.push_back(
        {copies.find_closest(t[0], middle), middle, copies.find_closest(t[2], middle)});
    references_.push_back(compute_reference_triangle(
        {cells.reference.col(t[0]), cells.reference.col(t[1]), cells.reference.col(t[2])}));
    surface_of_triangle_.push_back(t[1] / cells.nodes_per_cell);
    shifts.push_back(cells.unwrapped.col(t[1]) - ghosts_.nodes().col(middle));
  }
  for (const Hinge &h : cells.hinges) {
    const int middle = local[h.b];
    if (middle < 0) continue;
    hinges_.push_back({copies.find_closest(h.a, middle), middle, copies.find_closest(h.c, middle),
                       copies.find_closest(h.d, middle)});
  }
  triangle_shift_.resize(3, shifts.size());
  for (size_t e = 0; e < shifts.size(); e++)
    triangle_shift_.col(e) = shifts[e];
}

// Nodes in bins, so that only the bins around an element are searched.
void SuspensionShare::list_candidates()
{
  FlatElements elements;
  elements.set_geometry(ghosts_.nodes(), triangles_);
  const Points &nodes = ghosts_.nodes();
  double reach = 0.0;
  for (int e = 0; e < elements.n_elements(); e++)
    reach = std::max(reach, kListMargin * kNearFactor * elements.mean_edge(e));
  const double width = 2.0 * reach;    // reach plus an edge
  using Bin = std::array<int, 3>;
  const auto find_bin = [&](const Vec3 &x) {
    const Vec3 place = (x / width).array().floor();
    return Bin{static_cast<int>(place[0]), static_cast<int>(place[1]), static_cast<int>(place[2])};
  };
  std::map<Bin, std::vector<int>> bins;
  for (Eigen::Index i = 0; i < nodes.cols(); i++)
    bins[find_bin(nodes.col(i))].push_back(static_cast<int>(i));

  candidates_.start.assign(1, 0);
  std::vector<int> around, found;
  for (int e = 0; e < elements.n_elements(); e++) {
    const Bin center = find_bin(nodes.col(triangles_[e][1]));
    around.clear();
    for (int b = 0; b < 27; b++) {
      const auto bin =
          bins.find({center[0] + b % 3 - 1, center[1] + b / 3 % 3 - 1, center[2] + b / 9 - 1});
      if (bin != bins.end()) around.insert(around.end(), bin->second.begin(), bin->second.end());
    }
    found.resize(around.size() + 1);
    const int n_found =
        elements.find_within(e, kListMargin * kNearFactor * elements.mean_edge(e), around.data(),
                             static_cast<int>(around.size()), nodes, found.data());
    candidates_.node.insert(candidates_.node.end(), found.begin(), found.begin() + n_found);
    candidates_.start.push_back(static_cast<int>(candidates_.node.size()));
  }
}

Configuration SuspensionShare::configuration() const
{
  return Configuration{ghosts_.nodes(),
                       ghosts_.n_owned(),
                       triangles_,
                       surface_of_triangle_,
                       surface_of_node_,
                       no_index_,
                       triangle_shift_,
                       unwrapped_,
                       candidates_,
                       orientations_,
                       0};
}

Points SuspensionShare::compute_membrane_forces() const
{
  const Points &x = ghosts_.nodes();
  Points forces = Points::Zero(3, x.cols());
  for (size_t e = 0; e < triangles_.size(); e++) {
    const Triangle &t = triangles_[e];
    const TriangleResponse response =
        compute_skalak_response(skalak_, references_[e], {x.col(t[0]), x.col(t[1]), x.col(t[2])});
    for (int v = 0; v < 3; v++)
      forces.col(t[v]) += response.force[v];
  }
  for (const Hinge &h : hinges_) {
    const HingeResponse response =
        bend_.compute_response({x.col(h.a), x.col(h.b), x.col(h.c), x.col(h.d)});
    forces.col(h.a) += response.force[0];
    forces.col(h.b) += response.force[1];
    forces.col(h.c) += response.force[2];
    forces.col(h.d) += response.force[3];
  }
  return forces;
}

}    // namespace biem_bench
