// Edges against triangles, nodes against distances. Does not move anything.
#include "biem_mesh_clearance.h"

#include "biem_error.h"
#include "biem_mesh_obstacles.h"

#include <algorithm>
#include <limits>
#include <string>

namespace biem {
namespace {

// True if an edge of the triangles goes through the surface.
bool has_crossing(const MeshLattice &lattice, const Points &nodes,
                  const std::vector<Triangle> &triangles, const MeshObstacles &surface)
{
  for (const Triangle &t : triangles)
    for (int k = 0; k < 3; k++) {
      const Vec3 end = nodes.col(t[(k + 1) % 3]);
      if (surface.intersects(end, lattice.wrap_difference(end - nodes.col(t[k])))) return true;
    }
  return false;
}

// The smallest distance of the nodes from the surface; limit if none is as near.
double compute_distance(const Points &nodes, const MeshObstacles &surface, double limit)
{
  double smallest = limit;
  for (int i = 0; i < nodes.cols(); i++)
    smallest = std::min(smallest, surface.evaluate(nodes.col(i), Vec3::Zero(), limit).value);
  return smallest;
}

double compute_shortest_edge(const MeshLattice &lattice, const SurfaceMesh &mesh)
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const Triangle &t : mesh.triangles)
    for (int k = 0; k < 3; k++)
      shortest = std::min(shortest, lattice.wrap_difference(mesh.nodes.col(t[k]) -
                                                            mesh.nodes.col(t[(k + 1) % 3])).norm());
  return shortest;
}

void check_own_images(const MeshLattice &lattice, const SurfaceMesh &body, double gap)
{
  const Mat3 inverse = lattice.vectors().inverse();
  for (int k = 0; k < 3; k++) {
    const auto along = inverse.row(k) * body.nodes;
    const double height = lattice.heights()[k];
    const double extent = (along.maxCoeff() - along.minCoeff()) * height;
    if (extent + gap > height)
      throw Error("Placement: the body measures " + std::to_string(extent) + " along the height " +
                  std::to_string(height) + " of the box and does not keep the gap " +
                  std::to_string(gap) + " to its own periodic image; make it smaller, turn it or "
                  "enlarge the box");
  }
}

// Whether an existing node is deep inside the body.
bool holds_nodes(const MeshLattice &lattice, const SurfaceMesh &body, const MeshObstacles &surface,
                 const Points &nodes)
{
  const Vec3 center = body.nodes.rowwise().mean();
  const double radius = (body.nodes.colwise() - center).colwise().norm().maxCoeff();
  for (int i = 0; i < nodes.cols(); i++)
    if (lattice.wrap_difference(nodes.col(i) - center).norm() < radius &&
        surface.is_inside(nodes.col(i)))
      return true;
  return false;
}

}    // namespace

void check_wall_clearance(const Mat3 &vectors, const SurfaceMesh &wall,
                          const PackingObstacles &existing)
{
  if (existing.nodes.cols() == 0) return;
  const MeshLattice lattice(vectors);
  const double shortest = compute_shortest_edge(lattice, wall);
  const MeshObstacles new_surface(lattice, wall.nodes, wall.triangles, shortest,
                                  MeshObstacles::Sides::Two);
  if (compute_distance(existing.nodes, new_surface, 1e-6 * shortest) < 1e-6 * shortest)
    throw Error("Wall: an existing atom lies on it; move the atom or the wall; sheets that cross "
                "must share the nodes of the line where they cross, as those of a duct do");
  const MeshObstacles old_surfaces(lattice, existing.nodes, existing.triangles, shortest);
  if (has_crossing(lattice, existing.nodes, existing.triangles, new_surface) ||
      has_crossing(lattice, wall.nodes, wall.triangles, old_surfaces))
    throw Error("Wall: it crosses a surface that is in the box already; create walls before cells, "
                "or move one of them; sheets that cross must be one duct");
  if (!existing.triangles.empty() && old_surfaces.is_inside(wall.nodes.col(0)))
    throw Error("Wall: it lies inside a closed surface that is in the box already; move one of "
                "them");
}

void check_body_clearance(const Mat3 &vectors, const SurfaceMesh &body, double gap,
                          const PackingObstacles &existing)
{
  const MeshLattice lattice(vectors);
  check_own_images(lattice, body, gap);
  if (existing.nodes.cols() == 0) return;
  const double reach = std::max(gap, compute_shortest_edge(lattice, body));
  const MeshObstacles new_surface(lattice, body.nodes, body.triangles, reach);
  const MeshObstacles old_surfaces(lattice, existing.nodes, existing.triangles, reach);
  const bool is_clear = compute_distance(body.nodes, old_surfaces, reach) >= gap &&
      compute_distance(existing.nodes, new_surface, reach) >= gap &&
      !has_crossing(lattice, body.nodes, body.triangles, old_surfaces) &&
      !has_crossing(lattice, existing.nodes, existing.triangles, new_surface) &&
      (existing.triangles.empty() || !old_surfaces.is_inside(body.nodes.col(0))) &&
      !holds_nodes(lattice, body, new_surface, existing.nodes);
  if (!is_clear)
    throw Error("Placement: the body does not keep the gap " + std::to_string(gap) +
                " to what is in the box already; move it, lower the gap or enlarge the box");
}

}    // namespace biem
