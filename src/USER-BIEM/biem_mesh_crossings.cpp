// Edges against triangles, bin by bin: see the header.
#include "biem_mesh_crossings.h"

#include "biem_mesh_obstacles.h"

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
void CrossingBins::find_range(const SurfaceTriangle &t, int axis, int &low, int &high) const
{
  double smallest = 0.0, largest = 0.0;
  for (int k = 0; k < 3; k++) {
    const double s = lattice_.compute_fractional(t.corner(k))[axis];
    smallest = k == 0 ? s : std::min(smallest, s);
    largest = k == 0 ? s : std::max(largest, s);
  }
  const int n = n_[axis];
  const double start = std::floor(smallest * n), end = std::floor(largest * n);
  low = 0;
  high = n - 1;
  if (end - start + 1.0 >= n) return;
  low = static_cast<int>(start - n * std::floor(start / n));
  high = low + static_cast<int>(end - start);
}

std::optional<Crossing> find_crossing(const MeshLattice &lattice,
                                      std::vector<SurfaceTriangle> &triangles)
{
  std::sort(triangles.begin(), triangles.end(),
            [](const SurfaceTriangle &a, const SurfaceTriangle &b) { return a.bin < b.bin; });
  std::vector<Plane> planes;
  for (const SurfaceTriangle &t : triangles) planes.push_back(make_plane(t));
  std::optional<Crossing> result;
  for (size_t first = 0, end; first < triangles.size(); first = end) {
    for (end = first; end < triangles.size() && triangles[end].bin == triangles[first].bin;) end++;
    for (size_t i = first; i < end; i++)
      for (size_t j = i + 1; j < end; j++) {
        const SurfaceTriangle &s = triangles[i], &t = triangles[j];
        if (s.is_sheet && t.is_sheet) continue;
        const int low = std::min(s.surface, t.surface), high = std::max(s.surface, t.surface);
        if (result && std::pair(low, high) >= std::pair(result->first, result->second)) continue;
        if (do_cross(lattice, s, planes[i], t, planes[j]))
          result = Crossing{low, high, planes[i].center};
      }
  }
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
