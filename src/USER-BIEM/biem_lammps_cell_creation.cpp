// Atoms, topology and reference shape of new cells; see the header.
#include "biem_lammps_cell_creation.h"
#include "atom.h"
#include "atom_vec.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace LAMMPS_NS {

namespace {

const char kReference[] = "biem_reference";    // property/atom d2_biem_reference

// What a node of an icosphere (2 and 3) or a duct (3 and 0) stores at most.
constexpr int kUsualAngles = 3, kUsualDihedrals = 3;

template <class T>
std::vector<T> gather_on_first(const std::vector<T> &own, MPI_Datatype datatype, MPI_Comm world)
{
  int rank, n_ranks, n = static_cast<int>(own.size());
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &n_ranks);
  std::vector<int> counts(n_ranks), offsets(n_ranks + 1, 0);
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
  for (int i = 0; i < n_ranks; i++)
    offsets[i + 1] = offsets[i] + counts[i];
  std::vector<T> all(rank == 0 ? offsets[n_ranks] : 0);
  MPI_Gatherv(own.data(), n, datatype, all.data(), counts.data(), offsets.data(), datatype, 0,
              world);
  return all;
}

}    // namespace

biem::PackingObstacles gather_obstacles(LAMMPS *lmp, const std::string &command)
{
  Atom *atom = lmp->atom;
  std::vector<tagint> tags, corners;
  std::vector<double> x;
  for (int i = 0; i < atom->nlocal; i++) {
    tags.push_back(atom->tag[i]);
    x.insert(x.end(), atom->x[i], atom->x[i] + 3);
    for (int m = 0; m < atom->num_angle[i]; m++) {
      if (atom->tag[i] != atom->angle_atom2[i][m]) continue;
      corners.push_back(atom->angle_atom1[i][m]);
      corners.push_back(atom->angle_atom2[i][m]);
      corners.push_back(atom->angle_atom3[i][m]);
    }
  }
  tags = gather_on_first(tags, MPI_LMP_TAGINT, lmp->world);
  corners = gather_on_first(corners, MPI_LMP_TAGINT, lmp->world);
  x = gather_on_first(x, MPI_DOUBLE, lmp->world);

  // sorted by ID, so that sums over nodes come out the same on any number of ranks
  const int n_nodes = static_cast<int>(tags.size());
  std::vector<int> order(n_nodes);
  for (int i = 0; i < n_nodes; i++)
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](int i, int j) { return tags[i] < tags[j]; });
  biem::PackingObstacles obstacles;
  obstacles.nodes.resize(3, n_nodes);
  std::unordered_map<tagint, int> index;
  for (int i = 0; i < n_nodes; i++) {
    for (int k = 0; k < 3; k++)
      obstacles.nodes(k, i) = x[3 * order[i] + k];
    index[tags[order[i]]] = i;
  }
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    biem::Triangle triangle;
    for (int k = 0; k < 3; k++) {
      const auto found = index.find(corners[i + k]);
      if (found == index.end())
        lmp->error->one(FLERR, command + ": an existing angle refers to atom " +
                                   std::to_string(corners[i + k]) +
                                   ", which does not exist; was it deleted without its angles?");
      triangle[k] = found->second;
    }
    obstacles.triangles.push_back(triangle);
  }
  std::sort(obstacles.triangles.begin(), obstacles.triangles.end());
  return obstacles;
}

void CellCreation::prepare(const CellTemplate &cell)
{
  prepare_topology(cell);
  prepare_reference();
}

void CellCreation::prepare_topology(const CellTemplate &cell)
{
  const int n_angles = cell.load.max_triangles, n_dihedrals = cell.load.max_hinges;
  if (atom->natoms > 0) {
    if (atom->angle_per_atom >= n_angles && atom->dihedral_per_atom >= n_dihedrals) return;
    error->all(
        FLERR,
        command_ + ": each atom stores up to " + std::to_string(n_angles) + " angles and " +
            std::to_string(n_dihedrals) + " dihedrals, but the box was created with room for " +
            std::to_string(atom->angle_per_atom) + " and " +
            std::to_string(atom->dihedral_per_atom) +
            " and holds atoms already: add 'extra/angle/per/atom " + std::to_string(n_angles) +
            " extra/dihedral/per/atom " + std::to_string(std::max(n_dihedrals, kUsualDihedrals)) +
            "' to create_box or read_data, or use " + command_ + " before other atoms");
  }
  atom->angle_per_atom = std::max({atom->angle_per_atom, n_angles, kUsualAngles});
  atom->dihedral_per_atom = std::max({atom->dihedral_per_atom, n_dihedrals, kUsualDihedrals});
  atom->deallocate_topology();
  atom->avec->grow(std::max(atom->nmax, 1));
}

void CellCreation::prepare_reference()
{
  int is_double, n_columns;
  if (atom->find_custom(kReference, is_double, n_columns) < 0)
    modify->add_fix(std::string(kReference) + " all property/atom d2_" + kReference +
                    " 3 ghost yes");
  if (atom->find_custom(kReference, is_double, n_columns) < 0 || !is_double || n_columns != 3)
    error->all(FLERR, command_ +
                          ": the per-atom property biem_reference exists but is not of the form "
                          "d2_biem_reference with 3 columns: remove your fix property/atom, " +
                          command_ + " makes its own");
}

tagint CellCreation::add(const CellTemplate &cell,
                         const std::vector<biem::RigidPlacement> &placements,
                         const CellLabels &labels)
{
  tagint largest = 0, first_tag;
  for (int i = 0; i < atom->nlocal; i++)
    largest = std::max(largest, atom->tag[i]);
  MPI_Allreduce(&largest, &first_tag, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  first_tag++;
  const bigint n_nodes = cell.mesh.nodes.cols(), n_cells = placements.size();
  if (first_tag + n_cells * n_nodes - 1 > MAXTAGINT)
    error->all(FLERR, command_ + ": the new atom IDs exceed the largest possible one, " +
                          std::to_string(MAXTAGINT) + "; use LAMMPS compiled with BIGBIG");

  // ghosts are overwritten by new atoms, as in create_atoms
  atom->nghost = 0;
  atom->avec->clear_bonus();
  const int first_local = atom->nlocal;
  for (bigint i = 0; i < n_cells; i++)
    add_cell(cell, placements[i], first_tag + static_cast<tagint>(i * n_nodes));
  atom->data_fix_compute_variable(first_local, atom->nlocal);
  set_labels(cell, labels, first_local, first_tag);
  update_counts(cell, n_cells);
  set_topology(cell, labels, first_tag, static_cast<tagint>(n_cells));
  return first_tag;
}

// Compares in the units of the sub-domains. A position that round-off has put on the box boundary
// is taken to lie inside, so that exactly one rank owns it.
bool CellCreation::is_owned(const double *x) const
{
  double lamda[3];
  const double *low = domain->sublo, *high = domain->subhi;
  const double *box_low = domain->boxlo, *box_high = domain->boxhi;
  if (domain->triclinic) {
    domain->x2lamda(const_cast<double *>(x), lamda);
    low = domain->sublo_lamda;
    high = domain->subhi_lamda;
    box_low = domain->boxlo_lamda;
    box_high = domain->boxhi_lamda;
    x = lamda;
  }
  for (int k = 0; k < 3; k++) {
    const double inside =
        std::min(std::max(x[k], box_low[k]), std::nextafter(box_high[k], box_low[k]));
    if (inside < low[k] || inside >= high[k]) return false;
  }
  return true;
}

void CellCreation::add_cell(const CellTemplate &cell, const biem::RigidPlacement &placement,
                            tagint first_tag)
{
  for (int node = 0; node < cell.mesh.nodes.cols(); node++) {
    const biem::Vec3 position = placement.center + placement.rotation * cell.mesh.nodes.col(node);
    double x[3] = {position[0], position[1], position[2]};
    imageint image = (static_cast<imageint>(IMGMAX) << IMG2BITS) |
                     (static_cast<imageint>(IMGMAX) << IMGBITS) | IMGMAX;
    domain->remap(x, image);
    if (!is_owned(x)) continue;
    atom->avec->create_atom(1, x);
    const int i = atom->nlocal - 1;
    atom->image[i] = image;
    atom->tag[i] = first_tag + node;
  }
}

void CellCreation::set_labels(const CellTemplate &cell, const CellLabels &labels, int first_local,
                              tagint first_tag)
{
  const tagint n_nodes = static_cast<tagint>(cell.mesh.nodes.cols());
  int is_double, n_columns;
  const int index = atom->find_custom(kReference, is_double, n_columns);
  double **reference = atom->darray[index];
  for (int i = first_local; i < atom->nlocal; i++) {
    const tagint offset = atom->tag[i] - first_tag;
    atom->type[i] = labels.type;
    atom->mask[i] |= labels.group_bits;
    atom->molecule[i] = labels.first_molecule + offset / n_nodes;
    atom->num_angle[i] = atom->num_dihedral[i] = 0;
    for (int k = 0; k < 3; k++)
      reference[i][k] = cell.mesh.nodes(k, static_cast<int>(offset % n_nodes));
  }
}

void CellCreation::update_counts(const CellTemplate &cell, bigint n_cells)
{
  const bigint expected = atom->natoms + n_cells * static_cast<bigint>(cell.mesh.nodes.cols());
  const bigint n_local = atom->nlocal;
  MPI_Allreduce(&n_local, &atom->natoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (atom->natoms != expected)
    error->all(FLERR, command_ + ": there are " + std::to_string(atom->natoms) +
                          " atoms instead of " + std::to_string(expected) +
                          ": an atom outside the box was lost or taken by two ranks");
  atom->nangles += n_cells * static_cast<bigint>(cell.mesh.triangles.size());
  atom->ndihedrals += n_cells * static_cast<bigint>(cell.hinges.size());
  atom->tag_check();
  atom->map_init();
  atom->map_set();
}

// With newton on, an angle or dihedral is stored once, with its second atom.
void CellCreation::set_topology(const CellTemplate &cell, const CellLabels &labels,
                                tagint first_tag, tagint n_cells)
{
  const tagint n_nodes = static_cast<tagint>(cell.mesh.nodes.cols());
  for (tagint first = first_tag; first < first_tag + n_cells * n_nodes; first += n_nodes) {
    for (const biem::Triangle &t : cell.mesh.triangles) {
      const int i = atom->map(first + t[1]);
      if (i < 0 || i >= atom->nlocal) continue;
      const int m = atom->num_angle[i]++;
      atom->angle_type[i][m] = labels.angle_type;
      atom->angle_atom1[i][m] = first + t[0];
      atom->angle_atom2[i][m] = first + t[1];
      atom->angle_atom3[i][m] = first + t[2];
    }
    for (const biem::Hinge &h : cell.hinges) {
      const int i = atom->map(first + h.b);
      if (i < 0 || i >= atom->nlocal) continue;
      const int m = atom->num_dihedral[i]++;
      atom->dihedral_type[i][m] = labels.dihedral_type;
      atom->dihedral_atom1[i][m] = first + h.a;
      atom->dihedral_atom2[i][m] = first + h.b;
      atom->dihedral_atom3[i][m] = first + h.c;
      atom->dihedral_atom4[i][m] = first + h.d;
    }
  }
}

}    // namespace LAMMPS_NS
