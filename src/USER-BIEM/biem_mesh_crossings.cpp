// Edges against triangles, bin by bin: see the header.
#include "biem_mesh_crossings.h"

#include "biem_mesh_obstacles.h"

#include <map>
#include <numeric>

namespace biem {
namespace {

// Bins along an axis: a bound of the memory that their numbers ask for.
constexpr double kMostBins = 100000.0;

struct Plane {
  Vec3 center, normal;    // any length
  double radius;          // of the sphere about the center that holds the corners
};

Plane make_plane(const SurfaceTriangle &t)
{
  const Vec3 a = t.corner(0), b = t.corner(1), c = t.corner(2);
  Plane plane = {(a + b + c) / 3.0, (b - a).cross(c - a), 0.0};
  for (int k = 0; k < 3; k++)
    plane.radius = std::max(plane.radius, (t.corner(k) - plane.center).norm());
  return plane;
}

// Whether all corners of t, moved by shift, are on one side of the plane.
bool is_on_one_side(const SurfaceTriangle &t, const Vec3 &shift, const Plane &plane)
{
  double side[3];
  for (int k = 0; k < 3; k++) side[k] = plane.normal.dot(t.corner(k) + shift - plane.center);
  return (side[0] > 0.0 && side[1] > 0.0 && side[2] > 0.0) ||
      (side[0] < 0.0 && side[1] < 0.0 && side[2] < 0.0);
}

// Whether an edge of t, moved by shift, goes through the other triangle.
bool has_edge_through(const SurfaceTriangle &t, const Vec3 &shift, const SurfaceTriangle &other)
{
  const Mat3 corners = Eigen::Map<const Mat3>(other.corners);
  for (int k = 0; k < 3; k++) {
    const Vec3 end = t.corner((k + 1) % 3);
    if (is_crossed(corners, end + shift, end - t.corner(k))) return true;
  }
  return false;
}

// s and t of one bin, in any periodic images; of one surface only where they are of two images.
bool do_cross(const MeshLattice &lattice, const SurfaceTriangle &s, const Plane &plane_s,
              const SurfaceTriangle &t, const Plane &plane_t)
{
  const Vec3 apart = plane_t.center - plane_s.center, wrapped = lattice.wrap_difference(apart);
  const double reach = plane_s.radius + plane_t.radius;
  if (wrapped.squaredNorm() > reach * reach) return false;
  const Vec3 shift = wrapped - apart;    // of t
  if (s.surface == t.surface && shift.norm() < 1e-6 * reach) return false;
  if (is_on_one_side(t, shift, plane_s) || is_on_one_side(s, -shift, plane_t)) return false;
  return has_edge_through(t, shift, s) || has_edge_through(s, -shift, t);
}

}    // namespace

CrossingBins::CrossingBins(const MeshLattice &lattice, double width) : lattice_(lattice)
{
  for (int a = 0; a < 3; a++)
    n_[a] = std::max(1, static_cast<int>(std::min(kMostBins, lattice.heights()[a] / width)));
}

// low is not negative, so that the remainder of a division by the number of bins is the bin.
CrossingBins::Box CrossingBins::find_box(const SurfaceTriangle &t) const
{
  const Vec3 s0 = lattice_.compute_fractional(t.corner(0)),
             s1 = lattice_.compute_fractional(t.corner(1)),
             s2 = lattice_.compute_fractional(t.corner(2));
  Box box;
  for (int a = 0; a < 3; a++) {
    const int n = n_[a];
    const double start = std::floor(std::min({s0[a], s1[a], s2[a]}) * n);
    const double end = std::floor(std::max({s0[a], s1[a], s2[a]}) * n);
    const bool is_around = !(end - start + 1.0 < n);
    const double image = is_around ? 0.0 : std::floor(start / n);
    box.image[a] = static_cast<std::int64_t>(image);
    box.low[a] = is_around ? 0 : static_cast<int>(start - n * image);
    box.high[a] = is_around ? n - 1 : box.low[a] + static_cast<int>(end - start);
    box.is_around = box.is_around || is_around;
  }
  return box;
}

// The images of one surface that share a bin are close to each other: eleven bits tell them apart.
std::uint64_t CrossingBins::find_occupant(const SurfaceTriangle &t, const Box &box, bool next_x,
                                          bool next_y, bool next_z)
{
  if (t.is_sheet) return kSheets;
  if (box.is_around) return kSeveral;
  const bool next[3] = {next_x, next_y, next_z};
  std::uint64_t occupant = t.surface;
  for (int a = 0; a < 3; a++)
    occupant = (occupant << 11) | (static_cast<std::uint64_t>(box.image[a] + next[a]) & 2047);
  return occupant;
}

// Of the bin, or the free one where it belongs. Linear probing; the multiplier spreads neighboring
// bins (Knuth, The Art of Computer Programming 3, Section 6.4: Fibonacci hashing).
std::size_t BinOccupants::find_slot(std::int64_t bin) const
{
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = (static_cast<std::uint64_t>(bin) * 0x9E3779B97F4A7C15u >> 20) & mask;
  while (slots_[slot].bin != bin && slots_[slot].bin >= 0) slot = (slot + 1) & mask;
  return slot;
}

void BinOccupants::add(std::int64_t bin, std::uint64_t occupant)
{
  Slot &slot = slots_[find_slot(bin)];
  if (slot.bin >= 0) {
    if (slot.occupant != occupant) slot.occupant = kSeveral;
    return;
  }
  slot = {bin, occupant};
  if (++n_bins_ > slots_.size() / 2) grow();
}

void BinOccupants::grow()
{
  const std::vector<Slot> old = std::move(slots_);
  slots_ = std::vector<Slot>(4 * old.size());
  for (const Slot &slot : old)
    if (slot.bin >= 0) slots_[find_slot(slot.bin)] = slot;
}

std::vector<Crossing> find_crossings(const MeshLattice &lattice,
                                     const std::vector<SurfaceTriangle> &triangles)
{
  std::vector<int> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(triangles[a].bin, a) < std::pair(triangles[b].bin, b);
  });
  std::vector<Plane> planes;
  for (const SurfaceTriangle &t : triangles) planes.push_back(make_plane(t));
  std::map<std::pair<int, int>, Vec3> found;
  for (size_t i = 0; i < order.size(); i++) {
    const SurfaceTriangle &s = triangles[order[i]];
    for (size_t j = i + 1; j < order.size() && triangles[order[j]].bin == s.bin; j++) {
      const SurfaceTriangle &t = triangles[order[j]];
      if (s.occupant == t.occupant && s.occupant != kSeveral) continue;
      const Plane &plane_s = planes[order[i]], &plane_t = planes[order[j]];
      if (!do_cross(lattice, s, plane_s, t, plane_t)) continue;
      found.insert({std::minmax(s.surface, t.surface), plane_s.center});
    }
  }
  std::vector<Crossing> result;
  for (const auto &[pair, where] : found)
    result.push_back({pair.first, pair.second, {where[0], where[1], where[2]}});
  return result;
}

// van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 125 (1983), Eq. 8.
double compute_solid_angle(const SurfaceTriangle &triangle, const Vec3 &point)
{
  const Vec3 a = triangle.corner(0) - point, b = triangle.corner(1) - point,
             c = triangle.corner(2) - point;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}    // namespace biem
