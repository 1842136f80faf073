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

  // Adds int dA of the hat functions (nodal areas, n) and dV/dx of the enclosed volume (3 x n).
  virtual void add_nodal_areas(Eigen::Ref<Eigen::VectorXd> areas) const = 0;
  virtual void add_volume_gradient(PointsRef gradient) const = 0;
  // Contribution of one element to the enclosed volume, about the given origin.
  virtual double volume(int element, const Vec3 &origin) const = 0;

  // Far rule: nodes carry the fraction nodal_fraction() of their nodal area; every element carries
  // one interior point with the rest of its area and the mean density.
  virtual double nodal_fraction() const = 0;
  virtual void compute_interior_points(PointsRef points) const = 0;    // 3 x n_elements
  virtual void compute_interior_strengths(PointsView density, PointsRef strengths) const = 0;

  // Adds int (consistent mass) * density to result: 3 x n each.
  virtual void add_mass_product(PointsView density, PointsRef result) const = 0;

  // Distance from the target to the element's nearest node, squared.
  virtual double squared_distance(int element, const Vec3 &target) const = 0;

  // Closed form minus far rule of the free-space single layer of element at target.
  // prepare_near() is called once per density (3 x n) before any correction.
  virtual void prepare_near(PointsView density) = 0;
  virtual Vec3 compute_near_correction(int element, const Vec3 &target) const = 0;
};

}    // namespace biem

#endif
