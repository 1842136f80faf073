// What a scene is made of: the kinds of its surfaces, the shapes of its rigid particles, its walls;
// and from that the blocks of unknowns that Eq. 5 of Zhao et al. 2012 has in this scene.
// Knows no positions of bodies, no forces and no time.
#ifndef BIEM_SCENE_H
#define BIEM_SCENE_H

#include "biem_mesh_icosphere.h"
#include "biem_solver_wall.h"
#include <string>

namespace biem {

enum class SurfaceKind { None, Cell, Rigid, Wall };

struct Surface {
  SurfaceKind kind = SurfaceKind::None;    // None: no surface has this number
  double viscosity_ratio = 1.0;            // Cell: inside over outside
  // Rigid: index into Scene::shapes. Cell with unknowns: index into Scene::connectivities.
  int shape = -1;
  Vec3 velocity = Vec3::Zero();    // Wall: of the wall itself [length/time]

  bool is_closed() const { return kind == SurfaceKind::Cell || kind == SurfaceKind::Rigid; }
  // Whether it has unknowns: a cell of the fluid's own viscosity only follows the flow.
  bool is_unknown() const
  {
    return kind == SurfaceKind::Rigid || kind == SurfaceKind::Wall ||
           (kind == SurfaceKind::Cell && viscosity_ratio != 1.0);
  }
  // The double-layer density is this times the unknown.
  double double_layer_factor() const
  {
    if (kind == SurfaceKind::Rigid) return 1.0;
    return kind == SurfaceKind::Cell ? viscosity_ratio - 1.0 : 0.0;
  }
};

struct Scene {
  std::vector<Surface> surfaces;      // by the number of the surface
  std::vector<SurfaceMesh> shapes;    // of rigid particles, in their body frames
  // Triangles of cells with unknowns, by the numbers of the nodes within their cell.
  std::vector<std::vector<Triangle>> connectivities;
  WallMesh walls;    // all walls together

  bool has(SurfaceKind kind) const;
  bool has_unknowns() const;
  bool has_contrast() const;    // cells with unknowns
  // Layers that the unknowns carry; only where there are some.
  Layers unknown_layers() const;
};

// The same surfaces, shapes and walls, to the last digit.
bool operator==(const Scene &a, const Scene &b);

// Nodes of each block, for reports.
struct BlockSizes {
  long n_free = 0;        // cells of viscosity ratio 1
  long n_contrast = 0;    // cells of other viscosity ratios
  long n_rigid = 0, n_wall = 0;
};
// One line for each block that exists and what it costs; "nothing to solve" where nothing is.
std::string describe_blocks(const BlockSizes &sizes);

}    // namespace biem

#endif
