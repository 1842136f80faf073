// Axisymmetric bodies about the z axis, given by their meridian curve, and their surface meshes.
// Knows nothing of position, orientation, LAMMPS or mechanics.
#ifndef BIEM_MESH_SHAPE_H
#define BIEM_MESH_SHAPE_H

#include "biem_mesh_icosphere.h"

#include <memory>
#include <string>

namespace biem {

// A point of the meridian curve: distance from the symmetry axis and height along it, length.
struct MeridianPoint {
  double rho, z;
};

// A body of revolution, symmetric under z -> -z. Lengths are in the unit of the constructor's.
class Shape {
 public:
  virtual ~Shape() = default;

  // The surface point to which the point of the unit sphere at polar angle theta goes;
  // theta in [0, pi], 0 on the axis (z > 0), pi/2 on the equator. rho'(theta) > 0 at 0.
  virtual MeridianPoint compute_meridian_point(double theta) const = 0;
  virtual double compute_volume() const = 0;    // exact, length^3
  virtual std::string describe() const = 0;     // e.g. "red cell of equivalent radius 1"
};

// The discocyte of Zhao et al. 2012 (after Pozrikidis); radius = that of the sphere of its volume.
std::unique_ptr<Shape> make_red_cell(double radius = 1.0);
std::unique_ptr<Shape> make_sphere(double radius);
// Platelets: an oblate spheroid, or a flat disc with a half-circular edge; thickness < diameter.
std::unique_ptr<Shape> make_spheroid(double diameter, double thickness);
std::unique_ptr<Shape> make_rounded_disc(double diameter, double thickness);

// Icosphere of n_nodes = 10 f^2 + 2 nodes mapped to the shape, centered at the origin and scaled
// so that the volume inside the flat triangles is the exact volume of the shape.
SurfaceMesh make_mesh(const Shape &shape, int n_nodes);

// The factor by which make_mesh enlarged the mapped mesh: nodes lie on the shape times this.
double compute_volume_scale(const Shape &shape, int n_nodes);

// Volume enclosed by the triangles (divergence theorem), length^3; negative when inside out.
double compute_enclosed_volume(const PointsView &nodes, const std::vector<Triangle> &triangles);

// Shape quality of the triangles: what decides the accuracy of flat elements.
struct MeshQuality {
  double shortest_edge, longest_edge;        // length
  double smallest_angle;                     // rad, over all corners of all triangles
  double smallest_area, largest_area;        // length^2
};
MeshQuality compute_mesh_quality(const SurfaceMesh &mesh);

}    // namespace biem

#endif
