// Flat triangles with linear densities: the paper's element.
// Far rule of degree 2: 1/4 of the area at the vertices, 3/4 at the centroid.
#ifndef BIEM_ELEMENT_FLAT_H
#define BIEM_ELEMENT_FLAT_H

#include "biem_element.h"
#include "biem_near_triangle.h"

namespace biem {

class FlatElements : public SurfaceElements {
 public:
  void set_geometry(PointsView nodes, const std::vector<Triangle> &triangles) override;
  int n_elements() const override { return static_cast<int>(triangles_.size()); }
  double area(int element) const override { return 0.5 * frames_[element].twice_area; }
  double mean_edge(int element) const override { return mean_edges_[element]; }
  void add_nodal_areas(Eigen::Ref<Eigen::VectorXd> areas) const override;
  void add_volume_gradient(PointsRef gradient) const override;
  void add_area_gradient(PointsRef gradient) const override;
  double volume(int element, const Vec3 &origin) const override;
  double nodal_fraction() const override { return 0.25; }
  void compute_interior_points(PointsRef points) const override;
  void compute_interior_strengths(PointsView density, PointsRef strengths) const override;
  void add_nodal_normals(PointsRef normals) const override;
  void compute_interior_normals(PointsRef normals) const override;
  void compute_interior_means(PointsView density, PointsRef means) const override;
  void add_mass_product(PointsView density, PointsRef result) const override;
  int find_within(int element, double distance, const int *candidates, int n, PointsView nodes,
                  int *found) const override;
  void prepare_near(PointsView single_layer_density, PointsView double_layer_density,
                    const std::vector<Layers> *layers = nullptr) override;
  bool has_near(int element) const override;
  void add_near_corrections(int element, const int *targets, int n, PointsView nodes,
                            PointsRef velocities) const override;
  void add_near_tensors(int element, const int *targets, int n, PointsView nodes,
                        std::vector<Mat3> &tensors) const override;

 private:
  // A density of prepare_near in the form that the near corrections need.
  struct PreparedDensity {
    std::vector<LinearDensity> linear;        // in the element's frame
    std::vector<std::array<Vec3, 4>> rule;    // vertices, centroid; times area of the far rule
  };

  Vec3 centroid(int element) const;
  bool carries_single(int element) const;
  bool carries_double(int element) const;
  PreparedDensity prepare(PointsView density, Layers layer) const;
  template <Layers layers>
  PointPack compute_corrections(int element, const PointPack &targets) const;

  std::vector<Triangle> triangles_;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<TriangleFrame> frames_;
  std::vector<double> mean_edges_;
  Eigen::Index n_nodes_ = 0;
  PreparedDensity single_, double_;    // empty: not present
  std::vector<Layers> layers_;         // of each element; empty: both
};

}    // namespace biem

#endif
