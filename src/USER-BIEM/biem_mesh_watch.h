// Measures of a membrane mesh that has gone wrong: strain against the reference shape, collapsed
// triangles, folded hinges; and the limits. Knows one triangle or hinge at a time; not what to do.
#ifndef BIEM_MESH_WATCH_H
#define BIEM_MESH_WATCH_H

#include "biem_types.h"

#include <algorithm>
#include <cmath>

namespace biem {

// When a run stops. Strains: red cells of 162 nodes in shear have edges between 0.6 and 1.6 times
// their reference and areas between 0.96 and 1.05 (Ca = 0.1 to 2, t = 10); a sphere with ED = ES at
// Ca = 2 has 0.7 to 1.7 and 0.6 to 1.6. Fold: an inverted triangle of a smooth mesh has a normal
// opposite to those of its neighbors but for their angle, 20 degrees with 162 nodes: the cosine is
// below -0.94. Creases of those cells, buckled ones included, have -0.03 and more.
struct WatchLimits {
  double edge_stretch = 4.0;     // largest ratio of an edge to its reference, and of that to it
  double area_stretch = 3.0;     // the same for areas of triangles
  double fold_cosine = -0.9;     // smallest cosine between the normals of neighboring triangles
  int crossing_interval = 1;     // steps between two searches for crossing surfaces; 0: none
};

// 4 sqrt(3) area / (sum of squared edges): 1 for an equilateral triangle, 0 for three nodes on one
// line. Below this one counts as collapsed; meshes that can be used have 0.1 and more.
constexpr double kCollapsedQuality = 1e-3;

struct TriangleMeasure {
  double edges[3];        // squared lengths of the edges 0-1, 1-2, 2-0
  double squared_area;    // four times the square of the area

  double compute_quality() const
  {
    return std::sqrt(12.0 * squared_area) / (edges[0] + edges[1] + edges[2]);
  }
  // Written so that what is not finite is collapsed, too.
  bool is_collapsed() const
  {
    const double limit = kCollapsedQuality * (edges[0] + edges[1] + edges[2]);
    return !(12.0 * squared_area > limit * limit);
  }
};

// a, b, c: positions, length.
inline TriangleMeasure measure_triangle(const double *a, const double *b, const double *c)
{
  const Vec3 ab = Vec3(b) - Vec3(a), bc = Vec3(c) - Vec3(b), ca = Vec3(a) - Vec3(c);
  return {{ab.squaredNorm(), bc.squaredNorm(), ca.squaredNorm()}, ab.cross(bc).squaredNorm()};
}

// Squares of ratios to the reference shape.
struct TriangleStrain {
  double longest_edge, shortest_edge, area;

  // Of the ratio that is furthest from 1, or of its inverse: squared as well, at least 1.
  double compute_edge_stretch() const { return std::max(longest_edge, 1.0 / shortest_edge); }
  double compute_area_stretch() const { return std::max(area, 1.0 / area); }
};

inline TriangleStrain compute_strain(const TriangleMeasure &reference, const TriangleMeasure &now)
{
  const double r0 = now.edges[0] / reference.edges[0], r1 = now.edges[1] / reference.edges[1],
               r2 = now.edges[2] / reference.edges[2];
  return {std::max({r0, r1, r2}), std::min({r0, r1, r2}),
          now.squared_area / reference.squared_area};
}

// Cosine of the angle between the normals of the triangles (a, b, c) and (d, c, b), 1 where they
// are in one plane and -1 where one lies on the other; not a number where one has no area.
inline double compute_fold_cosine(const double *a, const double *b, const double *c,
                                  const double *d)
{
  const Vec3 edge = Vec3(c) - Vec3(b);
  const Vec3 first = (Vec3(b) - Vec3(a)).cross(edge), second = (Vec3(d) - Vec3(b)).cross(edge);
  return first.dot(second) / std::sqrt(first.squaredNorm() * second.squaredNorm());
}

// Whether that cosine is below a negative limit.
inline bool is_folded(const double *a, const double *b, const double *c, const double *d,
                      double limit)
{
  const Vec3 edge = Vec3(c) - Vec3(b);
  const Vec3 first = (Vec3(b) - Vec3(a)).cross(edge), second = (Vec3(d) - Vec3(b)).cross(edge);
  const double product = first.dot(second);
  return product < 0.0 &&
      product * product > limit * limit * first.squaredNorm() * second.squaredNorm();
}

}    // namespace biem

#endif
