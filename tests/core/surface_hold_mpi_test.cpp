// Volume and area held within a whole evaluation, of cells with and without unknowns beside a rigid
// particle in a sheared cell. On 1, 2 and 4 ranks.
#include "coupled_scene.h"
#include <gtest/gtest.h>

using namespace biem;

namespace {

struct Measures {
  std::vector<double> volume, area;
  Points volume_gradient, area_gradient;
};

// Of the whole scene at once.
Measures measure(const CoupledScene &scene)
{
  Measures m;
  FlatElements elements;
  elements.set_geometry(scene.nodes, scene.triangles);
  m.volume_gradient = m.area_gradient = Points::Zero(3, scene.nodes.cols());
  elements.add_volume_gradient(m.volume_gradient);
  elements.add_area_gradient(m.area_gradient);
  m.volume.assign(scene.parts.size(), 0.0);
  m.area.assign(scene.parts.size(), 0.0);
  for (int e = 0; e < elements.n_elements(); e++) {
    const int s = scene.surface_of_triangle[e];
    m.volume[s] += elements.volume(e, Vec3::Zero());
    m.area[s] += elements.area(e);
  }
  return m;
}

}    // namespace

TEST(HeldSuspension, RatesOfVolumeAndAreaInAShearFlowAreTheWantedOnes)
{
  const CoupledScene scene = make_coupled_scene(make_tilted_box(), 3.0);
  const Measures exact = measure(scene);
  DistributedSuspension nodes(MPI_COMM_WORLD, scene, 1e-3, make_settings(1e-3));
  HeldCells &held = nodes.held();
  held.hold = Hold::VolumeAndArea;
  held.reference_volume = exact.volume;
  held.reference_area = exact.area;
  for (size_t s = 0; s < scene.parts.size(); s++) {
    held.reference_volume[s] *= 1.001;
    held.reference_area[s] *= 0.998;
  }
  held.relaxation_rate = 5.0;
  Conditions conditions;
  conditions.flow.set_shear(0.8);
  const Points velocity = nodes.evaluate(make_forces(scene), conditions).velocity;
  const Points whole = velocity + conditions.flow.gradient * scene.nodes;
  for (size_t s = 0; s < scene.parts.size(); s++) {
    const bool is_cell = scene.scene.surfaces[s].kind == SurfaceKind::Cell;
    EXPECT_NEAR(held.volume[s], is_cell ? exact.volume[s] : 0.0, 1e-13);
    EXPECT_NEAR(held.area[s], is_cell ? exact.area[s] : 0.0, 1e-13);
    if (!is_cell) continue;
    double volume_rate = 0.0, area_rate = 0.0;
    for (Eigen::Index i = 0; i < whole.cols(); i++) {
      if (scene.surface_of_node[i] != static_cast<int>(s)) continue;
      volume_rate += velocity.col(i).dot(exact.volume_gradient.col(i));
      area_rate += whole.col(i).dot(exact.area_gradient.col(i));
    }
    EXPECT_NEAR(volume_rate, 5.0 * 0.001 * exact.volume[s], 1e-12) << "surface " << s;
    EXPECT_NEAR(area_rate, -5.0 * 0.002 * exact.area[s], 1e-12) << "surface " << s;
  }
}
