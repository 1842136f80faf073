// compute biem/cell: gathers sums over the triangles, hinges and nodes of each cell and publishes
// what follows from them. Knows no formula of a membrane law or of a shape.
#include "compute_biem_cell.h"

#include "dihedral_biem_bend.h"

#include "biem_error.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_output.h"
#include "biem_mesh_moments.h"

#include "angle.h"
#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr int N_COLUMNS = 23;

// Sums of sums are sums, so this is reduced as plain doubles. Positions are relative to the origin.
struct ComputeBiemCell::Sums {
  biem::MeshMoments moments;
  double velocity[3] = {};        // integral of v dA
  double skalak = 0.0, bending = 0.0;
  double force[3] = {};
  double force_moment[6] = {};    // sym(F x), xx yy zz xy xz yz
};

static constexpr int N_SUMS = biem::MeshMoments::n_values + 14;

static void compute_symmetric_product(const double *a, const double *b, double *result)
{
  const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < 6; k++)
    result[k] = 0.5 * (a[row[k]] * b[column[k]] + a[column[k]] * b[row[k]]);
}

/* ---------------------------------------------------------------------- */

ComputeBiemCell::ComputeBiemCell(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), skalak(nullptr), bend(nullptr), values(nullptr), is_first(1)
{
  static_assert(sizeof(Sums) == N_SUMS * sizeof(double), "plain doubles");
  if (narg != 3)
    error->all(FLERR, "Compute biem/cell takes no arguments, but has {} (the first is {})",
               narg - 3, arg[3]);
  if (!atom->molecule_flag)
    error->all(FLERR, "Compute biem/cell needs molecule IDs, since a molecule is a cell; use an "
               "atom style that has them (molecular or full)");
  array_flag = 1;
  extarray = 0;
  size_array_rows = static_cast<int>(find_last_molecule());
  size_array_cols = N_COLUMNS;
  if (size_array_rows < 1)
    error->all(FLERR, "Compute biem/cell: no atom has a molecule ID above 0, so there are no "
               "cells; define the compute after create_cells, read_data or read_restart");
  memory->create(values, size_array_rows, N_COLUMNS, "biem/cell:values");
  array = values;
  origin.resize(3 * size_array_rows);
  comm_reverse = 1;
}

ComputeBiemCell::~ComputeBiemCell()
{
  memory->destroy(values);
}

tagint ComputeBiemCell::find_last_molecule()
{
  tagint last = 0, last_all;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->molecule[i]);
  MPI_Allreduce(&last, &last_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  return last_all;
}

void ComputeBiemCell::init()
{
  if (!force->newton_bond)
    error->all(FLERR, "Compute biem/cell needs each triangle on exactly one process: "
               "set 'newton on' before the simulation box is defined");
  const tagint last = find_last_molecule();
  if (last > size_array_rows)
    error->all(FLERR, "Compute {} biem/cell has a row for each of {} molecules, but there are {} "
               "now; define it after the last command that adds cells", id, size_array_rows, last);
  skalak = force->angle_match("biem/skalak");
  bend = dynamic_cast<DihedralBiemBend *>(force->dihedral_match("biem/bend"));
  flow = nullptr;
  for (int i = 0; i < modify->nfix; i++)
    if (strcmp(modify->fix[i]->style, "biem") == 0) flow = modify->fix[i];
  check_group();
  is_first = 1;
}

/* ----------------------------------------------------------------------
   a part of a surface has no volume: a cell is in the group with all its atoms or with none
------------------------------------------------------------------------- */

void ComputeBiemCell::check_group()
{
  const int n = size_array_rows;
  std::vector<int> count(2 * n, 0), count_all(2 * n);    // atoms in the group, atoms not in it
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] > 0)
      count[2 * (atom->molecule[i] - 1) + ((atom->mask[i] & groupbit) ? 0 : 1)]++;
  MPI_Allreduce(count.data(), count_all.data(), 2 * n, MPI_INT, MPI_SUM, world);
  for (int m = 0; m < n; m++)
    if (count_all[2 * m] > 0 && count_all[2 * m + 1] > 0)
      error->all(FLERR, "Compute {} biem/cell: its group has only {} of the {} atoms of molecule "
                 "{}; a cell must be in the group as a whole", id, count_all[2 * m],
                 count_all[2 * m] + count_all[2 * m + 1], m + 1);
}

/* ---------------------------------------------------------------------- */

void ComputeBiemCell::compute_array()
{
  invoked_array = update->ntimestep;
  if (is_first) compute_origins();
  std::vector<Sums> sums(size_array_rows);
  node_area.assign(atom->nlocal + atom->nghost, 0.0);
  add_triangles(sums);
  add_hinges(sums);
  BiemCompat::reverse_comm(comm, this);    // node_area of ghosts
  add_nodes(sums);
  is_first = 0;

  MPI_Allreduce(MPI_IN_PLACE, sums.data(), N_SUMS * size_array_rows, MPI_DOUBLE, MPI_SUM, world);
  for (int m = 1; m <= size_array_rows; m++) publish(sums[m - 1], m);
}

// Mean unwrapped position of the nodes; later calls use the last centroid.
void ComputeBiemCell::compute_origins()
{
  std::vector<double> sum(4 * size_array_rows, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit) || atom->molecule[i] < 1) continue;
    double unwrapped[3], *s = &sum[4 * (atom->molecule[i] - 1)];
    domain->unmap(atom->x[i], atom->image[i], unwrapped);
    for (int c = 0; c < 3; c++) s[c] += unwrapped[c];
    s[3] += 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), static_cast<int>(sum.size()), MPI_DOUBLE, MPI_SUM, world);
  for (int m = 0; m < size_array_rows; m++)
    for (int c = 0; c < 3; c++) origin[3 * m + c] = sum[4 * m + c] / std::max(1.0, sum[4 * m + 3]);
}

/* ----------------------------------------------------------------------
   with newton on, atom t[1] is owned and has image flags; the others may be ghosts, which have
   none, but they are the closest images
------------------------------------------------------------------------- */

void ComputeBiemCell::add_triangles(std::vector<Sums> &sums)
{
  double **x = atom->x;
  for (int n = 0; n < neighbor->nanglelist; n++) {
    const int *t = neighbor->anglelist[n];
    const tagint m = atom->molecule[t[1]];
    if (!(atom->mask[t[1]] & groupbit) || m < 1) continue;
    if (skalak && !skalak->setflag[t[3]]) continue;
    if (is_first) check_image_flags(t);

    double unwrapped[3];
    domain->unmap(x[t[1]], atom->image[t[1]], unwrapped);
    const biem::Vec3 x1 = biem::Vec3(unwrapped) - biem::Vec3(&origin[3 * (m - 1)]);
    const biem::Vec3 x0 = x1 + (biem::Vec3(x[t[0]]) - biem::Vec3(x[t[1]]));
    const biem::Vec3 x2 = x1 + (biem::Vec3(x[t[2]]) - biem::Vec3(x[t[1]]));
    const double area = biem::add_triangle_moments(x0, x1, x2, sums[m - 1].moments);
    for (int k = 0; k < 3; k++) node_area[t[k]] += area / 3.0;
    if (skalak) sums[m - 1].skalak += skalak->single(t[3], t[0], t[1], t[2]);
  }
}

void ComputeBiemCell::add_hinges(std::vector<Sums> &sums)
{
  if (!bend) return;
  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *t = neighbor->dihedrallist[n];
    const tagint m = atom->molecule[t[1]];
    if (!(atom->mask[t[1]] & groupbit) || m < 1 || !bend->setflag[t[4]]) continue;
    sums[m - 1].bending += bend->compute_hinge_energy(t[4], t[0], t[1], t[2], t[3]);
  }
}

/* ----------------------------------------------------------------------
   velocity of the unwrapped position: in a box that deforms, images move relative to each other
------------------------------------------------------------------------- */

void ComputeBiemCell::add_nodes(std::vector<Sums> &sums)
{
  const double *rate = domain->h_rate;
  for (int i = 0; i < atom->nlocal; i++) {
    if (node_area[i] == 0.0) continue;
    const tagint m = atom->molecule[i];
    Sums &sum = sums[m - 1];
    const imageint image = atom->image[i];
    const int ix = (image & IMGMASK) - IMGMAX, iy = ((image >> IMGBITS) & IMGMASK) - IMGMAX,
              iz = (image >> IMG2BITS) - IMGMAX;
    const double *v = atom->v[i], *f = atom->f[i];
    sum.velocity[0] += node_area[i] * (v[0] + ix * rate[0] + iy * rate[5] + iz * rate[4]);
    sum.velocity[1] += node_area[i] * (v[1] + iy * rate[1] + iz * rate[3]);
    sum.velocity[2] += node_area[i] * (v[2] + iz * rate[2]);

    double position[3], product[6];
    domain->unmap(atom->x[i], image, position);
    for (int c = 0; c < 3; c++) position[c] -= origin[3 * (m - 1) + c];
    compute_symmetric_product(f, position, product);
    for (int c = 0; c < 3; c++) sum.force[c] += f[c];
    for (int k = 0; k < 6; k++) sum.force_moment[k] += product[k];
  }
}

/* ----------------------------------------------------------------------
   a data file with wrapped positions and no image flags would give cells of nonsensical volume
------------------------------------------------------------------------- */

void ComputeBiemCell::check_image_flags(const int *t)
{
  const double tolerance = 1e-6 * domain->prd[0];
  double **x = atom->x, unwrapped[3], other[3];
  domain->unmap(x[t[1]], atom->image[t[1]], unwrapped);
  for (const int k : {t[0], t[2]}) {
    const int owned = atom->map(atom->tag[k]);
    if (owned < 0 || owned >= atom->nlocal) continue;    // another process' atom
    domain->unmap(x[owned], atom->image[owned], other);
    for (int c = 0; c < 3; c++)
      if (!(std::fabs(unwrapped[c] + x[k][c] - x[t[1]][c] - other[c]) <= tolerance))
        error->one(FLERR, "Compute {} biem/cell: the image flags of atoms {} and {} of molecule {} "
                   "do not belong to one connected cell; give image flags in the data file for "
                   "cells that cross a boundary", id, atom->tag[t[1]], atom->tag[k],
                   atom->molecule[t[1]]);
  }
}

/* ---------------------------------------------------------------------- */

void ComputeBiemCell::publish(const Sums &sum, tagint m)
{
  double *row = values[m - 1];
  std::fill(row, row + N_COLUMNS, 0.0);
  if (sum.moments.area == 0.0) return;    // no triangles: tracers, or not in the group
  biem::CellShape shape;
  try {
    shape = biem::compute_cell_shape(sum.moments);
  } catch (biem::Error &e) {
    error->all(FLERR, "Compute {} biem/cell: molecule {}: {}", id, m, e.what());
  }

  double *center = &origin[3 * (m - 1)], moment[6];
  compute_symmetric_product(sum.force, shape.centroid.data(), moment);
  row[0] = sum.moments.volume;
  row[1] = sum.moments.area;
  row[5] = shape.inclination_in_plane;
  row[6] = shape.inclination;
  row[7] = shape.deformation;
  row[14] = sum.skalak;
  row[15] = sum.bending;
  row[22] = shape.ellipsoid_angle;
  for (int c = 0; c < 3; c++) {
    center[c] += shape.centroid[c];
    row[2 + c] = center[c];
    row[8 + c] = shape.semi_axes[c];
    row[11 + c] = sum.velocity[c] / sum.moments.area;
  }
  for (int k = 0; k < 6; k++) row[16 + k] = -(sum.force_moment[k] - moment[k]);
  if (flow) replace_stresslet(m, row + 16);
}

/* ----------------------------------------------------------------------
   the double layer of a rigid particle or of another viscosity has a stresslet, too: that of the
   flow solver is complete, but for its trace; it is zero for cells that have none
------------------------------------------------------------------------- */

void ComputeBiemCell::replace_stresslet(tagint m, double *stresslet)
{
  if (m > flow->size_array_rows) return;
  const int row = static_cast<int>(m) - 1;
  double size = 0.0;
  for (int k = 0; k < 6; k++)
    size += std::fabs(flow->compute_array(row, FlowOutput::kStresslet + k));
  if (size == 0.0) return;
  const double pressure = (stresslet[0] + stresslet[1] + stresslet[2]) / 3.0;
  for (int k = 0; k < 6; k++)
    stresslet[k] = flow->compute_array(row, FlowOutput::kStresslet + k) + (k < 3 ? pressure : 0.0);
}

/* ---------------------------------------------------------------------- */

int ComputeBiemCell::pack_reverse_comm(int n, int first, double *buf)
{
  for (int i = 0; i < n; i++) buf[i] = node_area[first + i];
  return n;
}

void ComputeBiemCell::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int i = 0; i < n; i++) node_area[list[i]] += buf[i];
}

double ComputeBiemCell::memory_usage()
{
  return sizeof(double) *
      (static_cast<double>(size_array_rows) * (N_COLUMNS + 3) + node_area.capacity());
}
