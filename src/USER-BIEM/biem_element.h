// Contract of a surface element: what the integral operators need to know of a discretised surface.
// The nodes carry the unknowns; an element turns them into far-rule sources, near integrals and
// geometry. Knows nothing of periodicity, membranes or communication. A curved element is one more
// implementation of this class.
#ifndef BIEM_ELEMENT_H
#define BIEM_ELEMENT_H

#include "biem_types.h"

namespace biem {

class SurfaceElements {
 public:
  virtual ~SurfaceElements() = default;

  // nodes: 3 x n; triangles index into them. Throws Error on a degenerate element.
  virtual void set_geometry(PointsView nodes, const std::vector<Triangle> &triangles) = 0;

  virtual int n_elements() const = 0;
  virtual double area(int element) const = 0;
  virtual double mean_edge(int element) const = 0;    // length scale of the near rule

  // Adds int dA of the hat functions (nodal areas, n), dV/dx of the enclosed volume and dA/dx of
  // the area (3 x n each).
  virtual void add_nodal_areas(Eigen::Ref<Eigen::VectorXd> areas) const = 0;
  virtual void add_volume_gradient(PointsRef gradient) const = 0;
  virtual void add_area_gradient(PointsRef gradient) const = 0;
  // Contribution of one element to the enclosed volume, about the given origin.
  virtual double volume(int element, const Vec3 &origin) const = 0;

  // Far rule: nodes carry the fraction nodal_fraction() of their nodal area; every element carries
  // one interior point with the rest of its area and the mean density.
  virtual double nodal_fraction() const = 0;
  virtual void compute_interior_points(PointsRef points) const = 0;    // 3 x n_elements
  // Single layer: area times mean density of the interior points.
  virtual void compute_interior_strengths(PointsView density, PointsRef strengths) const = 0;
  // Double layer: outward normals times the area of the far rule (nodes: adds, 3 x n), and the
  // mean density that belongs to the interior points (3 x n_elements).
  virtual void add_nodal_normals(PointsRef normals) const = 0;
  virtual void compute_interior_normals(PointsRef normals) const = 0;
  virtual void compute_interior_means(PointsView density, PointsRef means) const = 0;

  // Adds int (consistent mass) * density to result: 3 x n each.
  virtual void add_mass_product(PointsView density, PointsRef result) const = 0;

  // Of the candidates (n columns of nodes), in their order, those within distance of one of the
  // element's nodes: written to found, which has room for n or is candidates; returns their number.
  virtual int find_within(int element, double distance, const int *candidates, int n,
                          PointsView nodes, int *found) const = 0;

  // Densities of the near corrections, 3 x n each, or 3 x 0 for a layer that is not present: the
  // single layer's f and the double layer's q. layers: what each element carries of them; null:
  // both. Called once per density and geometry.
  virtual void prepare_near(PointsView single_layer_density, PointsView double_layer_density,
                            const std::vector<Layers> *layers = nullptr) = 0;
  // Whether the element carries a layer whose density was given. Throws Error if not prepared.
  virtual bool has_near(int element) const = 0;
  // velocities (3 x n_all) of the n targets (columns of nodes) += closed form minus far rule of
  // the element's free-space integrals, int (I/r + rr/r^3) f dA and int -6 r (r.q)(r.n)/r^5 dA.
  // The result at a target does not depend on the other targets. Throws Error if not prepared.
  // Only the layers that the element carries are added and paid for.
  virtual void add_near_corrections(int element, const int *targets, int n, PointsView nodes,
                                    PointsRef velocities) const = 0;
  // The same for the double layer of (e_1, e_2, e_3), in columns; needs no densities.
  virtual void add_near_tensors(int element, const int *targets, int n, PointsView nodes,
                                std::vector<Mat3> &tensors) const = 0;
};

}    // namespace biem

#endif
