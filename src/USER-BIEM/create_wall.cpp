// create_wall: checks the system, has the core make the mesh, hands it to the bridge, reports.
// Does not know how meshes are made nor how atoms are stored.
#include "create_wall.h"

#include "biem_lammps_bridge.h"
#include "biem_lammps_cell_creation.h"
#include "biem_lammps_surface_command.h"
#include "biem_lammps_wall_settings.h"
#include "biem_mesh_clearance.h"
#include "comm.h"
#include "group.h"
#include "utils.h"

using namespace LAMMPS_NS;

namespace {

const char kName[] = "create_wall";

biem::SurfaceMesh make_lattice_wall(LAMMPS *lmp, const WallSettings &s)
{
  const biem::WallBox box = {get_cell(lmp), get_origin(lmp)};
  if (s.shape == WallSettings::Shape::Plane)
    return biem::make_plane_wall(box, s.axis, s.first, s.edge);
  if (s.shape == WallSettings::Shape::Duct)
    return biem::make_duct_wall(box, {s.axis, s.first, s.second}, s.edge);
  return biem::make_tube_wall(box, {s.axis, s.first, s.second, s.radius}, s.edge);
}

biem::SurfaceMesh make_wall(LAMMPS *lmp, const WallSettings &s)
{
  SurfaceCommand base(lmp, kName);
  biem::SurfaceMesh mesh;
  if (s.shape != WallSettings::Shape::Mesh) {
    base.run_on_first([&] { mesh = make_lattice_wall(lmp, s); });
    return lmp->comm->me == 0 ? mesh : make_lattice_wall(lmp, s);
  }
  biem::SurfaceMesh file = base.read_mesh(s.file);
  file.nodes = (s.scale * file.nodes).colwise() + s.shift;
  base.check_edges(biem::compute_mesh_quality(file).longest_edge);
  base.run_on_first([&] { mesh = biem::join_periodic_nodes(get_cell(lmp), file); });
  return lmp->comm->me == 0 ? mesh : biem::join_periodic_nodes(get_cell(lmp), file);
}

std::string describe(const WallSettings &s)
{
  const char *const names[3] = {"x", "y", "z"};
  const std::string axis = names[static_cast<int>(s.axis)];
  switch (s.shape) {
    case WallSettings::Shape::Plane: return "plane normal to " + axis;
    case WallSettings::Shape::Duct: return "duct along " + axis;
    case WallSettings::Shape::Tube: return "tube along " + axis;
    default: return "mesh of " + s.file;
  }
}

void report(LAMMPS *lmp, const WallSettings &settings, const biem::SurfaceMesh &mesh,
            tagint first_tag, tagint molecule)
{
  if (lmp->comm->me != 0) return;
  const biem::WallMeasures measures = biem::compute_wall_measures(get_cell(lmp), mesh);
  utils::logmesg(lmp, "Created wall: {}\n", describe(settings));
  utils::logmesg(lmp, "  atoms {} to {}, molecule {}\n", first_tag,
                 first_tag + static_cast<tagint>(mesh.nodes.cols()) - 1, molecule);
  utils::logmesg(lmp, "  {} nodes, {} angles, edges {:.4g} to {:.4g}, area {:.8g}\n",
                 mesh.nodes.cols(), mesh.triangles.size(), measures.shortest_edge,
                 measures.longest_edge, measures.area);
  if (measures.n_open_edges > 0)
    utils::logmesg(lmp, "  the wall ends at {} open edges\n", measures.n_open_edges);
}

}    // namespace

void CreateWall::command(int narg, char **arg)
{
  SurfaceCommand base(lmp, kName);
  base.check_system();
  const WallSettings settings = parse_create_wall(lmp, narg, arg);
  const SurfaceLabels &wanted = settings.labels;
  base.check_types(wanted.type, wanted.angle_type, 0);
  CellTemplate wall;
  wall.mesh = make_wall(lmp, settings);
  wall.load = biem::balance_middle_nodes(wall.mesh.triangles, wall.hinges,
                                         static_cast<int>(wall.mesh.nodes.cols()));
  const biem::PackingObstacles existing = gather_obstacles(lmp, kName);
  base.run_on_first([&] { biem::check_wall_clearance(get_cell(lmp), wall.mesh, existing); });

  CellLabels labels = {wanted.type, wanted.angle_type, 0, 0, 0};
  labels.first_molecule = base.compute_first_molecule(wanted.first_molecule, 1);
  CellCreation creation(lmp, kName);
  creation.prepare(wall);
  if (!wanted.group.empty())
    labels.group_bits = group->bitmask[group->find_or_create(wanted.group.c_str())];
  const biem::RigidPlacement place = {biem::Vec3::Zero(), biem::Mat3::Identity()};
  const tagint first_tag = creation.add(wall, {place}, labels);
  report(lmp, settings, wall.mesh, first_tag, labels.first_molecule);
}
