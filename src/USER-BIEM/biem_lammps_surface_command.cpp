// Checks and collective steps of create_cells and create_wall: see the header.
#include "biem_lammps_surface_command.h"
#include "atom.h"
#include "atom_vec.h"
#include "biem_error.h"
#include "biem_lammps_bridge.h"
#include "biem_mesh_file.h"
#include "biem_mesh_lattice.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include <algorithm>

namespace LAMMPS_NS {

void SurfaceCommand::fail(const std::string &what)
{
  error->all(FLERR, name_ + ": " + what);
  throw biem::Error("unreachable: LAMMPS' error handler returned");
}

void SurfaceCommand::check_system()
{
  if (!domain->box_exist) fail("there is no box yet: use create_box or read_data first");
  if (domain->dimension != 3 || !domain->xperiodic || !domain->yperiodic || !domain->zperiodic)
    fail("the box must be three-dimensional and periodic: use 'boundary p p p'");
  if (!atom->molecule_flag || !atom->avec->angles_allow || !atom->avec->dihedrals_allow ||
      atom->molecular != Atom::MOLECULAR)
    fail("atom style " + std::string(atom->atom_style) +
         " lacks molecule IDs, angles or dihedrals: use 'atom_style molecular'");
  if (!atom->tag_enable || atom->map_style == Atom::MAP_NONE)
    fail("atoms have no map from ID to atom: use 'atom_modify map yes' (and not 'id no')");
  if (!force->newton_bond)
    fail("newton is off for bonds: use 'newton on' before the box is created");
}

void SurfaceCommand::check_types(int type, int angle_type, int dihedral_type)
{
  auto check = [&](const std::string &what, int value, int n, const std::string &remedy) {
    if (value > n)
      fail(what + " " + std::to_string(value) + " does not exist, the box has " +
           std::to_string(n) + ": " + remedy);
  };
  check("atom type", type, atom->ntypes, "raise the number of types in create_box");
  check("angle type", angle_type, atom->nangletypes, "add 'angle/types N' to create_box");
  check("dihedral type", dihedral_type, atom->ndihedraltypes,
        "add 'dihedral/types N' to create_box");
}

void SurfaceCommand::check_edges(double longest_edge)
{
  const biem::MeshLattice lattice(get_cell(lmp));
  const double half = 0.5 * lattice.heights().minCoeff();
  if (longest_edge >= half)
    fail("the longest edge of the mesh, " + std::to_string(longest_edge) + ", must be less than " +
         std::to_string(half) +
         ", half the shortest height of the box: use more nodes or a larger "
         "box");
}

tagint SurfaceCommand::compute_first_molecule(tagint wanted, int n_surfaces)
{
  tagint largest = 0, next = 0;
  for (int i = 0; i < atom->nlocal; i++)
    largest = std::max(largest, atom->molecule[i]);
  MPI_Allreduce(&largest, &next, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  next++;
  if (wanted == 0) return next;
  int is_taken = 0, is_taken_anywhere;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] >= wanted && atom->molecule[i] < wanted + n_surfaces) is_taken = 1;
  MPI_Allreduce(&is_taken, &is_taken_anywhere, 1, MPI_INT, MPI_MAX, world);
  if (is_taken_anywhere)
    fail("molecule " + std::to_string(wanted) +
         (n_surfaces > 1 ? " or one of the following " + std::to_string(n_surfaces - 1) : "") +
         " exists already; the next free molecule ID is " + std::to_string(next));
  return wanted;
}

void SurfaceCommand::run_on_first(const std::function<void()> &function)
{
  std::string message;
  if (comm->me == 0) {
    try {
      function();
    } catch (const biem::Error &e) {
      message = e.what();
    }
  }
  int length = static_cast<int>(message.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, world);
  if (length == 0) return;
  message.resize(length);
  MPI_Bcast(&message[0], length, MPI_CHAR, 0, world);
  fail(message);
}

biem::SurfaceMesh SurfaceCommand::read_mesh(const std::string &path)
{
  biem::SurfaceMesh mesh;
  run_on_first([&] { mesh = biem::read_surface_mesh(path); });
  int sizes[2] = {static_cast<int>(mesh.nodes.cols()), static_cast<int>(mesh.triangles.size())};
  MPI_Bcast(sizes, 2, MPI_INT, 0, world);
  mesh.nodes.resize(3, sizes[0]);
  mesh.triangles.resize(sizes[1]);
  MPI_Bcast(mesh.nodes.data(), 3 * sizes[0], MPI_DOUBLE, 0, world);
  MPI_Bcast(mesh.triangles.data(), 3 * sizes[1], MPI_INT, 0, world);
  return mesh;
}

}    // namespace LAMMPS_NS
