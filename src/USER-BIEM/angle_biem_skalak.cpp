// angle_style biem/skalak: hands triangles to the Skalak law and takes back forces and energies.
// Knows no formula of the law.
#include "angle_biem_skalak.h"

#include "biem_error.h"
#include "biem_membrane_skalak.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;

static constexpr char REFERENCE[] = "biem_reference";    // per-atom property d2_biem_reference

// positions or reference positions of the three atoms
static biem::TriangleNodes load_triangle(double **rows, int i1, int i2, int i3)
{
  return {biem::Vec3(rows[i1]), biem::Vec3(rows[i2]), biem::Vec3(rows[i3])};
}

/* ---------------------------------------------------------------------- */

AngleBiemSkalak::AngleBiemSkalak(LAMMPS *lmp) :
    Angle(lmp), shear_modulus(nullptr), dilatation_modulus(nullptr)
{
  writedata = 1;
}

AngleBiemSkalak::~AngleBiemSkalak()
{
  if (allocated && !copymode) {
    memory->destroy(setflag);
    memory->destroy(shear_modulus);
    memory->destroy(dilatation_modulus);
  }
}

void AngleBiemSkalak::allocate()
{
  allocated = 1;
  const int n = atom->nangletypes + 1;
  memory->create(shear_modulus, n, "angle:shear_modulus");
  memory->create(dilatation_modulus, n, "angle:dilatation_modulus");
  memory->create(setflag, n, "angle:setflag");
  for (int i = 0; i < n; i++) setflag[i] = 0;
}

void AngleBiemSkalak::coeff(int narg, char **arg)
{
  if (narg != 3)
    error->all(FLERR, "angle_coeff for biem/skalak takes a type, ES and ED, but has {} values",
               narg);
  if (!allocated) allocate();
  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, atom->nangletypes, ilo, ihi, error);
  const double shear = utils::numeric(FLERR, arg[1], false, lmp);
  const double dilatation = utils::numeric(FLERR, arg[2], false, lmp);
  try {
    biem::SkalakLaw(shear, dilatation);
  } catch (biem::Error &e) {
    error->all(FLERR, "angle_coeff {} for biem/skalak: {}", arg[0], e.what());
  }
  for (int i = ilo; i <= ihi; i++) {
    shear_modulus[i] = shear;
    dilatation_modulus[i] = dilatation;
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   a restart file holds the reference shape for a fix of this id and style, which LAMMPS does not
   define by itself: defining it here, before LAMMPS drops unclaimed restart data, brings it back
------------------------------------------------------------------------- */

void AngleBiemSkalak::init_style()
{
  if (!force->newton_bond)
    error->all(FLERR, "Angle style biem/skalak needs each triangle on exactly one process: "
               "set 'newton on' before the simulation box is defined");
  int flag, columns;
  if (atom->find_custom(REFERENCE, flag, columns) < 0)
    modify->add_fix("biem_reference all property/atom d2_biem_reference 3 ghost yes");
  find_reference();
  check_reference_set();
}

double **AngleBiemSkalak::find_reference()
{
  int flag, columns;
  const int index = atom->find_custom(REFERENCE, flag, columns);
  if (index < 0)
    error->all(FLERR, "Angle style biem/skalak: the per-atom reference shape d2_biem_reference "
               "is gone; keep the fix biem_reference");
  if (flag != 1 || columns != 3)
    error->all(FLERR, "Angle style biem/skalak: the per-atom property biem_reference must be "
               "d2_biem_reference with 3 columns; use 'fix biem_reference all property/atom "
               "d2_biem_reference 3 ghost yes'");
  return atom->darray[index];
}

void AngleBiemSkalak::check_reference_set()
{
  const int ifix = modify->find_fix(REFERENCE);
  if (ifix >= 0 && modify->fix[ifix]->comm_border < 3)
    error->all(FLERR, "Angle style biem/skalak: fix biem_reference does not send the reference "
               "shape to ghost atoms; add 'ghost yes' to it");
  double **reference = find_reference();
  double largest = 0.0, largest_all;
  for (int i = 0; i < atom->nlocal; i++)
    for (int c = 0; c < 3; c++) largest = std::fmax(largest, std::fabs(reference[i][c]));
  MPI_Allreduce(&largest, &largest_all, 1, MPI_DOUBLE, MPI_MAX, world);
  if (atom->nangles > 0 && largest_all == 0.0)
    error->all(FLERR, "Angle style biem/skalak: the reference shape (property d2_biem_reference) "
               "is missing or all zero. create_cells makes it. For a data file: 'fix "
               "biem_reference all property/atom d2_biem_reference 3 ghost yes' before 'read_data "
               "<file> fix biem_reference NULL biem_reference', with a section of that name. "
               "A restart file has it if the run that wrote it had");
}

void AngleBiemSkalak::refuse_triangle(const char *what, int i1, int i2, int i3)
{
  const tagint *tag = atom->tag;
  error->one(FLERR, "Angle style biem/skalak: {}: atoms {} {} {} of molecule {} on step {}", what,
             tag[i1], tag[i2], tag[i3], atom->molecule_flag ? atom->molecule[i2] : 0,
             update->ntimestep);
}

/* ---------------------------------------------------------------------- */

void AngleBiemSkalak::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  double **x = atom->x, **f = atom->f, **reference_rows = find_reference();
  const int nlocal = atom->nlocal;

  for (int n = 0; n < neighbor->nanglelist; n++) {
    const int *t = neighbor->anglelist[n];
    const biem::TriangleNodes reference = load_triangle(reference_rows, t[0], t[1], t[2]);
    const biem::TriangleNodes nodes = load_triangle(x, t[0], t[1], t[2]);
    if (biem::is_degenerate(reference))
      refuse_triangle("the reference triangle has no area (is the property d2_biem_reference set "
                      "for this cell?)", t[0], t[1], t[2]);
    if (biem::is_degenerate(nodes))
      refuse_triangle("a triangle has collapsed or has positions that are not numbers (the time "
                      "step is too large, or the cell is too soft for the flow)",
                      t[0], t[1], t[2]);
    biem::TriangleResponse response = biem::compute_skalak_response(
        biem::SkalakLaw(shear_modulus[t[3]], dilatation_modulus[t[3]]),
        biem::compute_reference_triangle(reference), nodes);

    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 3; c++) f[t[k]][c] += response.force[k][c];
    if (evflag) {
      const biem::Vec3 d1 = nodes[0] - nodes[1], d2 = nodes[2] - nodes[1];
      ev_tally(t[0], t[1], t[2], nlocal, force->newton_bond, response.energy,
               response.force[0].data(), response.force[2].data(), d1[0], d1[1], d1[2], d2[0],
               d2[1], d2[2]);
    }
  }
}

/* ----------------------------------------------------------------------
   a membrane triangle prefers no angle in particular
------------------------------------------------------------------------- */

double AngleBiemSkalak::equilibrium_angle(int)
{
  return 0.0;
}

// i1, i2, i3 are local indices of the closest images, as in the list of angles
double AngleBiemSkalak::single(int type, int i1, int i2, int i3)
{
  return biem::compute_skalak_response(
             biem::SkalakLaw(shear_modulus[type], dilatation_modulus[type]),
             biem::compute_reference_triangle(load_triangle(find_reference(), i1, i2, i3)),
             load_triangle(atom->x, i1, i2, i3)).energy;
}

/* ---------------------------------------------------------------------- */

void AngleBiemSkalak::write_restart(FILE *fp)
{
  fwrite(&shear_modulus[1], sizeof(double), atom->nangletypes, fp);
  fwrite(&dilatation_modulus[1], sizeof(double), atom->nangletypes, fp);
}

void AngleBiemSkalak::read_restart(FILE *fp)
{
  allocate();
  const int n = atom->nangletypes;
  for (double *values : {&shear_modulus[1], &dilatation_modulus[1]}) {
    if (comm->me == 0) utils::sfread(FLERR, values, sizeof(double), n, fp, nullptr, error);
    MPI_Bcast(values, n, MPI_DOUBLE, 0, world);
  }
  for (int i = 1; i <= n; i++) setflag[i] = 1;
}

void AngleBiemSkalak::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->nangletypes; i++)
    fprintf(fp, "%d %.17g %.17g\n", i, shear_modulus[i], dilatation_modulus[i]);
}
