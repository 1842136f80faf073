// create_cells: checks the system, has the core place the cells, hands them to the bridge, reports.
// Does not know how cells are packed nor how atoms are stored.
#include "create_cells.h"

#include "atom.h"
#include "atom_vec.h"
#include "biem_error.h"
#include "biem_lammps_bridge.h"
#include "biem_lammps_cell_creation.h"
#include "biem_lammps_cell_settings.h"
#include "biem_mesh_lattice.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

namespace {

const double kPi = 3.14159265358979323846;

void check_system(LAMMPS *lmp)
{
  Atom *atom = lmp->atom;
  Domain *domain = lmp->domain;
  auto fail = [&](const std::string &what) { lmp->error->all(FLERR, "create_cells: " + what); };
  if (!domain->box_exist) fail("there is no box yet: use create_box or read_data first");
  if (domain->dimension != 3 || !domain->xperiodic || !domain->yperiodic || !domain->zperiodic)
    fail("the box must be three-dimensional and periodic: use 'boundary p p p'");
  if (!atom->molecule_flag || !atom->avec->angles_allow || !atom->avec->dihedrals_allow ||
      atom->molecular != Atom::MOLECULAR)
    fail("atom style " + std::string(atom->atom_style) +
         " lacks molecule IDs, angles or dihedrals: use 'atom_style molecular'");
  if (!atom->tag_enable || atom->map_style == Atom::MAP_NONE)
    fail("atoms have no map from ID to atom: use 'atom_modify map yes' (and not 'id no')");
  if (!lmp->force->newton_bond)
    fail("newton is off for bonds: use 'newton on' before the box is created");
}

void check_types(LAMMPS *lmp, const CellSettings &s)
{
  auto check = [&](const std::string &what, int value, int n, const std::string &remedy) {
    if (value > n)
      lmp->error->all(FLERR, "create_cells: " + what + " " + std::to_string(value) +
                                 " does not exist, the box has " + std::to_string(n) +
                                 ": " + remedy);
  };
  check("atom type", s.type, lmp->atom->ntypes, "raise the number of types in create_box");
  check("angle type", s.angle_type, lmp->atom->nangletypes, "add 'angle/types N' to create_box");
  check("dihedral type", s.dihedral_type, lmp->atom->ndihedraltypes,
        "add 'dihedral/types N' to create_box");
}

CellTemplate make_template(const CellSettings &s)
{
  CellTemplate cell;
  cell.mesh = biem::make_mesh(*s.shape, s.n_nodes);
  cell.hinges = biem::make_hinges(cell.mesh.triangles);
  cell.load = biem::balance_middle_nodes(cell.mesh.triangles, cell.hinges, s.n_nodes);
  return cell;
}

// LAMMPS finds the image of a neighbor node by the shortest distance.
void check_edges(LAMMPS *lmp, double longest_edge)
{
  const biem::MeshLattice lattice(get_cell(lmp));
  const double half = 0.5 * lattice.heights().minCoeff();
  if (longest_edge >= half)
    lmp->error->all(FLERR, "create_cells: the longest edge of the mesh, " +
                               std::to_string(longest_edge) + ", must be less than " +
                               std::to_string(half) + ", half the shortest height of the box: "
                               "use more nodes or a larger box");
}

biem::PackingRequest make_request(LAMMPS *lmp, const CellSettings &s)
{
  biem::PackingRequest request;
  request.shape = s.shape.get();
  request.n_nodes = s.n_nodes;
  request.n_bodies = s.n_cells;
  request.seed = s.seed;
  request.lattice = get_cell(lmp);
  request.minimum_gap = std::max(0.0, s.gap);
  if (s.gap < 0.0 && s.placement != CellSettings::Placement::Single)
    request.minimum_gap = 0.05 * std::cbrt(s.shape->compute_volume() / (4.0 * kPi / 3.0));
  const bool is_random = s.orientation == CellSettings::Orientation::Random;
  request.rotation = is_random ? biem::PackingRotation::free : biem::PackingRotation::fixed;
  request.orientation = biem::compute_rotation_to_axis(s.axis, s.roll);
  if (s.placement == CellSettings::Placement::Hematocrit) {
    const double n = s.hematocrit * std::abs(request.lattice.determinant()) /
        s.shape->compute_volume();
    if (n < 0.5 || n > std::numeric_limits<int>::max())
      lmp->error->all(FLERR, "create_cells: hematocrit " + std::to_string(s.hematocrit) +
                                 " in this box means " + std::to_string(n) +
                                 " cells: change the box, the hematocrit or the size of the cell");
    request.n_bodies = static_cast<int>(std::lround(n));
  }
  return request;
}

// Rank 0 places the cells and tells the others, so that all have the same digits.
std::vector<biem::RigidPlacement> place_cells(LAMMPS *lmp, const CellSettings &s,
                                              const biem::PackingRequest &request)
{
  const biem::PackingObstacles obstacles = gather_obstacles(lmp);
  std::vector<biem::RigidPlacement> placements(request.n_bodies);
  std::string message;
  if (lmp->comm->me == 0) {
    try {
      if (s.placement == CellSettings::Placement::Single) {
        placements[0] = {s.center, request.orientation};
        biem::check_placement(request, placements[0], obstacles);
      } else {
        placements = biem::make_random_packing(request, obstacles);
      }
    } catch (const biem::Error &e) {
      message = e.what();
    }
  }
  int length = static_cast<int>(message.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, lmp->world);
  if (length > 0) {
    message.resize(length);
    MPI_Bcast(&message[0], length, MPI_CHAR, 0, lmp->world);
    lmp->error->all(FLERR, "create_cells: " + message);
  }
  for (biem::RigidPlacement &placement : placements) {
    MPI_Bcast(placement.center.data(), 3, MPI_DOUBLE, 0, lmp->world);
    MPI_Bcast(placement.rotation.data(), 9, MPI_DOUBLE, 0, lmp->world);
  }
  return placements;
}

tagint compute_first_molecule(LAMMPS *lmp, const CellSettings &s, int n_cells)
{
  Atom *atom = lmp->atom;
  tagint largest = 0, next = 0;
  for (int i = 0; i < atom->nlocal; i++) largest = std::max(largest, atom->molecule[i]);
  MPI_Allreduce(&largest, &next, 1, MPI_LMP_TAGINT, MPI_MAX, lmp->world);
  next++;
  if (s.first_molecule == 0) return next;
  int is_taken = 0, is_taken_anywhere;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] >= s.first_molecule && atom->molecule[i] < s.first_molecule + n_cells)
      is_taken = 1;
  MPI_Allreduce(&is_taken, &is_taken_anywhere, 1, MPI_INT, MPI_MAX, lmp->world);
  if (is_taken_anywhere)
    lmp->error->all(FLERR, "create_cells: molecule " + std::to_string(s.first_molecule) +
                               " or one of the following " + std::to_string(n_cells - 1) +
                               " exists already; the next free molecule ID is " +
                               std::to_string(next));
  return s.first_molecule;
}

void report(LAMMPS *lmp, const biem::PackingRequest &request, const CellTemplate &cell,
            tagint first_tag, tagint first_molecule)
{
  if (lmp->comm->me != 0) return;
  const int n_cells = request.n_bodies;
  const biem::MeshQuality quality = biem::compute_mesh_quality(cell.mesh);
  const double fraction = n_cells * request.shape->compute_volume() /
      std::abs(request.lattice.determinant());
  utils::logmesg(lmp, "Created {} cells: {}\n", n_cells, request.shape->describe());
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
  check_system(lmp);
  const CellSettings settings = parse_create_cells(lmp, narg, arg);
  check_types(lmp, settings);
  const CellTemplate cell = make_template(settings);
  check_edges(lmp, biem::compute_mesh_quality(cell.mesh).longest_edge);

  const biem::PackingRequest request = make_request(lmp, settings);
  CellLabels labels = {settings.type, settings.angle_type, settings.dihedral_type, 0, 0};
  labels.first_molecule = compute_first_molecule(lmp, settings, request.n_bodies);
  const std::vector<biem::RigidPlacement> placements = place_cells(lmp, settings, request);

  CellCreation creation(lmp);
  creation.prepare(cell);
  if (!settings.group.empty())
    labels.group_bits = group->bitmask[group->find_or_create(settings.group.c_str())];
  const tagint first_tag = creation.add(cell, placements, labels);
  report(lmp, request, cell, first_tag, labels.first_molecule);
}
