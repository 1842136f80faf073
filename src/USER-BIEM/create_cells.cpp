// create_cells: checks the system, has the core place the cells, hands them to the bridge, reports.
// Does not know how cells are packed nor how atoms are stored.
#include "create_cells.h"

#include "biem_lammps_bridge.h"
#include "biem_lammps_cell_creation.h"
#include "biem_lammps_cell_settings.h"
#include "biem_lammps_surface_command.h"
#include "biem_mesh_clearance.h"
#include "biem_mesh_moments.h"
#include "comm.h"
#include "group.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

using namespace LAMMPS_NS;

namespace {

const double kPi = 3.14159265358979323846;

const char kName[] = "create_cells";

// A closed mesh from a file, its center of volume at the origin.
biem::SurfaceMesh read_body(SurfaceCommand &base, const CellSettings &s)
{
  biem::SurfaceMesh mesh = base.read_mesh(s.mesh_file);
  mesh.nodes *= s.mesh_scale;
  base.run_on_first([&] { biem::check_closed_oriented(mesh.nodes, mesh.triangles); });
  biem::MeshMoments moments;
  const biem::Vec3 middle = mesh.nodes.rowwise().mean();    // digits cancel far from the body
  for (const biem::Triangle &t : mesh.triangles)
    biem::add_triangle_moments(mesh.nodes.col(t[0]) - middle, mesh.nodes.col(t[1]) - middle,
                               mesh.nodes.col(t[2]) - middle, moments);
  const biem::Vec3 first(moments.volume_first[0], moments.volume_first[1],
                         moments.volume_first[2]);
  mesh.nodes.colwise() -= middle + first / moments.volume;
  if (s.mesh_radius > 0.0)
    mesh.nodes *= s.mesh_radius / std::cbrt(moments.volume / (4.0 * kPi / 3.0));
  return mesh;
}

CellTemplate make_template(SurfaceCommand &base, const CellSettings &s)
{
  CellTemplate cell;
  cell.mesh = s.shape ? biem::make_mesh(*s.shape, s.n_nodes) : read_body(base, s);
  cell.hinges = biem::make_hinges(cell.mesh.triangles);
  cell.load = biem::balance_middle_nodes(cell.mesh.triangles, cell.hinges,
                                         static_cast<int>(cell.mesh.nodes.cols()));
  return cell;
}

double compute_volume(const CellTemplate &cell)
{
  return biem::compute_enclosed_volume(cell.mesh.nodes, cell.mesh.triangles);
}

std::string describe(const CellSettings &s, const CellTemplate &cell)
{
  if (s.shape) return s.shape->describe();
  char radius[32];
  std::snprintf(radius, sizeof radius, "%.6g", std::cbrt(compute_volume(cell) * 0.75 / kPi));
  return "mesh of " + s.mesh_file + ", equivalent radius " + radius;
}

biem::PackingRequest make_request(LAMMPS *lmp, const CellSettings &s, const CellTemplate &cell)
{
  const double volume = compute_volume(cell);
  biem::PackingRequest request;
  request.shape = s.shape.get();
  request.n_nodes = static_cast<int>(cell.mesh.nodes.cols());
  request.n_bodies = s.n_cells;
  request.seed = s.seed;
  request.lattice = get_cell(lmp);
  request.minimum_gap = std::max(0.0, s.gap);
  if (s.gap < 0.0 && s.placement != CellSettings::Placement::Single)
    request.minimum_gap = 0.05 * std::cbrt(volume / (4.0 * kPi / 3.0));
  const bool is_random = s.orientation == CellSettings::Orientation::Random;
  request.rotation = is_random ? biem::PackingRotation::free : biem::PackingRotation::fixed;
  request.orientation = biem::compute_rotation_to_axis(s.axis, s.roll);
  if (s.placement == CellSettings::Placement::Hematocrit) {
    const double n = s.hematocrit * std::abs(request.lattice.determinant()) / volume;
    if (n < 0.5 || n > std::numeric_limits<int>::max())
      SurfaceCommand(lmp, kName).fail("hematocrit " + std::to_string(s.hematocrit) +
                                      " in this box means " + std::to_string(n) + " cells: change "
                                      "the box, the hematocrit or the size of the cell");
    request.n_bodies = static_cast<int>(std::lround(n));
  }
  return request;
}

void check_single(const biem::PackingRequest &request, const CellTemplate &cell,
                  const biem::RigidPlacement &placement, const biem::PackingObstacles &obstacles)
{
  if (request.shape) return biem::check_placement(request, placement, obstacles);
  const biem::Points nodes = (placement.rotation * cell.mesh.nodes).colwise() + placement.center;
  biem::check_body_clearance(request.lattice, {nodes, cell.mesh.triangles}, request.minimum_gap,
                             obstacles);
}

// Rank 0 places the cells and tells the others, so that all have the same digits.
std::vector<biem::RigidPlacement> place_cells(LAMMPS *lmp, const CellSettings &s,
                                              const biem::PackingRequest &request,
                                              const CellTemplate &cell)
{
  const biem::PackingObstacles obstacles = gather_obstacles(lmp, kName);
  std::vector<biem::RigidPlacement> placements(request.n_bodies);
  SurfaceCommand(lmp, kName).run_on_first([&] {
    if (s.placement == CellSettings::Placement::Single) {
      placements[0] = {s.center, request.orientation};
      check_single(request, cell, placements[0], obstacles);
    } else {
      placements = biem::make_random_packing(request, obstacles);
    }
  });
  for (biem::RigidPlacement &placement : placements) {
    MPI_Bcast(placement.center.data(), 3, MPI_DOUBLE, 0, lmp->world);
    MPI_Bcast(placement.rotation.data(), 9, MPI_DOUBLE, 0, lmp->world);
  }
  return placements;
}

void report(LAMMPS *lmp, const CellSettings &settings, const biem::PackingRequest &request,
            const CellTemplate &cell, tagint first_tag, tagint first_molecule)
{
  if (lmp->comm->me != 0) return;
  const int n_cells = request.n_bodies;
  const biem::MeshQuality quality = biem::compute_mesh_quality(cell.mesh);
  const double fraction =
      n_cells * compute_volume(cell) / std::abs(request.lattice.determinant());
  utils::logmesg(lmp, "Created {} cells: {}\n", n_cells, describe(settings, cell));
  utils::logmesg(lmp, "  atoms {} to {}, molecules {} to {}\n", first_tag,
                 first_tag + static_cast<tagint>(n_cells) * request.n_nodes - 1, first_molecule,
                 first_molecule + n_cells - 1);
  utils::logmesg(lmp, "  per cell: {} nodes, {} angles, {} dihedrals, edges {:.4g} to {:.4g}\n",
                 request.n_nodes, cell.mesh.triangles.size(), cell.hinges.size(),
                 quality.shortest_edge, quality.longest_edge);
  utils::logmesg(lmp, "  volume fraction of these cells (hematocrit) {:.6g}, gap at least {:.4g}\n",
                 fraction, request.minimum_gap);
}

}    // namespace

void CreateCells::command(int narg, char **arg)
{
  SurfaceCommand base(lmp, kName);
  base.check_system();
  const CellSettings settings = parse_create_cells(lmp, narg, arg);
  const SurfaceLabels &wanted = settings.labels;
  base.check_types(wanted.type, wanted.angle_type, settings.dihedral_type);
  const CellTemplate cell = make_template(base, settings);
  base.check_edges(biem::compute_mesh_quality(cell.mesh).longest_edge);

  const biem::PackingRequest request = make_request(lmp, settings, cell);
  CellLabels labels = {wanted.type, wanted.angle_type, settings.dihedral_type, 0, 0};
  labels.first_molecule = base.compute_first_molecule(wanted.first_molecule, request.n_bodies);
  const std::vector<biem::RigidPlacement> placements =
      place_cells(lmp, settings, request, cell);

  CellCreation creation(lmp, kName);
  creation.prepare(cell);
  if (!wanted.group.empty())
    labels.group_bits = group->bitmask[group->find_or_create(wanted.group.c_str())];
  const tagint first_tag = creation.add(cell, placements, labels);
  report(lmp, settings, request, cell, first_tag, labels.first_molecule);
}
